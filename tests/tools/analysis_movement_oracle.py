#!/usr/bin/env python3
"""Makes the tables of tests/analysis with which times, routes and landing zones are compared.

Times are those of GRASS r.walk and r.cost, routes those of scikit-image, landing zones those of the definition written
down in numpy. Needs grass, gdal_translate, numpy and scikit-image, and the data beside the checkout:

    python3 tests/tools/analysis_movement_oracle.py --data ../shared/data --out tests/analysis

Posts count from the south-west. Heights are the rasters' own samples; paces and obstacles are made from them and from the
numbers of columns and rows, so that tests make the same ones.
"""

import argparse
import pathlib
import subprocess
import tempfile
import zlib

import numpy
from skimage.graph import route_through_array

PLACES = {
    "redbutte": "scenes/redbutte_us/red_butte_dem.tif",
    "wake": "scenes/wake_nc_us/elev_ned_30m.tif",
    "taunton": "scenes/taunton_uk/dtm.tif",
}
SAMPLES = 120
ROUTES = 8


def samples(path, folder):
    """The heights from the south-west, north-west corner and cell of a raster."""
    raw = folder / "raw.img"
    command = ["gdal_translate", "-q", "-of", "ENVI", "-ot", "Float32", str(path), str(raw)]
    subprocess.run(command, check=True)
    lines = [line.partition("=") for line in raw.with_suffix(".hdr").read_text().splitlines()]
    header = {key.strip(): value.strip() for key, _, value in lines}
    columns, rows = int(header["samples"]), int(header["lines"])
    info = header["map info"].strip("{}").split(",")
    corner, cell = (float(info[3]), float(info[4])), (float(info[5]), float(info[6]))
    heights = numpy.fromfile(raw, dtype="<f4").reshape(rows, columns)[::-1].copy()
    if "data ignore value" in header:
        heights[heights == numpy.float32(header["data ignore value"])] = numpy.nan
    return heights, corner, cell


def paces(heights):
    """Seconds a meter by bands of height: 1 to 3 in steps of a half."""
    return (1.0 + numpy.floor(heights / 8.0) % 5 * 0.5).astype(numpy.float32)


def grass(folder, path, pace, corner, cell, start):
    """Times of r.walk and r.cost, with and without knight's moves, from the south-west."""
    rows, columns = pace.shape
    pace[::-1].astype("<f4").tofile(folder / "pace.bin")
    north, west = corner[1], corner[0]
    south, east = north - rows * cell[1], west + columns * cell[0]
    at = f"{west + (start[0] + 0.5) * cell[0]},{south + (start[1] + 0.5) * cell[1]}"
    bounds = f"north={north} south={south} east={east} west={west} rows={rows} cols={columns}"
    script = f"""set -e
r.in.gdal -o input={path} output=dem --q
g.region raster=dem --q
r.mapcalc "zero = if(isnull(dem), null(), 0.0)" --q
r.in.bin -f input={folder}/pace.bin output=all bytes=4 {bounds} --q
r.mapcalc "pace = if(isnull(dem), null(), all)" --q
for knight in 8 16; do
  flag=$(test $knight = 16 && echo -k || true)
  r.walk $flag elevation=dem friction=zero output=walk$knight start_coordinates={at} --q
  r.cost $flag input=pace output=cost$knight start_coordinates={at} --q
  for kind in walk cost; do
    r.out.bin -f input=$kind$knight output={folder}/$kind$knight.bin bytes=4 null=nan --q
  done
done
g.version
"""
    (folder / "oracle.sh").write_text(script)
    subprocess.run(["grass", "-c", str(path), str(folder / "location"), "-e"], check=True, capture_output=True)
    command = ["grass", str(folder / "location" / "PERMANENT"), "--exec", "bash", str(folder / "oracle.sh")]
    done = subprocess.run(command, check=True, capture_output=True, text=True)
    values = lambda name: numpy.fromfile(folder / f"{name}.bin", dtype="<f4").reshape(rows, columns)[::-1]
    # r.cost counts distances in cells eastward.
    found = {f"walk{count}": values(f"walk{count}") for count in (8, 16)}
    found |= {f"cost{count}": values(f"cost{count}") * cell[0] for count in (8, 16)}
    return found, done.stdout.strip().splitlines()[-1]


def movement(name, path, folder, out):
    heights, corner, cell = samples(path, folder)
    rows, columns = heights.shape
    start = (columns // 3, rows // 3)
    pace = paces(heights)
    times, version = grass(folder, path, pace, corner, cell, start)
    random = numpy.random.default_rng(37)
    lines = [f"# {name}: {columns} x {rows} posts, from column {start[0]}, row {start[1]}; {version}"]
    for tool, values in times.items():
        held = numpy.argwhere(numpy.isfinite(values))
        for row, column in held[random.choice(len(held), SAMPLES, replace=False)]:
            lines.append(f"{tool},{column},{row},{values[row, column]:.6g}")
    closed = numpy.where(numpy.isnan(pace), -1, pace).astype(float)
    held = numpy.argwhere(closed > 0)
    for row, column in held[random.choice(len(held), ROUTES, replace=False)]:
        _, cost = route_through_array(closed, (start[1], start[0]), (row, column), geometric=True)
        lines.append(f"route,{column},{row},{cost * cell[0]:.8g}")
    (out / f"movement_{name}.csv").write_text("\n".join(lines) + "\n")


def slopes(heights, cell):
    """Tangents of slopes by Horn's method; a neighbor without data or beyond the border counts as the nearest post."""
    f = numpy.float32
    padded = numpy.pad(heights, 1, mode="edge")
    rows, columns = heights.shape

    def at(east, north):
        there = padded[1 + north : 1 + north + rows, 1 + east : 1 + east + columns]
        return numpy.where(numpy.isnan(there), heights, there)

    two = f(2.0)
    east = (at(1, 1) + two * at(1, 0) + at(1, -1)) - (at(-1, 1) + two * at(-1, 0) + at(-1, -1))
    north = (at(1, 1) + two * at(0, 1) + at(-1, 1)) - (at(1, -1) + two * at(0, -1) + at(-1, -1))
    spans = lambda count: f(4.0) * numpy.array([2.0 - (i in (0, count - 1)) for i in range(count)], dtype=f)
    east = east / (spans(columns) * f(cell[0]))[None, :]
    north = north / (spans(rows) * f(cell[1]))[:, None]
    return numpy.sqrt(east * east + north * north)


def shifted(values, east, north, outside):
    """The values so many columns east and rows north of each post."""
    rows, columns = values.shape
    moved = numpy.full_like(values, outside)
    into = lambda count, step: slice(max(0, -step), min(count, count - step))
    out_of = lambda count, step: slice(max(0, step), min(count, count + step))
    if abs(east) < columns and abs(north) < rows:
        moved[into(rows, north), into(columns, east)] = values[out_of(rows, north), out_of(columns, east)]
    return moved


def disk_maxima(values, radius, cell, outside):
    reach = [int(radius / size) for size in cell]
    highest = numpy.full_like(values, -numpy.inf)
    for north in range(-reach[1], reach[1] + 1):
        for east in range(-reach[0], reach[0] + 1):
            if (east * cell[0]) ** 2 + (north * cell[1]) ** 2 <= radius * radius:
                highest = numpy.maximum(highest, shifted(values, east, north, outside))
    return highest


def landing(name, path, folder, size, approach):
    f = numpy.float32
    heights, _, cell = samples(path, folder)
    rows, columns = heights.shape
    # The disk reaches the posts beside its center, however far apart they are.
    radius = max({"1": 12.5, "3": 25.0, "5": 50.0, "7": 75.0}[size], max(cell))
    numbers = numpy.arange(columns)[None, :] * 73 + numpy.arange(rows)[:, None] * 151
    obstacles = numpy.where(numbers % 997 == 0, f(4.0), f(0.0))
    slope = slopes(heights, cell)
    hindrance = numpy.where(numpy.isnan(slope) | numpy.isnan(heights) | (obstacles > f(0.45)), f(numpy.inf), slope)
    greatest = disk_maxima(hindrance, radius, cell, f(numpy.inf))
    tops = numpy.where(numpy.isnan(heights), f(-numpy.inf), heights + obstacles)
    tops = disk_maxima(tops, radius, cell, f(-numpy.inf))

    def is_clear(east, north):
        step = float(numpy.hypot(east * cell[0], north * cell[1]))
        rise = f(step / 10.0)
        clear = numpy.ones(heights.shape, dtype=bool)
        for n in range(1, int(approach / step) + 1):
            clear &= shifted(tops, n * east, n * north, f(-numpy.inf)) - f(n) * rise <= heights + f(0.45)
        return clear

    axes = [(0, 1), (1, 1), (1, 0), (1, -1)]
    has_axis = numpy.zeros(heights.shape, dtype=bool)
    for east, north in axes:
        has_axis |= is_clear(east, north) & is_clear(-east, -north)
    free, caution = (f(numpy.tan(numpy.radians(degrees))) for degrees in (7.0, 15.0))
    codes = numpy.where(greatest > free, 1, 2).astype(numpy.uint8)
    codes[(greatest > caution) | ~has_axis] = 0
    codes[numpy.isnan(heights)] = 255
    counts = ",".join(str(int((codes == code).sum())) for code in (0, 1, 2, 255))
    return f"{name},{size},{approach},{counts},{zlib.crc32(codes.tobytes())}"


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--data", type=pathlib.Path, required=True)
    parser.add_argument("--out", type=pathlib.Path, required=True)
    options = parser.parse_args()
    zones = ["# place, size, approach m, posts of code 0, 1, 2 and without data, CRC-32 of the codes"]
    for name, file in PLACES.items():
        path = (options.data / file).resolve()
        with tempfile.TemporaryDirectory() as folder:
            movement(name, path, pathlib.Path(folder), options.out)
        for size, approach in [("1", 100), ("3", 300), ("7", 500)]:
            with tempfile.TemporaryDirectory() as folder:
                zones.append(landing(name, path, pathlib.Path(folder), size, approach))
    (options.out / "landing_zones.csv").write_text("\n".join(zones) + "\n")


if __name__ == "__main__":
    main()
