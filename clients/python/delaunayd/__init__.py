"""delaunayd, the Delaunay triangulation daemon, and its geometry in this process.

`Client` for threads; `delaunayd.aio.Client` for asyncio; `Mirror` follows a set. Without a daemon: `delaunayd.spatial.Delaunay` with
the interface of SciPy's, and `delaunayd.interpolate` with that of its interpolators.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, List

if TYPE_CHECKING:
    from ._constraints import Constraints, Quality, Region, Regions
    from ._protocol import Band, Cells, Contour, Field
    from .client import Client, ConnectionLost, Located, Neighbour, Pipeline, Refused, Reply
    from .mirror import Change, Constraint, Mirror

__all__ = [
    "Band", "Cells", "Change", "Client", "ConnectionLost", "Constraint", "Constraints", "Contour", "Field", "Located", "Mirror", "Neighbour",
    "Pipeline", "Quality", "Refused", "Region", "Regions", "Reply"
]
__version__ = "1.0.0"

_HOMES = {
    "Band": "_protocol", "Cells": "_protocol", "Change": "mirror", "Constraint": "mirror", "Constraints": "_constraints", "Contour": "_protocol", "Field": "_protocol",
    "Mirror": "mirror", "Quality": "_constraints", "Region": "_constraints", "Regions": "_constraints"
}


def __getattr__(name: str) -> Any:
    """The client is imported when it is first used: delaunayd.spatial does without."""
    if name not in __all__:
        raise AttributeError("module 'delaunayd' has no attribute %r" % name)
    from importlib import import_module

    value = getattr(import_module("." + _HOMES.get(name, "client"), __name__), name)
    globals()[name] = value
    return value


def __dir__() -> List[str]:
    return sorted([*globals(), *__all__])
