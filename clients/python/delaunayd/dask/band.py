"""What is left of a tile when its interior is done, and how the rest of its triangles are found.

Words. A tile's own points are those in its leaf; the points that other tiles send are foreign. P are the own points of a tile, F the foreign
ones that it has, DT() the canonical triangulation. It equals that of points moved by infinitely little, so no circle has a fourth point.

Opening. A triangle of DT(P + F) with an own corner is opened towards each other tile whose box its circle may meet: its corners are sent there.
A hull edge is a circle of infinite radius, its outer half plane; so are both sides of each edge if all points are on a line, and a single
point is opened towards all tiles. What is opened towards no tile is final. The rounds end when no tile has anything new to send.

Theorem [after Caraffa, Bredif & Vallet, Tile & Merge, 2019]. At the end each triangle of DT(P + F) with an own corner is one of all points.
1. Assume that a triangle, or a hull edge's half plane, with the own corner a has a point of all points in its circle.
2. Circles through a inside of it, which touch it at a, include one that has exactly one other point v on it and none inside. The point v belongs to
   another tile B, because it is not in P + F. The edge a v is in DT of every set of points that contains a and v.
3. The circle meets the box of B, so a was sent to B. So the edge a v is in the triangulation of B, where v is own.
4. A triangle or half plane of B at that edge has the own corner v, and its circle meets the box of the tile of a, at a. So v was sent there.
   This contradicts 2.

The band. Let S be the corners of what P alone opens. A triangle of DT(P) is done if not all of its corners are in S; then it is final, so no later
point is in its circle, and it is written at once.
5. A triangle T of DT(P + F) that is not done has its corners in S + F: if T is in DT(P), by the definition; otherwise it was made when points of F
   removed triangles that were not final, and its corners are theirs or in F.
6. The circle of T has no point of P + F inside, so T is in DT(S + F). So are the edges between done triangles and others: the walls.
7. Walls enclose the region of the done triangles. DT(S + F) has other triangles there, which mean nothing. They are those that
   can be reached from the inner sides of walls without a way through a wall.
So S, F and the walls replace the tile: they are about as many as the square root of its points.

All points of P on a line: S is P, and there are no walls. Such a tile opens at first only its two ends, towards all tiles: if the points of all tiles
are on one line, this is enough, as there are no triangles. Otherwise it is opened in full when nothing is new.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Dict, Iterable, List, NamedTuple, Tuple

import numpy as np

from .._triangulation import Triangulation
from . import circles

if TYPE_CHECKING:
    from .._types import Floats, Ints, NDArray, Numbers


def points_type(values: bool) -> Any:
    """A point that travels: its number, its place, and its value."""
    fields: List[Tuple[str, str]] = [("id", "<u8"), ("x", "<f8"), ("y", "<f8")]
    return np.dtype([*fields, ("z", "<f8")] if values else fields)


def xy_of(points: NDArray[Any]) -> Floats:
    return np.column_stack([points["x"], points["y"]])


class Opened(NamedTuple):
    """What to send: rows of points for each tile, each ascending; and whether the tile opened only the ends of a line."""

    to: Dict[int, Numbers]
    deferred: bool


def _collect(pairs: Iterable[Tuple[int, Any]]) -> Dict[int, Numbers]:
    found: Dict[int, List[Any]] = {}
    for tile, rows in pairs:
        found.setdefault(tile, []).append(np.ravel(rows))
    return {tile: np.unique(np.concatenate(rows)) for tile, rows in sorted(found.items())}


def _open_line(xy: Floats, hull: Ints, boxes: Floats, me: int, full: bool) -> Opened:
    """Of points on a line, or of one point."""
    rows = hull.astype(np.int64) if full else hull[[0, -1]].astype(np.int64)
    others = [tile for tile, box in enumerate(boxes) if tile != me and not np.isnan(box[0])]
    return Opened(_collect((tile, rows) for tile in others), not full)


def open_tile(xy: Floats, triangulation: Triangulation, boxes: Floats, me: int) -> Opened:
    """Of the own points alone."""
    hull = triangulation.hull()
    triangles = triangulation.simplices
    if len(triangles) == 0:
        return _open_line(xy, hull, boxes, me, False)
    pairs = [(tile, triangles[rows]) for tile, rows in circles.triangles_meeting(xy, triangles, boxes, me)]
    edges = np.column_stack([hull, np.roll(hull, -1)])
    pairs += [(tile, edges[rows]) for tile, rows in circles.edges_meeting(xy[edges[:, 0]], xy[edges[:, 1]], boxes, me)]
    return Opened(_collect(pairs), False)


def divide(triangles: Ints, sent: Numbers, n: int) -> Tuple[NDArray[np.bool_], Numbers]:
    """Which triangles of n points are done, and the walls, as pairs of points with the done triangle on their left. `sent`: S."""
    in_band = np.zeros(n, dtype=bool)
    in_band[sent] = True
    inside = in_band[triangles]
    done: NDArray[np.bool_] = ~inside.all(axis=1)
    beside = np.flatnonzero(done & (inside.sum(axis=1) == 2))
    kept, corners = inside[beside], triangles[beside].astype(np.int64)
    edges = np.concatenate([
        corners[kept[:, i] & kept[:, (i + 1) % 3]][:, [i, (i + 1) % 3]] for i in range(3)
    ])
    twins = np.isin(edges[:, 0] * n + edges[:, 1], edges[:, 1] * n + edges[:, 0])
    return done, edges[~twins]


class Band:
    """The triangulation of S + F, ascending by number. `walls`: pairs of numbers. `own`: whether each point is one of S."""

    def __init__(self, points: NDArray[Any], own: NDArray[np.bool_], walls: NDArray[Any]):
        self.points, self.own = points, own
        self.xy = xy_of(points)
        self._triangulation = Triangulation(self.xy, 1)
        self.triangles = self._triangulation.simplices
        self._walls = np.searchsorted(points["id"], walls).astype(np.int64)
        self._hole = self._flooded()

    def _flooded(self) -> NDArray[np.bool_]:
        """Which triangles are in the region of the done ones."""
        n = len(self.points)
        walls = np.sort(self._walls[:, 0] * n + self._walls[:, 1])
        hole = np.zeros(len(self.triangles), dtype=bool)
        if len(walls) == 0:
            return hole
        corners = self.triangles.astype(np.int64)
        edges = corners * n + np.roll(corners, -1, axis=1)  # edge k begins at corner k
        inner = np.isin(edges, walls)
        walled = inner | np.isin(np.roll(corners, -1, axis=1) * n + corners, walls)
        beyond = np.where(walled, -1, np.roll(self._triangulation.neighbors(), 1, axis=1))  # neighbour k is opposite corner k
        front = np.flatnonzero(inner.any(axis=1))
        while len(front) > 0:
            hole[front] = True
            front = np.unique(beyond[front])
            front = front[front >= 0]
            front = front[~hole[front]]
        return hole

    def open(self, boxes: Floats, me: int, full: bool) -> Opened:
        """`full`: a line, too, opens all of its edges."""
        hull = self._triangulation.hull()
        if len(self.triangles) == 0:
            return _open_line(self.xy, hull, boxes, me, full)
        triangles = self.triangles[self.own[self.triangles].any(axis=1) & ~self._hole]
        pairs = [(tile, triangles[rows]) for tile, rows in circles.triangles_meeting(self.xy, triangles, boxes, me)]
        edges = self._hull_edges(hull)
        a, b = self.xy[edges[:, 0]], self.xy[edges[:, 1]]
        pairs += [(tile, edges[rows]) for tile, rows in circles.edges_meeting(a, b, boxes, me)]
        return Opened(_collect(pairs), False)

    def _hull_edges(self, hull: Ints) -> Ints:
        """Those with an own corner, except where the hull is that of done triangles."""
        n = len(self.points)
        edges = np.column_stack([hull, np.roll(hull, -1)])
        corners = self.triangles[self._hole].astype(np.int64)
        of_hole = np.isin(edges[:, 0].astype(np.int64) * n + edges[:, 1], corners * n + np.roll(corners, -1, axis=1))
        wall = np.isin(edges[:, 0].astype(np.int64) * n + edges[:, 1], self._walls[:, 0] * n + self._walls[:, 1])
        kept: Ints = edges[self.own[edges].any(axis=1) & (~of_hole | wall)]
        return kept

    def rest(self) -> Ints:
        """The triangles that this tile still has to output: those whose smallest number is an own one and that are not done."""
        kept: Ints = self.triangles[self.own[self.triangles[:, 0]] & ~self._hole]
        return kept
