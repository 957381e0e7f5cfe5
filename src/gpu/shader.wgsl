// Draws the items of a draw list that are alike, by the formulas of src/draw/lighting.rs and src/draw/ground.rs.
//
// Two families of entry points share everything but their outputs: `color` writes the lit surface,
// `feature` writes the feature's number and the depth in meters. Depth is reversed: with the clip planes
// folded into A and B, the buffer holds A / d − B, which is 1 at the near plane and 0 at the far plane, so
// that a float buffer resolves equal ratios of depth equally well everywhere. With parallel rays it holds A − B · d.
//
// No branch depends on the constants of a frame alone: for such a shader, Mesa's Vulkan on the processor writes the constants
// into its code and compiles it anew for every frame. Where one decides, both sides are computed, or what decides is joined
// with what changes from pixel to pixel by an operator that has no branch of its own.

struct Frame {
    eye: vec4f,           // xyz, 1 where rays are parallel
    right: vec4f,         // xyz, 1 / tangent of half the horizontal field of view, or 1 / half the width in meters
    up: vec4f,            // xyz, the same of the vertical field of view, or of the height
    forward: vec4f,       // xyz
    depth: vec4f,         // A, B of the depth buffer; width and height of the picture
    tile: vec4f,          // clip coordinates of the picture in those of the tile: factors, what is added per unit of w
    tile_first: vec4f,    // column and row of the tile's first pixel in the picture
    to_sun: vec4f,        // xyz
    sun: vec4f,           // rgb
    sky: vec4f,           // rgb
    bounce: vec4f,        // rgb
    haze: vec4f,          // rgb, 1 / distance
    zenith: vec4f,        // rgb, distance at which haze begins
    studio_top: vec4f,    // rgb, 1 where the backdrop is the studio's
    studio_bottom: vec4f, // rgb, Backdrop::HORIZON
    sides: array<vec4f, 4>, // xyz toward a side light, its share
    bathymetry: array<vec4f, 9>, // rgb of water over a bed at a height, rising
    undergrowth: vec4f,   // rgb of ground under trees, and the most of it
    shallow: vec4f,       // rgb of water along the shore, WaterColor::OFF_SHORE
    open: vec4f,          // rgb of open water
    ground: vec4f,        // x and y of the south-west post, cell's width and height
    ground_size: vec4u,   // ramp stops, stops in a row of the ramp's texture, levels of the ground, level of the forms
    imagery: vec4f,       // x and y of the south-west corner of the draped picture, 1 / its width and height
    imagery_size: vec4f,  // its columns and rows; 1 where there is one; 1 where it is shaded
    cover: vec4f,         // tree line and snow line in meters, true rise over drawn (0: no cover), 1 where the north is shady
    cover_more: vec4f,    // moisture; cell of the ground in meters; 1 where it has forms too small for that; share of the fill
    cover_colors: array<vec4f, 7>, // rgb of luminance 1, factor on the tint's luminance: woods, meadow, scree, rock, snow, crops, soil
    contour: vec4f,       // rgb, strength
    contour_shape: vec4f, // interval in meters (0: none), width in pixels, every how many is heavier; 1 where the ground has a grain
    contour_lit: vec4f,   // rgb of lines toward the light, 1 where lines are illuminated
    contour_turn: vec4f,  // Contours::LIT_WIDTH and LIT_TURN
    ground_levels: array<vec4u, 24>, // columns, rows, first post of all; binary logarithm of the texels in a row
    ground_windows: array<vec4u, 8>, // column and row of the first post, columns, rows
    window_size: vec4u,   // number of windows; rows of the texture for each
    ground_tops: array<vec4u, 24>, // columns and rows of blocks, first texel of all; number of levels (0: no ground)
    relief: vec4f,        // world Z per meter of elevation; how strongly forms show in the shade
    shadows: array<ShadowView, 2>, // of the sun, of the sky
}

// ShadowMap.
struct ShadowView {
    eye: vec4f,              // xyz of the eye that the map was made for: a map outlives frames
    forward: vec4f,          // xyz of its viewing direction
    across: array<vec4f, 2>, // xyz of the axes across the light; texel per depth, base-2 logarithm of level 0's texel
    toward: vec4f,           // xyz toward the light, number of levels; 0 where there is no map
    levels: array<vec4f, 8>, // corner of the first texel, texel in meters
    tables: array<vec4u, 8>, // columns and rows of pages, first entry in `shadow_pages`
}

// The most readings of the ground along the longer side of a pixel seen at a grazing angle.
const MOST_TAPS = 8.0;
// The same of plain ground.
const PLAIN_TAPS = 2.0;
// Masks are read this many mip levels finer than colors, since each of a pixel's samples reads its own.
const MASK_LEVEL_BIAS = -1.0;

@group(0) @binding(0) var<uniform> frame: Frame;
// One texel a post, row by row and level by level: height, slope east and slope north as bits of f32; the visibilities of
// the sun in 11 bits and of the sky in 11, from 0 to 2, and water in 10, from -1 (woods) to 1. Then the tops of blocks.
@group(0) @binding(1) var ground_posts: texture_2d<u32>;
// One texel a stop of the ramp: linear rgb, height.
@group(0) @binding(2) var ramp_stops: texture_2d<f32>;
// One texel a page: its number from 1 or 0, the greatest heights of solids and of the ground as bits of f32.
@group(0) @binding(3) var shadow_pages: texture_2d<u32>;
// The heights of solids and of the ground, page by page.
@group(0) @binding(4) var shadow_texels: texture_2d<f32>;
// The draped picture, colors multiplied by alpha.
@group(0) @binding(5) var imagery_texture: texture_2d<f32>;
@group(0) @binding(6) var imagery_sampler: sampler;

// The material of the fragment that is drawn, and the texel it shows.
var<private> material: Surface;
var<private> texel: vec4f;

// The part of `nearer − 1` that counts with parallel rays: that of the CPU renderer's tolerances.
const PARALLEL_NEARER = 0.05;

// By how much an item counts as nearer than it is: 1, or a little more for what is draped.
override nearer: f32 = 1.0;
// The same as a part of a pixel: what its depth changes by over that part is added. Covers the grid that
// hardware moves corners to, which tilts a drape against the ground where both are seen edge-on.
override nearer_px: f32 = 0.0;
// Whether any of the materials drawn has a texture: reading one costs even where it is not shown.
override textured: bool = true;
// The parts of the shading that anything drawn can show: bits of the constants below. Software drivers run both sides of
// a branch that is not decided when the pipeline is made.
override parts: u32 = 0xffffffffu;

const GROUND_COLOR_PART = 1u;
const GROUND_LIGHT_PART = 2u;
const OWN_LIGHT_PART = 4u;
const HATCHING_PART = 8u;
const WATER_PART = 16u;
const NATURAL_PART = 32u;
const IMAGERY_PART = 64u;
const COVER_PART = 128u;
const GRAIN_PART = 256u;
const CONTOURS_PART = 512u;
const SUN_SHADOWS_PART = 1024u;
const SKY_SHADOWS_PART = 2048u;
const HAZE_PART = 4096u;
const MAP_WATER_PART = 8192u;
const EDGES_PART = 16384u;
const WINDOWS_PART = 32768u;
const AREA_PART = 65536u;
const WATER_RELIEF_PART = 131072u;
const PLAIN_SHADOWS_PART = 262144u;
const PLAIN_GROUND_PART = 524288u;

struct Varying {
    @invariant @builtin(position) clip: vec4f,
    @location(0) world: vec3f,
    @location(1) normal: vec3f,
    @location(2) uv: vec2f,
    @location(3) color: vec4f,
    @location(4) @interpolate(flat) feature: u32,
    @location(5) @interpolate(flat) material: u32,
}

fn linear_from_srgb(value: vec3f) -> vec3f {
    let low = value / 12.92;
    let high = pow((value + 0.055) / 1.055, vec3f(2.4));
    return select(high, low, value <= vec3f(0.04045));
}

// A corner's clip coordinates in the whole picture as those in the tile that is drawn.
fn in_tile(across: vec2f, w: f32) -> vec2f {
    return across * frame.tile.xy + frame.tile.zw * w;
}

fn is_parallel() -> bool {
    return frame.eye.w > 0.5;
}

// From the eye to a place, or along the parallel rays.
fn from_eye(world: vec3f) -> vec3f {
    return select(world - frame.eye.xyz, frame.forward.xyz, is_parallel());
}

// A corner in world space as the picture has it.
fn projected(world: vec3f) -> Varying {
    // Relative to the eye first: far from the origin a product of matrices would lose the low digits.
    let offset = world - frame.eye.xyz;
    let depth = dot(offset, frame.forward.xyz);
    var out: Varying;
    let across = vec2f(dot(offset, frame.right.xyz) * frame.right.w, dot(offset, frame.up.xyz) * frame.up.w);
    let raised = (nearer - 1.0) * PARALLEL_NEARER;
    let parallel = vec2f(frame.depth.x - frame.depth.y * depth + raised, 1.0);
    let central = vec2f(frame.depth.x * nearer - frame.depth.y * depth, depth);
    let depth_and_w = select(central, parallel, is_parallel());
    out.clip = vec4f(in_tile(across, depth_and_w.y), depth_and_w);
    out.world = world;
    return out;
}

fn with_surface(seen: Varying, normal: vec3f, corner: Corner, owner: Owner) -> Varying {
    var out = seen;
    out.normal = normal;
    out.uv = corner.uv;
    out.color = vec4f(linear_from_srgb(corner.color.rgb), corner.color.a);
    out.feature = owner.feature;
    out.material = owner.material;
    return out;
}

// Corners of many items in world space.
@vertex
fn merged_vertex(corner: Corner, owner: Owner) -> Varying {
    return with_surface(projected(corner.position), corner.normal, corner, owner);
}

// Corners of what lies on the ground.
struct Draped {
    @location(0) position: vec3f,
    @location(1) uv: vec2f,
    @location(2) color: vec4f, // linear
    @location(3) normal: vec4f,
    @location(4) material: u32,
}

@vertex
fn draped_vertex(corner: Draped) -> Varying {
    var out = projected(corner.position);
    out.normal = corner.normal.xyz;
    out.uv = corner.uv;
    out.color = corner.color;
    out.material = corner.material;
    return out;
}

// Corners of a mesh that is drawn at many places.
@vertex
fn placed_vertex(corner: Corner, owner: Owner, place: Place) -> Varying {
    let world_from_mesh = mat4x4f(place.x_axis, place.y_axis, place.z_axis, place.origin);
    let world = (world_from_mesh * vec4f(corner.position, 1.0)).xyz;
    let normal = (world_from_mesh * vec4f(corner.normal, 0.0)).xyz;
    return with_surface(projected(world), normal, corner, owner);
}

// Corners of a patch of bare ground: the first material, FeatureId::GROUND.
@vertex
fn patch_vertex(@location(0) position: vec3f) -> Varying {
    var out = projected(position);
    out.normal = vec3f(0.0, 0.0, 1.0);
    out.color = vec4f(1.0);
    out.feature = 1u;
    return out;
}

// The same where nothing but the depth is drawn.
@vertex
fn patch_depth(@location(0) position: vec3f) -> @invariant @builtin(position) vec4f {
    return projected(position).clip;
}

struct Post {
    height: f32,
    slope: vec2f,
    visibility: vec3f, // of the sun, of the sky; under water
    gradient: vec2f,   // rise of the height itself, meters per meter
    water: vec2f,      // rise of the water, per meter
}

fn post_at(at: vec2u, level: u32) -> Post {
    let place = frame.ground_levels[level];
    return unpacked(ground_texel(place.z + at.y * place.x + at.x));
}

fn ground_texel(index: u32) -> vec4u {
    let row_bits = frame.ground_levels[0].w;
    return textureLoad(ground_posts, vec2u(index & ((1u << row_bits) - 1u), index >> row_bits), 0);
}

fn unpacked(texel: vec4u) -> Post {
    let shares = vec3f(vec3u(texel.w, texel.w >> 11u, texel.w >> 22u) & vec3u(2047u, 2047u, 1023u));
    let visibility = shares / vec3f(2047.0, 1023.0, 511.0) - vec3f(0.0, 0.0, 1.0);
    return Post(bitcast<f32>(texel.x), bitcast<vec2f>(texel.yz), visibility, vec2f(0.0), vec2f(0.0));
}

fn mix_post(a: Post, b: Post, t: f32) -> Post {
    return Post(
        a.height + (b.height - a.height) * t,
        a.slope + (b.slope - a.slope) * t,
        a.visibility + (b.visibility - a.visibility) * t,
        a.gradient + (b.gradient - a.gradient) * t,
        a.water + (b.water - a.water) * t,
    );
}

// GroundMap::sample on one level; posts of level n lie 2^n of the map's cells apart.
fn ground_on_level(at: vec2f, level: u32) -> Post {
    let scale = 1.0 / f32(1u << level);
    let last = vec2f(frame.ground_levels[0].xy - 1u);
    let grid = clamp((at - frame.ground.xy) / frame.ground.zw, vec2f(0.0), last) * scale;
    let size = frame.ground_levels[level].xy;
    let first = min(vec2u(grid), max(size, vec2u(2u)) - 2u);
    let next = min(first + 1u, size - 1u);
    let sw = post_at(first, level);
    let se = post_at(vec2u(next.x, first.y), level);
    let nw = post_at(vec2u(first.x, next.y), level);
    let ne = post_at(next, level);
    return between(sw, se, nw, ne, grid - vec2f(first), scale);
}

// Between four posts, of which `scale` lie on a cell of the map.
fn between(sw: Post, se: Post, nw: Post, ne: Post, part: vec2f, scale: f32) -> Post {
    var post = mix_post(mix_post(sw, se, part.x), mix_post(nw, ne, part.x), part.y);
    let east = mix(se.height - sw.height, ne.height - nw.height, part.y);
    let north = mix(nw.height - sw.height, ne.height - se.height, part.x);
    post.gradient = vec2f(east, north) / frame.ground.zw * scale;
    let wet = vec4f(sw.visibility.z, se.visibility.z, nw.visibility.z, ne.visibility.z);
    post.water = vec2f(mix(wet.y - wet.x, wet.w - wet.z, part.y), mix(wet.z - wet.x, wet.w - wet.y, part.x))
        / frame.ground.zw * scale;
    return post;
}

// The ground over a pixel that spans `right` and `down`: near the eye one reading of the map itself, far
// away several readings of a coarser level along the pixel's longer side, since one would sparkle. Plain ground is read at
// few places of one level: each post takes a software driver as long as a hundred operations.
fn ground_at(at: vec2f, right: vec2f, down: vec2f) -> Post {
    let across = length(right / frame.ground.zw);
    let along = length(down / frame.ground.zw);
    let axis = select(down, right, across > along);
    let longer = max(across, along);
    var windows = 0.0;
    if has(WINDOWS_PART) {
        windows = windows_over(at);
    }
    let is_plain = has(PLAIN_GROUND_PART);
    let most_taps = select(MOST_TAPS, PLAIN_TAPS, is_plain);
    let taps = clamp(ceil(longer / max(min(across, along), exp2(-windows))), 1.0, most_taps);
    let most = f32(frame.ground_size.z - 1u);
    let between_levels = clamp(log2(max(longer / taps, 1e-6)), -windows, most);
    let level = select(between_levels, round(between_levels), is_plain);
    let lower = i32(floor(level));
    let part = level - f32(lower);
    var sum = Post(0.0, vec2f(0.0), vec3f(0.0), vec2f(0.0), vec2f(0.0));
    for (var tap = 0.0; tap < taps; tap += 1.0) {
        let here = at + axis * ((tap + 0.5) / taps - 0.5);
        var post = ground_at_level(here, lower);
        if !is_plain && part > 0.0 {
            post = mix_post(post, ground_at_level(here, lower + 1), part);
        }
        sum.height += post.height / taps;
        sum.slope += post.slope / taps;
        sum.visibility += post.visibility / taps;
        sum.gradient += post.gradient / taps;
        sum.water += post.water / taps;
    }
    return sum;
}

fn stop_at(index: u32) -> vec4f {
    let columns = frame.ground_size.y;
    return textureLoad(ramp_stops, vec2u(index % columns, index / columns), 0);
}

// Ramp::linear_at.
fn ramp_at(height: f32) -> vec3f {
    var low = 0u;
    var high = frame.ground_size.x;
    while low < high {
        let middle = (low + high) / 2u;
        if stop_at(middle).w <= height {
            low = middle + 1u;
        } else {
            high = middle;
        }
    }
    let after = stop_at(min(low, frame.ground_size.x - 1u));
    let before = stop_at(max(low, 1u) - 1u);
    let between = low > 0u && low < frame.ground_size.x;
    let part = select(0.0, (height - before.w) / (after.w - before.w), between);
    return mix(before.rgb, after.rgb, part);
}

// The ramp of src/draw/bathymetry.rs.
fn water_at(height: f32) -> vec3f {
    var above = 1u;
    while above < 8u && frame.bathymetry[above].w <= height {
        above += 1u;
    }
    let low = frame.bathymetry[above - 1u];
    let high = frame.bathymetry[above];
    return mix(low.rgb, high.rgb, clamp((height - low.w) / (high.w - low.w), 0.0, 1.0));
}

// The draped picture over a pixel: linear rgb, the share of the ground that it covers.
fn draped_at(at: vec2f, right: vec2f, down: vec2f) -> vec4f {
    let part = (at - frame.imagery.xy) * frame.imagery.zw;
    let is_within = all(part >= vec2f(0.0)) && all(part <= vec2f(1.0));
    if (frame.imagery_size.z < 0.5) | !is_within {
        return vec4f(0.0);
    }
    let texel = 0.5 / frame.imagery_size.xy;
    let uv = clamp(vec2f(part.x, 1.0 - part.y), texel, 1.0 - texel);
    let per_m = vec2f(1.0, -1.0) * frame.imagery.zw;
    let color = textureSampleGrad(imagery_texture, imagery_sampler, uv, right * per_m, down * per_m);
    return vec4f(color.rgb / max(color.a, 1e-4), color.a);
}

// The functions of src/draw/ground_grain.rs.
fn mixed_bits(at: vec2u) -> vec2u {
    var x = at.x * 1664525u + 1013904223u;
    var y = at.y * 1664525u + 1013904223u;
    x += y * 1664525u;
    y += x * 1664525u;
    x ^= x >> 16u;
    y ^= y >> 16u;
    x += y * 1664525u;
    y += x * 1664525u;
    x ^= x >> 16u;
    y ^= y >> 16u;
    return vec2u(x, y);
}

fn grain_hash(at: vec2u) -> f32 {
    return f32(mixed_bits(at).x >> 8u) / 8388608.0 - 1.0;
}

fn grain_noise(at: vec2f) -> f32 {
    let cell = floor(at);
    let part = at - cell;
    let smoothed = part * part * (3.0 - 2.0 * part);
    let corner = vec2u(vec2i(cell));
    let south = mix(grain_hash(corner), grain_hash(corner + vec2u(1u, 0u)), smoothed.x);
    let north = mix(grain_hash(corner + vec2u(0u, 1u)), grain_hash(corner + vec2u(1u, 1u)), smoothed.x);
    return mix(south, north, smoothed.y);
}

// A wave's part of the grain.
fn grain_wave(at: vec2f, pixel_m: f32, wave_m: f32, share: f32) -> f32 {
    let shown = clamp(2.0 * wave_m / (GRAIN_WAVE_PX * pixel_m) - 1.0, 0.0, 1.0);
    if shown <= 0.0 {
        return 0.0;
    }
    return share * shown * grain_noise(at / wave_m);
}

fn grain_waves(at: vec2f, pixel_m: f32, waves_m: vec3f, shares: vec3f) -> f32 {
    return grain_wave(at, pixel_m, waves_m.x, shares.x) + grain_wave(at, pixel_m, waves_m.y, shares.y)
        + grain_wave(at, pixel_m, waves_m.z, shares.z);
}

fn ground_grain(at: vec2f, pixel_m: f32, rise: f32) -> f32 {
    let sum = grain_waves(at, pixel_m, GRAIN_WAVES_M, GRAIN_SHARES);
    return 1.0 + (GRAIN_LEVEL + (GRAIN_STEEP - GRAIN_LEVEL) * clamp(rise, 0.0, 1.0)) * sum;
}

// CoverNoise.
struct Noise {
    uneven: f32,
    patches: f32,
    fine: f32,
    form: vec2f,
    ridge: f32,
    at: vec2f,
    longest_m: f32,
}

fn noise_values(at: vec2u) -> vec2f {
    var bits = at.x * 2376512323u + at.y * 3625334849u;
    bits = (bits ^ (bits >> 15u)) * 739982445u;
    bits = (bits ^ (bits >> 12u)) * 695872825u;
    bits ^= bits >> 15u;
    return vec2f(vec2u(bits & 65535u, bits >> 16u)) / 32768.0 - 1.0;
}

// About the cosine of so many turns, and its rise per turn.
fn gully_wave(turns: f32) -> vec2f {
    let past = turns - round(turns);
    let part = 2.0 * abs(past);
    let rise = 24.0 * part * (1.0 - part);
    return vec2f(1.0 - 2.0 * part * part * (3.0 - 2.0 * part), select(-rise, rise, past < 0.0));
}

fn cover_noise(at: vec2f, mean_pixel_m: f32, longest_m: f32, ground_rise: vec2f) -> Noise {
    let ground_steep = length(ground_rise);
    let gullies = NOISE_MOST_GULLIES * smoothstep(NOISE_GULLY_RISE.x, NOISE_GULLY_RISE.y, ground_steep);
    var sum = Noise(0.0, 0.0, 0.0, vec2f(0.0), 0.0, at, longest_m);
    var wave_m = NOISE_FIRST_M;
    var faint = 1.0;
    var turn = vec2f(1.0, 0.0);
    var wider = vec2f(0.0);
    let widest = NOISE_FORM_CELLS * frame.cover_more.y;
    for (var octave = 0.0; octave < NOISE_OCTAVES; octave += 1.0) {
        let shown = clamp(2.0 * wave_m / (NOISE_WAVE_PX * mean_pixel_m) - 1.0, 0.0, 1.0);
        // Finer waves show less.
        if !(shown > 0.0) {
            break;
        }
        let place = vec2f(turn.x * at.x - turn.y * at.y, turn.y * at.x + turn.x * at.y) / wave_m + NOISE_BENT * wider;
        let cell = floor(place);
        let part = place - cell;
        let smoothed = part * part * (3.0 - 2.0 * part);
        let steep = 6.0 * part * (1.0 - part);
        let corner = vec2u(vec2i(cell));
        let sw = noise_values(corner);
        let se = noise_values(corner + vec2u(1u, 0u));
        let nw = noise_values(corner + vec2u(0u, 1u));
        let ne = noise_values(corner + vec2u(1u, 1u));
        let south = mix(sw, se, smoothed.x);
        let north = mix(nw, ne, smoothed.x);
        let value = mix(south, north, smoothed.y);
        let rise = vec2f(mix(se.x - sw.x, ne.x - nw.x, smoothed.y), north.x - south.x) * steep;
        wider = value;
        let share = NOISE_SHARE * shown;
        let is_fine = octave >= NOISE_FIRST_FINE;
        faint *= select(1.0, NOISE_FAINTER, is_fine);
        sum.uneven += share * faint * value.x;
        sum.patches += select(share * value.y, 0.0, is_fine);
        sum.fine += select(0.0, share * value.y, is_fine);
        let within = clamp((widest - wave_m) / (0.75 * widest), 0.0, 1.0);
        let branched = ground_rise + NOISE_BRANCHED * ground_steep * sum.form;
        let contour = vec2f(-branched.y, branched.x) / max(length(branched), 1e-6);
        let level = vec2f(turn.x * contour.x - turn.y * contour.y, turn.y * contour.x + turn.x * contour.y);
        let along = NOISE_GULLIES * (part.x * level.x + part.y * level.y);
        let waves_sw = gully_wave(along + 0.5 * (sw.x + 1.0));
        let waves_se = gully_wave(along - NOISE_GULLIES * level.x + 0.5 * (se.x + 1.0));
        let waves_nw = gully_wave(along - NOISE_GULLIES * level.y + 0.5 * (nw.x + 1.0));
        let waves_ne = gully_wave(along - NOISE_GULLIES * (level.x + level.y) + 0.5 * (ne.x + 1.0));
        let waves_south = mix(waves_sw, waves_se, smoothed.x);
        let waves_north = mix(waves_nw, waves_ne, smoothed.x);
        let wave = mix(waves_south, waves_north, smoothed.y);
        let blend = vec2f(mix(waves_se.x - waves_sw.x, waves_ne.x - waves_nw.x, smoothed.y), waves_north.x - waves_south.x);
        let gully_rise = NOISE_GULLY_HEIGHT * (blend * steep + NOISE_GULLIES * wave.y * level);
        let ridged = mix(value.x, NOISE_GULLY_HEIGHT * wave.x, gullies);
        let ridged_rise = mix(rise, gully_rise, gullies);
        let away = sqrt(ridged * ridged + NOISE_CREST * NOISE_CREST);
        let crest = -ridged / away;
        let back = vec2f(
            turn.x * ridged_rise.x + turn.y * ridged_rise.y,
            turn.x * ridged_rise.y - turn.y * ridged_rise.x,
        );
        sum.form += back * (share * faint * within * crest);
        sum.ridge += share * faint * within * 2.0 * (NOISE_MEAN_AWAY - away);
        wave_m *= NOISE_FINER;
        turn = vec2f(NOISE_TURN.x * turn.x - NOISE_TURN.y * turn.y, NOISE_TURN.y * turn.x + NOISE_TURN.x * turn.y);
    }
    return sum;
}

// The functions of src/draw/ground_cover.rs.
fn covered_by(color: vec3f, tint: vec3f, own: f32, cover: vec4f, hue: f32, share: f32) -> vec3f {
    return mix(color, mix(tint, cover.rgb * own, hue) * cover.w, COVER_MOST * share);
}

fn strata_wave(height: f32, change: f32, uneven: f32, wave_m: f32) -> f32 {
    let shown = clamp(2.0 * wave_m / (GRAIN_WAVE_PX * max(change, 1e-6)) - 1.0, 0.0, 1.0);
    return shown * grain_noise(vec2f(height / wave_m + 2.0 * uneven, 0.5));
}

// The function of src/draw/field_plots.rs.
fn field_tone(at: vec2f, pixel_m: f32) -> f32 {
    let shown = area_shown(FIELD_M.x, pixel_m);
    if shown <= 0.0 {
        return 0.0;
    }
    let parcel = area_parcel(at, FIELD_M.x);
    let place = area_turned(at, normalize(parcel.own + vec2f(1e-3, 0.0)));
    let whole = noise_values(parcel.cell + u32(AREA_SALTS.y)).x;
    let inside = clamp(parcel.inside_m / pixel_m + 0.5, 0.0, 1.0);
    return shown * inside * (AREA_PARCEL_TONE * whole + area_strip(place, FIELD_M.y, 0.0, pixel_m, parcel.cell).x);
}

fn with_cover(tint: vec3f, post: Post, change: f32, noise: Noise) -> vec3f {
    let slope = post.slope * frame.cover.z;
    let shade = clamp(-slope.y * frame.cover.w, -1.0, 1.0);
    let height = post.height + COVER_UNEVEN_M * noise.uneven + COVER_ASPECT_M * shade;
    let rise = length(slope) + COVER_UNEVEN_RISE * noise.uneven;
    let hollow = clamp(1.0 - post.visibility.y, 0.0, 1.0);
    let moist = frame.cover_more.x + dot(COVER_MOISTER, vec4f(post.height, shade, hollow, noise.uneven));
    let above_trees = smoothstep(frame.cover.x - COVER_MEADOW_M.x, frame.cover.x, height);
    let below_snow = 1.0 - smoothstep(frame.cover.y - COVER_MEADOW_M.y, frame.cover.y, height);
    let green = smoothstep(COVER_WOODS_MOISTURE.x, COVER_WOODS_MOISTURE.y, moist);
    let copses = smoothstep(COVER_COPSES.x, COVER_COPSES.y, noise.patches + noise.fine);
    let sloping = smoothstep(COVER_WOODS_RISE.x, COVER_WOODS_RISE.y, rise);
    let wild = smoothstep(COVER_WILD.x * frame.cover.x, COVER_WILD.y * frame.cover.x, height);
    let woods = (1.0 - above_trees) * green * mix(copses, 1.0, max(sloping, COVER_WILD_WOODS * wild));
    let fields = COVER_FIELD_MEADOW * green * (1.0 - wild) * clamp(0.5 + noise.patches, 0.0, 1.0);
    let meadow = mix(fields, below_snow, above_trees);
    let bare = mix(COVER_DRY_RISE, 1.0, smoothstep(0.0, COVER_WOODS_MOISTURE.y, moist));
    let scree = max(above_trees, 1.0 - green) * smoothstep(COVER_SCREE_RISE.x * bare, COVER_SCREE_RISE.y * bare, rise);
    let rock = smoothstep(COVER_ROCK_RISE.x * bare, COVER_ROCK_RISE.y * bare, rise);
    let half = COVER_MEADOW_M.z;
    let snow = smoothstep(frame.cover.y - half, frame.cover.y + half, height) * (1.0 - rock);
    let own = dot(tint, vec3f(0.2126, 0.7152, 0.0722));
    let wet = smoothstep(COVER_HUE_MOISTURE.x, COVER_HUE_MOISTURE.y, frame.cover_more.x);
    let climb = smoothstep(COVER_HUE_CLIMB.x * frame.cover.x, COVER_HUE_CLIMB.y * frame.cover.x, height) * wet;
    let grown = mix(COVER_HUE.x, COVER_HUE.y, climb);
    var color = covered_by(tint, tint, own, frame.cover_colors[1], mix(COVER_HUE.x, grown, COVER_MEADOW_CLIMB), meadow);
    let farmed = smoothstep(COVER_FARMED_MOISTURE.x, COVER_FARMED_MOISTURE.y, moist)
        * (1.0 - smoothstep(COVER_FARMED_RISE.x, COVER_FARMED_RISE.y, rise)) * (1.0 - wild) * (1.0 - above_trees);
    if farmed > 0.0 {
        var plot = 0.0;
        if !has(PLAIN_GROUND_PART) {
            plot = field_tone(noise.at, max(noise.longest_m, COVER_LEAST_PIXEL_M));
        }
        let tone = clamp(plot + COVER_FARMED_PATCHES * noise.patches, -1.0, 1.0);
        let other = select(frame.cover_colors[6], frame.cover_colors[1], tone < 0.0);
        color = covered_by(color, tint, own, mix(frame.cover_colors[5], other, abs(tone)), COVER_HUE.x, farmed);
    }
    color = covered_by(color, tint, own, frame.cover_colors[0], grown, woods);
    color = covered_by(color, tint, own, frame.cover_colors[2], COVER_HUE.x, scree);
    color = covered_by(color, tint, own, frame.cover_colors[3], COVER_HUE.x, rock);
    color = covered_by(color, frame.cover_colors[4].rgb * own, own, frame.cover_colors[4], COVER_HUE.x, snow);
    let open = max(1.0 - snow, 0.0);
    let wooded = woods * (1.0 - rock) * open;
    let strata = strata_wave(post.height, change, noise.uneven, COVER_STRATA_M.x)
        + strata_wave(post.height, change, noise.uneven, COVER_STRATA_M.y)
        + strata_wave(post.height, change, noise.uneven, COVER_STRATA_M.z);
    let layered = max(rock, scree * (1.0 - green)) * open;
    let ridges = COVER_RIDGES * noise.ridge * min(length(slope), 1.0) * frame.cover_more.z;
    let bushy = (1.0 - above_trees) * (1.0 - woods) * (1.0 - rock) * (1.0 - farmed) * open;
    let shrubs = bushy * smoothstep(COVER_SHRUBS.x, COVER_SHRUBS.y, noise.fine + 0.5 * noise.patches);
    color = mix(color, frame.cover_colors[0].rgb * (own * frame.cover_colors[0].w), COVER_SHRUB_SHARE * shrubs);
    let rough = mix(COVER_TUFTS, COVER_CROWNS, wooded);
    let texture = (COVER_PATCHES * noise.patches + rough * noise.fine) * open + ridges;
    return color * max(1.0 + texture + COVER_STRATA * layered * strata, 0.3);
}

// GroundCover::form.
fn small_form(post: Post, noise: Noise) -> vec2f {
    let rise = min(length(post.slope), 1.0);
    let dry = max(1.0 - 4.0 * max(post.visibility.z, 0.0), 0.0);
    let level = COVER_FORM_LEVEL / max(frame.cover.z, 1e-6);
    return noise.form * ((level + COVER_FORM_RISE * rise) * dry * frame.cover_more.z);
}

// Lines `spacing` meters apart vanish before they run together.
fn contour_fade(spacing: f32, per_pixel: f32) -> f32 {
    return clamp((spacing / per_pixel - 4.0) / 6.0, 0.0, 1.0);
}

// Contours: how much of a pixel a line `width_px` wide covers, where height changes by `per_pixel` across one.
fn contour_cover(height: f32, per_pixel: f32, width_px: f32) -> f32 {
    let interval = frame.contour_shape.x;
    if !((interval > 0.0) & (per_pixel > interval * 1e-6)) {
        return 0.0;
    }
    let line = round(height / interval);
    let every = frame.contour_shape.z;
    let heavy = line - every * floor(line / every) < 0.5;
    let minor = contour_fade(interval, per_pixel);
    let width = width_px * select(1.0, 1.0 + minor, heavy);
    let strength = select(minor, contour_fade(interval * every, per_pixel), heavy);
    return clamp(width * 0.5 + 0.5 - abs(height - line * interval) / per_pixel, 0.0, 1.0) * strength;
}

const MOST_WINDOW = 12; // more texels than any radius of shadows reads

// A point as a map sees it: its level, its place in texels, its height toward the light.
struct ShadowPlace {
    table: vec4u,
    texel_m: f32,
    at: vec2f,
    height: f32,
}

fn turned(map: u32, v: vec3f) -> vec3f {
    return vec3f(
        dot(frame.shadows[map].across[0].xyz, v),
        dot(frame.shadows[map].across[1].xyz, v),
        dot(frame.shadows[map].toward.xyz, v),
    );
}

fn shadow_place(map: u32, offset: vec3f) -> ShadowPlace {
    let texel = max(dot(offset, frame.shadows[map].forward.xyz) * frame.shadows[map].across[0].w, 1.17549435e-38);
    let exponent = i32(bitcast<u32>(texel) >> 23u) - 127;
    let above = exponent - i32(frame.shadows[map].across[1].w);
    let index = clamp(above, 0, i32(frame.shadows[map].toward.w) - 1);
    let level = frame.shadows[map].levels[index];
    let here = turned(map, offset);
    return ShadowPlace(frame.shadows[map].tables[index], level.z, (here.xy - level.xy) / level.z, here.z);
}

fn shadow_page(table: vec4u, page: vec2i) -> vec4u {
    if any(page < vec2i(0)) || any(page >= vec2i(table.xy)) {
        return vec4u(0u, bitcast<u32>(f32(NOTHING)), bitcast<u32>(f32(NOTHING)), 0u);
    }
    let index = table.z + u32(page.y) * table.x + u32(page.x);
    return textureLoad(shadow_pages, vec2u(index % TABLE_COLUMNS, index / TABLE_COLUMNS), 0);
}

// The greatest heights around a point.
fn shadow_highest(place: ShadowPlace) -> vec2f {
    return bitcast<vec2f>(shadow_page(place.table, vec2i(floor(place.at / f32(PAGE)))).yz);
}

// A texel's heights of solids and of the ground.
fn shadow_texel(table: vec4u, at: vec2i) -> vec2f {
    let page = vec2i(floor(vec2f(at) / f32(PAGE)));
    let number = shadow_page(table, page).x;
    if number == 0u {
        return vec2f(NOTHING);
    }
    let corner = vec2u((number - 1u) % PAGE_COLUMNS, (number - 1u) / PAGE_COLUMNS) * u32(PAGE);
    return textureLoad(shadow_texels, corner + vec2u(at - page * PAGE), 0).xy;
}

fn shadow_height(heights: vec2f, on_solid: bool) -> f32 {
    return select(heights.x, max(heights.x, heights.y), on_solid);
}

// The weight of all texels within `radius`, of those that cast, and of these times their height.
fn shadow_cover(place: ShadowPlace, radius: f32, step: i32, rise: vec2f, bias: f32, on_solid: bool) -> vec3f {
    let first = vec2i(ceil(place.at - 0.5 - radius));
    let low = first + (first & vec2i(step - 1));
    // Bounded, since a place may be NaN.
    let high = min(vec2i(floor(place.at - 0.5 + radius)), low + MOST_WINDOW);
    var sum = vec3f(0.0);
    for (var y = low.y; y <= high.y; y += step) {
        for (var x = low.x; x <= high.x; x += step) {
            let aside = vec2f(vec2i(x, y)) + 0.5 - place.at;
            let tent = max(1.0 - abs(aside) / radius, vec2f(0.0));
            let top = shadow_height(shadow_texel(place.table, vec2i(x, y)), on_solid);
            let height = top - (place.height + dot(rise, aside));
            let share = clamp((height - bias) / (FULL_TEXELS * place.texel_m), 0.0, 1.0) * tent.x * tent.y;
            sum += vec3f(tent.x * tent.y, share, share * height);
        }
    }
    return sum;
}

fn face_rise(normal: vec3f) -> vec2f {
    let toward = select(max(normal.z, 1e-30), min(normal.z, -1e-30), normal.z < 0.0);
    let rise = -normal.xy / toward;
    let steepness = length(rise);
    return rise * min(1.0, STEEPEST / max(steepness, 1e-30));
}

// ShadowMap::sun.
fn sun_share(world: vec3f, normal: vec3f, on_solid: bool) -> f32 {
    if !has(SUN_SHADOWS_PART) {
        return 1.0;
    }
    let offset = world - frame.shadows[0].eye.xyz;
    let place = shadow_place(0u, offset);
    let highest = shadow_height(shadow_highest(place), on_solid) - place.height;
    if (frame.shadows[0].toward.w == 0.0) | (highest <= 0.0) {
        return 1.0;
    }
    let rise = face_rise(turned(0u, normal)) * place.texel_m;
    let error = BIAS_TEXELS * place.texel_m + BIAS_PER_METER * length(offset);
    let bias = error * (1.0 + length(rise) / place.texel_m);
    if has(PLAIN_SHADOWS_PART) {
        let texel = floor(place.at);
        let top = shadow_height(shadow_texel(place.table, vec2i(texel)), on_solid);
        let above = top - (place.height + dot(rise, texel + 0.5 - place.at));
        return 1.0 - clamp((above - bias) / (FULL_TEXELS * place.texel_m), 0.0, 1.0);
    }
    let search = clamp(SPREAD * highest / place.texel_m, LEAST_RADIUS, MOST_RADIUS);
    let step = select(1, 2, search > SPARSE_RADIUS);
    let found = shadow_cover(place, search, step, rise, bias, on_solid);
    if found.y == 0.0 {
        return 1.0;
    }
    if found.y >= found.x {
        return 0.0;
    }
    let breadth = clamp(SPREAD * (found.z / found.y) / place.texel_m, LEAST_RADIUS, MOST_RADIUS);
    if breadth >= search && step == 1 {
        return 1.0 - found.y / found.x;
    }
    let shade = shadow_cover(place, breadth, 1, rise, bias, on_solid);
    return 1.0 - shade.y / shade.x;
}

// ShadowMap::contact.
fn contact_share(world: vec3f, on_solid: bool) -> f32 {
    if !has(SKY_SHADOWS_PART) {
        return 1.0;
    }
    let place = shadow_place(1u, world - frame.shadows[1].eye.xyz);
    let highest = shadow_highest(place);
    let reach = CONTACT_RADIUS * place.texel_m;
    let is_open = select(highest.x <= place.height, highest.y <= place.height - reach, on_solid);
    if (frame.shadows[1].toward.w == 0.0) | is_open {
        return 1.0;
    }
    let radius = select(CONTACT_RADIUS, WALL_RADIUS, on_solid);
    let low = vec2i(ceil(place.at - 0.5 - radius));
    // Bounded, since a place may be NaN.
    let high = min(vec2i(floor(place.at - 0.5 + radius)), low + MOST_WINDOW);
    var sum = vec2f(0.0);
    for (var y = low.y; y <= high.y; y += 1) {
        for (var x = low.x; x <= high.x; x += 1) {
            let aside = vec2f(vec2i(x, y)) + 0.5 - place.at;
            let tent = max(1.0 - abs(aside) / radius, vec2f(0.0));
            let texel = shadow_texel(place.table, vec2i(x, y));
            let hidden = select((texel.x - place.height) / reach, 1.0 - (place.height - texel.y) / reach, on_solid);
            sum += vec2f(1.0, clamp(hidden, 0.0, 1.0)) * (tent.x * tent.y);
        }
    }
    return 1.0 - select(GROUND_CONTACT, WALL_CONTACT, on_solid) * sum.y / sum.x;
}

// Lighting::shade_received.
fn lit(albedo: vec3f, normal: vec3f, received: vec2f) -> vec3f {
    let direct = frame.sun.rgb * (max(dot(normal, frame.to_sun.xyz), 0.0) * received.x);
    let ambient = mix(frame.bounce.rgb, frame.sky.rgb, normal.z * 0.5 + 0.5) * received.y;
    return albedo * (direct + ambient);
}

// Lighting::sky_color of a ray of unit length.
fn sky_at(ray: vec3f) -> vec3f {
    let up = max(ray.z, 0.0);
    let horizon = frame.studio_bottom.w;
    return mix(frame.haze.rgb, frame.zenith.rgb, up * (2.0 - up) * (up * (1.0 + horizon) / (up + horizon)));
}

// WaterColor::tint.
fn water_tint(height: f32, off_shore: f32) -> vec3f {
    let own = water_at(height);
    let near = clamp(off_shore / frame.shallow.w, 0.0, 1.0);
    let far = clamp((off_shore - frame.shallow.w) / (1.0 - frame.shallow.w), 0.0, 1.0);
    return mix(mix(frame.shallow.rgb, own, near), min(own, frame.open.rgb), far);
}

// The functions of src/draw/water.rs.
fn ripple(at: vec2f, pixel_m: f32, low: f32, wave_m: f32, steepness: f32) -> vec2f {
    let shown = low * clamp(2.0 * wave_m / (RIPPLE_WAVE_PX * pixel_m) - 1.0, 0.0, 1.0);
    if shown <= 0.0 {
        return vec2f(0.0);
    }
    let place = at / wave_m;
    return vec2f(grain_noise(place), grain_noise(place + vec2f(37.5, 17.25))) * (shown * steepness);
}

fn ripples(at: vec2f, pixel_m: f32, ray: vec3f) -> vec2f {
    let low = clamp((1.0 + ray.z - RIPPLE_GRAZING.x) / (RIPPLE_GRAZING.y - RIPPLE_GRAZING.x), 0.0, 1.0);
    return ripple(at, pixel_m, low, RIPPLE_WAVES_M.x, RIPPLE_STEEPNESS.x)
        + ripple(at, pixel_m, low, RIPPLE_WAVES_M.y, RIPPLE_STEEPNESS.y)
        + ripple(at, pixel_m, low, RIPPLE_WAVES_M.z, RIPPLE_STEEPNESS.z);
}

fn facing_sun(normal: vec3f) -> f32 {
    return max(dot(normal, frame.to_sun.xyz), 0.0);
}

// ReliefShading::soft.
fn soft_brightness(brightness: f32) -> f32 {
    const dark = RELIEF_TOE - RELIEF_DARKEST;
    const bright = RELIEF_BRIGHTEST - RELIEF_SHOULDER;
    let toe = RELIEF_DARKEST + dark * dark / (dark + max(RELIEF_TOE - brightness, 0.0));
    let shoulder = RELIEF_BRIGHTEST - bright * bright / (bright + max(brightness - RELIEF_SHOULDER, 0.0));
    return select(select(brightness, shoulder, brightness > RELIEF_SHOULDER), toe, brightness < RELIEF_TOE);
}

// ReliefShading::shade.
fn relief_lit(albedo: vec3f, post: Post, small: vec2f, at: vec2f, received: vec2f) -> vec3f {
    let z_factor = frame.to_sun.w;
    let normal = normalize(vec3f(-(post.slope + small) * z_factor, 1.0));
    let form = normalize(vec3f(-ground_on_level(at, frame.ground_size.w).slope * z_factor, 1.0));
    var sides = 0.0;
    for (var side = 0; side < 4; side += 1) {
        sides += max(dot(normal, frame.sides[side].xyz), 0.0) * frame.sides[side].w;
    }
    let shade = dot(RELIEF_SHARES, vec3f(facing_sun(normal), sides, facing_sun(form)));
    let lost = RELIEF_SHARES.x * facing_sun(normal) * (1.0 - post.visibility.x * received.x);
    let upright = facing_sun(vec3f(0.0, 0.0, 1.0));
    let level = dot(RELIEF_SHARES, vec3f(upright, RELIEF_SIDE_RISE, upright));
    let low = stop_at(0u).w;
    let high = stop_at(frame.ground_size.x - 1u).w;
    let elevation = select(0.0, (post.height - low) / (high - low), high > low);
    let contrast = mix(RELIEF_LOW_CONTRAST, 1.0, clamp(elevation / 0.75, 0.0, 1.0));
    let relief = contrast * (shade - level);
    let shadow = contrast * lost;
    let gain = select(RELIEF_GAIN, frame.sun.w, relief < 0.0);
    let shade_share = max(1.0 - post.visibility.x * received.x * facing_sun(normal) / max(upright, RELIEF_LEAST_SINE), 0.0);
    let detail = frame.relief.y * shade_share * dot(normal - form, frame.to_sun.xyz);
    let detailed = 1.0 + RELIEF_MOST_DETAIL * detail / (RELIEF_MOST_DETAIL + abs(detail));
    let brightness = soft_brightness(1.0 + gain * relief - RELIEF_GAIN * shadow) * detailed;
    let hue = mix(RELIEF_COOL, RELIEF_WARM, clamp(0.5 + 1.2 * (relief - shadow), 0.0, 1.0));
    let tint = hue / mix(RELIEF_COOL, RELIEF_WARM, 0.5);
    let gray = vec3f(dot(albedo, vec3f(0.2126, 0.7152, 0.0722)));
    let deep = max(albedo + (albedo - gray) * RELIEF_FILL_CHROMA, vec3f(0.0));
    let fill = deep * RELIEF_FILL * (frame.cover_more.w * clamp(1.0 - brightness, 0.0, 1.0));
    let glare = RELIEF_GLARE * frame.cover_more.w * max((brightness - 1.0) / (RELIEF_BRIGHTEST - 1.0), 0.0);
    return (mix(albedo, gray * RELIEF_GLARE_COLOR, glare) * tint * brightness + fill) * mix(RELIEF_CLOSED, 1.0, post.visibility.y * received.y);
}

// The normal on the side that is seen; the triangle's own where its corners have none.
fn vertex_normal(in: Varying, front: bool) -> vec3f {
    let own = cross(dpdx(in.world), dpdy(in.world));
    let toward_eye = own * select(1.0, -1.0, dot(own, from_eye(in.world)) > 0.0);
    let given = in.normal * select(-1.0, 1.0, front);
    let normal = select(toward_eye, given, dot(given, given) > 0.0);
    return normal * inverseSqrt(max(dot(normal, normal), 1e-30));
}

fn is_opaque() -> bool {
    return (material.flags.x & (MASK | BLEND)) == 0u;
}

// hatching_cover.
fn hatching_cover(at: vec2f) -> f32 {
    let across = (at.x + at.y) * 0.70710678 / HATCHING_PITCH_PX;
    return clamp(HATCHING_WIDTH_PX / 2.0 + 0.5 - abs(fract(across) - 0.5) * HATCHING_PITCH_PX, 0.0, 1.0);
}

fn texture_at(uv: vec2f) -> vec4f {
    if !textured {
        return vec4f(1.0);
    }
    let filtered = textureSample(base_texture, base_sampler, uv, material.flags.y);
    return select(vec4f(1.0), filtered, (material.flags.x & TEXTURED) != 0u);
}

// Reads the material of a fragment and the texel that it shows.
fn read_material(in: Varying) {
    material = material_of(in.material);
    texel = texture_at(in.uv);
    if !is_opaque() {
        texel = vec4f(texel.rgb / max(texel.a, 1e-4), texel.a);
    }
    if has(AREA_PART) {
        let right = length(dpdx(in.world.xy));
        let down = length(dpdy(in.world.xy));
        if (material.flags.x & AREA) != 0u {
            texel = area_color(in.material, in.world.xy, sqrt(right * down), max(right, down), abs(2.0 * in.uv.x - 1.0));
        }
    }
}

fn surface(in: Varying) -> vec4f {
    if (material.flags.x & HATCHING) != 0u {
        return vec4f(material.base_color.rgb, material.base_color.a * hatching_cover(in.clip.xy + frame.tile_first.xy));
    }
    return material.base_color * in.color * texel;
}

fn has(part: u32) -> bool {
    return (parts & part) != 0u;
}

// wireframe::edge_cover, by the weights of a triangle's second and third corner.
fn edge_cover(weights: vec2f) -> f32 {
    let right = dpdx(weights);
    let down = dpdy(weights);
    let across = vec3f(-right.x - right.y, right);
    let along = vec3f(-down.x - down.y, down);
    let per_px = max(sqrt(across * across + along * along), vec3f(1e-30));
    let height = 1.0 / max(max(per_px.x, per_px.y), per_px.z);
    let away = abs(vec3f(1.0 - weights.x - weights.y, weights)) / per_px;
    let shown = clamp((height - WIREFRAME_FADE_PX.x) / (WIREFRAME_FADE_PX.y - WIREFRAME_FADE_PX.x), 0.0, 1.0);
    return clamp(WIREFRAME_WIDTH_PX * 0.5 + 0.5 - min(min(away.x, away.y), away.z), 0.0, 1.0) * shown;
}

// The color of bare ground; water_share is that of the water that mirrors the sky, unlit that of an unshaded picture.
struct GroundColor {
    color: vec3f,
    water_share: f32,
    unlit: f32,
}

fn ground_color(at: vec2f, post: Post, noise: Noise, right: vec2f, down: vec2f, grain: f32) -> GroundColor {
    var seen = GroundColor(ramp_at(post.height), 0.0, 0.0);
    if has(COVER_PART) {
        let change = length(vec2f(dot(post.gradient, right), dot(post.gradient, down)));
        let covered = with_cover(seen.color, post, change, noise);
        seen.color = select(seen.color, covered, frame.cover.z > 0.0);
    }
    if has(MAP_WATER_PART) {
        seen.color = mix(seen.color, frame.undergrowth.rgb, clamp(-post.visibility.z, 0.0, 1.0) * frame.undergrowth.w);
    }
    seen.color *= grain;
    if has(MAP_WATER_PART) {
        // ShorePixel and WaterColor.
        let change = length(vec2f(dot(post.water, right), dot(post.water, down)));
        let away = (post.visibility.z - 0.5) / max(change, 1e-4);
        let water = clamp(away + 0.5, 0.0, 1.0);
        let shore = 1.0 - WATER_SHORE * clamp(WATER_SHORE_PX - abs(away), 0.0, 1.0);
        let tint = water_tint(post.height, clamp((post.visibility.z - 0.75) * 4.0, 0.0, 1.0));
        let wet = clamp(4.0 * post.visibility.z - 1.0, 0.0, 1.0);
        seen.color = mix(seen.color * (1.0 - WATER_WET * wet * wet), tint, water) * shore;
        seen.water_share = water;
    }
    let land = 1.0 - seen.water_share;
    if has(IMAGERY_PART) {
        let draped = draped_at(at, right, down);
        seen.color = mix(seen.color, draped.rgb, draped.a);
        seen.water_share *= 1.0 - draped.a;
        seen.unlit = select(draped.a, 0.0, frame.imagery_size.w > 0.5);
    }
    if has(CONTOURS_PART) {
        let per_pixel = length(vec2f(dot(post.gradient, right), dot(post.gradient, down)));
        // Contours::ink.
        let is_lit = frame.contour_lit.w > 0.5;
        let downhill = -post.gradient / max(length(post.gradient), 1e-30);
        let facing = dot(downhill, frame.to_sun.xy / max(length(frame.to_sun.xy), 1e-30));
        let width = frame.contour_shape.y
            * select(1.0, frame.contour_turn.x + frame.contour_turn.y * abs(facing), is_lit);
        let lit_ink = mix(frame.contour.rgb, frame.contour_lit.rgb, clamp(0.5 + facing * frame.contour_turn.z, 0.0, 1.0));
        let ink = select(frame.contour.rgb, lit_ink, is_lit);
        let cover = contour_cover(post.height, per_pixel, width) * frame.contour.a;
        seen.color = mix(seen.color, ink, cover * land);
    }
    return seen;
}

// What a pixel spans of a surface along its row and down its column, in meters.
struct Footprint {
    right: vec3f,
    down: vec3f,
}

fn face_of(span: Footprint) -> vec3f {
    return cross(span.right, span.down);
}

fn pixel_m(span: Footprint) -> f32 {
    return max(length(span.right.xy), length(span.down.xy));
}

// The color of a surface, how light it is, and the share of it that is water.
struct Shaded {
    color: vec4f,
    light: vec3f,
    water_share: f32,
}

// The share of water of a surface that the ground gives no color.
fn water_of(flags: u32) -> f32 {
    return select(0.0, 1.0, has(WATER_PART) && (flags & WATER) != 0u);
}

// What the ground gives a surface of a color that lies on it.
fn on_ground(color: vec4f, flags: u32, world: vec3f, span: Footprint) -> Shaded {
    var shaded = Shaded(color, color.rgb, water_of(flags));
    let post = ground_at(world.xy, span.right.xy, span.down.xy);
    var grain = 1.0;
    if has(GRAIN_PART) && (flags & (FROM_GROUND_ALBEDO | NATURAL)) != 0u {
        grain = ground_grain(world.xy, pixel_m(span), length(post.slope));
    }
    if has(NATURAL_PART) && (flags & NATURAL) != 0u {
        shaded.color = vec4f(color.rgb * grain, color.a);
    }
    var noise = Noise(0.0, 0.0, 0.0, vec2f(0.0), 0.0, vec2f(0.0), 0.0);
    var small = vec2f(0.0);
    if has(COVER_PART) {
        noise = cover_noise(world.xy, sqrt(length(span.right.xy) * length(span.down.xy)), pixel_m(span), post.slope * frame.cover.z);
        small = small_form(post, noise);
    }
    var unlit = 0.0;
    if has(GROUND_COLOR_PART) && (flags & FROM_GROUND_ALBEDO) != 0u {
        let seen = ground_color(world.xy, post, noise, span.right.xy, span.down.xy, grain);
        shaded.color = vec4f(seen.color, 1.0);
        shaded.water_share = seen.water_share;
        unlit = seen.unlit;
    }
    if has(GROUND_LIGHT_PART) && (flags & FROM_GROUND_NORMAL) != 0u {
        let received = vec2f(sun_share(world, face_of(span), false), contact_share(world, false));
        let base = shaded.color.rgb;
        shaded.light = mix(relief_lit(base, post, small, world.xy, received), base, unlit);
    }
    return shaded;
}

// Lighting::mirror.
fn mirrored(light: vec3f, water_share: f32, world: vec3f, span: Footprint) -> vec3f {
    if !has(WATER_PART | MAP_WATER_PART) || water_share <= 0.0 {
        return light;
    }
    let ray = normalize(from_eye(world));
    let normal = normalize(vec3f(-ripples(world.xy, pixel_m(span), ray), 1.0));
    let facing = -dot(ray, normal);
    let grazing = 1.0 - clamp(facing, 0.0, 1.0);
    let share = WATER_MIRRORED + (WATER_MOST_MIRRORED - WATER_MIRRORED) * (grazing * grazing * grazing * grazing * grazing);
    let mirrored_ray = ray + normal * (2.0 * facing);
    var seen = sky_at(mirrored_ray);
    if has(WATER_RELIEF_PART) {
        let shown = clamp((share - RELIEF_SHOWN.x) / (RELIEF_SHOWN.y - RELIEF_SHOWN.x), 0.0, 1.0);
        if shown > 0.0 {
            let relief = mirrored_relief(mirrored_ray, world, span);
            seen = mix(seen, relief.rgb, shown * relief.a);
        }
    }
    return mix(light, seen, share * water_share);
}

// MirroredRay, from a place in columns and rows.
struct MirroredRay {
    start: vec2f,
    per_m: vec2f, // columns and rows per meter in plan
    z: f32,
    rise: f32,
}

// The highest land of a block, in world Z.
fn top_at(block: vec2u, level: u32) -> f32 {
    let place = frame.ground_tops[level];
    let at = min(block, place.xy - 1u);
    return bitcast<f32>(ground_texel(place.z + at.y * place.x + at.x).x) * frame.relief.x;
}

// GroundMap::height_m in world Z, GroundPost::water.
fn ground_between(grid: vec2f) -> vec2f {
    let size = frame.ground_levels[0].xy;
    let first = min(vec2u(grid), max(size, vec2u(2u)) - 2u);
    let next = min(first + 1u, size - 1u);
    let part = grid - vec2f(first);
    let sw = ground_texel(first.y * size.x + first.x);
    let se = ground_texel(first.y * size.x + next.x);
    let nw = ground_texel(next.y * size.x + first.x);
    let ne = ground_texel(next.y * size.x + next.x);
    let west = bitcast<vec2f>(vec2u(sw.x, nw.x));
    let heights = west + (bitcast<vec2f>(vec2u(se.x, ne.x)) - west) * part.x;
    let dry = vec2f(vec2u(sw.w, nw.w) >> vec2u(22u));
    let wet = mix(dry, vec2f(vec2u(se.w, ne.w) >> vec2u(22u)), part.x) / 511.0 - 1.0;
    return vec2f((heights.x + (heights.y - heights.x) * part.y) * frame.relief.x, mix(wet.x, wet.y, part.y));
}

fn ray_grid(ray: MirroredRay, along: f32) -> vec2f {
    return clamp(ray.start + ray.per_m * along, vec2f(0.0), vec2f(frame.ground_levels[0].xy - 1u));
}

fn is_below_ground(ray: MirroredRay, along: f32) -> bool {
    let ground = ground_between(ray_grid(ray, along));
    return ground.x > ray.z + ray.rise * along && ground.y < 0.5;
}

// Where a ray leaves a rectangle.
fn ray_exit(ray: MirroredRay, low: vec2f, high: vec2f) -> f32 {
    let border = select(high, low, ray.per_m < vec2f(0.0));
    let is_along = ray.per_m == vec2f(0.0);
    let at = select((border - ray.start) / select(ray.per_m, vec2f(1.0), is_along), vec2f(3.4e38), is_along);
    return min(at.x, at.y);
}

// MirroredRay::meets; below 0 where it meets nothing.
fn ray_meets(ray: MirroredRay) -> f32 {
    let levels = frame.ground_tops[0].w;
    let highest = top_at(vec2u(0u), levels - 1u);
    let leaves_map = ray_exit(ray, vec2f(0.0), vec2f(frame.ground_levels[0].xy - 1u));
    let end = min(leaves_map, (highest - ray.z) / ray.rise);
    let fastest = max(abs(ray.per_m.x), abs(ray.per_m.y));
    let step = 0.5 / fastest;
    let past = 1e-3 / fastest;
    var along = 0.0;
    var level = min(u32(RAY_FIRST_LEVEL), levels - 1u);
    var left = u32(RAY_STEPS);
    while along < end && left > 0u {
        left -= 1u;
        let cells = RAY_BLOCK * f32(1u << level);
        let block = floor(ray_grid(ray, along) / cells);
        let leaves = max(ray_exit(ray, block * cells, (block + 1.0) * cells), along);
        if ray.z + ray.rise * along >= top_at(vec2u(block), level) {
            along = leaves + past;
            level = min(level + 1u, levels - 1u);
        } else if level > 0u {
            level -= 1u;
        } else {
            let stop = min(leaves, end);
            var above = along;
            loop {
                if is_below_ground(ray, along) {
                    var below = along;
                    for (var half = 0.0; half < RAY_BISECTIONS; half += 1.0) {
                        let middle = 0.5 * (above + below);
                        if is_below_ground(ray, middle) {
                            below = middle;
                        } else {
                            above = middle;
                        }
                    }
                    return below;
                }
                if along >= stop || left == 0u {
                    break;
                }
                left -= 1u;
                above = along;
                along = min(along + step, stop);
            }
            along = leaves + past;
        }
    }
    return -1.0;
}

// The light of the ground that a mirrored ray meets, as it reaches the water; 1 where it meets any.
fn mirrored_relief(direction: vec3f, world: vec3f, span: Footprint) -> vec4f {
    let level = length(direction.xy);
    if (level <= 1e-3) | (frame.ground_tops[0].w == 0u) {
        return vec4f(0.0);
    }
    let toward = direction.xy / level;
    var ray = MirroredRay((world.xy - frame.ground.xy) / frame.ground.zw, toward / frame.ground.zw, 0.0, 0.0);
    ray.z = max(ground_between(ray_grid(ray, 0.0)).x, 0.0);
    ray.rise = max(direction.z / level, RAY_LEAST_RISE);
    let along = ray_meets(ray);
    if along < 0.0 {
        return vec4f(0.0);
    }
    let turned = distance(world, frame.eye.xyz);
    let whole = turned + along * sqrt(1.0 + ray.rise * ray.rise);
    let parted = select(whole / turned, 1.0, is_parallel());
    let across = min(length(span.right), length(span.down)) * parted;
    let right = vec2f(across, 0.0);
    let down = vec2f(0.0, across);
    let place = world.xy + toward * along;
    let post = ground_at(place, right, down);
    // GroundMap::mirrored_land.
    var land = ramp_at(post.height);
    if has(COVER_PART) {
        let covered = with_cover(land, post, 1e30, Noise(0.0, 0.0, 0.0, vec2f(0.0), 0.0, vec2f(0.0), 1e30));
        land = select(land, covered, frame.cover.z > 0.0);
    }
    if has(MAP_WATER_PART) {
        land = mix(land, frame.undergrowth.rgb, clamp(-post.visibility.z, 0.0, 1.0) * frame.undergrowth.w);
    }
    var unlit = 0.0;
    if has(IMAGERY_PART) {
        let draped = draped_at(place, right, down);
        land = mix(land, draped.rgb, draped.a);
        unlit = select(draped.a, 0.0, frame.imagery_size.w > 0.5);
    }
    let light = mix(relief_lit(land, post, vec2f(0.0), place, vec2f(1.0)), land, unlit);
    let hazy = max(whole - frame.zenith.w, 0.0) - max(turned - frame.zenith.w, 0.0);
    return vec4f(mix(frame.haze.rgb, light, exp(-hazy * frame.haze.w)), 1.0);
}

fn in_haze(light: vec3f, world: vec3f) -> vec3f {
    if has(HAZE_PART) {
        let clear = exp(-max(distance(world, frame.eye.xyz) - frame.zenith.w, 0.0) * frame.haze.w);
        return mix(frame.haze.rgb, light, clear);
    }
    return light;
}

fn shade(in: Varying, front: bool) -> vec4f {
    let flags = material.flags.x;
    var color = surface(in);
    let normal = vertex_normal(in, front);
    var light = color.rgb;
    var water_share = water_of(flags);
    let span = Footprint(dpdx(in.world), dpdy(in.world));
    let from_ground = FROM_GROUND_NORMAL | FROM_GROUND_ALBEDO;
    if has(GROUND_COLOR_PART | GROUND_LIGHT_PART) && (flags & from_ground) != 0u {
        let ground = on_ground(color, flags, in.world, span);
        color = ground.color;
        light = ground.light;
        water_share = ground.water_share;
    }
    if has(OWN_LIGHT_PART) && (flags & FROM_GROUND_NORMAL) == 0u {
        var received = vec2f(1.0, 1.0);
        if (flags & IN_ALL_LIGHT) == 0u {
            received.y = contact_share(in.world, true);
            if dot(normal, frame.to_sun.xyz) > 0.0 {
                received.x = sun_share(in.world, face_of(span), true);
            }
        }
        light = lit(color.rgb, normal, received);
    }
    if has(HATCHING_PART) && (flags & HATCHING) != 0u {
        light = color.rgb;
    }
    light = mirrored(light, water_share, in.world, span);
    if has(EDGES_PART) {
        let cover = edge_cover(in.uv);
        light = mix(light, WIREFRAME_COLOR, select(0.0, cover * WIREFRAME_ALPHA, (flags & EDGES) != 0u));
    }
    light = in_haze(light, in.world);
    return vec4f(light, select(1.0, color.a, (flags & BLEND) != 0u));
}

// The depth buffer's value from what the rasterizer knows exactly at a pixel's center: 1 / d or, with parallel rays, the
// value itself.
fn reversed_depth(in: Varying) -> f32 {
    let change = max(abs(dpdx(in.clip.w)), abs(dpdy(in.clip.w)));
    let change_parallel = max(abs(dpdx(in.clip.z)), abs(dpdy(in.clip.z)));
    let parallel = in.clip.z + nearer_px * change_parallel;
    let central = frame.depth.x * (nearer * in.clip.w + nearer_px * change) - frame.depth.y;
    return select(central, parallel, is_parallel());
}

fn shade_or_discard(in: Varying, front: bool) -> vec4f {
    read_material(in);
    let shaded = shade(in, front);
    let alpha = surface(in).a;
    if (material.flags.x & MASK) != 0u && alpha < material.cutoff.x {
        discard;
    }
    return shaded;
}

// A line of the ground's wireframe in a window.
@fragment
fn line_color(in: Varying) -> @location(0) vec4f {
    let clear = exp(-max(distance(in.world, frame.eye.xyz) - frame.zenith.w, 0.0) * frame.haze.w);
    return vec4f(mix(frame.haze.rgb, WIREFRAME_COLOR, clear), WIREFRAME_ALPHA);
}

@fragment
fn color(in: Varying, @builtin(front_facing) front: bool) -> @location(0) vec4f {
    return shade_or_discard(in, front);
}

struct ColorAndSamples {
    @location(0) color: vec4f,
    @builtin(sample_mask) samples: u32,
}

fn is_solid_at(in: Varying, offset: vec2f) -> bool {
    let uv = in.uv + dpdx(in.uv) * offset.x + dpdy(in.uv) * offset.y;
    var texel = textureSampleBias(base_texture, base_sampler, uv, material.flags.y, MASK_LEVEL_BIAS);
    if (material.flags.x & TEXTURED) == 0u {
        texel = vec4f(1.0);
    }
    return material.base_color.a * in.color.a * texel.a >= material.cutoff.x;
}

// A masked item with its alpha tested at each of the four standard sample places, for smooth borders.
@fragment
fn masked_color(in: Varying, @builtin(front_facing) front: bool) -> ColorAndSamples {
    read_material(in);
    let shaded = shade(in, front);
    let solid = vec4<bool>(
        is_solid_at(in, vec2f(-0.125, -0.375)),
        is_solid_at(in, vec2f(0.375, -0.125)),
        is_solid_at(in, vec2f(-0.375, 0.125)),
        is_solid_at(in, vec2f(0.125, 0.375)),
    );
    let bits = select(vec4u(0u), vec4u(1u, 2u, 4u, 8u), solid);
    return ColorAndSamples(shaded, bits.x | bits.y | bits.z | bits.w);
}

struct ColorAndDepth {
    @location(0) color: vec4f,
    @builtin(frag_depth) depth: f32,
}

// For OpenGL, whose clip space halves the depth range about zero and so loses what reversing gained.
@fragment
fn color_and_depth(in: Varying, @builtin(front_facing) front: bool) -> ColorAndDepth {
    let depth = reversed_depth(in);
    return ColorAndDepth(shade_or_discard(in, front), depth);
}

struct FeatureAndDepth {
    @location(0) seen: vec2u, // feature, bits of the depth in meters
    @builtin(frag_depth) depth: f32,
}

@fragment
fn feature(in: Varying) -> FeatureAndDepth {
    read_material(in);
    let depth = reversed_depth(in);
    let alpha = surface(in).a;
    if !is_opaque() && alpha < material.cutoff.x {
        discard;
    }
    let along = dot(in.world - frame.eye.xyz, frame.forward.xyz);
    let depth_m = select(1.0 / in.clip.w, along, is_parallel());
    return FeatureAndDepth(vec2u(in.feature, bitcast<u32>(depth_m)), depth);
}
