"""Checks of the arguments of methods. A value that could be read in two ways, or only in part, is an error. Examples are text that looks
like a number, True as a number, 1.5 as an id, a whole number that no double equals, and masked arrays. The package for Node has the same rules.
"""

from __future__ import annotations

import sys
from array import array
from decimal import Decimal
from numbers import Real
from typing import Any, Callable, Iterable, List, Mapping, Optional, Sequence, Tuple, TypeVar, Union

try:
    import numpy
except ImportError:  # the standard library alone is enough
    numpy = None  # type: ignore[assignment]

Word = Union[str, int, float]
Inside = Union[None, bool, int]
_T = TypeVar("_T")

LEAST, MOST = 2.0**-142, 2.0**201  # magnitudes of coordinates other than 0
_EXACT = 2**53  # whole numbers up to this one are doubles


def word(text: str) -> str:
    """A word of a request."""
    if not isinstance(text, str) or len(text.split()) != 1 or text != text.strip():
        raise TypeError("%r is not one word" % (text,))
    return text


# ---- numbers ----


def _scalar(value: Any) -> Any:
    """The value of Python in a scalar of NumPy, or in an array without axes; other values as they are."""
    return value.item() if getattr(value, "ndim", None) == 0 and not hasattr(value, "mask") else value


def _number(value: Any) -> Any:
    """A number of Python."""
    value = _scalar(value)
    if isinstance(value, bool) or not isinstance(value, (Real, Decimal)):
        raise TypeError("%r is not a number" % (value,))
    return value


def real(value: Any) -> float:
    """A number as a double, which may be NaN or infinite. Fractions are rounded once."""
    number = _number(value)
    if isinstance(number, int) and abs(number) > _EXACT and int(float(number)) != number:
        raise ValueError("no double equals %d" % number)
    return float(number)


def _known(value: Any) -> float:
    """A value of a point: NaN or None where it is missing."""
    return float("nan") if value is None else real(value)


def whole(value: Any) -> int:
    """A number without a fraction."""
    number = _number(value)
    if not isinstance(number, int) and number % 1 != 0:
        raise ValueError("%r is not a whole number" % (value,))
    return int(number)


def each(values: Iterable[Any], take: Callable[[Any], _T]) -> List[_T]:
    """Every value of a list or of another iterable, but not the letters of a text."""
    if isinstance(values, (str, bytes, bytearray, Mapping)):
        raise TypeError("%r is not a list" % (values,))
    return [take(value) for value in values]


def box(sides: Sequence[float]) -> List[float]:
    """A box (x0, y0, x1, y1)."""
    x0, y0, x1, y1 = each(sides, real)
    return [x0, y0, x1, y1]


def seconds(limit: Optional[float]) -> Optional[float]:
    """A limit of time; None: there is none."""
    if limit is None:
        return None
    if not 0 < real(limit) < float("inf"):
        raise ValueError("a timeout is a number of seconds above 0, or None")
    return real(limit)


# ---- what may be left out ----


def truth(name: str, value: Any) -> bool:
    """True or False; None counts as False."""
    if value is not None and (isinstance(value, (str, bytes, float)) or value not in (False, True)):
        raise TypeError("%s is True or False, not %r" % (name, value))
    return bool(value)


def flag(keyword: str, value: Any) -> Tuple[Word, ...]:
    """The keyword if the value is True."""
    return (keyword,) if truth(keyword.lower(), value) else ()


def option(keyword: Optional[str], value: Any, take: Callable[[Any], Any]) -> Tuple[Word, ...]:
    """The keyword, if there is one, and what `take` makes of the value, a word or several; nothing if the value is None."""
    if value is None:
        return ()
    taken = take(value)
    return (*([] if keyword is None else [keyword]), *(taken if isinstance(taken, (list, tuple)) else [taken]))


def inside(value: Inside) -> Tuple[Word, ...]:
    """Inside the border of a number, or, if it is True, inside any border."""
    value = _scalar(value)
    return flag("INSIDE", value) if isinstance(value, bool) else option("INSIDE", value, whole)


# ---- arrays ----


def little(numbers: array[Any]) -> array[Any]:
    """Numbers whose bytes become little-endian, or those of this machine again."""
    if sys.byteorder == "big":
        numbers.byteswap()
    return numbers


def plain(values: Any) -> Any:
    """An array of NumPy, also from iterables that NumPy does not read: generators, sets, maps."""
    if isinstance(values, numpy.ma.MaskedArray) and numpy.ma.is_masked(values):  # type: ignore[no-untyped-call]
        raise ValueError("an array with masked values: fill it, or leave them out")
    found: Any = numpy.asarray(values)
    unread = found.ndim == 0 and found.dtype.kind == "O" and hasattr(found[()], "__iter__")
    return numpy.asarray(each(found[()], _scalar)) if unread else found


def doubles(values: Any, dtype: str = "f8", take: Callable[[Any], float] = real) -> Any:
    """Numbers as a contiguous array of NumPy of doubles, in the order of bytes of `dtype`: the same memory if it is one. O(n)."""
    found: Any = plain(values)
    if found.dtype.kind == "O":
        return numpy.array([take(value) for value in found.ravel()], dtype).reshape(found.shape)
    if found.dtype.kind not in "fiu":
        raise TypeError("an array of %s has no numbers" % found.dtype)
    if found.dtype.kind in "iu" and found.itemsize == 8 and found.size > 0:
        for value in found[(found > _EXACT) | (found < -_EXACT)].tolist():
            real(value)
    return numpy.ascontiguousarray(found, dtype).reshape(found.shape)


def known(values: Any, dtype: str = "f8") -> Any:
    """The same of values of points: NaN or None where one is missing."""
    return doubles(values, dtype, _known)


def _bytes(numbers: Any) -> memoryview:
    return memoryview(numbers).cast("B") if len(numbers) > 0 else memoryview(b"")


def column(values: Any) -> Tuple[memoryview, int]:
    """Values of points as little-endian doubles, and how many."""
    if numpy is not None:
        a: Any = known(values, "<f8")
        if a.ndim != 1:
            raise ValueError("values must have the shape (n,)")
        return _bytes(a), len(a)
    flat = _flat(values, _known)
    return _bytes(little(flat)), len(flat)


def _flat(values: Any, take: Callable[[Any], float] = real) -> array[float]:
    """A copy of numbers, without NumPy."""
    return array("d", values if isinstance(values, array) and values.typecode in "fd" else each(values, take))


def _rows(values: Any, a: Any) -> Any:
    """An array of shape (n, 2), also where a flat array.array has pairs."""
    if a.size == 0:
        return a.reshape(0, 2)
    return a.reshape(-1, 2) if a.ndim == 1 and isinstance(values, array) and a.size % 2 == 0 else a


def pairs(points: Any) -> Tuple[memoryview, int]:
    """Points as little-endian doubles x, y, and their number."""
    if numpy is not None:
        a = _rows(points, doubles(points, "<f8"))
        if a.ndim != 2 or a.shape[1] != 2:
            raise ValueError("points must have the shape (n, 2)")
        return _bytes(a), len(a)
    flat = _flat(points if isinstance(points, array) else [v for x, y in each(points, tuple) for v in (x, y)])
    if len(flat) % 2 != 0:
        raise ValueError("odd number of coordinates")
    return _bytes(little(flat)), len(flat) // 2


def id_pairs(ends: Any) -> Tuple[memoryview, int]:
    """Pairs of ids as little-endian words, and their number."""
    if numpy is not None:
        a = _rows(ends, plain(ends))
        if a.ndim != 2 or a.shape[1] != 2 or (a.size > 0 and a.dtype.kind not in "iu"):
            raise ValueError("ends must have the shape (n, 2) and be ids")
        if a.size > 0 and not (a.min() >= 0 and a.max() < 2**32):
            raise ValueError("an id is a number from 0 to 2^32 - 1")
        return _bytes(numpy.ascontiguousarray(a, dtype="<u4")), len(a)
    flat = array("I", each(ends if isinstance(ends, array) else [i for a, b in each(ends, tuple) for i in (a, b)], whole))
    if len(flat) % 2 != 0:
        raise ValueError("ends must be pairs of ids")
    return _bytes(little(flat)), len(flat) // 2


def numbers_of(data: Any) -> List[float]:
    """Little-endian doubles as numbers of Python."""
    numbers: List[float] = little(array("d", bytes(data))).tolist()
    return numbers


def rows_with_fields(points: Any, fields: Mapping[str, Any]) -> Tuple[memoryview, int]:
    """Rows x, y and a value of each field, as little-endian doubles, and how many rows."""
    data, n = pairs(points)
    columns = [column(values) for values in fields.values()]
    for name, (_, many) in zip(fields, columns):
        if many != n:
            raise ValueError("%d values of %s for %d points" % (many, name, n))
    width = 2 + len(columns)
    if numpy is not None:
        table: Any = numpy.empty((n, width), dtype="<f8")
        table[:, :2] = numpy.frombuffer(data, dtype="<f8").reshape(-1, 2)
        for k, (values, _) in enumerate(columns):
            table[:, 2 + k] = numpy.frombuffer(values, dtype="<f8")
        return _bytes(table), n
    flat = array("d", bytes(8 * n * width))
    flat[0::width], flat[1::width] = array("d", bytes(data))[0::2], array("d", bytes(data))[1::2]
    for k, (values, _) in enumerate(columns):
        flat[2 + k :: width] = array("d", bytes(values))
    return _bytes(flat), n


def first_bad(points: Any) -> int:
    """The first row of an array of points that has a coordinate which no set takes; -1: there is none."""
    size = numpy.abs(points)
    bad = ~((size == 0) | ((size >= LEAST) & (size <= MOST))).all(axis=1)
    return int(bad.argmax()) if bad.any() else -1


def check_rows(data: memoryview, width: int) -> None:
    """Raises ValueError where the server would refuse a number of rows x, y, value ...: for requests that change something before."""
    for i, v in enumerate(numbers_of(data)):
        row, column = divmod(i, width)
        if column < 2 and not (v == 0 or LEAST <= abs(v) <= MOST):
            raise ValueError("points[%d]: a coordinate is 0 or has a magnitude from 2^-142 to 2^201, not %r" % (row, v))
        if abs(v) == float("inf"):
            raise ValueError("a value of points[%d] is infinite" % row)
