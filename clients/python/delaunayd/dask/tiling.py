"""Tiles: the leaves of a k-d tree. A cut is a coordinate: points below it go to one side, all others to the other side. Coincident points
share a tile, and boxes of the tiles' points are disjoint."""

from __future__ import annotations

from typing import TYPE_CHECKING, List, NamedTuple, Tuple, Union

import numpy as np

if TYPE_CHECKING:
    from .._types import Floats, NDArray, Numbers


class Cut(NamedTuple):
    """Points whose coordinate `axis` is below `at` are in `low`, all others in `high`; these are cuts or numbers of tiles."""

    axis: int
    at: float
    low: Union["Cut", int]
    high: Union["Cut", int]


class Tiling:
    """`root`: the first cut, or the number 0 of the only tile. `count`: how many tiles there are."""

    def __init__(self, root: Union[Cut, int]):
        self.root = root
        self.count = 1 + max(_leaves(root))

    def split(self, xy: Floats) -> List[Tuple[int, Numbers]]:
        """The tiles that have some of these points: each tile's number and the rows of its points, ascending. O(n log tiles)."""
        found: List[Tuple[int, Numbers]] = []
        self._descend(self.root, xy, np.arange(len(xy)), found)
        return found

    def _descend(self, node: Union[Cut, int], xy: Floats, rows: Numbers, found: List[Tuple[int, Numbers]]) -> None:
        if len(rows) == 0:
            return
        if not isinstance(node, Cut):
            found.append((node, rows))
            return
        low = xy[rows, node.axis] < node.at
        self._descend(node.low, xy, rows[low], found)
        self._descend(node.high, xy, rows[~low], found)


def _leaves(node: Union[Cut, int]) -> List[int]:
    return _leaves(node.low) + _leaves(node.high) if isinstance(node, Cut) else [node]


def tiling_of(sample: Floats, tiles: int) -> Tiling:
    """At most `tiles` tiles that have about as many of the points each, if the sample, of shape (k, 2), is like the points. There are fewer
    tiles than that if the sample has fewer places."""
    names = iter(range(tiles))

    def divide(rows: Floats, parts: int) -> Union[Cut, int]:
        cut = _cut(rows, (parts // 2) / parts) if parts > 1 else None
        if cut is None:
            return next(names)
        low = rows[:, cut[0]] < cut[1]
        return Cut(cut[0], cut[1], divide(rows[low], parts // 2), divide(rows[~low], parts - parts // 2))

    return Tiling(divide(sample, tiles))


def _cut(rows: Floats, share: float) -> Union[Tuple[int, float], None]:
    """The cut across the longer side that leaves about this share below it; across the other side if all points share one coordinate."""
    if len(rows) < 2:
        return None
    sides = rows.max(axis=0) - rows.min(axis=0)
    for axis in np.argsort(-sides, kind="stable"):
        column: NDArray[np.float64] = np.sort(rows[:, axis])
        at = column[int(share * len(column))]
        if at == column[0]:
            above = column[column > at]
            if len(above) == 0:
                continue
            at = above[0]
        return int(axis), float(at)
    return None
