"""Compares the pictures that several builds of the program make of every scene in `scenes/`, byte for byte.

    python3 tests/tools/same_pictures.py PROGRAM PROGRAM...

Builds of two optimization levels, for processors with and without AVX2, with any number of threads: all must give the
same files. The builds, each in a folder of its own:

    cargo build --release
    cargo build
    RUSTFLAGS=-Ctarget-cpu=x86-64-v3 cargo build --release --target-dir target/avx2

The last is for processors with AVX2 and FMA, which the compiler then uses wherever it likes. Each scene is drawn with every
camera, on 1, 2 and 16 threads by the first program, on all cores by the others. Prints the number of pictures, and each that
differs; exits with 1 where one does.
"""

import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]


def draw(program, threads, folder):
    """Every picture of every scene, by name."""
    for scene in sorted((ROOT / "scenes").glob("*.toml")):
        out = str(Path(folder) / f"{scene.stem}.png")
        command = [program, "render", str(scene), "--all-cameras", "--size", "480x270", "-o", out]
        if threads:
            command += ["--threads", str(threads)]
        done = subprocess.run(command, capture_output=True, text=True)
        if done.returncode != 0:
            raise SystemExit(f"{' '.join(command)}: {done.stderr}")
    return {path.name: path.read_bytes() for path in Path(folder).glob("*.png")}


def main():
    programs = [str(Path(name).resolve()) for name in sys.argv[1:]]
    if not programs:
        raise SystemExit(__doc__)
    runs = [(programs[0], threads) for threads in (1, 2, 16)] + [(program, None) for program in programs[1:]]
    first, differing = None, 0
    for program, threads in runs:
        with tempfile.TemporaryDirectory() as folder:
            pictures = draw(program, threads, folder)
        first = first or pictures
        names = sorted(name for name in first.keys() | pictures.keys() if first.get(name) != pictures.get(name))
        differing += len(names)
        threads = f"{threads} threads" if threads else "all threads"
        print(f"{program}, {threads}: {len(pictures)} pictures, {len(names)} differ {' '.join(names)}".rstrip())
    sys.exit(differing > 0)


if __name__ == "__main__":
    main()
