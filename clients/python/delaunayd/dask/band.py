"""What is left of a tile when its interior is done, and how the rest of its triangles are found.

The terms and the rule are those of core/delaunay_tiles.h: faces, ghosts, boxes, and own and foreign points. P are the own points of a tile, F the
foreign ones that it has, DT() the canonical triangulation. A face of DT(P) is final if it meets no other tile's box: no later point is in its circle.

1. Tile.open(), called until no face is postponed, returns S: all corners of faces of DT(P) that are not final. Only what its first call
   returns is sent at once; the rest is judged again with F.
2. A triangle of DT(P) is done if not all of its corners are in S. Then it is final by step 1, and it is written at once.
3. A triangle T of DT(P + F) that is not done has its corners in S + F. If T is in DT(P), this is the definition. Otherwise T was made when points
   of F removed faces that were not final; its corners are theirs or in F.
4. The circle of T has no point of P + F inside, so T is in DT(S + F). So are the edges between done triangles and other faces: the walls.
5. Walls enclose the region of the done triangles. DT(S + F) has other triangles there, which mean nothing: those that can be reached from
   the inner sides of walls without a way through a wall. They can only make a tile send more than it must.

So S, F and the walls replace the tile. They are about as many as the square root of its points.

All points of P on a line: S is P, and there are no walls. Such a tile first sends only the two ends of the line, to all tiles. If the points of all
tiles are on one line, this is enough, because there are no triangles. Otherwise the tile follows the rule when nothing else is new."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, List, Tuple

import numpy as np

from .._triangulation import Triangulation

if TYPE_CHECKING:
    from .._types import Floats, NDArray, Numbers


def points_type(fields: int) -> Any:
    """A point that travels: its number, its place, and its values."""
    columns: List[Any] = [("id", "<u8"), ("x", "<f8"), ("y", "<f8")]
    return np.dtype([*columns, ("z", "<f8", (fields,))] if fields > 0 else columns)


def xy_of(points: NDArray[Any]) -> Floats:
    return np.column_stack([points["x"], points["y"]])


def ends(xy: Floats) -> Numbers:
    """The rows of the two ends of points on a line: the least and the greatest place by x, then y."""
    order = np.lexsort((xy[:, 1], xy[:, 0]))
    rows: Numbers = np.unique(order[[0, -1]])
    return rows


def divide(triangles: NDArray[Any], sent: Numbers, n: int) -> Tuple[NDArray[np.bool_], Numbers]:
    """Which triangles of n points are done, and the walls, as pairs of points with the done triangle on their left. `sent`: S."""
    in_band = np.zeros(n, dtype=bool)
    in_band[sent] = True
    a, b, c = (in_band[triangles[:, k]] for k in range(3))
    done: NDArray[np.bool_] = ~(a & b & c)
    pairs = ((a & b & ~c, [0, 1]), (b & c & ~a, [1, 2]), (c & a & ~b, [2, 0]))
    edges = np.concatenate([triangles[beside][:, corners] for beside, corners in pairs]).astype(np.int64)
    twins = np.isin(edges[:, 0] * n + edges[:, 1], edges[:, 1] * n + edges[:, 0])
    return done, edges[~twins]


class Band:
    """DT(S + F) of points in the order of their numbers. `own`: whether each point is one of S. `walls`: pairs of numbers."""

    def __init__(self, points: NDArray[Any], own: NDArray[np.bool_], walls: NDArray[Any]):
        self._triangulation = Triangulation(xy_of(points), 1)
        self.triangles = self._triangulation.simplices
        self.hole = self._flooded(len(points), np.searchsorted(points["id"], walls).astype(np.int64))
        self.own = own

    def _flooded(self, n: int, walls: Numbers) -> NDArray[np.bool_]:
        """Which triangles are in the region of the done ones."""
        hole = np.zeros(len(self.triangles), dtype=bool)
        if len(walls) == 0:
            return hole
        keys = np.sort(walls[:, 0] * n + walls[:, 1])
        corners = self.triangles.astype(np.int64)
        ends = np.roll(corners, -1, axis=1)  # side k goes from corner k to the next one
        inner = np.isin(corners * n + ends, keys)
        walled = inner | np.isin(ends * n + corners, keys)
        beyond = np.where(walled, -1, np.roll(self._triangulation.neighbors(), 1, axis=1))  # neighbour k is opposite corner k
        front = np.flatnonzero(inner.any(axis=1))
        while len(front) > 0:
            hole[front] = True
            front = np.unique(beyond[front])
            front = front[front >= 0]
            front = front[~hole[front]]
        return hole

    def mine(self) -> NDArray[np.bool_]:
        """Which triangles are triangles of all points, have an own corner, and are not done."""
        mine: NDArray[np.bool_] = self.own[self.triangles].any(axis=1) & ~self.hole
        return mine

    def others(self) -> NDArray[np.bool_]:
        """Which triangles have no own corner, and are not where the done ones are."""
        return ~self.mine() & ~self.hole

    def has(self, places: Floats) -> NDArray[np.bool_]:
        """Which places are in triangles of mine()."""
        return self._among(self.mine(), places)

    def has_others(self, places: Floats) -> NDArray[np.bool_]:
        """Which places are in triangles of others()."""
        return self._among(self.others(), places)

    def _among(self, chosen: NDArray[np.bool_], places: Floats) -> NDArray[np.bool_]:
        rows = self._triangulation.locate(np.ascontiguousarray(places), 0.0, 1)
        found: NDArray[np.bool_] = (rows >= 0) & np.append(chosen, False)[rows]
        return found

    def rest(self) -> NDArray[Any]:
        """The triangles that this tile still has to output: those whose smallest number is an own one and that are not done."""
        kept: NDArray[Any] = self.triangles[self.own[self.triangles[:, 0]] & ~self.hole]
        return kept
