"""Finds out what the input is, and makes chunks of it. Files of text and blocks of dask arrays are written to the spill folder first,
because their rows must be counted before points have numbers."""

from __future__ import annotations

import gzip
import itertools
import os
from typing import TYPE_CHECKING, Any, Iterator, List, NamedTuple, Optional

import numpy as np

from . import chunks, spill
from .chunks import Chunk
from .engine import Engine
from .imported import dask, module

if TYPE_CHECKING:
    from .._types import Floats

_TEXT = (".csv", ".csv.gz")
_LASER = (".las", ".laz")
_LINES = 1 << 18  # lines of text that are converted at once


class Input(NamedTuple):
    """The chunks in the order of rows, and whether points have values."""

    chunks: List[Chunk]
    values: bool


def chunks_of(points: Any, values: Optional[Any], engine: Engine, folder: str) -> Input:
    """`folder`: where tasks may write. ValueError: shapes do not fit; OSError: a file cannot be read."""
    if isinstance(points, (str, os.PathLike)):
        return _of_files([os.fspath(points)], values, engine, folder)
    if isinstance(points, (list, tuple)) and len(points) > 0 and all(isinstance(p, (str, os.PathLike)) for p in points):
        return _of_files([os.fspath(path) for path in points], values, engine, folder)
    if dask.is_dask_collection(points):
        return _of_collection(points, values, engine, folder)
    return _of_array(np.asarray(points), values, engine, folder)


# ---- arrays ----


def _of_array(array: Any, values: Optional[Any], engine: Engine, folder: str) -> Input:
    width = _width(array.shape, "points")
    z = None if values is None else np.asarray(values, dtype=np.float64)
    if z is not None and z.shape != array.shape[:1]:
        raise ValueError("values must have the shape (%d,), not %s" % (len(array), z.shape))
    found = chunks.of_array(array, z)
    return Input(found if engine.client is None else _stored(found, array, z, folder), z is not None or width == 3)


def _width(shape: Any, name: str) -> int:
    if len(shape) != 2 or shape[1] not in (2, 3):
        raise ValueError("%s must have the shape (n, 2), or (n, 3) with values, not %s" % (name, tuple(shape)))
    return int(shape[1])


def _stored(found: List[Chunk], array: Any, z: Any, folder: str) -> List[Chunk]:
    """The chunks in files, for other processes."""
    paths = [os.path.join(folder, name) for name in ("points.npy", "values.npy")]
    for path, content in zip(paths, (array, z)):
        if content is not None:
            spill.write(path, [chunks.npy_header(content), np.ascontiguousarray(content)])
    values_path = None if z is None else paths[1]
    return [
        chunk._replace(array=None, values=None, path=paths[0], values_path=values_path, start=chunk.first_row) for chunk in found
    ]


# ---- collections of dask ----


def _of_collection(points: Any, values: Optional[Any], engine: Engine, folder: str) -> Input:
    if hasattr(points, "columns"):
        names = [name for name in ("x", "y", "z") if name in points.columns]
        if names[:2] != ["x", "y"]:
            raise ValueError("a dataframe must have the columns x and y")
        width, blocks = len(names), points[names].to_delayed()
    else:
        width = _width(points.shape, "points")
        blocks = points.rechunk({1: -1}).to_delayed()[:, 0].tolist()
    if values is not None:
        if not hasattr(values, "to_delayed"):
            raise ValueError("values of a dask array must be a dask array")
        columns = values.to_delayed().tolist()
        if not hasattr(points, "chunks") or points.chunks[0] != values.chunks[0]:
            raise ValueError("values must have the chunks of points")
        calls = [(folder, number, block, column) for number, (block, column) in enumerate(zip(blocks, columns))]
    else:
        calls = [(folder, number, block, None) for number, block in enumerate(blocks)]
    counts = engine.run_blocks("read", write_block, calls)
    return Input(_written(folder, "points", counts), values is not None or width == 3)


def write_block(folder: str, number: int, block: Any, column: Any) -> int:
    """Writes a block, with its column of values if there is one; returns the number of rows."""
    rows: Floats = np.asarray(block, dtype=np.float64)
    if column is not None:
        rows = np.column_stack([rows[:, :2], np.asarray(column, dtype=np.float64)])
    spill.write(spill.path_of(folder, "block", number), [chunks.npy_header(rows), np.ascontiguousarray(rows)])
    return len(rows)


def _written(folder: str, name: str, counts: List[int]) -> List[Chunk]:
    first = [0, *itertools.accumulate(counts)]
    return [Chunk(name, first[k], n, path=spill.path_of(folder, "block", k)) for k, n in enumerate(counts)]


# ---- files ----


def _of_files(paths: List[str], values: Optional[Any], engine: Engine, folder: str) -> Input:
    if values is not None:
        raise ValueError("values of files are their third column")
    paths = [os.path.abspath(path) for path in paths]
    for path in paths:
        if not path.lower().endswith((".npy", *_TEXT, *_LASER)):
            raise ValueError("%s: the name must end with .npy, .csv, .csv.gz, .las or .laz" % path)
    texts = [(path, folder, number) for number, path in enumerate(paths) if not path.lower().endswith(".npy")]
    converted = dict(zip([path for path, _, _ in texts], engine.run("read", convert, texts)))
    found: List[Chunk] = []
    widths = {}
    for path in paths:
        source = converted.get(path, path)
        rows = np.load(source, mmap_mode="r")
        widths[path] = _width(rows.shape, path)
        found += [
            Chunk(path, start, min(chunks.ROWS, len(rows) - start), path=source, start=start)
            for start in range(0, len(rows), chunks.ROWS)
        ]
    if len(set(widths.values())) > 1:
        raise ValueError("%s has values, and %s has none" % (max(widths, key=widths.__getitem__), min(widths, key=widths.__getitem__)))
    return Input(found, 3 in widths.values())


def convert(path: str, folder: str, number: int) -> str:
    """Writes the rows of a file as a .npy file; returns its name."""
    blocks = _laser(path) if path.lower().endswith(_LASER) else _text(path)
    raw, width, n = spill.path_of(folder, "raw", number), 2, 0

    def counted() -> Iterator[Floats]:
        nonlocal width, n
        for rows in blocks:
            width, n = rows.shape[1], n + len(rows)
            yield rows

    # The header needs the number of rows, so its place stays free until they are written.
    spill.write_behind(raw, counted(), lambda: chunks.npy_header_of((n, width)))
    return raw


def _text(path: str) -> Iterator[Floats]:
    """Rows x,y or x,y,z; the first line may name the columns."""
    opened: Any = gzip.open(path, "rt") if path.lower().endswith(".gz") else open(path, encoding="utf-8")
    with opened as file:
        row, width = 0, 0
        while True:
            lines = list(itertools.islice(file, _LINES))
            if not lines:
                return
            if row == 0 and not _numbers(lines[0]):
                lines = lines[1:]
            rows = _parsed(path, row, lines)
            if len(rows) == 0:
                continue
            width = width or rows.shape[1]
            if rows.shape[1] != width or width not in (2, 3):
                raise ValueError("%s, row %d: there are %d columns" % (path, row, rows.shape[1]))
            yield rows
            row += len(rows)


def _numbers(line: str) -> bool:
    try:
        return len([float(word) for word in line.split(",")]) > 0
    except ValueError:
        return False


def _parsed(path: str, row: int, lines: List[str]) -> Floats:
    lines = [line for line in lines if line.strip()]
    if not lines:
        return np.empty((0, 2))
    try:
        rows: Floats = np.loadtxt(lines, delimiter=",", ndmin=2, comments=None)
        return rows
    except ValueError:
        width = len(lines[0].split(","))
        bad = next((k for k, line in enumerate(lines) if not _numbers(line) or len(line.split(",")) != width), 0)
        raise ValueError("%s, row %d: %r is not a point" % (path, row + bad, lines[bad].strip())) from None


def _laser(path: str) -> Iterator[Floats]:
    laspy = module("laspy", path)
    with laspy.open(path) as file:
        for points in file.chunk_iterator(chunks.ROWS):
            yield np.column_stack([points.x, points.y, points.z]).astype(np.float64)
