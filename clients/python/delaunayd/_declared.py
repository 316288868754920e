"""Constraints as the library takes them, and the error about two that cross."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Sequence, Tuple

import numpy as np

from ._values import doubles, known

if TYPE_CHECKING:
    from ._types import ArrayLike, Floats, Ints, NDArray
    from .geometries import Graph

# struct dt_constraint.
_CONSTRAINT = np.dtype({"names": ["a", "b", "border", "number"], "formats": ["<u4", "<u4", "?", "<u4"], "offsets": [0, 4, 8, 12], "itemsize": 16})


class Crossing(ValueError):
    """Two segments cross where no point is. `segments` has both: pairs of points."""

    def __init__(self, message: str, segments: Tuple[Tuple[int, int], Tuple[int, int]]):
        super().__init__(message)
        self.segments = segments

    def __reduce__(self) -> Any:
        return type(self), (self.args[0], self.segments)


def crossing(points: Floats, wrong: Sequence[int]) -> Crossing:
    """The error for the segments wrong[0], wrong[1] and wrong[2], wrong[3]."""
    a, b, c, d = map(int, wrong)
    places = " to ".join(str(tuple(points[i].tolist())) for i in (a, b)), " to ".join(str(tuple(points[i].tolist())) for i in (c, d))
    message = "segments [%d, %d] and [%d, %d] cross where no point is: from %s, and from %s" % (a, b, c, d, *places)
    return Crossing(message, ((a, b), (c, d)))


def named(error: Crossing, graph: Graph) -> Crossing:
    """The same error with the names of the parts."""
    one, other = (graph.part_of(ends[0]) for ends in error.segments)
    subject = "%s crosses itself" % one if one == other else "%s crosses %s" % (one, other)
    return Crossing("%s: %s" % (subject, error.args[0]), error.segments)


def checked_points(points: Any) -> Floats:
    """A copy of points of shape (n, 2), contiguous."""
    if isinstance(points, np.ma.MaskedArray):
        raise ValueError("Input points cannot be a masked array")
    checked: Floats = np.array(doubles(points))  # its own: tables are computed later
    if checked.ndim != 2 or checked.shape[1] != 2:
        raise ValueError("points must have the shape (n, 2): delaunayd knows the plane alone")
    if len(checked) == 0:
        raise ValueError("No points given")
    if not np.isfinite(checked).all():
        raise ValueError("Points cannot contain NaN or infinity")
    return checked


def checked_segments(segments: ArrayLike) -> Ints:
    """Segments of shape (m, 2), contiguous."""
    pairs = np.asarray(segments)
    if pairs.size == 0:
        pairs = np.empty((0, 2), dtype=np.int32)
    if pairs.ndim != 2 or pairs.shape[1] != 2 or not np.issubdtype(pairs.dtype, np.integer):
        raise ValueError("segments must have the shape (m, 2) and be numbers of points")
    if pairs.size > 0 and not (pairs.min() >= 0 and pairs.max() < 2**31):
        raise ValueError("segments must be numbers of points, from 0 on")
    return np.array(pairs, dtype=np.int32, order="C")


def checked_heights(z: ArrayLike, n: int) -> Floats:
    """Heights of n points, contiguous."""
    heights: Floats = np.array(known(z))
    if heights.shape != (n,):
        raise ValueError("z must have the shape (n,): one height for each point")
    if np.isinf(heights).any():
        raise ValueError("z cannot contain infinity")
    return heights


def segments_of(declared: NDArray[Any]) -> Tuple[Ints, NDArray[Any], Ints]:
    """The segments of constraints, whether they are borders, and their numbers."""
    segments = np.column_stack([declared["a"], declared["b"]]).astype(np.int32)
    return segments, declared["border"].copy(), declared["number"].astype(np.int32)


def declare(segments: Ints, border: Any, number: Any) -> NDArray[Any]:
    """The constraints along segments; `border` and `number` are those of all, or one for each."""
    numbers = np.asarray(number)
    if numbers.shape not in ((), (len(segments),)) or (numbers.size > 0 and numbers.dtype.kind not in "iu"):
        raise ValueError("number must be a whole number, or one for each segment")
    if numbers.size > 0 and not (numbers.min() >= 0 and numbers.max() < 2**31):
        raise ValueError("numbers are from 0 to 2^31 - 1")
    kinds = np.asarray(border)
    if kinds.shape not in ((), (len(segments),)) or (kinds.size > 0 and (kinds.dtype.kind not in "biu" or not np.isin(kinds, (0, 1)).all())):
        raise ValueError("border must be true or false, or that for each segment")
    declared = np.zeros(len(segments), dtype=_CONSTRAINT)
    declared["a"], declared["b"] = segments[:, 0], segments[:, 1]
    declared["border"], declared["number"] = kinds, numbers
    return declared
