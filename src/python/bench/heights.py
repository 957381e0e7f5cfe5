"""What a million heights cost from Python, beside the library's own time for the same positions.

usage: python src/python/bench/heights.py [DEM], with the wheel of a release build installed, after
       cargo build --release --example heights, in src/python
"""

import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
import sandtable

ROOT = Path(__file__).resolve().parents[3]
RUNS = 30
# Each program is measured so often, one after the other, so that both meet the same load.
ROUNDS = 5

path = Path(sys.argv[1] if len(sys.argv) > 1 else ROOT / "assets/jacksboro/dem.tif")
own = ROOT / "target/release/examples/heights"
dem = sandtable.Dem.open(path)
west, south, east, north = dem.bounds
for count in [1, 1_000, 1_000_000]:
    xy = np.random.default_rng(0).uniform((west, south), (east, north), (count, 2))
    with tempfile.TemporaryDirectory() as folder:
        positions = Path(folder) / "positions"
        positions.write_bytes(xy.astype("<f8").tobytes())
        best = {"library": np.inf, "Python": np.inf}
        for _ in range(ROUNDS):
            printed = subprocess.run([own, path, positions, str(RUNS)], capture_output=True, check=True).stdout
            best["library"] = min(best["library"], float(printed))
            for _ in range(RUNS):
                start = time.perf_counter()
                dem.heights(xy)
                best["Python"] = min(best["Python"], time.perf_counter() - start)
    nanoseconds = {name: seconds / count * 1e9 for name, seconds in best.items()}
    speed = best["library"] / best["Python"]
    print(f"{count:>9} heights: library {nanoseconds['library']:.1f} ns each, Python {nanoseconds['Python']:.1f}, speed {speed:.2f}")
print(f"load {os.getloadavg()[0]:.1f}, {os.cpu_count()} cores, {path.name}")
