"""Types: strict checkers pass the package and a program that uses it, and refuse wrong uses."""

import re
import subprocess
import sys
from pathlib import Path

import pytest
import sandtable
from conftest import ROOT

PACKAGE = Path(sandtable.__file__).parent
USE = Path(__file__).with_name("typed_use.py")
WRONG = """
import sandtable as st

dem = st.Dem.open("dem.tif")
dem.heights([(0.0, 0.0)], "cubical")
dem.viewshed((0.0, 0.0), reach=5.0)
length: int = dem.profile([(0.0, 0.0), (1.0, 1.0)]).length
st.plot.relief(dem, azimuth="north")
"""


@pytest.mark.parametrize("checker", ["mypy", "pyright"])
def test_strict_checkers_pass_the_package_and_its_use_and_refuse_wrong_uses(checker, tmp_path):
    pytest.importorskip(checker)

    def check(*what):
        options = {"mypy": ["--strict"], "pyright": ["--pythonpath", sys.executable]}[checker]
        # In a folder without sources of the package: what is installed is checked.
        command = [sys.executable, "-m", checker, *options, *map(str, what)]
        return subprocess.run(command, capture_output=True, text=True, cwd=tmp_path)

    package = check(*{"mypy": ["-p", "sandtable"], "pyright": [PACKAGE]}[checker])
    assert package.returncode == 0, package.stdout + package.stderr
    wrong = tmp_path / "wrong.py"
    wrong.write_text(WRONG)
    said = check(USE, wrong).stdout
    errors = re.findall(r"(\w+\.py):(\d+)(?::\d+)?(?: -|:) error", said)
    assert {(name, int(line)) for name, line in errors} == {("wrong.py", line) for line in [5, 6, 7, 8]}, said


def test_the_checked_program_runs():
    ended = subprocess.run([sys.executable, USE], capture_output=True, text=True, cwd=ROOT)
    assert ended.returncode == 0 and "(36, 64, 3)" in ended.stdout, ended.stderr
