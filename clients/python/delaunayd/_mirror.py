"""The state of a set that is followed, made of the bytes that WATCH sends, without a connection (PROTOCOL.md, section 6.5)."""

from __future__ import annotations

import struct
from collections import deque
from typing import Any, Callable, Deque, Dict, Iterable, Iterator, List, NamedTuple, Optional, Sequence, Set, Tuple, Union

from . import _address, _protocol as protocol
from ._protocol import ConnectionLost, Refused, Request, field_names, set_name
from ._values import box, option, seconds

Triangle = Tuple[int, int, int]
RingOf = Callable[[int], Optional[bytes]]

PIECE = 1 << 18  # bytes to receive at once
FIRST_PAUSE, LAST_PAUSE = 0.02, 1.0  # seconds between attempts to connect
LATER = frozenset(("LOADING", "BUSY", "NOMEM"))  # errors after which a mirror tries again
_XY = 16  # bytes of coordinates; those of the values follow


class Constraint(NamedTuple):
    """A constraint, a < b. They sort as in CONSTRAINTS."""

    a: int
    b: int
    border: bool  # else a line
    number: int


class Change(NamedTuple):
    """What differs from the state before, ids and triangles ascending. A point that has moved may have kept its triangles; those are
    in neither list."""

    version: int
    added: List[int]
    moved: List[int]
    gone: List[int]
    valued: List[int]  # ids of points with another value of a followed field, but not of added ones
    triangles_added: List[Triangle]
    triangles_removed: List[Triangle]
    # sorted; of a part of a set (within) those that come to meet it or do not any more, and `added` also those whose ends have moved
    constraints_added: List[Constraint]
    constraints_released: List[Constraint]


# A ring is its ids as little-endian words, for a point on the hull followed by one byte: 24 bytes for six neighbours.


def _ring(words: Sequence[bytes], boundary: bool) -> bytes:
    ids = struct.pack("<%dI" % len(words), *map(int, words))
    return ids + b"b" if boundary else ids


def _is_boundary(ring: bytes) -> bool:
    return len(ring) % 4 == 1


def _ids(ring: bytes) -> Tuple[int, ...]:
    return struct.unpack_from("<%dI" % (len(ring) // 4), ring)


def _has_two(ring: Optional[bytes]) -> bool:
    """Whether it is that of a boundary point with two neighbours: of one triangle, or on the line that all points are on."""
    return ring is not None and len(ring) == 9


def _are_joined(a: int, b: int, ring_of: RingOf) -> bool:
    """Whether two neighbours of such a point are neighbours. Of a part of a set (within) both may be unknown; then they are taken to be."""
    one, other = ring_of(a), ring_of(b)
    if one is None or (other is not None and len(other) < len(one)):  # one of them may be that of a hub
        return other is None or a in _ids(other)
    return b in _ids(one)


def _star(id: int, ring: Optional[bytes], ring_of: RingOf) -> Iterator[Triangle]:
    """The triangles of a point, as in TRIANGLES; ring_of returns the ring of any point, None if it is unknown."""
    if ring is None:
        return
    ids = _ids(ring)
    if _has_two(ring) and not _are_joined(ids[0], ids[1], ring_of):
        return
    for k in range(1 if _is_boundary(ring) else 0, len(ids)):
        b, c = ids[k - 1], ids[k]
        yield (id, b, c) if id < b and id < c else (b, c, id) if b < c else (c, id, b)


def _has(triangle: Triangle, ring_of: RingOf) -> bool:
    """Whether a triangle of a part of a set is there; its known corner with the shortest ring tells."""
    known = [(len(ring), id) for id, ring in zip(triangle, map(ring_of, triangle)) if ring is not None]
    if not known:
        return False
    _, id = min(known)
    return triangle in _star(id, ring_of(id), ring_of)


class Mirror:
    """Points, rings and version of a set; what both kinds of mirrors have."""

    def __init__(
        self,
        url: Union[str, _address.Address, None],
        name: str,
        fields: Iterable[str] = (),
        within: Optional[Sequence[float]] = None,
        timeout: Optional[float] = None,
    ):
        self.name = set_name(name)
        self.fields = field_names(fields)
        self.within = None if within is None else tuple(box(within))
        self._address = url if isinstance(url, _address.Address) else _address.parse(url)
        self._timeout = seconds(timeout)
        self._closed = False
        self._pause = 0.0  # before the next attempt to connect
        self.version = 0
        self.dropped = False
        self._whole = False  # there has been a first state
        self._points: Dict[int, bytes] = {}  # coordinates and values
        self._rings: Dict[int, bytes] = {}
        self._constraints: Dict[Constraint, Tuple[float, ...]] = {}  # of a part of a set the places of its ends, else nothing
        self._lines: Deque[bytes] = deque()
        self._rest = b""
        self._begin_connection()

    # ---- what it knows ----

    def __len__(self) -> int:
        return len(self._points)

    def __contains__(self, id: int) -> bool:
        return id in self._points

    def point(self, id: int) -> Tuple[float, float]:
        """The coordinates of a point. KeyError: there is none of that id."""
        x, y = struct.unpack_from("<2d", self._points[id])
        return x, y

    def values(self, id: int) -> Tuple[float, ...]:
        """The values of the followed fields at a point, NaN where one is missing. KeyError: there is none of that id."""
        return struct.unpack_from("<%dd" % len(self.fields), self._points[id], _XY)

    def neighbors(self, id: int) -> List[int]:
        """The ring of a point, as in LISTS. KeyError: it has none, because it is an alias, or the set is not triangulated."""
        return list(_ids(self._rings[id]))

    def is_boundary(self, id: int) -> bool:
        """Whether a point is on the hull. KeyError as for neighbors."""
        return _is_boundary(self._rings[id])

    def points(self) -> Tuple[Any, ...]:
        """As Client.points: the ids, the coordinates, and with fields the values with shape (n, k). Cost: that of all points."""
        order = sorted(self._points)
        rows = b"".join(struct.pack("<I", id) + self._points[id] for id in order)
        table = protocol.records(rows, 2, len(self.fields))
        return table if self.fields else table[:2]

    def lists(self) -> Dict[int, Any]:
        """As Client.lists: every ring, in the order of LISTS. Cost: that of all points."""
        inner = sorted(id for id, ring in self._rings.items() if not _is_boundary(ring))
        return {id: protocol.flat(protocol.uint32s(self._rings[id][: len(self._rings[id]) & ~3], 1)) for id in inner + self.hull()}

    def hull(self) -> List[int]:
        """As Client.hull. Of a part of a set (within) the points on the hull, ascending. Cost: that of all points."""
        boundary = sorted(id for id, ring in self._rings.items() if _is_boundary(ring))
        if self.within is not None or len(boundary) < 2:
            return boundary
        ends = (id for id in boundary if len(self._rings[id]) < 8)  # of the line that all points are on
        at = next(ends, boundary[0])
        hull = [at]
        while len(hull) < len(boundary):
            at = _ids(self._rings[at])[0]
            hull.append(at)
        return hull

    def triangles(self) -> Any:
        """As Client.triangles: the corners, with shape (m, 3). Of a part of a set the triangles of its points; if all points of the set are
        on one line, a point of the part whose neighbours are outside counts as a triangle with them. Cost: that of all points."""
        whole = self.within is None
        found: Set[Triangle] = set()
        for id, ring in self._rings.items():
            found.update(t for t in _star(id, ring, self._rings.get) if not whole or t[0] == id)
        flat = [id for triangle in sorted(found) for id in triangle]
        return protocol.uint32s(struct.pack("<%dI" % len(flat), *flat), 3)

    def constraints(self) -> List[Constraint]:
        """The constraints, in the order of CONSTRAINTS; of a part of a set (within) those that meet it. Cost: that of sorting them."""
        return sorted(self._constraints)

    def ends(self, constraint: Constraint) -> Tuple[Tuple[float, float], Tuple[float, float]]:
        """The places of its ends, which may be outside of a part of a set. KeyError: there is no such constraint."""
        places = self._constraints[constraint]
        if not places:
            return self.point(constraint.a), self.point(constraint.b)
        return (places[0], places[1]), (places[2], places[3])

    # ---- the connection ----

    def _begin_connection(self) -> None:
        """What the connection before has sent without being complete is forgotten."""
        self._lines.clear()
        self._rest = b""
        self._rows = 0  # of the current event, that are still to come
        self._more = self._reset = False
        self._version = 0  # of the current event
        self._new_points: Dict[int, Optional[bytes]] = {}  # None: gone
        self._new_rings: Dict[int, Optional[bytes]] = {}
        self._new_constraints: Dict[Constraint, Optional[Tuple[float, ...]]] = {}  # None: released

    def _lengthen_pause(self) -> None:
        """An attempt to connect begins."""
        self._pause = min(LAST_PAUSE, max(FIRST_PAUSE, 2 * self._pause))

    def _has_begun(self) -> bool:
        """Whether the first state is in what has been received. Raises Refused if there will be none."""
        self._step()
        if self.dropped:
            raise Refused("ERR NOSET the set %s has been dropped" % self.name)
        return self._whole

    def _request(self) -> bytes:
        """What a new connection sends."""
        words: List[Any] = ["WATCH", self.name, *(["SINCE", self.version] if self._whole else []), *option("WITHIN", self.within, box)]
        if self.fields:
            words += ["FIELDS", ",".join(self.fields)]
        words.append("CONSTRAINTS")
        first: List[Request] = [protocol.request("AUTH", self._address.token)] if self._address.token else []
        return b"".join(request.line for request in [*first, protocol.request(*words)])

    def _receive(self, data: bytes) -> None:
        lines = (self._rest + data).split(b"\n")
        self._rest = lines.pop()
        self._lines += lines

    def _step(self) -> Optional[Change]:
        """The next change in what has been received; None also after the first state. Raises Refused; the set is dropped if there is
        none of that name any more."""
        while self._lines and not self.dropped:
            line = self._lines.popleft()
            if self._rows > 0:
                self._rows -= 1
                self._read_row(line.split(b" "))
            else:
                self._read_head(line.decode().split(" "))
            if self._rows == 0 and self._version > 0 and not self._more:
                first = not self._whole
                change = self._commit()
                if first or change is not None:
                    return change
        return None

    def _read_head(self, words: List[str]) -> None:
        if words[0] == "ERR":
            refusal = Refused(" ".join(words))
            if refusal.code != "NOSET" or not self._whole:
                raise refusal
            self.dropped = True
        elif words[0] == "EVENT":
            self.dropped = words[-1] == "dropped"
            self._rows = int(words[1])
            self._version = next((int(w[8:]) for w in words[3:] if w.startswith("version=")), 0)
            self._more = "more" in words[4:]
            if "reset" in words[4:]:
                self._reset = True
                self._new_points.clear()
                self._new_rings.clear()
                self._new_constraints.clear()
        elif words[0] != "OK":
            raise ConnectionLost("not an event of this protocol: " + " ".join(words)[:80])

    def _read_row(self, words: List[bytes]) -> None:
        id = int(words[1])
        if words[0] in (b"constraint", b"released"):
            constraint = Constraint(id, int(words[2]), words[3] == b"border", int(words[4]))
            self._new_constraints[constraint] = tuple(map(float, words[5:])) if words[0] == b"constraint" else None
            return
        if words[0] == b"list":
            self._new_rings[id] = _ring(words[3:], words[2] == b"b")
            return
        self._new_rings[id] = None
        if words[0] == b"point":
            self._new_points[id] = struct.pack("<%dd" % (len(words) - 2), *map(float, words[2:]))
        elif words[0] == b"gone":
            self._new_points[id] = None
        else:
            raise ConnectionLost("not a row of an event: " + repr(words)[:80])

    # ---- from one state to the next ----

    def _commit(self) -> Optional[Change]:
        """Applies the events that have come; returns what differs, if there has been a state before."""
        version, first, reset = self._version, not self._whole, self._reset
        points, rings, constraints = self._new_points, self._new_rings, self._new_constraints
        self._new_points, self._new_rings, self._new_constraints = {}, {}, {}
        self._reset, self._version, self._whole = False, 0, True
        silent = version == self.version and not points and not reset and not rings and not constraints
        self.version = version
        if reset and first:
            self._points = {id: point for id, point in points.items() if point is not None}
            self._rings = {id: ring for id, ring in rings.items() if ring is not None}
            self._constraints = {key: places for key, places in constraints.items() if places is not None}
            return None
        if reset:
            constraints = {**dict.fromkeys(self._constraints), **constraints}
            points = {**dict.fromkeys(self._points), **points}
            rings = {**dict.fromkeys(self._rings), **rings}
        change = Change(version, [], [], [], [], [], [], [], [])
        self._apply_points(points, change)
        self._apply_rings(rings, change)
        self._apply_constraints(constraints, change)
        for ids in (change.added, change.moved, change.gone, change.valued):
            ids.sort()
        for triangles in (change.triangles_added, change.triangles_removed):
            triangles.sort()
        change.constraints_added.sort()
        change.constraints_released.sort()
        return None if silent else change

    def _apply_points(self, points: Dict[int, Optional[bytes]], change: Change) -> None:
        for id, new in points.items():
            old = self._points.get(id)
            if new is None:
                if self._points.pop(id, None) is not None:
                    change.gone.append(id)
                continue
            self._points[id] = new
            if old is None:
                change.added.append(id)
                continue
            if old[:_XY] != new[:_XY]:
                change.moved.append(id)
            if old[_XY:] != new[_XY:]:
                change.valued.append(id)

    def _apply_constraints(self, constraints: Dict[Constraint, Optional[Tuple[float, ...]]], change: Change) -> None:
        for key, new in constraints.items():
            if new is None:
                if self._constraints.pop(key, None) is not None:
                    change.constraints_released.append(key)
            elif self._constraints.get(key) != new:
                change.constraints_added.append(key)
                self._constraints[key] = new

    def _apply_rings(self, rings: Dict[int, Optional[bytes]], change: Change) -> None:
        """The rings of all corners of a triangle that comes or goes change, but when points leave or join a line, a ring of two may be
        the same before and after."""
        old: Dict[int, Optional[bytes]] = {}
        for id, new in rings.items():
            ring = self._rings.get(id)
            if ring == new and not _has_two(ring):
                continue
            old[id] = ring
            if new is None:
                del self._rings[id]
            else:
                self._rings[id] = new

        def was(id: int) -> Optional[bytes]:
            return old[id] if id in old else self._rings.get(id)

        now = self._rings.get
        removed, added = change.triangles_removed, change.triangles_added
        for id, ring in old.items():
            before, after = set(_star(id, ring, was)), set(_star(id, now(id), now))
            if self.within is None:  # the first corner reports it
                removed.extend(t for t in before - after if t[0] == id)
                added.extend(t for t in after - before if t[0] == id)
            else:  # only some corners are known, and a triangle goes with the last of these
                removed.extend(t for t in before - after if not _has(t, now))
                added.extend(t for t in after - before if not _has(t, was))
        if self.within is not None:
            removed[:], added[:] = set(removed), set(added)
