"""A triangulation in this process: arrays go to libdelaunay-core and come back without copies. It never changes, so any number of
threads may use it at once, without a lock, and a forked process has its own."""

from __future__ import annotations

import ctypes
import os
from typing import TYPE_CHECKING, Any, List, NamedTuple, Optional, Tuple

import numpy as np

from . import _library
from ._declared import crossing
from ._library import COINCIDENT, CROSSES, EDGES, HULL, NOEDGE, NOPOINT, byref, check
from ._values import first_bad, whole

if TYPE_CHECKING:
    from ._types import Floats, Ints, NDArray, Numbers

TOLERANCE: float = 100 * float(np.finfo(np.float64).eps)  # SciPy's, of places beside the hull

_PLACES = "coordinates of places"


def processors() -> int:
    """How many threads the processors of this process can run at once."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def workers_of(workers: Optional[int]) -> int:
    """As for cKDTree, -1 is as many as there are processors; so is None."""
    if workers is None or workers == -1:
        return processors()
    if whole(workers) < 1:
        raise ValueError("workers must be at least 1, or -1 for all processors")
    return whole(workers)


def _first_bad(points: Floats) -> str:
    row = first_bad(points)
    return "points[%d] is %s" % (row, points[row]) if row >= 0 else "%d points" % len(points)


def _check_declared(status: int, points: Floats, wrong: Any) -> None:
    if status == CROSSES:
        raise crossing(points, wrong)
    if status != 0:
        check(status, _first_wrong(status, points, wrong))


def _first_wrong(status: int, points: Floats, wrong: Any) -> str:
    return "point %d" % wrong[0] if status in (NOPOINT, NOEDGE) else _first_bad(points)


class Splitting(NamedTuple):
    """The points, those in common last, their heights, the constraints along which segments run now, how many were split, and the largest
    distance of a part from its segment."""

    points: Floats
    z: Optional[Floats]
    declared: NDArray[Any]
    split: int
    deviation: float


def split(points: Floats, z: Optional[Floats], declared: NDArray[Any]) -> Splitting:
    """Gives constraints that cross points in common."""
    library, plan, wrong = _library.library(), _library.Split(), (ctypes.c_uint32 * 4)()
    heights = None if z is None else z.ctypes.data
    status = library.dt_arrays_split(
        points.ctypes.data, heights, len(points), declared.ctypes.data, len(declared), byref(plan), wrong
    )
    try:
        _check_declared(status, points, wrong)
        more = _copied_bytes(plan.point, 16 * plan.n_points).view(np.float64).reshape(-1, 2)
        if z is not None:
            values = _copied_bytes(plan.value, 8 * plan.n_points * (plan.columns > 0)).view(np.float64)
            z = np.concatenate([z, values if plan.columns > 0 else np.full(len(more), np.nan)])
        parts = _copied_bytes(plan.added, declared.itemsize * plan.n_added).view(declared.dtype)
        return Splitting(np.concatenate([points, more]), z, parts, int(plan.split), float(plan.deviation))
    finally:
        library.dt_split_clear(byref(plan))


def _copied_bytes(address: Optional[int], size: int) -> NDArray[Any]:
    copied = np.empty(size, dtype=np.uint8)
    if address is not None:
        ctypes.memmove(copied.ctypes.data, address, size)
    return copied


class Triangulation:
    """Of points of shape (n, 2), contiguous; with constraints, as of declare(), the constrained one. `simplices`: the triangles, sorted, each
    counterclockwise from its smallest point. Without `rows` there are none, and only values(), nearest(), within() and hull() may be called."""

    _handle: Any = None

    def __init__(self, points: Floats, workers: Optional[int] = None, declared: Optional[NDArray[Any]] = None, rows: bool = True):
        self._library = _library.library()
        n = len(points)
        found = np.empty((2 * n if rows else 0, 3), dtype=np.int32)  # there are fewer; pages that are not touched cost nothing
        handle = ctypes.c_void_p()
        if declared is None:
            status = self._library.dt_arrays_new(
                points.ctypes.data, n, _library.pages, workers_of(workers), found.ctypes.data if rows else None, byref(handle)
            )
            check(status, _first_bad(points) if status != 0 else "")
        else:
            wrong = (ctypes.c_uint32 * 4)()
            status = self._library.dt_arrays_declared(
                points.ctypes.data, n, declared.ctypes.data, len(declared), _library.pages, workers_of(workers),
                found.ctypes.data, byref(handle), wrong
            )
            _check_declared(status, points, wrong)
        self._handle = handle
        self.counts = _library.Counts()
        self._library.dt_arrays_counts(handle, byref(self.counts))
        self.simplices: Ints = found[: self.counts.triangles]

    def __del__(self) -> None:
        if self._handle is not None:
            self._library.dt_arrays_free(self._handle)

    # ---- tables ----

    def _table(self, table: int, rows: int, width: int) -> Ints:
        out = np.empty((rows, width), dtype=np.int32)
        check(self._library.dt_arrays_table(self._handle, table, out.ctypes.data), "a table")
        return out

    def coincident(self) -> Ints:
        """Rows (point, the point that represents it)."""
        return self._table(COINCIDENT, self.counts.coincident, 2)

    def edges(self) -> Ints:
        """The edges, the smaller point first, sorted."""
        return self._table(EDGES, self.counts.edges, 2)

    def hull(self) -> Ints:
        """The points of the hull, counterclockwise; those of a line from end to end."""
        return self._table(HULL, self.counts.hull, 1)[:, 0]

    def neighbors(self) -> Ints:
        """neighbors[i, k] is the row opposite corner k of row i, -1 at the hull."""
        twins = np.empty(self.simplices.shape, dtype=np.int32)
        self._library.dt_arrays_twins(self._handle, twins.ctypes.data)
        twins //= 3  # the side that begins at corner k + 1 is opposite corner k; -1 stays -1
        return np.roll(twins, -1, axis=1)

    # ---- constraints ----

    def constrained_edges(self) -> Ints:
        """The edges that are parts of segments, the smaller point first, sorted."""
        found = _library.Ids()
        try:
            check(self._library.dt_arrays_constrained_edges(self._handle, byref(found)), "edges")
            return self._copied(found).astype(np.int32).reshape(-1, 2)
        finally:
            self._library.dt_arrays_release(found.v)

    def inside(self) -> NDArray[Any]:
        """Whether each triangle is inside a border."""
        inside = np.zeros(len(self.simplices), dtype=bool)
        check(self._library.dt_arrays_inside(self._handle, self.simplices.ctypes.data, inside.ctypes.data), "the border")
        return inside

    def faces(self) -> Tuple[NDArray[Any], NDArray[Any], NDArray[Any]]:
        """The face of each triangle; the numbers of the borders that contain each face, face by face; and where those of each end."""
        face = np.empty(len(self.simplices), dtype=np.uint32)
        number, end = _library.Ids(), _library.Ids()
        try:
            check(self._library.dt_arrays_faces(self._handle, face.ctypes.data, byref(number), byref(end)), "faces")
            return face, self._copied(number), self._copied(end)
        finally:
            self._library.dt_arrays_release(number.v)
            self._library.dt_arrays_release(end.v)

    def regions(self) -> Tuple[List[Any], Any]:
        """What each border encloses, and what all do: (number, closed, triangles, area)."""
        rows, n, inside = ctypes.POINTER(_library.Region)(), ctypes.c_size_t(), _library.Region()
        check(self._library.dt_arrays_regions(self._handle, byref(rows), byref(n), byref(inside)), "regions")
        try:
            return [(r.number, r.closed, r.triangles, r.area) for r in rows[: n.value]], (inside.triangles, inside.area)
        finally:
            self._library.dt_arrays_release(rows)

    def refined(self, quality: Any) -> Tuple[Floats, NDArray[Any], Any]:
        """The points and the constraints (rows of a, b, border, number) of a mesh to order, and the counts."""
        from ._declared import _CONSTRAINT

        got = _library.Refined()
        check(self._library.dt_arrays_refine(self._handle, byref(quality), byref(got)), "refine")
        try:
            points = np.empty((got.points, 2))
            constraints = np.empty(got.constraints, dtype=_CONSTRAINT)
            for array, source in ((points, got.point), (constraints, got.constraint)):
                if array.size > 0:
                    ctypes.memmove(array.ctypes.data, source, array.nbytes)
            return points, constraints, got
        finally:
            self._library.dt_arrays_release(got.point)
            self._library.dt_arrays_release(got.constraint)

    @staticmethod
    def _copied(found: Any) -> NDArray[Any]:
        numbers = np.empty(found.n, dtype=np.uint32)
        if found.n > 0:
            ctypes.memmove(numbers.ctypes.data, found.v, 4 * found.n)
        return numbers

    # ---- places of shape (n, 2), contiguous ----

    def locate(self, places: Floats, tol: float, workers: Optional[int]) -> Ints:
        """The row of the triangle of each place, -1 outside; shape places.shape[:-1]."""
        out = np.empty(places.shape[:-1], dtype=np.int32)
        n = out.size
        workers = 1 if n < 2 else workers_of(workers)
        status = self._library.dt_arrays_locate(
            self._handle, places.ctypes.data, n, tol, workers, out.ctypes.data
        )
        if status != 0:
            check(status, _PLACES)
        return out

    def values(
        self, column: Floats, method: int, max_edge: float, places: Floats, outside: float, workers: Optional[int],
        tol: float = TOLERANCE,
    ) -> Floats:
        """The value at each place. Places that are outside the hull by less than tol times its size are on its edge."""
        out = np.empty(len(places))
        status = self._library.dt_arrays_values(
            self._handle, column.ctypes.data, method, max_edge, places.ctypes.data, len(places), tol, outside,
            workers_of(workers), out.ctypes.data
        )
        check(status, "max_edge")
        return out

    def nearest(self, places: Floats, k: int, workers: Optional[int]) -> Tuple[Floats, Numbers]:
        """The distances and numbers of the nearest k, shape (n, k); infinite and npoints where there are fewer."""
        ids = np.empty((len(places), k), dtype=np.uint32)
        distance = np.empty((len(places), k))
        status = self._library.dt_arrays_nearest(
            self._handle, places.ctypes.data, len(places), k, workers_of(workers), ids.ctypes.data, distance.ctypes.data
        )
        check(status, _PLACES)
        numbers = ids.astype(np.int64)
        numbers[ids == 0xFFFFFFFF] = self.counts.points
        return distance, numbers

    def within(self, places: Floats, r: Floats, workers: Optional[int]) -> Tuple[Numbers, Numbers]:
        """The numbers of the points at most r[i] from place i, ascending, of one place after the other; and where those of each
        end."""
        end = np.empty(len(places), dtype=np.uintp)
        found = _library.Ids()
        status = self._library.dt_arrays_within(
            self._handle, places.ctypes.data, r.ctypes.data, len(places), workers_of(workers), byref(found), end.ctypes.data
        )
        try:
            check(status, "places and distances")
            numbers = self._copied(found)
        finally:
            self._library.dt_arrays_release(found.v)
        return numbers.astype(np.int64), end.astype(np.int64)
