"""From points to a Tin."""

from __future__ import annotations

import itertools
from typing import TYPE_CHECKING, Any, List, Optional

import numpy as np

from .._values import whole
from . import limits, reading
from .chunks import Chunk
from .engine import Engine
from .folders import new_folder, remove_folder
from .results import Tin
from .rounds import Course
from .tasks import Job
from .tiling import Tiling, tiling_of

if TYPE_CHECKING:
    from .._types import Floats

TILE = 10_000_000
_SAMPLE = 1 << 16  # points that the cuts of tiles are chosen from, and 2^10 more for each tile


def triangulate(
    points: Any,
    values: Any = None,
    *,
    tile: int = TILE,
    client: Optional[Any] = None,
    spill: Optional[str] = None,
    keep: bool = True,
    progress: bool = False,
    timeout: float = 300.0,
) -> Tin:
    """The Delaunay triangulation of points as a Tin.

    `points`: an array of NumPy or dask of shape (n, 2), or (n, 3) with values; a dask dataframe with columns x, y and maybe z; or the
    name of a file, or a list of names: .npy, .csv, .csv.gz, .las, and .laz if laspy is installed. The number of a point is its
    row, counted over all files in order.

    `values`: an array of shape (n,), instead of a third column; of shape (n, fields) for several fields; or a mapping from names of fields to
    arrays. Of a dataframe, the names of columns, z by default. `tile`: about how many points a tile has. A worker needs about
    200 bytes of memory for each point of a tile. `client`: of distributed, by default this process's; without one dask's own
    scheduler is used. `spill`: a folder that all workers see, by default one for temporary files; it needs 20 bytes a point, and the triangles 24
    or 48. What a process that was killed has left there is removed first. `keep`: keep the points there, for tin.raster(), contours() and locate().
    `timeout`: how many seconds to wait for workers while the cluster has none.

    ValueError names a row that is not a point; MemoryError and OSError say what does not suffice; TimeoutError: there were no workers;
    RuntimeError: workers died again and again."""
    if whole(tile) < 1:
        raise ValueError("a tile must have at least 1 point")
    engine = Engine(client, progress, timeout)
    folder = new_folder(spill)
    try:
        least = reading.least(points)
        limits.check_memory(engine, min(tile, least), 0)
        limits.check_disk(folder, least, 0)
        found = reading.chunks_of(points, values, engine, folder)
        total = sum(chunk.n for chunk in found.chunks)
        tiles = max(1, -(-total // tile))
        limits.check_memory(engine, min(tile, total), len(found.fields))
        limits.check_disk(folder, total, len(found.fields))
        tiling = tiling_of(_sample(found.chunks, _SAMPLE + (tiles << 10)), tiles)
        return tin_of(engine, folder, found, tiling, keep)
    except BaseException:
        remove_folder(folder)
        raise


def tin_of(engine: Engine, folder: str, found: reading.Input, tiling: Tiling, keep: bool, before: int = 0) -> Tin:
    """The Tin of an input with these tiles. It owns the folder. `before`: the number of the first point."""
    *first, after = itertools.accumulate((chunk.n for chunk in found.chunks), initial=before)
    dtype = "<u4" if after < 2**32 else "<u8"
    course = Course(engine, Job(folder, found.fields, dtype, tuple(first)), found.chunks, tiling, keep)
    course.split()
    limits.check_memory(engine, max((state.points for state in course.tiles.values()), default=0), len(found.fields))
    return Tin(engine, course.run(), keep)


def _sample(chunks: List[Chunk], size: int) -> Floats:
    total = max(1, sum(chunk.n for chunk in chunks))
    parts = [chunk.sample(max(1, size * chunk.n // total), seed) for seed, chunk in enumerate(chunks) if chunk.n > 0]
    return np.concatenate([np.empty((0, 2)), *parts])


__all__ = ["TILE", "triangulate"]
