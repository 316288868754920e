"""The commands as methods, for every kind of client.

A method defines the requests to send and how to read their replies; `_run` of the client does the rest. In the clients
of `delaunayd.aio` each method returns an awaitable of the result described here.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Callable, Dict, Iterable, List, Mapping, Optional, Sequence, Tuple, Union

from . import _protocol as protocol
from ._constraints import ConstraintCommands
from ._protocol import Band, Cells, Contour, Field, Located, Loop, Neighbour, Progress, Reply, Value, field_name, field_names, set_name
from ._values import (
    Inside, Word, box as box_of, check_rows, column, each, flag, inside as inside_of, numbers_of, option, pairs, real,
    rows_with_fields, truth, whole, word,
)

if TYPE_CHECKING:
    from ._types import Floats, Uint32s

Fields = Union[str, Sequence[str]]


class Commands(ConstraintCommands):
    """The commands, one method each: those of the table, those about constraints, and here those that take or return more than
    words, such as arrays. `inside` of several: nothing outside the border of this number, or, if it is True, outside all borders."""

    def _ask_ids(self, width: int, *words: Word, body: Any = b"") -> Uint32s:
        """Ids in binary, in rows of `width`."""

        def read(reply: Reply) -> Uint32s:
            ids: Uint32s = protocol.uint32s(reply.data, width)
            return ids

        return self._ask(read, *words, body=body)

    def command(self, *words: Word, progress: Optional[Progress] = None) -> Reply:
        """Sends any request, given as words, and returns its raw reply. `progress` is called with the lines that report the progress
        of a long request."""
        return self._ask(lambda reply: reply, *words, progress=progress)

    def ping(self) -> None:
        """Returns if the server replies."""
        return self._ask(lambda _: None, "PING")

    def info(self, *sections: str) -> Dict[str, Value]:
        """Information about the server, all or that of the named sections."""
        return self._ask(_info, "INFO", *each(sections, word))

    # ---- sets ----

    def sets(self) -> List[str]:
        """The names of all sets, sorted."""
        return self._ask(lambda reply: [row.split(" ")[0] for row in reply.rows], "SETS")

    # ---- points ----

    def load(
        self, name: str, points: Any, fields: Optional[Mapping[str, Any]] = None, replace: bool = False
    ) -> int:
        """Adds points of shape (n, 2), all or none, to a set, which is created if necessary. Returns the id of the first one; the
        others follow it. `fields` maps names of fields to n values each, NaN where one is missing. Loading twice doubles the points.

        `replace`: the set is dropped first, as by drop(), so that it has these points alone, with ids from 0, and is not triangulated.
        What the server would refuse about the points is checked before; only if it lacks memory or disk is the set then gone."""
        data, n = rows_with_fields(points, fields) if fields else pairs(points)
        words: Tuple[Word, ...] = ("FIELDS", ",".join(map(field_name, fields))) if fields else ()
        requests = [protocol.request("LOADB", set_name(name), n, *words, body=data)]
        if truth("replace", replace):
            check_rows(data, 2 + len(fields or ()))
            # DROP needs a set, which LOADB of no points creates if there is none.
            requests[:0] = [protocol.request("LOADB", name, 0), protocol.request("DROP", name)]
        first: int = self._run(requests, lambda replies: int(replies[-1].keys["first"]))
        return first

    def add(self, name: str, x: float, y: float) -> int:
        """Adds a point; returns its id."""
        return self._ask(lambda reply: int(reply.keys["first"]), "ADD", set_name(name), real(x), real(y))

    def move(self, name: str, id: int, x: float, y: float) -> None:
        """Moves a point, which keeps its id."""
        return self._ask(protocol.nothing, "MOVE", set_name(name), whole(id), real(x), real(y))

    def get(self, name: str, ids: Iterable[int]) -> List[Tuple[float, float]]:
        """The coordinates of points."""
        return self._ask(_coordinates, "GET", set_name(name), *each(ids, whole))

    def points(self, name: str, fields: Optional[Fields] = None) -> Tuple[Any, ...]:
        """Every point, ascending: the ids, and the coordinates with shape (n, 2). With `fields`, names of fields, their values
        are the third, with shape (n, k), NaN where one is missing; all is of one state of the set."""
        if fields is None:
            return self._ask(lambda reply: protocol.records(reply.data, 2), "POINTS", set_name(name), "BINARY")
        names = field_names(fields)
        words = ("FIELDS", ",".join(names)) if names else ()
        return self._ask(lambda reply: protocol.records(reply.data, 2, len(names)), "POINTS", set_name(name), *words, "BINARY")

    def coincident(self, name: str) -> List[Tuple[int, int]]:
        """Every point that coincides with another one, and the point that represents both in the triangulation."""
        return self._ask(protocol.table("i"), "COINCIDENT", set_name(name))

    # ---- fields: values at points ----

    def fields(self, name: str) -> Dict[str, Field]:
        """The fields of a set."""
        return self._ask(_fields, "FIELDS", set_name(name))

    def get_field(self, name: str, field: str, ids: Iterable[int]) -> List[float]:
        """The values of points."""
        return self._ask(_second_words, "FGET", set_name(name), field_name(field), *each(ids, whole))

    def field(self, name: str, field: str) -> Tuple[Uint32s, Floats]:
        """The values of all points, of one state of the set: the ids, ascending, and the values, NaN where one is missing."""
        return self._ask(_ids_and_values(2, 1), "POINTS", set_name(name), "FIELDS", field_name(field), "BINARY")

    def set_field(self, name: str, field: str, values: Any, first: int = 0) -> None:
        """Sets the values of the ids first, first + 1, ..., all or none. NaN takes a value away. The field is created if need
        be."""
        data, n = column(values)
        return self._ask(lambda _: None, "FSETB", set_name(name), field_name(field), whole(first), n, body=data)

    # ---- the triangulation ----

    def triangulate(
        self, name: str, method: Optional[str] = None, progress: Optional[Progress] = None
    ) -> Dict[str, Value]:
        """Triangulates a set; the triangulation then follows every edit. Returns the counts of points, coincident points, triangles,
        edges and hull points, and ms, the time taken. `method` is auto, divide or shelling; the result is the same."""
        return self._ask(protocol.values, "TRIANGULATE", set_name(name), *option("METHOD", method, word), progress=progress)

    def triangles(self, name: str, within: Optional[Sequence[float]] = None, inside: Inside = None) -> Uint32s:
        """Every triangle, counterclockwise and in a canonical order: ids with shape (n, 3). `within`: those that meet the closed
        box (x0, y0, x1, y1). `inside`: those inside a border."""
        return self._ask_ids(3, "TRIANGLES", set_name(name), *option("WITHIN", within, box_of), *inside_of(inside), "BINARY")

    def edges(self, name: str, constrained: bool = False, inside: Inside = None) -> Uint32s:
        """Every edge a, b, with a < b, sorted: ids with shape (n, 2). `constrained`: those that are parts of constraints; `inside`: those
        with a border's inside on a side."""
        return self._ask_ids(2, "EDGES", set_name(name), *flag("CONSTRAINED", constrained), *inside_of(inside), "BINARY")

    def lists(self, name: str, within: Optional[Sequence[float]] = None) -> Dict[int, Uint32s]:
        """Each point's neighbours, counterclockwise; interior points come first, then the hull in its order. `within`: those of
        the points in the closed box (x0, y0, x1, y1)."""
        words = ("LISTS", set_name(name), *option("WITHIN", within, box_of), "BINARY")
        return self._ask(lambda reply: protocol.rings(reply.data), *words)

    def neighbors(self, name: str, id: int) -> List[int]:
        """The neighbours of one point, counterclockwise."""
        return self._ask(lambda reply: [int(i) for i in reply.rows[0].split()[1:]], "LISTS", set_name(name), whole(id))

    def hull(self, name: str) -> List[int]:
        """The points of the convex hull, counterclockwise."""
        return self._ask(protocol.first_words, "HULL", set_name(name))

    # ---- searches ----

    def locate(self, name: str, x: float, y: float) -> Located:
        """The triangle, edge or point at a place."""
        return self._ask(protocol.located, "LOCATE", set_name(name), real(x), real(y))

    def locate_all(self, name: str, places: Iterable[Sequence[float]]) -> List[Located]:
        """The same for many places at once."""
        set_name(name)
        requests = [protocol.request("LOCATE", name, real(x), real(y)) for x, y in places]
        found: List[Located] = self._run(requests, lambda replies: [protocol.located(reply) for reply in replies])
        return found

    def locate_triangles(self, name: str, places: Any) -> Uint32s:
        """The triangle of each place of shape (n, 2): ids with shape (n, 3), as in triangles(). Of several that meet at a place, the
        first of triangles(); outside three times 4294967295."""
        data, n = pairs(places)
        return self._ask_ids(3, "LOCATEB", set_name(name), n, body=data)

    def nearest_all(self, name: str, places: Any, k: int = 1) -> Uint32s:
        """The k points nearest to each place of shape (n, 2), nearest first: ids with shape (n, k), 4294967295 where there are
        too few points."""
        data, n = pairs(places)
        return self._ask_ids(k, "NEARESTB", set_name(name), n, whole(k), body=data)

    def nearest(self, name: str, x: float, y: float, k: int = 1) -> List[Neighbour]:
        """The k points nearest to a place, nearest first."""
        return self._ask(protocol.neighbours, "NEAREST", set_name(name), real(x), real(y), whole(k))

    # ---- surfaces ----

    def weights(self, name: str, x: float, y: float, method: str = "linear") -> Dict[int, float]:
        """The weights of the values at points around a place; `method` is linear, natural or laplace."""
        return self._ask(_weights, "WEIGHTS", set_name(name), real(x), real(y), "METHOD", word(method))

    def interpolate(
        self,
        name: str,
        field: Fields,
        places: Any,
        method: str = "linear",
        max_edge: Optional[float] = None,
        inside: Inside = None,
        outside: Optional[str] = None,
        missing: Optional[str] = None,
    ) -> Floats:
        """The values of a field at places of shape (n, 2), NaN where there are none; `method` is linear, natural, laplace,
        nearest or smooth. None in triangles with an edge longer than max_edge, and outside the border of `inside`. Outside the hull
        there are none, or with `outside` nearest those at the nearest place of the hull. With `missing` skip, as if points without a
        value had been deleted. Of several fields, a list, one search finds the values: shape (n, fields)."""
        data, n = pairs(places)
        words: Tuple[Word, ...] = ("INTERPOLATEB", set_name(name), ",".join(field_names(field)), n)
        return self._ask(_numbers(*_count(field)), *words, *_method(method, max_edge, inside, outside, missing), body=data)

    def gradient(
        self,
        name: str,
        field: Fields,
        places: Any,
        max_edge: Optional[float] = None,
        inside: Inside = None,
        missing: Optional[str] = None,
    ) -> Floats:
        """By how much a field grows at places of shape (n, 2), for a unit of x and of y: shape (n, 2), of several fields (n, fields,
        2); NaN where there is no surface. missing: as of interpolate()."""
        data, n = pairs(places)
        words: Tuple[Word, ...] = ("GRADIENTB", set_name(name), ",".join(field_names(field)), n)
        return self._ask(_numbers(*_count(field), 2), *words, *_surface(max_edge, inside, missing), body=data)

    def raster(
        self,
        name: str,
        field: Fields,
        box: Sequence[float],
        columns: int,
        rows: int,
        method: str = "linear",
        max_edge: Optional[float] = None,
        inside: Inside = None,
        outside: Optional[str] = None,
        clip: Optional[str] = None,
        quantity: Optional[str] = None,
        missing: Optional[str] = None,
    ) -> Floats:
        """The values at the centres of the cells of a box (x0, y0, x1, y1), shape (rows, columns), of several fields (rows, columns,
        fields), the northernmost row first; else as interpolate(). clip: the name of a set, inside whose borders alone there are values. With the
        quantity "slope" or "aspect", the slope or the direction downhill there, in degrees."""
        words: Tuple[Word, ...] = ("RASTER", set_name(name), ",".join(field_names(field)), *box_of(box), whole(columns), whole(rows))
        words += _method(method, max_edge, inside, outside, missing) + option("CLIP", clip, set_name) + option("AS", quantity, word)
        return self._ask(_numbers(whole(columns), *_count(field)), *words, "BINARY")

    def contours(
        self,
        name: str,
        field: str,
        levels: Optional[Iterable[float]] = None,
        every: Optional[float] = None,
        base: float = 0.0,
        max_edge: Optional[float] = None,
        inside: Inside = None,
        missing: Optional[str] = None,
    ) -> List[Contour]:
        """The contour lines of a field at levels, or at base and all multiples of `every` from it."""
        words = ("CONTOUR", set_name(name), field_name(field), *_levels(levels, every, base))
        return self._ask(protocol.contours, *words, *_surface(max_edge, inside, missing))

    def bands(
        self,
        name: str,
        field: str,
        levels: Optional[Iterable[float]] = None,
        every: Optional[float] = None,
        base: float = 0.0,
        max_edge: Optional[float] = None,
        inside: Inside = None,
        missing: Optional[str] = None,
    ) -> List[Band]:
        """The polygons between neighbouring levels: the lowest may be -inf, the highest inf. With `every`, levels at base and multiples of
        `every` from it, as many as cover the surface."""
        words = ("CONTOUR", set_name(name), field_name(field), *_levels(levels, every, base), "BANDS")
        return self._ask(protocol.bands, *words, *_surface(max_edge, inside, missing))

    def profile(
        self,
        name: str,
        field: str,
        places: Any,
        max_edge: Optional[float] = None,
        inside: Inside = None,
        missing: Optional[str] = None,
    ) -> Floats:
        """The surface of a field along straight pieces between places of shape (n, 2): rows `distance, x, y, value` of shape
        (rows, 4), for the places and for every edge and corner of the triangulation between them."""
        words: Tuple[Word, ...] = ("PROFILE", set_name(name), field_name(field), *numbers_of(pairs(places)[0]))
        return self._ask(_numbers(4), *words, *_surface(max_edge, inside, missing), "BINARY")

    def volume(
        self,
        name: str,
        field: str,
        level: Optional[float] = None,
        minus: Optional[str] = None,
        inside: Inside = None,
        box: Optional[Sequence[float]] = None,
        missing: Optional[str] = None,
    ) -> Dict[str, float]:
        """The volumes `above` and `below` between the surface of a field and a level, 0 unless given, or the surface of another
        field, `minus`; and the `area` of the triangles whose corners have values. Only what is inside borders, and in a box (x0, y0,
        x1, y1)."""
        words: Tuple[Word, ...] = ("VOLUME", set_name(name), field_name(field), *option("LEVEL", level, real), *option("MINUS", minus, field_name))
        return self._ask(protocol.numbers, *words, *inside_of(inside), *option("MISSING", missing, word), *option("BOX", box, box_of))

    def simplify(
        self, name: str, field: str, error: float, into: str, points: Optional[int] = None, ids: Optional[str] = None
    ) -> Dict[str, float]:
        """Makes the new set `into` of few points of the set, at most `points`: the linear surface of the field through them is within
        the error of every point. The field `ids` of the new set gets their ids in the set. Returns `points`, `constraints`
        and the `error` of the worst point."""
        words: Tuple[Word, ...] = ("SIMPLIFY", set_name(name), field_name(field), "ERROR", real(error))
        words += option("POINTS", points, whole) + option("IDS", ids, field_name)
        return self._ask(protocol.simplified, *words, "INTO", set_name(into))

    def voronoi(self, name: str, ids: Iterable[int] = (), box: Optional[Sequence[float]] = None) -> Cells:
        """The Voronoi cells of points, or of all, clipped to a box (x0, y0, x1, y1), or to the box around all points, grown by
        half of its longer side."""
        return self._ask(protocol.cells, "VORONOI", set_name(name), *each(ids, whole), *option("BOX", box, box_of), "BINARY")

    def areas(self, name: str, box: Optional[Sequence[float]] = None) -> Tuple[Uint32s, Floats]:
        """The areas of the cells of voronoi(): the ids, and the areas."""
        return self._ask(_ids_and_values(1), "AREAS", set_name(name), *option("BOX", box, box_of), "BINARY")

    def alpha(self, name: str, radius: float) -> List[Loop]:
        """The boundary of the alpha shape: of the union of the triangles whose circumradius is at most the radius."""
        return self._ask(protocol.loops, "ALPHA", set_name(name), real(radius))

    def alpha_auto(self, name: str) -> Tuple[float, List[Loop]]:
        """The least radius that gives one piece with all points, and the boundary of its alpha shape."""
        return self._ask(protocol.radius_and_loops, "ALPHA", set_name(name), "AUTO")

    def within(self, name: str, *where: float) -> List[int]:
        """The points in a closed box (x0, y0, x1, y1) or disc (x, y, r), by id."""
        return self._ask(protocol.first_words, "WITHIN", set_name(name), *each(where, real))


def _count(field: Fields) -> Tuple[int, ...]:
    """The axis of several fields."""
    return () if isinstance(field, str) else (len(field),)


def _numbers(*shape: int) -> Callable[[Reply], Floats]:
    """Reads numbers of the shape (n, *shape)."""

    def read(reply: Reply) -> Floats:
        rows: Floats = protocol.doubles(reply.data, *shape)
        return rows

    return read


def _surface(max_edge: Optional[float], inside: Inside, missing: Optional[str]) -> Tuple[Word, ...]:
    return option("MAXEDGE", max_edge, real) + inside_of(inside) + option("MISSING", missing, word)


def _method(
    method: str, max_edge: Optional[float], inside: Inside, outside: Optional[str], missing: Optional[str]
) -> Tuple[Word, ...]:
    return ("METHOD", word(method), *_surface(max_edge, inside, missing), *option("OUTSIDE", outside, word))


def _levels(levels: Optional[Iterable[float]], every: Optional[float], base: float) -> Tuple[Word, ...]:
    if (levels is None) == (every is None):
        raise ValueError("either levels or every")
    if levels is None:
        return ("EVERY", real(every), "BASE", real(base))
    if base != 0:
        raise ValueError("a base needs every")
    return tuple(each(levels, real))


def _ids_and_values(*widths: int) -> Callable[[Reply], Tuple[Uint32s, Floats]]:
    """Reads ids, and the last of several columns."""

    def read(reply: Reply) -> Tuple[Uint32s, Floats]:
        ids, *_, values = protocol.records(reply.data, *widths)
        return ids, protocol.flat(values)

    return read


def _fields(reply: Reply) -> Dict[str, Field]:
    return {name: Field(*facts) for name, *facts in protocol.table("sidd")(reply)}


def _weights(reply: Reply) -> Dict[int, float]:
    return dict(protocol.table("id")(reply))


def _second_words(reply: Reply) -> List[float]:
    return [value for _, value in protocol.table("id")(reply)]


def _info(reply: Reply) -> Dict[str, Value]:
    split = (row.split(":", 1) for row in reply.rows)
    return {key: protocol.value(text) for key, text in split}


def _coordinates(reply: Reply) -> List[Tuple[float, float]]:
    return [(x, y) for _, x, y in protocol.table("idd")(reply)]
