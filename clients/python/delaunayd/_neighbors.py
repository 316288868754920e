"""Which triangles are next to each other, from the triangles alone.

The daemon sends triangles sorted, each from its smallest corner: rows a, b, c with a < b, c, and those with the same a follow one
another. That finds most pairs without sorting or searching:

         c_i = b_j                    Near edges are those at a row's own a. Two rows of the same a that share one are a few
        /    |    \\                   rows apart. The far edge b-c of a row may be a near edge of another row, one of the few
      b_i --- a --- c_j              whose smallest corner is the lower of b and c. Only pairs of far edges are sorted.
"""

from __future__ import annotations

from typing import Any

import numpy as np

_STEPS = 16  # rows to examine before an edge is left to the sort


def _pair_rows_of_a_corner(a: Any, b: Any, c: Any, out: Any) -> None:
    """Near edges that two rows of the same a share."""
    i = np.flatnonzero(a[:-1] == a[1:]).astype(np.int32)
    for step in range(1, _STEPS):
        j = i + step
        met = np.flatnonzero(b[i] == c[j])
        out[i[met], 2], out[j[met], 1] = j[met], i[met]
        met = np.flatnonzero(c[i] == b[j])
        out[i[met], 1], out[j[met], 2] = j[met], i[met]
        i = i[i + (step + 1) < len(a)]
        i = i[a[i] == a[i + (step + 1)]]
        if len(i) == 0:
            return


def _near_left(b: Any, c: Any, out: Any) -> Any:
    """The near edges without a neighbour yet: their rows, upper ends and places in out."""
    near = np.flatnonzero(out[:, 1:].ravel() < 0).astype(np.int32)  # 2 * row, + 0: the edge c-a, + 1: a-b
    row, side = near >> 1, near & 1
    return row, np.where(side, b[row], c[row]), 3 * row + 1 + side


def _pair_far_with_near(a: Any, b: Any, c: Any, low: Any, high: Any, out: Any, points: int) -> None:
    """Far edges low-high that are near edges of another row."""
    row, upper, slot = _near_left(b, c, out)
    upper = np.append(upper, np.int32(-1))
    start = np.zeros(points + 1, dtype=np.int32)
    np.cumsum(np.bincount(a[row], minlength=points), out=start[1:])
    at, end = start[low], start[low + 1]
    far = np.flatnonzero(at < end).astype(np.int32)
    at, end, want = at[far], end[far], high[far]
    flat = out.reshape(-1)
    for _ in range(_STEPS):
        hit = upper[at] == want
        met = np.flatnonzero(hit)
        mine, other = far[met], at[met]
        flat[3 * mine], flat[slot[other]] = row[other], mine
        at += 1
        left = np.flatnonzero(~hit & (at < end))
        if len(left) == 0:
            return
        far, at, end, want = far[left], at[left], end[left], want[left]


def _pair_rest(a: Any, b: Any, c: Any, low: Any, high: Any, out: Any) -> None:
    """All edges without a neighbour yet, sorted; those of the hull remain alone."""
    far = np.flatnonzero(out[:, 0] < 0).astype(np.int32)
    near, upper, slot = _near_left(b, c, out)
    row = np.concatenate([far, near])
    slot = np.concatenate([3 * far, slot])
    key = np.concatenate([low[far], a[near]]).astype(np.int64)
    key <<= 32
    key |= np.concatenate([high[far], upper])
    order = np.argsort(key)
    key, slot, row = key[order], slot[order], row[order]
    met = np.flatnonzero(key[:-1] == key[1:])
    flat = out.reshape(-1)
    flat[slot[met]], flat[slot[met + 1]] = row[met + 1], row[met]


def neighbors_of(simplices: Any, points: int) -> Any:
    """neighbors[i, k] is the row of `simplices` opposite corner k of row i, -1 at the hull. The rows are as the daemon sends them,
    of ids below `points`. Cost: linear, but for a sort of about a third of the edges."""
    out = np.full((len(simplices), 3), -1, dtype=np.int32)
    if len(simplices) > 1:
        a, b, c = (np.ascontiguousarray(simplices[:, k]) for k in range(3))
        low, high = np.minimum(b, c), np.maximum(b, c)
        _pair_rows_of_a_corner(a, b, c, out)
        _pair_far_with_near(a, b, c, low, high, out, points)
        _pair_rest(a, b, c, low, high, out)
    return out
