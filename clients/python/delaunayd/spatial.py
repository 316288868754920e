"""The interface of scipy.spatial.Delaunay for points of the plane, in this process, without a daemon. Needs NumPy.

    from delaunayd.spatial import Delaunay

ConstrainedDelaunay keeps segments, and knows what is inside polygons; triangulate_polygon is its short form. simplify
finds the few points that a surface needs. SciPy has nothing like them.

Differences from SciPy's:

- Triangles are exact, canonical and sorted, each counterclockwise from its smallest point. Where more than three points lie on a
  circle, the choice among the possible triangles is CGAL's. Thin triangles that Qhull drops are present.
- Collinear points are not an error: they have no triangles.
- `qhull_options` that concern how Qhull computes have no effect. Others, QJ for coincident points, and `furthest_site` are refused
  with NotImplementedError; more than two dimensions with ValueError.

clients/python/tests/scipy_tests.py in the repository lists the tests of SciPy that fail for these reasons.
"""

from __future__ import annotations

import sys
import threading
import warnings
from typing import TYPE_CHECKING, Any, Callable, Dict, List, Optional, Tuple, TypeVar

import numpy as np

from . import _declared, _near, _planes, _refined
from ._declared import Crossing, checked_points
from ._refined import simplify
from ._triangulation import TOLERANCE, Triangulation, split as split_crossing
from ._values import doubles, real, truth

if TYPE_CHECKING:
    from ._constraints import Regions
    from ._types import ArrayLike, Floats, Ints, NDArray
    from .geometries import Graph
    from .client import Client

__all__ = ["ConstrainedDelaunay", "Crossing", "Delaunay", "simplify", "triangulate_polygon", "tsearch"]

_T = TypeVar("_T")
_HARMLESS_OPTIONS = frozenset("Qbb Qc Qz Qx Qt Q12 QJ Pp".split())


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


class _Moment:
    """Points, their triangulation, and what has been derived from it. It never changes: add_points makes another one."""

    def __init__(self, points: Floats, workers: Optional[int], declared: Optional[NDArray[Any]] = None):
        self.points = points
        self.triangulation = Triangulation(points, workers, declared)
        self.cache: Dict[str, Any] = {}


class Delaunay:
    """The Delaunay triangulation of points of shape (n, 2).

    The first arguments are SciPy's. `workers` is the number of threads, all processors if it is None or -1.

    `client`, a delaunayd.Client, or `url`, and `set`, a name: the points are also a set of that daemon, which others can use. The set
    is created with these points, unless it has the same ones; without points, those of the set are taken, and `ids` has their
    ids. add_points adds to the set, too. Changes by others are not followed: that is what client.mirror(name) is for. Without
    `set`, `client` and `url` have no effect.

    Attributes, as for SciPy: points, simplices, neighbors, convex_hull, coplanar, equations, good, transform, vertex_to_simplex,
    vertex_neighbor_vertices, npoints, nsimplex, ndim, min_bound, max_bound, paraboloid_scale, paraboloid_shift.

    Several threads may use an object at once. A pickle has the points, and the ids, but no longer the set."""

    ndim = 2
    furthest_site = False

    def __init__(
        self,
        points: Optional[ArrayLike] = None,
        furthest_site: bool = False,
        incremental: bool = False,
        qhull_options: Any = None,
        *,
        url: Optional[str] = None,
        client: Optional[Client] = None,
        set: Optional[str] = None,
        workers: Optional[int] = None,
    ):
        options = _check_options(furthest_site, qhull_options)
        if points is None and set is None:
            raise ValueError("No points given")
        checked = None if points is None else checked_points(points)
        self._shared: Any = None
        self.ids: Optional[NDArray[Any]] = None
        if set is not None:
            from ._shared import SharedSet

            self._shared = SharedSet(client, url, set)
            self.ids, checked = self._shared.open(checked)
            checked = checked_points(checked)
        assert checked is not None
        self._begin(checked, incremental, workers)
        if "QJ" in options and len(self._coincident) > 0:
            raise NotImplementedError("QJ would move coincident points apart; delaunayd lists them in `coplanar`")

    def _begin(self, points: Floats, incremental: bool, workers: Optional[int]) -> None:
        self._incremental = truth("incremental", incremental)
        self._workers = workers
        self._adding = threading.Lock()
        self._now = _Moment(points, workers)

    @property  # type: ignore[misc]
    def __class__(self) -> Any:
        """SciPy's interpolators accept a triangulation only if isinstance identifies it as SciPy's; they use the same attributes
        then. So, if SciPy is loaded, that isinstance check succeeds."""
        theirs = sys.modules.get("scipy.spatial._qhull")
        return type(self) if theirs is None else _also(type(self), theirs.Delaunay)

    def __repr__(self) -> str:
        return "<delaunayd.spatial.Delaunay of %d points, %d triangles>" % (self.npoints, self.nsimplex)

    # ---- points ----

    def add_points(self, points: ArrayLike, restart: bool = False) -> None:
        """Adds points; their numbers follow those of the existing points. For an object created with incremental=True. `restart`
        has no effect: the triangles depend on the points alone. Cost: that of a triangulation of all points."""
        if not self._incremental:
            raise RuntimeError("incremental mode not enabled or already closed")
        if np.size(points) == 0 and np.ndim(points) == 2:
            return
        more = checked_points(points)
        with self._adding:
            now = _Moment(np.concatenate([self._now.points, more]), self._workers)
            if self._shared is not None:
                self.ids = self._shared.add(self.ids, more)
            self._now = now

    def close(self) -> None:
        """Ends the incremental mode. What has been computed stays."""
        self._incremental = False

    def __enter__(self) -> "Delaunay":
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def __reduce__(self) -> Any:
        left = ("_now", "_adding", "_shared")
        kept = {name: value for name, value in vars(self).items() if name not in left}
        return _blank, (type(self),), {**kept, "points": self.points}

    def __setstate__(self, state: Dict[str, Any]) -> None:
        vars(self).update({name: value for name, value in state.items() if name != "points"}, _shared=None)
        self._begin(state["points"], self._incremental, self._workers)

    # ---- tables; each is computed on first use ----

    def _cached(self, key: str, compute: Callable[[_Moment], _T]) -> _T:
        now = self._now
        if key not in now.cache:
            now.cache[key] = compute(now)
        found: _T = now.cache[key]
        return found

    @property
    def points(self) -> Floats:
        """The points, shape (npoints, 2)."""
        return self._now.points

    @property
    def simplices(self) -> Ints:
        """The triangles, shape (nsimplex, 3): sorted rows, each counterclockwise from its smallest point."""
        return self._now.triangulation.simplices

    @property
    def npoints(self) -> int:
        """The number of points."""
        return len(self._now.points)

    @property
    def nsimplex(self) -> int:
        """The number of triangles."""
        return len(self.simplices)

    @property
    def vertices(self) -> Ints:
        """The old name of `simplices`."""
        warnings.warn("Delaunay attribute 'vertices' is deprecated in favour of 'simplices'", DeprecationWarning, 2)
        return self.simplices

    @property
    def min_bound(self) -> Floats:
        """The least x and y."""
        return self._cached("min_bound", lambda now: np.asarray(now.points.min(axis=0)))

    @property
    def max_bound(self) -> Floats:
        """The greatest x and y."""
        return self._cached("max_bound", lambda now: np.asarray(now.points.max(axis=0)))

    @property
    def good(self) -> Ints:
        """1 for each triangle: all are good."""
        return self._cached("good", lambda now: np.ones(len(now.triangulation.simplices), dtype=np.int32))

    @property
    def neighbors(self) -> Ints:
        """neighbors[i, k] is the triangle opposite corner k of triangle i, -1 at the hull."""
        return self._cached("neighbors", lambda now: now.triangulation.neighbors())

    @property
    def convex_hull(self) -> Ints:
        """The edges of the hull counterclockwise, shape (n, 2); of collinear points, the edges between them."""
        return self._cached("convex_hull", _hull_edges)

    @property
    def vertex_neighbor_vertices(self) -> Tuple[Ints, Ints]:
        """(indptr, indices): the neighbours of k are indices[indptr[k]:indptr[k + 1]], ascending."""
        return self._cached("vertex_neighbor_vertices", _vertex_neighbors)

    @property
    def vertex_to_simplex(self) -> Ints:
        """A triangle of each point, for one that coincides with another a triangle of that; -1 if there is none."""
        return self._cached("vertex_to_simplex", _vertex_simplices)

    @property
    def _coincident(self) -> Ints:
        return self._cached("coincident", lambda now: now.triangulation.coincident())

    @property
    def coplanar(self) -> Ints:
        """Points in no triangle because they coincide with another: rows (point, triangle of that, that)."""
        pairs = self._coincident
        return np.column_stack([pairs[:, 0], self.vertex_to_simplex[pairs[:, 1]], pairs[:, 1]])

    @property
    def transform(self) -> Floats:
        """Barycentric coordinates: those of x in triangle i are c = transform[i, :2].dot(x - transform[i, 2]) and 1 - c.sum(). NaN
        for a triangle that is too thin. Shape (nsimplex, 3, 2)."""
        return self._cached("transform", lambda now: np.asarray(_planes.transforms(now.points, now.triangulation.simplices)))

    # ---- the paraboloid ----

    @property
    def paraboloid_scale(self) -> float:
        """Of the heights z = scale (x^2 + y^2) + shift."""
        return float(self._cached("paraboloid", lambda now: _planes.paraboloid(now.points))[0])

    @property
    def paraboloid_shift(self) -> float:
        """Of the heights z = scale (x^2 + y^2) + shift."""
        return float(self._cached("paraboloid", lambda now: _planes.paraboloid(now.points))[1])

    @property
    def equations(self) -> Floats:
        """The plane of each lifted triangle: (normal, offset), shape (nsimplex, 4)."""
        scale, shift = self.paraboloid_scale, self.paraboloid_shift
        return self._cached(
            "equations", lambda now: np.asarray(_planes.planes(now.points, now.triangulation.simplices, scale, shift))
        )

    def lift_points(self, x: ArrayLike) -> Floats:
        """Places of shape (..., 2) lifted to the paraboloid, shape (..., 3)."""
        lifted: Floats = _planes.lift(_places(x), self.paraboloid_scale, self.paraboloid_shift)
        return lifted

    def plane_distance(self, xi: ArrayLike) -> Floats:
        """The distance of each lifted place below the plane of each triangle: shape (..., nsimplex)."""
        lifted = self.lift_points(xi)
        distances: Floats = np.dot(lifted, self.equations[:, :3].T) + self.equations[:, 3]
        return distances

    # ---- location, exact ----

    def find_simplex(self, xi: ArrayLike, bruteforce: bool = False, tol: Optional[float] = None) -> Ints:
        """The triangle that contains each place of shape (..., 2), -1 outside and for NaN. Exact: on an edge or a point it is the
        first of those that meet there.

        `tol`: a place outside the hull that is at most tol times the width and height of all points, added, away from an edge
        of the hull belongs to the triangle there, because places on an edge can rarely be expressed in doubles; 100 times the
        machine epsilon if it is None. 0: none does. `bruteforce` has no effect."""
        return self._now.triangulation.locate(_places(xi), TOLERANCE if tol is None else real(tol), self._workers)

    # ---- the nearest points ----

    def query(
        self,
        x: ArrayLike,
        k: Any = 1,
        eps: float = 0,
        p: float = 2,
        distance_upper_bound: float = np.inf,
        workers: int = 1,
    ) -> Tuple[Any, Any]:
        """The points nearest to each place of shape (..., 2), as scipy.spatial.cKDTree.query: distances and numbers, shape (...)
        for k = 1, else (..., k); k may also be a list of ranks, beginning with 1. Where there are fewer points than k, or none is
        nearer than `distance_upper_bound`, the distance is infinite and the number npoints. `p` is the norm, at least 1; `eps` would
        allow other points, but the answer is exact. Of points that are as near, lower numbers come first."""
        return _near.query(self._now, _finite(x), k, eps, p, distance_upper_bound, workers)

    def query_ball_point(
        self,
        x: ArrayLike,
        r: ArrayLike,
        p: float = 2.0,
        eps: float = 0,
        workers: int = 1,
        return_sorted: Optional[bool] = None,
        return_length: bool = False,
    ) -> Any:
        """The numbers of all points at most r from each place of shape (..., 2), ascending, as cKDTree.query_ball_point: a list, or
        an array of lists of the shape (...). `return_length`: only how many there are. `r` is broadcast to that shape."""
        return _near.query_ball_point(self._now, _finite(x), r, eps, p, workers, return_length)


class ConstrainedDelaunay(Delaunay):
    """The constrained Delaunay triangulation of points of shape (n, 2) and segments of shape (m, 2), pairs of points: every
    segment is an edge, or a chain of edges through the points on it, and all other edges are Delaunay. Crossing, a ValueError, names
    two segments that cross where no point is.

    `border`: the segments are the border of a region, in any order and direction, with holes, islands in holes and so on; or an array
    that says it of each segment. `number`: of the line or region, the same for all segments or one for each. A triangle is inside a
    border if every way out crosses it an odd number of times. `from_rings` and `from_geometries` make segments of polygons.

    `split`: segments that cross get points in common, at the nearest places, and are replaced by their parts; the new points follow the
    others. `deviation` is the largest distance of a part from its segment. `z`: heights of the points, NaN where there is none; those of new
    points are between the heights at the ends.

    It has all that Delaunay has, but add_points and natural neighbours; the paraboloid does not decide which edges there are."""

    def __init__(
        self,
        points: ArrayLike,
        segments: ArrayLike,
        border: Any = False,
        *,
        number: Any = 0,
        z: Optional[ArrayLike] = None,
        split: bool = False,
        workers: Optional[int] = None,
    ):
        self.segments: Ints = _declared.checked_segments(segments)
        self.border, self.number = border, number
        checked = checked_points(points)
        self.z: Optional[Floats] = None if z is None else _declared.checked_heights(z, len(checked))
        self.deviation = 0.0
        self.least_angle: Optional[float] = None
        self.unrefined: Optional[int] = None
        self._shared, self.ids = None, None
        self._begin(self._split(checked) if truth("split", split) else checked, False, workers)

    def _split(self, points: Floats) -> Floats:
        found = split_crossing(points, self.z, _declared.declare(self.segments, self.border, self.number))
        self.segments, self.border, self.number = _declared.segments_of(found.declared)
        self.z, self.deviation = found.z, found.deviation
        return found.points

    def _begin(self, points: Floats, incremental: bool, workers: Optional[int]) -> None:
        self._incremental, self._workers = incremental, workers
        self._now = _Moment(points, workers, _declared.declare(self.segments, self.border, self.number))

    @classmethod
    def from_rings(cls, *rings: ArrayLike, split: bool = False, workers: Optional[int] = None) -> "ConstrainedDelaunay":
        """That of a polygon, or of several: rings of shape (k, 2), closed or not. What is enclosed an odd number of times is inside.
        The points are those of all rings, one after the other."""
        if len(rings) == 0:
            raise ValueError("No rings given")
        return cls.from_geometries({"type": "Polygon", "coordinates": rings}, split=split, workers=workers)

    @classmethod
    def from_geometries(
        cls, geometries: Any, *, split: bool = False, workers: Optional[int] = None
    ) -> "ConstrainedDelaunay":
        """That of polygons, lines and points: a geometry of shapely, a list or an array of them, a GeoSeries or GeoDataFrame, or GeoJSON
        (delaunayd.geometries). Polygons become borders; feature i has the number i."""
        from .geometries import read

        return cls._from_graph(read(geometries), split, workers)

    @classmethod
    def _from_graph(cls, graph: Graph, split: bool, workers: Optional[int]) -> "ConstrainedDelaunay":
        try:
            return cls(
                graph.points, graph.segments, graph.border, number=graph.number, z=graph.z, split=split, workers=workers
            )
        except Crossing as error:
            raise _declared.named(error, graph) from None

    def __repr__(self) -> str:
        return "<delaunayd.spatial.ConstrainedDelaunay of %d points, %d segments, %d triangles>" % (
            self.npoints,
            len(self.segments),
            self.nsimplex,
        )

    @property
    def constrained_edges(self) -> Ints:
        """The edges that are parts of segments, the smaller point first, sorted, shape (n, 2)."""
        return self._cached("constrained_edges", lambda now: now.triangulation.constrained_edges())

    # ---- regions ----

    @property
    def inside(self) -> NDArray[Any]:
        """Whether each triangle is inside a border; only closed borders count. `simplices[d.inside]` are the triangles inside, and
        matplotlib's Triangulation takes `mask=~d.inside`."""
        return self._cached("inside", lambda now: now.triangulation.inside())

    def inside_of(self, number: int) -> NDArray[Any]:
        """Whether each triangle is inside the border of this number. ValueError: there is no such border, or it is open."""
        region = self.regions.borders.get(number)
        if region is None or not region.closed:
            raise ValueError("the border %d is open" % number if region is not None else "there is no border %d" % number)
        face, numbers, end = self._faces
        owner = np.repeat(np.arange(len(end)), np.diff(end, prepend=0))
        has = np.zeros(len(end), dtype=bool)
        has[owner[numbers == number]] = True
        mask: NDArray[Any] = has[face]
        return mask

    @property
    def region(self) -> Ints:
        """The smallest number of a border that contains each triangle, -1 outside of all."""
        return self._cached("region", lambda now: _first_region(*self._faces))

    @property
    def regions(self) -> Regions:
        """What the borders enclose, as Client.regions() has it; areas are exact, and rounded once."""
        return self._cached("regions", _regions)

    @property
    def _faces(self) -> Tuple[NDArray[Any], NDArray[Any], NDArray[Any]]:
        return self._cached("faces", lambda now: now.triangulation.faces())

    def refine(
        self, angle: Optional[float] = None, *, area: Optional[float] = None, length: Optional[float] = None,
        number: Optional[int] = None, keep: bool = False, limit: Optional[int] = None,
    ) -> "ConstrainedDelaunay":
        """The triangulation of these points and of others behind them, so that no triangle inside borders, or inside border `number`, has
        an angle below `angle` degrees (25 without any limit), an area above `area`, or an edge longer than `length`. Without borders
        the hull becomes one. `keep`: segments stay whole. `limit`: of new points, 16 for each by default. `least_angle` is the least
        angle inside, `unrefined` how many triangles are not as wanted. ValueError: a limit, or an open border."""
        points, (segments, border, numbers), angle, left = _refined.refined(self, angle, area, length, number, keep, limit)
        d = type(self)(points, segments, border, number=numbers, workers=self._workers)
        d.least_angle, d.unrefined = angle, left
        return d

    def to_matplotlib(self) -> Any:
        """A matplotlib.tri.Triangulation of the points and triangles, in which those outside of borders are masked if there are borders."""
        from matplotlib.tri import Triangulation as Theirs  # type: ignore[import]

        mask = ~self.inside if np.any(self.border) else None
        return Theirs(self.points[:, 0], self.points[:, 1], self.simplices, mask=mask)


def triangulate_polygon(*polygon: Any, split: bool = False, workers: Optional[int] = None) -> Tuple[Floats, Ints]:
    """The triangles of a polygon with holes: the points, shape (n, 2), and the triangles inside, shape (m, 3). `polygon`: its rings, of shape
    (k, 2), or one argument that ConstrainedDelaunay.from_geometries takes. What is inside any of several features counts. Crossing,
    a ValueError, names rings and sides that cross; with `split`, these get points in common, which follow the others."""
    from .geometries import read

    rings = len(polygon) > 1 or (len(polygon) == 1 and _is_ring(polygon[0]))
    geometries = {"type": "Polygon", "coordinates": polygon} if rings else polygon[0] if polygon else None
    if geometries is None:
        raise ValueError("No rings given")
    graph = read(geometries)
    if len(graph.points) == 0:
        return np.empty((0, 2)), np.empty((0, 3), dtype=np.int32)
    d = ConstrainedDelaunay._from_graph(graph, split, workers)
    return d.points, d.simplices[d.inside]


def _is_ring(value: Any) -> bool:
    """Whether it is an array of places, or nested lists of numbers."""
    first = value
    for _ in range(2):
        if isinstance(first, dict) or not hasattr(first, "__len__") or hasattr(first, "geom_type"):
            return False
        if len(first) == 0:
            return first is value
        first = next(iter(first))
    return isinstance(first, (int, float, np.number))


def _first_region(face: NDArray[Any], numbers: NDArray[Any], end: NDArray[Any]) -> Ints:
    count = np.diff(end, prepend=0)
    first = np.full(len(end), -1, dtype=np.int32)
    first[count > 0] = numbers[(end - count)[count > 0]]
    rows: Ints = first[face]
    return rows


def _regions(now: _Moment) -> Regions:
    from ._constraints import Region, Regions

    rows, (triangles, area) = now.triangulation.regions()
    return Regions(triangles, area, {number: Region(closed, count, size) for number, closed, count, size in rows})


def tsearch(tri: Delaunay, xi: ArrayLike) -> Ints:
    """tri.find_simplex(xi), as scipy.spatial.tsearch."""
    return tri.find_simplex(xi)


def _places(xi: ArrayLike) -> Floats:
    places: Floats = doubles(xi)
    if places.shape[-1:] != (2,):
        raise ValueError("wrong dimensionality in xi: places must have 2 coordinates")
    return places


def _finite(x: ArrayLike) -> Floats:
    places: Floats = doubles(x)
    if places.shape[-1:] != (2,):
        raise ValueError("x must consist of vectors of length 2")
    if not np.isfinite(places).all():
        raise ValueError("'x' must be finite, check for nan or inf values")
    return places


def _hull_edges(now: _Moment) -> Ints:
    hull = now.triangulation.hull()
    if len(now.triangulation.simplices) == 0:
        return np.column_stack([hull[:-1], hull[1:]])
    return np.column_stack([hull, np.roll(hull, -1)])


def _vertex_neighbors(now: _Moment) -> Tuple[Ints, Ints]:
    """The edges a, b with a < b are sorted. So are those of each b after a stable sort by b: its lower neighbours, which come first;
    the upper ones of each a follow one another."""
    edges, n = now.triangulation.edges(), len(now.points)
    by_upper = edges[np.argsort(edges[:, 1], kind="stable")]
    lower, upper = np.bincount(edges[:, 1], minlength=n), np.bincount(edges[:, 0], minlength=n)
    indptr = np.zeros(n + 1, dtype=np.int32)
    np.cumsum(lower + upper, out=indptr[1:])
    is_lower = np.repeat(np.tile([True, False], n), np.column_stack([lower, upper]).ravel())
    indices = np.empty(2 * len(edges), dtype=np.int32)
    indices[is_lower], indices[~is_lower] = by_upper[:, 0], edges[:, 1]
    return indptr, indices


def _vertex_simplices(now: _Moment) -> Ints:
    simplices = now.triangulation.simplices
    some = np.full(len(now.points), -1, dtype=np.int32)
    # The last assignment wins: the first triangle of each point.
    some[simplices[::-1].ravel()] = np.repeat(np.arange(len(simplices), dtype=np.int32)[::-1], 3)
    pairs = now.triangulation.coincident()
    some[pairs[:, 0]] = some[pairs[:, 1]]
    return some


def _blank(kind: Any) -> Any:
    """What a pickle fills. (Without it, pickle would compare __class__ with the type.)"""
    return kind.__new__(kind)


_both: Dict[Any, Any] = {}


def _also(ours: Any, theirs: Any) -> Any:
    """A class that is both, for isinstance; it has no instances."""
    if (ours, theirs) not in _both:
        _both[ours, theirs] = type(ours.__name__, (ours, theirs), {"__module__": ours.__module__})
    return _both[ours, theirs]
