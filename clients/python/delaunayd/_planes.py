"""Quantities that SciPy derives from triangles: planes of the triangles lifted to a paraboloid, and barycentric coordinates."""

from __future__ import annotations

from typing import Any, Tuple

import numpy as np

_RCOND_LIMIT = 1000 * np.finfo(float).eps  # below which a triangle is degenerate, as for SciPy


def paraboloid(points: Any) -> Tuple[float, float]:
    """The scale and shift of z = scale (x^2 + y^2) + shift that make heights as large as coordinates, as for Qhull's
    option Qbb with a point at infinity (Qz)."""
    z = np.einsum("ij,ij->i", points, points)
    low, high = float(z.min()), 1.1 * float(z.max())
    scale = float(np.abs(points).max()) / (high - low) if high > low else 1.0
    return scale, -low * scale


def lift(places: Any, scale: float, shift: float) -> Any:
    """Places of shape (..., 2) on the paraboloid: shape (..., 3)."""
    z = np.empty(places.shape[:-1] + (3,))
    z[..., :2] = places
    z[..., 2] = (places**2).sum(axis=-1) * scale + shift
    return z


def planes(points: Any, simplices: Any, scale: float, shift: float) -> Any:
    """For each lifted triangle the plane (normal, offset): a unit normal that points downwards, and normal . x + offset = 0."""
    corner = points[simplices]
    last = corner[:, 2]
    side = corner[:, :2] - last[:, None, :]
    rise = scale * np.einsum("ijk,ijk->ij", side, corner[:, :2] + last[:, None, :])
    u, v = side[:, 0], side[:, 1]
    out = np.empty((len(simplices), 4))
    out[:, 0] = rise[:, 0] * v[:, 1] - u[:, 1] * rise[:, 1]
    out[:, 1] = u[:, 0] * rise[:, 1] - rise[:, 0] * v[:, 0]
    out[:, 2] = -(u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0])
    length = np.sqrt(np.einsum("ij,ij->i", out[:, :3], out[:, :3]))
    with np.errstate(divide="ignore", invalid="ignore"):
        out[:, :3] /= length[:, None]
    height = np.einsum("ij,ij->i", last, last) * scale + shift
    out[:, 3] = -(out[:, 0] * last[:, 0] + out[:, 1] * last[:, 1] + out[:, 2] * height)
    return out


def transforms(points: Any, simplices: Any) -> Any:
    """transform[i, :2] is the matrix and transform[i, 2] the corner r with which matrix . (x - r) are the first two barycentric
    coordinates of x in triangle i. NaN where the triangle is too thin for that."""
    corner = points[simplices]
    last = corner[:, 2]
    a, b = corner[:, 0] - last, corner[:, 1] - last
    out = np.empty((len(simplices), 3, 2))
    with np.errstate(all="ignore"):
        det = a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]
        out[:, 0, 0], out[:, 0, 1] = b[:, 1] / det, -b[:, 0] / det
        out[:, 1, 0], out[:, 1, 1] = -a[:, 1] / det, a[:, 0] / det
        norm = np.maximum(np.abs(a).sum(axis=1), np.abs(b).sum(axis=1))
        inverse = np.abs(out[:, :2]).sum(axis=1).max(axis=1)
        bad = ~(1.0 / (norm * inverse) >= _RCOND_LIMIT)
    out[bad, :2] = np.nan
    out[:, 2] = last
    return out
