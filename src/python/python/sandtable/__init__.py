"""Elevation models and scenes: heights, profiles, lines of sight, viewsheds, meshes and pictures.

>>> import sandtable
>>> dem = sandtable.Dem.open("assets/jacksboro/dem.tif")
>>> dem.shape
(344, 403)

Answers are those of the program ``sandtable``, to the last bit. Everything computes on all cores and without the
interpreter's lock; arrays are NumPy's. ``import sandtable.xarray`` adds the accessor ``.sandtable`` to arrays of xarray,
and ``sandtable.dask`` does plans on a Dask cluster.
"""

from . import plot
from ._analysis import Analysis, kinds
from ._errors import SandtableError, SandtableWarning
from ._sandtable import Dem, Finding, LineOfSight, Mesh, Plan, Profile, Raster, Symbol, licenses, set_limit
from ._sandtable import __VERSION__ as __version__
from ._scene import Scene

__all__ = [
    "Analysis",
    "Dem",
    "Finding",
    "LineOfSight",
    "Mesh",
    "Plan",
    "Profile",
    "Raster",
    "SandtableError",
    "SandtableWarning",
    "Scene",
    "Symbol",
    "__version__",
    "kinds",
    "licenses",
    "plot",
    "set_limit",
]
