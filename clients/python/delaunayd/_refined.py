"""Meshes to order: the points and segments of ConstrainedDelaunay.refine."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Optional, Tuple

from ._declared import segments_of
from ._library import Quality

if TYPE_CHECKING:
    from .spatial import ConstrainedDelaunay

_ANY = 0xFFFFFFFF  # DT_NONE
_EACH = 16  # points that may be added for each one


def _limit(value: Optional[float]) -> float:
    if value is not None and not value > 0:
        raise ValueError("limits are above 0")
    return 0.0 if value is None else float(value)


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
    most = _EACH * d.npoints if limit is None else int(limit)
    quality = Quality(_limit(angle), _limit(area), _limit(length), _ANY if number is None else number, keep, most, None, None)
    points, declared, counts = d._now.triangulation.refined(quality)
    return points, segments_of(declared), float(counts.angle), int(counts.unrefined)
