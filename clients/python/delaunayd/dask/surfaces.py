"""The surface of a tile: its own and foreign points with their triangulation. All triangles with an own corner are triangles of all points.

A place in such a triangle belongs to the tile; on an edge it may belong to several tiles. Every place in the hull belongs to the tile of each
corner of its triangle, and so to one at least."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any, NamedTuple, Tuple

import numpy as np

from .._library import LINEAR
from .._triangulation import Triangulation
from . import band, spill
from .tasks import Job, band_of, own_points

if TYPE_CHECKING:
    from .._types import Floats, NDArray, Numbers
    from .rounds import Tile


class Grid(NamedTuple):
    """The cells of a raster: `box` is x0 <= x1, y0 <= y1. Row 0 is the northernmost one, column 0 the westernmost."""

    box: Tuple[float, float, float, float]
    rows: int
    columns: int

    def centres(self) -> Tuple[Floats, Floats]:
        """The x of each column and the y of each row, as RASTER of a daemon has them."""
        x0, y0, x1, y1 = self.box
        i, j = np.arange(self.columns), np.arange(self.rows)
        return x0 + (x1 - x0) * (2 * i + 1) / (2 * self.columns), y1 - (y1 - y0) * (2 * j + 1) / (2 * self.rows)


class Surface:
    """`own`: whether each point is the tile's own. Needs 200 bytes a point."""

    def __init__(self, job: Job, tile: Tile):
        xy, ids, z = own_points(job, tile.number, tile.chunks, job.values)
        foreign = spill.read_arrays(spill.path_of(job.folder, "state", tile.number, tile.last))["foreign"]
        ids = np.concatenate([ids, foreign["id"].astype(ids.dtype)])
        order = np.argsort(ids, kind="stable")
        self.ids, self.own = ids[order], order < len(xy)
        self.xy = np.concatenate([xy, band.xy_of(foreign)])[order]
        self.z = None if z is None else np.concatenate([z, foreign["z"]])[order]
        self._triangulation = Triangulation(self.xy, 1)
        self.triangles = self._triangulation.simplices

    def locate(self, places: Floats) -> Numbers:
        """The triangle of each place, -1 if the place does not belong to the tile."""
        rows: Numbers = self._triangulation.locate(places, 0.0, 1).astype(np.int64)
        if len(self.triangles) > 0:
            rows[~self.own[self.triangles[rows]].any(axis=1)] = -1
        return rows

    def values(self, places: Floats) -> Floats:
        """The linear values at places in triangles."""
        assert self.z is not None
        return self._triangulation.values(self.z, LINEAR, np.inf, places, np.nan, 1)

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


def raster(job: Job, tile: Tile, grid: Grid, name: str) -> None:
    """Writes the cells that belong to the tile, and their values."""
    x, y = grid.centres()
    cells = _cells(job, tile, grid, x, y)
    values = np.empty(0)
    if len(cells) > 0:
        surface = Surface(job, tile)
        places = np.column_stack([x[cells % grid.columns], y[cells // grid.columns]])
        found = surface.locate(places) >= 0
        cells, values = cells[found], surface.values(places[found])
    spill.write_arrays(os.path.join(job.folder, "%s-%d" % (name, tile.number)), cells=cells, values=values)


def _cells(job: Job, tile: Tile, grid: Grid, x: Floats, y: Floats) -> Numbers:
    """The cells whose centres may belong to the tile: those in its box, and those on rows through triangles of its band."""
    points, now = band_of(job.folder, tile.number, tile.last)
    x0, y0, x1, y1 = job.boxes[tile.number]
    columns = np.flatnonzero((x >= x0) & (x <= x1))
    rows = np.flatnonzero((y >= y0) & (y <= y1))
    found = [(rows[:, None] * grid.columns + columns).ravel()]
    corners = band.xy_of(points)[now.mine()]
    if len(corners) > 0:
        found.append(_crossed(corners, x, y))
    cells: Numbers = np.unique(np.concatenate(found))
    return cells


def _crossed(corners: Floats, x: Floats, y: Floats) -> Numbers:
    """The cells on rows through triangles, of shape (n, 3, 2), from a column before the triangle to one behind it."""
    first = np.searchsorted(-y, -corners[:, :, 1].max(axis=1), "left")
    after = np.searchsorted(-y, -corners[:, :, 1].min(axis=1), "right")
    triangle, row = _spread(first, after)
    low, high = np.full(len(row), np.inf), np.full(len(row), -np.inf)
    for k in range(3):
        a, b = corners[triangle, k], corners[triangle, (k + 1) % 3]
        with np.errstate(all="ignore"):
            at = np.clip((y[row] - a[:, 1]) / (b[:, 1] - a[:, 1]), 0, 1)
            place = a[:, 0] + at * (b[:, 0] - a[:, 0])
        level = a[:, 1] == b[:, 1]
        crossed = (np.minimum(a[:, 1], b[:, 1]) <= y[row]) & (y[row] <= np.maximum(a[:, 1], b[:, 1]))
        off = 2.0**-48 * (np.abs(a[:, 0]) + np.abs(b[:, 0]))  # at and place have errors of some 2^-52 of these
        for one in (np.where(level, a[:, 0], place), np.where(level, b[:, 0], place)):
            low = np.where(crossed, np.fmin(low, one - off), low)
            high = np.where(crossed, np.fmax(high, one + off), high)
    before = np.maximum(np.searchsorted(x, low, "left") - 1, 0)
    behind = np.minimum(np.searchsorted(x, high, "right") + 1, len(x))
    which, column = _spread(before, behind)
    cells: Numbers = np.unique(row[which] * len(x) + column)
    return cells


def _spread(first: NDArray[Any], after: NDArray[Any]) -> Tuple[Numbers, Numbers]:
    """The numbers first[k] to after[k] - 1 of all k, one after the other, and the k of each."""
    counts = np.maximum(after - first, 0)
    which = np.repeat(np.arange(len(counts)), counts)
    within = np.arange(len(which)) - np.repeat(np.cumsum(counts) - counts, counts)
    return which, first[which] + within


def hull(job: Job, tile: Tile) -> NDArray[Any]:
    """The hull of the own points: their places and numbers."""
    xy, ids, _ = own_points(job, tile.number, tile.chunks, False)
    rows = Triangulation(xy, 1).hull()
    found = np.empty(len(rows), dtype=band.points_type(False))
    found["id"], found["x"], found["y"] = ids[rows], xy[rows, 0], xy[rows, 1]
    return found
