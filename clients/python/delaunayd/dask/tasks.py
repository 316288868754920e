"""What workers do. Every function reads files of the spill folder and writes others; it may run twice, and the files are the same.

    split       a chunk of the input -> its rows, tile by tile
    build       a tile's rows -> the triangles that are done, its band, and the first messages
    exchange    a band, the messages to it -> more messages
    finish      a band, what it has received -> the rest of its triangles
"""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any, Dict, List, NamedTuple, Optional, Tuple

import numpy as np

from .._triangulation import Triangulation
from . import band, spill
from .chunks import Chunk
from .tiling import Tiling

if TYPE_CHECKING:
    from .._types import Floats, NDArray, Numbers

_BLOCK = 1 << 20  # triangles that are numbered at once


class Job(NamedTuple):
    """What all tasks know: the spill folder, whether points have values, and the type of numbers in the output."""

    folder: str
    values: bool
    dtype: str
    first_ids: Tuple[int, ...] = ()  # of each chunk
    boxes: Any = None  # of the own points of each tile, (t, 4), nan for none


class Piece(NamedTuple):
    """The rows of a chunk in a tile."""

    tile: int
    n: int
    box: Tuple[float, float, float, float]


class Sent(NamedTuple):
    """What a task of a tile did. `to`: the tiles that it has messages for. `deferred`: it has opened only the ends of its line."""

    tile: int
    to: Tuple[int, ...]
    deferred: bool
    halo: int = 0
    done: int = 0
    coincident: int = 0
    ends: Any = None


def split(job: Job, number: int, chunk: Chunk, tiling: Tiling) -> List[Piece]:
    """Writes the rows of a chunk to one file for each tile: coordinates, rows in the chunk, values."""
    xy, z = chunk.read(job.values)
    pieces = []
    for tile, rows in tiling.split(xy):
        own = xy[rows]
        parts = [own, rows.astype("<u4")] + ([] if z is None else [z[rows]])
        spill.write(spill.path_of(job.folder, "piece", number, tile), parts)
        pieces.append(Piece(tile, len(rows), _box(own)))
    return pieces


def _box(xy: Floats) -> Tuple[float, float, float, float]:
    (x0, y0), (x1, y1) = xy.min(axis=0).tolist(), xy.max(axis=0).tolist()
    return x0, y0, x1, y1


def own_points(job: Job, tile: int, chunks: Tuple[int, ...], with_values: bool) -> Tuple[Floats, NDArray[Any], Optional[Floats]]:
    """The own points of a tile, their numbers, ascending, and their values. The pieces remain."""
    size = 28 if job.values else 20
    paths = [spill.path_of(job.folder, "piece", chunk, tile) for chunk in chunks]
    counts = [os.path.getsize(path) // size for path in paths]
    n = sum(counts)
    xy, ids = np.empty((n, 2)), np.empty(n, dtype=job.dtype)
    z = np.empty(n) if with_values else None
    at = 0
    for chunk, path, count in zip(chunks, paths, counts):
        with open(path, "rb") as file:
            here = slice(at, at + count)
            _fill(file, xy[here])
            ids[here] = np.frombuffer(file.read(4 * count), dtype="<u4")
            ids[here] += np.array(job.first_ids[chunk], dtype=job.dtype)
            if z is not None:
                _fill(file, z[here])
        at += count
    return xy, ids, z


def _fill(file: Any, array: NDArray[Any]) -> None:
    if array.nbytes > 0 and file.readinto(array.reshape(-1).view(np.uint8).data) != array.nbytes:
        raise OSError("%s: the file is shorter than it was" % file.name)


def build(job: Job, tile: int, chunks: Tuple[int, ...]) -> Sent:
    """Triangulates the own points. Writes what is done, the band, and what to send."""
    xy, ids, z = own_points(job, tile, chunks, job.values)
    triangulation = Triangulation(xy, 1)
    opened = band.open_tile(xy, triangulation, job.boxes, tile)
    triangles, hull = triangulation.simplices, triangulation.hull()
    coincident = int(triangulation.counts.coincident)
    flat = len(triangles) == 0
    sent = hull.astype(np.int64) if flat else np.unique(np.concatenate([np.empty(0, dtype=np.int64), *opened.to.values()]))
    sent = np.sort(sent)
    done, walls = band.divide(triangles, sent, len(ids))
    count = _write_done(job, tile, triangles, done, ids)
    points = _points(job, xy, ids, z, sent)
    spill.write_arrays(
        spill.path_of(job.folder, "band", tile), points=points, walls=ids[walls], hull=_points(job, xy, ids, z, hull)
    )
    to = {other: np.searchsorted(sent, rows) for other, rows in opened.to.items()}
    _send(job, 1, tile, points, to)
    pairs = _pairs(points["id"], to)
    spill.write_arrays(spill.path_of(job.folder, "state", tile, 1), foreign=points[:0], sent=pairs)
    return Sent(tile, tuple(to), opened.deferred, done=count, coincident=coincident, ends=xy[hull[[0, -1]]] if flat else None)


def _write_done(job: Job, tile: int, triangles: Any, done: NDArray[np.bool_], ids: NDArray[Any]) -> int:
    blocks = range(0, len(triangles), _BLOCK)
    rows = (ids[triangles[at : at + _BLOCK][done[at : at + _BLOCK]]] for at in blocks)
    spill.write(spill.path_of(job.folder, "done", tile), rows)
    return int(np.count_nonzero(done))


def _points(job: Job, xy: Floats, ids: NDArray[Any], z: Optional[Floats], rows: Any) -> NDArray[Any]:
    points = np.empty(len(rows), dtype=band.points_type(job.values))
    points["id"], points["x"], points["y"] = ids[rows], xy[rows, 0], xy[rows, 1]
    if z is not None:
        points["z"] = z[rows]
    return points


def _pairs(ids: NDArray[Any], to: Dict[int, Numbers]) -> NDArray[np.uint64]:
    """What is sent: a tile and a point in one number; there are less than 2^40 points."""
    pairs = [ids[rows] | np.uint64(tile << 40) for tile, rows in to.items()]
    return np.concatenate([np.empty(0, dtype=np.uint64), *pairs])


def _send(job: Job, turn: int, tile: int, points: NDArray[Any], to: Dict[int, Numbers]) -> None:
    for other, rows in to.items():
        spill.write(spill.path_of(job.folder, "message", turn, tile, other), [points[rows]])


def _received(job: Job, tile: int, turn: int, senders: Tuple[int, ...]) -> NDArray[Any]:
    dtype = band.points_type(job.values)
    found = [np.fromfile(spill.path_of(job.folder, "message", turn, sender, tile), dtype=dtype) for sender in senders]
    return np.concatenate([np.empty(0, dtype=dtype), *found])


def _band_of(folder: str, tile: int, foreign: NDArray[Any]) -> band.Band:
    found = spill.read_arrays(spill.path_of(folder, "band", tile))
    points = np.concatenate([found["points"], foreign])
    order = np.argsort(points["id"], kind="stable")
    return band.Band(points[order], order < len(found["points"]), found["walls"])


def exchange(job: Job, tile: int, before: int, turn: int, senders: Tuple[int, ...], full: bool) -> Sent:
    """Inserts what was sent in the turn before, and sends what is new. `before`: the turn of the tile's last state. Points that the tile
    has already are ignored."""
    state = spill.read_arrays(spill.path_of(job.folder, "state", tile, before))
    foreign = np.concatenate([state["foreign"], _received(job, tile, turn - 1, senders)])
    own = spill.read_arrays(spill.path_of(job.folder, "band", tile))["points"]["id"]
    _, first = np.unique(foreign["id"], return_index=True)
    foreign = foreign[first]
    foreign = foreign[~np.isin(foreign["id"], own)]
    now = _band_of(job.folder, tile, foreign)
    opened = now.open(job.boxes, tile, full)
    to = {}
    for other, rows in opened.to.items():
        rows = rows[~np.isin(_pairs(now.points["id"], {other: rows}), state["sent"])]
        if len(rows) > 0:
            to[other] = rows
    _send(job, turn, tile, now.points, to)
    sent = np.concatenate([state["sent"], _pairs(now.points["id"], to)])
    spill.write_arrays(spill.path_of(job.folder, "state", tile, turn), foreign=foreign, sent=sent)
    return Sent(tile, tuple(to), opened.deferred, halo=len(foreign))


def finish(job: Job, tile: int, last: int) -> int:
    """Writes the rest of the triangles; returns their number. `last`: the turn of the tile's last state."""
    state = spill.read_arrays(spill.path_of(job.folder, "state", tile, last))
    now = _band_of(job.folder, tile, state["foreign"])
    rest = now.rest()
    spill.write(spill.path_of(job.folder, "rest", tile), [now.points["id"][rest].astype(job.dtype)])
    return len(rest)


def triangles(folder: str, tile: int, dtype: str) -> NDArray[Any]:
    """The triangles that a tile outputs, those in its interior first."""
    rows = [np.fromfile(spill.path_of(folder, kind, tile), dtype=dtype) for kind in ("done", "rest")]
    found: NDArray[Any] = np.concatenate(rows).reshape(-1, 3)
    return found
