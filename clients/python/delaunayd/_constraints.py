"""Constraints and regions as methods, for every kind of client."""

from __future__ import annotations

from typing import Any, Dict, Iterable, List, Mapping, NamedTuple, Optional, Sequence, Tuple

from . import _protocol as protocol
from ._protocol import Reply, Value, field_name, set_name
from ._table import Table
from ._values import Inside, Word, column, each, flag, id_pairs, inside as inside_of, numbers_of, option, pairs, real, truth, whole

_PLACES_A_LINE = 500  # 2 words of up to 25 bytes each; a line may have 65536 bytes


class Constraints(NamedTuple):
    """Constraints as arrays, in the order of CONSTRAINTS: the ids of the ends with shape (n, 2), whether each is a border (else a
    line), and the numbers. Without NumPy `ends` is a flat array a, b, a, b, ..."""

    ends: Any
    border: Any
    number: Any


class Region(NamedTuple):
    """What is inside a border: the number of its triangles and its area, both 0 unless the border is closed."""

    closed: bool
    triangles: int
    area: float


class Regions(NamedTuple):
    """The regions of a set by the number of their border, and the triangles and the area of everything that is inside at least one."""

    triangles: int
    area: float
    borders: Dict[int, Region]


class Quality(NamedTuple):
    """The shapes of triangles: their number and area, the least and the largest angle in degrees, the lengths of the shortest and the
    longest edge, and how many triangles have which least angle: counts[i] from 5 i to 5 (i + 1) degrees. Without triangles, angles and
    lengths are nan."""

    triangles: int
    area: float
    angle: float
    largest: float
    shortest: float
    longest: float
    counts: Tuple[int, ...]


class ConstraintCommands(Table):
    """The commands about constraints and regions. `border`: parts of borders instead of lines; `number`: of the line or polygon that
    a constraint belongs to, 0 at first."""

    def constrain(
        self, name: str, ends: Any, border: bool = False, number: int = 0, split: bool = False
    ) -> Dict[str, Value]:
        """Declares constraints between pairs of ids, shape (n, 2), all or none. Returns how many are new, `added`. With `split`,
        those that cross get points in common, and the result is `first`, `added` (points), `split` and `deviation`. Refused with the
        code CROSSES if two cross where no point is."""
        data, n = id_pairs(ends)
        words = (*_which(border, number), *flag("SPLIT", split), n)
        return self._ask(protocol.values, "CONSTRAINB", set_name(name), *words, body=data)

    def constrain_path(
        self,
        name: str,
        ids: Iterable[int],
        closed: bool = False,
        border: bool = False,
        number: int = 0,
        split: bool = False,
    ) -> Dict[str, Value]:
        """The same for the segments along a path of ids; `closed`: also from its last one to its first."""
        way, closed = each(ids, whole), truth("closed", closed)
        if len(way) < 2 + closed:
            raise ValueError("a path has at least two points, a closed one three")
        return self.constrain(name, list(zip(way, way[1:] + way[:closed])), border, number, split)

    def release(self, name: str, ends: Any, border: bool = False, number: int = 0) -> int:
        """Releases constraints, given as for constrain(), all or none; returns how many."""
        data, n = id_pairs(ends)
        return self._ask(_released, "RELEASEB", set_name(name), *_which(border, number), n, body=data)

    def release_all(self, name: str, number: Optional[int] = None, border: bool = False) -> int:
        """Releases all constraints, or all lines, or borders, of a number; returns how many."""
        if truth("border", border) and number is None:
            raise ValueError("border needs a number; without both, all constraints are released")
        words = ("ALL",) if number is None else (*flag("BORDER", border), "OF", whole(number))
        return self._ask(_released, "RELEASE", set_name(name), *words)

    def refine(
        self,
        name: str,
        angle: Optional[float] = None,
        area: Optional[float] = None,
        length: Optional[float] = None,
        inside: Inside = None,
        keep: bool = False,
        limit: Optional[int] = None,
    ) -> Dict[str, Value]:
        """Adds points until no triangle inside borders, or inside border `inside`, has an angle below `angle` degrees (25 without any limit), an
        area above `area`, or an edge longer than `length`; in a set without borders the hull becomes one. `keep`: constraints
        are not divided; `limit`: points that may be added, 16 for each one by default. Returns `first`, `added`, `split`, the least
        `angle`, how many triangles are `unrefined`, and how many edges of the `hull` became border 0."""
        words: Tuple[Word, ...] = option("ANGLE", angle, real) + option("AREA", area, real) + option("LENGTH", length, real)
        words += option("LIMIT", limit, whole) + inside_of(inside) + flag("KEEP", keep)
        return self._ask(protocol.values, "REFINE", set_name(name), *words)

    def constraints(self, name: str, ids: Iterable[int] = (), number: Optional[int] = None) -> Constraints:
        """All constraints, those that end at one of some ids, or those of a number."""
        which, of = each(ids, whole), option("OF", number, whole)
        if which and of:
            raise ValueError("either ids or a number")
        return self._ask(_constraints, "CONSTRAINTS", set_name(name), *which, *of, "BINARY")

    def regions(self, name: str) -> Regions:
        """What the borders of a set enclose."""
        return self._ask(_regions, "REGIONS", set_name(name))

    def quality(self, name: str, inside: Inside = None) -> Quality:
        """The angles of the triangles: of all, of those inside any border, or inside that of a number."""
        return self._ask(_quality, "QUALITY", set_name(name), *inside_of(inside))

    def regions_at(self, name: str, places: Any) -> List[Tuple[int, ...]]:
        """The numbers of the borders that contain each place of shape (n, 2), ascending; a place on the edge of a region belongs to it."""
        flat, step = numbers_of(pairs(places)[0]), 2 * _PLACES_A_LINE
        set_name(name)
        requests = [protocol.request("REGIONS", name, "AT", *flat[at : at + step]) for at in range(0, len(flat), step)]
        found: List[Tuple[int, ...]] = self._run(requests, _regions_of_places)
        return found

    def load_paths(
        self,
        name: str,
        paths: Iterable[Any],
        border: bool = False,
        number: int = 0,
        split: bool = False,
        fields: Optional[Mapping[str, Sequence[Any]]] = None,
    ) -> Dict[str, Value]:
        """Adds the points of paths, of shape (k, 2) each, and the constraints along them, as one change, all or nothing. A path whose
        last place equals its first is closed. The first path gets `number`, the others the numbers after it. `fields` maps names
        of fields to the values of the points: one sequence for each path. Returns `first`, `added`, `coincident` and `constraints`, with
        `split` also `split` and `deviation`. Paths that cross are named by lines: path by path, one line before each and one for
        each point."""
        names = [field_name(field) for field in fields or ()]
        lines = _lines(list(paths), list((fields or {}).values()))
        words: Tuple[Word, ...] = ("LOAD", set_name(name), len(lines), "PATHS", *_which(border, number), *flag("SPLIT", split))
        if names:
            words += ("FIELDS", ",".join(names))
        return self._ask(protocol.values, *words, body="".join(lines).encode())


def _which(border: bool, number: int) -> Tuple[Word, ...]:
    return (*flag("BORDER", border), "OF", whole(number))


def _released(reply: Reply) -> int:
    return int(reply.keys["released"])


def _constraints(reply: Reply) -> Constraints:
    words = protocol.uint32s(reply.data, 3)
    if hasattr(words, "reshape"):
        return Constraints(words[:, :2].copy(), words[:, 2] % 2 == 1, words[:, 2] >> 1)
    ends = type(words)("I", [v for i, v in enumerate(words) if i % 3 < 2])
    return Constraints(ends, [bool(v & 1) for v in words[2::3]], type(words)("I", [v >> 1 for v in words[2::3]]))


def _regions(reply: Reply) -> Regions:
    borders = {}
    for number, state, triangles, area in map(str.split, reply.rows):
        borders[int(number)] = Region(state == "closed", int(triangles), float(area))
    return Regions(int(reply.keys["inside"]), float(reply.keys["area"]), borders)


def _quality(reply: Reply) -> Quality:
    area, angle, largest, shortest, longest = (float(reply.keys[key]) for key in Quality._fields[1:-1])
    counts = tuple(int(row.split()[2]) for row in reply.rows)
    return Quality(int(reply.keys["triangles"]), area, angle, largest, shortest, longest, counts)


def _regions_of_places(replies: Sequence[Reply]) -> List[Tuple[int, ...]]:
    return [tuple(map(int, row.split()[1:])) for reply in replies for row in reply.rows]


def _lines(paths: Sequence[Any], columns: Sequence[Sequence[Any]]) -> List[str]:
    """The lines of LOAD PATHS."""
    for of in columns:
        if len(of) != len(paths):
            raise ValueError("values of %d paths for %d" % (len(of), len(paths)))
    lines = []
    for i, path in enumerate(paths):
        lines.append(">\n")
        flat = numbers_of(pairs(path)[0])
        values = [numbers_of(column(of[i])[0]) for of in columns]
        for those in values:
            if 2 * len(those) != len(flat):
                raise ValueError("%d values for %d points of path %d" % (len(those), len(flat) // 2, i))
        for row in zip(flat[0::2], flat[1::2], *values):
            lines.append(" ".join(map(repr, row)) + "\n")
    return lines
