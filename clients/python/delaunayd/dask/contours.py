"""Contour lines: each tile cuts its triangles, and the pieces are joined at the edges that they share.

A line crosses an edge at a place that is computed from the edge alone, the smaller number first, so tiles agree on every byte. It
crosses each edge at most once, so each piece has one successor: lines are chains or cycles."""

from __future__ import annotations

import bisect
import os
from typing import TYPE_CHECKING, Any, List, NamedTuple, Sequence, Tuple, overload

import numpy as np

from .._protocol import Contour
from . import spill
from .imported import array
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


def pieces(job: Job, tile: Tile, field: int, levels: Tuple[float, ...], name: str) -> None:
    """Writes those of the triangles that the tile outputs, for each level that has some."""
    surface = Surface(job, tile, (field,))
    triangles = surface.output()
    z = surface.z[0][triangles]
    triangles, z = triangles[~np.isnan(z).any(axis=1)], z[~np.isnan(z).any(axis=1)]
    low, high = z.min(axis=1), z.max(axis=1)
    for k, level in enumerate(levels):
        found = _of_level(surface, triangles[(low < level) & (high >= level)], level)
        if len(found.edges) > 0:
            spill.write_arrays(_piece(job.folder, name, k, tile.number), edges=found.edges, places=found.places)


def _piece(folder: str, name: str, level: int, tile: int) -> str:
    return spill.path_of(folder, name + "-piece", level, tile)


def _of_level(surface: Surface, triangles: NDArray[Any], level: float) -> Pieces:
    above = surface.z[0][triangles] >= level
    one = above.sum(axis=1) == 1
    # The corner that is alone on its side comes first.
    alone = np.where(one, above.argmax(axis=1), (~above).argmax(axis=1))
    turned = np.take_along_axis(triangles, (alone[:, None] + np.arange(3)) % 3, axis=1)
    first, second = turned[:, [0, 1]], turned[:, [2, 0]]
    ends = np.stack([np.where(one[:, None], first, second), np.where(one[:, None], second, first)], axis=1)
    return Pieces(surface.ids[np.sort(ends, axis=2)].astype(np.uint64), _places(surface, ends, level))


def _places(surface: Surface, ends: NDArray[Any], level: float) -> Floats:
    """Where the level crosses edges: the operations of dt_level_place in core/contours/reading.c, so that the bytes are a daemon's."""
    z = surface.z[0][ends]
    rising = (z[..., 0] < z[..., 1])[..., None]
    ends = np.where(rising, ends[..., ::-1], ends)  # the higher end first
    higher, lower = (surface.z[0][ends[..., k]] for k in range(2))
    with np.errstate(over="ignore"):
        fall = higher - lower
        share = np.where(np.isinf(fall), (higher / 2 - level / 2) / (higher / 2 - lower / 2), (higher - level) / fall)[..., None]
    a, b = surface.xy[ends[..., 0]], surface.xy[ends[..., 1]]
    places: Floats = np.clip(a + (b - a) * share, np.minimum(a, b), np.maximum(a, b))
    return places


def join(folder: str, tiles: Tuple[int, ...], level: float, name: str, k: int) -> None:
    """Writes the lines of a level, in the order of the edges on which they begin: their places, where those of each line end, and whether
    each is closed."""
    paths = [_piece(folder, name, k, tile) for tile in tiles]
    found = [Pieces(**spill.read_arrays(path)) for path in paths if os.path.exists(path)]
    lines = _joined(found)
    places = [np.empty((0, 2)), *(line for _, line in lines)]
    spill.write_array(spill.path_of(folder, name + "-places", k), np.concatenate(places))
    spill.write_array(spill.path_of(folder, name + "-ends", k), np.cumsum([len(line) for _, line in lines], dtype=np.int64))
    spill.write_array(spill.path_of(folder, name + "-closed", k), np.array([closed for closed, _ in lines], dtype=bool))


class Contours(Sequence[Contour]):
    """Contour lines on disk, each read when it is asked for. The same as arrays of dask, a chunk for each level that has lines: `places`, of shape (k, 2), those of
    one line after the other; and for each line its `levels`, whether it is `closed`, and where its places end, `ends`."""

    def __init__(self, folder: str, name: str, levels: Tuple[float, ...]):
        self._levels = levels
        self._paths = {
            kind: [spill.path_of(folder, "%s-%s" % (name, kind), k) for k in range(len(levels))] for kind in ("places", "ends", "closed")
        }
        # These maps stay readable when the files are removed.
        self._ends, self._closed, self._places = (
            [np.load(path, mmap_mode="r") for path in self._paths[kind]] for kind in ("ends", "closed", "places")
        )
        self._after = np.cumsum([0, *map(len, self._ends)]).tolist()

    def __len__(self) -> int:
        return int(self._after[-1])

    @overload
    def __getitem__(self, at: int) -> Contour: ...

    @overload
    def __getitem__(self, at: slice) -> List[Contour]: ...

    def __getitem__(self, at: Any) -> Any:
        if isinstance(at, slice):
            return [self[k] for k in range(len(self))[at]]
        k = range(len(self))[at]
        level = bisect.bisect_right(self._after, k) - 1
        row, ends = k - self._after[level], self._ends[level]
        line = np.array(self._places[level][0 if row == 0 else ends[row - 1] : ends[row]])
        return Contour(self._levels[level], bool(self._closed[level][row]), line)

    def __repr__(self) -> str:
        return "%d contour lines at %d levels" % (len(self), len(self._levels))

    @property
    def places(self) -> Any:
        return self._lazy("places", np.empty((0, 2)))

    @property
    def closed(self) -> Any:
        return self._lazy("closed", np.empty(0, dtype=bool))

    @property
    def levels(self) -> Any:
        counts = np.diff(self._after)
        parts = [array.full(count, level, chunks=-1) for count, level in zip(counts.tolist(), self._levels)]
        return array.concatenate(parts) if parts else array.zeros(0)

    @property
    def ends(self) -> Any:
        before = np.cumsum([0, *map(len, self._places)]).tolist()
        parts = [spill.lazy(path, -1) + first for path, first in zip(self._paths["ends"], before)]
        return array.concatenate(parts) if parts else array.zeros(0, dtype=np.int64)

    def _lazy(self, kind: str, none: Any) -> Any:
        parts = [spill.lazy(path, -1) for path in self._paths[kind]]
        return array.concatenate(parts) if parts else array.from_array(none)


def _joined(parts: List[Pieces]) -> List[Tuple[bool, Floats]]:
    """Whether each line is closed, and its places."""
    edges = np.concatenate([np.empty((0, 2, 2), dtype=np.uint64), *(part.edges for part in parts)])
    places = np.concatenate([np.empty((0, 2, 2)), *(part.places for part in parts)]).reshape(-1, 2)
    order, node = _numbered(edges.reshape(-1, 2))
    n = len(order)
    place = places[order]
    after = np.full(n, -1, dtype=np.int64)
    after[node[0::2]] = node[1::2]
    begins = np.ones(n, dtype=bool)
    begins[node[1::2]] = False
    lines = [(closed, _distinct(closed, place[rows])) for closed, rows in _chains(after.tolist(), np.flatnonzero(begins).tolist())]
    return [(closed, line) for closed, line in lines if len(line) >= (3 if closed else 2)]


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


def _distinct(closed: bool, places: Floats) -> Floats:
    """The places of a line without those that equal the ones before."""
    kept = np.ones(len(places), dtype=bool)
    kept[1:] = (places[1:] != places[:-1]).any(axis=1)
    places = places[kept]
    return places[:-1] if closed and len(places) > 1 and (places[0] == places[-1]).all() else places
