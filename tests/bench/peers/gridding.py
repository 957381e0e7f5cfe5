"""Times gridding of x,y,z text in place: scipy's linear griddata, then startin's natural neighbors (NaN without it).

usage: gridding.py POINTS.csv SIDE    prints milliseconds, one number a line
"""
import sys
import time

import numpy as np
from scipy.interpolate import griddata

points = np.loadtxt(sys.argv[1], delimiter=",", skiprows=1)
side = int(sys.argv[2])
x, y = np.meshgrid(np.arange(side, dtype=float), np.arange(side, dtype=float))

start = time.perf_counter()
griddata(points[:, :2], points[:, 2], (x, y), method="linear")
print((time.perf_counter() - start) * 1e3)

try:
    import startinpy
except ImportError:
    print("nan")
else:
    start = time.perf_counter()
    dt = startinpy.DT()
    dt.insert(points)
    dt.interpolate({"method": "NNI", "precompute": True}, np.column_stack([x.ravel(), y.ravel()]), strict=False)
    print((time.perf_counter() - start) * 1e3)
