"""Tables of RichDEM, pysheds and pyflwdir for the kinds of analysis about water.

    pip install richdem==0.3.4 pysheds pyflwdir rasterio numpy==1.26
    python tests/tools/analysis_water_oracle.py ../shared/data/dem > src/analysis/water/oracle.tsv

RichDEM 0.3.4 builds with Python 3.11 when the pybind11 that it carries is replaced by 2.11 and its sources are compiled as
C++14.

For each elevation file, a line with sizes, counts and CRCs of results; no elevations. Rows run from the south.

* `filled`: FillDepressions of RichDEM (Zhou et al. 2016) as f32, NaN without data.
* `directions`: on that ground, the steepest fall; of several, the first from the east counter-clockwise. Where one is the
  steepest, pysheds has it too (checked here). In flats, the lowest of the mask of ResolveFlats of RichDEM (Barnes et al.
  2014b), sides before diagonals. Codes 1 to 8, 0 off the land, 255 without data.
* `cells`: FlowAccumulation of RichDEM along these directions, and the same of pyflwdir (checked here), as u32.
"""

import sys
import zlib
import os

import numpy as np
import rasterio

FILES = [
    "SainteHelens.dem",
    "bigtujunga_utm11_i16_tiled.tif",
    "zion_srtm_u16_deflate.tif",
    "kootenai_1m.asc",
    "west_bijou_gully.asc",
]

# Columns east and rows north of the eight neighbors, from the east counter-clockwise.
STEPS = [(1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1)]
# RichDEM counts from the west clockwise, its rows from the north.
RICHDEM = {(-1, 0): 1, (-1, 1): 2, (0, 1): 3, (1, 1): 4, (1, 0): 5, (1, -1): 6, (0, -1): 7, (-1, -1): 8}
ESRI = {(1, 0): 1, (1, -1): 2, (0, -1): 4, (-1, -1): 8, (-1, 0): 16, (-1, 1): 32, (0, 1): 64, (1, 1): 128}


def quiet(function, *arguments, **named):
    """Calls a function of RichDEM without what it prints."""
    sys.stdout.flush()
    sys.stderr.flush()
    saved = [os.dup(1), os.dup(2)]
    nowhere = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, 1)
    os.dup2(nowhere, 2)
    try:
        return function(*arguments, **named)
    finally:
        for number, copy in zip((1, 2), saved):
            os.dup2(copy, number)
            os.close(copy)
        os.close(nowhere)


def read(path):
    """Heights as f64 with NaN, rows from the south, and the sides of the cell."""
    with rasterio.open(path) as file:
        heights = file.read(1).astype("f8")
        if file.nodata is not None:
            heights[file.read(1) == file.nodata] = np.nan
        # Cells of degrees count as square: their sides differ by rounding alone, which would part equal falls.
        is_metric = file.crs is None or not file.crs.is_geographic
        return heights[::-1].copy(), (file.res if is_metric else (1.0, 1.0))


def shifted(grid, step, fill):
    """What each cell has at a step."""
    east, north = step
    padded = np.pad(grid, 1, constant_values=fill)
    rows, columns = grid.shape
    return padded[1 + north : 1 + north + rows, 1 + east : 1 + east + columns]


def richdem_array(heights):
    import richdem

    array = richdem.rdarray(np.where(np.isnan(heights), -9999.0, heights)[::-1].astype("f8"), no_data=-9999.0)
    array.geotransform = [0, 1, 0, 0, 0, -1]
    return array


def fill(heights):
    import richdem

    filled = quiet(richdem.FillDepressions, richdem_array(heights), epsilon=False, in_place=False)
    filled = np.array(filled, dtype="f8")[::-1]
    return np.where(np.isnan(heights), np.nan, filled)


def mask_of_flats(filled):
    """The number of increments that ResolveFlats adds to each cell."""
    import richdem

    array = richdem_array(filled)
    resolved = np.array(quiet(richdem.ResolveFlats, array, in_place=False), dtype="f8")[::-1]
    # Increments are steps to the next number: those between two positive numbers are the difference of their bits.
    bits = np.where(np.isnan(filled), 0.0, resolved).view("i8") - np.where(np.isnan(filled), 0.0, filled).view("i8")
    return np.where(np.isnan(filled), 0, bits)


def directions(filled, cell):
    """Codes, and which cells have one steepest fall, several, or lie in flats."""
    data = ~np.isnan(filled)
    runs = [np.hypot(east * cell[0], north * cell[1]) for east, north in STEPS]
    falls = np.stack([(filled - shifted(filled, step, np.nan)) / run for step, run in zip(STEPS, runs)])
    falls = np.where(np.isnan(falls), -np.inf, falls)
    steepest = falls.max(axis=0)
    falling = data & (steepest > 0)
    # Falls that differ by rounding alone are one.
    near = falls >= steepest - np.abs(steepest) * 1e-12
    codes = np.where(falling, np.argmax(near, axis=0) + 1, 0)
    several = falling & (near.sum(axis=0) > 1)
    around = np.stack([shifted(filled, step, np.nan) for step in STEPS])
    outlet = data & np.isnan(around).any(axis=0)
    flat = data & ~falling & ~outlet
    mask = mask_of_flats(filled)
    # Outlets of a flat are below all of its cells.
    rated = np.full((8,) + filled.shape, np.inf)
    for number, step in enumerate(STEPS):
        other = shifted(np.where(flat, mask.astype("f8"), -1.0), step, np.inf)
        level = shifted(filled, step, np.nan) == filled
        rated[number] = np.where(level, 2 * other + number % 2 * 0.5, np.inf)
    codes[flat] = np.argmin(rated, axis=0)[flat] + 1
    codes[~data] = 255
    return codes.astype("u1"), falling & ~several, several, flat


def check_with_pysheds(filled, cell, codes, single):
    """pysheds has the same direction in inner cells with one steepest fall."""
    from affine import Affine
    from pyproj import Proj
    from pysheds.grid import Grid
    from pysheds.sview import Raster, ViewFinder

    heights = np.where(np.isnan(filled), -9999.0, filled)[::-1].copy()
    affine = Affine(cell[0], 0, 0, 0, -cell[1], 0)
    view = ViewFinder(affine=affine, shape=heights.shape, nodata=np.float64(-9999.0), crs=Proj("epsg:32633"))
    raster = Raster(heights, viewfinder=view)
    grid = Grid.from_raster(raster)
    found = np.array(grid.flowdir(raster, flats=-1, pits=-2, nodata_out=np.int64(0)))[::-1]
    inner = single.copy()
    inner[[0, -1]] = False
    inner[:, [0, -1]] = False
    # pysheds drains into holes.
    for step in STEPS:
        inner &= ~np.isnan(shifted(filled, step, np.nan))
    wanted = np.zeros(codes.shape, dtype="i8")
    for number, step in enumerate(STEPS):
        wanted[codes == number + 1] = ESRI[step]
    return int((found != wanted)[inner].sum()), int(inner.sum())


def accumulate(codes):
    import pyflwdir
    import richdem

    north_first = codes[::-1]
    props = np.full(codes.shape + (9,), -1.0, dtype="f4")
    props[..., :] = 0
    props[..., 0] = np.where(north_first == 255, -2, np.where(north_first == 0, -1, 0))
    esri = np.full(codes.shape, 247, dtype="u1")
    esri[north_first == 0] = 0
    for number, step in enumerate(STEPS):
        here = north_first == number + 1
        props[here, RICHDEM[step]] = 1
        esri[here] = ESRI[step]
    # RichDEM passes on nothing along the border; cells without data around it make it an inner one.
    props = np.pad(props, ((1, 1), (1, 1), (0, 0)))
    props[[0, -1], :, 0] = -2
    props[:, [0, -1], 0] = -2
    array = richdem.rd3array(props, no_data=-2, geotransform=[0, 1, 0, 0, 0, -1])
    cells = np.array(quiet(richdem.FlowAccumFromProps, array), dtype="f8")[1:-1, 1:-1][::-1]
    cells = np.where(codes == 255, 0, cells)
    other = pyflwdir.from_array(esri, ftype="d8", check_ftype=False).upstream_area(unit="cell")[::-1]
    other = np.where(codes == 255, 0, other)
    return cells, int((cells != other).sum())


def crc(grid, kind):
    grid = np.ascontiguousarray(grid, dtype=kind)
    if kind == "f4":
        grid = np.where(np.isnan(grid), np.float32(np.nan), grid + np.float32(0.0)).astype("f4")
    return f"{zlib.crc32(grid.tobytes()):08x}"


def main(folder):
    print("file\tcolumns\trows\tcell\theights\traised\tfilled\tone\tseveral\tflat\tdirections\tmost\tcells")
    for name in FILES:
        heights, cell = read(os.path.join(folder, name))
        assert f"{cell[0]:g}" == f"{cell[1]:g}", "the test takes square cells"
        filled = fill(heights)
        codes, single, several, flat = directions(filled, cell)
        unequal, compared = check_with_pysheds(filled, cell, codes, single)
        cells, off = accumulate(codes)
        print(f"{name}: pysheds differs at {unequal} of {compared} cells, pyflwdir at {off}", file=sys.stderr)
        row = [
            name,
            heights.shape[1],
            heights.shape[0],
            f"{cell[0]:g}",
            crc(heights, "f4"),
            int((filled > heights).sum()),
            crc(filled, "f4"),
            int(single.sum()),
            int(several.sum()),
            int(flat.sum()),
            crc(codes, "u1"),
            int(cells.max()),
            crc(cells, "u4"),
        ]
        print("\t".join(map(str, row)))


if __name__ == "__main__":
    main(sys.argv[1])
