#!/usr/bin/env python3
"""Runs a command in a terminal of its own and prints what the terminal got; its exit code is that of the command.

    in_terminal.py [--interrupt-at TEXT] COMMAND...

At TEXT, the key Ctrl-C is pressed once. Standard library only.
"""

import fcntl
import os
import pty
import signal
import struct
import sys
import termios
import time

SECONDS = 120
COLUMNS = 120


def main():
    arguments = sys.argv[1:]
    interrupt_at = None
    if arguments[0] == "--interrupt-at":
        interrupt_at, arguments = arguments[1].encode(), arguments[2:]
    child, terminal = pty.fork()
    if child == 0:
        # The parent of this program may ignore signals, as a background job does.
        signal.signal(signal.SIGINT, signal.SIG_DFL)
        os.execvp(arguments[0], arguments)
    fcntl.ioctl(terminal, termios.TIOCSWINSZ, struct.pack("HHHH", 40, COLUMNS, 0, 0))
    got, deadline = b"", time.monotonic() + SECONDS
    while time.monotonic() < deadline:
        try:
            part = os.read(terminal, 65536)
        except OSError:
            # The command has ended, and with it the other end of the terminal.
            break
        if not part:
            break
        got += part
        if interrupt_at and interrupt_at in got:
            os.write(terminal, b"\x03")
            interrupt_at = None
    else:
        os.kill(child, signal.SIGKILL)
    _, status = os.waitpid(child, 0)
    sys.stdout.buffer.write(got)
    sys.stdout.flush()
    return os.waitstatus_to_exitcode(status) % 256


if __name__ == "__main__":
    sys.exit(main())
