"""Scenes that are made in Python, or opened from a scene file."""

from __future__ import annotations

import itertools
import os
import sys
import warnings
from collections.abc import Callable, Sequence
from keyword import iskeyword
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

from . import _data, _progress, _saved, _toml
from ._errors import SandtableWarning
from ._sandtable import _BuiltScene
from ._tables import SceneTables

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from . import Finding

_S = TypeVar("_S", bound="Scene")

#: What hears of the progress of work.
_Progress = Callable[[float], object] | bool | None

#: The longest side of the picture that a notebook shows, in pixels.
_NOTEBOOK_PX = 1280


class Scene(SceneTables):
    """A scene: the ground, what lies and stands on it, and views of it.

    Parameters
    ----------
    ground : path, DataArray, rasterio dataset, array or Dem
        Elevation in meters: the path of a file or folder, or a list of paths of tiles; an ``xarray.DataArray`` as rioxarray
        has it; a dataset of rasterio; an array of shape (rows, columns) from the north-west, with ``transform`` and ``crs``;
        or a ``Dem``. A path that ends in ``.toml`` is a scene file, and what is added comes after its tables.
    transform : affine.Affine or sequence of float
        Of an array: the transform of its outer north-west corner, or its first six numbers.
    crs : str, int, pyproj.CRS or rasterio.crs.CRS
        The coordinate system of an array; of a file or DataArray that names none or a wrong one.
    nodata : float
        A value that means no data.
    allow : sequence of path
        Folders that a scene file may read besides the parent of its own. Paths given to methods may be read.
    allow_remote : sequence of str
        Hosts, each HOST or HOST:PORT, that files with an address are read from.

    Every method that adds something returns a new scene, and leaves this one as it is:

    >>> scene = st.Scene(dem).roads(gdf, width="lanes * 3.5").labels(places, text="name").camera("overview")
    >>> scene.render(size=(1920, 1080)).shape
    (1080, 1920, 3)

    The methods are the tables of the scene file, and their keywords its keys. Features come from a GeoDataFrame, a GeoSeries,
    shapes of shapely, texts of WKT, the path of a file, an object with ``__geo_interface__``, a table with a column of
    positions, or a list of positions. Their coordinate system is that of the data; where these have none, ``crs=`` states it.

    A scene is built when it is first rendered, and built once. What should be looked at is a ``SandtableWarning``, what keeps
    it from being built a ``SandtableError``; both name a line of ``toml()``.
    """

    _file: Path | None

    def __init__(
        self,
        ground: Any,
        *,
        transform: Any = None,
        crs: Any = None,
        nodata: float | None = None,
        allow: Sequence[str | PathLike[str]] = (),
        allow_remote: Sequence[str] = (),
    ) -> None:
        self._begin(None, allow, allow_remote)
        if isinstance(ground, (str, PathLike)) and os.fspath(ground).lower().endswith(".toml"):
            if transform is not None or crs is not None or nodata is not None:
                raise ValueError("a scene file states its own ground; leave out transform, crs and nodata")
            self._file = Path(ground)
            return
        self._add("terrain", "[terrain]", _data.ground(ground, transform, crs, nodata), {})

    def _begin(self, file: Path | None, allow: Sequence[Any], allow_remote: Sequence[str]) -> None:
        """A scene of a file, or one without any table."""
        self._file = file
        self._top: dict[str, Any] = {}
        self._tables: tuple[tuple[str, dict[str, Any]], ...] = ()
        self._given: dict[str, Any] = {}
        self._allow: tuple[Path, ...] = tuple(Path(folder) for folder in allow)
        self._allow_remote = tuple(allow_remote)
        self._built: _BuiltScene | None = None

    @classmethod
    def open(
        cls,
        path: str | PathLike[str],
        *,
        allow: Sequence[str | PathLike[str]] = (),
        allow_remote: Sequence[str] = (),
    ) -> Scene:
        """Opens a scene file and the files that it names under the parent of its folder, or under the folders ``allow``.

        Elevation that has an address is read from the hosts ``allow_remote``, each HOST or HOST:PORT, which are allowed in
        this process from then on. Raises SandtableError with file, line and column where the scene is wrong; ``findings`` of
        the exception are all errors.
        """
        scene = cls.__new__(cls)
        scene._begin(Path(path), allow, allow_remote)
        scene._build()
        return scene

    def _with(self: _S, table: str, head: str, source: Any, keys: dict[str, Any]) -> _S:
        """A copy with one more table, or with more keys in the one that there is."""
        stated = {name[:-1] if iskeyword(name[:-1]) else name: value for name, value in keys.items() if value is not None}
        given = _data.Given({})
        if source is not None:
            at = stated.get("at")
            given = _data.features(source, stated.get("crs"), at)
            if "columns" in given.keys and at is not None:
                del stated["at"]
        copy = self.__class__.__new__(self.__class__)
        copy.__dict__.update(self.__dict__)
        copy._top, copy._given, copy._built = dict(self._top), dict(self._given), None
        copy._add(table, head, given, stated)
        return copy

    def _add(self, table: str, head: str, given: _data.Given, stated: dict[str, Any]) -> None:
        keys = dict(given.keys)
        if given.data is not None:
            name = self._free_name(table, given.ending)
            keys = {key: name if value == "{name}" else value for key, value in keys.items()}
            self._given[name] = given.data
        self._allow += given.allow
        for key, value in stated.items():
            keys[key] = self._value(table, key, value)
        if not head:
            self._top |= keys
            return
        merged = [index for index, (known, _) in enumerate(self._tables) if known == head and not head.startswith("[[")]
        if merged:
            tables = list(self._tables)
            tables[merged[0]] = (head, {**tables[merged[0]][1], **keys})
            self._tables = tuple(tables)
        else:
            self._tables += ((head, keys),)

    def _free_name(self, table: str, ending: str) -> str:
        numbers = itertools.chain([""], (f"-{number}" for number in itertools.count(2)))
        names = (f"memory:{table}{number}{ending}" for number in numbers)
        return next(name for name in names if name not in self._given)

    def _value(self, table: str, key: str, value: Any) -> Any:
        """The value of a key: data in memory and paths by their names."""
        if key in ("crs", "points_crs") and value is not None:
            return _data.crs_text(value)
        if isinstance(value, dict):
            return {inner: self._value(table, inner, part) for inner, part in value.items()}
        if isinstance(value, (bytes, bytearray)) or hasattr(getattr(value, "geometry", None), "to_wkb"):
            given = _data.features(value, None, None)
            name = self._free_name(f"{table}-{key}", given.ending)
            self._given[name] = given.data
            return name if isinstance(value, (bytes, bytearray)) else {"file": name}
        if isinstance(value, PathLike) or (isinstance(value, str) and os.path.isabs(value)):
            named, allow = _data.path_of(value)
            self._allow += allow
            return named
        if key in ("file", "font") and isinstance(value, str):
            named, allow = _data.path_of(value)
            self._allow += allow
            return named
        return value

    def toml(self) -> str:
        """The scene file that says the same.

        Data in memory are named ``memory:…``; a comment says so, and ``save("folder/scene.toml")`` writes them beside the file.
        """
        if self._file is not None and not self._tables and not self._top:
            return self._file.read_text(encoding="utf-8")
        comment = '# memory:… is data of Python: Scene.save("folder/scene.toml") writes it beside the scene file\n\n'
        return (comment if self._given else "") + self._text(lambda value: value)

    def _text(self, named: Callable[[Any], Any]) -> str:
        """The text with values as ``named`` gives them."""
        top = dict(self._top)
        if self._file is not None:
            included = top.pop("include", [])
            included = [included] if isinstance(included, str) else list(included)
            top = {"include": [self._file.absolute().as_posix(), *included]} | top
        parts = [_toml.table("", named(top))] if top else []
        parts += [_toml.table(head, named(keys)) for head, keys in self._tables]
        return "\n".join(parts)

    def _build(self, progress: _progress.Said | bool = False) -> _BuiltScene:
        if self._built is None:
            self._built = self._build_new(progress)
            for finding in self._built.built_findings:
                if finding.severity != "note":
                    warnings.warn(SandtableWarning(finding), stacklevel=_outside())
        return self._built

    def _build_new(self, progress: _progress.Said | bool) -> _BuiltScene:
        remote = list(self._allow_remote)
        if self._file is not None and not self._tables and not self._top:
            return _BuiltScene.open(self._file, allow=list(self._allow), allow_remote=remote, progress=progress)
        allow = list(dict.fromkeys(self._allow))
        if self._file is not None:
            folder = self._file.absolute().parent
            # What the included file may read itself.
            allow += [folder.parent if folder.parent.parent != folder.parent else folder]
        text = self.toml()
        return _BuiltScene.build(
            text, list(self._given.items()), allow=allow, allow_remote=remote, progress=progress
        )

    @property
    def cameras(self) -> tuple[str, ...]:
        """The names of the cameras, the first one that of the default."""
        return self._build().cameras

    @property
    def notes(self) -> tuple[str, ...]:
        """What was done that a user should know, each in a sentence."""
        return self._build().notes

    @property
    def findings(self) -> tuple[Finding, ...]:
        """What is wrong with the scene or looks wrong, as ``sandtable check`` finds it: the scene is checked when this is
        first needed."""
        return self._build().findings

    def render(
        self, camera: str | None = None, size: tuple[int, int] | None = None, *, progress: _Progress = None
    ) -> NDArray[np.uint8]:
        """Renders the view of a camera, with its annotations: uint8 of shape (H, W, 3), red, green and blue.

        ``camera`` is one of ``cameras``, the first by default; ``size`` is (width, height), 16 to 16384 pixels each, by default
        that of the camera's paper or (1920, 1080), or as many in the shape of what a map shows. The pixels are those of
        ``sandtable render``.

        ``progress`` is called with the share of the picture that is drawn, 0 to 1, some times a second. With ``progress=True``
        the step and its share are printed on standard error. By default a notebook shows them under the cell while work takes
        longer than a second; ``progress=False`` shows nothing.
        """
        with _progress.of_parts(progress) as said:
            return self._build(said).render(camera, size, progress=said)

    def save(
        self,
        path: str | PathLike[str],
        *,
        camera: str | None = None,
        size: tuple[int, int] | None = None,
        progress: _Progress = None,
    ) -> None:
        """Writes a file in the format of its extension.

        ========================  ===============================================================
        ``.png``                  the picture of ``render``
        ``.pdf``, ``.svg``        the same, with letters and lines as vectors
        ``.html``                 a page for browsers, which needs no network
        ``.glb``, ``.obj``        a model, true to scale
        ``.toml``                 the scene file, with GeoTIFF and GeoJSON of data in memory beside it
        ========================  ===============================================================

        ``camera`` and ``size`` are those of a picture, as in ``render``, and so is ``progress``. Raises SandtableError.
        """
        path = Path(path)
        if path.suffix.lower() != ".toml":
            with _progress.of_parts(progress) as said:
                self._build(said).save(path, camera, size, progress=said)
            return
        text = self.toml()
        if self._file is None or self._tables or self._top:
            text = self._text(_saved.relative_names(path, _saved.write_data(self._given, path)))
        path.write_text(text, encoding="utf-8")

    def show(self, *, progress: _Progress = None) -> _saved.ScenePage:
        """The scene as a page that a notebook shows in a frame: turned, zoomed and asked for heights with the mouse.

        ``progress`` is that of ``render``.
        """
        with _progress.of_parts(progress) as said:
            return _saved.ScenePage(self._build(said).page(progress=said))

    def analyze(self, kind: str, *, crs: Any = None, progress: _Progress = None, **arguments: Any) -> Any:
        """Analyzes the ground, as ``sandtable analyze``: ``kind`` and the keywords are those of ``sandtable.kinds()``.

        Positions are (x, y) in ``crs``, by default the scene's, texts that state places, lists or arrays of them, or shapes of
        shapely. ``extent`` is (x0, y0, x1, y1), two opposite corners or a ring. A kind that gives a raster alone makes an
        ``xarray.DataArray``, which needs xarray; every other an ``Analysis``. The ground has its earthworks, and roads, water,
        woods and buildings are known. Raises SandtableError.

        ``progress`` is that of ``render``; an exception of it ends the analysis.
        """
        with _progress.of_parts(progress) as said:
            return self._build(said).analyze(kind, crs=crs, progress=said, **arguments)

    def _repr_png_(self) -> bytes:
        with _progress.of_parts(None) as said:
            return self._build(said).png(longest=_NOTEBOOK_PX, progress=said)

    def __repr__(self) -> str:
        if self._file is not None and not self._tables and not self._top:
            return f"<Scene {self._file}>"
        counts: dict[str, int] = {}
        for head, _ in self._tables:
            name = head.strip("[]")
            counts[name] = counts.get(name, 0) + 1
        shown = ", ".join(name if count == 1 else f"{count} {name}" for name, count in counts.items())
        return f"<Scene of {shown}>" if self._file is None else f"<Scene {self._file} and {shown}>"


def _outside() -> int:
    """How many calls up the code is that uses the package."""
    here, frame, depth = os.path.dirname(__file__), sys._getframe(1), 1
    while frame.f_back is not None and os.path.dirname(frame.f_code.co_filename) == here:
        frame, depth = frame.f_back, depth + 1
    return depth
