"""Client of delaunayd, the Delaunay triangulation daemon.

`Client` for threads; `delaunayd.aio.Client` for asyncio; `delaunayd.spatial.Delaunay` with the interface of SciPy's.
"""

from ._protocol import Cells, Field
from .client import Client, ConnectionLost, Located, Neighbour, Pipeline, Refused, Reply

__all__ = ["Cells", "Client", "ConnectionLost", "Field", "Located", "Neighbour", "Pipeline", "Refused", "Reply"]
__version__ = "0.1.0"
