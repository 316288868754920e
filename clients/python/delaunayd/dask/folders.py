"""Spill folders and their owners. A process that is killed leaves its folder behind; the next one that makes a folder in the same place removes it.

The owner of a folder holds a lock (flock) of the file `owner` in it as long as it lives. The file gets its name when it is locked. Locks may not reach
other machines, so the file says on which one the owner runs, since which start of it. Folders of other machines stay."""

from __future__ import annotations

import contextlib
import fcntl
import os
import shutil
import tempfile
import time
from typing import Any, Dict, Optional

_PREFIX = "delaunayd-"
_held: Dict[str, Any] = {}  # the locked files of folders of this process


def _mark() -> bytes:
    with open("/proc/sys/kernel/random/boot_id", "rb") as file:
        return b"delaunayd.dask " + file.read()


def new_folder(parent: Optional[str]) -> str:
    """A new folder in `parent`, or in the one for temporary files, from which folders of dead processes are removed first."""
    parent = tempfile.gettempdir() if parent is None else os.path.abspath(parent)
    _remove_dead(parent)
    folder = tempfile.mkdtemp(prefix=_PREFIX, dir=parent)
    owner = os.path.join(folder, "owner")
    with contextlib.suppress(OSError):  # without locks or marks the folder stays if this process is killed
        file = open(owner + ".new", "wb", buffering=0)
        _held[folder] = file
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        file.write(_mark())
        os.rename(owner + ".new", owner)
    return folder


def remove_folder(path: str) -> None:
    """Removes the folder. A task that still runs may make a file meanwhile, but none once the folder is gone."""
    for _ in range(50):
        shutil.rmtree(path, ignore_errors=True)
        if not os.path.exists(path):
            break
        time.sleep(0.1)
    file = _held.pop(path, None)
    if file is not None:
        file.close()


def _remove_dead(parent: str) -> None:
    with contextlib.suppress(OSError):
        for name in os.listdir(parent):
            if name.startswith(_PREFIX):
                _remove_if_dead(os.path.join(parent, name))


def _remove_if_dead(folder: str) -> None:
    """Removes a folder whose owner ran on this machine and holds its lock no longer."""
    with contextlib.suppress(OSError), open(os.path.join(folder, "owner"), "rb") as file:
        if file.read() == _mark():
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)  # OSError: the owner lives
            remove_folder(folder)
