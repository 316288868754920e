"""The surface of a tile: its own and foreign points with their triangulation. All triangles with an own corner are triangles of all points.

A place in such a triangle belongs to the tile; on an edge it may belong to several tiles. Every place in the hull belongs to the tile of each
corner of its triangle, and so to one at least."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Sequence, Tuple

import numpy as np

from .._library import LINEAR
from .._triangulation import Triangulation
from . import band, spill
from .tasks import Job, band_of, own_points

if TYPE_CHECKING:
    from .._types import Floats, NDArray, Numbers
    from .rounds import Tile


class Surface:
    """`own`: whether each point is the tile's own. `z`: the values of some fields. Without `rows` there are no triangles and no
    locate(). Needs 200 bytes a point."""

    def __init__(self, job: Job, tile: Tile, fields: Sequence[int] = (), rows: bool = True):
        xy, ids, z = own_points(job, tile.number, tile.chunks, fields)
        foreign = spill.read_arrays(spill.path_of(job.folder, "state", tile.number, tile.last))["foreign"]
        foreign = foreign[np.argsort(foreign["id"], kind="stable")]
        at = np.searchsorted(ids, foreign["id"])
        self.ids, self.own = np.insert(ids, at, foreign["id"]), np.insert(np.ones(len(ids), dtype=bool), at, False)
        self.xy = np.insert(xy, at, band.xy_of(foreign), axis=0)
        self.z = [np.insert(column, at, foreign["z"][:, field]) for column, field in zip(z, fields)]
        self._triangulation = Triangulation(self.xy, 1, rows=rows)
        self.triangles = self._triangulation.simplices

    def locate(self, places: Floats) -> Numbers:
        """The triangle of each place, -1 if the place does not belong to the tile."""
        rows: Numbers = self._triangulation.locate(places, 0.0, 1).astype(np.int64)
        if len(self.triangles) > 0:
            rows[~self.own[self.triangles[rows]].any(axis=1)] = -1
        return rows

    def values(self, k: int, method: int, places: Floats) -> Floats:
        """The values of field k at places, nan outside the hull of these points."""
        return self._triangulation.values(self.z[k], method, np.inf, places, np.nan, 1, 0.0)

    def has(self, places: Floats) -> NDArray[np.bool_]:
        """Which places are in the hull of these points."""
        zeros = self._triangulation.values(np.zeros(len(self.xy)), LINEAR, np.inf, places, np.nan, 1, 0.0)
        return ~np.isnan(zeros)

    def nearest(self, places: Floats) -> Tuple[Floats, Numbers]:
        """The distances and the rows of the nearest points."""
        distance, rows = self._triangulation.nearest(places, 1, 1)
        return distance[:, 0], rows[:, 0]

    def output(self) -> NDArray[Any]:
        """The triangles that this tile outputs."""
        kept: NDArray[Any] = self.triangles[self.own[self.triangles[:, 0]]]
        return kept


def locate(job: Job, tile: Tile, places: Floats) -> Tuple[Numbers, NDArray[Any]]:
    """Which places belong to the tile, and the corners of their triangles."""
    chosen = _candidates(job, tile, places)
    if len(chosen) == 0:
        return chosen, np.empty((0, 3), dtype=job.dtype)
    surface = Surface(job, tile)
    rows = surface.locate(places[chosen])
    return chosen[rows >= 0], surface.ids[surface.triangles[rows[rows >= 0]]]


def _candidates(job: Job, tile: Tile, places: Floats) -> Numbers:
    """The places that may belong to the tile: those in its box, and those in triangles of its band."""
    points, now = band_of(job.folder, tile.number, tile.last)
    x0, y0, x1, y1 = job.boxes[tile.number]
    x, y = places[:, 0], places[:, 1]
    inside = (x >= x0) & (x <= x1) & (y >= y0) & (y <= y1)
    others = np.flatnonzero(~inside)
    near = others[now.has(places[others])]
    found: Numbers = np.sort(np.concatenate([np.flatnonzero(inside), near]))
    return found


def hull(job: Job, tile: Tile) -> NDArray[Any]:
    """The hull of the own points: their places and numbers."""
    xy, ids, _ = own_points(job, tile.number, tile.chunks, ())
    rows = Triangulation(xy, 1, rows=False).hull()
    found = np.empty(len(rows), dtype=band.points_type(0))
    found["id"], found["x"], found["y"] = ids[rows], xy[rows, 0], xy[rows, 1]
    return found
