"""Contour lines: each tile cuts its triangles, and the pieces are joined at the edges that they share.

A line crosses an edge at a place that is computed from the edge alone, the smaller number first, so tiles agree on every byte. It
crosses each edge at most once, so each piece has one successor: lines are chains or cycles."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, List, NamedTuple, Tuple

import numpy as np

from .._protocol import Contour
from .surfaces import Surface
from .tasks import Job

if TYPE_CHECKING:
    from .._types import Floats, NDArray, Numbers
    from .rounds import Tile


class Pieces(NamedTuple):
    """Parts of lines of one level in a triangle each, with the higher ground on the left: edges, of shape (n, 2, 2), as pairs of
    numbers, the smaller first; and the places there, of shape (n, 2, 2)."""

    edges: NDArray[Any]
    places: Floats


def pieces(job: Job, tile: Tile, levels: Tuple[float, ...]) -> List[Pieces]:
    """Those of the triangles that the tile outputs, for each level."""
    surface = Surface(job, tile)
    triangles = surface.output()
    assert surface.z is not None
    z = surface.z[triangles]
    triangles, z = triangles[~np.isnan(z).any(axis=1)], z[~np.isnan(z).any(axis=1)]
    low, high = z.min(axis=1), z.max(axis=1)
    return [_of_level(surface, triangles[(low < level) & (high >= level)], level) for level in levels]


def _of_level(surface: Surface, triangles: NDArray[Any], level: float) -> Pieces:
    assert surface.z is not None
    above = surface.z[triangles] >= level
    one = above.sum(axis=1) == 1
    # The corner that is alone on its side comes first.
    alone = np.where(one, above.argmax(axis=1), (~above).argmax(axis=1))
    turned = np.take_along_axis(triangles, (alone[:, None] + np.arange(3)) % 3, axis=1)
    first, second = turned[:, [0, 1]], turned[:, [2, 0]]
    ends = np.stack([np.where(one[:, None], first, second), np.where(one[:, None], second, first)], axis=1)
    return Pieces(surface.ids[np.sort(ends, axis=2)].astype(np.uint64), _places(surface, ends, level))


def _places(surface: Surface, ends: NDArray[Any], level: float) -> Floats:
    """Where the level crosses edges: the operations of dt_level_place in core/contours/reading.c, so that the bytes are a daemon's."""
    assert surface.z is not None
    z = surface.z[ends]
    rising = (z[..., 0] < z[..., 1])[..., None]
    ends = np.where(rising, ends[..., ::-1], ends)  # the higher end first
    higher, lower = (surface.z[ends[..., k]] for k in range(2))
    with np.errstate(over="ignore"):
        fall = higher - lower
        share = np.where(np.isinf(fall), (higher / 2 - level / 2) / (higher / 2 - lower / 2), (higher - level) / fall)[..., None]
    a, b = surface.xy[ends[..., 0]], surface.xy[ends[..., 1]]
    places: Floats = np.clip(a + (b - a) * share, np.minimum(a, b), np.maximum(a, b))
    return places


def joined(level: float, parts: List[Pieces]) -> List[Contour]:
    """The lines of a level, in the order of the edges on which they begin."""
    edges = np.concatenate([np.empty((0, 2, 2), dtype=np.uint64), *(part.edges for part in parts)])
    places = np.concatenate([np.empty((0, 2, 2)), *(part.places for part in parts)]).reshape(-1, 2)
    order, node = _numbered(edges.reshape(-1, 2))
    n = len(order)
    place = places[order]
    after = np.full(n, -1, dtype=np.int64)
    after[node[0::2]] = node[1::2]
    begins = np.ones(n, dtype=bool)
    begins[node[1::2]] = False
    lines = _chains(after.tolist(), np.flatnonzero(begins).tolist())
    return [line for line in (_line(level, closed, place[rows]) for closed, rows in lines) if line is not None]


def _numbered(edges: NDArray[Any]) -> Tuple[Numbers, Numbers]:
    """Numbers of the different edges in ascending order: a row of each, and the number of each row."""
    order = np.lexsort((edges[:, 1], edges[:, 0]))
    ordered = edges[order]
    new = np.ones(len(edges), dtype=bool)
    new[1:] = (ordered[1:] != ordered[:-1]).any(axis=1)
    node = np.empty(len(edges), dtype=np.int64)
    node[order] = np.cumsum(new) - 1
    return order[new], node


def _chains(after: List[int], begins: List[int]) -> List[Tuple[bool, List[int]]]:
    """Whether each line is closed, and its nodes. Open lines start at `begins`, closed ones at their least node."""
    seen = bytearray(len(after))
    found: List[Tuple[bool, List[int]]] = []
    for closed, starts in ((False, begins), (True, range(len(after)))):
        for start in starts:
            rows, at = [], start
            while at >= 0 and not seen[at]:
                seen[at] = 1
                rows.append(at)
                at = after[at]
            if rows:
                found.append((closed, rows))
    return sorted(found, key=lambda line: line[1][0])


def _line(level: float, closed: bool, places: Floats) -> Any:
    """The line without places that equal the ones before; None if too few are left."""
    kept = np.ones(len(places), dtype=bool)
    kept[1:] = (places[1:] != places[:-1]).any(axis=1)
    places = places[kept]
    if closed and len(places) > 1 and (places[0] == places[-1]).all():
        places = places[:-1]
    return Contour(level, closed, places) if len(places) >= (3 if closed else 2) else None
