"""The private daemon of this process: in memory, on a Unix socket that only this user can access.

It exits when its standard input ends. This process holds the other end of that pipe, so the daemon ends with this process, however
that ends. Forked processes share the daemon.
"""

from __future__ import annotations

import atexit
import logging
import os
import shutil
import subprocess
import threading
from pathlib import Path
from typing import Optional

_log = logging.getLogger("delaunayd")
_lock = threading.Lock()
_process: Optional["subprocess.Popen[str]"] = None
_owner = 0  # the process that has started it
_path: Optional[str] = None
os.register_at_fork(after_in_child=lambda: globals().update(_lock=threading.Lock()))


def find_program() -> str:
    """$DELAUNAYD, or the program in this package, or that of $PATH."""
    packed = Path(__file__).parent / "bin" / "delaunayd"
    chosen = os.environ.get("DELAUNAYD") or (str(packed) if packed.exists() else shutil.which("delaunayd"))
    if not chosen:
        raise ConnectionError("no daemon can be started: delaunayd is not in $PATH; $DELAUNAYD may name it")
    return chosen


def socket_path(instead_of: Optional[str] = None) -> str:
    """The path of its socket. Starts the daemon if it does not run yet, or if it does not answer on `instead_of`."""
    global _path
    with _lock:
        if _path is None or _path == instead_of:
            _path = _start()
        return _path


def _start() -> str:
    global _process, _owner
    _end()
    program = find_program()
    try:
        _process = subprocess.Popen(
            [program, "--private", "--log-level", "error"], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
        )
    except OSError as error:
        raise ConnectionError("cannot start %s: %s" % (program, error.strerror)) from error
    _owner = os.getpid()
    assert _process.stdout is not None
    with _process.stdout as said:
        words = said.readline().split()
    if words[:2] != ["ready", "on"]:
        _end()
        raise ConnectionError("cannot start %s: it is not a daemon, or one without --private" % program)
    _log.info("started the private daemon %s, process %d: sets are in memory alone and end with this process", program, _process.pid)
    return words[2]


@atexit.register
def _end() -> None:
    global _process
    process, _process = _process, None
    if process is None or _owner != os.getpid():
        return
    assert process.stdin is not None
    process.stdin.close()
    try:
        process.wait(5)
    except subprocess.TimeoutExpired:
        process.kill()
        process.wait()
