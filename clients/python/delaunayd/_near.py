"""The searches of scipy.spatial.cKDTree, with its conventions, by a triangulation. Norms other than the Euclidean one are compared
among points that the Euclidean search finds: |v|_p and |v|_2 differ by at most a factor of 2^|1/2 - 1/p|.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Optional, Tuple

import numpy as np

from ._values import doubles, each, whole

if TYPE_CHECKING:
    from ._types import ArrayLike, Floats, Numbers

_ROUNDED = 1 + 2.0**-50  # more than roundings of a radius


def _check(eps: float, p: float) -> None:
    if eps < 0:
        raise ValueError("eps must be non-negative")
    if not p >= 1:
        raise ValueError("Only p-norms with 1<=p<=infinity permitted")


def _euclidean(r: Any, p: float) -> Any:
    """A Euclidean radius around everything within r by norm p."""
    return r if p <= 2 else r * 2 ** (0.5 - 1 / p) * _ROUNDED


def _norm(difference: Floats, p: float) -> Floats:
    x, y = np.abs(difference[..., 0]), np.abs(difference[..., 1])
    norm: Floats
    if p == 2:
        norm = np.hypot(x, y)
    elif np.isinf(p):
        norm = np.maximum(x, y)
    else:
        norm = x + y if p == 1 else (x**p + y**p) ** (1 / p)
    return norm


def _nearest_by_norm(now: Any, flat: Floats, k: int, p: float, workers: Optional[int]) -> Tuple[Floats, Numbers]:
    """As Triangulation.nearest: the k nearest of all that are as near as the farthest of k points."""
    n = len(now.points)
    few = min(k, n)
    _, some = now.triangulation.nearest(flat, few, workers)
    bound = _norm(now.points[some] - flat[:, None], p).max(axis=1)
    radius = np.maximum(_euclidean(bound, p) * _ROUNDED, 2.0**-142)
    ids, end = now.triangulation.within(flat, radius, workers)
    place = np.repeat(np.arange(len(flat)), np.diff(end, prepend=0))
    distance = _norm(now.points[ids] - flat[place], p)
    order = np.lexsort((ids, distance, place))
    take = (end - np.diff(end, prepend=0))[:, None] + np.arange(few)
    out, numbers = np.full((len(flat), k), np.inf), np.full((len(flat), k), n)
    out[:, :few], numbers[:, :few] = distance[order][take], ids[order][take]
    return out, numbers


def query(
    now: Any, places: Floats, k: Any, eps: float, p: float, upper: float, workers: Optional[int]
) -> Tuple[Any, Any]:
    _check(eps, p)
    one = k is not None and np.ndim(k) == 0
    ranks = np.arange(1, whole(k) + 1) if one else np.array(each(k, whole), dtype=np.int64)
    if ranks.ndim != 1 or len(ranks) == 0 or ranks.min() < 1:
        raise ValueError("k must be an integer greater than zero or a sequence of such integers")
    flat, most = places.reshape(-1, 2), int(ranks.max())
    if p == 2:
        distance, ids = now.triangulation.nearest(flat, most, workers)
    else:
        distance, ids = _nearest_by_norm(now, flat, most, p, workers)
    if not one:
        distance, ids = distance[:, ranks - 1], ids[:, ranks - 1]
    far = ~(distance < upper)
    distance[far], ids[far] = np.inf, len(now.points)
    shape = places.shape[:-1] + (() if one and most == 1 else (len(ranks),))
    if shape == ():
        return distance.item(), ids.item()
    return distance.reshape(shape), ids.reshape(shape)


def query_ball_point(
    now: Any, places: Floats, r: ArrayLike, eps: float, p: float, workers: Optional[int], only_length: bool
) -> Any:
    _check(eps, p)
    shape = places.shape[:-1]
    flat = places.reshape(-1, 2)
    radius = np.broadcast_to(doubles(r), shape).ravel()
    wide = np.ascontiguousarray(_euclidean(radius, p))
    ids, end = now.triangulation.within(flat, wide, workers)
    if p != 2:
        place = np.repeat(np.arange(len(flat)), np.diff(end, prepend=0))
        near = _norm(now.points[ids] - flat[place], p) <= radius[place]
        ids = ids[near]
        end = np.cumsum(np.bincount(place[near], minlength=len(flat)))
    if only_length:
        return np.diff(end, prepend=0).reshape(shape)[()]
    lists = np.empty(len(flat), dtype=object)
    lists[:] = [part.tolist() for part in np.split(ids, end[:-1])] if len(flat) > 0 else []
    return lists.reshape(shape) if shape else lists[0]
