#!/usr/bin/env python3
"""GRASS's r.viewshed in a session made for it.

usage: viewshed_grass.py RAW SIZE X Y EYE    prints the milliseconds of r.viewshed itself, without starting GRASS and
importing the raster; RAW is a raster that GDAL reads; needs grass on the PATH."""
import os
import subprocess
import sys
import time

if os.environ.get("GISRC"):
    raw, _, x, y, eye = sys.argv[1:6]
    quiet = dict(check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    subprocess.run(["r.in.gdal", "-o", f"input={raw}", "output=ground"], **quiet)
    subprocess.run(["g.region", "raster=ground"], **quiet)
    start = time.perf_counter()
    subprocess.run(
        ["r.viewshed", "-c", "-r", "-b", "input=ground", "output=seen", f"coordinates={x},{y}",
         f"observer_elevation={eye}", "memory=4000"], **quiet)
    print((time.perf_counter() - start) * 1e3)
else:
    subprocess.run(["grass", "--tmp-location", "XY", "--exec", sys.executable, __file__] + sys.argv[1:], check=True,
                   stderr=subprocess.DEVNULL)
