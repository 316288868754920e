"""Client of delaunayd, the Delaunay triangulation daemon.

`Client` for threads; `delaunayd.aio.Client` for asyncio; `delaunayd.spatial.Delaunay` with the interface of SciPy's;
`delaunayd.interpolate` with that of its interpolators.
"""

from ._protocol import Cells, Contour, Field
from .client import Client, ConnectionLost, Located, Neighbour, Pipeline, Refused, Reply

__all__ = ["Cells", "Client", "ConnectionLost", "Contour", "Field", "Located", "Neighbour", "Pipeline", "Refused", "Reply"]
__version__ = "0.1.0"
