"""A set followed over a connection of its own."""

from __future__ import annotations

import select
import socket
import time
from typing import Callable, Iterable, Iterator, Optional, Sequence, Union

from . import _address, _mirror
from ._mirror import LATER, PIECE, Change, Constraint
from ._protocol import ConnectionLost, Refused

__all__ = ["Change", "Constraint", "Mirror"]


class Mirror(_mirror.Mirror):
    """Follows a set, with WATCH:

        with client.mirror("t") as m:
            for change in m:
                print(m.version, change.triangles_added, change.triangles_removed)

    Points, rings, constraints and version are of one state of the set, that at `version`. They change only inside poll(), wait() and the
    iteration, which belong to one thread; what happens between two calls is one change or a few. The state is complete when
    the constructor returns; that is not a change.

    `url` as for Client. `fields`: the fields whose values it has. `within`: x0, y0, x1, y1, a box; only the points in it, and the constraints that meet it, are
    followed.
    `timeout` in seconds limits connecting and the wait for the first state; then TimeoutError is raised. `on_change` is called with
    every Change.

    After a lost connection it connects again and continues; however much has happened meanwhile, the change is the difference
    to the state before. If the set is dropped, `dropped` is True and no changes follow. Refused: the server refuses to let the
    set be followed.

    A change costs the mirror time in proportion to its size; one after a reset (PROTOCOL.md, section 6.5), in proportion to the
    size of the set."""

    def __init__(
        self,
        url: Union[str, _address.Address, None],
        name: str,
        fields: Iterable[str] = (),
        within: Optional[Sequence[float]] = None,
        timeout: Optional[float] = None,
        on_change: Optional[Callable[[Change], object]] = None,
    ):
        super().__init__(url, name, fields, within, timeout)
        self._on_change = on_change
        self._socket: Optional[socket.socket] = None
        deadline = None if timeout is None else time.monotonic() + timeout
        try:
            self._connect(deadline)
            while not self._has_begun():
                if not self._read(deadline):
                    raise TimeoutError("the set %s did not arrive in time" % name)
        except BaseException:
            self.close()
            raise

    def close(self) -> None:
        """Ends the connection; the state remains. Closing twice is allowed."""
        self._closed = True
        self._disconnect()

    def __enter__(self) -> "Mirror":
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def __del__(self) -> None:
        connection = getattr(self, "_socket", None)
        if connection is not None:
            connection.close()

    def __repr__(self) -> str:
        return "<delaunayd.Mirror of %s at %s, version %d>" % (self.name, self._address, self.version)

    # ---- changes ----

    def poll(self, timeout: Optional[float] = 0) -> Optional[Change]:
        """The next change; None if there is none within `timeout` seconds (None: no limit), the set has been dropped, or the mirror
        is closed."""
        deadline = None if timeout is None else time.monotonic() + timeout
        while True:
            try:
                change = self._step()
                if change is not None:
                    self._pause = 0.0
                    if self._on_change is not None:
                        self._on_change(change)
                    return change
                if self.dropped:
                    self._disconnect()
                if self.dropped or self._closed or not self._live(deadline) or not self._read(deadline):
                    return None
            except Refused as refusal:
                self._disconnect()
                if refusal.code not in LATER:
                    raise
            except (ConnectionError, BlockingIOError):
                self._disconnect()

    def wait(self, version: int, timeout: Optional[float] = None) -> bool:
        """Waits until the mirror has that version, such as that in the reply to an edit, or a later one. False: it is not there within
        `timeout` seconds (None: no limit), the set has been dropped, or the mirror is closed."""
        deadline = None if timeout is None else time.monotonic() + timeout
        while self.version < version:
            if self.poll(None if deadline is None else max(0.0, deadline - time.monotonic())) is None:
                return False
        return True

    def __iter__(self) -> Iterator[Change]:
        """Every change, until the set is dropped or the mirror is closed."""
        while True:
            change = self.poll(None)
            if change is None:
                return
            yield change

    # ---- the connection ----

    def _disconnect(self) -> None:
        connection, self._socket = self._socket, None
        if connection is not None:
            connection.close()
            self._begin_connection()

    def _connect(self, deadline: Optional[float]) -> None:
        limit = self._timeout
        if deadline is not None:
            left = max(0.01, deadline - time.monotonic())
            limit = left if limit is None else min(limit, left)
        self._socket = _address.connect(self._address, limit)
        self._socket.setsockopt(socket.SOL_SOCKET, socket.SO_KEEPALIVE, 1)
        self._begin_connection()
        self._socket.sendall(self._request())

    def _live(self, deadline: Optional[float]) -> bool:
        """Connects if the connection was lost. False: not before the deadline."""
        while self._socket is None:
            if deadline is not None and time.monotonic() + self._pause > deadline:
                time.sleep(max(0.0, deadline - time.monotonic()))
                return False
            time.sleep(self._pause)
            self._lengthen_pause()
            try:
                self._connect(deadline)
            except OSError:
                self._disconnect()
        return True

    def _read(self, deadline: Optional[float]) -> bool:
        """Receives what there is. False: nothing has come before the deadline."""
        assert self._socket is not None
        ready = select.poll()
        ready.register(self._socket, select.POLLIN)
        left = None if deadline is None else max(0.0, deadline - time.monotonic())
        if not ready.poll(None if left is None else 1000 * left):
            return False
        data = self._socket.recv(PIECE)
        if not data:
            raise ConnectionLost("the connection was lost")
        self._receive(data)
        return True
