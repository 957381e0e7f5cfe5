"""What the tests share: the program whose answers the package must give, and where the data lies."""

import os
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[3]
JACKSBORO = ROOT / "assets/jacksboro/dem.tif"
ROAD = ROOT / "scenes/road.toml"
EXE = ".exe" if os.name == "nt" else ""
PROGRAM = Path(os.environ.get("SANDTABLE_PROGRAM", ROOT / f"target/debug/sandtable{EXE}"))


@pytest.fixture(scope="session")
def program():
    """Runs the program of this repository and returns what it prints."""
    assert PROGRAM.is_file(), f"{PROGRAM} is not built: run `cargo build`, or set SANDTABLE_PROGRAM"

    def run(*arguments, input=None, cwd=None):
        command = [PROGRAM, *map(str, arguments)]
        ended = subprocess.run(command, input=input, capture_output=True, text=True, cwd=cwd)
        assert ended.returncode == 0, f"{command}\n{ended.stderr}"
        return ended.stdout

    return run


@pytest.fixture(scope="session")
def data():
    """Where a file of the shared test data is; the test is skipped where there is none."""

    def find(name):
        path = ROOT.parent / "shared/data" / name
        if not path.exists():
            assert "SANDTABLE_REQUIRE_DATA" not in os.environ, f"no test data at {path}"
            pytest.skip(f"no test data at {path}")
        return path

    return find
