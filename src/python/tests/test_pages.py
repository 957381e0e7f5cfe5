"""The pages' examples run, the stubs are true, and everything that is linked in is noticed."""

import re
import subprocess
import sys
import tomllib

import pytest
import sandtable
from conftest import ROOT


@pytest.mark.parametrize("page", ["src/book/analysis.md", "src/book/gis-and-python.md", "src/book/many-machines.md", "src/book/notebook.md", "src/python/README.md"])
def test_the_examples_of_the_pages_run(program, page, tmp_path):
    for folder in ["assets", "scenes"]:
        (tmp_path / folder).symlink_to(ROOT / folder)
    text = (ROOT / page).read_text()
    # What the examples go on with.
    for command in re.findall(r"^(?:cargo run --|sandtable) (plan .*)$", text, re.M):
        program(*command.split(), cwd=tmp_path)
    examples = re.findall(r"```python\n(.*?)```", text, re.S)
    assert examples
    for number, example in enumerate(examples):
        (tmp_path / f"example{number}.py").write_text(example)
        command = [sys.executable, f"example{number}.py"]
        ended = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True)
        assert ended.returncode == 0, ended.stderr


def test_the_stubs_are_those_of_the_package():
    pytest.importorskip("mypy")
    command = [sys.executable, "-m", "mypy.stubtest", "sandtable", "--ignore-missing-stub"]
    ended = subprocess.run(command, capture_output=True, text=True)
    assert ended.returncode == 0, ended.stdout + ended.stderr


def test_what_is_public_says_what_it_does():
    for name in sandtable.__all__:
        public = getattr(sandtable, name)
        assert name == "__version__" or public.__doc__, name
        for method in ["open", "heights", "viewshed", "render"]:
            assert getattr(getattr(public, method, len), "__doc__"), f"{name}.{method}"


def test_what_is_linked_in_is_noticed():
    by_name = {}
    for package in tomllib.loads((ROOT / "Cargo.lock").read_text())["package"]:
        by_name.setdefault(package["name"], []).append(package)
    waiting, linked = ["numpy", "pyo3"], set()
    while waiting:
        name, _, version = waiting.pop().partition(" ")
        for package in by_name[name]:
            pair = (package["name"], package["version"])
            if version in ["", package["version"]] and pair not in linked:
                linked.add(pair)
                waiting += package.get("dependencies", [])
    # What runs while others are built is not linked in.
    linked -= {pair for pair in linked if pair[0] in ["pyo3-build-config", "target-lexicon"]}
    assert len(linked) > 10
    for name, version in linked:
        assert f"\n{name} {version}: " in sandtable.licenses()
