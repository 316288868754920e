"""The spill folder: files that tasks write and later tasks read. All workers must see it.

A file gets its name when it is complete, and no file changes after that. A task that Dask runs again, because a worker died, reads what the
first run read and replaces files by equal ones."""

from __future__ import annotations

import contextlib
import io
import os
import uuid
from typing import TYPE_CHECKING, Any, Dict, Iterable

import numpy as np

if TYPE_CHECKING:
    from .._types import NDArray


def path_of(folder: str, kind: str, *numbers: int) -> str:
    """The file of this kind for a chunk, a tile, or a round and two tiles."""
    return os.path.join(folder, "-".join([kind, *map(str, numbers)]))


def write(path: str, parts: Iterable[Any]) -> None:
    """Writes arrays or bytes, one after the other. OSError names the file; there is then no file of this name, or the old one."""
    scratch = "%s.%s" % (path, uuid.uuid4().hex)
    try:
        with open(scratch, "wb", buffering=0) as out:
            for part in parts:
                rest = memoryview(part).cast("B") if len(part) > 0 else memoryview(b"")
                while len(rest) > 0:
                    rest = rest[out.write(rest) :]
        os.replace(scratch, path)
    except OSError as error:
        with contextlib.suppress(OSError):
            os.remove(scratch)
        raise OSError(error.errno, error.strerror, path) from None


def write_arrays(path: str, **arrays: Any) -> None:
    """Writes named arrays of moderate size."""
    content = io.BytesIO()
    np.savez(content, **arrays)
    write(path, [content.getbuffer()])


def read_arrays(path: str) -> Dict[str, NDArray[Any]]:
    with np.load(path) as found:
        return dict(found)


def remove(*paths: str) -> None:
    """Removes files that may exist."""
    for path in paths:
        with contextlib.suppress(FileNotFoundError):
            os.remove(path)
