"""Rasters: each tile computes the cells that belong to it.

A cell belongs to a tile if its centre is in a triangle of all points that has an own corner; so every cell in the hull belongs to one tile at least.
The band of a tile (band.py) has every triangle that the tile has without such a corner, so it finds out which cells belong to others."""

from __future__ import annotations

import operator
from typing import TYPE_CHECKING, Any, NamedTuple, Sequence, Tuple

import numpy as np

from .._library import LINEAR
from . import band, spill
from .surfaces import Surface
from .tasks import Job, band_of

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

    def places(self, cells: Numbers) -> Floats:
        """The centres of cells, which are counted row by row."""
        x, y = self.centres()
        return np.column_stack([x[cells % self.columns], y[cells // self.columns]])


def grid_of(bounds: Any, shape: Any) -> Grid:
    """Of a box, two opposite corners (x0, y0, x1, y1), and (rows, columns). ValueError: it has no cells."""
    (x0, y0, x1, y1), (rows, columns) = map(float, bounds), map(operator.index, shape)
    if not np.isfinite([x0, y0, x1, y1]).all() or rows < 1 or columns < 1:
        raise ValueError("a raster needs a box of finite numbers, and at least one row and one column")
    return Grid((min(x0, x1), min(y0, y1), max(x0, x1), max(y0, y1)), rows, columns)


def linear(job: Job, tile: Tile, grid: Grid, fields: Sequence[int], name: str) -> None:
    """Writes the cells that belong to the tile, and their values."""
    cells = cells_of(job, tile, grid)
    values = np.empty((len(cells), len(fields)))
    if len(cells) > 0:
        surface, places = Surface(job, tile, fields, rows=False), grid.places(cells)
        for k in range(len(fields)):
            values[:, k] = surface.values(k, LINEAR, places)
    there = ~np.isnan(values).all(axis=1)  # the others may have values in other tiles
    write_part(spill.path_of(job.folder, name, tile.number), cells[there], values[there])


def write_part(path: str, cells: Numbers, values: Floats) -> None:
    """Writes cells and their values, of shape (cells, fields)."""
    spill.write(path, [cells, np.ascontiguousarray(values)])


def read_part(path: str, fields: int) -> Tuple[Numbers, Floats]:
    """What write_part has written."""
    rows = np.fromfile(path)
    n = len(rows) // (1 + fields)
    return rows[:n].view(np.int64), rows[n:].reshape(n, fields)


def cells_of(job: Job, tile: Tile, grid: Grid) -> Numbers:
    """The cells that belong to the tile, and others that are outside the hull of all points that the tile has. Those in the box of the tile
    belong to it, but for some in triangles of other tiles."""
    x, y = grid.centres()
    points, now = band_of(job.folder, tile.number, tile.last)
    if len(now.triangles) == 0 and len(points) > 0:
        return _on_edges(points, now, grid, x, y)
    columns, rows = _in_box(job.boxes[tile.number], x, y)
    corners = band.xy_of(points)[now.triangles]
    cells = _cells(grid, columns, rows)
    inside = _crossed(corners[now.others()], x[columns], y[rows])
    inside = inside[now.has_others(grid.places(cells[inside]))]
    beside = _crossed(corners[now.mine()], x, y)
    beside = beside[~(_within(beside % grid.columns, columns) & _within(beside // grid.columns, rows))]
    found: Numbers = np.concatenate([np.delete(cells, inside), beside[~now.has_others(grid.places(beside))]])
    return found


def _in_box(box: Any, x: Floats, y: Floats) -> Tuple[slice, slice]:
    """The columns and the rows whose centres are in a box."""
    columns = np.flatnonzero((x >= box[0]) & (x <= box[2]))
    rows = np.flatnonzero((y >= box[1]) & (y <= box[3]))
    return _range(columns), _range(rows)


def _range(ascending: Numbers) -> slice:
    return slice(int(ascending[0]), int(ascending[-1]) + 1) if len(ascending) > 0 else slice(0, 0)


def _within(numbers: Numbers, of: slice) -> NDArray[np.bool_]:
    within: NDArray[np.bool_] = (numbers >= of.start) & (numbers < of.stop)
    return within


def _cells(grid: Grid, columns: slice, rows: slice) -> Numbers:
    """The cells of these columns and rows, row by row."""
    found: Numbers = np.arange(rows.start, rows.stop)[:, None] * grid.columns + np.arange(columns.start, columns.stop)
    return found.ravel()


def _on_edges(points: NDArray[Any], now: band.Band, grid: Grid, x: Floats, y: Floats) -> Numbers:
    """All points are on one line: the cells that may be on an edge with an own end."""
    line = points["x"] + 1j * points["y"]  # in the order of the line, since complex numbers are sorted by x, then y
    order = np.argsort(line, kind="stable")
    own = np.flatnonzero(now.own[order])
    near = line[order[max(own[0] - 1, 0) : own[-1] + 2]]
    cells = _cells(grid, *_in_box((near.real.min(), near.imag.min(), near.real.max(), near.imag.max()), x, y))
    places = grid.places(cells)
    at = places[:, 0] + 1j * places[:, 1]
    before = np.maximum(np.searchsorted(line[order], at, "right") - 1, 0)
    after = np.minimum(np.searchsorted(line[order], at, "left"), len(line) - 1)
    kept: Numbers = cells[now.own[order[before]] | now.own[order[after]]]
    return kept


def _crossed(corners: Floats, x: Floats, y: Floats) -> Numbers:
    """The cells of a grid of these columns and rows on rows through triangles, of shape (n, 3, 2), from a column before the triangle to one
    behind it; ascending."""
    first = np.searchsorted(-y, -corners[:, :, 1].max(axis=1), "left")
    after = np.searchsorted(-y, -corners[:, :, 1].min(axis=1), "right")
    triangle, row = spread(first, after)
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
    which, column = spread(before, behind)
    cells: Numbers = np.unique(row[which] * len(x) + column)
    return cells


def spread(first: NDArray[Any], after: NDArray[Any]) -> Tuple[Numbers, Numbers]:
    """The numbers first[k] to after[k] - 1 of all k, one after the other, and the k of each."""
    counts = np.maximum(after - first, 0)
    which = np.repeat(np.arange(len(counts)), counts)
    within = np.arange(len(which)) - np.repeat(np.cumsum(counts) - counts, counts)
    return which, first[which] + within
