"""How far long work is: given to a function, printed, or shown under the cell of a notebook."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from importlib import import_module
from typing import Any

#: Work that is done by then shows nothing in a notebook.
_PATIENCE_S = 1.0

#: What is left is estimated after this time and this share: before, it is a guess. As the program does.
_LEAST_TIME_S = 2.0
_LEAST_SHARE = 0.02


class Said:
    """What hears of a step that work is at and of its share, 0 to 1, if it counts, and of the end."""

    def at(self, step: str, share: float | None) -> None:
        raise NotImplementedError

    def end(self, is_done: bool) -> None:
        raise NotImplementedError


class _Part(Said):
    """A part of work that goes on when the part has ended."""

    def __init__(self, whole: Said) -> None:
        self._whole = whole

    def at(self, step: str, share: float | None) -> None:
        self._whole.at(step, share)

    def end(self, is_done: bool) -> None:
        pass


class _Called(Said):
    """A function of the user."""

    def __init__(self, call: Callable[[float], object]) -> None:
        self._call = call

    def at(self, step: str, share: float | None) -> None:
        if share is not None:
            self._call(share)

    def end(self, is_done: bool) -> None:
        if is_done:
            self._call(1.0)


class _Line(Said):
    """A line of text that changes."""

    def __init__(self, patience_s: float) -> None:
        self._shown_from = time.monotonic() + patience_s
        self._step, self._since, self._text = "", time.monotonic(), ""

    def at(self, step: str, share: float | None) -> None:
        now = time.monotonic()
        if step != self._step:
            self._step, self._since = step, now
        text = step if share is None else step + _share_text(now - self._since, share)
        if now >= self._shown_from and text != self._text:
            self._show(text)
            self._text = text

    def end(self, is_done: bool) -> None:
        if self._text:
            self._clear()

    def _show(self, text: str) -> None:
        raise NotImplementedError

    def _clear(self) -> None:
        raise NotImplementedError


class _Printed(_Line):
    """A line of standard error, which goes away at the end."""

    def _show(self, text: str) -> None:
        print(f"\r{text:{len(self._text)}}", end="", file=sys.stderr, flush=True)

    def _clear(self) -> None:
        print(f"\r{'':{len(self._text)}}\r", end="", file=sys.stderr, flush=True)


class _Shown(_Line):
    """A line under a cell of a notebook, which is empty at the end."""

    _handle: Any = None

    def _show(self, text: str) -> None:
        shown = {"text/plain": text}
        if self._handle is None:
            # It states no types of it.
            display: Any = import_module("IPython.display")
            self._handle = display.display(shown, raw=True, display_id=True)
        else:
            self._handle.update(shown, raw=True)

    def _clear(self) -> None:
        self._handle.update({"text/plain": ""}, raw=True)


def of(progress: Any) -> Said | None:
    """What hears of the progress of work, by what the user gave for it; None where nothing does.

    Without anything it is a line in a notebook, and in IPython on a terminal.
    """
    if isinstance(progress, Said):
        return _Part(progress)
    if progress is None:
        return _by_default()
    if progress is True:
        return _Printed(0.0)
    if progress is False:
        return None
    if callable(progress):
        return _Called(progress)
    raise TypeError(
        f"progress is a {type(progress).__name__}; give a callable, True to print it on standard error, or False for none"
    )


@contextmanager
def of_parts(progress: Any) -> Iterator[Said | bool]:
    """What hears of several parts of work as of one; to be given on as `progress` of each."""
    said = of(progress)
    if said is None:
        yield False
        return
    is_done = False
    try:
        yield said
        is_done = True
    finally:
        said.end(is_done)


def _by_default() -> Said | None:
    # Who works in IPython has imported it.
    shell = sys.modules["IPython"].get_ipython() if "IPython" in sys.modules else None
    if shell is None:
        return None
    if hasattr(shell, "kernel"):
        return _Shown(_PATIENCE_S)
    return _Printed(_PATIENCE_S) if sys.stderr.isatty() else None


def _share_text(elapsed_s: float, share: float) -> str:
    """The share that is done, and the time that is left if all goes on alike."""
    percent = f" {int(share * 100)} %"
    if elapsed_s < _LEAST_TIME_S or share < _LEAST_SHARE:
        return percent
    left_s = elapsed_s * (1.0 - share) / share
    return f"{percent}, {left_s:.0f} s left" if left_s < 120.0 else f"{percent}, {left_s / 60.0:.0f} min left"
