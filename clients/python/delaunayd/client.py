"""The client for threads. Tables are NumPy arrays if NumPy is installed, else array.array; no Python object is created for a single
point or triangle."""

from __future__ import annotations

import os
import select
import threading
import weakref
from typing import Any, Callable, Generator, Iterable, List, Optional, Sequence, Union

from . import _address, _protocol as protocol
from ._commands import Commands
from ._protocol import LINE, ConnectionLost, Located, Neighbour, Progress, Refused, Reply, Request
from ._table import READS
from ._values import Word, seconds
from .mirror import Change, Mirror

__all__ = ["Client", "ConnectionLost", "Located", "Neighbour", "Pipeline", "Refused", "Reply"]

# Requests that are sent before their replies are read must fit into the buffers of sockets, because a server that cannot send
# its replies stops reading. Only a single request may be longer: the server reads all of it before it replies.
_AT_ONCE = 1000  # requests
_BYTES_AT_ONCE = 1 << 15
_PIECE = 1 << 20
# Requests that may be sent again when the connection was lost before they were answered.
_HARMLESS = READS | {b"PING", b"INFO"}


def _next_batch(requests: Sequence[Request], at: int) -> Sequence[Request]:
    """Those from requests[at] on that are sent together."""
    end, size = at, 0
    while end < len(requests) and end - at < _AT_ONCE:
        size += len(requests[end].line) + len(requests[end].body)
        if end > at and size > _BYTES_AT_ONCE:
            break
        end += 1
    return requests[at:end]


class _Connection:
    """A socket, and the bytes received from it."""

    def __init__(self, address: _address.Address, timeout: Optional[float]):
        self.pid = os.getpid()
        self.socket = _address.connect(address, timeout)
        self.input: Any = self.socket.makefile("rb", buffering=1 << 18)
        self.poll = select.poll()
        self.poll.register(self.socket, select.POLLIN)
        self.used = False  # a reply has come
        self.silent = False  # nothing has come since the last requests were sent

    def close(self) -> None:
        self.input.close()
        self.socket.close()

    def is_good(self) -> bool:
        """True if nothing unexpected has arrived, such as its end, and the connection is not one of the process we were forked from."""
        return self.pid == os.getpid() and not self.poll.poll(0)

    def send(self, requests: Sequence[Request]) -> None:
        self.silent = True
        lines: List[bytes] = []
        for line, body in requests:
            lines.append(line)
            if len(body) > 0:
                self.socket.sendall(b"".join(lines))
                lines.clear()
                for at in range(0, len(body), _PIECE):
                    self.socket.sendall(body[at : at + _PIECE])
        self.socket.sendall(b"".join(lines))

    def _read(self, size: int) -> Any:
        """This number of bytes, fewer at the end, in a writable buffer."""
        data = bytearray(size)
        got = self.input.readinto(data)
        return data if got == size else data[:got]

    def receive(self, progress: Optional[Progress]) -> Reply:
        reader: Generator[int, bytes, Reply] = protocol.read_reply(progress)
        want = next(reader)
        try:
            while True:
                data = self.input.readline() if want == LINE else self._read(want)
                self.silent = self.silent and len(data) == 0
                want = reader.send(data)
        except StopIteration as end:
            self.used = True
            reply: Reply = end.value
            return reply


class Client(Commands):
    """A connection to a daemon, which several threads may use: each request and its reply are one step, and other threads wait
    meanwhile. Threads that should not wait for each other's long requests have clients of their own.

    `url` is delaunay://[:token@]host[:port], unix://[:token@]/path (or the path alone), or private: for a daemon of this process
    alone. Without one, $DELAUNAY_URL; without that, localhost:6374, or the private daemon if no server listens there. repr() says which
    it is, and the logger "delaunayd" at level INFO when a private daemon is started: it loses its sets with this process.

    `timeout` is in seconds, for connecting and for each wait for the server; then TimeoutError is raised. None: no limit.

    After a lost connection the next request reconnects. A request whose reply did not arrive raises ConnectionLost; a change may or
    may not have been carried out. Requests that change nothing are repeated once instead."""

    def __init__(self, url: Optional[str] = None, timeout: Optional[float] = None):
        self._address = _address.parse(url)
        self._where = _address.describe(self._address, None)
        self._timeout = seconds(timeout)
        self._lock = threading.RLock()
        self._connection: Optional[_Connection] = None
        self._closed = False
        self._busy = False  # a request is under way
        self._sent = 0  # requests of send() whose replies are to be received
        _clients.add(self)
        self._connect()

    def close(self) -> None:
        """Closes the connection. Closing twice is allowed."""
        with self._lock:
            self._closed = True
            self._disconnect()

    def __enter__(self) -> "Client":
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def __del__(self) -> None:
        connection = getattr(self, "_connection", None)
        if connection is not None:
            connection.close()

    def __repr__(self) -> str:
        return "<delaunayd.Client of %s>" % self._where

    # ---- the connection; with the lock ----

    def _connect(self) -> None:
        self._connection = _Connection(self._address, self._timeout)
        self._where = _address.describe(self._address, self._connection.socket)
        if self._address.token:
            try:
                self._connection.send([protocol.request("AUTH", self._address.token)])
                self._connection.receive(None)
            except BaseException:
                self._disconnect()
                raise

    def _disconnect(self) -> None:
        connection, self._connection = self._connection, None
        for _ in range(self._sent):
            self._lock.release()
        self._sent = 0
        if connection is not None:
            connection.close()

    def _live(self) -> _Connection:
        """The connection; reconnects if it was lost."""
        if self._closed:
            raise ConnectionLost("the client is closed")
        if self._connection is not None and self._sent == 0 and not self._connection.is_good():
            self._disconnect()
        if self._connection is None:
            self._connect()
        assert self._connection is not None
        return self._connection

    def _receive(self, connection: _Connection, progress: Optional[Progress]) -> Union[Reply, Refused]:
        try:
            return connection.receive(progress)
        except Refused as refusal:
            if refusal.code == "TOOLONG":  # the server closes
                self._disconnect()
            return refusal

    def _exchange(self, requests: Sequence[Request], progress: Optional[Progress]) -> List[Union[Reply, Refused]]:
        """If it is interrupted, replies and requests would no longer match, so the connection is closed."""
        connection = self._live()
        try:
            try:
                connection.send(requests)
            except (BrokenPipeError, ConnectionResetError):
                pass  # what the server said before it closed may be there
            return [self._receive(connection, progress) for _ in requests]
        except ConnectionLost:
            self._disconnect()
            raise
        except ConnectionError as error:
            self._disconnect()
            raise ConnectionLost("the connection was lost") from error
        except BaseException:
            self._disconnect()
            raise

    def _exchange_again(self, requests: Sequence[Request], progress: Optional[Progress]) -> List[Union[Reply, Refused]]:
        """Reconnects if the connection ended between requests, provided that no request could be carried out twice."""
        connection = self._live()
        try:
            return self._exchange(requests, progress)
        except ConnectionLost:
            fresh_start = connection.used and connection.silent
            if not fresh_start or not all(r.line.split(None, 1)[0] in _HARMLESS for r in requests):
                raise
        return self._exchange(requests, progress)

    # ---- requests ----

    def _settle(self, requests: Sequence[Request], progress: Optional[Progress] = None) -> List[Union[Reply, Refused]]:
        """Replies and refusals, in the order of the requests."""
        replies: List[Union[Reply, Refused]] = []
        with self._lock:
            if self._busy or self._sent > 0:
                raise RuntimeError("the replies to earlier requests have not been received yet")
            self._busy = True
            try:
                while len(replies) < len(requests):
                    replies += self._exchange_again(_next_batch(requests, len(replies)), progress)
            finally:
                self._busy = False
        return replies

    def _run(
        self, requests: Sequence[Request], read: Callable[[Any], Any], progress: Optional[Progress] = None
    ) -> Any:
        replies = self._settle(requests, progress)
        for reply in replies:
            if isinstance(reply, Refused):
                raise reply
        return read(replies)

    def pipeline(self) -> "Pipeline":
        """Requests that are sent together: see Pipeline."""
        return Pipeline(self)

    def send(self, *words: Word) -> None:
        """Sends a request whose reply is to be received by receive(), in the order of requests. Until then other threads
        wait."""
        one = protocol.request(*words)
        self._lock.acquire()
        try:
            self._live().send([one])
            self._sent += 1
        except BaseException:
            self._disconnect()
            self._lock.release()
            raise

    def receive(self, progress: Optional[Progress] = None) -> Reply:
        """The reply to the oldest request of send() that has none yet. Raises Refused if it is ERR."""
        with self._lock:
            if self._sent == 0 or self._connection is None:
                raise RuntimeError("there is no request whose reply is to be received")
            try:
                reply = self._receive(self._connection, progress)
            except BaseException:
                self._disconnect()
                raise
            if self._sent > 0:
                self._sent -= 1
                self._lock.release()
        if isinstance(reply, Refused):
            raise reply
        return reply

    def mirror(
        self,
        name: str,
        fields: Iterable[str] = (),
        within: Optional[Sequence[float]] = None,
        timeout: Optional[float] = None,
        on_change: Optional[Callable[[Change], object]] = None,
    ) -> Mirror:
        """An object that follows a set of this server, over a connection of its own: see Mirror."""
        return Mirror(self._address, name, fields, within, timeout, on_change)


class Pipeline(Commands):
    """Requests that are sent together, without waiting for each other's replies:

        with client.pipeline() as p:
            p.add("t", 1, 2)
            p.nearest("t", 0, 0)
        first, near = p.results

    A method returns None; `results` has the return values in order after the `with`. Every request is carried out;
    then the first Refused is raised. Requests of other clients may be carried out in between."""

    def __init__(self, client: Client):
        self.results: List[Any] = []
        self._client = client
        self._requests: List[Request] = []
        self._reads: List[Any] = []

    def _run(
        self, requests: Sequence[Request], read: Callable[[Any], Any], progress: Optional[Progress] = None
    ) -> None:
        self._requests += requests
        self._reads.append((len(requests), read))

    def execute(self) -> List[Any]:
        """Sends the collected requests; returns the results, where a refused one is the exception Refused."""
        requests, reads = self._requests, self._reads
        self._requests, self._reads, self.results = [], [], []
        replies = self._client._settle(requests)
        at = 0
        for n, read in reads:
            part = replies[at : at + n]
            refused = [reply for reply in part if isinstance(reply, Refused)]
            self.results.append(refused[0] if refused else read(part))
            at += n
        return self.results

    def __enter__(self) -> "Pipeline":
        return self

    def __exit__(self, kind: Any, *_: object) -> None:
        if kind is not None:
            return
        for result in self.execute():
            if isinstance(result, Refused):
                raise result


_clients: "weakref.WeakSet[Client]" = weakref.WeakSet()


def _after_fork() -> None:
    """In the child another thread of the parent may have held the lock."""
    for client in list(_clients):
        client._lock = threading.RLock()
        client._busy = False
        client._sent = 0
        client._disconnect()


os.register_at_fork(after_in_child=_after_fork)
