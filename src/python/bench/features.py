"""Compares 100,000 features of a GeoDataFrame with the same of a FlatGeobuf file: python bench/features.py BUILDINGS DEM.

BUILDINGS is a file of polygons that geopandas reads; they are repeated beside each other. One feature is drawn of each, so that
the time is that of handing over or reading all of them.
"""

import sys
import tempfile
import time
import warnings
from pathlib import Path

import geopandas
import pandas
import sandtable as st

COUNT, RUNS = 100_000, 5


def main(buildings, dem):
    warnings.simplefilter("ignore")
    frame = geopandas.read_file(buildings).to_crs(32616)
    frame = frame[[*(name for name in frame.columns if frame[name].notna().any())]]
    frame["geometry"] = frame.geometry.translate(750_000 - frame.total_bounds[0], 4_018_000 - frame.total_bounds[1])
    frame = pandas.concat([frame] * (COUNT // len(frame) + 1), ignore_index=True)[:COUNT]
    frame["number"] = range(COUNT)
    print(f"{len(frame)} features, {len(frame.columns) - 1} columns, {frame.geometry.count_coordinates().sum()} vertices")
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "buildings.fgb"
        frame.to_file(path)
        ground = st.Scene(dem)
        bare = best(lambda: ground.style(ramp="atlas").cameras)
        of_file = best(lambda: ground.buildings(path, where="number = 7").cameras) - bare
        of_frame = best(lambda: ground.buildings(frame, where="number = 7").cameras) - bare
    print(f"FlatGeobuf {of_file:.3f} s, GeoDataFrame {of_frame:.3f} s: {of_frame / of_file:.2f} times; the bare ground {bare:.3f} s")


def best(run):
    """The shortest of some runs, in seconds."""
    times = []
    for _ in range(RUNS):
        start = time.perf_counter()
        run()
        times.append(time.perf_counter() - start)
    return min(times)


if __name__ == "__main__":
    main(*sys.argv[1:])
