"""What the library gives to the package's own modules; `__init__.pyi` has what is public."""

from collections.abc import Callable, Sequence
from os import PathLike
from typing import Any, final

import numpy as np
from numpy.typing import NDArray

from . import Dem as Dem
from . import Finding as Finding
from . import LineOfSight as LineOfSight
from . import Mesh as Mesh
from . import Plan as Plan
from . import Profile as Profile
from . import Raster as Raster
from . import Symbol as Symbol
from . import licenses as licenses
from . import set_limit as set_limit
from ._progress import Said

__VERSION__: str

_Progress = Said | Callable[[float], object] | bool | None

@final
class _Features:
    def __len__(self) -> int: ...
    def geojson(self) -> str: ...
    @property
    def crs(self) -> str: ...

@final
class _BuiltScene:
    @staticmethod
    def open(
        path: str | PathLike[str],
        *,
        allow: Sequence[str | PathLike[str]] = (),
        allow_remote: Sequence[str] = (),
        progress: _Progress = None,
    ) -> _BuiltScene: ...
    @staticmethod
    def build(
        text: str,
        given: Sequence[tuple[str, Any]],
        *,
        allow: Sequence[str | PathLike[str]] = (),
        allow_remote: Sequence[str] = (),
        progress: _Progress = None,
    ) -> _BuiltScene: ...
    @property
    def cameras(self) -> tuple[str, ...]: ...
    @property
    def notes(self) -> tuple[str, ...]: ...
    @property
    def built_findings(self) -> tuple[Finding, ...]: ...
    @property
    def findings(self) -> tuple[Finding, ...]: ...
    def render(
        self,
        camera: str | None = None,
        size: tuple[int, int] | None = None,
        *,
        progress: _Progress = None,
    ) -> NDArray[np.uint8]: ...
    def png(
        self,
        camera: str | None = None,
        size: tuple[int, int] | None = None,
        *,
        longest: int | None = None,
        progress: _Progress = None,
    ) -> bytes: ...
    def save(
        self,
        path: str | PathLike[str],
        camera: str | None = None,
        size: tuple[int, int] | None = None,
        *,
        progress: _Progress = None,
    ) -> None: ...
    def page(self, *, progress: _Progress = None) -> bytes: ...
    def analyze(
        self,
        kind: str,
        *,
        crs: Any | None = None,
        progress: _Progress = None,
        **arguments: Any,
    ) -> Any: ...

def _features(
    shapes: Sequence[bytes | None], columns: Sequence[tuple[str, Any]], crs: Any
) -> _Features: ...
def _analysis_kinds() -> str: ...
def _run_program(arguments: list[str], restart: list[str]) -> int: ...
