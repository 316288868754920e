"""What a triangulation needs, estimated before it begins."""

from __future__ import annotations

import shutil

from .engine import Engine

MEMORY = 200  # bytes of a worker for each point of a tile, at its peak; make bench-dask reports the measured figure
_BASE = 150 << 20  # bytes of a worker with Python, NumPy and dask
_MOST = 1 << 28  # points of a tile


def check_memory(engine: Engine, tile: int, fields: int) -> None:
    """MemoryError: a thread of a worker has too little memory for a tile of so many points. ValueError: a tile has too many."""
    if tile > _MOST:
        raise ValueError("a tile of %d points has more than 2^28" % tile)
    available, threads = engine.memory()
    each = MEMORY + 8 * fields
    need = _BASE + each * tile
    if need > available:
        raise MemoryError(
            "a tile of %d points needs about %s, and each of %d threads of workers has %s: use tile=%d or less, or fewer threads. "
            "Coincident points are always in one tile"
            % (tile, _size(need), threads, _size(available), max(1, (available - _BASE) // each))
        )


def check_disk(folder: str, total: int, fields: int) -> None:
    """OSError: the spill folder has too little space for so many points and their triangles."""
    number = 4 if total < 2**32 else 8
    need = total * (20 + 8 * fields + max(6 * number, 16 + 8 * fields))  # points, and triangles or the input
    free = shutil.disk_usage(folder).free
    if need > free:
        raise OSError("%d points need about %s in the spill folder %s, which has %s" % (total, _size(need), folder, _size(free)))


def _size(n: int) -> str:
    return "%.1f GB" % (n / 1e9) if n >= 1e9 else "%.1f MB" % (n / 1e6)
