"""Finds out what the input is, and makes chunks of it. Everything but .npy files is written to the spill folder first: workers may not see the memory
of this process, and the rows of text and of dask arrays must be counted before points have numbers."""

from __future__ import annotations

import gzip
import itertools
import os
import zlib
from typing import TYPE_CHECKING, Any, Iterator, List, Mapping, NamedTuple, Optional, Tuple

import numpy as np

from .._values import doubles, known, plain
from . import chunks, laser, spill
from .chunks import Chunk
from .engine import Engine
from .imported import array, dask

if TYPE_CHECKING:
    from .._types import Floats

_TEXT = (".csv", ".csv.gz")
_LASER = (".las", ".laz")
_LINES = 1 << 18  # lines of text that are converted at once


class Input(NamedTuple):
    """The chunks in the order of rows, and the names of the fields."""

    chunks: List[Chunk]
    fields: Tuple[str, ...]


def chunks_of(points: Any, values: Optional[Any], engine: Engine, folder: str) -> Input:
    """`folder`: where tasks may write. ValueError: shapes do not fit; OSError: a file cannot be read."""
    if isinstance(points, (str, os.PathLike)):
        return _of_files([os.fspath(points)], values, engine, folder)
    if isinstance(points, (list, tuple)) and len(points) > 0 and all(isinstance(p, (str, os.PathLike)) for p in points):
        return _of_files([os.fspath(path) for path in points], values, engine, folder)
    if dask.is_dask_collection(points):
        return _of_collection(points, values, engine, folder)
    return _of_array(plain(points), values, folder)


# ---- arrays ----


def _of_array(rows: Any, values: Optional[Any], folder: str) -> Input:
    width = _width(rows.shape, "points")
    if rows.dtype.kind == "c":
        raise ValueError("points are complex numbers; their coordinates must be columns")
    z, names = (rows[:, 2:], _third(width)) if values is None else _columns(values)
    if len(z) != len(rows):
        raise ValueError("values must have the shape (%d,) or (%d, fields), not %s" % (len(rows), len(rows), z.shape))
    path = spill.path_of(folder, "points")
    blocks = (_table(rows[at : at + chunks.ROWS], z[at : at + chunks.ROWS]) for at in range(0, len(rows), chunks.ROWS))
    spill.write(path, itertools.chain([chunks.npy_header((len(rows), 2 + len(names)))], blocks))
    return Input(chunks.of_file("points", path, len(rows)), names)


def _table(rows: Any, z: Any) -> Floats:
    """The coordinates in rows with values behind them, contiguous."""
    table: Floats = np.column_stack([doubles(rows[:, :2]), known(z)])
    return table


def _width(shape: Any, name: str) -> int:
    if len(shape) != 2 or shape[1] not in (2, 3):
        raise ValueError("%s must have the shape (n, 2), or (n, 3) with values, not %s" % (name, tuple(shape)))
    return int(shape[1])


def _third(width: int) -> Tuple[str, ...]:
    """The fields of points in rows of this width."""
    return ("z",) * (width - 2)


def _columns(values: Any) -> Tuple[Any, Tuple[str, ...]]:
    """Values as an array of shape (n, fields), and the names of the fields."""
    if isinstance(values, Mapping):
        columns = [known(column) for column in values.values()]
        if len(columns) == 0 or any(column.ndim != 1 or len(column) != len(columns[0]) for column in columns):
            raise ValueError("values of fields must have the same shape (n,)")
        return np.column_stack(columns), tuple(map(str, values))
    z: Floats = known(values)
    if z.ndim not in (1, 2):
        raise ValueError("values must have the shape (n,) or (n, fields), not %s" % (z.shape,))
    z = z[:, None] if z.ndim == 1 else z
    return z, _numbered(z.shape[1])


def _numbered(fields: int) -> Tuple[str, ...]:
    """One field is z, several have their numbers as names."""
    return ("z",) if fields == 1 else tuple(map(str, range(fields)))


# ---- collections of dask ----


def _of_collection(points: Any, values: Optional[Any], engine: Engine, folder: str) -> Input:
    if hasattr(points, "columns"):
        names = _chosen(points, values)
        blocks, columns = points[["x", "y", *names]].to_delayed(), None
    else:
        names = _third(_width(points.shape, "points"))
        blocks = points.rechunk({1: -1}).to_delayed()[:, 0].tolist()
        columns = None
        if values is not None:
            columns, names = _blocks(points, values)
    calls = [(folder, number, block, column) for number, (block, column) in enumerate(zip(blocks, columns or [None] * len(blocks)))]
    counts = engine.run_blocks("read", write_block, calls)
    first = itertools.accumulate(counts, initial=0)
    return Input([Chunk("points", row, n, spill.path_of(folder, "block", k), 0) for k, (row, n) in enumerate(zip(first, counts))], names)


def _chosen(frame: Any, values: Optional[Any]) -> Tuple[str, ...]:
    """The columns with values."""
    wanted = (values,) if isinstance(values, str) else values
    names = tuple(name for name in ("z",) if name in frame.columns) if wanted is None else tuple(wanted)
    missing = [name for name in ("x", "y", *names) if not isinstance(name, str) or name not in frame.columns]
    if missing:
        raise ValueError("a dataframe must have the columns x and y, and those of values: there is no %s" % missing[0])
    return names


def _blocks(points: Any, values: Any) -> Tuple[List[Any], Tuple[str, ...]]:
    """Values of a dask array as delayed blocks, and the names of the fields."""
    parts = list(values.values()) if isinstance(values, Mapping) else [values]
    if len(parts) == 0 or not all(hasattr(part, "to_delayed") and hasattr(part, "chunks") for part in parts):
        raise ValueError("values of a dask array must be a dask array, or several by names")
    if any(part.chunks[0] != points.chunks[0] or part.ndim > 2 for part in parts):
        raise ValueError("values must have the chunks of points, and the shape (n,) or (n, fields)")
    if isinstance(values, Mapping):
        return array.stack(parts, axis=1).rechunk({1: -1}).to_delayed()[:, 0].tolist(), tuple(map(str, values))
    if values.ndim == 1:
        return values.to_delayed().tolist(), _numbered(1)
    return values.rechunk({1: -1}).to_delayed()[:, 0].tolist(), _numbered(values.shape[1])


def write_block(folder: str, number: int, block: Any, column: Any) -> int:
    """Writes a block, with its columns of values if they are apart; returns the number of rows."""
    rows: Floats = doubles(block)
    spill.write_array(spill.path_of(folder, "block", number), rows if column is None else _table(rows, column))
    return len(rows)


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
    widths = {}  # of files that have rows
    for path in paths:
        source = converted.get(path, path)
        rows = _mapped(source, path)
        width = _width(rows.shape, path)
        if len(rows) > 0:
            widths[path] = width
        found += chunks.of_file(path, source, len(rows))
    if len(set(widths.values())) > 1:
        raise ValueError("%s has values, and %s has none" % (max(widths, key=widths.__getitem__), min(widths, key=widths.__getitem__)))
    return Input(found, _third(max(widths.values(), default=2)))


def _mapped(source: str, path: str) -> Any:
    """The rows of a .npy file."""
    try:
        rows = np.load(source, mmap_mode="r")
    except ValueError as error:
        raise ValueError("%s is not a file of numbers: %s" % (path, error)) from None
    if rows.dtype.kind not in "fiu":
        raise ValueError("%s has rows of type %s, not numbers" % (path, rows.dtype))
    return rows


def least(points: Any) -> int:
    """How many points there are at least, before anything is read. Lines of text and laser points have at most 128 bytes."""
    if isinstance(points, (str, os.PathLike)):
        points = [points]
    if isinstance(points, (list, tuple)):
        paths = [path for path in points if isinstance(path, (str, os.PathLike))]
        return sum(os.path.getsize(path) // 128 for path in paths if os.path.isfile(path))
    shape = getattr(points, "shape", (0,))
    return int(shape[0]) if len(shape) > 0 and isinstance(shape[0], (int, float)) and np.isfinite(shape[0]) else 0


def convert(path: str, folder: str, number: int) -> str:
    """Writes the rows of a file as a .npy file; returns its name."""
    blocks = laser.blocks_of(path) if path.lower().endswith(_LASER) else _text(path)
    raw, width, n = spill.path_of(folder, "raw", number), 2, 0

    def counted() -> Iterator[Floats]:
        nonlocal width, n
        for rows in blocks:
            width, n = rows.shape[1], n + len(rows)
            yield rows

    # The header needs the number of rows, so its place stays free until they are written.
    try:
        spill.write_behind(raw, counted(), lambda: chunks.npy_header((n, width)))
    except (UnicodeDecodeError, EOFError, gzip.BadGzipFile, zlib.error) as error:
        raise ValueError("%s, after row %d: %s" % (path, n, error)) from None
    return raw


def _text(path: str) -> Iterator[Floats]:
    """Rows x,y or x,y,z; the first line that is not blank may name the columns."""
    opened: Any = gzip.open if path.lower().endswith(".gz") else open
    with opened(path, "rt", encoding="utf-8-sig") as file:
        row, width, begun = 0, 0, False
        while True:
            lines = list(itertools.islice(file, _LINES))
            if not lines:
                return
            lines = [line for line in lines if line.strip()]
            if lines and not begun:
                begun = True
                if _names(lines[0]):
                    _check_names(path, lines.pop(0))
            rows = _parsed(path, row, lines)
            if len(rows) == 0:
                continue
            width = width or rows.shape[1]
            if rows.shape[1] != width or width not in (2, 3):
                raise ValueError("%s, row %d: there are %d columns" % (path, row, rows.shape[1]))
            yield rows
            row += len(rows)


def _names(line: str) -> bool:
    """Whether no word of the line is a number."""
    return not any(map(_numbers, line.split(",")))


def _check_names(path: str, line: str) -> None:
    """ValueError if the names of columns say that the first two are not x and y."""
    names = [word.strip().strip('"').lower() for word in line.split(",")]
    if ("x" in names and "y" in names and names[:2] != ["x", "y"]) or names[0] in ("lat", "latitude", "y", "northing"):
        raise ValueError("%s: the columns are %s; the first ones must be x and y" % (path, ", ".join(names)))


def _numbers(line: str) -> bool:
    try:
        return len([float(word) for word in line.split(",")]) > 0
    except ValueError:
        return False


def _parsed(path: str, row: int, lines: List[str]) -> Floats:
    if not lines:
        return np.empty((0, 2))
    try:
        rows: Floats = np.loadtxt(lines, delimiter=",", ndmin=2, comments=None)
        return rows
    except ValueError:
        width = len(lines[0].split(","))
        bad = next((k for k, line in enumerate(lines) if not _numbers(line) or len(line.split(",")) != width), 0)
        raise ValueError("%s, row %d: %r is not a point" % (path, row + bad, lines[bad].strip())) from None
