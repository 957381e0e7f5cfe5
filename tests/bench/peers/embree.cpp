// Embree 3 over a field of heights, asked round by round so that another program's rounds can stand between.
//
//   g++ -O3 -march=native embree.cpp -o embree -lembree3
//   embree HEIGHTS N grid|triangles PAIRS RAYS
//
// HEIGHTS: n*n f32, row by row, in cells. PAIRS: 4 f32 a line of sight, columns and rows of the posts that it joins.
// RAYS: 6 f32 a ray, origin and direction in cells. Lines stand ABOVE over both posts. On standard input "build", "los"
// or "primary"; on standard output milliseconds and how many lines were blocked or rays hit (for "build": bytes).
// One thread. Triangles are split as the ground is: along the diagonal of the corners that are both even or both odd.
#include <embree3/rtcore.h>

#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#include <vector>

static const float ABOVE = 0.18f;
static int64_t bytes = 0;

static bool count(void *, ssize_t change, bool) { bytes += change; return true; }

static double now_ms() {
    using namespace std::chrono;
    return duration<double, std::milli>(steady_clock::now().time_since_epoch()).count();
}

static std::vector<float> read(const char *path) {
    FILE *file = fopen(path, "rb");
    if (!file) { fprintf(stderr, "%s cannot be read\n", path); exit(1); }
    fseek(file, 0, SEEK_END);
    std::vector<float> values(ftell(file) / 4);
    rewind(file);
    if (fread(values.data(), 4, values.size(), file) != values.size()) exit(1);
    fclose(file);
    return values;
}

static void vertices(RTCGeometry geometry, const std::vector<float> &z, unsigned n) {
    float *v = (float *)rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 12, z.size());
    for (size_t i = 0; i < z.size(); i++) { v[3 * i] = i % n; v[3 * i + 1] = z[i]; v[3 * i + 2] = i / n; }
}

static RTCGeometry triangles(RTCDevice device, const std::vector<float> &z, unsigned n) {
    RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    vertices(geometry, z, n);
    size_t count = size_t(n - 1) * (n - 1) * 2;
    unsigned *q = (unsigned *)rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 12, count);
    for (unsigned y = 0; y < n - 1; y++)
        for (unsigned x = 0; x < n - 1; x++) {
            unsigned sw = y * n + x, se = sw + 1, nw = sw + n, ne = nw + 1;
            unsigned rising[6] = {sw, se, ne, sw, ne, nw}, falling[6] = {sw, se, nw, se, ne, nw};
            memcpy(q, x % 2 == y % 2 ? rising : falling, sizeof rising);
            q += 6;
        }
    return geometry;
}

static RTCGeometry grid(RTCDevice device, const std::vector<float> &z, unsigned n) {
    RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_GRID);
    vertices(geometry, z, n);
    const unsigned side = 64, count = (n - 1) / side;
    RTCGrid *q = (RTCGrid *)rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_GRID, 0, RTC_FORMAT_GRID, sizeof(RTCGrid), size_t(count) * count);
    for (unsigned i = 0; i < count * count; i++)
        q[i] = {(i / count) * side * n + (i % count) * side, n, uint16_t(side + 1), uint16_t(side + 1)};
    return geometry;
}

static RTCScene build(RTCDevice device, const std::vector<float> &z, unsigned n, bool as_grid) {
    RTCScene scene = rtcNewScene(device);
    RTCGeometry geometry = as_grid ? grid(device, z, n) : triangles(device, z, n);
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene, geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(scene);
    return scene;
}

int main(int, char **arguments) {
    unsigned n = atoi(arguments[2]);
    bool as_grid = !strcmp(arguments[3], "grid");
    std::vector<float> z = read(arguments[1]), pairs = read(arguments[4]), rays = read(arguments[5]);
    RTCDevice device = rtcNewDevice("threads=1,set_affinity=0");
    rtcSetDeviceMemoryMonitorFunction(device, count, nullptr);
    std::vector<RTCRay> lines;
    for (size_t i = 0; i < pairs.size(); i += 4) {
        RTCRay ray = {};
        unsigned x = pairs[i], y = pairs[i + 1], to_x = pairs[i + 2], to_y = pairs[i + 3];
        ray.org_x = x; ray.org_z = y; ray.org_y = z[size_t(y) * n + x] + ABOVE;
        ray.dir_x = float(to_x) - x; ray.dir_z = float(to_y) - y;
        ray.dir_y = z[size_t(to_y) * n + to_x] + ABOVE - ray.org_y;
        ray.tfar = 1; ray.mask = -1;
        lines.push_back(ray);
    }
    std::vector<RTCRayHit> primary;
    for (size_t i = 0; i < rays.size(); i += 6) {
        RTCRayHit hit = {};
        hit.ray.org_x = rays[i]; hit.ray.org_z = rays[i + 1]; hit.ray.org_y = rays[i + 2];
        hit.ray.dir_x = rays[i + 3]; hit.ray.dir_z = rays[i + 4]; hit.ray.dir_y = rays[i + 5];
        hit.ray.tfar = 1e30f; hit.ray.mask = -1; hit.hit.geomID = RTC_INVALID_GEOMETRY_ID;
        primary.push_back(hit);
    }
    RTCScene scene = nullptr;
    char command[16];
    while (scanf("%15s", command) == 1) {
        RTCIntersectContext context;
        rtcInitIntersectContext(&context);
        int64_t found = 0;
        double start = now_ms();
        if (!strcmp(command, "build")) {
            if (scene) rtcReleaseScene(scene);
            bytes = 0;
            start = now_ms();
            scene = build(device, z, n, as_grid);
            found = bytes;
        } else if (!strcmp(command, "los")) {
            for (RTCRay ray : lines) { rtcOccluded1(scene, &context, &ray); found += ray.tfar < 0; }
        } else {
            context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
            for (RTCRayHit hit : primary) { rtcIntersect1(scene, &context, &hit); found += hit.hit.geomID != RTC_INVALID_GEOMETRY_ID; }
        }
        printf("%.6f %lld\n", now_ms() - start, (long long)found);
        fflush(stdout);
    }
}
