"""What a scene is made of: files by their paths, and data of Python, which are handed over in memory.

```text
path ──────────────────► the path, absolute
GeoDataFrame, shapely ─► well-known binary and columns ──┐
table, WKT ────────────► CSV ────────────────────────────┼─► `memory:NAME` and what it is
__geo_interface__ ─────► GeoJSON ────────────────────────┘
positions ─────────────► `points`, in the scene's text
```
"""

from __future__ import annotations

import csv
import io
import json
import re
from collections.abc import Mapping
from dataclasses import dataclass
from os import PathLike, fspath
from pathlib import Path
from typing import Any

from ._sandtable import Dem, _features

_WKT = re.compile(r"\s*(SRID=\d+;)?\s*(MULTI)?(POINT|LINESTRING|POLYGON|GEOMETRYCOLLECTION)\b", re.I)


@dataclass(frozen=True)
class Given:
    """Keys of a table, data in memory that they name as ``{name}``, folders that they read, and how the name of the data ends."""

    keys: dict[str, Any]
    data: Any = None
    allow: tuple[Path, ...] = ()
    ending: str = ""


def crs_text(crs: Any) -> str:
    """The coordinate system of a text, an EPSG code, a ``pyproj.CRS`` or a ``rasterio.crs.CRS``, as a scene file states it."""
    if isinstance(crs, str):
        return crs
    if isinstance(crs, int):
        return f"EPSG:{crs}"
    code = crs.to_epsg()
    return f"EPSG:{code}" if code is not None else crs.to_wkt(version="WKT1_GDAL")


def path_of(value: Any) -> tuple[Any, tuple[Path, ...]]:
    """A path as a scene file states it, absolute, and its folder; a text that names no file as it is."""
    if not isinstance(value, (str, PathLike)):
        return value, ()
    text = fspath(value)
    if "://" in text or (isinstance(value, str) and not _exists(text)):
        return text, ()
    path = Path(text).absolute()
    return path.as_posix(), (path if path.is_dir() else path.parent,)


def _exists(text: str) -> bool:
    return "\0" not in text and len(text) <= 4096 and "\n" not in text and Path(text).exists()


def ground(dem: Any, transform: Any, crs: Any, nodata: float | None) -> Given:
    """The keys of ``[terrain]`` for elevation of any kind."""
    if isinstance(dem, Dem):
        return _opened_dem(dem)
    if isinstance(dem, (str, PathLike)):
        return _elevation_files([dem], crs, nodata)
    if isinstance(dem, (list, tuple)) and all(isinstance(part, (str, PathLike)) for part in dem):
        return _elevation_files(list(dem), crs, nodata)
    if hasattr(dem, "dims") and hasattr(dem, "to_numpy"):
        return Given({"dem": "{name}"}, _dem_of_xarray(dem, crs, nodata))
    if hasattr(dem, "read") and hasattr(dem, "transform"):
        return _dataset(dem, crs, nodata)
    return Given({"dem": "{name}"}, _dem_of_array(dem, transform, crs, nodata))


def _dataset(dem: Any, crs: Any, nodata: float | None) -> Given:
    if _exists(dem.name):
        return _elevation_files([dem.name], crs, nodata)
    crs, nodata = crs or dem.crs, dem.nodata if nodata is None else nodata
    return Given({"dem": "{name}"}, _dem_of_array(dem.read(1), tuple(dem.transform), crs, nodata))


def _opened_dem(dem: Dem) -> Given:
    if dem._source is None:
        return Given({"dem": "{name}"}, dem)
    file, stated = dem._source
    if stated["vertical_unit"] is not None:
        raise ValueError("the Dem has a vertical_unit in meters; name its file, and its unit by terrain(vertical_unit=…)")
    named, allow = path_of(file)
    return Given({"dem": named} | {key: value for key, value in stated.items() if value is not None}, None, allow)


def _elevation_files(files: list[Any], crs: Any, nodata: float | None) -> Given:
    named = [path_of(file) for file in files]
    keys: dict[str, Any] = {"dem": named[0][0] if len(named) == 1 else [name for name, _ in named]}
    keys |= {} if crs is None else {"crs": crs_text(crs)}
    keys |= {} if nodata is None else {"nodata": nodata}
    return Given(keys, None, tuple(folder for _, allow in named for folder in allow))


def _dem_of_array(array: Any, transform: Any, crs: Any, nodata: float | None) -> Dem:
    if transform is None:
        raise ValueError(
            "an array has no place: give transform=, an affine.Affine or its first six numbers, of the outer north-west corner"
        )
    if crs is None:
        raise ValueError("the elevation has no coordinate system: give crs=, such as crs='EPSG:32616'")
    return Dem.from_array(array, list(transform)[:6], crs, nodata=nodata)


def _dem_of_xarray(array: Any, crs: Any, nodata: float | None) -> Dem:
    try:
        from .xarray import _dem_of
    except ImportError as error:
        raise ImportError("a DataArray needs rioxarray, which knows its place: pip install rioxarray") from error
    if crs is not None:
        array = array.rio.write_crs(crs_text(crs))
    if array.rio.crs is None:
        raise ValueError("the DataArray has no coordinate system: give crs=, such as crs='EPSG:32616'")
    return _dem_of(array if nodata is None else array.rio.write_nodata(nodata))


def features(source: Any, crs: Any, at: Any) -> Given:
    """The keys of a source: a file, or data of Python, or positions."""
    if isinstance(source, (str, PathLike)) and not (isinstance(source, str) and _WKT.match(source)):
        named, allow = path_of(source)
        return Given({"file": named}, None, allow)
    if isinstance(source, (bytes, bytearray)):
        return Given({"file": "{name}"}, bytes(source))
    if hasattr(getattr(source, "geometry", None), "to_wkb"):
        return Given({"file": "{name}"}, _geo_frame(source, crs))
    if hasattr(source, "to_csv"):
        return _table(source, crs, at)
    if isinstance(source, Mapping) or (hasattr(source, "__geo_interface__") and not hasattr(source, "wkb")):
        return Given({"file": "{name}"}, _geojson(source), ending=".geojson")
    if isinstance(source, str) or hasattr(source, "wkb"):
        source = [source]
    return _sequence(list(source), crs)


def _geo_frame(frame: Any, crs: Any) -> Any:
    shapes = frame.geometry
    system = shapes.crs if shapes.crs is not None else crs
    if system is None:
        kind = type(frame).__name__
        raise ValueError(f"the {kind} has no coordinate system: give crs=, such as crs='EPSG:4326'")
    columns = []
    if hasattr(frame, "columns"):
        own = {shapes.name, *(name for name in frame.columns if str(frame[name].dtype) == "geometry")}
        columns = [(str(name), _column(frame[name])) for name in frame.columns if name not in own]
    elif frame.name is not None:
        columns = []
    return _features(shapes.to_wkb().tolist(), columns, crs_text(system))


def _column(values: Any) -> Any:
    """The values of a column as an array of numbers or truths, or those that are there with their rows."""
    # Types of pandas have values that are missing.
    is_plain = type(values.dtype).__module__.startswith("numpy")
    wanted = {"f": "float64", "i": "int64", "u": "int64", "b": "bool"}.get(getattr(values.dtype, "kind", "O"))
    if not is_plain or wanted is None:
        rows = values.notna().to_numpy(dtype="bool").nonzero()[0].astype("int64")
        return rows, values.iloc[rows].tolist()
    return values.to_numpy(dtype="float64" if str(values.dtype) == "uint64" else wanted)


def _table(table: Any, crs: Any, at: Any) -> Given:
    """A table without shapes: its columns say where its rows lie, or `at` names those that do."""
    keys: dict[str, Any] = {"file": "{name}"}
    if isinstance(at, str):
        keys["columns"] = {"position": at}
    elif at is not None:
        if crs is None:
            raise ValueError(f"the columns {at[0]} and {at[1]} have no coordinate system: give crs=, such as crs='EPSG:4326'")
        keys["columns"] = {"x": at[0], "y": at[1]}
    missing = [name for name in keys.get("columns", {}).values() if name not in table.columns]
    if missing:
        names = ", ".join(map(str, table.columns))
        raise ValueError(f"the table has no column {missing[0]!r}; its columns are {names}")
    return Given(keys, table.to_csv(index=False).encode(), ending=".csv")


def _geojson(source: Any) -> bytes:
    return json.dumps(source if isinstance(source, Mapping) else source.__geo_interface__).encode()


def _sequence(parts: list[Any], crs: Any) -> Given:
    """Shapes of shapely, texts of WKT, or positions."""
    if parts and all(hasattr(part, "wkb") for part in parts):
        if crs is None:
            raise ValueError("shapes of shapely have no coordinate system: give crs=, such as crs='EPSG:4326'")
        return Given({"file": "{name}"}, _features([part.wkb for part in parts], [], crs_text(crs)))
    if parts and all(isinstance(part, str) and _WKT.match(part) for part in parts):
        if crs is None:
            raise ValueError("WKT has no coordinate system: give crs=, such as crs='EPSG:4326'")
        out = io.StringIO()
        csv.writer(out).writerows([["wkt"], *([part] for part in parts)])
        return Given({"file": "{name}", "columns": {"shape": "wkt"}}, out.getvalue().encode(), ending=".csv")
    return Given({"points": parts})
