"""The program ``sandtable``, which pip puts on the path."""

from __future__ import annotations

import signal
import sys

from ._sandtable import _run_program


def main() -> int:
    """Runs the program with the arguments of this process, and returns its exit code."""
    # Ctrl-C ends the program as the program has it, unless whoever started it has Ctrl-C ignored.
    if signal.getsignal(signal.SIGINT) is signal.default_int_handler:
        signal.signal(signal.SIGINT, signal.SIG_DFL)
    return _run_program(["sandtable", *sys.argv[1:]], [sys.executable or "", *sys.orig_argv[1:]])
