"""Drives the window of `sandtable view` as a person does: real keys and clicks under Xvfb, by xdotool.

    python3 tests/tools/view_window.py PROGRAM [FOLDER]

PROGRAM is a `sandtable` built with the feature `viewer`; screenshots go into FOLDER. Needs Xvfb, xdotool, a window manager
(openbox) and a graphics adapter, which may be Mesa's for processors. Ends with 0 where all went as it should.
"""

import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
PROGRAM = str(Path(sys.argv[1]).resolve())
SHOTS = Path(sys.argv[2]) if len(sys.argv) > 2 else None
PATIENCE_S = 90


def fail(message):
    raise SystemExit(f"FAILED: {message}")


def wait_for(what, check):
    """The first true value of `check`, tried for PATIENCE_S seconds."""
    end = time.monotonic() + PATIENCE_S
    while time.monotonic() < end:
        value = check()
        if value:
            return value
        time.sleep(0.2)
    fail(f"waited {PATIENCE_S} s for {what}")


class Display:
    """An X server of its own, with a window manager: without one no window has the keys."""

    def __enter__(self):
        self.runtime = tempfile.mkdtemp()
        read, write = os.pipe()
        self.server = subprocess.Popen(
            ["Xvfb", "-displayfd", str(write), "-screen", "0", "1280x800x24"],
            pass_fds=[write], stderr=subprocess.DEVNULL,
        )
        os.close(write)
        with os.fdopen(read) as number_pipe:
            number = number_pipe.readline().strip()
        self.environment = dict(
            os.environ, DISPLAY=f":{number}", XDG_RUNTIME_DIR=self.runtime, XDG_CONFIG_HOME=self.runtime,
        )
        self.environment.pop("WAYLAND_DISPLAY", None)
        self.manager = subprocess.Popen(["openbox"], env=self.environment, stderr=subprocess.DEVNULL)
        time.sleep(1)
        return self

    def __exit__(self, *_):
        self.manager.terminate()
        self.server.terminate()
        self.manager.wait()
        self.server.wait()
        shutil.rmtree(self.runtime, ignore_errors=True)

    def xdo(self, *words):
        done = subprocess.run(["xdotool", *map(str, words)], env=self.environment, capture_output=True, text=True)
        return done.stdout.strip()

    def shot(self, name):
        if SHOTS and shutil.which("import"):
            SHOTS.mkdir(parents=True, exist_ok=True)
            subprocess.run(["import", "-window", "root", str(SHOTS / f"{name}.png")], env=self.environment)


def folder_with_scene(folder):
    """A copy of a small scene with what it reads; its file."""
    (folder / "scenes").mkdir()
    (folder / "assets/jacksboro").mkdir(parents=True)
    shutil.copy(ROOT / "assets/jacksboro/valley.asc", folder / "assets/jacksboro")
    shutil.copy(ROOT / "scenes/road.toml", folder / "scenes")
    return folder / "scenes/road.toml"


def no_display(scene):
    """Without a display: one sentence that names `render`, and the exit code of wrong input."""
    environment = {key: value for key, value in os.environ.items() if not key.endswith("DISPLAY")}
    environment.pop("WAYLAND_SOCKET", None)
    done = subprocess.run([PROGRAM, "view", str(scene)], env=environment, capture_output=True, text=True)
    lines = done.stderr.strip().splitlines()
    if done.returncode != 1 or len(lines) != 1 or "sandtable render" not in lines[0]:
        fail(f"without a display: {done.returncode}, {done.stderr}")


def scripted(display, scene):
    """A script flies, picks, digs, takes back, draws; its picture is the one that `render` draws."""
    script = scene.with_name("script.txt")
    script.write_text(
        "wait 5\nfly 749000,4016500,1500 749500,4018000,500 30\npick 400,400\nedit crater 749000,4017500 60\nwait 3\n"
        "undo\nwait 3\nsnapshot\nsun 120,30\nundo\nhide roads\nshow roads\nviewshed 749000,4017500\n"
        "analyze obstacles vehicle=wheeled\nwait 5\ndiscard\nanalyze time from=749000,4017500 extent=748500,4017000,750500,4018500\n"
        "keep\nhide analyses\nshow analyses\nundo\nresize 900x600\nwait 5\nquit\n"
    )
    before = scene.read_text()
    command = [PROGRAM, "view", str(scene), "--script", str(script), "--json"]
    done = subprocess.run(command, env=display.environment, capture_output=True, text=True, timeout=600)
    if done.returncode != 0:
        fail(f"the script ended with {done.returncode}: {done.stderr}")
    report = json.loads(done.stdout)
    by_command = {entry["command"].split()[0]: entry for entry in report["commands"]}
    if by_command["edit"]["moved"]["cut_m3"] < 100:
        fail(f"the crater moved no earth: {by_command['edit']}")
    quiet = ["sun", "hide", "show", "viewshed", "analyze", "keep", "discard"]
    if any(entry.get("said") for command, entry in by_command.items() if command in quiet):
        fail(f"the window complains: {report['commands']}")
    analyses = [entry["analysis"] for entry in report["commands"] if entry["command"].startswith("analyze ")]
    if [analysis.get("kind") for analysis in analyses] != ["obstacles", "time"]:
        fail(f"the analyses were not made: {analyses}")
    command = [PROGRAM, "analyze", "obstacles", str(scene), "--vehicle", "wheeled", "--json"]
    printed = json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)
    if {figure["name"]: figure["value"] for figure in printed["figures"]} != analyses[0]["figures"]:
        fail(f"the window has other figures than the command: {printed['figures']}, {analyses[0]['figures']}")
    if not by_command["pick"]["picked"]["place"]:
        fail(f"nothing was picked: {by_command['pick']}")
    if report["frames"] < 40 or report["ground_triangles"] < 1000:
        fail(f"too few frames or triangles: {report}")
    if scene.read_text() != before:
        fail("a script that saves nothing changed the scene")
    camera = by_command["snapshot"]["camera"]
    picture = scene.with_name("road-view-1.png")
    width, height = re.search(rb"IHDR(.{4})(.{4})", picture.read_bytes(), re.S).groups()
    size = f"{int.from_bytes(width, 'big')}x{int.from_bytes(height, 'big')}"
    twin = scene.with_name("twin.toml")
    twin.write_text(before + "\n" + camera)
    drawn = scene.with_name("twin.png")
    subprocess.run([PROGRAM, "render", str(twin), "--camera", "view-1", "--size", size, "-o", str(drawn)], check=True,
                   capture_output=True)
    if drawn.read_bytes() != picture.read_bytes():
        fail("the picture of the view is not the one that `render` draws")
    twin.unlink()
    return report


def by_hand(display, scene):
    """Keys and clicks: fly, dig, take back, save, resize, break the file and mend it, close with edits."""
    program = subprocess.Popen([PROGRAM, "view", str(scene)], env=display.environment, stderr=subprocess.PIPE, text=True)
    window = wait_for("the window", lambda: display.xdo("search", "--onlyvisible", "--name", "sandtable")).split()[0]

    def title():
        return display.xdo("getwindowname", window)

    def has_edits():
        return "*" in title()

    wait_for("the scene", lambda: "road.toml" in title())
    time.sleep(3)
    display.shot("1-open")
    display.xdo("windowfocus", "--sync", window)
    display.xdo("mousemove", 800, 420, "click", 1)
    time.sleep(1)
    display.shot("2-picked")
    display.xdo("mousedown", 1, "mousemove_relative", 60, 30, "mouseup", 1)
    for _ in range(3):
        display.xdo("click", 4)
    display.xdo("keydown", "w")
    time.sleep(0.6)
    display.xdo("keyup", "w")
    time.sleep(1)
    display.shot("3-flown")
    display.xdo("key", "k")
    time.sleep(0.5)
    display.xdo("mousemove", 800, 450)
    time.sleep(0.5)
    display.shot("4-digging")
    display.xdo("click", 1)
    wait_for("the crater", has_edits)
    time.sleep(1)
    display.shot("5-dug")
    display.xdo("key", "Escape")
    display.xdo("key", "ctrl+z")
    wait_for("undo", lambda: not has_edits())
    display.xdo("key", "ctrl+y")
    wait_for("redo", has_edits)
    display.xdo("key", "ctrl+s")
    wait_for("saving", lambda: not has_edits())
    if scene.read_text().count("[[earthwork]]") != 1:
        fail("the crater is not in the scene file")
    display.xdo("windowsize", "--sync", window, 760, 520)
    time.sleep(1.5)
    display.shot("6-small")
    display.xdo("windowminimize", window)
    time.sleep(1)
    display.xdo("windowmap", "--sync", window, "windowactivate", "--sync", window)
    display.xdo("windowsize", "--sync", window, 1200, 760)
    time.sleep(1)
    sound = scene.read_text()
    scene.write_text(sound.replace("[terrain]", "[terain]"))
    time.sleep(2.5)
    display.shot("7-broken")
    scene.write_text(sound)
    time.sleep(4)
    display.shot("8-mended")
    display.xdo("windowfocus", "--sync", window)
    display.xdo("key", "k")
    time.sleep(0.5)
    display.xdo("mousemove", 700, 430, "click", 1)
    wait_for("a second crater", has_edits)
    display.xdo("key", "ctrl+q")
    time.sleep(1.5)
    display.shot("9-question")
    if program.poll() is not None:
        fail(f"the window closed with edits that were not saved; it ended with {program.returncode}: {program.stderr.read()}")
    display.xdo("key", "Tab")
    time.sleep(0.3)
    display.xdo("key", "Return")
    wait_for("the window to close", lambda: program.poll() is not None)
    if program.returncode != 0:
        fail(f"the program ended with {program.returncode}: {program.stderr.read()}")
    if scene.read_text().count("[[earthwork]]") != 2:
        fail("the second crater was not saved")


def main():
    for tool in ["Xvfb", "xdotool", "openbox"]:
        if not shutil.which(tool):
            fail(f"{tool} is not installed")
    folder = Path(tempfile.mkdtemp())
    try:
        scene = folder_with_scene(folder)
        no_display(scene)
        with Display() as display:
            report = scripted(display, scene)
            by_hand(display, scene)
        frame = report["milliseconds"]["frame"]
        print(f"passed: {report['frames']} frames, median {frame['median']:.1f} ms, on {report['adapter']}")
    finally:
        shutil.rmtree(folder, ignore_errors=True)


main()
