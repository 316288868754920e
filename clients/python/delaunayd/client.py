"""The connection: requests in lines, replies read part by part, large tables in binary form.

Tables come as NumPy arrays if NumPy is there, else as array.array; no Python object is made for a
single point or triangle.
"""

from __future__ import annotations

import os
import socket
import sys
from array import array
from typing import Any, Callable, Dict, Iterable, List, NamedTuple, Optional, Sequence, Tuple, Union
from urllib.parse import urlsplit

try:
    import numpy
except ImportError:  # the standard library alone will do
    numpy = None  # type: ignore[assignment]

DEFAULT_URL = "delaunay://localhost:6374"
_PIECE = 1 << 20

Progress = Callable[[str], None]
Word = Union[str, int, float]


class Refused(Exception):
    """The server answered ERR; `code` is its code, the connection goes on."""

    def __init__(self, line: str):
        super().__init__(line)
        self.code = line.split(" ", 2)[1]


class ConnectionLost(ConnectionError):
    """The connection ended before the reply did, or what came is no reply."""


class Reply(NamedTuple):
    keys: Dict[str, str]
    rows: List[str]
    data: bytes  # of a binary reply


class Neighbour(NamedTuple):
    id: int
    x: float
    y: float
    distance: float


class Located(NamedTuple):
    where: str  # inside, edge, vertex, outside
    ids: Tuple[int, ...]


def _number(word: Word) -> str:
    return repr(float(word)) if isinstance(word, float) else str(word)


def _uint32s(data: bytes, width: int) -> Any:
    """Little-endian words as rows of `width`: an array of shape (n, width), or a flat array.array."""
    if numpy is not None:
        return numpy.frombuffer(data, dtype="<u4").reshape(-1, width)
    words = array("I")
    words.frombytes(data)
    if sys.byteorder == "big":
        words.byteswap()
    return words


def _pairs(points: Any) -> Tuple[memoryview, int]:
    """Points as little-endian doubles x, y, and their number."""
    if numpy is not None:
        a = numpy.ascontiguousarray(points, dtype="<f8")
        if a.size == 0:
            a = a.reshape(0, 2)
        if a.ndim != 2 or a.shape[1] != 2:
            raise ValueError("points must have the shape (n, 2)")
        return memoryview(a).cast("B") if a.size else memoryview(b""), len(a)
    if isinstance(points, array) and points.typecode == "d":
        flat = array("d", points)
    else:
        flat = array("d")
        for x, y in points:
            flat.append(x)
            flat.append(y)
    if len(flat) % 2 != 0:
        raise ValueError("an x without its y")
    if sys.byteorder == "big":
        flat.byteswap()
    return memoryview(flat).cast("B"), len(flat) // 2


class Client:
    """A connection to a daemon. Not for two threads at once."""

    def __init__(self, url: Optional[str] = None, timeout: Optional[float] = None):
        parts = urlsplit(url or os.environ.get("DELAUNAY_URL") or DEFAULT_URL)
        if parts.scheme != "delaunay" or not parts.hostname:
            raise ValueError("a URL is delaunay://[:token@]host[:port]")
        self._socket = socket.create_connection((parts.hostname, parts.port or 6374), timeout)
        self._socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        self._in = self._socket.makefile("rb", buffering=1 << 18)
        if parts.password:
            try:
                self.command("AUTH", parts.password)
            except BaseException:
                self.close()
                raise

    def close(self) -> None:
        self._in.close()
        self._socket.close()

    def __enter__(self) -> "Client":
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    # ---- any request ----

    def send(self, *words: Word) -> None:
        """Sends a request; its reply is to be received, in the order of requests."""
        line = " ".join(_number(w) for w in words)
        if "\n" in line or "\r" in line:
            raise ValueError("a line break in a request")
        self._socket.sendall(line.encode() + b"\n")

    def receive(self, progress: Optional[Progress] = None) -> Reply:
        """Reads the oldest reply that has not been read. Raises Refused if it is ERR."""
        while True:
            status = self._line()
            if not status.startswith("#"):
                break
            if progress is not None:
                progress(status[1:].strip())
        if status.startswith("ERR "):
            raise Refused(status)
        words = status.split(" ")
        if words[0] != "OK" or len(words) < 2 or not words[1].isdigit():
            raise ConnectionLost("not a reply of this protocol: " + status[:80])
        keys = dict(w.split("=", 1) for w in words[2:] if "=" in w)
        rows = [self._line() for _ in range(int(words[1]))]
        data = b""
        if words[1] == "0" and "bytes" in keys:
            size = int(keys["bytes"])
            data = self._in.read(size)
            if len(data) < size:
                raise ConnectionLost("the connection was lost")
        return Reply(keys, rows, data)

    def command(self, *words: Word, progress: Optional[Progress] = None) -> Reply:
        self.send(*words)
        return self.receive(progress)

    def _line(self) -> str:
        line = self._in.readline()
        if not line.endswith(b"\n"):
            raise ConnectionLost("the connection was lost")
        return line.rstrip(b"\r\n").decode()

    # ---- sets ----

    def sets(self) -> List[str]:
        return [row.split(" ")[0] for row in self.command("SETS").rows]

    def create(self, name: str, tolerance: float = 0.0) -> None:
        self.command("CREATE", name, "TOL", tolerance)

    def drop(self, name: str) -> None:
        self.command("DROP", name)

    def stat(self, name: str) -> Dict[str, str]:
        return self.command("STAT", name).keys

    # ---- points ----

    def load(self, name: str, points: Any) -> int:
        """Adds points of shape (n, 2), all or none; the first one's id."""
        data, n = _pairs(points)
        self.send("LOADB", name, n)
        for at in range(0, len(data), _PIECE):
            self._socket.sendall(data[at : at + _PIECE])
        return int(self.receive().keys["first"])

    def add(self, name: str, x: float, y: float) -> int:
        return int(self.command("ADD", name, float(x), float(y)).keys["first"])

    def delete(self, name: str, ids: Iterable[int]) -> int:
        return int(self.command("DEL", name, *(int(i) for i in ids)).keys["deleted"])

    def move(self, name: str, id: int, x: float, y: float) -> None:
        self.command("MOVE", name, int(id), float(x), float(y))

    def points(self, name: str) -> Tuple[Any, Any]:
        """Every point: the ids, and the coordinates with shape (n, 2)."""
        data = self.command("POINTS", name, "BINARY").data
        if numpy is not None:
            table = numpy.frombuffer(data, dtype=[("id", "<u4"), ("xy", "<f8", 2)])
            return table["id"].copy(), table["xy"].copy()
        ids, xy = array("I"), array("d")
        for at in range(0, len(data), 20):
            ids.frombytes(data[at : at + 4])
            xy.frombytes(data[at + 4 : at + 20])
        if sys.byteorder == "big":
            ids.byteswap()
            xy.byteswap()
        return ids, xy

    def coincident(self, name: str) -> List[Tuple[int, int]]:
        """Every alias and its representative."""
        rows = self.command("COINCIDENT", name).rows
        return [(int(a), int(b)) for a, b in (row.split(" ") for row in rows)]

    # ---- the triangulation ----

    def triangulate(
        self, name: str, method: Optional[str] = None, progress: Optional[Progress] = None
    ) -> Dict[str, str]:
        words: Sequence[str] = ("METHOD", method) if method is not None else ()
        return self.command("TRIANGULATE", name, *words, progress=progress).keys

    def check(self, name: str) -> Dict[str, str]:
        return self.command("CHECK", name).keys

    def triangles(self, name: str) -> Any:
        """Every triangle, counterclockwise: ids with shape (n, 3)."""
        return _uint32s(self.command("TRIANGLES", name, "BINARY").data, 3)

    def edges(self, name: str) -> Any:
        """Every edge, a < b: ids with shape (n, 2)."""
        return _uint32s(self.command("EDGES", name, "BINARY").data, 2)

    def lists(self, name: str) -> Dict[int, Any]:
        """Each point's ring of neighbours, counterclockwise, in the order of LISTS: interior points
        first, then along the hull."""
        words = _uint32s(self.command("LISTS", name, "BINARY").data, 1)
        if numpy is not None:
            words = words.reshape(-1)
        rings: Dict[int, Any] = {}
        at = 0
        while at < len(words):
            degree = int(words[at + 1])
            rings[int(words[at])] = words[at + 2 : at + 2 + degree]
            at += 2 + degree
        return rings

    def hull(self, name: str) -> List[int]:
        return [int(row.split(" ", 1)[0]) for row in self.command("HULL", name).rows]

    def locate(self, name: str, x: float, y: float) -> Located:
        return _located(self.command("LOCATE", name, float(x), float(y)))

    def locate_all(self, name: str, places: Iterable[Sequence[float]]) -> List[Located]:
        """The same for many places, pipelined."""
        found: List[Located] = []
        batch: List[str] = []
        for x, y in places:
            batch.append("LOCATE %s %r %r\n" % (name, float(x), float(y)))
            if len(batch) == 1000:
                found += self._flush(batch)
        return found + self._flush(batch)

    def _flush(self, batch: List[str]) -> List[Located]:
        self._socket.sendall("".join(batch).encode())
        replies = [self._settle() for _ in batch]
        batch.clear()
        for reply in replies:
            if isinstance(reply, Refused):
                raise reply
        return [_located(reply) for reply in replies if isinstance(reply, Reply)]

    def _settle(self) -> Union[Reply, Refused]:
        try:
            return self.receive()
        except Refused as refusal:
            return refusal

    def nearest(self, name: str, x: float, y: float, k: int = 1) -> List[Neighbour]:
        rows = self.command("NEAREST", name, float(x), float(y), k).rows
        return [Neighbour(int(i), float(a), float(b), float(d)) for i, a, b, d in map(str.split, rows)]

    def within(self, name: str, *where: float) -> List[int]:
        """The points in a box (x0, y0, x1, y1) or a disc (x, y, r)."""
        rows = self.command("WITHIN", name, *(float(v) for v in where)).rows
        return [int(row.split(" ", 1)[0]) for row in rows]

    def info(self) -> Dict[str, str]:
        return dict(row.split(":", 1) for row in self.command("INFO").rows)


def _located(reply: Reply) -> Located:
    ids = tuple(map(int, reply.rows[0].split())) if reply.rows else ()
    return Located(reply.keys["where"], ids)
