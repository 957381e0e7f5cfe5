"""Tables of pyflwdir, SciPy and GRASS for basins, magnitudes, floods, breaches and drained areas.

    pip install pyflwdir scipy rasterio     (and grass-core for the last columns)
    python tests/tools/analysis_network_oracle.py PROGRAM ../shared/data/dem > src/analysis/water/network_oracle.tsv

PROGRAM is `sandtable`. Directions are its own: their CRC must be that of `oracle.tsv`, whose directions are those of RichDEM
and pysheds. For each elevation file a line with counts and CRCs of results; no elevations. Rows run from the south.

* `outlets`, `basins`: cells through which 200 and more drain off the land, and the CRC of the basins of all outlets by pyflwdir as
  u32, numbered from 1 in the order of their first cells, 0 without data.
* `magnitudes`: of streams of 200 cells and more, the CRC of Shreve's magnitudes as u32, 0 elsewhere: the number of sources above
  each cell, each source followed down (by hand: pyflwdir has Strahler's and Hack's orders alone).
* `level`, `seed`, `sides`, `corners`: at the median of the heights, the cells that SciPy's `ndimage.label` joins to the lowest of
  all (its index), by four and by eight neighbors.
* `pits`, `costs`: the pits of the ground, and the sum of the least costs of their ways out on ground without cuts, by a search
  written again here. BreachDepressions of RichDEM and BreachDepressionsLeastCost of Whitebox Workflows are no measure: both raise
  the cells of pits first and cut level, ours falls evenly and raises nothing. They drain all of the ground, as ours does.
Printed beside the table: r.watershed of GRASS with D8 (`-s`) on the filled ground: the share of cells with the same direction, and with the
  same drained cells. It fills nothing and resolves flats by a least-cost search of its own (A*, Ehlschlaeger 1989), and its cells
  beside the border drain off it: no setting makes it equal, the share is printed to stderr and not compared.
"""

import heapq
import math
import os
import subprocess
import sys
import tempfile
import zlib

import numpy as np
import rasterio
from scipy import ndimage

FILES = [
    "SainteHelens.dem",
    "bigtujunga_utm11_i16_tiled.tif",
    "zion_srtm_u16_deflate.tif",
    "kootenai_1m.asc",
    "west_bijou_gully.asc",
]
STEPS = [(1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1)]
ESRI = {(1, 0): 1, (1, -1): 2, (0, -1): 4, (-1, -1): 8, (-1, 0): 16, (-1, 1): 32, (0, 1): 64, (1, 1): 128}
# GRASS counts directions from the north-east counter-clockwise, from 1; rows from the north.
GRASS = {(1, 1): 1, (0, 1): 2, (-1, 1): 3, (-1, 0): 4, (-1, -1): 5, (0, -1): 6, (1, -1): 7, (1, 0): 8}


def read(path):
    """Heights as f64 with NaN, rows from the south, and the cell's side, 1 for degrees."""
    with rasterio.open(path) as file:
        heights = file.read(1).astype("f8")
        if file.nodata is not None:
            heights[file.read(1) == file.nodata] = np.nan
        is_metric = file.crs is None or not file.crs.is_geographic
        return heights[::-1].copy(), (file.res[0] if is_metric else 1.0)


def write(path, heights, cell):
    """Heights as a GeoTIFF of a plane, rows from the south; -9999 without data."""
    profile = dict(driver="GTiff", width=heights.shape[1], height=heights.shape[0], count=1, dtype="float32")
    transform = rasterio.transform.from_origin(500_000, 5_000_000, cell, cell)
    with rasterio.open(path, "w", **profile, crs="EPSG:32633", transform=transform, nodata=-9999) as file:
        file.write(np.where(np.isnan(heights), -9999, heights)[::-1].astype("f4"), 1)


def analyzed(program, kind, path, folder, *more):
    out = os.path.join(folder, "out.tif")
    subprocess.run([program, "analyze", kind, path, *more, "-o", out], check=True, capture_output=True)
    with rasterio.open(out) as file:
        return file.read(1)[::-1].copy()


def flow(codes):
    import pyflwdir

    esri = np.full(codes.shape, 247, dtype="u1")
    esri[codes[::-1] == 0] = 0
    for number, step in enumerate(STEPS):
        esri[codes[::-1] == number + 1] = ESRI[step]
    return pyflwdir.from_array(esri, ftype="d8", check_ftype=False)


def downstream(codes):
    """The cell that each drains to; its own number where none."""
    rows, columns = codes.shape
    to = np.arange(codes.size)
    for number, (east, north) in enumerate(STEPS):
        to[codes.ravel() == number + 1] += north * columns + east
    return to


def renumbered(labels, data):
    """Labels numbered from 1 in the order of their first cells."""
    _, first, inverse = np.unique(labels[data], return_index=True, return_inverse=True)
    rank = np.empty(first.size, dtype="u4")
    rank[np.argsort(first)] = np.arange(1, first.size + 1)
    out = np.zeros(labels.shape, dtype="u4")
    out[data] = rank[inverse.ravel()]
    return out


def basins(codes):
    data = codes != 255
    directions = flow(codes)
    labels = directions.basins()[::-1]
    assert (labels[data] > 0).all(), "pyflwdir left cells without a basin"
    cells = directions.upstream_area(unit="cell")[::-1]
    outlets = int(((codes == 0) & (cells >= 200)).sum())
    return outlets, renumbered(labels.astype("i8"), data), cells


def magnitudes(codes, cells):
    is_stream = ((cells >= 200) & (codes != 255)).ravel()
    to = downstream(codes)
    moves = to != np.arange(to.size)
    entered = np.zeros(to.size, dtype=bool)
    entered[to[is_stream & moves]] = True
    found = np.zeros(to.size, dtype="u4")
    for source in np.flatnonzero(is_stream & ~entered):
        while True:
            found[source] += 1
            if not moves[source]:
                break
            source = to[source]
    return found


def floods(heights):
    values = heights[~np.isnan(heights)].astype("f4")
    level = np.float32(np.sort(values)[values.size // 2]) + np.float32(0.5)
    seed = int(np.nanargmin(heights))
    wet = np.nan_to_num(heights.astype("f4"), nan=np.inf) < level
    joined = []
    for structure in (ndimage.generate_binary_structure(2, 1), np.ones((3, 3))):
        labels, _ = ndimage.label(wet, structure=structure)
        joined.append((labels == labels.ravel()[seed]).astype("u1"))
    return level, seed, joined


def pits(heights):
    """Cells that water does not leave: inner ones without lower cells around, and without a level one that comes before."""
    padded = np.pad(heights, 1, constant_values=np.nan)
    rows, columns = heights.shape
    number = np.arange(heights.size).reshape(heights.shape)
    numbers = np.pad(number, 1, constant_values=-1)
    is_pit = ~np.isnan(heights)
    data = is_pit.copy()
    for east, north in STEPS:
        other = padded[1 + north : 1 + north + rows, 1 + east : 1 + east + columns]
        their = numbers[1 + north : 1 + north + rows, 1 + east : 1 + east + columns]
        is_pit &= (other > heights) | ((other == heights) & (their > number))
        data &= ~np.isnan(other)
    return np.flatnonzero(is_pit & data)


def way_out(heights, columns, cell, pit):
    """The least cost of a cut from a pit to lower ground, the border or a hole: depths below the ground times the way."""
    rows = len(heights) // columns
    least, queue, level = {pit: 0.0}, [(0.0, pit)], heights[pit]
    while queue:
        cost, index = heapq.heappop(queue)
        if cost > least[index]:
            continue
        row, column = divmod(index, columns)
        is_inner = 0 < row < rows - 1 and 0 < column < columns - 1
        around = [(index + north * columns + east, math.hypot(east, north)) for east, north in STEPS] if is_inner else []
        if index != pit and (heights[index] < level or not is_inner or any(heights[to] != heights[to] for to, _ in around)):
            return cost
        for to, run in around:
            further = cost + max(heights[to] - level, 0.0) * run * cell
            if further < least.get(to, math.inf):
                least[to] = further
                heapq.heappush(queue, (further, to))
    return math.nan


def breaches(heights, cell):
    """The number of pits, and the sum of the least costs of ways out of each on ground without cuts."""
    flat = heights.astype("f4").astype("f8").ravel().tolist()
    found = pits(heights)
    return len(found), sum(way_out(flat, heights.shape[1], cell, int(pit)) for pit in found)


def watershed(filled, codes, cells, cell, folder):
    path = os.path.join(folder, "filled.tif")
    write(path, filled, cell)
    place = os.path.join(folder, "grass")
    out = [os.path.join(folder, name) for name in ("drain.tif", "acc.tif")]
    lines = [
        f"r.in.gdal input={path} output=d --q",
        "g.region raster=d",
        "r.watershed -s elevation=d accumulation=acc drainage=drain memory=2000 --q",
        f"r.out.gdal input=drain output={out[0]} type=Int16 --q",
        f"r.out.gdal input=acc output={out[1]} type=Float64 --q",
    ]
    subprocess.run(["rm", "-rf", place], check=True)
    subprocess.run(["grass", "-c", path, place, "-e"], check=True, capture_output=True)
    command = ["grass", place + "/PERMANENT", "--exec", "bash", "-c", "set -e; " + "; ".join(lines)]
    subprocess.run(command, check=True, capture_output=True)
    with rasterio.open(out[0]) as file:
        drain = np.abs(file.read(1)[::-1].astype("i4"))
    with rasterio.open(out[1]) as file:
        acc = np.abs(file.read(1)[::-1])
    wanted = np.zeros(codes.shape, dtype="i4")
    for number, step in enumerate(STEPS):
        wanted[codes == number + 1] = GRASS[step]
    inner = (codes > 0) & (codes != 255)
    inner[[0, -1]] = False
    inner[:, [0, -1]] = False
    same_direction = (drain == wanted)[inner].mean()
    same_cells = (np.round(acc) == cells)[inner].mean()
    return same_direction, same_cells


def crc(grid, kind):
    return f"{zlib.crc32(np.ascontiguousarray(grid, dtype=kind).tobytes()):08x}"


def known_directions():
    table = os.path.join(os.path.dirname(__file__), "../../src/analysis/water/oracle.tsv")
    with open(table) as lines:
        head, *rows = [line.rstrip("\n").split("\t") for line in lines]
    return {row[0]: row[head.index("directions")] for row in rows}


def main(program, folder):
    known = known_directions()
    print("file\tcell\toutlets\tbasins\tmagnitudes\tlevel\tseed\tsides\tsides_crc\tcorners\tcorners_crc\tpits\tcosts")
    for name in FILES:
        heights, cell = read(os.path.join(folder, name))
        with tempfile.TemporaryDirectory() as scratch:
            plane = os.path.join(scratch, "plane.tif")
            write(plane, heights, cell)
            codes = analyzed(program, "flow", plane, scratch, "--show", "direction")
            assert crc(codes, "u1") == known[name], f"{name}: the directions are not those of oracle.tsv"
            filled = np.where(np.isnan(heights), np.nan, analyzed(program, "fill", plane, scratch, "--show", "filled"))
            outlets, labels, cells = basins(codes)
            level, seed, joined = floods(heights)
            count, costs = breaches(heights, cell)
            same = watershed(filled, codes, cells, cell, scratch)
        print(f"{name}: r.watershed has the same direction at {same[0]:.4f}, the same drained cells at {same[1]:.4f}", file=sys.stderr)
        row = [name, f"{cell:g}", outlets, crc(labels, "u4"), crc(magnitudes(codes, cells), "u4"), f"{level}", seed]
        for wet in joined:
            row += [int(wet.sum()), crc(wet, "u1")]
        row += [count, f"{costs:.9g}"]
        print("\t".join(map(str, row)), flush=True)


if __name__ == "__main__":
    main(*sys.argv[1:])
