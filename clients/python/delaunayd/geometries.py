"""Points and segments of geometries, for delaunayd.spatial and for sets of a daemon: those of shapely and GeoPandas, where these are
installed, of GeoJSON, and rings as arrays. Needs NumPy.

    from delaunayd.geometries import read
    g = read(parcels)                      # a GeoSeries, a list of polygons, a GeoJSON object ...

Nothing of shapely is imported: what has `geom_type` is treated as a geometry of shapely, of version 1 or 2, and what has
`__geo_interface__` as GeoJSON.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Iterator, List, NamedTuple, Optional

import numpy as np

from ._values import doubles

if TYPE_CHECKING:
    from ._types import Floats, NDArray

__all__ = ["Graph", "read"]

_POINTS, _LINE, _RING = range(3)  # the kinds of parts


class Graph(NamedTuple):
    """Points, shape (n, 2), in the order of shapely's get_coordinates, and the segments between them, shape (m, 2). Each segment has a
    number, that of its feature, and may be a part of the border of a polygon, else of a line. `z` has the heights of the points, NaN
    where there is none; it is None if no geometry has any. The points of the part names[i], such as "ring 1 of feature 7", end at
    ends[i]."""

    points: Floats
    segments: NDArray[Any]
    border: NDArray[Any]
    number: NDArray[Any]
    z: Optional[Floats]
    names: List[str]
    ends: NDArray[Any]

    def part_of(self, point: int) -> str:
        """The name of the part that a point comes from."""
        return self.names[int(np.searchsorted(self.ends, point, side="right"))]


class _Part(NamedTuple):
    kind: int
    feature: int
    name: str
    coords: NDArray[Any]


def read(geometries: Any) -> Graph:
    """The graph of a geometry, or of several in a sequence, an array, a GeoSeries or a GeoDataFrame. Feature i of several has the
    number i; missing and empty ones have no points. Rings are borders of their polygon's number; they may be closed or not. Coordinates
    are x and y, and z, which does not matter for the triangles. ValueError names what cannot be read."""
    parts = [part for part in _parts_of_all(geometries) if len(part.coords) > 0]
    ends = np.cumsum([len(part.coords) for part in parts], dtype=np.int64)
    segments, border, number = [np.empty((0, 2), dtype=np.int64)], [np.empty(0, dtype=bool)], [np.empty(0, dtype=np.int64)]
    for part, end in zip(parts, ends.tolist()):
        those = _segments(part, end - len(part.coords))
        segments.append(those)
        border.append(np.full(len(those), part.kind == _RING))
        number.append(np.full(len(those), part.feature))
    return Graph(
        np.concatenate([np.empty((0, 2))] + [part.coords[:, :2] for part in parts]),
        np.concatenate(segments),
        np.concatenate(border),
        np.concatenate(number),
        _heights(parts),
        [part.name for part in parts],
        ends,
    )


def _segments(part: _Part, first: int) -> NDArray[Any]:
    """Those of a part whose points begin with the number `first`. A ring of two corners encloses nothing."""
    n = len(part.coords)
    if part.kind == _RING and n > 1 and (part.coords[0, :2] == part.coords[-1, :2]).all():
        n -= 1
    if part.kind == _POINTS or n < 2 + (part.kind == _RING):
        return np.empty((0, 2), dtype=np.int64)
    way = np.arange(first, first + n, dtype=np.int64)
    return np.column_stack([way, np.roll(way, -1)])[: n - (part.kind == _LINE)]


def _heights(parts: List[_Part]) -> Optional[Floats]:
    if all(part.coords.shape[1] == 2 for part in parts):
        return None
    missing = [np.full(len(part.coords), np.nan) if part.coords.shape[1] == 2 else part.coords[:, 2] for part in parts]
    heights: Floats = np.concatenate(missing)
    return heights


# ---- geometries ----


def _parts_of_all(geometries: Any) -> Iterator[_Part]:
    if _is_one(geometries):
        yield from _parts(geometries, 0, "")
        return
    several = getattr(geometries, "geometry", geometries)  # a GeoDataFrame's
    if isinstance(several, dict):
        several = several.get("features", several)
    for i, one in enumerate(several):
        if one is not None:
            if not _is_one(one):
                raise ValueError("feature %d is not a geometry but %s" % (i, type(one).__name__))
            yield from _parts(one, i, " of feature %d" % i)


def _is_one(geometry: Any) -> bool:
    if isinstance(geometry, dict):
        return geometry.get("type") not in (None, "FeatureCollection")
    if isinstance(getattr(geometry, "geom_type", None), str):
        return True
    return hasattr(geometry, "__geo_interface__") and _is_one(geometry.__geo_interface__)


def _parts(geometry: Any, feature: int, where: str) -> Iterator[_Part]:
    if isinstance(getattr(geometry, "geom_type", None), str):
        yield from _parts_of_shapely(geometry, feature, where)
    else:
        yield from _parts_of_geojson(geometry if isinstance(geometry, dict) else geometry.__geo_interface__, feature, where)


def _parts_of_shapely(geometry: Any, feature: int, where: str) -> Iterator[_Part]:
    kind = geometry.geom_type
    if geometry.is_empty:
        return
    if kind == "Point":
        yield _part(_POINTS, feature, "point" + where, geometry.coords)
    elif kind == "LineString":
        yield _part(_LINE, feature, "line" + where, geometry.coords)
    elif kind == "LinearRing":
        yield _part(_RING, feature, "ring" + where, geometry.coords)
    elif kind == "Polygon":
        for i, ring in enumerate([geometry.exterior, *geometry.interiors]):
            yield _part(_RING, feature, "ring %d%s" % (i, where), ring.coords)
    elif hasattr(geometry, "geoms"):
        for i, one in enumerate(geometry.geoms):
            yield from _parts_of_shapely(one, feature, " of part %d%s" % (i, where))
    else:
        raise ValueError("%s%s: there are points, lines and polygons" % (kind, where))


def _parts_of_geojson(geometry: Any, feature: int, where: str) -> Iterator[_Part]:
    kind = geometry.get("type")
    if kind == "Feature":
        if geometry.get("geometry") is not None:
            yield from _parts_of_geojson(geometry["geometry"], feature, where)
        return
    if kind == "GeometryCollection":
        for i, one in enumerate(geometry["geometries"]):
            yield from _parts_of_geojson(one, feature, " of part %d%s" % (i, where))
        return
    coordinates = geometry.get("coordinates")
    if coordinates is None or len(coordinates) == 0:
        return
    if kind in ("MultiPoint", "MultiLineString", "MultiPolygon"):
        for i, one in enumerate(coordinates):
            yield from _parts_of_geojson({"type": kind[5:], "coordinates": one}, feature, " of part %d%s" % (i, where))
    elif kind == "Point":
        yield _part(_POINTS, feature, "point" + where, [coordinates])
    elif kind == "LineString":
        yield _part(_LINE, feature, "line" + where, coordinates)
    elif kind == "Polygon":
        for i, ring in enumerate(coordinates):
            yield _part(_RING, feature, "ring %d%s" % (i, where), ring)
    else:
        raise ValueError("%s%s: there are points, lines and polygons" % (kind, where))


def _part(kind: int, feature: int, name: str, coords: Any) -> _Part:
    found: Floats = doubles(coords)
    if found.size == 0:
        found = found.reshape(0, 2)
    if found.ndim != 2 or found.shape[1] not in (2, 3):
        raise ValueError("%s has places of the shape %s, not (k, 2) or (k, 3)" % (name, found.shape))
    bad = ~np.isfinite(found[:, :2]).all(axis=1)
    if bad.any():
        raise ValueError("%s: place %d is %s" % (name, bad.argmax(), found[bad.argmax(), :2]))
    return _Part(kind, feature, name, found)
