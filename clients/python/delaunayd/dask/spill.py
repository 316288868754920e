"""The spill folder: files that tasks write and later tasks read. All workers must see it.

A file gets its name when it is complete, and no file changes after that. A task that Dask runs again, because a worker died, reads what the
first run read and replaces files by equal ones."""

from __future__ import annotations

import contextlib
import io
import os
import re
import shutil
import uuid
from typing import TYPE_CHECKING, Any, Callable, Dict, Iterable, Iterator, List

import numpy as np

from .chunks import npy_header
from .imported import array, dask

if TYPE_CHECKING:
    from .._types import NDArray


HEADER = 128  # bytes, of a .npy file with a table
_BLOCK = 1 << 20  # bytes that are copied at once


def path_of(folder: str, kind: str, *numbers: int) -> str:
    """The file of this kind for a chunk, a tile, or a round and two tiles."""
    return os.path.join(folder, "-".join([kind, *map(str, numbers)]))


@contextlib.contextmanager
def complete(path: str) -> Iterator[Any]:
    """A file that gets its name when everything is written. OSError names the file; there is then no file of this name, or the old one."""
    scratch = scratch_of(path)
    try:
        with naming(path), open(scratch, "wb", buffering=0) as out:
            yield out
        os.replace(scratch, path)
    except BaseException:
        remove(scratch)
        raise


@contextlib.contextmanager
def naming(path: str) -> Iterator[None]:
    """An OSError that names no file names this one."""
    try:
        yield
    except OSError as error:
        if error.filename is None and error.errno is not None:
            raise OSError(error.errno, error.strerror, path) from None
        raise


def _put(out: Any, parts: Iterable[Any]) -> None:
    for part in parts:
        rest = memoryview(part).cast("B") if len(part) > 0 else memoryview(b"")
        while len(rest) > 0:
            rest = rest[out.write(rest) :]


def scratch_of(path: str) -> str:
    """A name for a file that is not complete."""
    return "%s.%s" % (path, uuid.uuid4().hex)


def begin(path: str, header: bytes, size: int) -> None:
    """Makes a file of this size that begins with the header. The disk has no more of it until it is written."""
    with naming(path), open(path, "wb", buffering=0) as out:
        out.write(header)
        out.truncate(size)


def copy(source: str, path: str, at: int) -> None:
    """Copies a whole file into one that exists, from byte `at` on."""
    with naming(path), open(source, "rb", buffering=0) as file, open(path, "r+b") as out:
        out.seek(at)
        shutil.copyfileobj(file, out, _BLOCK)


def publish(source: str, path: str) -> None:
    """Gives a complete file this name, too. On another file system, or on one without links, it is copied."""
    scratch = scratch_of(path)
    try:
        try:
            os.link(source, scratch)
        except OSError:
            with naming(path):
                shutil.copyfile(source, scratch)
        os.replace(scratch, path)
    finally:
        remove(scratch)  # it remains if it is the same file as `path`


def write(path: str, parts: Iterable[Any]) -> None:
    """Writes arrays or bytes, one after the other."""
    with complete(path) as out:
        _put(out, parts)


def write_behind(path: str, parts: Iterable[Any], header: Callable[[], bytes]) -> None:
    """The same behind a header of 128 bytes, which is known only after the parts."""
    with complete(path) as out:
        out.seek(HEADER)
        _put(out, parts)
        first = header()
        assert len(first) == HEADER
        out.seek(0)
        _put(out, [first])


def write_arrays(path: str, **arrays: Any) -> None:
    """Writes named arrays of moderate size."""
    content = io.BytesIO()
    np.savez(content, **arrays)
    write(path, [content.getbuffer()])


def read_arrays(path: str) -> Dict[str, NDArray[Any]]:
    with np.load(path) as found:
        return dict(found)


def write_array(path: str, rows: NDArray[Any]) -> None:
    """Writes one array as a .npy file."""
    write(path, [npy_header(rows.shape, rows.dtype), np.ascontiguousarray(rows)])


def rows_of(path: str, first: int, after: int) -> NDArray[Any]:
    """These rows of a .npy file."""
    return np.array(np.load(path, mmap_mode="r")[first:after])


def lazy(path: str, chunks: Any = "auto") -> Any:
    """The array of a .npy file as an array of dask, whose tasks read it. `chunks` of rows, as dask has them; -1: one."""
    found = np.load(path, mmap_mode="r")
    shape, dtype = found.shape, found.dtype
    rows = array.core.normalize_chunks((chunks, *(-1 for _ in shape[1:])), shape, dtype=dtype)[0]
    after = np.cumsum([0, *rows]).tolist()
    read = dask.delayed(rows_of, pure=True)
    return array.concatenate([array.from_delayed(read(path, a, b), (b - a, *shape[1:]), dtype) for a, b in zip(after, after[1:])])


def numbered(folder: str, name: str) -> List[str]:
    """The files NAME-NUMBER, the greatest number first."""
    numbers = [int(file[len(name) + 1 :]) for file in os.listdir(folder) if re.fullmatch(re.escape(name) + "-[0-9]+", file)]
    return [path_of(folder, name, number) for number in sorted(numbers, reverse=True)]


def remove_all(folder: str, start: str) -> None:
    """Removes the files whose names start like this."""
    remove(*(os.path.join(folder, file) for file in os.listdir(folder) if file.startswith(start)))


def remove(*paths: str) -> None:
    """Removes files that may exist."""
    for path in paths:
        with contextlib.suppress(FileNotFoundError):
            os.remove(path)
