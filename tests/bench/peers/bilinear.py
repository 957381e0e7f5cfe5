"""Bilinear heights at many points by others, on one thread: answers one command a line until its input ends.

    bilinear.py FOLDER

FOLDER holds field_N.f32 (N x N heights, row by row) and random_N.f64, line_N.f64 (points as column, row in posts). A
command is `WHO WHAT N`, who is numba, answering, scipy or rasterio, what is random or line; the answer is million points a second.

numba    the plain loop over positions in posts, compiled with fastmath; no status, nothing said of holes
answering  the same loop in what ours reads and writes: positions on the map, heights of 64 bits, statuses
scipy    ndimage.map_coordinates of order 1
rasterio DatasetReader.sample, nearest only, of an uncompressed GeoTIFF made of the field; on fewer points
"""
import os
import sys
import time

for threads in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "NUMBA_NUM_THREADS"):
    os.environ[threads] = "1"

import numpy as np
import rasterio
from numba import njit
from rasterio.transform import from_origin
from scipy.ndimage import map_coordinates

FOLDER = sys.argv[1]
RASTERIO_POINTS = 20_000
# Where the fields of the bench lie.
ORIGIN = (500_000.0, 4_000_000.0)
CELL_M = 10.0


@njit(fastmath=True)
def loop(field, points, out):
    for i in range(points.shape[0]):
        x = points[i, 0]
        y = points[i, 1]
        column = int(x)
        row = int(y)
        u = x - column
        v = y - row
        south = field[row, column] + u * (field[row, column + 1] - field[row, column])
        north = field[row + 1, column] + u * (field[row + 1, column + 1] - field[row + 1, column])
        out[i] = south + v * (north - south)


@njit
def answering_loop(field, points, out, statuses):
    last_column, last_row = field.shape[1] - 1, field.shape[0] - 1
    for i in range(points.shape[0]):
        x = (points[i, 0] - ORIGIN[0]) / CELL_M
        y = (points[i, 1] - ORIGIN[1]) / CELL_M
        if not (x >= 0 and y >= 0 and x <= last_column and y <= last_row):
            out[i] = np.nan
            statuses[i] = 2
            continue
        column = min(int(x), last_column - 1)
        row = min(int(y), last_row - 1)
        u = x - column
        v = y - row
        sw, se = np.float64(field[row, column]), np.float64(field[row, column + 1])
        nw, ne = np.float64(field[row + 1, column]), np.float64(field[row + 1, column + 1])
        south = sw + (se - sw) * u
        north = nw + (ne - nw) * u
        height = south + (north - south) * v
        out[i] = height
        statuses[i] = 1 if np.isnan(height) else 0


cache = {}


def field_of(n):
    if n not in cache:
        cache[n] = np.fromfile(f"{FOLDER}/field_{n}.f32", np.float32).reshape(n, n)
    return cache[n]


def points_of(what, n):
    if (what, n) not in cache:
        points = np.fromfile(f"{FOLDER}/{what}_{n}.f64", np.float64).reshape(-1, 2)
        # The plain loop reads the post after a point's own.
        cache[what, n] = np.ascontiguousarray(np.minimum(points, n - 1.001))
    return cache[what, n]


def tif_of(n):
    if ("tif", n) not in cache:
        name = f"{FOLDER}/field_{n}.tif"
        with rasterio.open(name, "w", driver="GTiff", width=n, height=n, count=1, dtype="float32",
                           transform=from_origin(-0.5, n - 0.5, 1, 1)) as tif:
            tif.write(field_of(n)[::-1], 1)
        cache["tif", n] = rasterio.open(name)
    return cache["tif", n]


def run(who, what, n):
    field, points = field_of(n), points_of(what, n)
    if who == "numba":
        out = cache.setdefault(("out", n), np.zeros(len(points), np.float32))
        loop(field, points[:10], out)
        start = time.perf_counter()
        loop(field, points, out)
    elif who == "answering":
        if ("map", what, n) not in cache:
            cache["map", what, n] = points * CELL_M + np.array(ORIGIN)
        points = cache["map", what, n]
        out = cache.setdefault("heights", np.zeros(len(points)))
        statuses = cache.setdefault("statuses", np.zeros(len(points), np.uint8))
        answering_loop(field, points[:10], out, statuses)
        start = time.perf_counter()
        answering_loop(field, points, out, statuses)
    elif who == "scipy":
        swapped = np.ascontiguousarray(points[:, ::-1].T)
        start = time.perf_counter()
        map_coordinates(field, swapped, order=1, output=np.float32)
    else:
        tif, points = tif_of(n), points[:RASTERIO_POINTS]
        pairs = [tuple(point) for point in points]
        start = time.perf_counter()
        np.fromiter((value[0] for value in tif.sample(pairs)), np.float32, len(pairs))
    return len(points) / (time.perf_counter() - start) / 1e6


for line in sys.stdin:
    who, what, n = line.split()
    print(run(who, what, int(n)), flush=True)
