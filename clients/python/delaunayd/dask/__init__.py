"""The Delaunay triangulation of more points than fit into the memory of one machine, on Dask. Needs NumPy and dask; with distributed,
processes and machines share the work.

    from delaunayd.dask import triangulate
    tin = triangulate("points.npy")
    tin.to_npy("triangles.npy")

The triangles are exact and canonical: the same as those of one daemon or of delaunayd.spatial.Delaunay, whatever the tiles."""

from __future__ import annotations

from .results import Tin
from .making import triangulate

__all__ = ["Tin", "triangulate"]
