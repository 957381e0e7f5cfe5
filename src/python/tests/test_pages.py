"""The pages' examples run, the stubs are true, and everything that is linked in is noticed."""

import re
import subprocess
import sys
import tomllib

import pytest
import sandtable
from conftest import ROOT


@pytest.mark.parametrize("page", ["README.md", "src/python/README.md"])
def test_the_examples_of_the_pages_run(program, page, tmp_path):
    for folder in ["assets", "scenes"]:
        (tmp_path / folder).symlink_to(ROOT / folder)
    text = (ROOT / page).read_text()
    # What the examples go on with.
    for command in re.findall(r"^(?:cargo run --release --|sandtable) (plan .*)$", text, re.M):
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
    packages = tomllib.loads((ROOT / "src/python/Cargo.lock").read_text())["package"]
    program = tomllib.loads((ROOT / "Cargo.lock").read_text())["package"]
    known = {(package["name"], package["version"]) for package in program}
    added = {(package["name"], package["version"]) for package in packages} - known
    # What runs while others are built is not linked in.
    added -= {pair for pair in added if pair[0] in ["sandtable-python", "pyo3-build-config", "target-lexicon"]}
    assert {name for name, _ in added} >= {"numpy", "pyo3"}
    for name, version in added:
        assert f"\n{name} {version}: " in sandtable.licenses()
    shared = {name for name, _ in known} & {name for name, _ in added}
    assert not shared, f"{shared} have other versions than in the program: copy Cargo.lock here and build again"
