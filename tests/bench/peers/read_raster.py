"""Reads a GeoTIFF with rasterio (GDAL) and prints milliseconds, one run a line.

read_raster.py write RAW SIDE OUT PREDICTOR   makes OUT of a square of 32-bit floats, in deflated tiles of 256
read_raster.py whole FILE RUNS                reads the first band, RUNS times
read_raster.py first FILE RUNS                opens it and asks one height near its middle, RUNS times
"""

import sys
import time

import numpy
import rasterio
from rasterio.transform import from_origin


def write(raw, side, out, predictor):
    heights = numpy.fromfile(raw, dtype="<f4").reshape(int(side), int(side))
    profile = dict(
        driver="GTiff", width=heights.shape[1], height=heights.shape[0], count=1, dtype="float32",
        crs="EPSG:32612", transform=from_origin(500000, 4000000, 10, 10), nodata=-9999,
        tiled=True, blockxsize=256, blockysize=256, compress="deflate", predictor=int(predictor),
    )
    with rasterio.open(out, "w", **profile) as file:
        file.write(heights, 1)


def whole(path):
    with rasterio.open(path) as file:
        return float(file.read(1)[-1, -1])


def first(path):
    with rasterio.open(path) as file:
        return next(file.sample([(500000 + file.width * 5 + 3, 4000000 - file.height * 5 - 4)]))


def timed(work, path, runs):
    work(path)  # the first use in a process also starts GDAL
    for _ in range(int(runs)):
        start = time.perf_counter()
        work(path)
        print((time.perf_counter() - start) * 1e3)


if __name__ == "__main__":
    what, *rest = sys.argv[1:]
    if what == "write":
        write(*rest)
    else:
        timed({"whole": whole, "first": first}[what], *rest)
