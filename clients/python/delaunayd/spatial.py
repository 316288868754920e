"""The interface of scipy.spatial.Delaunay for points of the plane. Needs NumPy.

    from delaunayd.spatial import Delaunay

Differences from SciPy's:

- Triangles are exact, canonical and sorted, each counterclockwise from its smallest point. Where more than three points lie on a
  circle, the choice among the possible triangles is CGAL's. Thin triangles that Qhull drops are present.
- Collinear points are not an error: they have no triangles.
- `qhull_options` that concern how Qhull computes have no effect. Others, QJ for coincident points, and `furthest_site` are refused
  with NotImplementedError; more than two dimensions with ValueError.

clients/python/tests/scipy_tests.py in the repository lists the tests of SciPy that fail for these reasons.
"""

from __future__ import annotations

import os
import sys
import threading
import uuid
import warnings
import weakref
from typing import Any, Callable, Dict, List, Optional, Tuple

import numpy as np

from . import _planes, _protocol as protocol
from ._neighbors import neighbors_of
from .client import Client, ConnectionLost, Refused

__all__ = ["Delaunay"]

_HARMLESS_OPTIONS = frozenset("Qbb Qc Qz Qx Qt Q12 QJ Pp".split())
_threads = threading.local()  # .clients: of each thread, by URL


def _client_of_thread(url: Optional[str]) -> Client:
    key = (url or os.environ.get("DELAUNAY_URL"), os.getpid())
    clients: Dict[Any, Client] = _threads.__dict__.setdefault("clients", {})
    if key not in clients:
        clients[key] = Client(url)
    return clients[key]


def _drop(client: Client, name: str, pid: int) -> None:
    if pid == os.getpid():  # a forked child has a copy of the object, but the set is its parent's
        client._discard(name)


def _checked(points: Any) -> Any:
    if isinstance(points, np.ma.MaskedArray):
        raise ValueError("Input points cannot be a masked array")
    points = np.ascontiguousarray(points, dtype=np.float64)
    if points.ndim != 2 or points.shape[1] != 2:
        raise ValueError("points must have the shape (n, 2): delaunayd knows the plane alone")
    if len(points) == 0:
        raise ValueError("No points given")
    if not np.isfinite(points).all():
        raise ValueError("Points cannot contain NaN or infinity")
    return points


def _check_options(furthest_site: bool, options: Any) -> List[str]:
    if furthest_site:
        raise NotImplementedError("delaunayd has no furthest-site triangulations")
    if isinstance(options, bytes):
        options = options.decode()
    words = (options or "").split()
    for option in words:
        if option not in _HARMLESS_OPTIONS:
            raise NotImplementedError("%s: delaunayd has no such option of Qhull's" % option)
    return words


class Delaunay:
    """The Delaunay triangulation of points of shape (n, 2).

    The first arguments are SciPy's. `client` is a delaunayd.Client to use; else `url` is the address of the daemon, else it is
    $DELAUNAY_URL, localhost:6374 or a private daemon of this process. The points are in a temporary set there, which is dropped with
    this object or its connection, and created again if it is needed after that.

    Attributes, as for SciPy: points, simplices, neighbors, convex_hull, coplanar, equations, good, transform, vertex_to_simplex,
    vertex_neighbor_vertices, npoints, nsimplex, ndim, min_bound, max_bound, paraboloid_scale, paraboloid_shift."""

    ndim = 2
    furthest_site = False

    def __init__(
        self,
        points: Any,
        furthest_site: bool = False,
        incremental: bool = False,
        qhull_options: Any = None,
        *,
        url: Optional[str] = None,
        client: Optional[Client] = None,
    ):
        options = _check_options(furthest_site, qhull_options)
        self._given = client
        self._url = url
        self._begin()
        self._incremental = incremental
        self._points = _checked(points)
        self.simplices = self._make_set(True)
        if "QJ" in options and len(self._coincident) > 0:
            raise NotImplementedError("QJ would move coincident points apart; delaunayd lists them in `coplanar`")

    def _begin(self) -> None:
        self._lock = threading.RLock()
        self._cache: Dict[str, Any] = {}
        self._client: Optional[Client] = None
        self._name: Optional[str] = None
        self._fields: Dict[int, Any] = {}  # of the set; for the interpolators
        self._finalizer: Any = None

    @property  # type: ignore[misc]
    def __class__(self) -> Any:
        """SciPy's interpolators accept a triangulation only if isinstance identifies it as SciPy's; they use the same attributes
        then. So, if SciPy is loaded, that isinstance check succeeds."""
        theirs = sys.modules.get("scipy.spatial._qhull")
        return type(self) if theirs is None else _also(type(self), theirs.Delaunay)

    def __repr__(self) -> str:
        return "<delaunayd.spatial.Delaunay of %d points, %d triangles>" % (self.npoints, self.nsimplex)

    # ---- the set ----

    def _make_set(self, with_triangles: bool) -> Any:
        """Creates a set of the points and triangulates it; returns the triangles, if they are wanted."""
        client = self._given if self._given is not None else _client_of_thread(self._url)
        name = "py." + uuid.uuid4().hex
        data, n = protocol.pairs(self._points)
        requests = [
            protocol.request("CREATE", name, "TEMPORARY"),
            protocol.request("LOADB", name, n, body=data),
            protocol.request("TRIANGULATE", name),
        ]
        if with_triangles:
            requests.append(protocol.request("TRIANGLES", name, "BINARY"))
        try:
            simplices = client._run(requests, _last_triangles if with_triangles else lambda _: None)
        except BaseException:
            client._discard(name)
            raise
        self._client, self._name, self._fields = client, name, {}
        self._finalizer = weakref.finalize(self, _drop, client, name, os.getpid())
        self._finalizer.atexit = False  # the connection ends then
        return simplices

    def _forget_set(self) -> None:
        finalizer, self._finalizer, self._name = self._finalizer, None, None
        if finalizer is not None:
            finalizer()

    def _ask(self, ask: Callable[[Client, str], Any]) -> Any:
        """Returns ask(client, name). The set is created first if it does not exist, or no longer exists."""
        with self._lock:
            for tries in (1, 0):
                if self._name is None or self._client is None:
                    self._make_set(False)
                assert self._client is not None and self._name is not None
                try:
                    return ask(self._client, self._name)
                except (ConnectionLost, Refused) as error:
                    if tries == 0 or (isinstance(error, Refused) and error.code != "NOSET"):
                        raise
                    self._forget_set()

    def add_points(self, points: Any, restart: bool = False) -> None:
        """Adds points; their numbers follow those of the existing points. For an object created with incremental=True. With
        `restart` all points are triangulated again, with the same triangles as the result."""
        if not self._incremental:
            raise RuntimeError("incremental mode not enabled or already closed")
        points = np.asarray(points, dtype=np.float64)
        if points.size == 0 and points.ndim == 2:
            return
        points = _checked(points)
        with self._lock:
            if restart:
                self._forget_set()
            everything = np.concatenate([self._points, points])
            simplices = self._add_to_set(points) if self._name is not None else None
            self._points = everything
            if simplices is None:
                self._forget_set()
                simplices = self._make_set(True)
            self.simplices = simplices
            self._cache = {}

    def _add_to_set(self, points: Any) -> Any:
        """The triangles after that; None: the set no longer exists."""
        assert self._client is not None and self._name is not None
        data, n = protocol.pairs(points)
        requests = [
            protocol.request("LOADB", self._name, n, body=data),
            protocol.request("TRIANGLES", self._name, "BINARY"),
        ]
        try:
            # LOADB would create a set that was dropped with its connection, without triangles.
            return self._client._run([protocol.request("STAT", self._name)] + requests, _last_triangles)
        except (ConnectionLost, Refused):
            return None

    def close(self) -> None:
        """Ends the incremental mode and drops the set in the daemon. What has been computed stays."""
        self._incremental = False
        with self._lock:
            self._forget_set()

    def __enter__(self) -> "Delaunay":
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def __reduce__(self) -> Any:
        return _restore, (type(self), self._points, self.simplices, self._incremental, self._url)

    # ---- tables; each is computed on first use ----

    def _cached(self, key: str, compute: Callable[[], Any]) -> Any:
        if key not in self._cache:
            self._cache[key] = compute()
        return self._cache[key]

    @property
    def points(self) -> Any:
        """The points, shape (npoints, 2)."""
        return self._points

    @property
    def npoints(self) -> int:
        """The number of points."""
        return len(self._points)

    @property
    def nsimplex(self) -> int:
        """The number of triangles."""
        return len(self.simplices)

    @property
    def vertices(self) -> Any:
        """The old name of `simplices`."""
        warnings.warn("Delaunay attribute 'vertices' is deprecated in favour of 'simplices'", DeprecationWarning, 2)
        return self.simplices

    @property
    def min_bound(self) -> Any:
        """The least x and y."""
        return self._cached("min_bound", lambda: self._points.min(axis=0))

    @property
    def max_bound(self) -> Any:
        """The greatest x and y."""
        return self._cached("max_bound", lambda: self._points.max(axis=0))

    @property
    def good(self) -> Any:
        """1 for each triangle: all are good."""
        return self._cached("good", lambda: np.ones(self.nsimplex, dtype=np.int32))

    @property
    def neighbors(self) -> Any:
        """neighbors[i, k] is the triangle opposite corner k of triangle i, -1 at the hull."""
        return self._cached("neighbors", lambda: neighbors_of(self.simplices, self.npoints))

    @property
    def convex_hull(self) -> Any:
        """The edges of the hull, shape (n, 2); of collinear points, the edges between them."""
        return self._cached("convex_hull", self._find_hull)

    def _find_hull(self) -> Any:
        if self.nsimplex == 0:
            line = np.array(self._ask(Client.hull), dtype=np.int32)
            return np.column_stack([line[:-1], line[1:]])
        row, corner = np.nonzero(self.neighbors < 0)
        return np.column_stack([self.simplices[row, (corner + 1) % 3], self.simplices[row, (corner + 2) % 3]])

    @property
    def vertex_neighbor_vertices(self) -> Tuple[Any, Any]:
        """(indptr, indices): the neighbours of k are indices[indptr[k]:indptr[k + 1]], ascending."""
        pair: Tuple[Any, Any] = self._cached("vertex_neighbor_vertices", self._find_vertex_neighbors)
        return pair

    def _find_vertex_neighbors(self) -> Tuple[Any, Any]:
        edges = self._ask(Client.edges).view(np.int32)
        near = np.concatenate([edges[:, 0], edges[:, 1]])
        far = np.concatenate([edges[:, 1], edges[:, 0]])
        order = np.lexsort((far, near))
        indptr = np.zeros(self.npoints + 1, dtype=np.int32)
        np.cumsum(np.bincount(near, minlength=self.npoints), out=indptr[1:])
        return indptr, far[order]

    @property
    def vertex_to_simplex(self) -> Any:
        """A triangle of each point, for one that coincides with another a triangle of that; -1 if there is none."""
        return self._cached("vertex_to_simplex", self._find_vertex_simplices)

    def _find_vertex_simplices(self) -> Any:
        some = np.full(self.npoints, -1, dtype=np.int32)
        # The last assignment wins: the first triangle of each point.
        some[self.simplices[::-1].ravel()] = np.repeat(np.arange(self.nsimplex, dtype=np.int32)[::-1], 3)
        pairs = self._coincident
        some[pairs[:, 0]] = some[pairs[:, 1]]
        return some

    @property
    def _coincident(self) -> Any:
        def find() -> Any:
            return np.array(self._ask(Client.coincident), dtype=np.int32).reshape(-1, 2)

        return self._cached("coincident", find)

    @property
    def coplanar(self) -> Any:
        """Points in no triangle because they coincide with another: rows (point, triangle of that, that)."""
        pairs = self._coincident
        return np.column_stack([pairs[:, 0], self.vertex_to_simplex[pairs[:, 1]], pairs[:, 1]])

    @property
    def transform(self) -> Any:
        """Barycentric coordinates: those of x in triangle i are c = transform[i, :2].dot(x - transform[i, 2]) and 1 - c.sum(). NaN
        for a triangle that is too thin. Shape (nsimplex, 3, 2)."""
        return self._cached("transform", lambda: _planes.transforms(self._points, self.simplices))

    # ---- the paraboloid ----

    @property
    def paraboloid_scale(self) -> float:
        """Of the heights z = scale (x^2 + y^2) + shift."""
        return float(self._cached("paraboloid", lambda: _planes.paraboloid(self._points))[0])

    @property
    def paraboloid_shift(self) -> float:
        """Of the heights z = scale (x^2 + y^2) + shift."""
        return float(self._cached("paraboloid", lambda: _planes.paraboloid(self._points))[1])

    @property
    def equations(self) -> Any:
        """The plane of each lifted triangle: (normal, offset), shape (nsimplex, 4)."""
        scale, shift = self.paraboloid_scale, self.paraboloid_shift
        return self._cached("equations", lambda: _planes.planes(self._points, self.simplices, scale, shift))

    def lift_points(self, x: Any) -> Any:
        """Places of shape (..., 2) lifted to the paraboloid, shape (..., 3)."""
        return _planes.lift(np.asarray(x, dtype=np.float64), self.paraboloid_scale, self.paraboloid_shift)

    def plane_distance(self, xi: Any) -> Any:
        """The distance of each lifted place below the plane of each triangle: shape (..., nsimplex)."""
        lifted = self.lift_points(xi)
        return np.dot(lifted, self.equations[:, :3].T) + self.equations[:, 3]

    # ---- location, exact, by the daemon ----

    def find_simplex(self, xi: Any, bruteforce: bool = False, tol: Optional[float] = None) -> Any:
        """The triangle that contains each place of shape (..., 2), -1 outside and for NaN. On an edge or a point it is the
        first of those that meet there. The other arguments are SciPy's and have no effect: the answer is exact."""
        places = np.asarray(xi, dtype=np.float64)
        if places.shape[-1:] != (2,):
            raise ValueError("wrong dimensionality in xi: places must have 2 coordinates")
        flat = places.reshape(-1, 2)
        out = np.full(len(flat), -1, dtype=np.int32)
        inside = np.flatnonzero(((flat >= self.min_bound) & (flat <= self.max_bound)).all(axis=1))
        if len(inside) > 0 and self.nsimplex > 0:
            out[inside] = self._locate(flat[inside])
        return out.reshape(places.shape[:-1])

    def _locate(self, places: Any) -> Any:
        """The row of the triangle of each place: the daemon names the triangle by its corners."""
        corners = self._ask(lambda client, name: client.locate_triangles(name, places)).view(np.int32)
        rows = np.full(len(places), -1, dtype=np.int32)
        found = np.flatnonzero(corners[:, 0] >= 0)
        rows[found] = self._find_rows(corners[found, 0], corners[found, 1])
        return rows

    def _find_rows(self, a: Any, b: Any) -> Any:
        """The rows that begin with a, b. Rows with the same a follow one another, mostly a few."""
        at = self._cached("first_rows", self._find_first_rows)[a]
        second = self._cached("second", lambda: np.ascontiguousarray(self.simplices[:, 1]))
        left = np.flatnonzero(second[at] != b)
        for _ in range(12):
            if len(left) == 0:
                return at
            at[left] += 1
            left = left[second[at[left]] != b[left]]
        key = (self.simplices[:, 0].astype(np.int64) << 32) | second
        order = np.argsort(key)
        want = (a[left].astype(np.int64) << 32) | b[left]
        at[left] = order[np.searchsorted(key[order], want)]
        return at

    def _find_first_rows(self) -> Any:
        start = np.zeros(self.npoints + 1, dtype=np.int32)
        np.cumsum(np.bincount(self.simplices[:, 0], minlength=self.npoints), out=start[1:])
        return start

    # ---- the nearest points ----

    def query(self, x: Any, k: int = 1) -> Tuple[Any, Any]:
        """The k points nearest to each place of shape (..., 2), like scipy.spatial.cKDTree.query: distances and numbers, shape
        (...) for k = 1, else (..., k). Where there are fewer points, the distance is infinite and the number npoints. Of points
        that coincide one is found."""
        places = np.asarray(x, dtype=np.float64)
        if places.shape[-1:] != (2,):
            raise ValueError("x must consist of vectors of length 2")
        if not np.isfinite(places).all():
            raise ValueError("'x' must be finite, check for nan or inf values")
        flat = places.reshape(-1, 2)
        ids = self._ask(lambda client, name: client.nearest_all(name, flat, k)).astype(np.int64)
        none = ids == 0xFFFFFFFF
        ids[none] = 0
        distance = np.hypot(*(self._points[ids] - flat[:, None, :]).transpose(2, 0, 1))
        distance[none], ids[none] = np.inf, self.npoints
        shape = places.shape[:-1] + ((k,) if k > 1 else ())
        return distance.reshape(shape), ids.reshape(shape)


def _last_triangles(replies: Any) -> Any:
    return protocol.uint32s(replies[-1].data, 3).view(np.int32)


def _restore(kind: Any, points: Any, simplices: Any, incremental: bool, url: Optional[str]) -> Delaunay:
    """From a pickle: the set is created by the first call that needs it."""
    d: Delaunay = kind.__new__(kind)
    d._given, d._url = None, url
    d._begin()
    d._incremental, d._points, d.simplices = incremental, points, simplices
    return d


_both: Dict[Any, Any] = {}


def _also(ours: Any, theirs: Any) -> Any:
    """A class that is both, for isinstance; it has no instances."""
    if (ours, theirs) not in _both:
        _both[ours, theirs] = type(ours.__name__, (ours, theirs), {"__module__": ours.__module__})
    return _both[ours, theirs]
