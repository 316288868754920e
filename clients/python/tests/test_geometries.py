"""Polygons and lines in process: rings, GeoJSON, shapely and GeoPandas."""

import json
import pickle
import unittest
from pathlib import Path
from types import SimpleNamespace

try:
    import numpy

    from delaunayd.geometries import read
    from delaunayd.interpolate import LinearNDInterpolator
    from delaunayd.spatial import ConstrainedDelaunay, Crossing, triangulate_polygon
except ImportError:
    numpy = None
try:
    import shapely
    from shapely import geometry
except ImportError:
    shapely = None
try:
    import geopandas
except ImportError:
    geopandas = None
try:
    import matplotlib.tri
except ImportError:
    matplotlib = None

SQUARE, HOLE = [(0, 0), (9, 0), (9, 9), (0, 9)], [(2, 2), (2, 7), (7, 7), (7, 2)]
EXAMPLES = Path(__file__).resolve().parent.parent.parent / "examples"


def area(points, triangles):
    corner = points[triangles]
    u, v = corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]
    return (u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]).sum() / 2


@unittest.skipIf(numpy is None, "NumPy is missing")
class Polygons(unittest.TestCase):
    def test_rings_closed_or_not(self):
        for rings in ([SQUARE, HOLE], [SQUARE + SQUARE[:1], HOLE + HOLE[:1]], [numpy.array(SQUARE), numpy.array(HOLE, dtype=numpy.float32)]):
            points, triangles = triangulate_polygon(*rings)
            self.assertEqual(area(points, triangles), 81 - 25)
            self.assertEqual(len(triangles), 8)
            self.assertEqual(len(points), sum(map(len, rings)))
        self.assertEqual(area(*triangulate_polygon(SQUARE)), 81)
        self.assertEqual(area(*triangulate_polygon([(0, 0, 5), (9, 0, 5), (0, 9, 7)])), 40.5)

    def test_what_encloses_nothing(self):
        for polygon in ([[]], [[(1, 1)]], [[(0, 0), (1, 1)]], [[(0, 0), (1, 1), (0, 0)]], [[(0, 0), (1, 1), (2, 2)]], [[(5, 5)] * 4]):
            self.assertEqual(len(triangulate_polygon(*polygon)[1]), 0, polygon)
        with self.assertRaises(ValueError):
            triangulate_polygon()

    def test_duplicate_corners_and_rings_that_touch(self):
        doubled = [corner for corner in SQUARE for _ in range(3)]
        self.assertEqual(area(*triangulate_polygon(doubled)), 81)
        touching = [(0, 0), (4, 4), (0, 4)]  # at a corner, and along a side
        self.assertEqual(area(*triangulate_polygon(SQUARE, touching)), 81 - 8)
        spike = [(0, 0), (9, 0), (9, 9), (12, 9), (9, 9), (0, 9)]
        self.assertEqual(area(*triangulate_polygon(spike)), 81)
        self.assertEqual(area(*triangulate_polygon(SQUARE, SQUARE)), 0)  # enclosed twice
        eight = [(0, 0), (4, 4), (8, 0), (8, 8), (4, 4), (0, 8)]  # touches itself at a corner
        self.assertEqual(area(*triangulate_polygon(eight)), 32)

    def test_crossings_are_named(self):
        with self.assertRaisesRegex(Crossing, r"^ring 0 crosses itself: segments \[2, 3\] and \[0, 1\] cross .* \(0.0, 0.0\) to \(1.0, 1.0\)"):
            triangulate_polygon([(0, 0), (1, 1), (1, 0), (0, 1)])
        with self.assertRaisesRegex(ValueError, "^ring 1 crosses ring 0: ") as caught:
            triangulate_polygon(SQUARE, [(5, 5), (12, 5), (12, 6)])
        self.assertEqual(caught.exception.segments, ((4, 5), (1, 2)))
        again = pickle.loads(pickle.dumps(caught.exception))
        self.assertEqual((again.args, again.segments), (caught.exception.args, caught.exception.segments))
        lines = [{"type": "LineString", "coordinates": [[0, 0], [2, 2]]}, {"type": "LineString", "coordinates": [[0, 2], [2, 0], [3, 3]]}]
        with self.assertRaisesRegex(Crossing, "^line of feature 1 crosses line of feature 0: "):
            ConstrainedDelaunay.from_geometries(lines)

    def test_crossings_are_split(self):
        bow = [(0, 0), (4, 4), (4, 0), (0, 4)]
        points, triangles = triangulate_polygon(bow, split=True)
        self.assertEqual((points.tolist()[4:], area(points, triangles)), ([[2, 2]], 8))
        points, triangles = triangulate_polygon(SQUARE, [(5, 5), (12, 5), (12, 6)], split=True)
        self.assertEqual(points[7:, 0].tolist(), [9, 9])
        outside = [(9, 5), (12, 5), (12, 6), (9, 5 + 4 / 7)]
        self.assertAlmostEqual(area(points, triangles), 81 + area(*triangulate_polygon(outside)) - 4 * (4 / 7) / 2, places=12)
        lines = [{"type": "LineString", "coordinates": [[0, 0, 0], [4, 4, 8]]}, {"type": "LineString", "coordinates": [[0, 4, 4], [4, 0, 0]]}]
        d = ConstrainedDelaunay.from_geometries(lines, split=True)
        self.assertEqual((d.points[4].tolist(), d.z[4], d.deviation), ([2, 2], 3, 0))
        self.assertEqual((d.segments.tolist(), d.number.tolist(), d.border.any()), ([[0, 4], [1, 4], [2, 4], [3, 4]], [0, 0, 1, 1], False))
        again = pickle.loads(pickle.dumps(d))
        self.assertEqual((again.simplices.tolist(), again.z.tolist()), (d.simplices.tolist(), d.z.tolist()))
        apart = ConstrainedDelaunay(SQUARE, [[0, 1]], z=[1, 2, 3, 4], split=True)
        self.assertEqual((apart.segments.tolist(), apart.z.tolist(), apart.npoints), ([[0, 1]], [1, 2, 3, 4], 4))
        nothing = ConstrainedDelaunay(SQUARE, [], z=[numpy.nan] * 4, split=True)
        self.assertEqual((len(nothing.segments), nothing.nsimplex), (0, 2))
        thirds = ConstrainedDelaunay([(0, 0), (1, 0.1), (0, 0.07), (1, 0.02)], [[0, 1], [2, 3]], split=True)
        self.assertLess(thirds.deviation, 1e-16)
        for z in ([1, 2, 3], [[1, 2, 3, 4]], [1, 2, 3, numpy.inf]):
            with self.assertRaisesRegex(ValueError, "^z "):
                ConstrainedDelaunay(SQUARE, [], z=z)
        with self.assertRaisesRegex(ValueError, "point 9 does not exist"):
            ConstrainedDelaunay(SQUARE, [[0, 9]], split=True)

    def test_bad_places_are_named(self):
        for polygon, words in (
            ([SQUARE, [(1, 1), (float("nan"), 2), (3, 3)]], "^ring 1: place 1 is "),
            ([[(0, 0), (1, 1), (2, float("inf"))]], "^ring 0: place 2 is "),
            ([[(1, 2, 3, 4)] * 4], "^ring 0 has places of the shape"),
            ([{"type": "Circle", "coordinates": [1]}], "^Circle: "),
            ([[(0, 0), (1e300, 1), (0, 1)]], "2\\^201"),
        ):
            with self.assertRaisesRegex(ValueError, words):
                triangulate_polygon(*polygon)
        for wrong in ([1, 2], ["POINT (1 2)"], [None, object()]):
            with self.assertRaisesRegex(ValueError, "is not a geometry"):
                read(wrong)

    def test_geojson(self):
        field = json.loads((EXAMPLES / "field.geojson").read_text())
        d = ConstrainedDelaunay.from_geometries(field)
        self.assertEqual(sorted(d.regions.borders), [0, 1])
        self.assertEqual(d.regions.area, area(d.points, d.simplices[d.inside]))
        self.assertEqual(int((d.region == 1).sum()), d.regions.borders[1].triangles)
        with_interface = SimpleNamespace(__geo_interface__=field["features"][0])
        self.assertEqual(area(*triangulate_polygon(with_interface)), d.regions.borders[0].area)
        self.assertEqual(area(*triangulate_polygon([with_interface, None])), d.regions.borders[0].area)
        empty = {"type": "FeatureCollection", "features": [{"type": "Feature", "geometry": None}, {"type": "Point", "coordinates": []}]}
        self.assertEqual(len(triangulate_polygon(empty)[0]), 0)
        both = {"type": "GeometryCollection", "geometries": [
            {"type": "MultiPoint", "coordinates": [[1, 1], [8, 8]]},
            {"type": "MultiLineString", "coordinates": [[[1, 1], [2, 1]], []]},
            {"type": "MultiPolygon", "coordinates": [[SQUARE, HOLE], [[(20, 0), (30, 0), (20, 10)]]]},
        ]}
        graph = read(both)
        self.assertEqual((len(graph.points), len(graph.segments), int(graph.border.sum())), (2 + 2 + 8 + 3, 1 + 8 + 3, 11))
        self.assertEqual(graph.names[2], "line of part 0 of part 1")
        self.assertEqual(graph.part_of(4), "ring 0 of part 0 of part 2")
        self.assertEqual(area(*triangulate_polygon(both)), 81 - 25 + 50)

    def test_numbers_and_kinds_of_segments(self):
        points = SQUARE + HOLE
        sides = [[0, 1], [1, 2], [2, 3], [3, 0], [4, 5], [5, 6], [6, 7], [7, 4], [0, 4]]
        border = [True] * 8 + [False]
        d = ConstrainedDelaunay(points, sides, border, number=[7] * 4 + [8] * 5)
        self.assertEqual((d.regions.area, d.regions.borders[7].area, d.regions.borders[8].area), (81, 81, 25))
        self.assertEqual(d.inside_of(8).sum(), d.regions.borders[8].triangles)
        self.assertTrue((d.inside_of(7) >= d.inside_of(8)).all())
        self.assertEqual(set(d.region.tolist()), {7})
        self.assertEqual(pickle.loads(pickle.dumps(d)).regions, d.regions)
        opened = ConstrainedDelaunay(points, sides[1:], border[1:], number=[7] * 3 + [8] * 5)
        self.assertEqual(set(opened.region.tolist()), {-1, 8})
        self.assertFalse(opened.regions.borders[7].closed)
        for number, words in ((7, "open"), (9, "no border 9"), (-1, "no border")):
            with self.assertRaisesRegex(ValueError, words):
                opened.inside_of(number)
        for wrong in ({"number": [1]}, {"number": -1}, {"number": 2**31}, {"number": 0.5}, {"border": [True]}):
            with self.assertRaises(ValueError):
                ConstrainedDelaunay(points, sides, **wrong)
        self.assertEqual(ConstrainedDelaunay(points, [], True).regions.borders, {})

    def test_heights_of_breaklines(self):
        lines = [
            {"type": "LineString", "coordinates": [[0, 0, 0], [10, 0, 10]]},
            {"type": "LineString", "coordinates": [[0, 10, 0], [10, 10, 10]]},
            {"type": "Point", "coordinates": [5, 5]},
        ]
        d = ConstrainedDelaunay.from_geometries(lines)
        self.assertEqual(d.z[:4].tolist(), [0, 10, 0, 10])
        self.assertTrue(numpy.isnan(d.z[4]))
        self.assertIsNone(ConstrainedDelaunay.from_rings(SQUARE).z)
        d = ConstrainedDelaunay.from_geometries(lines[:2])
        self.assertEqual(LinearNDInterpolator(d, d.z)([(5, 5)]).tolist(), [5])

    def test_random_stars_are_covered(self):
        random = numpy.random.default_rng(3)
        for n in (3, 10, 100, 1000):
            angle = 2 * numpy.pi * numpy.arange(n) / n
            radius = random.uniform(1, 10, n)
            ring = numpy.column_stack([radius * numpy.cos(angle), radius * numpy.sin(angle)])
            points, triangles = triangulate_polygon(ring)
            x, y = ring.T
            want = (x * numpy.roll(y, -1) - y * numpy.roll(x, -1)).sum() / 2
            self.assertEqual(len(triangles), n - 2)
            self.assertAlmostEqual(area(points, triangles), want, delta=1e-9 * want)


@unittest.skipIf(numpy is None or matplotlib is None, "Matplotlib is missing")
class Matplotlib(unittest.TestCase):
    def test_a_triangulation_with_a_mask(self):
        t = ConstrainedDelaunay.from_rings(SQUARE, HOLE).to_matplotlib()
        self.assertIsInstance(t, matplotlib.tri.Triangulation)
        self.assertEqual(int((~t.mask).sum()), 8)
        finder = t.get_trifinder()
        self.assertEqual([int(finder(x, y)) >= 0 for x, y in ((1, 1.5), (4.5, 4.4))], [True, False])
        self.assertIsNone(ConstrainedDelaunay(SQUARE, [[0, 2]]).to_matplotlib().mask)


@unittest.skipIf(numpy is None or shapely is None, "shapely is missing")
class Shapely(unittest.TestCase):
    def test_every_kind_of_geometry(self):
        square, far = geometry.Polygon(SQUARE, [HOLE]), geometry.Polygon([(20, 0), (30, 0), (20, 10)])
        self.assertEqual(area(*triangulate_polygon(square)), square.area)
        self.assertEqual(area(*triangulate_polygon(geometry.MultiPolygon([square, far]))), square.area + far.area)
        self.assertEqual(area(*triangulate_polygon([square, None, geometry.Polygon(), far])), square.area + far.area)
        mixed = geometry.GeometryCollection([far, geometry.Point(3, 1), geometry.LineString([(21, 1), (22, 1)]), geometry.LinearRing(SQUARE)])
        d = ConstrainedDelaunay.from_geometries(mixed)
        self.assertEqual((d.regions.area, len(d.segments)), (81 + 50, 3 + 1 + 4))
        self.assertEqual(len(triangulate_polygon(geometry.MultiPolygon())[1]), 0)
        lines = geometry.MultiLineString([[(0, 0), (4, 0)], [(0, 1), (4, 1), (5, 2)]])
        self.assertEqual(ConstrainedDelaunay.from_geometries(lines).segments.tolist(), [[0, 1], [2, 3], [3, 4]])
        heights = ConstrainedDelaunay.from_geometries([geometry.LineString([(0, 0, 1), (1, 1, 2)]), geometry.Point(2, 0)]).z
        self.assertEqual(heights[:2].tolist(), [1, 2])
        self.assertTrue(numpy.isnan(heights[2]))

    def test_features_that_cross_are_named(self):
        boxes = [geometry.box(0, 0, 2, 2), geometry.box(5, 5, 6, 6), geometry.box(1, 1, 3, 3)]
        with self.assertRaisesRegex(Crossing, "^ring 0 of feature 2 crosses ring 0 of feature 0: "):
            ConstrainedDelaunay.from_geometries(boxes)
        with self.assertRaisesRegex(Crossing, "^ring 0 crosses itself: "):
            triangulate_polygon(geometry.Polygon([(0, 0), (4, 4), (4, 0), (0, 4)]))

    def test_triangles_tile_the_polygon(self):
        from shapely.ops import unary_union

        shapes = [
            geometry.Point(0, 0).buffer(5).difference(geometry.Point(1, 1).buffer(2)),
            geometry.box(0, 0, 10, 10).difference(geometry.MultiPoint([(i, j) for i in range(1, 10, 2) for j in range(1, 10, 3)]).buffer(0.4)),
            unary_union([geometry.Point(i, (3 * i) % 7).buffer(1.7) for i in range(12)]),
        ]
        for shape in shapes:
            points, triangles = triangulate_polygon(shape)
            self.assertAlmostEqual(area(points, triangles), shape.area, delta=1e-12 * shape.area)
            pieces = [geometry.Polygon(points[t]) for t in triangles]
            self.assertLess(unary_union(pieces).symmetric_difference(shape).area, 1e-9 * shape.area)
            for piece in pieces[:: max(1, len(pieces) // 50)]:
                self.assertTrue(shape.buffer(1e-9).contains(piece))

    def test_polygons_that_cross_themselves_are_as_shapely_makes_them_valid(self):
        from shapely.validation import make_valid

        random = numpy.random.default_rng(4)
        for n in (4, 5, 8, 20, 60):
            ring = random.integers(0, 30, (n, 2))
            want = make_valid(geometry.Polygon(ring)).area
            self.assertAlmostEqual(area(*triangulate_polygon(ring, split=True)), want, delta=1e-9 * want + 1e-12)

    def test_points_are_in_the_order_of_coordinates(self):
        shapes = [geometry.box(0, 0, 1, 1), geometry.Polygon(SQUARE, [HOLE])]
        want = numpy.concatenate([numpy.array(ring.coords) for s in shapes for ring in [s.exterior, *s.interiors]])
        self.assertEqual(read(shapes).points.tolist(), want.tolist())


@unittest.skipIf(numpy is None or geopandas is None or shapely is None, "GeoPandas is missing")
class GeoPandas(unittest.TestCase):
    def test_series_and_frames(self):
        parcels = geopandas.GeoSeries([geometry.box(0, 0, 2, 2), geometry.box(2, 0, 5, 2), None, geometry.box(2, 2, 3, 4)], index=list("abcd"))
        frame = geopandas.GeoDataFrame({"name": list("pqrs")}, geometry=parcels.values)
        for geometries in (parcels, frame, parcels.values, list(parcels)):
            d = ConstrainedDelaunay.from_geometries(geometries)
            self.assertEqual({k: r.area for k, r in d.regions.borders.items()}, {0: 4, 1: 6, 3: 2})
            self.assertEqual(d.region[d.find_simplex([(1, 0.5), (4, 0.5), (2.5, 3.5), (0.1, 3.9)])].tolist()[:3], [0, 1, 3])


if __name__ == "__main__":
    unittest.main()
