"""Measures the window of `sandtable view`: whole frames, opening, and a flight of one minute, on the adapter at hand.

    python3 tests/tools/window_times.py PROGRAM [walks|demo]

PROGRAM is a release build with the feature `viewer`. Needs Xvfb and openbox. Prints the tables of `tests/bench/README.md`;
`walks` or `demo` after PROGRAM prints those alone.
"""

import json
import math
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
PROGRAM = str(Path(sys.argv[1]).resolve())
SIZES = [129, 257, 513, 1025]
CELL_M = 30


def height(x, y):
    """Hills of all sizes, meters, at meters east and north."""
    waves = [(9000, 260), (4100, 140), (1900, 70), (830, 30), (370, 12), (150, 4)]
    at = [(x * 0.8 + y * 0.6, y * 0.8 - x * 0.6), (x, y)]
    return 600 + sum(
        high * math.sin(at[turn % 2][0] * math.tau / length + turn) * math.cos(at[turn % 2][1] * math.tau / length)
        for turn, (length, high) in enumerate(waves)
    )


def write_terrain(path, side):
    """An ESRI ASCII grid of `side` posts a side."""
    rows = (
        " ".join(f"{height(column * CELL_M, row * CELL_M):.1f}" for column in range(side))
        for row in reversed(range(side))
    )
    head = f"ncols {side}\nnrows {side}\nxllcenter 0\nyllcenter 0\ncellsize {CELL_M}\n"
    path.write_text(head + "\n".join(rows) + "\n")


def report(environment, scene, script, folder):
    """What the window says of a script."""
    commands = folder / "script.txt"
    commands.write_text(script)
    command = [PROGRAM, "view", str(scene), "--script", str(commands), "--json"]
    done = subprocess.run(command, env=environment, capture_output=True, text=True, timeout=1800)
    if done.returncode != 0:
        raise SystemExit(f"FAILED: {' '.join(command)}: {done.stderr}")
    return json.loads(done.stdout)


def circle(middle, radius_m, high_m, legs, frames):
    """Legs around a place, looking at it."""
    lines = []
    for leg in range(legs + 1):
        turn = leg * math.tau / legs
        eye = [middle[0] + radius_m * math.sin(turn), middle[1] - radius_m * math.cos(turn), high_m]
        target = [middle[0], middle[1], middle[2]]
        of = [",".join(f"{number:.0f}" for number in point) for point in (eye, target)]
        lines.append(f"fly {of[0]} {of[1]} {frames}")
    return lines


def walks(environment, folder):
    print("walk, 1024×768, whole frames, ms (median, 99 of 100), and its parts (medians)")
    print(f"{'posts':>8} {'frame':>8} {'p99':>8} {'update':>8} {'upload':>8} {'draw':>8} {'panels':>8} {'triangles':>10}")
    medians = []
    for side in SIZES:
        terrain = folder / f"walk-{side}.asc"
        write_terrain(terrain, side)
        # Each sees as much ground, at the posts' distance: the middle of the terrain from its south.
        extent = (side - 1) * CELL_M
        start = [f"{extent / 2:.0f},{-0.1 * extent:.0f},{600 + 0.25 * extent:.0f}", f"{extent / 2:.0f},{extent / 2:.0f},600"]
        end = [f"{extent / 2:.0f},{0.5 * extent:.0f},{600 + 0.25 * extent:.0f}", f"{extent / 2:.0f},{extent:.0f},600"]
        script = ["resize 1024x768", "key T", f"fly {start[0]} {start[1]} 1", "wait 20", f"fly {end[0]} {end[1]} 300", "quit"]
        times = report(environment, terrain, "\n".join(script), folder)
        part = times["milliseconds"]
        medians.append(part["frame"]["median"])
        cells = [part["frame"]["median"], part["frame"]["p99"], *(part[name]["median"] for name in ("update", "upload", "draw", "panels"))]
        print(f"{side:>7}²" + "".join(f" {cell:8.2f}" for cell in cells) + f" {times['ground_triangles']:>10}")
    print(f"{SIZES[-1]}² / {SIZES[0]}²: {medians[-1] / medians[0]:.2f}")


def demo(environment, folder):
    scene = ROOT / "scenes/jacksboro.toml"
    def flight(frames):
        legs = circle((753700, 4020000, 500), 6000, 2200, 12, max(1, round(frames / 12)))[:12]
        return report(environment, scene, "\n".join(["wait 5", *legs, "quit"]), folder)

    # As many frames as the adapter draws in a minute.
    times = flight(60_000 / flight(24)["milliseconds"]["frame"]["median"])
    part = times["milliseconds"]["frame"]
    print(f"\ndemo on {times['adapter']}: window {times['window_s']:.2f} s, first picture {times['first_picture_s']:.2f} s")
    print(f"a flight of one minute, {times['frames']} frames: median {part['median']:.1f} ms, 99 of 100 {part['p99']:.1f} ms,")
    print(f"longest {part['longest']:.1f} ms, {times['over_33_ms']} dropped (more than 33 ms)")
    middle = "753700,4020000"
    tasks = {
        "sun": ["sun 120,30"], "heights": ["heights 2.5"], "hiding": ["hide roads"], "showing": ["show roads"],
        "crater": [f"edit crater {middle} 60", "wait 1"], "undo": ["undo"], "viewshed": [f"viewshed {middle}"],
        "reading again": ["key Ctrl+R"],
    }
    print("\nthe longest time between two frames, and of the window's own work in one, ms, while it")
    for name, lines in tasks.items():
        done = report(environment, scene, "\n".join(["wait 20", *lines, "wait 10", *["undo"] * 2, "quit"]), folder)
        during = [entry for entry in done["commands"] if "longest_gap_ms" in entry][1:]
        gap = max(entry["longest_gap_ms"] for entry in during)
        own = max(entry["longest_own_ms"] for entry in during)
        print(f"{name:>14} {gap:8.1f} {own:8.1f}")


def main():
    with tempfile.TemporaryDirectory() as runtime:
        read, write = os.pipe()
        server = subprocess.Popen(
            ["Xvfb", "-displayfd", str(write), "-screen", "0", "1400x900x24"], pass_fds=[write], stderr=subprocess.DEVNULL
        )
        os.close(write)
        with os.fdopen(read) as number_pipe:
            number = number_pipe.readline().strip()
        environment = dict(os.environ, DISPLAY=f":{number}", XDG_RUNTIME_DIR=runtime, XDG_CONFIG_HOME=runtime)
        environment.pop("WAYLAND_DISPLAY", None)
        manager = subprocess.Popen(["openbox"], env=environment, stderr=subprocess.DEVNULL)
        time.sleep(1)
        try:
            for tables in [walks, demo]:
                if sys.argv[2:] in ([], [tables.__name__]):
                    tables(environment, Path(runtime))
        finally:
            for process in [manager, server]:
                process.terminate()
                process.wait()


main()
