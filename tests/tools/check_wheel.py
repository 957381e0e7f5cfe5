#!/usr/bin/env python3
"""Checks a wheel as one who gets it: in a fresh environment, from nothing to the first picture.

usage: python tests/tools/check_wheel.py WHEEL [PROGRAM]

Prints size, time of import and time to the first picture, and refuses what is too large; times are those of the machine and of the
network, for a person to judge. A wheel for manylinux 2014 must
use no newer symbol than that allows, which auditwheel (by pip) says. With a program, the wheel's must draw the same demonstration.

A wheel for manylinux 2014 is built by

    cd src/python && maturin build --release --locked --strip --zig --compatibility manylinux2014
"""

import os
import re
import statistics
import subprocess
import sys
import tempfile
import time
import venv
from pathlib import Path

# What PyPI's users download without a thought; the debug information of a development build is beside the point.
MOST_BYTES = 25_000_000
# The first import reads the disk, and a busy machine delays some.
IMPORTS = 7


def main() -> int:
    wheel = Path(sys.argv[1]).resolve()
    program = [Path(argument).resolve() for argument in sys.argv[2:]]
    size = wheel.stat().st_size
    findings = []
    print(f"{wheel.name}: {size / 1e6:.1f} MB")
    if "manylinux2014" in wheel.name:
        findings += audited(wheel)
        if size > MOST_BYTES:
            findings.append(f"the wheel has {size / 1e6:.1f} MB, which is more than {MOST_BYTES / 1e6:.0f} MB")
    with tempfile.TemporaryDirectory(prefix="sandtable-wheel-") as folder:
        findings += checked_in(Path(folder), wheel, program)
    for finding in findings:
        print(f"error: {finding}", file=sys.stderr)
    return 1 if findings else 0


def audited(wheel: Path) -> list[str]:
    """What keeps a wheel from the systems of manylinux 2014."""
    ended = run([sys.executable, "-m", "auditwheel", "show", wheel])
    policy = re.search(r'following platform\s+tag:\s+"(\S+)"', ended)
    print(f"auditwheel: {policy.group(1) if policy else ended}")
    fits = policy and re.fullmatch(r"manylinux_2_(5|12|17)_\w+", policy.group(1))
    return [] if fits else [f"auditwheel does not find it fit for manylinux 2014:\n{ended}"]


def checked_in(folder: Path, wheel: Path, program: list[Path]) -> list[str]:
    """What is wrong with a wheel in a new environment in `folder`."""
    scripts = folder / "python" / ("Scripts" if os.name == "nt" else "bin")
    began = time.monotonic()
    venv.create(folder / "python", with_pip=True)
    run([scripts / "python", "-m", "pip", "install", "--quiet", "--no-cache-dir", wheel])
    installed = time.monotonic()
    run([scripts / "sandtable", "demo", folder / "demo"])
    drawn = time.monotonic()
    print(f"from nothing to the first picture: {drawn - began:.1f} s, of which installing {installed - began:.1f} s")
    imports = [import_ms(scripts / "python") for _ in range(IMPORTS)]
    import_time = statistics.median(imports)
    print(f"import sandtable: {import_time:.0f} ms, the first {imports[0]:.0f} ms")
    findings = []
    for other in program:
        run([other, "demo", folder / "other"])
        if (folder / "demo/picture.png").read_bytes() != (folder / "other/picture.png").read_bytes():
            findings.append(f"its demonstration is not the picture of {other}")
    return findings


def import_ms(python: Path) -> float:
    """The time in which the package with all that it needs is imported."""
    ended = subprocess.run([python, "-X", "importtime", "-c", "import sandtable"], capture_output=True, text=True, check=True)
    line = next(line for line in ended.stderr.splitlines() if re.search(r"\| sandtable$", line))
    return int(line.split("|")[1]) / 1000


def run(command: list) -> str:
    """What a command prints; where it fails, this ends with what it said."""
    ended = subprocess.run(list(map(str, command)), capture_output=True, text=True)
    if ended.returncode != 0:
        sys.exit(f"{' '.join(map(str, command))}: exit code {ended.returncode}\n{ended.stdout}{ended.stderr}")
    return ended.stdout


if __name__ == "__main__":
    sys.exit(main())
