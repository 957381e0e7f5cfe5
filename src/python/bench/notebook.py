"""Times cells of a notebook: what the demonstration's picture and page take, without what Jupyter adds.

usage: python src/python/bench/notebook.py [SCENE] [ROUNDS]

Each round is a new process, as a kernel that was just started; its second cell and page are those of a scene that is made again.
Beside the time stand the seconds of all processors together, which other work on the machine hardly changes.
"""

import statistics
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]

CELLS = r"""
import sys, time

said = []

def cell(name, run):
    began, busy = time.perf_counter(), time.process_time()
    made = run()
    said.append((name, time.perf_counter() - began, time.process_time() - busy))
    return made

st = cell("import", lambda: __import__("sandtable"))

def fresh():
    made = st.Scene(sys.argv[1])
    return made, made._repr_png_()

scene, png = cell("first cell: picture", fresh)
page = cell("its page", lambda: scene.show()._repr_html_())
again, png = cell("the cell again", fresh)
cell("page of a new scene", lambda: st.Scene(sys.argv[1]).show()._repr_html_())
print(f"{len(png) / 1e6:.2f} MB of PNG, {len(page) / 1e6:.1f} MB of page", file=sys.stderr)
for row in said:
    print(*row, sep="\t")
"""


def main() -> None:
    scene = sys.argv[1] if len(sys.argv) > 1 else str(ROOT / "scenes/jacksboro.toml")
    rounds = int(sys.argv[2]) if len(sys.argv) > 2 else 5
    times: dict[str, list[tuple[float, float]]] = {}
    for _ in range(rounds):
        ran = subprocess.run([sys.executable, "-W", "ignore", "-c", CELLS, scene], capture_output=True, text=True, check=True)
        for line in ran.stdout.splitlines():
            name, seconds, busy = line.split("\t")
            times.setdefault(name, []).append((float(seconds), float(busy)))
    print(ran.stderr.strip())
    for name, measured in times.items():
        seconds, busy = (statistics.median(column) for column in zip(*measured))
        print(f"{name:24}{seconds:7.2f} s, {busy:.2f} s of processors")


if __name__ == "__main__":
    main()
