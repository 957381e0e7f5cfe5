from dataclasses import dataclass
from typing import Any

def kinds() -> list[dict[str, Any]]: ...
@dataclass(frozen=True)
class Analysis:
    kind: str
    features: list[dict[str, Any]]
    tables: list[dict[str, Any]]
    figures: list[dict[str, Any]]
    notes: list[str]
    source: str
    limits: list[str]
    crs: str | None
    _raster: dict[str, Any] | None
    # an xarray.DataArray
    @property
    def raster(self) -> Any | None: ...
    # a geopandas.GeoDataFrame
    def to_geopandas(self) -> Any: ...

def written(arguments: dict[str, Any]) -> list[tuple[str, str]]: ...
def made(said: dict[str, Any]) -> Any: ...
