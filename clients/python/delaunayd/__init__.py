"""Client of delaunayd, the Delaunay triangulation daemon.

`Client` for threads; `delaunayd.aio.Client` for asyncio; `Mirror` follows a set; `delaunayd.spatial.Delaunay` with the interface of
SciPy's; `delaunayd.interpolate` with that of its interpolators.
"""

from ._protocol import Cells, Contour, Field
from .client import Client, ConnectionLost, Located, Neighbour, Pipeline, Refused, Reply
from .mirror import Change, Mirror

__all__ = [
    "Cells", "Change", "Client", "ConnectionLost", "Contour", "Field", "Located", "Mirror", "Neighbour", "Pipeline", "Refused", "Reply"
]
__version__ = "0.1.0"
