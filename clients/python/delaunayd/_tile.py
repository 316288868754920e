"""A tile of a triangulation of more points than one process holds: struct dt_tile of core/delaunay_tiles.h, which has the method and
its proof. `delaunayd.dask` distributes the tiles."""

from __future__ import annotations

import ctypes
from typing import TYPE_CHECKING, Any, Dict, NamedTuple

import numpy as np

from . import _library
from ._library import byref, check
from ._values import first_bad

if TYPE_CHECKING:
    from ._types import Floats, NDArray

_REFUSED = "a point of another tile contradicts this tile: coincident points must be in one tile, and an id has one place"


class Counts(NamedTuple):
    """own: own points, coincident ones included; coincident: those that another own point represents; foreign: points of other tiles;
    triangles: of own and foreign points together; postponed: faces at which the next `open` looks."""

    own: int
    foreign: int
    coincident: int
    triangles: int
    postponed: int


def _points(xy: Any) -> Floats:
    points = np.ascontiguousarray(xy, dtype=np.float64)
    if points.ndim != 2 or points.shape[1] != 2:
        raise ValueError("points have the shape (n, 2), not %s" % (points.shape,))
    return points


def _ids(ids: Any, n: int) -> NDArray[Any]:
    numbers = np.asarray(ids)
    if numbers.shape != (n,) or (n > 0 and numbers.dtype.kind not in "ui"):
        raise ValueError("ids are %d integers" % n)
    if numbers.dtype.kind == "i" and n > 0 and numbers.min() < 0:
        raise ValueError("ids are not negative")
    return np.ascontiguousarray(numbers, dtype=np.uint64)


def _check_points(points: Floats, status: int, otherwise: str) -> None:
    if status == _library.RANGE:
        row = first_bad(points)
        if row < 0:
            raise ValueError(otherwise)
        check(status, "point %d is %s" % (row, points[row]))
    check(status, "%d points" % len(points))


class Tile:
    """Of own points xy, of shape (n, 2), with ascending global ids. Every method but `triangles` needs exclusive access to the tile."""

    _handle: Any = None

    def __init__(self, xy: Any, ids: Any, workers: int = 1):
        points = _points(xy)
        numbers = _ids(ids, len(points))
        self._library = _library.library()
        handle = ctypes.c_void_p()
        status = self._library.dt_tile_new(
            points.ctypes.data, numbers.ctypes.data, len(points), _library.pages, workers, byref(handle)
        )
        _check_points(points, status, "ids must ascend")
        self._handle = handle

    def __del__(self) -> None:
        if self._handle is not None:
            self._library.dt_tile_free(self._handle)
            self._handle = None

    @property
    def counts(self) -> Counts:
        words = (ctypes.c_uint64 * 5)()
        self._library.dt_tile_counts(self._handle, words)
        return Counts(*words)

    def insert(self, xy: Any, ids: Any) -> None:
        """Inserts points of other tiles; points that it has already are ignored."""
        points = _points(xy)
        numbers = _ids(ids, len(points))
        status = self._library.dt_tile_insert(self._handle, points.ctypes.data, numbers.ctypes.data, len(points))
        _check_points(points, status, _REFUSED)

    def open(self, boxes: Any, me: int) -> Dict[int, NDArray[Any]]:
        """What other tiles need that was not returned before: for each of them, rows of own points. boxes: of all t tiles, of shape (t, 4), nan
        for an empty tile; me: the number of this one. Nothing is left to be sent when no tile returns anything."""
        corners = np.ascontiguousarray(boxes, dtype=np.float64)
        if corners.ndim != 2 or corners.shape[1] != 4:
            raise ValueError("boxes have the shape (t, 4), not %s" % (corners.shape,))
        tiles = len(corners)
        if not 0 <= me < tiles:
            raise ValueError("there is no tile %d of %d" % (me, tiles))
        offsets, found = np.zeros(tiles + 1, dtype=np.int64), _library.Ids()
        status = self._library.dt_tile_open(
            self._handle, corners.ctypes.data, tiles, me, offsets.ctypes.data, byref(found)
        )
        try:
            if status == _library.RANGE:
                raise ValueError("a box is not x0 <= x1, y0 <= y1 of points, nor nan")
            check(status, "%d tiles" % tiles)
            rows = np.empty(found.n, dtype=np.uint32)
            if found.n > 0:
                ctypes.memmove(rows.ctypes.data, found.v, rows.nbytes)
        finally:
            self._library.dt_arrays_release(found.v)
        return {int(k): rows[offsets[k] : offsets[k + 1]] for k in np.flatnonzero(np.diff(offsets))}

    def triangles(self, dtype: Any) -> NDArray[Any]:
        """The triangles that this tile outputs, of shape (m, 3): global ids, counterclockwise from the smallest one, rows
        ascending. dtype: uint32 or uint64."""
        kind = np.dtype(dtype)
        if kind not in (np.dtype(np.uint32), np.dtype(np.uint64)):
            raise ValueError("triangles are uint32 or uint64, not %s" % kind)
        out, rows = np.empty((self.counts.triangles, 3), dtype=kind), ctypes.c_size_t()
        status = self._library.dt_tile_triangles(self._handle, kind.itemsize == 8, out.ctypes.data, byref(rows))
        if status == _library.RANGE:
            raise ValueError("an id does not fit uint32")
        check(status, "triangles")
        return out[: rows.value]


__all__ = ["Counts", "Tile"]
