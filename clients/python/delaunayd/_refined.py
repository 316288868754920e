"""Meshes to order: the points and segments of ConstrainedDelaunay.refine, and the points that simplify() keeps."""

from __future__ import annotations

import ctypes
from typing import TYPE_CHECKING, Any, Optional, Tuple

import numpy as np

from . import _library
from ._declared import checked_heights, checked_points, checked_segments, declare, segments_of
from ._library import Quality, TOOBIG, byref, check
from ._triangulation import Triangulation
from ._values import real, truth, whole

if TYPE_CHECKING:
    from ._types import ArrayLike, Numbers
    from .spatial import ConstrainedDelaunay

_ANY = 0xFFFFFFFF  # DT_NONE
_EACH = 16  # points that may be added for each one


def _limit(value: Optional[float]) -> float:
    if value is not None and not real(value) > 0:
        raise ValueError("limits are above 0")
    return 0.0 if value is None else real(value)


def refined(
    d: "ConstrainedDelaunay",
    angle: Optional[float],
    area: Optional[float],
    length: Optional[float],
    number: Optional[int],
    keep: bool,
    limit: Optional[int],
) -> Tuple[Any, Any, float, int]:
    """The points, the segments with their kinds and numbers, the least angle inside, and how many triangles are not as wanted."""
    if angle is None and area is None and length is None:
        angle = 25
    if angle is not None and angle >= 60:
        raise ValueError("no triangle has all angles above 60 degrees")
    most = _EACH * d.npoints if limit is None else whole(limit)
    quality = Quality(_limit(angle), _limit(area), _limit(length), _ANY if number is None else whole(number), truth("keep", keep), most, None, None)
    points, declared, counts = d._now.triangulation.refined(quality)
    return points, segments_of(declared), float(counts.angle), int(counts.unrefined)


def simplify(
    points: ArrayLike, values: ArrayLike, error: float = 0.0, *, most: Optional[int] = None, segments: Optional[ArrayLike] = None
) -> Numbers:
    """The numbers, ascending, of few of the points, such that the linear surface of their values is within `error` of the value at every
    point: those that SIMPLIFY keeps. `most`: at most so many, the most important ones. `segments`, pairs of points, are kept as by
    ConstrainedDelaunay. The first of coincident points counts; a value that is NaN does not. ValueError: Crossing, also if more than
    `most` points must stay."""
    library, found = _library.library(), _library.Thinned()
    if not 0 <= real(error) < np.inf:
        raise ValueError("error must be finite and not negative")
    if most is not None and whole(most) < 0:
        raise ValueError("most must be a number of points")
    places = checked_points(points)
    heights = checked_heights(values, len(places))
    declared = declare(checked_segments([] if segments is None else segments), False, 0)
    thinning = _library.Thinning(
        places.ctypes.data, heights.ctypes.data, len(places), declared.ctypes.data, len(declared), error,
        _ANY if most is None else min(whole(most), _ANY), None, None
    )
    try:
        status = library.dt_arrays_thin(byref(thinning), byref(found))
        if status == TOOBIG and found.least > 0:
            raise ValueError("%d points must stay: corners of the hull, ends of segments" % found.least)
        if status != 0:
            Triangulation(places, declared=declared)  # raises the error that names the points or segments
            check(status, "simplify")
        numbers = np.empty(found.n, dtype=np.uint32)
        if found.n > 0:
            ctypes.memmove(numbers.ctypes.data, found.kept, numbers.nbytes)
        return numbers.astype(np.int64)
    finally:
        library.dt_pages_release(found.kept)
