"""Interpolation between scattered points of the plane, with the calling convention of scipy.interpolate. Needs NumPy.

    from delaunayd.interpolate import LinearNDInterpolator, NaturalNeighborInterpolator

Differences from SciPy's: triangles are exact and canonical, so the values are canonical, too, to the last digit; the first of several
coincident points determines the value; values must be finite or NaN; `rescale` is refused with NotImplementedError, more than two
dimensions with ValueError.
"""

from __future__ import annotations

import weakref
from typing import Any, List, Optional, Tuple

import numpy as np

from . import _protocol as protocol
from .client import Client
from .spatial import Delaunay

__all__ = ["LinearNDInterpolator", "NaturalNeighborInterpolator"]

_LEAST, _MOST = 2.0**-142, 2.0**201  # magnitudes of coordinates but for 0 [PROTOCOL.md, section 1]
_AT_ONCE = 1 << 20  # places of a request
_FIELD = "v%d"
_MOST_FIELDS = 64  # of a set


class _Owner:
    """Whose values fields are: those of an interpolator, and of its copies."""


def _places(args: Tuple[Any, ...]) -> Any:
    """The places of a call: one array of shape (..., 2), or a tuple or two arrays of x and y, which are broadcast."""
    if len(args) == 1 and isinstance(args[0], tuple):
        args = args[0]
    if len(args) == 1:
        places = np.asarray(args[0], dtype=np.float64)
        if places.ndim == 1:
            places = places.reshape(-1, 2)  # as for SciPy
    elif len(args) == 2:
        x, y = np.broadcast_arrays(np.asarray(args[0], dtype=np.float64), np.asarray(args[1], dtype=np.float64))
        places = np.stack([x, y], axis=-1)
    else:
        raise ValueError("places have two coordinates")
    if places.shape[-1:] != (2,):
        raise ValueError("number of dimensions in xi does not match x")
    return places


class _Interpolator:
    _method = "linear"

    def __init__(
        self,
        points: Any,
        values: Any,
        fill_value: Any = np.nan,
        rescale: bool = False,
        *,
        max_edge: Optional[float] = None,
        url: Optional[str] = None,
        client: Optional[Client] = None,
    ):
        if rescale:
            raise NotImplementedError("rescale would change the triangulation; scale the points")
        self.tri = _triangulation(points, url, client)
        self.max_edge = None if max_edge is None else float(max_edge)
        self.values = self._check_values(values)
        self.values_shape = self.values.shape[1:]
        self.is_complex = np.issubdtype(self.values.dtype, np.complexfloating)
        self.fill_value = complex(fill_value) if self.is_complex else float(fill_value)
        columns = self.values.reshape(len(self.values), -1)
        self._columns = np.concatenate([columns.real, columns.imag], axis=1) if self.is_complex else columns
        self._owner = _Owner()

    def _check_values(self, values: Any) -> Any:
        values = np.asarray(values)
        if values.ndim == 0 or len(values) != self.tri.npoints:
            raise ValueError("different number of values and points")
        kind = np.complex128 if np.issubdtype(values.dtype, np.complexfloating) else np.float64
        values = np.ascontiguousarray(values, dtype=kind)
        if np.isinf(values).any():
            raise ValueError("values must be finite or NaN")
        return values

    @property
    def points(self) -> Any:
        """The points, shape (npoints, 2)."""
        return self.tri.points

    def __call__(self, *args: Any) -> Any:
        """The values at places: shape (..., 2), or x and y, which are broadcast. The result has their shape, and that of a
        value. It is fill_value outside the hull, and NaN where a value is missing."""
        places = _places(args)
        flat = places.reshape(-1, 2)
        out = np.full((len(flat), self._columns.shape[1]), np.nan)
        good = np.flatnonzero((np.abs(flat) <= _MOST).all(axis=1))
        asked = flat[good]
        asked[np.abs(asked) < _LEAST] = 0.0
        for at in range(0, len(good), _AT_ONCE):
            out[good[at : at + _AT_ONCE]] = self._ask(asked[at : at + _AT_ONCE])
        if self.is_complex:
            half = out.shape[1] // 2
            out = out[:, :half] + 1j * out[:, half:]
        if not np.isnan(self.fill_value):
            self._fill(out, flat)
        return out.reshape(places.shape[:-1] + self.values_shape)

    def _fill(self, out: Any, flat: Any) -> None:
        rows = np.flatnonzero(np.isnan(out).any(axis=1))
        if self.max_edge is None and np.isnan(self._columns).any():
            rows = rows[self.tri.find_simplex(flat[rows]) < 0]
        out[rows] = self.fill_value

    def _ask(self, places: Any) -> Any:
        """Shape (places, columns). Each column is a field of the set."""
        def ask(client: Client, name: str) -> Any:
            fields = self._fields(client, name)
            found = [client.interpolate(name, _FIELD % k, places, self._method, self.max_edge) for k in fields]
            return np.stack(found, axis=1)

        if self._columns.shape[1] == 0:
            return np.empty((len(places), 0))
        if self._columns.shape[1] > _MOST_FIELDS:
            raise NotImplementedError("at most 64 values a point")
        return self.tri._ask(ask)

    def _fields(self, client: Client, name: str) -> List[int]:
        """The numbers of the fields that have the columns, which are sent unless they are there. Interpolators may share a
        triangulation; if there are too many, those that were used last have fields."""
        fields = self.tri._fields  # number: (owner, column); the last used is the last
        mine = {column: number for number, (owner, column) in fields.items() if owner() is self._owner}
        columns = self._columns.T
        requests = []
        if len(mine) == len(columns):
            numbers = [mine[column] for column in range(len(columns))]
        else:
            numbers = self._free_fields(len(columns))
            for number, column in zip(numbers, columns):
                data, n = protocol.column(column)
                requests.append(protocol.request("FSETB", name, _FIELD % number, 0, n, body=data))
        for number in numbers:
            fields.pop(number, None)
        client._run(requests, lambda replies: None)
        fields.update((number, (weakref.ref(self._owner), column)) for column, number in enumerate(numbers))
        return numbers

    def _free_fields(self, n: int) -> List[int]:
        fields = self.tri._fields
        free = [number for number, (owner, _) in fields.items() if owner() in (None, self._owner)]
        free += [number for number in range(_MOST_FIELDS) if number not in fields]
        return (free + [number for number in fields if number not in free])[:n]


def _triangulation(points: Any, url: Optional[str], client: Optional[Client]) -> Delaunay:
    if type(points) is Delaunay:
        return points
    if not isinstance(points, np.ndarray) and hasattr(points, "simplices") and hasattr(points, "points"):
        points = points.points  # SciPy's
    elif isinstance(points, np.ma.MaskedArray) and not np.any(points.mask):
        points = points.data
    elif isinstance(points, tuple):
        points = np.stack(np.broadcast_arrays(*points), axis=-1).reshape(-1, len(points))
    return Delaunay(points, url=url, client=client)


class LinearNDInterpolator(_Interpolator):
    """LinearNDInterpolator(points, values, fill_value=nan)(xi): linear in each triangle, as scipy.interpolate's of that name.

    `points` has the shape (n, 2), or is a Delaunay triangulation; `values` has the shape (n, ...), real or complex. `max_edge`:
    there is no value in triangles with a longer edge. `client` and `url` are those of delaunayd.spatial.Delaunay."""


class NaturalNeighborInterpolator(_Interpolator):
    """NaturalNeighborInterpolator(points, values, fill_value=nan)(xi): Sibson's interpolation, which is smooth except at the
    points. Arguments and calls are those of LinearNDInterpolator; method="laplace" takes Laplace's weights instead."""

    def __init__(self, points: Any, values: Any, fill_value: Any = np.nan, method: str = "natural", **more: Any):
        if method not in ("natural", "laplace"):
            raise ValueError("method is natural or laplace")
        self._method = method
        super().__init__(points, values, fill_value, **more)
