"""The program that the wheel carries: the pictures, answers, errors and exit codes of the Rust program."""

import os
import re
import shutil
import signal
import subprocess
import sys
import sysconfig
import time
from pathlib import Path

import pytest
from conftest import EXE, JACKSBORO, PROGRAM, ROAD

SCRIPT = Path(sysconfig.get_path("scripts")) / f"sandtable{EXE}"
# A small picture of a scene with roads.
PICTURE = ["render", ROAD, "--camera", "front", "--size", "320x180", "-o"]


def run(program, *arguments, **options):
    return subprocess.run([*program, *map(str, arguments)], capture_output=True, stdin=subprocess.DEVNULL, **options)


@pytest.mark.parametrize("program", [[SCRIPT], [sys.executable, "-m", "sandtable"]], ids=["script", "module"])
def test_pictures_and_sidecars_are_those_of_the_rust_program(program, tmp_path):
    # Beside one another: the sidecar states the scene's path.
    files = []
    for name, command in [("wheel", program), ("rust", [PROGRAM])]:
        (tmp_path / name).mkdir()
        ended = run(command, *PICTURE, tmp_path / name / "road.png", "--buffers", tmp_path / name)
        assert ended.returncode == 0, ended.stderr
        files.append({path.name: path.read_bytes() for path in (tmp_path / name).iterdir()})
    assert len(files[0]) > 2 and files[0] == files[1]


@pytest.mark.parametrize(
    "arguments",
    [
        [],
        ["--version"],
        ["--help"],
        ["render", "--help"],
        ["nonsense"],
        ["render"],
        ["render", "missing.toml"],
        ["render", JACKSBORO],
        ["check", "wrong.toml"],
        ["height", JACKSBORO, "--at", "-84.2,36.3", "--crs", "EPSG:4326"],
        ["height", JACKSBORO, "--at", "0,0"],
        ["height", "--limit", "raster-samples=5", JACKSBORO, "--at", "-84.2,36.3"],
        ["--limit", "raster-samples=5", "height", "--limit", "road-pairs=5", JACKSBORO, "--at", "1,1"],
        ["serve", "missing.tif"],
        ["completions", "bash"],
        ["completions", "man"],
        ["catalog"],
    ],
    ids=lambda arguments: " ".join(Path(str(argument)).name for argument in arguments) or "nothing",
)
def test_answers_errors_and_exit_codes_are_those_of_the_rust_program(arguments, tmp_path):
    (tmp_path / "wrong.toml").write_text(ROAD.read_text().replace("[terrain]", "[terrain]\nnonsense = 1", 1))
    (tmp_path / "ground.tif").write_bytes(b"II*\0")
    wheel, rust = (run(program, *arguments, cwd=tmp_path) for program in [[SCRIPT], [PROGRAM]])
    assert (wheel.stdout, wheel.stderr, wheel.returncode) == (rust.stdout, rust.stderr, rust.returncode)
    assert wheel.stdout or wheel.stderr


def test_the_demonstration_is_drawn_from_the_wheel_alone(tmp_path):
    ended = run([SCRIPT], "demo", cwd=tmp_path, env={"PATH": "/nowhere"})
    assert ended.returncode == 0, ended.stderr
    picture = (tmp_path / "sandtable-demo/picture.png").read_bytes()
    assert picture.startswith(b"\x89PNG") and len(picture) > 100_000
    assert b"sandtable render" in ended.stdout


def test_the_program_starts_without_numpy(tmp_path):
    (tmp_path / "numpy.py").write_text("raise SystemExit('numpy was imported')")
    ended = run([sys.executable, "-m", "sandtable"], "--version", env={**os.environ, "PYTHONPATH": str(tmp_path)})
    assert (ended.returncode, ended.stderr) == (0, b""), ended.stderr


@pytest.mark.skipif(os.name == "nt", reason="signals and limits of Unix")
@pytest.mark.parametrize("sent", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_ends_the_program_and_leaves_no_part_of_a_file(sent, tmp_path):
    process = subprocess.Popen(
        [SCRIPT, "render", ROAD, "--size", "6000x4000", "-o", tmp_path / "large.png"],
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, env={**os.environ, "SANDTABLE_PROGRESS": "lines"},
    )
    # Until it draws; by then it waits for signals.
    for line in process.stderr:
        if line.startswith(b"progress: "):
            break
    process.send_signal(sent)
    _, said = process.communicate(timeout=20)
    assert process.returncode == -sent, said
    assert (b"interrupted: " in said) == (sent == signal.SIGINT) and b"Traceback" not in said
    assert list(tmp_path.iterdir()) == []


@pytest.mark.skipif(os.name == "nt", reason="signals and limits of Unix")
def test_a_program_that_ignores_ctrl_c_goes_on(tmp_path):
    # As a shell starts what runs in the background.
    process = subprocess.Popen(
        [SCRIPT, *map(str, PICTURE), tmp_path / "road.png"],
        stdout=subprocess.PIPE, stderr=subprocess.PIPE,
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_IGN),
    )
    time.sleep(0.3)
    process.send_signal(signal.SIGINT)
    _, said = process.communicate(timeout=60)
    assert process.returncode == 0, said


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="`ulimit -v` of Linux")
def test_a_limit_of_the_address_space_is_kept_as_by_the_rust_program(tmp_path):
    import resource

    def limited(megabytes):
        most = megabytes << 20
        return {"preexec_fn": lambda: resource.setrlimit(resource.RLIMIT_AS, (most, most))}

    (tmp_path / "rust").mkdir()
    (tmp_path / "wheel").mkdir()
    # It starts itself again, twice, by the interpreter of its environment.
    for program, folder in [(SCRIPT, "wheel"), (PROGRAM, "rust")]:
        ended = run([program], *PICTURE, tmp_path / folder / "road.png", **limited(600))
        assert ended.returncode == 0, ended.stderr
    assert (tmp_path / "wheel/road.png").read_bytes() == (tmp_path / "rust/road.png").read_bytes()
    refused = run([SCRIPT], *PICTURE, tmp_path / "refused.png", **limited(150))
    assert refused.returncode == 1, refused.stderr
    assert re.search(rb"ulimit -v", refused.stderr) and b"Traceback" not in refused.stderr
    assert not (tmp_path / "refused.png").exists()


def test_what_reads_the_output_may_stop(tmp_path):
    if shutil.which("bash") is None:
        pytest.skip("no bash")
    command = f"set -o pipefail; '{SCRIPT}' catalog | head -c 10"
    ended = subprocess.run(["bash", "-c", command], capture_output=True, cwd=tmp_path)
    assert (ended.returncode, ended.stderr) == (0, b"") and len(ended.stdout) == 10
