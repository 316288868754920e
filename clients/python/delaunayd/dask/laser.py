"""Laser points: .las is read here [ASPRS, LAS Specification 1.4 - R15], .laz by laspy. Coordinates are those of the command line, to the last bit:
clients/files/las_file.c."""

from __future__ import annotations

import os
import struct
from typing import TYPE_CHECKING, Any, Iterator, Sequence

import numpy as np

from .chunks import ROWS
from .imported import module

if TYPE_CHECKING:
    from .._types import Floats

_SHORTEST = (20, 28, 26, 34, 57, 63, 30, 36, 38, 59, 67)  # bytes of a point of each format


def blocks_of(path: str) -> Iterator[Floats]:
    """Blocks of rows x, y, z. ValueError: the file is no LAS."""
    return _of_laz(path) if path.lower().endswith(".laz") else _of_las(path)


def _of_laz(path: str) -> Iterator[Floats]:
    with module("laspy", path).open(path) as file:
        for points in file.chunk_iterator(ROWS):
            yield _places((points.X, points.Y, points.Z), file.header.scales, file.header.offsets)


def _of_las(path: str) -> Iterator[Floats]:
    with open(path, "rb") as file:
        head = file.read(375)
    if len(head) < 227 or head[:4] != b"LASF" or head[24] != 1 or head[25] > 4:
        raise ValueError("%s is not a file of LAS 1.0 to 1.4" % path)
    start, kind, record = struct.unpack_from("<I4xBH", head, 96)
    long = head[25] == 4 and len(head) >= 255
    n = struct.unpack_from("<Q", head, 247)[0] if long else struct.unpack_from("<I", head, 107)[0]
    factors = struct.unpack_from("<6d", head, 131)
    if kind & 0xC0:
        raise ValueError("%s is compressed: its name must end with .laz" % path)
    if kind >= len(_SHORTEST) or record < _SHORTEST[kind] or not np.isfinite(factors).all() or 0 in factors[:3]:
        raise ValueError("%s is not a file of LAS points: its header contradicts itself" % path)
    if start + n * record > os.path.getsize(path):
        raise ValueError("%s ends before its %d points do" % (path, n))
    form = np.dtype({"names": ["x", "y", "z"], "formats": ["<i4"] * 3, "offsets": [0, 4, 8], "itemsize": record})
    for at in range(0, n, ROWS):
        rows = np.fromfile(path, form, min(ROWS, n - at), offset=start + at * record)
        yield _places([rows[name] for name in "xyz"], factors[:3], factors[3:])


def _places(whole: Sequence[Any], scales: Sequence[float], offsets: Sequence[float]) -> Floats:
    return np.column_stack([_along(*one) for one in zip(whole, scales, offsets)])


def _along(whole: Any, scale: float, offset: float) -> Any:
    """scale * whole + offset. With scale = 10^-k and an offset of at most k decimal places it is rounded once."""
    power = next((10.0**k for k in range(13) if scale == 1 / 10.0**k), 0.0)
    shift = float(np.rint(offset * power))
    if power > 0 and abs(shift) < 2.0**52 and shift / power == offset:
        return (np.asarray(whole, dtype=np.float64) + shift) / power
    return np.asarray(whole, dtype=np.float64) * scale + offset
