"""Client of delaunayd, the Delaunay triangulation daemon.

`Client` for threads; `delaunayd.aio.Client` for asyncio; `delaunayd.spatial.Delaunay` with the interface of SciPy's.
"""

from .client import Client, ConnectionLost, Located, Neighbour, Pipeline, Refused, Reply

__all__ = ["Client", "ConnectionLost", "Located", "Neighbour", "Pipeline", "Refused", "Reply"]
__version__ = "0.1.0"
