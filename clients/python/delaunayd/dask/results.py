"""A triangulation whose triangles and points are in files of a spill folder."""

from __future__ import annotations

import shutil
import weakref
from typing import Any, Dict

import numpy as np

from . import tasks
from .engine import Engine
from .imported import array, dask
from .rounds import Outcome


class Tin:
    """What triangulate() returns. Its files are removed when the object is, or by close()."""

    def __init__(self, engine: Engine, outcome: Outcome, keep: bool):
        self._engine, self._outcome, self._keep = engine, outcome, keep
        self._job = outcome.job
        self._end = weakref.finalize(self, shutil.rmtree, self._job.folder, True)

    def close(self) -> None:
        """Removes the files; arrays that are not computed yet cannot be computed any more."""
        self._end()

    def __enter__(self) -> "Tin":
        return self

    def __exit__(self, *error: Any) -> None:
        self.close()

    @property
    def triangles(self) -> Any:
        """A dask array of shape (m, 3), one chunk for each tile: numbers of points, counterclockwise, the smallest first; each triangle
        exactly once. uint32 below 2^32 points, otherwise uint64."""
        dtype = np.dtype(self._job.dtype)
        parts = [
            array.from_delayed(
                dask.delayed(tasks.triangles, pure=True)(self._job.folder, tile.number, self._job.dtype), (tile.triangles, 3), dtype
            )
            for tile in self._outcome.tiles
        ]
        return array.concatenate(parts) if parts else array.zeros((0, 3), dtype=dtype)

    def stats(self) -> Dict[str, Any]:
        """points, coincident, triangles, tiles (those with points), rounds, and halo: how many points tiles have received, all added."""
        tiles = self._outcome.tiles
        return {
            "points": sum(tile.points for tile in tiles),
            "coincident": sum(tile.coincident for tile in tiles),
            "triangles": sum(tile.triangles for tile in tiles),
            "tiles": len(tiles),
            "rounds": self._outcome.rounds,
            "halo": sum(tile.halo for tile in tiles),
        }
