"""Chunks of the input: ranges of rows that a task reads at once."""

from __future__ import annotations

import io
from typing import TYPE_CHECKING, Any, List, NamedTuple, Tuple, cast

import numpy as np

from .._values import MOST, first_bad

if TYPE_CHECKING:
    from .._types import Floats, Numbers

ROWS = 1 << 21  # rows of a chunk, where the input does not have chunks of its own


class Chunk(NamedTuple):
    """`name`: of the source, for messages. `first_row`: the number of the first row in that source. `n`: how many rows there are.
    `path`: a file of NumPy, whose rows from `start` on are these."""

    name: str
    first_row: int
    n: int
    path: str
    start: int

    def rows(self) -> Any:
        """The rows, coordinates and values, mapped rather than read."""
        return np.load(self.path, mmap_mode="r")[self.start : self.start + self.n]

    def read(self) -> Tuple[Floats, Floats]:
        """The coordinates, and the values, of shape (n, fields). ValueError names a row that is not a point."""
        rows = self.rows()
        xy: Floats = np.ascontiguousarray(rows[:, :2], dtype=np.float64)
        self._check(xy)
        return xy, np.asarray(rows[:, 2:], dtype=np.float64)

    def _check(self, xy: Floats) -> None:
        row = first_bad(xy)
        if row >= 0:
            raise ValueError(
                "%s, row %d: %r, %r is not a point: magnitudes other than 0 are at least 2^-142 and at most 2^201"
                % (self.name, self.first_row + row, float(xy[row, 0]), float(xy[row, 1]))
            )

    def sample(self, size: int, seed: int) -> Floats:
        """At most this many of its points, chosen at random; rows that are not points are left out."""
        rows = self.rows()
        chosen: Numbers = np.arange(self.n)
        if size < self.n:
            chosen = np.unique(np.random.default_rng(seed).integers(0, self.n, size))
        xy: Floats = np.asarray(rows[chosen, :2], dtype=np.float64)
        kept: Floats = xy[(np.abs(xy) <= MOST).all(axis=1)]
        return kept


def of_file(name: str, path: str, n: int) -> List[Chunk]:
    """Chunks of a file of n rows."""
    return [Chunk(name, start, min(ROWS, n - start), path, start) for start in range(0, n, ROWS)]


def npy_header(shape: Tuple[int, ...], dtype: Any = "<f8") -> bytes:
    """What a .npy file has before the data of a C-contiguous array of this shape and type: 128 bytes, for two dimensions at most."""
    content, npy = io.BytesIO(), cast(Any, np.lib.format)
    npy.write_array_header_1_0(content, {"descr": npy.dtype_to_descr(np.dtype(dtype)), "fortran_order": False, "shape": shape})
    return content.getvalue()
