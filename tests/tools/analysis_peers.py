"""Measures terrain analyses beside gdaldem, GRASS and richdem: whole processes, interleaved in one run, the best of three.

    python3 tests/tools/analysis_peers.py PROGRAM [--side 4097] [--folder FOLDER] [--python PYTHON] [--only WORD,…]

PROGRAM is a release build. Needs gdal-bin and grass-core; PYTHON is a Python that has richdem, for its row. The elevation is
made here: fractal hills of SIDE posts a side, 30 m apart, written as a GeoTIFF of floats without compression. Peers of GRASS
work on a raster that was imported before and is not timed; a process counts from its start to its end with its files written.
Prints the table of the page on speed, and one of threads.
"""

import argparse
import math
import os
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

CELL_M = 30
REPEATS = 3
WEST_M, NORTH_M = 400_000, 5_000_000


def fractal(side):
    """Rows of heights in meters from the north: midpoints displaced by less at each halving (Fournier et al. 1982)."""
    try:
        import numpy
    except ImportError:
        sys.exit("numpy is needed to make the elevation: run this with --python's Python")
    numbers = numpy.random.default_rng(7)
    heights = numbers.normal(size=(3, 3)).astype("f4")
    amplitude = 1.0
    while heights.shape[0] < side:
        size = 2 * heights.shape[0] - 1
        finer = numpy.zeros((size, size), "f4")
        finer[::2, ::2] = heights
        finer[1::2, ::2] = (heights[:-1] + heights[1:]) / 2
        finer[:, 1::2] = (finer[:, :-2:2] + finer[:, 2::2]) / 2
        amplitude *= 0.48
        noise = numbers.normal(size=(size, size)).astype("f4") * amplitude
        noise[::2, ::2] *= 0.3
        heights = finer + noise
    heights = heights[:side, :side]
    low, high = heights.min(), heights.max()
    return ((heights - low) / (high - low) * 1800 + 50).astype("<f4")


def write_elevation(folder, side):
    """A GeoTIFF of the fractal; its path."""
    raw, tif = folder / f"hills{side}.bin", folder / f"hills{side}.tif"
    if tif.exists():
        return tif
    # In a process of its own: those that are measured inherit the most memory that this one ever had.
    code = f"import sys; sys.argv = ['']; sys.path.insert(0, {str(Path(__file__).parent)!r}); import analysis_peers"
    run([sys.executable, "-c", f"{code}; analysis_peers.fractal({side}).tofile({str(raw)!r})"])
    place = f"{{UTM, 1, 1, {WEST_M}, {NORTH_M}, {CELL_M}, {CELL_M}, 33, North, WGS-84}}"
    head = f"samples = {side}\nlines = {side}\nbands = 1\nheader offset = 0\ndata type = 4\ninterleave = bsq\nbyte order = 0"
    raw.with_suffix(".hdr").write_text(f"ENVI\n{head}\nmap info = {place}\n")
    run(["gdal_translate", "-q", "-of", "GTiff", raw, tif])
    raw.unlink()
    return tif


def run(command, threads=None):
    """Runs a command; seconds by the clock, the most memory in MiB, and seconds of the processors, the system's among them."""
    environment = dict(os.environ)
    if threads:
        environment["RAYON_NUM_THREADS"] = str(threads)
    with tempfile.TemporaryFile() as said:
        start = time.perf_counter()
        process = subprocess.Popen([str(word) for word in command], stdout=said, stderr=said, env=environment)
        _, status, usage = os.wait4(process.pid, 0)
        seconds = time.perf_counter() - start
        process.returncode = os.waitstatus_to_exitcode(status)
        if process.returncode != 0:
            said.seek(0)
            sys.exit(f"{command}: {said.read().decode(errors='replace')[-2000:]}")
    return seconds, usage.ru_maxrss / 1024, usage.ru_utime + usage.ru_stime


ROADS = 12


def road_lines(side):
    """Lines of roads in map coordinates: half from west to east, half from south to north, each with some two thousand bends."""
    reach_m, lines = (side - 1) * CELL_M, []
    for number in range(ROADS):
        across = (number // 2 + 0.5) / (ROADS / 2)
        stations = [index / 2000 for index in range(2001)]
        swing = [
            across + 0.03 * math.sin(9 * at + number) + 0.008 * math.sin(41 * at + 3 * number) for at in stations
        ]
        shares = zip(stations, swing) if number % 2 == 0 else zip(swing, stations)
        west, south = WEST_M + CELL_M / 2, NORTH_M - CELL_M / 2 - reach_m
        lines.append([(west + east * reach_m, south + north * reach_m) for east, north in shares])
    return lines


def write_roads(folder, side, elevation):
    """A scene of the elevation with roads, and the same lines for GRASS; the path of the scene. On foot, a meter takes twice as
    long off the roads, as the friction of `prepare_roads` has it."""
    scene, ascii = folder / "roads.toml", folder / "roads.txt"
    lines = road_lines(side)
    positions = lambda line: ", ".join(f"[{x:.2f}, {y:.2f}]" for x, y in line)
    road = lambda line: f"[[road]]\nprofile = \"drape\"\nwidth = {CELL_M}\npoints = [{positions(line)}]\n"
    vehicle = '[vehicle.walker]\nlike = "foot"\nspeed_kmh = 2.5\nroad_speed_kmh = [5, 5, 5, 5, 5]\n'
    scene.write_text(f'[terrain]\ndem = "{elevation.name}"\n\n{vehicle}\n' + "\n".join(map(road, lines)))
    bends = lambda line: "".join(f" {x:.2f} {y:.2f}\n" for x, y in line)
    ascii.write_text("".join(f"L {len(line)}\n{bends(line)}" for line in lines))
    return scene


class Place:
    """Positions on the elevation, as shares of its side from the south-west."""

    def __init__(self, side):
        self.reach_m = (side - 1) * CELL_M

    def at(self, east, north):
        x = WEST_M + CELL_M / 2 + east * self.reach_m
        y = NORTH_M - CELL_M / 2 - (1 - north) * self.reach_m
        return f"{x:.1f},{y:.1f}"


def grass(folder, *lines):
    """A command that runs lines in the location of GRASS."""
    return ["grass", folder / "grass" / "PERMANENT", "--exec", "bash", "-c", "set -e; " + "; ".join(lines)]


def comparisons(program, python, elevation, folder, side):
    """Rows: what, ours, peers by name."""
    place = Place(side)
    out = folder / "ours.tif"
    analyze = [program, "analyze"]
    start, near = place.at(0.5, 0.5), place.at(0.62, 0.71)
    ours = lambda kind, *rest: [*analyze, kind, elevation, *rest]
    richdem_code = (
        "import richdem as rd, numpy; "
        f"d = rd.rdarray(numpy.fromfile('{folder}/hills.raw', '<f4').reshape({side}, {side}), no_data=-9999); "
        "f = rd.FillDepressions(d, epsilon=False); a = rd.FlowAccumulation(f, method='D8'); "
        f"numpy.asarray(a).astype('<f4').tofile('{folder}/richdem.raw')"
    )
    walk = lambda friction: f"r.walk -k elevation=d friction={friction} output=cost outdir=dirs start_coordinates={start} --q --o"
    drain = f"r.drain -d input=cost direction=dirs output=way start_coordinates={near} --q --o"
    route = lambda friction: grass(folder, f"{walk(friction)} stop_coordinates={near}", drain)
    routed = ["--from", start, "--to", near, "-o", folder / "route.gpkg"]
    roads = write_roads(folder, side, elevation)
    return [
        (
            "slope",
            ours("slope", "--unit", "degrees", "-o", out),
            {"gdaldem slope": ["gdaldem", "slope", "-q", elevation, folder / "peer.tif"]},
        ),
        (
            "geomorphons",
            ours("geomorphons", "--radius", "20", "--comparison", "magnitude", "-o", out),
            {"r.geomorphon": grass(folder, "r.geomorphon elevation=d forms=f search=20 flat=1 comparison=anglev1 --q --o")},
        ),
        (
            "accumulation",
            ours("flow", "-o", out),
            {
                "richdem": [python, "-c", richdem_code],
                "r.watershed": grass(folder, "r.watershed -s elevation=d accumulation=acc memory=3000 --q --o"),
            },
        ),
        (
            "isochrones",
            ours("time", "--from", start, "--vehicle", "foot", "-o", out),
            {"r.walk": grass(folder, walk("zero"))},
        ),
        (
            "route of 30 km, bare ground",
            ours("route", "--vehicle", "foot", *routed),
            {"r.walk, r.drain": route("zero")},
        ),
        (
            "route of 30 km with roads",
            [*analyze, "route", roads, "--vehicle", "walker", "--method", "langmuir", *routed],
            {"r.walk, r.drain": route("friction")},
        ),
    ]


def threaded(program, elevation, folder, side):
    """Rows of the table of threads: what, command."""
    place = Place(side)
    out = folder / "ours.tif"
    posts = ";".join([place.at(0.3, 0.4), place.at(0.7, 0.6), place.at(0.5, 0.2), place.at(0.2, 0.8)])
    ours = lambda kind, *rest: [program, "analyze", kind, elevation, *rest, "-o", out]
    return [
        ("slope", ours("slope", "--unit", "degrees")),
        ("geomorphons", ours("geomorphons", "--radius", "20")),
        ("viewsheds of 4", ours("viewsheds", "--posts", posts)),
        ("masking by 4", ours("masking", "--radars", posts)),
        ("isochrones", ours("time", "--from", place.at(0.5, 0.5), "--vehicle", "foot")),
    ]


def best(commands):
    """The least times, memories and processor times of commands that are run in turn."""
    found = {name: [] for name in commands}
    for _ in range(REPEATS):
        for name, (command, threads) in commands.items():
            found[name].append(run(command, threads))
    return {name: tuple(map(min, zip(*runs))) for name, runs in found.items()}


def prepare_grass(elevation, folder):
    shutil.rmtree(folder / "grass", ignore_errors=True)
    run(["grass", "-c", elevation, folder / "grass", "-e"])
    run(grass(folder, f"r.in.gdal input={elevation} output=d --q", "g.region raster=d", "r.mapcalc 'zero = 0' --q"))


def prepare_roads(folder):
    """What a meter takes beside the slope: nothing on the roads, as long as on the level off them."""
    lines = f"v.in.ascii -n input={folder / 'roads.txt'} output=roads format=standard --q --o"
    cells = "v.to.rast input=roads type=line output=roads use=val value=1 --q --o"
    run(grass(folder, lines, cells, "r.mapcalc 'friction = if(isnull(roads), 0.72, 0)' --q --o"))


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("program", type=lambda path: Path(path).resolve())
    parser.add_argument("--side", type=int, default=4097)
    parser.add_argument("--folder", type=Path, default=Path(tempfile.gettempdir()) / "analysis_peers")
    parser.add_argument("--python", default=sys.executable)
    parser.add_argument("--only", default="")
    options = parser.parse_args()
    options.folder.mkdir(exist_ok=True)
    elevation = write_elevation(options.folder, options.side)
    wanted = [word for word in options.only.split(",") if word]
    is_wanted = lambda what: not wanted or any(what.startswith(word) for word in wanted)
    rows = comparisons(options.program, options.python, elevation, options.folder, options.side)
    rows = [row for row in rows if is_wanted(row[0])]
    if any(not name.startswith(("gdaldem", "richdem")) for _, _, peers in rows for name in peers):
        prepare_grass(elevation, options.folder)
        prepare_roads(options.folder)
    run(["gdal_translate", "-q", "-of", "ENVI", elevation, options.folder / "hills.raw"])
    print(f"| what, {options.side}², whole process | ours | processor | MiB | peer | | processor | times | processor |\n|---|---|---|---|---|---|---|---|---|")
    for what, command, peers in rows:
        times = best({"ours": (command, None), **{name: (peer, None) for name, peer in peers.items()}})
        seconds, memory, processor = times["ours"]
        for name in peers:
            peer, _, work = times[name]
            ours = f"{what} | {seconds:.2f} s | {processor:.2f} s | {memory:.0f}"
            ratios = f"{peer / seconds:.1f} | {work / processor:.1f}"
            print(f"| {ours} | {name} | {peer:.2f} s | {work:.2f} s | {ratios} |", flush=True)
    print("\n| what | 1 thread | 2 threads | times |\n|---|---|---|---|")
    for what, command in threaded(options.program, elevation, options.folder, options.side):
        if is_wanted(what) or "threads" in wanted:
            times = best({"1": (command, 1), "2": (command, 2)})
            one, two = times["1"][0], times["2"][0]
            print(f"| {what} | {one:.2f} s | {two:.2f} s | {one / two:.2f} |", flush=True)


if __name__ == "__main__":
    main()
