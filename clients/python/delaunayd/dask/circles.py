"""Which boxes the circles of triangles, and the half planes outside of hull edges, may meet. The answers are never too few.

The bound of circles, with u = 2^-52, twice the rounding error of one operation. All corners are relative to the first corner a:
1. b and c have relative errors of at most u / 2 per coordinate, because a difference of doubles is rounded once.
2. The centre relative to a is (cy bb - by cc, bx cc - cx bb) / d, with bb = b.b, cc = c.c, d = 2 (bx cy - by cx).
3. Each numerator differs from the exact one by at most 8 u (|cy| bb + |by| cc), and d by at most 8 u * 2 (|bx cy| + |by cx|): each product has
   at most five factors and operations with an error of u / 2 each, and the sum one more.
4. If the second error is at most |d| / 4, the quotient q differs from the exact one by at most 2 (e + |q| f) / |d| + u |q|, where e and f are
   the errors of the numerator and of d.
5. Otherwise nothing is known: the radius becomes infinite, and the circle meets every box.
6. The radius is at most |q| plus the errors of both coordinates; the centre is off by these, and by its sum with a: the disk around the computed
   centre with the radius |q| (1 + 8 u) + 2 (errors) + 4 u (|centre|) contains the circle.
7. Differences of coordinates are at least 2^-195 and products have at most four factors: nothing underflows or overflows.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Iterator, Tuple

import numpy as np

if TYPE_CHECKING:
    from .._types import Floats, Ints, NDArray, Numbers

_U = 2.0**-52
_BLOCK = 1 << 15  # triangles whose temporary arrays fit into a cache


def disks(a: Floats, b: Floats, c: Floats) -> Tuple[Floats, Floats, Floats]:
    """x, y and radius of a disk that contains the circle through each triple of places, of shape (n, 2)."""
    with np.errstate(all="ignore"):
        bx, by, cx, cy = b[:, 0] - a[:, 0], b[:, 1] - a[:, 1], c[:, 0] - a[:, 0], c[:, 1] - a[:, 1]
        bb, cc = bx * bx + by * by, cx * cx + cy * cy
        first, second = bx * cy, by * cx
        d: Any = 2 * (first - second)
        off = 16 * _U * (np.abs(first) + np.abs(second))
        size = np.abs(d)
        x, y = (cy * bb - by * cc) / d, (bx * cc - cx * bb) / d
        far = np.abs(x) + np.abs(y)
        error = 8 * _U * ((np.abs(cx) + np.abs(cy)) * bb + (np.abs(bx) + np.abs(by)) * cc)
        error = 2 * (error + far * off) / size + _U * far
        radius: Any = np.hypot(x, y) * (1 + 8 * _U) + 2 * error
        x, y = x + a[:, 0], y + a[:, 1]
        radius += 4 * _U * (np.abs(x) + np.abs(y))
        unsafe = ~((4 * off <= size) & (radius < np.inf))
    return np.where(unsafe, 0, x), np.where(unsafe, 0, y), np.where(unsafe, np.inf, radius)


def _meeting(disk: Tuple[Floats, Floats, Floats], box: Floats) -> NDArray[np.bool_]:
    x, y, radius = disk
    dx = np.maximum(np.maximum(box[0] - x, x - box[2]), 0)
    dy = np.maximum(np.maximum(box[1] - y, y - box[3]), 0)
    met: NDArray[np.bool_] = np.hypot(dx, dy) <= radius * (1 + 8 * _U)
    return met


def _disks_beyond(xy: Floats, triangles: Ints, own: Floats) -> Tuple[Numbers, Tuple[Floats, Floats, Floats]]:
    """The triangles whose disk leaves the box, and these disks. All other boxes are outside this one."""
    rows, found = [], []
    for start in range(0, len(triangles), _BLOCK):
        block = triangles[start : start + _BLOCK]
        x, y, radius = disks(xy[block[:, 0]], xy[block[:, 1]], xy[block[:, 2]])
        edge = radius * (1 + 8 * _U)
        inside = (x - edge > own[0]) & (x + edge < own[2]) & (y - edge > own[1]) & (y + edge < own[3])
        beyond = np.flatnonzero(~inside)
        rows.append(start + beyond)
        found.append((x[beyond], y[beyond], radius[beyond]))
    x, y, radius = (np.concatenate([np.empty(0), *column]) for column in zip(*found)) if found else (np.empty(0),) * 3
    return np.concatenate([np.empty(0, dtype=np.int64), *rows]), (x, y, radius)


def triangles_meeting(xy: Floats, triangles: Ints, boxes: Floats, me: int) -> Iterator[Tuple[int, Numbers]]:
    """For each box but the own one, `me`, the triangles whose circle may meet it. Boxes (t, 4) are x0, y0, x1, y1, nan for none."""
    rows, disk = _disks_beyond(xy, triangles, boxes[me])
    for tile, box in enumerate(boxes):
        if tile != me and len(rows) > 0 and not np.isnan(box[0]):
            met = _meeting(disk, box)
            if met.any():
                yield tile, rows[met]


def edges_meeting(a: Floats, b: Floats, boxes: Floats, me: int) -> Iterator[Tuple[int, Numbers]]:
    """For each box but the own one the edges to whose right, or on whose line, a place of it may be. Shapes (n, 2)."""
    d: Any = b - a
    for tile, box in enumerate(boxes):
        if tile == me or np.isnan(box[0]) or len(a) == 0:
            continue
        # The corner that is farthest to the right of the edge's direction.
        x = np.where(d[:, 1] > 0, box[2], box[0]) - a[:, 0]
        y = np.where(d[:, 0] > 0, box[1], box[3]) - a[:, 1]
        left, right = d[:, 0] * y, d[:, 1] * x
        met = np.flatnonzero(left - right <= 4 * _U * (np.abs(left) + np.abs(right)))
        if len(met) > 0:
            yield tile, met
