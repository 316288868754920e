"""A view like scipy.spatial.Delaunay of a triangulation in the plane. Needs NumPy.

    from delaunayd.spatial import Delaunay

Triangles are counterclockwise and exact; ties are broken in the daemon's canonical way. Points that
coincide with others are in no triangle and are listed in `coplanar`, as with SciPy.
"""

from __future__ import annotations

import uuid
import weakref
from typing import Any, Optional, Tuple

import numpy as np

from ._neighbors import neighbors_of
from .client import Client, Refused


def _drop(client: Client, name: str, owned: bool) -> None:
    try:
        client.drop(name)
    except (OSError, ValueError, Refused):
        pass  # the connection has gone, or the set has
    if owned:
        client.close()


class Delaunay:
    """Triangulates points of shape (n, 2) in a set of its own, which goes with this object."""

    ndim = 2

    def __init__(self, points: Any, url: Optional[str] = None, client: Optional[Client] = None):
        self.points = np.ascontiguousarray(points, dtype=np.float64)
        if self.points.ndim != 2 or self.points.shape[1] != 2:
            raise ValueError("points must have the shape (n, 2)")
        self._client = client if client is not None else Client(url)
        self._name = "py." + uuid.uuid4().hex
        self._edge_table: Optional[Tuple[Any, ...]] = None
        self.close = weakref.finalize(self, _drop, self._client, self._name, client is None)
        try:
            self._client.load(self._name, self.points)
            self._client.triangulate(self._name)
            self.simplices = self._client.triangles(self._name).view(np.int32)
        except BaseException:
            self.close()
            raise

    @property
    def npoints(self) -> int:
        return len(self.points)

    @property
    def nsimplex(self) -> int:
        return len(self.simplices)

    @property
    def min_bound(self) -> Any:
        return self.points.min(axis=0)

    @property
    def max_bound(self) -> Any:
        return self.points.max(axis=0)

    # ---- edges: every half edge of the simplices finds its edge's number ----
    # Fresh memory is what costs most here, so results go into arrays that are there already.

    def _edges(self) -> Tuple[Any, Any, Any]:
        """The edges, sorted; where those with a lower end k start; their upper ends."""
        if self._edge_table is None:
            edges = self._client.edges(self._name).view(np.int32)
            start = np.zeros(self.npoints + 1, dtype=np.int32)
            np.cumsum(np.bincount(edges[:, 0], minlength=self.npoints), out=start[1:])
            beyond = np.full(16, -1, dtype=np.int32)  # room for the steps beyond the last
            self._edge_table = (edges, start, np.concatenate([edges[:, 1], beyond]))
        return self._edge_table

    def _find_edges(self, low: Any, high: Any) -> Any:
        """The numbers of the edges low-high. Edges with the same lower end lie together, and most
        are found there within a few steps, the rest by bisection."""
        edges, start, far = self._edges()
        at = start[low]
        todo = np.flatnonzero(far[at] != high)
        for _ in range(12):
            if len(todo) == 0:
                return at
            next_at = at[todo] + 1
            at[todo] = next_at
            todo = todo[far[next_at] != high[todo]]
        key = (edges[:, 0].astype(np.int64) << 32) | edges[:, 1]
        at[todo] = np.searchsorted(key, (low[todo].astype(np.int64) << 32) | high[todo])
        return at

    def _sides(self) -> Tuple[Any, Any]:
        """Each edge has two sides, 2e (walking upwards, what lies to the left) and 2e + 1: the side
        on which the simplex lies, for the edge opposite each corner; and the simplex on each side,
        -1: none."""
        if not hasattr(self, "_side_table"):
            s = self.simplices
            a, b = np.empty((2, s.size), dtype=np.int32)
            for k in range(3):
                a[k::3] = s[:, (k + 1) % 3]
                b[k::3] = s[:, (k + 2) % 3]
            down = a > b
            high = np.maximum(a, b)
            side = self._find_edges(np.minimum(a, b, out=a), high)
            side *= 2
            side += down
            for k in range(3):
                high[k::3] = np.arange(len(s), dtype=np.int32)  # has served its purpose
            simplex = np.full(2 * len(self._edges()[0]), -1, dtype=np.int32)
            simplex[side] = high
            self._side_table = (side, simplex)
        return self._side_table

    @property
    def neighbors(self) -> Any:
        """neighbors[i, k] is the simplex opposite corner k of simplex i, -1 at the hull."""
        if not hasattr(self, "_neighbors"):
            self._neighbors = neighbors_of(self.simplices, self.npoints)
        return self._neighbors

    @property
    def convex_hull(self) -> Any:
        """The edges of the hull, shape (n, 2)."""
        hull = np.array(self._client.hull(self._name), dtype=np.int32)
        if self.nsimplex == 0:
            return np.column_stack([hull[:-1], hull[1:]])
        return np.column_stack([hull, np.roll(hull, -1)])

    @property
    def vertex_neighbor_vertices(self) -> Tuple[Any, Any]:
        """(indptr, indices): the neighbours of k are indices[indptr[k]:indptr[k + 1]], ascending."""
        edges = self._edges()[0]
        near = np.concatenate([edges[:, 0], edges[:, 1]])
        far = np.concatenate([edges[:, 1], edges[:, 0]])
        order = np.lexsort((far, near))
        indptr = np.zeros(self.npoints + 1, dtype=np.int32)
        np.cumsum(np.bincount(near, minlength=self.npoints), out=indptr[1:])
        return indptr, far[order]

    @property
    def vertex_to_simplex(self) -> Any:
        """A simplex of each vertex, -1 for a point that is in none."""
        some = np.full(self.npoints, -1, dtype=np.int32)
        some[self.simplices.ravel()] = np.repeat(np.arange(self.nsimplex, dtype=np.int32), 3)
        return some

    @property
    def coplanar(self) -> Any:
        """Points in no triangle because they coincide with another: rows (point, simplex, vertex)."""
        pairs = np.array(self._client.coincident(self._name), dtype=np.int32).reshape(-1, 2)
        return np.column_stack([pairs[:, 0], self.vertex_to_simplex[pairs[:, 1]], pairs[:, 1]])

    # ---- location, exact, by the daemon ----

    def find_simplex(self, xi: Any, bruteforce: bool = False, tol: Optional[float] = None) -> Any:
        """The simplex that contains each place, -1 outside. On an edge or a point it is one of those
        that meet there. The other arguments are SciPy's and have no effect: the answer is exact."""
        places = np.asarray(xi, dtype=np.float64)
        if places.shape[-1:] != (2,):
            raise ValueError("places must have 2 coordinates")
        found = self._client.locate_all(self._name, places.reshape(-1, 2))
        return np.array([self._simplex_of(f.ids) for f in found], dtype=np.int32).reshape(
            places.shape[:-1]
        )

    def _simplex_of(self, ids: Tuple[int, ...]) -> int:
        if not ids or self.nsimplex == 0:
            return -1
        if not hasattr(self, "_some_simplex"):
            self._some_simplex = self.vertex_to_simplex
        if len(ids) == 1:
            return int(self._some_simplex[ids[0]])
        low, high = np.array([min(ids[:2])], np.int32), np.array([max(ids[:2])], np.int32)
        edge = int(self._find_edges(low, high)[0])
        for simplex in self._sides()[1][2 * edge : 2 * edge + 2].tolist():
            if simplex >= 0 and (len(ids) == 2 or set(ids) == set(self.simplices[simplex].tolist())):
                return simplex
        return -1
