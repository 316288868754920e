"""Requests and replies as bytes, without a connection (proto/PROTOCOL.md in the repository)."""

from __future__ import annotations

import re
import struct
from array import array
from itertools import accumulate
from numbers import Integral
from typing import TYPE_CHECKING, Any, Callable, Dict, Generator, Iterable, List, NamedTuple, Optional, Sequence, Tuple, TypeVar, Union

from ._values import Word, little, real, whole

try:
    import numpy
except ImportError:  # the standard library alone is enough
    numpy = None  # type: ignore[assignment]

if TYPE_CHECKING:
    from ._types import Floats, Numbers, Uint32s

Progress = Callable[[str], None]
Value = Union[bool, int, float, str]
_T = TypeVar("_T")

_SET_NAME = re.compile(r"[A-Za-z0-9_.:-]{1,64}\Z")
_ROW = re.compile(r"ERR [A-Z]+ (?:point|place|value) ([0-9]+): ")
LINE = -1  # what read_reply asks for: a line
_INTEGER = re.compile(r"-?[0-9]+\Z")
_FLOAT = re.compile(r"-?([0-9]+(\.[0-9]*)?(e[-+]?[0-9]+)?|inf|nan)\Z")


class Refused(Exception):
    """The server replied ERR. `code` is the error code, such as NOSET; the connection is still usable. `index`: which row of an array
    it is about, counted from 0 as ids are, where the server's sentence counts from 1; else None."""

    def __init__(self, line: str):
        found = _ROW.match(line)
        self.index = int(found.group(1)) - 1 if found is not None else None
        super().__init__(line if self.index is None else "%s (index %d)" % (line, self.index))
        self.line = line
        self.code = line.split(" ", 2)[1]

    def __reduce__(self) -> Any:
        return type(self), (self.line,)


class ConnectionLost(ConnectionError):
    """The connection ended before the reply was complete, or the bytes received are not a reply. The next request reconnects."""


class Reply(NamedTuple):
    """A raw reply: the words key=value of its first line, its rows, and the bytes of a binary reply."""

    keys: Dict[str, str]
    rows: List[str]
    data: bytes


class Request(NamedTuple):
    """A line, and the bytes that follow it."""

    line: bytes
    body: Any = b""


class Neighbour(NamedTuple):
    """A point and its distance from the place of the query."""

    id: int
    x: float
    y: float
    distance: float


class Field(NamedTuple):
    """The number of values of a field, and the least and the greatest of them; NaN if there are none."""

    values: int
    least: float
    most: float


class Cells(NamedTuple):
    """Voronoi cells: that of point ids[i] has the corners corners[offsets[i]:offsets[i + 1]], counterclockwise; they are clipped
    to the box (x0, y0, x1, y1). Without NumPy `corners` is a flat array x, y, x, y, ..."""

    ids: Uint32s
    offsets: Numbers
    corners: Floats
    box: Tuple[float, float, float, float]


class Contour(NamedTuple):
    """A contour line, shape (k, 2), with higher ground on its left; a closed one does not repeat its first place."""

    level: float
    closed: bool
    line: Floats


class Band(NamedTuple):
    """A polygon between two levels: an outer ring, counterclockwise, and its holes, clockwise, each of shape (k, 2) without its first
    place again. shapely.geometry.shape(band) and GeoPandas take it by its __geo_interface__."""

    low: float
    high: float
    rings: List[Floats]

    @property
    def __geo_interface__(self) -> Dict[str, Any]:
        rings = [list(map(tuple, _pairs(ring))) for ring in self.rings]
        return {"type": "Polygon", "coordinates": tuple(tuple(ring + ring[:1]) for ring in rings)}

    def path(self) -> Any:
        """A matplotlib.path.Path, for PathPatch or PathCollection."""
        from matplotlib.path import Path  # type: ignore[import]

        closed = [tuple(map(tuple, ring)) for ring in self.__geo_interface__["coordinates"]]
        codes = [code for ring in closed for code in [Path.MOVETO] + [Path.LINETO] * (len(ring) - 2) + [Path.CLOSEPOLY]]
        return Path([place for ring in closed for place in ring], codes)


class Loop(NamedTuple):
    """A closed loop of the boundary of a shape: ids with the shape on their left; those of a hole are clockwise."""

    hole: bool
    ids: List[int]


class Located(NamedTuple):
    """Where a place lies: `where` is inside, edge, vertex or outside; `ids` are the points of that triangle, edge or vertex."""

    where: str
    ids: Tuple[int, ...]


def _text(word: Word) -> str:
    if isinstance(word, str):
        return word
    return str(whole(word)) if isinstance(word, Integral) else repr(real(word))


def request(*words: Word, body: Any = b"") -> Request:
    """The request made of these words. Numbers are written so that reading them returns the same number."""
    line = " ".join(_text(w) for w in words)
    if "\n" in line or "\r" in line:
        raise ValueError("a line break in a request")
    return Request(line.encode() + b"\n", body)


def set_name(name: str) -> str:
    """Returns the name if it is valid for a set; the error is the server's. A name with a blank would be two words."""
    if not _SET_NAME.match(name):
        raise Refused("ERR SYNTAX a set's name is 1 to 64 of A-Z a-z 0-9 _ . : -")
    return name


def field_name(name: str) -> str:
    """The same for a field."""
    if not _SET_NAME.match(name) or name[0] in "0123456789.:-":
        raise Refused("ERR SYNTAX a field's name is a letter or _, then up to 63 of A-Z a-z 0-9 _ . : -")
    return name


def field_names(fields: Union[str, Iterable[str]]) -> List[str]:
    """The name of one field, or those of several."""
    return [field_name(fields)] if isinstance(fields, str) else [field_name(field) for field in fields]


def read_reply(progress: Optional[Progress] = None) -> Generator[int, bytes, Reply]:
    """Yields what it needs next, LINE or a number of bytes, and receives it. Returns the reply; raises Refused if it is ERR."""
    while True:
        status = decode_line((yield LINE))
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
    rows = []
    for _ in range(int(words[1])):
        rows.append(decode_line((yield LINE)))
    data = b""
    if words[1] == "0" and "bytes" in keys:
        data = yield int(keys["bytes"])
        if len(data) < int(keys["bytes"]):
            raise ConnectionLost("the connection was lost")
    return Reply(keys, rows, data)


def decode_line(line: bytes) -> str:
    if not line.endswith(b"\n"):
        raise ConnectionLost("the connection was lost")
    return line.rstrip(b"\r\n").decode()


class Asking:
    """How a method of a client asks: with requests to send, and a function that reads their replies."""

    def _run(
        self, requests: Sequence[Request], read: Callable[[Any], Any], progress: Optional[Progress] = None
    ) -> Any:
        """Sends the requests and returns read(list of replies). Raises the first Refused."""
        raise NotImplementedError

    def _ask(
        self, read: Callable[[Reply], _T], *words: Word, body: Any = b"", progress: Optional[Progress] = None
    ) -> _T:
        answer: _T = self._run([request(*words, body=body)], lambda replies: read(replies[0]), progress)
        return answer


# ---- results ----


def nothing(reply: Reply) -> None:
    """The reply says only that the request has been carried out."""


def fact(key: str, read: Callable[[str], _T]) -> Callable[[Reply], _T]:
    return lambda reply: read(reply.keys[key])


def fact_if_any(key: str, read: Callable[[str], _T]) -> Callable[[Reply], Optional[_T]]:
    return lambda reply: read(reply.keys[key]) if key in reply.keys else None


def numbers(reply: Reply) -> Dict[str, float]:
    return {key: float(text) for key, text in reply.keys.items()}


def simplified(reply: Reply) -> Dict[str, float]:
    """The facts of SIMPLIFY, without the version of the new set."""
    return {"points": int(reply.keys["points"]), "constraints": int(reply.keys["constraints"]), "error": float(reply.keys["error"])}


def truth(text: str) -> bool:
    return text in ("yes", "1")


def table(types: str) -> Callable[[Reply], List[Any]]:
    """The rows as tuples, each word of the type of its letter, the last one's for the rest: i, d, s; others have that of their form."""
    reads: List[Callable[[str], Any]] = [{"i": int, "d": float, "s": str}.get(letter, value) for letter in types]

    def row(text: str) -> Tuple[Any, ...]:
        words = text.split(" ")
        return tuple(read(word) for read, word in zip(reads + reads[-1:] * len(words), words))

    return lambda reply: [row(text) for text in reply.rows]


# ---- values ----


def value(text: str) -> Value:
    """A value of a reply: numbers as int or float, yes and no as bool, others as they are."""
    if _INTEGER.match(text):
        return int(text)
    if _FLOAT.match(text):
        return float(text)
    return text == "yes" if text in ("yes", "no") else text


def values(reply: Reply) -> Dict[str, Value]:
    return {key: value(text) for key, text in reply.keys.items()}


def uint32s(data: bytes, width: int) -> Any:
    """Little-endian words as rows of `width`: an array of shape (n, width), or a flat array.array without NumPy."""
    if numpy is not None:
        return numpy.frombuffer(data, dtype="<u4").reshape(-1, width)
    return little(array("I", bytes(data)))


def doubles(data: bytes, *shape: int) -> Any:
    """Little-endian doubles: an array of the shape (n, *shape), or a flat array.array without NumPy."""
    if numpy is not None:
        return numpy.frombuffer(data, dtype="<f8").reshape(-1, *shape)
    return little(array("d", bytes(data)))


def flat(table: Any) -> Any:
    """A table as a flat array, which it is already without NumPy."""
    return table.reshape(-1) if numpy is not None else table


def _cell_rows(data: bytes) -> List[int]:
    """Where the rows of VORONOI BINARY begin, in units of 8 bytes: id, k, then k times x, y."""
    rows: List[int] = []
    at, words = 0, little(array("I", bytes(data)))
    end, append = len(words), rows.append
    while at < end:
        append(at >> 1)
        at += 2 + 4 * words[at + 1]
    return rows


def cells(reply: "Reply") -> "Cells":
    """The rows of VORONOI BINARY."""
    x0, y0, x1, y1 = map(float, reply.keys["box"].split(","))
    if numpy is not None:
        units: Any = numpy.frombuffer(reply.data, dtype="<u8")
        starts = numpy.array(_cell_rows(reply.data), dtype="i8")
        sizes = numpy.zeros(len(starts) + 1, dtype="i8")
        sizes[1:] = units[starts] >> 32
        is_corner = numpy.ones(len(units), dtype=bool)
        is_corner[starts] = False
        corners: Any = numpy.frombuffer(reply.data, dtype="<f8")[is_corner].reshape(-1, 2)
        return Cells((units[starts] & 0xFFFFFFFF).astype("u4"), sizes.cumsum(), corners, (x0, y0, x1, y1))
    ids, offsets, found = array("I"), array("q", [0]), bytearray()
    for at in _cell_rows(reply.data):
        id, k = struct.unpack_from("<II", reply.data, 8 * at)
        found += reply.data[8 * at + 8 : 8 * at + 8 + 16 * k]
        ids.append(id)
        offsets.append(offsets[-1] + k)
    return Cells(ids, offsets, doubles(bytes(found), 2), (x0, y0, x1, y1))


def loops(reply: "Reply") -> List["Loop"]:
    """The rows of ALPHA."""
    split = (row.split(" ") for row in reply.rows)
    return [Loop(kind == "hole", [int(id) for id in ids]) for kind, _, *ids in split]


def radius_and_loops(reply: "Reply") -> Tuple[float, List["Loop"]]:
    """The reply to ALPHA set AUTO."""
    return float(reply.keys["radius"]), loops(reply)


def contours(reply: "Reply") -> List["Contour"]:
    found = []
    for row in reply.rows:
        level, kind, _, *xy = row.split(" ")
        found.append(Contour(float(level), kind == "closed", _line(xy)))
    return found


def bands(reply: "Reply") -> List["Band"]:
    found: List[Band] = []
    for row in reply.rows:
        low, high, number, _, _, *xy = row.split(" ")
        if int(number) == len(found):
            found.append(Band(float(low), float(high), []))
        found[-1].rings.append(_line(xy))
    return found


def _pairs(line: Any) -> Any:
    """The places of a line that _line has made."""
    return line.tolist() if hasattr(line, "shape") else zip(line[::2], line[1::2])


def _line(words: List[str]) -> Any:
    if numpy is not None:
        return numpy.array(words, dtype=float).reshape(-1, 2)
    return array("d", map(float, words))


def records(data: bytes, *widths: int) -> Tuple[Any, ...]:
    """Rows of an id and columns of doubles: the ids, and arrays of the shapes (n, width)."""
    if numpy is not None:
        form: List[Any] = [("id", "<u4"), *(("column %d" % k, "<f8", (width,)) for k, width in enumerate(widths))]
        table = numpy.frombuffer(data, dtype=form)
        return tuple(table[name].copy() for name, *_ in form)
    columns, ends = [array("I"), *(array("d") for _ in widths)], list(accumulate((8 * width for width in widths), initial=4))
    for at in range(0, len(data), ends[-1]):
        for found, first, end in zip(columns, [0, *ends], ends):
            found.frombytes(data[at + first : at + end])
    return tuple(map(little, columns))


def rings(data: bytes) -> Dict[int, Any]:
    """The rows of LISTS BINARY."""
    words = uint32s(data, 1)
    if numpy is not None:
        words = words.reshape(-1)
    found: Dict[int, Any] = {}
    at = 0
    while at < len(words):
        degree = int(words[at + 1])
        found[int(words[at])] = words[at + 2 : at + 2 + degree]
        at += 2 + degree
    return found


def located(reply: Reply) -> Located:
    ids = tuple(map(int, reply.rows[0].split())) if reply.rows else ()
    return Located(reply.keys["where"], ids)


def neighbours(reply: Reply) -> List[Neighbour]:
    return [Neighbour(*row) for row in table("iddd")(reply)]


def first_words(reply: Reply) -> List[int]:
    return [int(row.split(" ", 1)[0]) for row in reply.rows]
