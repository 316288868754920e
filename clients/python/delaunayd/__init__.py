"""Client of delaunayd, the Delaunay triangulation daemon."""

from .client import Client, ConnectionLost, Located, Neighbour, Refused, Reply

__all__ = ["Client", "ConnectionLost", "Located", "Neighbour", "Refused", "Reply"]
__version__ = "0.1.0"
