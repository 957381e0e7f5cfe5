"""Terrain analyses: what Python gives as arguments, and what it gets.

NumPy is imported where it is used: the program, which starts by this package, does without.
"""

from __future__ import annotations

import json
from dataclasses import dataclass
from os import PathLike, fspath
from typing import Any

from ._sandtable import _analysis_kinds


def kinds() -> list[dict[str, Any]]:
    """The kinds of analysis: name, family, title, summary, what each gives, its parameters, source and limits.

    >>> [kind["name"] for kind in sandtable.kinds() if kind["family"] == "surface"]
    """
    return json.loads(_analysis_kinds())


@dataclass(frozen=True)
class Analysis:
    """What an analysis gives that is more than a raster.

    Attributes
    ----------
    kind : str
        The kind's name.
    raster : xarray.DataArray or None
        A value for each post, where the kind gives one; it needs xarray.
    features : list of dict
        GeoJSON features in the coordinate system `crs`, x and y.
    tables : list of dict
        Each with its `title` and `rows`, a dict a row.
    figures : list of dict
        Each with its `name`, `value` and `unit`.
    notes : list of str
        What was left out or is not known.
    source, limits : str, list of str
        Where the method is from, and what it does not know.
    crs : str or None
        The system of raster and features.
    """

    kind: str
    features: list[dict[str, Any]]
    tables: list[dict[str, Any]]
    figures: list[dict[str, Any]]
    notes: list[str]
    source: str
    limits: list[str]
    crs: str | None
    _raster: dict[str, Any] | None

    @property
    def raster(self):
        return None if self._raster is None else _data_array(self._raster, self)

    def to_geopandas(self):
        """The features as a ``geopandas.GeoDataFrame``, with their coordinate system."""
        try:
            import geopandas
        except ImportError as error:
            raise ImportError("to_geopandas makes a GeoDataFrame: pip install geopandas") from error
        if not self.features:
            return geopandas.GeoDataFrame({"geometry": []}, geometry="geometry", crs=self.crs)
        return geopandas.GeoDataFrame.from_features(self.features, crs=self.crs)

    def __repr__(self) -> str:
        parts = {"features": self.features, "tables": self.tables, "figures": self.figures}
        counts = [f"{len(part)} {name}" for name, part in parts.items() if part]
        return f"<Analysis {self.kind}: {', '.join(counts + ['a raster'] * (self._raster is not None))}>"


def written(arguments: dict[str, Any]) -> list[tuple[str, str]]:
    """Arguments as the command has them: names and texts. What is None is not stated."""
    return [(name, _text(name, value)) for name, value in arguments.items() if value is not None]


def made(said: dict[str, Any]):
    """What users see: the array of a kind that gives a raster alone, else an Analysis."""
    outcome = json.loads(said["json"])
    features = json.loads(said["features"])["features"]
    names = ("kind", "tables", "figures", "notes", "source", "limits")
    analysis = Analysis(
        **{name: outcome[name] for name in names}, features=features, crs=said["crs"], _raster=said["raster"]
    )
    gives = next(kind["gives"] for kind in kinds() if kind["name"] == analysis.kind)
    return analysis.raster if gives == "raster" else analysis


def _text(name: str, value: Any) -> str:
    import numpy as np

    if isinstance(value, str):
        return value
    if isinstance(value, PathLike):
        return fspath(value)
    if hasattr(value, "__geo_interface__"):
        return ";".join(_text(name, position[:2]) for position in _positions(name, value.__geo_interface__))
    if isinstance(value, (bool, np.bool_)):
        raise TypeError(f"{name} is {value}; give a number, a text, a position or positions")
    if isinstance(value, (int, float, np.integer, np.floating)):
        return repr(value.item() if isinstance(value, np.generic) else value)
    try:
        items = list(value)
    except TypeError:
        raise TypeError(f"{name} is a {type(value).__name__}; give a number, a text, a position or positions") from None
    texts = [_text(name, item) for item in items]
    # Numbers side by side are a position, an extent or rising numbers; anything else is a position an item.
    are_numbers = all(isinstance(item, (int, float, np.integer, np.floating)) for item in items)
    return ("," if are_numbers else ";").join(texts)


def _positions(name: str, shape: dict[str, Any]) -> list[Any]:
    kind, coordinates = shape.get("type"), shape.get("coordinates", [])
    if kind == "Point":
        return [coordinates]
    if kind in ("LineString", "MultiPoint"):
        return list(coordinates)
    if kind == "Polygon":
        return list(coordinates[0])[:-1]
    raise TypeError(f"{name} is a {kind}; give a point, points, a line or a polygon")


def _data_array(raster: dict[str, Any], analysis: Analysis):
    import numpy as np

    try:
        import xarray as xr
    except ImportError as error:
        raise ImportError("analyze makes an xarray.DataArray of a raster: pip install xarray") from error
    a, _, c, _, e, f = raster["transform"]
    array = raster["array"]
    rows, columns = array.shape
    coordinates = {"y": f + e * (np.arange(rows) + 0.5), "x": c + a * (np.arange(columns) + 0.5)}
    # Texts, numbers and lists of them alone: what NetCDF holds.
    attributes = {
        "long_name": raster["name"],
        "units": raster["units"],
        "crs": analysis.crs or "",
        "transform": list(raster["transform"]),
        "kind": analysis.kind,
        "classes": raster["classes"],
        "class_from": raster["class_from"],
        "class_tints": raster["class_tints"],
        "figures": [figure["name"] for figure in analysis.figures],
        "figure_values": [figure["value"] for figure in analysis.figures],
        "figure_units": [figure["unit"] for figure in analysis.figures],
        "source": analysis.source,
        "limits": analysis.limits,
        "notes": analysis.notes,
    }
    if array.dtype == np.uint8:
        attributes["_FillValue"] = np.uint8(255)
    made = xr.DataArray(array, coordinates, ("y", "x"), raster["name"], attributes)
    try:
        import rioxarray  # noqa: F401  (the accessor .rio)
    except ImportError:
        return made
    if analysis.crs is None:
        return made
    # It takes the attribute away.
    return made.rio.write_crs(analysis.crs).assign_attrs(crs=analysis.crs)
