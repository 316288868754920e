"""What workers do. Every function reads files of the spill folder and writes others; it may run twice, and the files are the same.

    split       a chunk of the input -> its rows, tile by tile
    build       a tile's rows -> the triangles that are done, its band, and the first messages
    exchange    a band, the messages to it -> more messages
    finish      a band, what it has received -> the rest of its triangles
"""

from __future__ import annotations

import itertools
import os
from typing import TYPE_CHECKING, Any, Dict, List, NamedTuple, Sequence, Tuple

import numpy as np

from .._tile import Tile
from . import band, spill
from .chunks import Chunk
from .tiling import Tiling

if TYPE_CHECKING:
    from .._types import Floats, NDArray, Numbers

_BLOCK = 1 << 21  # triangles of a file


class Job(NamedTuple):
    """What all tasks know: the spill folder, the names of the fields, and the type of numbers in the output."""

    folder: str
    fields: Tuple[str, ...]
    dtype: str
    first_ids: Tuple[int, ...] = ()  # of each chunk
    boxes: Any = None  # of the own points of each tile, (t, 4), nan for none


class Piece(NamedTuple):
    """The rows of a chunk in a tile."""

    tile: int
    n: int
    box: Tuple[float, float, float, float]


class Part(NamedTuple):
    """Of what a tile has sent in a turn, the points for one tile: the sender or the receiver, the first of them, and how many there are."""

    tile: int
    first: int
    n: int


class Sent(NamedTuple):
    """What a task of a tile did. `to`: its messages, by receivers. `deferred`: it has opened only the ends of its line."""

    tile: int
    to: Tuple[Part, ...]
    deferred: bool
    halo: int = 0
    done: Tuple[int, ...] = ()
    coincident: int = 0
    ends: Any = None


def split(job: Job, number: int, chunk: Chunk, tiling: Tiling) -> List[Piece]:
    """Writes the rows of a chunk to one file for each tile: coordinates, rows in the chunk, values, field by field."""
    xy, z = chunk.read()
    pieces = []
    for tile, rows in tiling.split(xy):
        own = xy[rows]
        parts = [own, rows.astype("<u4"), *(z[rows, field] for field in range(len(job.fields)))]
        spill.write(spill.path_of(job.folder, "piece", number, tile), parts)
        pieces.append(Piece(tile, len(rows), _box(own)))
    return pieces


def _box(xy: Floats) -> Tuple[float, float, float, float]:
    x, y = xy[:, 0], xy[:, 1]  # one by one: a reduction along rows of two takes eight times as long
    return float(x.min()), float(y.min()), float(x.max()), float(y.max())


def own_points(job: Job, tile: int, chunks: Tuple[int, ...], fields: Sequence[int]) -> Tuple[Floats, NDArray[Any], Floats]:
    """The own points of a tile, their numbers, ascending, and their values in these fields, of shape (fields, n). The pieces remain."""
    size = 20 + 8 * len(job.fields)
    paths = [spill.path_of(job.folder, "piece", chunk, tile) for chunk in chunks]
    counts = [os.path.getsize(path) // size for path in paths]
    n = sum(counts)
    xy, ids, z = np.empty((n, 2)), np.empty(n, dtype=job.dtype), np.empty((len(fields), n))
    at = 0
    for chunk, path, count in zip(chunks, paths, counts):
        with open(path, "rb") as file:
            here = slice(at, at + count)
            _fill(file, xy[here])
            ids[here] = np.frombuffer(file.read(4 * count), dtype="<u4")
            ids[here] += np.array(job.first_ids[chunk], dtype=job.dtype)
            for column, field in zip(z, fields):
                file.seek((20 + 8 * field) * count)
                _fill(file, column[here])
        at += count
    return xy, ids, z


def _fill(file: Any, array: NDArray[Any]) -> None:
    if array.nbytes > 0 and file.readinto(array.reshape(-1).view(np.uint8).data) != array.nbytes:
        raise OSError("%s: the file is shorter than it was" % file.name)


def build(job: Job, tile: int, chunks: Tuple[int, ...]) -> Sent:
    """Triangulates the own points. Writes what is done, the band, and what to send."""
    xy, ids, z = own_points(job, tile, chunks, range(len(job.fields)))
    own = Tile(xy, np.arange(len(ids), dtype=np.uint64))
    counts = own.counts
    if counts.triangles == 0:  # a line or a place
        _, band_rows = np.unique(xy + 0.0, axis=0, return_index=True)
        band_rows = np.sort(band_rows)
        to = _to_all(job, tile, band.ends(xy[band_rows]))
    else:
        first, later = own.open(job.boxes, tile), _open(own, job, tile)
        band_rows = np.unique(np.concatenate([np.empty(0, dtype=np.int64), *first.values(), *later.values()]))
        to = {other: np.searchsorted(band_rows, rows) for other, rows in first.items()}
    triangles = own.triangles(np.uint32)
    del own
    done, walls = band.divide(triangles, band_rows, len(ids))
    count = _write_done(job, tile, triangles, done, ids)
    points = _points(job, xy, ids, z, band_rows)
    spill.write_arrays(spill.path_of(job.folder, "band", tile), points=points, walls=ids[walls])
    parts = _send(job, 1, tile, points, to)
    spill.write_arrays(
        spill.path_of(job.folder, "state", tile, 1), foreign=points[:0], sent=_pairs(points["id"], to)
    )
    line = band.xy_of(points)[band.ends(band.xy_of(points))] if counts.triangles == 0 else None
    return Sent(tile, parts, line is not None, done=count, coincident=counts.coincident, ends=line)


def _to_all(job: Job, tile: int, rows: Numbers) -> Dict[int, Numbers]:
    return {other: rows for other, box in enumerate(job.boxes) if other != tile and not np.isnan(box[0])}


def _open(tile: Tile, job: Job, number: int) -> Dict[int, Numbers]:
    """What Tile.open returns until it has judged all faces."""
    found: Dict[int, Numbers] = {}
    more = True
    while more:
        for other, rows in tile.open(job.boxes, number).items():
            found[other] = np.concatenate([found[other], rows]) if other in found else rows
        more = tile.counts.postponed > 0
    return found


def _write_done(job: Job, tile: int, triangles: Any, done: NDArray[np.bool_], ids: NDArray[Any]) -> Tuple[int, ...]:
    """Writes them to several files, so that they can be removed one by one; returns the number of triangles in each."""
    counts = []
    for part, at in enumerate(range(0, len(triangles), _BLOCK)):
        rows = ids[triangles[at : at + _BLOCK][done[at : at + _BLOCK]]]
        spill.write(spill.path_of(job.folder, "done", tile, part), [rows])
        counts.append(len(rows))
    return tuple(counts)


def _points(job: Job, xy: Floats, ids: NDArray[Any], z: Floats, rows: Any) -> NDArray[Any]:
    points = np.empty(len(rows), dtype=band.points_type(len(job.fields)))
    points["id"], points["x"], points["y"] = ids[rows], xy[rows, 0], xy[rows, 1]
    if len(z) > 0:
        points["z"] = z[:, rows].T
    return points


def _pairs(ids: NDArray[Any], to: Dict[int, Numbers]) -> NDArray[np.uint64]:
    """What is sent: a tile and a point in one number; there are less than 2^40 points."""
    pairs = [ids[rows] | np.uint64(tile << 40) for tile, rows in to.items()]
    return np.concatenate([np.empty(0, dtype=np.uint64), *pairs])


def _send(job: Job, turn: int, tile: int, points: NDArray[Any], to: Dict[int, Numbers]) -> Tuple[Part, ...]:
    """Writes all messages to one file."""
    spill.write(spill.path_of(job.folder, "message", turn, tile), [points[rows] for rows in to.values()])
    first = itertools.accumulate(map(len, to.values()), initial=0)
    return tuple(Part(other, at, len(rows)) for (other, rows), at in zip(to.items(), first))


def _received(job: Job, turn: int, mail: Sequence[Part]) -> NDArray[Any]:
    dtype = band.points_type(len(job.fields))
    paths = [spill.path_of(job.folder, "message", turn, part.tile) for part in mail]
    found = [np.fromfile(path, dtype, part.n, offset=part.first * dtype.itemsize) for path, part in zip(paths, mail)]
    return np.concatenate([np.empty(0, dtype=dtype), *found])


def exchange(job: Job, tile: int, before: int, turn: int, mail: Sequence[Part], full: bool) -> Sent:
    """Inserts what was sent in the turn before, and sends what is new. `mail`: by senders. `before`: the turn of the tile's last state. `full`: a line
    follows the rule, too. Owners send a point to a tile once, so no point comes twice."""
    state = spill.read_arrays(spill.path_of(job.folder, "state", tile, before))
    foreign = np.concatenate([state["foreign"], _received(job, turn - 1, mail)])
    points = spill.read_arrays(spill.path_of(job.folder, "band", tile))["points"]
    now = Tile(band.xy_of(points), points["id"])
    now.insert(band.xy_of(foreign), foreign["id"])
    deferred = now.counts.triangles == 0 and not full
    found = _to_all(job, tile, band.ends(band.xy_of(points))) if deferred else _open(now, job, tile)
    to = {}
    for other, rows in found.items():
        rows = rows[~np.isin(_pairs(points["id"], {other: rows}), state["sent"])]
        if len(rows) > 0:
            to[other] = rows
    parts = _send(job, turn, tile, points, to)
    sent = np.concatenate([state["sent"], _pairs(points["id"], to)])
    spill.write_arrays(spill.path_of(job.folder, "state", tile, turn), foreign=foreign, sent=sent)
    return Sent(tile, parts, deferred, halo=len(foreign))


def finish(job: Job, tile: int, last: int) -> int:
    """Writes the rest of the triangles; returns their number. `last`: the turn of the tile's last state."""
    points, now = band_of(job.folder, tile, last)
    rest = now.rest()
    spill.write(spill.path_of(job.folder, "rest", tile), [points["id"][rest].astype(job.dtype)])
    return len(rest)


def band_of(folder: str, tile: int, last: int) -> Tuple[NDArray[Any], band.Band]:
    """The points of a tile's band and its foreign points, by number, and their triangulation."""
    found = spill.read_arrays(spill.path_of(folder, "band", tile))
    points = np.concatenate([found["points"], spill.read_arrays(spill.path_of(folder, "state", tile, last))["foreign"]])
    order = np.argsort(points["id"], kind="stable")
    return points[order], band.Band(points[order], order < len(found["points"]), found["walls"])
