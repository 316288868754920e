"""Finds out what the input is, and makes chunks of it."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any, List, NamedTuple, Optional

import numpy as np

from . import chunks, spill
from .chunks import Chunk
from .engine import Engine


class Input(NamedTuple):
    """The chunks in the order of rows, and whether points have values."""

    chunks: List[Chunk]
    values: bool


def chunks_of(points: Any, values: Optional[Any], engine: Engine, folder: str) -> Input:
    """`folder`: where the tasks may write."""
    array = np.asarray(points)
    _check_shape(array.shape, "points")
    z = None if values is None else _values(values, len(array))
    has_values = z is not None or array.shape[1] == 3
    if engine.client is None:
        return Input(chunks.of_array(array, z), has_values)
    return Input(_stored(array, z, folder), has_values)


def _stored(array: Any, z: Any, folder: str) -> List[Chunk]:
    """Chunks of an array that other processes read: in files."""
    paths = [os.path.join(folder, name) for name in ("points.npy", "values.npy")]
    for path, content in zip(paths, (array, z)):
        if content is not None:
            spill.write(path, [chunks.npy_header(content), np.ascontiguousarray(content)])
    found = [chunk._replace(array=None, values=None, path=paths[0], start=chunk.first_row) for chunk in chunks.of_array(array, z)]
    return [chunk._replace(values_path=None if z is None else paths[1]) for chunk in found]


def _check_shape(shape: Any, name: str) -> None:
    if len(shape) != 2 or shape[1] not in (2, 3):
        raise ValueError("%s must have the shape (n, 2), or (n, 3) with values, not %s" % (name, tuple(shape)))


def _values(values: Any, n: int) -> Any:
    array = np.asarray(values, dtype=np.float64)
    if array.shape != (n,):
        raise ValueError("values must have the shape (%d,), not %s" % (n, array.shape))
    return array
