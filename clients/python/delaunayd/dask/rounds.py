"""The course of a triangulation: split the chunks into tiles, build each tile, exchange points until nothing is new, and finish.

It runs in the process of the caller, which knows numbers alone: of tiles, of rows, and of who has messages for whom."""

from __future__ import annotations

import itertools
import os
from typing import TYPE_CHECKING, Any, Dict, List, NamedTuple, Optional, Set, Tuple

import numpy as np

from .._triangulation import Triangulation
from . import spill, tasks
from .chunks import Chunk, npy_header
from .engine import Engine
from .tiling import Tiling

if TYPE_CHECKING:
    from .._types import Floats


class Tile(NamedTuple):
    """`chunks`: those that have rows in it. `last`: the turn of its last state. `triangles`: how many it outputs."""

    number: int
    chunks: Tuple[int, ...]
    points: int
    coincident: int
    halo: int
    last: int
    triangles: int


class Outcome(NamedTuple):
    """The tiles that have points, how many rounds there were, and what every task knows."""

    job: tasks.Job
    tiles: List[Tile]
    rounds: int


class _State:
    """What is known of a tile while rounds go on."""

    def __init__(self, chunks: Tuple[int, ...], points: int):
        self.chunks, self.points = chunks, points
        self.coincident = self.halo = 0
        self.done: Tuple[int, ...] = ()
        self.last, self.deferred = 1, False
        self.ends: Optional[Floats] = None


class Course:
    """Carries it out. `job` names the folder and the chunks."""

    def __init__(self, engine: Engine, job: tasks.Job, chunks: List[Chunk], tiling: Tiling, keep: bool):
        self._engine, self._job, self._chunks, self._tiling, self._keep = engine, job, chunks, tiling, keep
        self.tiles: Dict[int, _State] = {}

    def split(self) -> None:
        """Writes the rows of the chunks by tiles."""
        calls = [(self._job, number, chunk, self._tiling) for number, chunk in enumerate(self._chunks)]
        boxes = np.full((self._tiling.count, 4), np.nan)
        found: Dict[int, List[Tuple[int, int]]] = {}
        for number, pieces in enumerate(self._engine.run("read", tasks.split, calls)):
            for piece in pieces:
                found.setdefault(piece.tile, []).append((number, piece.n))
                boxes[piece.tile] = _joined(boxes[piece.tile], piece.box)
        self.tiles = {
            tile: _State(tuple(number for number, _ in rows), sum(count for _, count in rows)) for tile, rows in sorted(found.items())
        }
        self._job = self._job._replace(boxes=boxes)
        spill.remove(*{chunk.path for chunk in self._chunks if os.path.dirname(chunk.path) == self._job.folder})

    def run(self) -> Outcome:
        """Everything after the split."""
        calls = [(self._job, tile, state.chunks) for tile, state in self.tiles.items()]

        def ended(i: int) -> None:
            _, tile, chunks = calls[i]
            spill.remove(*(spill.path_of(self._job.folder, "piece", chunk, tile) for chunk in chunks))

        sent = self._engine.run("build", tasks.build, calls, None if self._keep else ended)
        for one in sent:
            state = self.tiles[one.tile]
            state.done, state.coincident, state.ends = one.done, one.coincident, one.ends
        turn = 1
        while True:
            mail = self._note(sent)
            full = set() if mail else self._lines()
            if not mail and not full:
                break
            turn += 1
            sent = self._exchange(turn, mail, full)
        return self._finish(turn)

    def _note(self, sent: List[tasks.Sent]) -> Dict[int, List[tasks.Part]]:
        """The messages for each tile, in the order of senders."""
        mail: Dict[int, List[tasks.Part]] = {}
        for one in sent:
            self.tiles[one.tile].deferred = one.deferred
            for part in one.to:
                mail.setdefault(part.tile, []).append(part._replace(tile=one.tile))
        return mail

    def _lines(self) -> Set[int]:
        """The tiles whose points are on a line and that must open it in full."""
        lines = {tile for tile, state in self.tiles.items() if state.deferred}
        ends = [state.ends for state in self.tiles.values() if state.ends is not None]
        if len(ends) == len(self.tiles) and lines:
            places = np.ascontiguousarray(np.concatenate(ends))
            if Triangulation(places, 1).counts.triangles == 0:
                return set()  # all points are on one line
        return lines

    def _exchange(self, turn: int, mail: Dict[int, List[tasks.Part]], full: Set[int]) -> List[tasks.Sent]:
        calls = [
            (self._job, tile, self.tiles[tile].last, turn, mail.get(tile, []), tile in full) for tile in sorted(set(mail) | full)
        ]
        sent = self._engine.run("round", tasks.exchange, calls)
        spill.remove_all(self._job.folder, "message-%d-" % (turn - 1))
        for one in sent:
            state = self.tiles[one.tile]
            spill.remove(spill.path_of(self._job.folder, "state", one.tile, state.last))
            state.last, state.halo = turn, one.halo
        return sent

    def _finish(self, turn: int) -> Outcome:
        calls = [(self._job, tile, state.last) for tile, state in self.tiles.items()]
        parts: List[Tuple[str, int]] = []
        tiles: List[Tile] = []
        for (tile, state), more in zip(self.tiles.items(), self._engine.run("triangles", tasks.finish, calls)):
            files = [spill.path_of(self._job.folder, "done", tile, k) for k in range(len(state.done))]
            parts += zip([*files, spill.path_of(self._job.folder, "rest", tile)], [*state.done, more])
            tiles.append(Tile(tile, state.chunks, state.points, state.coincident, state.halo, state.last, sum(state.done) + more))
        self._gather(parts)
        return Outcome(self._job, tiles, turn)

    def _gather(self, parts: List[Tuple[str, int]]) -> None:
        """Moves the triangles from files to one, so that the disk has each of them once, but for those on their way. A part: a file, and the
        number of its triangles."""
        path, row = spill.path_of(self._job.folder, "triangles"), 3 * np.dtype(self._job.dtype).itemsize
        header = npy_header((sum(n for _, n in parts), 3), self._job.dtype)
        *first, size = itertools.accumulate((row * n for _, n in parts), initial=len(header))
        spill.begin(path, header, size)
        calls = [(part, path, at) for (part, _), at in zip(parts, first)]
        self._engine.run("triangles", spill.copy, calls, lambda i: spill.remove(parts[i][0]))


def _joined(box: Any, other: Any) -> Any:
    return (*np.fmin(box[:2], other[:2]), *np.fmax(box[2:], other[2:]))
