"""The accessor ``.sandtable`` of ``xarray.DataArray``: queries of elevation that keep the georeference.

>>> import rioxarray, sandtable.xarray
>>> da = rioxarray.open_rasterio("dem.tif", masked=True).squeeze("band")
>>> seen = da.sandtable.viewshed((750_000, 4_018_000), range=5_000)
>>> seen.rio.crs, seen.rio.transform()

The array has a dimension along y and one along x, as rioxarray has them, and heights in meters. Coordinate system, transform
and no-data value are those of ``.rio``.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
import rioxarray  # noqa: F401  (the accessor .rio)
import xarray as xr
from affine import Affine
from numpy.typing import ArrayLike, NDArray

from . import Dem, LineOfSight, Mesh, Profile, Raster

if TYPE_CHECKING:
    from . import _Interpolation

# xarray states no types of it.
_accessor: Any = xr.register_dataarray_accessor


@_accessor("sandtable")
class SandtableAccessor:
    """Elevation queries of an array of shape (rows, columns), in meters."""

    def __init__(self, array: xr.DataArray) -> None:
        self._array = array
        self._dem: Dem | None = None

    @property
    def dem(self) -> Dem:
        """The elevation model of the array, which is read when it is first needed."""
        if self._dem is None:
            self._dem = _dem_of(self._array)
        return self._dem

    def heights(
        self, xy: ArrayLike | str | Sequence[str], interpolation: _Interpolation = "bilinear", **options: Any
    ) -> NDArray[np.float64]:
        """Heights at positions of shape (N, 2): float64 of shape (N,), meters. As ``Dem.heights``."""
        return self.dem.heights(xy, interpolation, **options)

    def profile(self, line: ArrayLike | Sequence[str], **options: Any) -> Profile:
        """The ground along a line of shape (N, 2). As ``Dem.profile``."""
        return self.dem.profile(line, **options)

    def line_of_sight(self, observer: Sequence[float] | str, target: Sequence[float] | str, **options: Any) -> LineOfSight:
        """Whether one position, (x, y), sees another. As ``Dem.line_of_sight``."""
        return self.dem.line_of_sight(observer, target, **options)

    def mesh(self, max_error: float) -> Mesh:
        """The mesh that is nowhere off by more than ``max_error`` meters. As ``Dem.mesh``."""
        return self.dem.mesh(max_error)

    def viewshed(self, observer: Sequence[float] | str, **options: Any) -> xr.DataArray:
        """What is seen from (x, y): uint8, 1 in sight, 0 hidden, 255 without data. As ``Dem.viewshed``."""
        return _data_array(self.dem.viewshed(observer, **options), "viewshed", self._array.rio)

    def hillshade(self, azimuth: float = 315.0, altitude: float = 45.0) -> xr.DataArray:
        """How directly the ground faces the sun: uint8, 1 to 255, 0 without data. As ``Dem.hillshade``."""
        return _data_array(self.dem.hillshade(azimuth, altitude), "hillshade", self._array.rio)

    def analyze(self, kind: str, **arguments: Any) -> Any:
        """A terrain analysis: an array of a kind that gives a raster alone, else an Analysis. As ``Dem.analyze``."""
        return self.dem.analyze(kind, **arguments)


def _dem_of(array: xr.DataArray) -> Dem:
    rio = array.rio
    plane = array.transpose(..., rio.y_dim, rio.x_dim)
    if plane.ndim != 2:
        shape = dict(zip(plane.dims, plane.shape))
        raise ValueError(f"the array has dimensions {shape}; take one band of it, as by .squeeze('band')")
    (a, b, c, d, e, f), values = _transform_of(rio), plane.to_numpy()
    if e > 0:
        # Rows from the south: the same samples, from the north.
        (b, c), (e, f) = (-b, c + b * len(values)), (-e, f + e * len(values))
        values = values[::-1]
    return Dem.from_array(values, (a, b, c, d, e, f), rio.crs, nodata=rio.nodata)


def _transform_of(rio: Any) -> tuple[float, ...]:
    """The stated transform, to the last bit, where it is still that of the coordinates: a slice has another."""
    stated, measured = tuple(rio.transform())[:6], tuple(rio.transform(recalc=True))[:6]
    cell = max(map(abs, measured[:2] + measured[3:5]))
    return stated if all(abs(a - b) <= 1e-6 * cell for a, b in zip(stated, measured)) else measured


def _data_array(raster: Raster, name: str, rio: Any) -> xr.DataArray:
    """The raster as an array with the names of dimensions of the array that it was computed of."""
    a, _, c, _, e, f = raster.transform
    rows, columns = raster.array.shape
    coordinates = {rio.y_dim: f + e * (np.arange(rows) + 0.5), rio.x_dim: c + a * (np.arange(columns) + 0.5)}
    made: Any = xr.DataArray(raster.array, coordinates, (rio.y_dim, rio.x_dim), name)
    made = made.rio.set_spatial_dims(rio.x_dim, rio.y_dim).rio.write_transform(Affine(*raster.transform))
    if raster.crs is not None:
        made = made.rio.write_crs(raster.crs)
    with_nodata: xr.DataArray = made.rio.write_nodata(raster.nodata)
    return with_nodata
