"""What the library gives to the package's own modules; `__init__.pyi` has what is public."""

from . import Dem as Dem
from . import Finding as Finding
from . import LineOfSight as LineOfSight
from . import Mesh as Mesh
from . import Plan as Plan
from . import Profile as Profile
from . import Raster as Raster
from . import Scene as Scene
from . import Symbol as Symbol
from . import licenses as licenses
from . import set_limit as set_limit

__VERSION__: str

def _analysis_kinds() -> str: ...
def _run_program(arguments: list[str], restart: list[str]) -> int: ...
