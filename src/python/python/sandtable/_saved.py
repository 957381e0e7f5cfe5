"""Scene files with their data beside them, and pages in a notebook."""

from __future__ import annotations

import html
import os
from collections.abc import Callable
from pathlib import Path
from typing import Any

from ._sandtable import Dem, _Features

#: The largest page that a notebook holds: its file grows by as much each time the cell runs.
_MOST_PAGE_BYTES = 30_000_000

#: The height of the page in a notebook, in pixels.
_PAGE_HEIGHT_PX = 560


class ScenePage:
    """A scene as a page: turned, zoomed and asked for heights in a notebook. ``html`` is its text."""

    def __init__(self, page: bytes) -> None:
        self.html = page.decode("utf-8")

    def _repr_html_(self) -> str:
        if len(self.html) > _MOST_PAGE_BYTES:
            megabytes, most = len(self.html) / 1e6, _MOST_PAGE_BYTES / 1e6
            return (
                f"<p>The page has {megabytes:.0f} MB, more than the {most:.0f} MB that a notebook should hold: write it with "
                "<code>scene.save('scene.html')</code> and open that.</p>"
            )
        style = f"width: 100%; height: {_PAGE_HEIGHT_PX}px; border: 0"
        return f'<iframe srcdoc="{html.escape(self.html)}" style="{style}" sandbox="allow-scripts"></iframe>'

    def __repr__(self) -> str:
        return f"<ScenePage of {len(self.html) / 1e6:.1f} MB>"


def write_data(given: dict[str, Any], file: Path) -> dict[str, str]:
    """Writes data in memory beside the scene file; returns the names of the files."""
    names = {}
    for name, data in given.items():
        stem = f"{file.stem}-{name.removeprefix('memory:')}"
        if isinstance(data, Dem):
            names[name] = f"{stem}.tif"
            data._save(file.with_name(names[name]))
        elif isinstance(data, _Features):
            names[name] = f"{stem}.geojson"
            file.with_name(names[name]).write_text(data.geojson(), encoding="utf-8")
        else:
            names[name] = stem
            file.with_name(names[name]).write_bytes(data)
    return names


def relative_names(file: Path, named: dict[str, str]) -> Callable[[Any], Any]:
    """What turns names of data in memory into those of files, and absolute paths into ones from the scene file, where it may
    read them without permission: in the parent of its folder."""
    folder = file.absolute().parent

    def of(value: Any) -> Any:
        if isinstance(value, dict):
            return {key: of(part) for key, part in value.items()}
        if isinstance(value, (list, tuple)):
            return [of(part) for part in value]
        if not isinstance(value, str):
            return value
        if value in named:
            return named[value]
        if os.path.isabs(value) and Path(value).is_relative_to(folder.parent):
            return Path(os.path.relpath(value, folder)).as_posix()
        return value

    return of
