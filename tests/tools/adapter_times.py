"""Measures frames and pictures on a graphics adapter beside the processor, without a window or a display.

    python3 tests/tools/adapter_times.py PROGRAM [FOLDER] [--only frames,pictures,series]

PROGRAM is a release build with the features `gpu` and `viewer`. Needs Python alone: no package, no registry, no display. The
scenes of the repository are read beside this file; FOLDER holds more scene folders, such as those that `sandtable new` makes
of the places of the test data, each with its `scene.toml`. Frames are those of the window, drawn on a texture
(`view --offscreen`). Every time is a whole process's, or a median of its frames; the processor's pictures are drawn in turns
with the adapter's. Prints the tables of `tests/bench/README.md`.
"""

import argparse
import json
import math
import os
import subprocess
import sys
import tempfile
from array import array
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
CELL_M = 30
REPEATS = 3
PAGED_SIDE = 16_384


def run(program, *words, **options):
    command = [program, *map(str, words)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=1800, **options)
    if done.returncode != 0:
        raise SystemExit(f"FAILED: {' '.join(map(str, command))}: {done.stderr}")
    return done.stdout


def height(x, y):
    """Hills of all sizes, meters, at meters east and north."""
    waves = [(9000, 260), (4100, 140), (1900, 70), (830, 30), (370, 12)]
    return 600 + sum(
        high * math.sin((x * 0.8 + y * 0.6) * math.tau / length + turn) * math.cos((y * 0.8 - x * 0.6) * math.tau / length)
        for turn, (length, high) in enumerate(waves)
    )


def write_terrain(folder, side):
    """A raster of floats with its header (ESRI .flt) of `side` posts a side; hills that repeat."""
    path, period = folder / f"hills{side}.flt", 1024
    if path.exists():
        return path
    block = [[height(column * CELL_M, row * CELL_M) for column in range(min(side, period))] for row in range(min(side, period))]
    rows = [array("f", (row * (side // len(row) + 1))[:side]) for row in block]
    with open(path, "wb") as out:
        for row in range(side):
            out.write(rows[(side - 1 - row) % len(rows)].tobytes())
    order = "LSBFIRST" if sys.byteorder == "little" else "MSBFIRST"
    head = f"ncols {side}\nnrows {side}\nxllcorner 0\nyllcorner 0\ncellsize {CELL_M}\nNODATA_value -9999\nbyteorder {order}\n"
    path.with_suffix(".hdr").write_text(head)
    return path


def frames(program, scene, script, size, folder):
    """The report of the frames of a script."""
    commands = folder / "script.txt"
    commands.write_text("\n".join([*script, "quit"]) + "\n")
    said = run(program, "view", scene, "--offscreen", "--size", size, "--script", commands, "--json", "--allow", ROOT)
    return json.loads(said)


def over(middle, radius_m, high_m, legs, steps):
    """Legs of a flight around a place, looking at it."""
    eye = lambda turn: (middle[0] + radius_m * math.sin(turn), middle[1] - radius_m * math.cos(turn), high_m)
    text = lambda point: ",".join(f"{number:.0f}" for number in point)
    turns = [leg * math.tau / legs for leg in range(legs + 1)]
    return [f"fly {text(eye(turn))} {text(middle)} {steps}" for turn in turns]


def frame_row(name, size, report):
    parts = report["milliseconds"]
    median = lambda part: (parts[part] or {"median": float("nan")})["median"]
    columns = ["frame", "update", "upload", "draw", "panels", "wait", "device"]
    cells = [f"{median(column):8.2f}" for column in columns[:1]] + [f"{parts['frame']['p99']:8.2f}"]
    cells += [f"{median(column):8.2f}" for column in columns[1:]]
    print(f"{name:>22} {size:>10} {report['frames']:>6} {' '.join(cells)} {report['calls']:6.0f} {report['pipelines']:5}", flush=True)


def frame_table(program, places, folder):
    print("frames without a window, ms: median and 99 of 100 of whole frames, medians of their parts; calls and pipelines")
    head = ["frame", "p99", "update", "upload", "draw", "panels", "wait", "device"]
    print(f"{'scene':>22} {'size':>10} {'frames':>6} {' '.join(f'{word:>8}' for word in head)} {'calls':>6} {'pipes':>5}")
    demo = ROOT / "scenes/jacksboro.toml"
    flight = over((753700, 4020000, 500), 6000, 2200, 12, 20)
    passes, adapter = {}, ""
    for size in ["1024x768", "1920x1080", "3840x2160"]:
        report = frames(program, demo, ["wait 20", *flight], size, folder)
        frame_row("demo", size, report)
        passes[f"demo {size}"], adapter = report["passes"], report["adapter"]
    for name, scene in [
        ("forest", ROOT / "scenes/forest.toml"),
        *((place.parent.name, place) for place in places),
    ]:
        for size in ["1920x1080", "3840x2160"]:
            report = frames(program, scene, ["wait 20", *["key C", "wait 80"] * 4], size, folder)
            frame_row(name, size, report)
            passes[f"{name} {size}"] = report["passes"]
    for side in [129, 257, 513, 1025, PAGED_SIDE]:
        terrain, extent = write_terrain(folder, side), (side - 1) * CELL_M
        reach = min(extent, 1024 * CELL_M)
        start = f"fly {extent / 2:.0f},{-0.1 * reach:.0f},{600 + 0.25 * reach:.0f} {extent / 2:.0f},{reach / 2:.0f},600 1"
        end = f"fly {extent / 2:.0f},{0.5 * reach:.0f},{600 + 0.25 * reach:.0f} {extent / 2:.0f},{reach:.0f},600 300"
        frame_row(f"walk {side}²", "1024x768", frames(program, terrain, [start, "wait 60", end], "1024x768", folder))
    print(f"\non {adapter}; passes, ms (median)")
    for name, times in passes.items():
        print(f"{name:>32}: " + ", ".join(f"{label} {time['median']:.2f}" for label, time in (times or {}).items()))


def picture(program, scene, size, backend, out):
    words = ["render", scene, "--size", size, "--backend", backend, "--json", "-o", out, "--allow", ROOT]
    return json.loads(run(program, *words))["seconds"]


ADAPTER_STEPS = [
    "opening the adapter", "translating shaders", "casting shadows", "making pipelines", "sending the scene",
    "drawing on the adapter", "reading the picture back",
]


def picture_table(program, places, folder):
    print("\npictures, s: drawing by the processor and by the adapter, best of three in turns, and the adapter's steps")
    print(f"{'scene':>22} {'size':>10} {'cpu':>6} {'gpu':>6}  " + "  ".join(ADAPTER_STEPS))
    out = folder / "picture.png"
    for name, scene in [
        ("demo", ROOT / "scenes/jacksboro.toml"), ("forest", ROOT / "scenes/forest.toml"),
        *((place.parent.name, place) for place in places),
    ]:
        for size in ["320x180", "1920x1080", "3840x2160"]:
            runs = [[picture(program, scene, size, backend, out) for backend in ("cpu", "gpu")] for _ in range(REPEATS)]
            drawn = lambda steps: sum(steps.get(step, 0) for step in ["drawing", *ADAPTER_STEPS])
            by_processor = min(drawn(processor) for processor, _ in runs)
            best = min((adapter for _, adapter in runs), key=drawn)
            steps = "  ".join(f"{best.get(step, 0):{len(step)}.3f}" for step in ADAPTER_STEPS)
            print(f"{name:>22} {size:>10} {by_processor:6.2f} {drawn(best):6.2f}  {steps}", flush=True)


def series_table(program, folder):
    print("\na flight by the adapter, 1920×1080, s of a whole process: one frame, eleven frames, and each frame after the first")
    scene = ROOT / "scenes/river.toml"
    for backend in ["cpu", "gpu"]:
        best = {}
        for count in [1, 11]:
            times = []
            for repeat in range(REPEATS):
                out = folder / f"flight-{backend}-{count}-{repeat}"
                begun = os.times().elapsed
                run(program, "fly", scene, "-o", out, "--size", "1920x1080", "--seconds", count, "--fps", 1,
                    "--backend", backend, "--allow", ROOT)
                times.append(os.times().elapsed - begun)
            best[count] = min(times)
        print(f"{backend:>6} {best[1]:8.2f} {best[11]:8.2f} {(best[11] - best[1]) / 10:8.3f}", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("program", type=lambda path: Path(path).resolve())
    parser.add_argument("folder", type=Path, nargs="?")
    parser.add_argument("--only", default="frames,pictures,series")
    options = parser.parse_args()
    wanted = options.only.split(",")
    places = sorted(options.folder.glob("*/scene.toml")) if options.folder else []
    with tempfile.TemporaryDirectory() as scratch:
        folder = Path(scratch)
        if "frames" in wanted:
            frame_table(options.program, places, folder)
        if "pictures" in wanted:
            picture_table(options.program, places, folder)
        if "series" in wanted:
            series_table(options.program, folder)


if __name__ == "__main__":
    main()
