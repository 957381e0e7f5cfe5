"""Values of Python as TOML."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Mapping
from numbers import Integral, Real
from os import PathLike
from typing import Any

_BARE_KEY = re.compile(r"[A-Za-z0-9_-]+")


def key(name: str) -> str:
    """A key, in quotes where it needs them."""
    return name if _BARE_KEY.fullmatch(name) else text(name)


def text(value: str) -> str:
    """A basic string."""
    escaped = {'"': '\\"', "\\": "\\\\", "\n": "\\n", "\r": "\\r", "\t": "\\t"}
    safe = (escaped.get(c) or (c if c >= " " and c != "\x7f" else f"\\u{ord(c):04x}") for c in value)
    return f'"{"".join(safe)}"'


def value(name: str, given: Any) -> str:
    """The value of a key ``name``: texts, truths, numbers, lists and tables, on one line.

    NumPy's numbers and arrays are numbers and lists, a shapely point is a list of two numbers, and a path is a text.
    """
    if isinstance(given, str):
        return text(given)
    if isinstance(given, bool) or type(given).__name__ in ("bool_", "bool"):
        return "true" if given else "false"
    if isinstance(given, Integral):
        return str(int(given))
    if isinstance(given, Real):
        number = float(given)
        if not math.isfinite(number):
            raise ValueError(f"{name} is {number}; give a finite number")
        return repr(number)
    if isinstance(given, PathLike):
        return text(str(given))
    if getattr(given, "geom_type", None) == "Point":
        return value(name, [given.x, given.y])
    if isinstance(given, Mapping):
        pairs = (f"{key(str(inner))} = {value(f'{name}.{inner}', part)}" for inner, part in given.items())
        return "{ " + ", ".join(pairs) + " }"
    if isinstance(given, Iterable) and not isinstance(given, (bytes, bytearray)):
        return "[" + ", ".join(value(name, part) for part in given) + "]"
    raise TypeError(f"{name} is of type {type(given).__name__}; give a text, a number, a list or a dict")


def table(head: str, keys: Mapping[str, Any]) -> str:
    """A table under its head, such as ``[[road]]``; an empty head for keys at the top."""
    lines = [head] if head else []
    lines += [f"{key(name)} = {value(name, given)}" for name, given in keys.items()]
    return "\n".join(lines) + "\n"
