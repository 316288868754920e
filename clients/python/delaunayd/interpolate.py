"""Interpolation between scattered points of the plane, with the calling convention of scipy.interpolate, in this process. Needs
NumPy.

    from delaunayd.interpolate import LinearNDInterpolator, NaturalNeighborInterpolator, griddata

Differences from SciPy's: triangles are exact and canonical, so the values are canonical, too, to the last digit; the first of several
coincident points determines the value; values must be finite or NaN; more than two dimensions are refused with ValueError.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Optional, Tuple

import numpy as np

from ._library import LAPLACE, LINEAR, NATURAL, SMOOTH
from ._values import doubles, known, real, truth
from .spatial import Delaunay

if TYPE_CHECKING:
    from ._types import ArrayLike, Floats, NDArray
    from .client import Client

__all__ = [
    "CloughTocher2DInterpolator", "LinearNDInterpolator", "NaturalNeighborInterpolator", "NearestNDInterpolator", "SmoothInterpolator",
    "griddata",
]

_METHODS = {"linear": LINEAR, "natural": NATURAL, "laplace": LAPLACE, "smooth": SMOOTH}


def _places(args: Tuple[Any, ...]) -> Floats:
    """The places of a call: one array of shape (..., 2), or a tuple or two arrays of x and y, which are broadcast."""
    if len(args) == 1 and isinstance(args[0], tuple):
        args = args[0]
    if len(args) == 1:
        places: Floats = doubles(args[0])
        if places.ndim == 1:
            places = places.reshape(-1, 2)  # as for SciPy
    elif len(args) == 2:
        x, y = np.broadcast_arrays(doubles(args[0]), doubles(args[1]))
        places = np.stack([x, y], axis=-1)
    else:
        raise ValueError("places have two coordinates")
    if places.shape[-1:] != (2,):
        raise ValueError("number of dimensions in xi does not match x")
    return places


def _points(points: Any) -> Any:
    """Points as Delaunay takes them: those of an array, a tuple of coordinates, or a triangulation of SciPy's."""
    if isinstance(points, np.ma.MaskedArray) and not np.any(points.mask):
        return points.data
    if isinstance(points, tuple):
        return np.stack(np.broadcast_arrays(*points), axis=-1).reshape(-1, len(points))
    if not isinstance(points, np.ndarray) and hasattr(points, "simplices") and hasattr(points, "points"):
        return points.points
    return points


class _Scale:
    """Coordinates from 0 to 1 if `rescale`, as SciPy's: about 0, divided by the width and height."""

    def __init__(self, points: Any, rescale: bool):
        self.points = points
        self.offset: Any = None
        if truth("rescale", rescale):
            flat = doubles(points)
            self.offset = flat.mean(axis=0)
            self.width = np.ptp(flat, axis=0)
            self.width[self.width == 0] = 1.0
            self.points = (flat - self.offset) / self.width

    def __call__(self, places: Floats) -> Floats:
        scaled: Floats = places if self.offset is None else (places - self.offset) / self.width
        return scaled


def _triangulate(points: Any, rescale: bool, workers: Optional[int]) -> Tuple[Delaunay, _Scale]:
    if rescale and hasattr(points, "simplices"):
        raise ValueError("Rescaling is not supported when passing a Delaunay triangulation as ``points``.")
    scale = _Scale(_points(points), rescale)
    return points if isinstance(points, Delaunay) else Delaunay(scale.points, workers=workers), scale


class _Values:
    """Values of shape (n, ...) as columns: each is contiguous in memory, and `shaped` is another view of the same numbers."""

    def __init__(self, values: ArrayLike, points: int):
        self.is_complex = np.iscomplexobj(values)
        given = np.asarray(values, dtype=np.complex128) if self.is_complex else known(values)
        if given.ndim == 0 or len(given) != points:
            raise ValueError("different number of values and points")
        kept = np.array(np.moveaxis(given, 0, -1), order="C")
        if np.isinf(kept).any():
            raise ValueError("values must be finite or NaN")
        self.shape = kept.shape[:-1]
        self.columns = kept.reshape(-1, points)
        self.shaped = np.moveaxis(kept, -1, 0)

    def __reduce__(self) -> Any:
        return _Values, (self.shaped, len(self.shaped))


class _Interpolator:
    _method = "linear"

    def __init__(
        self,
        points: Any,
        values: ArrayLike,
        fill_value: Any = np.nan,
        rescale: bool = False,
        *,
        max_edge: Optional[float] = None,
        url: Optional[str] = None,
        client: Optional[Client] = None,
        workers: Optional[int] = None,
    ):
        self.tri, self._scale = _triangulate(points, rescale, workers)
        self._workers = workers
        self.max_edge = None if max_edge is None else real(max_edge)
        self._values = _Values(values, self.tri.npoints)
        self.fill_value: Any = complex(fill_value) if self.is_complex else float(fill_value)

    @property
    def values(self) -> NDArray[Any]:
        """The values of the points, shape (n, ...). Others may be assigned, as a whole or in place: the next call uses them."""
        return self._values.shaped

    @values.setter
    def values(self, values: NDArray[Any]) -> None:
        self._values = _Values(values, self.tri.npoints)

    @property
    def values_shape(self) -> Tuple[int, ...]:
        """The shape of a value."""
        return self._values.shape

    @property
    def is_complex(self) -> bool:
        """Whether values are complex."""
        return self._values.is_complex

    @property
    def points(self) -> Floats:
        """The points, shape (npoints, 2)."""
        return self.tri.points

    def __call__(self, *args: Any) -> NDArray[Any]:
        """The values at places: shape (..., 2), or x and y, which are broadcast. The result has their shape, and that of a
        value. It is fill_value outside the hull, and NaN where a value is missing."""
        values = self._values
        places = _places(args)
        flat = np.ascontiguousarray(self._scale(places.reshape(-1, 2)))
        out = np.empty((len(flat), len(values.columns)), dtype=values.columns.dtype)
        for k, column in enumerate(values.columns):
            if values.is_complex:
                out[:, k].real = self._column(column.real, flat, complex(self.fill_value).real)
                out[:, k].imag = self._column(column.imag, flat, complex(self.fill_value).imag)
            else:
                out[:, k] = self._column(column, flat, self.fill_value)
        return out.reshape(places.shape[:-1] + values.shape)

    def _column(self, column: Any, flat: Floats, outside: float) -> Floats:
        triangulation = self.tri._now.triangulation
        if len(column) != triangulation.counts.points:
            raise ValueError("points were added to the triangulation, which now has more than there are values")
        edge = np.inf if self.max_edge is None else self.max_edge
        return triangulation.values(
            np.ascontiguousarray(column), _METHODS[self._method], edge, flat, outside, self._workers
        )


class LinearNDInterpolator(_Interpolator):
    """LinearNDInterpolator(points, values, fill_value=nan, rescale=False)(xi): linear in each triangle, as scipy.interpolate's of
    that name.

    `points` has the shape (n, 2), or is a Delaunay triangulation, or a constrained one; `values` has the shape (n, ...), real or complex. `max_edge`:
    there is no value in triangles with a longer edge. `workers` is the number of threads, all processors if it is None.
    `client` and `url` have no effect: no daemon is needed."""


class NaturalNeighborInterpolator(_Interpolator):
    """NaturalNeighborInterpolator(points, values, fill_value=nan)(xi): Sibson's interpolation, which is smooth except at the
    points. Arguments and calls are those of LinearNDInterpolator; method="laplace" takes Laplace's weights instead."""

    def __init__(
        self, points: Any, values: ArrayLike, fill_value: Any = np.nan, method: str = "natural", **more: Any
    ):
        if method not in ("natural", "laplace"):
            raise ValueError("method is natural or laplace")
        self._method = method
        super().__init__(points, values, fill_value, **more)


class SmoothInterpolator(_Interpolator):
    """SmoothInterpolator(points, values, fill_value=nan)(xi): the surface of Clough and Tocher, whose slopes are continuous.
    Slopes at points are found by least squares over their neighbours, at once and without SciPy. So values differ a little from those of
    CloughTocher2DInterpolator, which searches for the slopes of least curvature. Arguments and calls are those of LinearNDInterpolator."""

    _method = "smooth"


class NearestNDInterpolator:
    """NearestNDInterpolator(points, values, rescale=False)(xi): the value of the nearest point, inside the hull and outside, as
    scipy.interpolate's of that name. Of points that are as near, the first one counts. `points` may be a Delaunay triangulation.
    `tree_options` has no effect. Options of a call are those of Delaunay.query, such as `distance_upper_bound`: NaN beyond it."""

    def __init__(
        self, x: Any, y: ArrayLike, rescale: bool = False, tree_options: Any = None, *, workers: Optional[int] = None
    ):
        self._workers = -1 if workers is None else workers
        self.tri, self._scale = _triangulate(x, rescale, workers)
        self.values = np.asarray(y)
        if self.values.ndim == 0 or len(self.values) != self.tri.npoints:
            raise ValueError("different number of values and points")

    @property
    def points(self) -> Floats:
        """The points, shape (npoints, 2)."""
        return self.tri.points

    @property
    def tree(self) -> Delaunay:
        """What has `query`, as SciPy's tree."""
        return self.tri

    def __call__(self, *args: Any, **query: Any) -> NDArray[Any]:
        """The values at places, given as for LinearNDInterpolator."""
        places = self._scale(_places(args))
        _, ids = self.tri.query(places, **{"workers": self._workers, **query})
        ids = np.asarray(ids)
        if len(self.values) != self.tri.npoints:
            raise ValueError("points were added to the triangulation, which now has more than there are values")
        none = ids == self.tri.npoints
        found: NDArray[Any] = self.values[np.where(none, 0, ids)]
        if none.any():
            found = found.astype(np.result_type(found.dtype, np.float64))
            found[none] = np.nan
        return found


def CloughTocher2DInterpolator(
    points: Any, values: ArrayLike, fill_value: Any = np.nan, tol: float = 1e-6, maxiter: int = 400, rescale: bool = False
) -> Any:
    """SciPy's interpolator of that name, which must be installed, on an exact triangulation."""
    from scipy.interpolate import CloughTocher2DInterpolator as theirs  # type: ignore[import]

    tri = points if rescale or isinstance(points, Delaunay) else Delaunay(_points(points))
    return theirs(tri, values, fill_value, tol, maxiter, rescale)


def griddata(
    points: Any,
    values: ArrayLike,
    xi: Any,
    method: str = "linear",
    fill_value: Any = np.nan,
    rescale: bool = False,
    *,
    workers: Optional[int] = None,
) -> NDArray[Any]:
    """The values at places, as scipy.interpolate.griddata for points of the plane: method "nearest", "linear", "cubic", which needs
    SciPy, or also "natural", "laplace" or "smooth"."""
    if method == "nearest":
        return NearestNDInterpolator(points, values, rescale=rescale, workers=workers)(xi)
    if method == "linear":
        return LinearNDInterpolator(points, values, fill_value, rescale, workers=workers)(xi)
    if method in ("natural", "laplace"):
        return NaturalNeighborInterpolator(points, values, fill_value, method, rescale=rescale, workers=workers)(xi)
    if method == "smooth":
        return SmoothInterpolator(points, values, fill_value, rescale, workers=workers)(xi)
    if method == "cubic":
        found: NDArray[Any] = CloughTocher2DInterpolator(points, values, fill_value, rescale=rescale)(xi)
        return found
    raise ValueError("Unknown interpolation method %r for 2 dimensional data" % (method,))
