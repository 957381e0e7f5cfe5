#!/usr/bin/env python3
"""A viewshed by one line a cell over the bilinear surface (Franklin and Ray's R3), with numba on one thread.

usage: viewshed_lines.py RAW SIZE COLUMN ROW EYE    prints milliseconds; RAW holds SIZE x SIZE float32, rows from the
north; needs numpy and numba. Neither curvature nor refraction."""
import sys
import time

import numpy as np
from numba import njit


@njit(fastmath=True)
def lines(z, cx, cy, eye, out):
    n = z.shape[0]
    for ty in range(n):
        for tx in range(n):
            dx = tx - cx
            dy = ty - cy
            m = max(abs(dx), abs(dy))
            target = z[ty, tx]
            seen = 1
            for i in range(1, m):
                t = i / m
                fx = cx + dx * t
                fy = cy + dy * t
                xi = int(fx)
                yi = int(fy)
                u = fx - xi
                v = fy - yi
                xj = min(xi + 1, n - 1)
                yj = min(yi + 1, n - 1)
                low = z[yi, xi] * (1 - u) + z[yi, xj] * u
                high = z[yj, xi] * (1 - u) + z[yj, xj] * u
                if low * (1 - v) + high * v > eye + (target - eye) * t:
                    seen = 0
                    break
            out[ty, tx] = seen


raw, size, column, row, above = sys.argv[1], int(sys.argv[2]), int(sys.argv[3]), int(sys.argv[4]), float(sys.argv[5])
z = np.fromfile(raw, np.float32).reshape(size, size)
lines(z[:9, :9].copy(), 4, 4, float(z[4, 4]) + above, np.zeros((9, 9), np.uint8))  # compiles
out = np.zeros((size, size), np.uint8)
start = time.perf_counter()
lines(z, column, row, float(z[row, column]) + above, out)
print((time.perf_counter() - start) * 1e3)
