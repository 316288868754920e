"""Rasters of the value of the nearest point.

The tile of a cell has points around it, but the nearest of all points may be one of another tile. d is the distance of the nearest that the
tile has. Only tiles whose boxes are at most d away from the centre can have a nearer point, or one as near with a smaller number. They are asked.

    nearest     a tile -> the cells that belong to it, their values, and which other tiles it asks about which cells
    answer      a tile, what it is asked -> its nearest own point of each of these cells
    decided     all of these points -> the nearest

The last step is exact: it triangulates the points that were found, and the nearest of them is the nearest of all."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Dict, List, Sequence, Tuple

import numpy as np

from .._triangulation import Triangulation
from . import band, spill
from .rasters import Grid, cells_of, spread, write_part
from .surfaces import Surface
from .tasks import Job, own_points

if TYPE_CHECKING:
    from .._types import Floats, NDArray, Numbers
    from .rounds import Tile

_REACH = 1 + 2.0**-40  # distances are rounded
_SIDE = 256  # cells of the grid that leaves out points far from every question


def nearest(job: Job, tile: Tile, grid: Grid, fields: Sequence[int], name: str) -> List[int]:
    """Writes the cells that belong to the tile, and the values of the nearest point that it has; and for each other tile that it must ask, the
    cells and the distances. Returns these tiles."""
    cells = cells_of(job, tile, grid)
    values = np.empty((0, len(fields)))
    found = np.empty(0, dtype=band.points_type(len(fields)))
    to: Dict[int, Numbers] = {}
    distance = np.empty(0)
    if len(cells) > 0:
        surface = Surface(job, tile, fields, rows=False)
        cells = cells[surface.has(grid.places(cells))]
        places = _tame(grid.places(cells))
        distance, rows = surface.nearest(places)
        values = np.column_stack([z[rows] for z in surface.z])
        to = _asked(job.boxes, tile.number, places, distance * _REACH)
        asking = np.unique(np.concatenate([np.empty(0, dtype=np.int64), *to.values()]))
        found = _points(surface, rows[asking])
        spill.write_arrays(spill.path_of(job.folder, name + "-own", tile.number), cells=cells[asking], points=found)
    write_part(spill.path_of(job.folder, name, tile.number), cells, values)
    for other, which in to.items():
        path = spill.path_of(job.folder, name + "-ask", tile.number, other)
        spill.write_arrays(path, cells=cells[which], reach=distance[which] * _REACH)
    return list(to)


def _tame(places: Floats) -> Floats:
    """Coordinates below 2^-142 count as 0."""
    tame: Floats = np.where(np.abs(places) < 2.0**-142, 0.0, places)
    return tame


def _points(surface: Surface, rows: Numbers) -> NDArray[Any]:
    points = np.empty(len(rows), dtype=band.points_type(len(surface.z)))
    points["id"], points["x"], points["y"] = surface.ids[rows], surface.xy[rows, 0], surface.xy[rows, 1]
    points["z"] = np.column_stack([z[rows] for z in surface.z])
    return points


def _asked(boxes: Floats, me: int, places: Floats, reach: Floats) -> Dict[int, Numbers]:
    """The other tiles whose boxes are within reach of places, and the rows of these places."""
    own = _from_box(places, boxes[me])
    inner = np.minimum(places - boxes[me][:2], boxes[me][2:] - places).min(axis=1)
    rows = np.flatnonzero((own > 0) | (inner < reach))  # of the others the disc is inside the own box
    if len(rows) == 0:
        return {}
    low, high = (places[rows] - reach[rows, None]).min(axis=0), (places[rows] + reach[rows, None]).max(axis=0)
    with np.errstate(invalid="ignore"):
        near = (boxes[:, :2] <= high).all(axis=1) & (boxes[:, 2:] >= low).all(axis=1)
    found = {}
    for other in np.flatnonzero(near).tolist():
        within = rows[_from_box(places[rows], boxes[other]) <= reach[rows]]
        if other != me and len(within) > 0:
            found[other] = within
    return found


def _from_box(places: Floats, box: Any) -> Floats:
    """At most the distances of places from a box, but for rounding."""
    beside = np.maximum(np.maximum(box[:2] - places, places - box[2:]), 0)
    distance: Floats = np.hypot(beside[:, 0], beside[:, 1])
    return distance


def answer(job: Job, tile: Tile, grid: Grid, fields: Sequence[int], name: str, askers: Sequence[int]) -> None:
    """Writes the tile's nearest own point of each cell about which it is asked, unless it is certainly farther than what the asker has."""
    asked = [spill.read_arrays(spill.path_of(job.folder, name + "-ask", asker, tile.number)) for asker in askers]
    cells, reach = (np.concatenate([one[key] for one in asked]) for key in ("cells", "reach"))
    xy, ids, z = own_points(job, tile.number, tile.chunks, fields)
    places = _tame(grid.places(cells))
    kept = np.flatnonzero(_near(xy, places, reach))
    points = np.empty(len(kept), dtype=band.points_type(len(fields)))
    points["id"], points["x"], points["y"], points["z"] = ids[kept], xy[kept, 0], xy[kept, 1], z[:, kept].T
    if len(kept) > 0:
        distance, rows = Triangulation(np.ascontiguousarray(xy[kept]), 1, rows=False).nearest(places, 1, 1)
        nearer = distance[:, 0] <= reach * _REACH
        cells, points = cells[nearer], points[rows[nearer, 0]]
    else:
        cells = cells[:0]
    spill.write_arrays(spill.path_of(job.folder, name + "-answer", tile.number), cells=cells, points=points)


def _near(xy: Floats, places: Floats, reach: Floats) -> NDArray[np.bool_]:
    """Whether each point is in a cell of a grid, around all points, that the disc of some place may meet."""
    low, high = xy.min(axis=0), xy.max(axis=0)
    with np.errstate(all="ignore"):
        scale = np.where(high > low, (_SIDE - 1) / (high - low), 0)
    scale = np.where(np.isfinite(scale), scale, 0)

    def cell(at: Floats) -> Numbers:
        with np.errstate(over="ignore"):
            rows: Numbers = np.clip((at - low) * scale, 0, _SIDE - 1).astype(np.int64)
        return rows

    least, most = cell(places - reach[:, None]), cell(places + reach[:, None])
    which, row = spread(least[:, 1], most[:, 1] + 1)
    marks = np.zeros((_SIDE, _SIDE + 1), dtype=np.int64)  # +1 where a range of cells begins, -1 behind its end
    np.add.at(marks, (row, least[which, 0]), 1)
    np.add.at(marks, (row, most[which, 0] + 1), -1)
    at = cell(xy)
    near: NDArray[np.bool_] = np.cumsum(marks, axis=1)[at[:, 1], at[:, 0]] > 0
    return near


def decided(folder: str, grid: Grid, fields: Sequence[int], name: str) -> Tuple[Numbers, Floats]:
    """The cells about which tiles have asked, and their values."""
    paths = [path for kind in ("-own", "-answer") for path in spill.numbered(folder, name + kind)]
    found = [spill.read_arrays(path) for path in paths]
    points = np.concatenate([np.empty(0, dtype=band.points_type(len(fields))), *(part["points"] for part in found)])
    cells: Numbers = np.unique(np.concatenate([np.empty(0, dtype=np.int64), *(part["cells"] for part in found)]))
    if len(cells) == 0:
        return cells, points["z"]
    _, first = np.unique(points["id"], return_index=True)
    points = points[first]
    _, rows = Triangulation(band.xy_of(points), 1, rows=False).nearest(_tame(grid.places(cells)), 1, 1)
    return cells, points["z"][rows[:, 0]]
