from collections.abc import Callable, Sequence
from os import PathLike
from typing import Any, Literal, final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import plot as plot
from ._analysis import Analysis as Analysis
from ._analysis import kinds as kinds
from ._scene import Scene as Scene

_Interpolation = Literal["bilinear", "planar", "nearest", "cubic", "distance-weighted"]
_Surface = Literal["source", "ground", "scene"]
# "EPSG:32616", a proj string, WKT 1, an EPSG code, a pyproj.CRS or a rasterio.crs.CRS
_Crs = Any
_Transform = tuple[float, float, float, float, float, float]

__version__: str

class SandtableError(Exception):
    file: str | None
    line: int | None
    column: int | None
    findings: tuple[Finding, ...]
    def __init__(
        self,
        message: str,
        file: str | None = None,
        line: int | None = None,
        column: int | None = None,
        findings: Sequence[Finding] = (),
    ) -> None: ...

class SandtableWarning(UserWarning):
    finding: Finding
    def __init__(self, finding: Finding) -> None: ...

@final
class Finding:
    @property
    def code(self) -> str: ...
    @property
    def severity(self) -> Literal["error", "warning", "note"]: ...
    @property
    def message(self) -> str: ...
    @property
    def help(self) -> str | None: ...
    @property
    def file(self) -> str | None: ...
    @property
    def line(self) -> int | None: ...
    @property
    def column(self) -> int | None: ...

@final
class Raster:
    @property
    def array(self) -> NDArray[np.uint8]: ...
    @property
    def transform(self) -> _Transform: ...
    @property
    def crs(self) -> str | None: ...
    @property
    def nodata(self) -> int: ...

@final
class Mesh:
    @property
    def vertices(self) -> NDArray[np.float32]: ...
    @property
    def triangles(self) -> NDArray[np.uint32]: ...
    @property
    def origin(self) -> tuple[float, float]: ...
    @property
    def crs(self) -> str | None: ...

@final
class Profile:
    @property
    def stations(self) -> NDArray[np.float64]: ...
    @property
    def xy(self) -> NDArray[np.float64]: ...
    @property
    def heights(self) -> NDArray[np.float64]: ...
    @property
    def length(self) -> float: ...
    @property
    def covered(self) -> float: ...
    @property
    def ground_length(self) -> float: ...
    @property
    def ascent(self) -> float: ...
    @property
    def descent(self) -> float: ...

@final
class LineOfSight:
    @property
    def visible(self) -> bool: ...
    @property
    def distance(self) -> float: ...
    @property
    def heights(self) -> tuple[float, float]: ...
    @property
    def blocker(self) -> tuple[float, float, float, float] | None: ...
    @property
    def clearance(self) -> float | None: ...
    @property
    def target_rise(self) -> float | None: ...
    @property
    def observer_rise(self) -> float | None: ...
    def __bool__(self) -> bool: ...

@final
class Dem:
    @property
    def _source(self) -> tuple[Any, dict[str, Any]] | None: ...
    @staticmethod
    def open(
        path: str | PathLike[str],
        *,
        crs: _Crs | None = None,
        nodata: float | None = None,
        vertical_datum: str | None = None,
        vertical_unit: float | None = None,
        height_scale: float | None = None,
        height_offset: float | None = None,
        cell: float | None = None,
        allow_remote: Sequence[str] = (),
    ) -> Dem: ...
    @staticmethod
    def from_array(
        array: ArrayLike,
        transform: Sequence[float],
        crs: _Crs | None = None,
        *,
        nodata: float | None = None,
    ) -> Dem: ...
    @property
    def shape(self) -> tuple[int, int]: ...
    @property
    def bounds(self) -> tuple[float, float, float, float]: ...
    @property
    def transform(self) -> _Transform: ...
    @property
    def crs(self) -> str | None: ...
    @property
    def vertical_datum(self) -> str | None: ...
    @property
    def notes(self) -> tuple[str, ...]: ...
    def to_numpy(self) -> NDArray[np.float32] | NDArray[np.float64]: ...
    def heights(
        self,
        xy: ArrayLike | str | Sequence[str],
        interpolation: _Interpolation = "bilinear",
        *,
        surface: _Surface | None = None,
        crs: _Crs | None = None,
    ) -> NDArray[np.float64]: ...
    def profile(
        self,
        line: ArrayLike | Sequence[str],
        *,
        interpolation: _Interpolation = "planar",
        step: float | None = None,
        crs: _Crs | None = None,
    ) -> Profile: ...
    def line_of_sight(
        self,
        observer: Sequence[float] | str,
        target: Sequence[float] | str,
        *,
        observer_height: float = 2.0,
        target_height: float = 0.0,
        refraction: float | None = None,
        flat: bool = False,
        crs: _Crs | None = None,
    ) -> LineOfSight: ...
    def _sight_chart(
        self,
        observer: Sequence[float] | str,
        target: Sequence[float] | str,
        *,
        observer_height: float = 2.0,
        target_height: float = 0.0,
        refraction: float | None = None,
        flat: bool = False,
        crs: _Crs | None = None,
    ) -> dict[str, Any]: ...
    def viewshed(
        self,
        observer: Sequence[float] | str,
        *,
        observer_height: float = 2.0,
        target_height: float = 0.0,
        range: float | None = None,
        sector: tuple[float, float] | None = None,
        refraction: float | None = None,
        flat: bool = False,
        crs: _Crs | None = None,
    ) -> Raster: ...
    def analyze(
        self,
        kind: str,
        *,
        crs: _Crs | None = None,
        progress: bool | Callable[[float], object] | None = None,
        **arguments: Any,
    ) -> Any: ...
    def mesh(self, max_error: float) -> Mesh: ...
    def hillshade(self, azimuth: float = 315.0, altitude: float = 45.0) -> Raster: ...

@final
class Symbol:
    def __new__(cls, code: str, **fields: object) -> Symbol: ...
    @property
    def code(self) -> str: ...
    @property
    def description(self) -> str: ...
    @property
    def notes(self) -> list[str]: ...
    def svg(self, size: float = 100.0) -> str: ...
    def png(self, size: float = 100.0) -> bytes: ...
    def render(self, size: float = 100.0) -> NDArray[np.uint8]: ...
    def _repr_svg_(self) -> str: ...
    def _repr_png_(self) -> bytes: ...

@final
class Plan:
    @staticmethod
    def open(folder: str | PathLike[str]) -> Plan: ...
    @property
    def product(self) -> Literal["heights", "viewsheds", "atlas", "tiles", "analysis"]: ...
    def __len__(self) -> int: ...
    def is_done(self, shard: int) -> bool: ...
    def check_inputs(self) -> None: ...
    def work(self, shard: int, threads: int = 1) -> Literal["done", "skipped"]: ...
    def gather(self, output: str | PathLike[str] | None = None) -> dict[str, Any]: ...

def set_limit(name: str, value: int) -> None: ...
def licenses() -> str: ...
