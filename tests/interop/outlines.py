"""Outlines that people publish (npm's world-atlas and us-atlas), in process, beside shapely: the triangles of each valid geometry have its
area. Those that cross themselves are named, and with split=True they have the area that is enclosed an odd number of times, as lines across
them measure it. All geometries of a file at once have the same areas.

    outlines.py FILE...        files of TopoJSON
"""

import json
import sys

import numpy as np
from shapely.geometry import MultiPolygon, Polygon

sys.path.insert(0, "clients/python")
from delaunayd.spatial import ConstrainedDelaunay, Crossing, triangulate_polygon  # noqa: E402

LINES = 1000


def geometries(path):
    """Polygons as lists of rings, and a list of them for each geometry."""
    topology = json.load(open(path))
    transform, arcs = topology.get("transform"), []
    for arc in topology["arcs"]:
        places = np.array(arc, dtype=float)
        arcs.append(np.cumsum(places, axis=0) * transform["scale"] + transform["translate"] if transform else places)

    def ring(numbers):
        pieces = [arcs[i] if i >= 0 else arcs[~i][::-1] for i in numbers]
        return np.concatenate(pieces[:1] + [piece[1:] for piece in pieces[1:]])

    def polygons(geometry):
        if geometry["type"] == "GeometryCollection":
            return [p for g in geometry["geometries"] for p in polygons(g)]
        found = [geometry["arcs"]] if geometry["type"] == "Polygon" else geometry.get("arcs", [])
        return [[[ring(r) for r in p] for p in found]]

    for name, of in topology["objects"].items():
        yield name, [p for p in polygons(of) if p]


def area(points, triangles):
    corner = points[triangles]
    u, v = corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]
    return (u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]).sum() / 2


def enclosed(polygons):
    """The area that is enclosed an odd number of times, by a line through the middle of each of many horizontal strips. Between the heights of
    corners that follow each other it is exact, but for strips in which sides cross."""
    rings = [np.vstack([ring, ring[:1]]) for polygon in polygons for ring in polygon]
    x0, y0, x1, y1 = np.concatenate([np.column_stack([r[:-1], r[1:]]) for r in rings]).T
    edges = np.unique(y0)
    if len(edges) > LINES:
        edges = np.linspace(edges[0], edges[-1], LINES + 1)
    total = 0.0
    for y, height in zip((edges[1:] + edges[:-1]) / 2, np.diff(edges)):
        across = (y0 <= y) != (y1 <= y)
        x = np.sort(x0[across] + (y - y0[across]) * (x1[across] - x0[across]) / (y1[across] - y0[across]))
        total += height * (x[1::2] - x[::2]).sum()
    return total


def check_one(polygons):
    """The area, and whether the geometry crosses itself."""
    geojson = {"type": "MultiPolygon", "coordinates": polygons}
    large = [[ring for ring in polygon if len(ring) > 3] for polygon in polygons]
    theirs = MultiPolygon([Polygon(p[0], p[1:]) for p in large if p])
    try:
        found, crossing = area(*triangulate_polygon(geojson)), False
    except Crossing:
        found, crossing = area(*triangulate_polygon(geojson, split=True)), True
    if theirs.is_valid:
        assert not crossing and abs(found - theirs.area) <= 1e-12 * theirs.area, (found, theirs.area)
    else:
        want = enclosed(polygons)
        assert abs(found - want) <= 2e-3 * want, (found, want)
    return found, crossing


def main():
    for path in sys.argv[1:]:
        for name, all_of_it in geometries(path):
            each = [check_one(polygons) for polygons in all_of_it]
            collection = [{"type": "MultiPolygon", "coordinates": polygons} for polygons in all_of_it]
            d = ConstrainedDelaunay.from_geometries(collection, split=True)
            for k, (want, _) in enumerate(each):
                assert want == 0 or abs(d.regions.borders[k].area - want) <= 1e-9 * want, (path, name, k)
            print("%s, %s: %d geometries, %d points, %d cross themselves; split, %d points more, deviation %.2g" % (
                path.rsplit("/", 1)[-1], name, len(each), sum(len(r) for g in all_of_it for p in g for r in p),
                sum(crossing for _, crossing in each), d.npoints - sum(len(r) for g in all_of_it for p in g for r in p), d.deviation
            ), flush=True)


main()
