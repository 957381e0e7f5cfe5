"""The program `sandtable`: where it is, and a run of it with progress that can be canceled."""

import json
import os
import shutil
import site
import subprocess
import sysconfig
import threading

from qgis.core import QgsSettings

SETTING = "sandtable/program"

# What the program writes of its steps: `progress: analyzing 37 %`.
PROGRESS_PREFIX = "progress: "

# The time between two looks at whether a run is canceled: short for a person, long for a processor.
LOOK_AGAIN_S = 0.1

# How long a canceled program may take to remove what it has begun to write.
CANCEL_S = 5

# The steps of pictures and exports, in their order: the share that is done follows from how many have begun.
STEPS = [
    "reading the scene file",
    "reading elevation",
    "laying features",
    "loading models",
    "placing labels and cameras",
    "refining terrain",
    "lighting terrain",
    "draping features",
    "drawing graphics",
    "setting models",
    "drawing",
    "annotating",
    "writing the picture",
]


class ProgramError(Exception):
    """The program is missing, or failed: what it said."""


class ProgramCanceled(Exception):
    """The run was canceled; the program left no part of a file."""


def find_program():
    """The path of the program: by the setting, on the path, or where pip has put it, for all users or for this one."""
    stated = QgsSettings().value(SETTING, "", type=str)
    if stated:
        return stated
    scripts = [sysconfig.get_path("scripts"), os.path.join(site.getuserbase(), "Scripts" if os.name == "nt" else "bin")]
    folders = [os.environ.get("PATH", "")] + [folder for folder in scripts if folder]
    found = shutil.which("sandtable", path=os.pathsep.join(folders))
    if found is None:
        raise ProgramError(
            "The program `sandtable` was not found. Install it (`pip install sandtable`), or state its path in the dialog "
            "“3D picture of this map”."
        )
    return found


def run(arguments, on_progress=lambda text, percent: None, is_canceled=lambda: False):
    """Runs the program and returns what it printed.

    `on_progress` is called with the name of a step and with 0 to 100; `is_canceled` ends the program when it is true.
    Raises `ProgramError` where it fails and `ProgramCanceled` where it was canceled.
    """
    environment = dict(os.environ, SANDTABLE_PROGRESS="lines")
    try:
        process = subprocess.Popen(
            [find_program(), *map(str, arguments)],
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            env=environment,
            encoding="utf-8",
            errors="replace",
            creationflags=getattr(subprocess, "CREATE_NO_WINDOW", 0),
        )
    except OSError as error:
        raise ProgramError(f"The program does not start: {error}.") from error
    printed, said = [], []
    readers = [
        threading.Thread(target=lambda: printed.append(process.stdout.read()), daemon=True),
        threading.Thread(target=_read_progress, args=(process.stderr, said, on_progress), daemon=True),
    ]
    for reader in readers:
        reader.start()
    while True:
        if is_canceled():
            _end(process)
            _close(process, readers)
            raise ProgramCanceled
        try:
            process.wait(LOOK_AGAIN_S)
            break
        except subprocess.TimeoutExpired:
            pass
    _close(process, readers)
    if is_canceled():
        raise ProgramCanceled
    if process.returncode != 0:
        raise ProgramError("\n".join(said).strip() or f"The program ended with code {process.returncode}.")
    return "".join(printed)


def run_with_feedback(arguments, feedback):
    """`run` with the progress and the cancel button of Processing."""

    def on_progress(text, percent):
        feedback.setProgressText(text)
        feedback.setProgress(percent)

    feedback.pushCommandInfo("sandtable " + " ".join(map(str, arguments)))
    return run(arguments, on_progress, feedback.isCanceled)


def catalog():
    """The kinds of terrain analysis, as the program has them: a list of dictionaries."""
    return json.loads(run(["catalog"]))


def _read_progress(stream, said, on_progress):
    for line in stream:
        line = line.rstrip()
        if not line.startswith(PROGRESS_PREFIX):
            said.append(line)
            continue
        text = line[len(PROGRESS_PREFIX) :]
        step, _, share = text.removesuffix(" %").rpartition(" ") if text.endswith(" %") else (text, "", "")
        if step in STEPS:
            part = float(share) / 100.0 if share.isdigit() else 0.0
            on_progress(step, 100.0 * (STEPS.index(step) + part) / len(STEPS))
        elif share.isdigit():
            on_progress(step, float(share))


def _close(process, readers):
    for reader in readers:
        reader.join()
    process.stdout.close()
    process.stderr.close()


def _end(process):
    process.terminate()
    try:
        process.wait(CANCEL_S)
    except subprocess.TimeoutExpired:
        process.kill()
        process.wait()
