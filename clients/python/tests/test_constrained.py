"""delaunayd.spatial.ConstrainedDelaunay: segments, polygons, and what is refused."""

import copy
import pickle
import unittest

try:
    import numpy

    from delaunayd.interpolate import LinearNDInterpolator
    from delaunayd.spatial import ConstrainedDelaunay, Delaunay, simplify
except ImportError:
    numpy = None

SQUARE = [(0, 0), (4, 0), (4, 4), (0, 4)]


def areas(d):
    """Twice the area of each triangle."""
    corners = d.points[d.simplices]
    u, v = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    return u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]


@unittest.skipIf(numpy is None, "NumPy is missing")
class Constrained(unittest.TestCase):
    def test_each_segment_is_an_edge_or_a_chain_of_edges(self):
        for diagonal in ([0, 2], [3, 1]):
            d = ConstrainedDelaunay(SQUARE, [diagonal])
            self.assertEqual(d.constrained_edges.tolist(), [sorted(diagonal)])
            self.assertEqual(len(d.simplices), 2)
            self.assertTrue(all(set(diagonal) <= set(s) for s in d.simplices.tolist()))
        d = ConstrainedDelaunay(SQUARE + [(2, 2)], [[0, 2], [1, 3]])
        self.assertEqual(d.constrained_edges.tolist(), [[0, 4], [1, 4], [2, 4], [3, 4]])
        self.assertFalse(d.inside.any())

    def test_refined_meshes_have_no_smaller_angles_and_begin_with_the_points(self):
        d = ConstrainedDelaunay.from_rings([(0, 0), (9, 0), (9, 2), (0, 2)], [(1, 0.5), (2, 0.5), (2, 1), (1, 1)])
        fine = d.refine(30, area=0.1, limit=5000)
        self.assertTrue((fine.points[: len(d.points)] == d.points).all())
        self.assertEqual((fine.unrefined, fine.regions.area), (0, d.regions.area))
        self.assertGreaterEqual(fine.least_angle, 30)
        corners = fine.points[fine.simplices[fine.inside]]
        sides = numpy.roll(corners, -1, axis=1) - corners
        lengths = numpy.hypot(sides[:, :, 0], sides[:, :, 1])
        cosines = -(sides * numpy.roll(sides, 1, axis=1)).sum(axis=2) / lengths / numpy.roll(lengths, 1, axis=1)
        self.assertAlmostEqual(numpy.degrees(numpy.arccos(cosines)).min(), fine.least_angle, places=9)
        areas = abs(sides[:, 0, 0] * sides[:, 1, 1] - sides[:, 0, 1] * sides[:, 1, 0]) / 2
        self.assertLessEqual(areas.max(), 0.1)
        again = fine.refine(30, area=0.1)
        self.assertEqual(len(again.points), len(fine.points))
        self.assertEqual(d.refine(20, length=1, keep=True).constrained_edges.tolist(), d.constrained_edges.tolist())
        self.assertEqual(len(d.refine(30, limit=3).points), 11)
        self.assertGreater(len(ConstrainedDelaunay(SQUARE, []).refine(length=1).points), 10)
        for wrong in ({"angle": 60}, {"area": -1}, {"length": float("nan")}, {"angle": 20, "number": 7}):
            with self.assertRaises(ValueError):
                d.refine(**wrong)
        with self.assertRaisesRegex(ValueError, "open"):
            ConstrainedDelaunay(SQUARE, [[0, 1]], border=True).refine()

    def test_a_surface_of_few_points_is_within_the_error_of_all(self):
        places = numpy.array([(x, y) for x in range(9) for y in range(9)] + [(4, 4)], dtype=float)
        heights = abs(places[:, 0] - 4) + places[:, 1] / 8
        heights[-1] = 99  # coincident: the first one counts
        kept = simplify(places, heights, 0.25)
        self.assertLess(len(kept), 20)
        self.assertEqual(kept.tolist(), sorted(set(kept.tolist()) - {81}))
        surface = LinearNDInterpolator(Delaunay(places[kept]), heights[kept])
        self.assertLessEqual(abs(surface(places[:81]) - heights[:81]).max(), 0.25 + 1e-12)
        self.assertEqual(simplify(places, heights, most=4).tolist(), [0, 8, 72, 80])
        self.assertEqual(len(simplify(places, heights, most=5)), 5)
        self.assertEqual(simplify(places, numpy.zeros(82), segments=[[3, 40], [40, 81]]).tolist(), [0, 3, 8, 40, 72, 80])
        heights[3] = numpy.nan
        self.assertNotIn(3, simplify(places, heights, 0).tolist())

    def test_a_surface_of_few_points_refuses_bad_input(self):
        for heights, options, message in (
            ([0] * 4, {"error": -1}, "error must be"),
            ([0] * 4, {"error": float("nan")}, "error must be"),
            ([0] * 3, {}, "one height"),
            ([0, 0, 0, float("inf")], {}, "infinity"),
            ([0] * 4, {"most": 3}, "4 points must stay"),
            ([0] * 4, {"segments": [[0, 2], [1, 3]]}, "cross where no point is"),
            ([0] * 4, {"segments": [[0, 4]]}, "point 4 does not exist"),
            ([0] * 4, {"segments": [[2, 2]]}, "both ends"),
        ):
            with self.assertRaisesRegex(ValueError, message):
                simplify(SQUARE, heights, **options)
        with self.assertRaisesRegex(ValueError, "at most 2"):
            simplify([(0, 0), (1e99, 0), (0, 1)], [0, 0, 0])

    def test_without_segments_it_is_the_delaunay_triangulation(self):
        points = numpy.random.default_rng(1).normal(size=(1000, 2))
        d, plain = ConstrainedDelaunay(points, []), Delaunay(points)
        self.assertEqual(d.simplices.tolist(), plain.simplices.tolist())
        self.assertEqual((d.constrained_edges.shape, d.inside.any()), ((0, 2), False))

    def test_places_are_found_among_constraints(self):
        rng = numpy.random.default_rng(2)
        points = rng.random((400, 2))
        comb = numpy.column_stack([numpy.repeat(numpy.arange(50) / 50, 2), numpy.tile([0.001, 0.999], 50)])
        d = ConstrainedDelaunay(numpy.vstack([comb, points]), numpy.arange(100).reshape(-1, 2), workers=2)
        places = rng.random((2000, 2))
        row = d.find_simplex(places)
        corner = d.points[d.simplices[row]]
        for k in range(3):
            a, b = corner[:, k], corner[:, (k + 1) % 3]
            left = (b[:, 0] - a[:, 0]) * (places[:, 1] - a[:, 1]) - (b[:, 1] - a[:, 1]) * (places[:, 0] - a[:, 0])
            self.assertTrue((left[row >= 0] > -1e-12).all())
        distance, number = d.query(places)
        want = numpy.hypot(*(places[:, None] - d.points[None]).transpose(2, 0, 1)).min(axis=1)
        self.assertTrue(numpy.allclose(distance, want, rtol=1e-15))
        beyond = {}
        for i, s in enumerate(d.simplices.tolist()):
            beyond.update({(s[k], s[(k + 1) % 3]): i for k in range(3)})
        for i, (s, n) in enumerate(zip(d.simplices.tolist(), d.neighbors.tolist())):
            self.assertEqual(n, [beyond.get((s[(k + 2) % 3], s[(k + 1) % 3]), -1) for k in range(3)])

    def test_what_cannot_be_is_named(self):
        for segments, words in [
            ([[0, 2], [1, 3]], r"segments \[1, 3\] and \[0, 2\] cross where no point is"),
            ([[0, 9]], "point 9 does not exist"),
            ([[1, 1]], "point 1 is both ends of a segment"),
            ([[0, -1]], "from 0 on"),
            ([[0, 2**40]], "from 0 on"),
            ([[0.5, 1]], "shape"),
            ([0, 1, 2], "shape"),
        ]:
            with self.assertRaisesRegex(ValueError, words):
                ConstrainedDelaunay(SQUARE, segments)
        with self.assertRaisesRegex(ValueError, "NaN"):
            ConstrainedDelaunay([(0, float("nan"))], [])
        with self.assertRaises(RuntimeError):
            ConstrainedDelaunay(SQUARE, [[0, 2]]).add_points([(1, 2)])

    def test_polygons_with_holes_and_islands(self):
        island = [(3, 3), (5, 3), (5, 5)]
        d = ConstrainedDelaunay.from_rings([(0, 0), (9, 0), (9, 9), (0, 9), (0, 0)], [(2, 2), (2, 7), (7, 7), (7, 2)], island)
        self.assertEqual(areas(d)[d.inside].sum(), 2 * (81 - 25 + 2))
        places = [(1, 1), (2.5, 3), (4.5, 4), (8, 8)]
        self.assertEqual(d.inside[d.find_simplex(places)].tolist(), [True, False, True, True])
        self.assertEqual(ConstrainedDelaunay.from_rings([(0, 0), (1, 1)]).nsimplex, 0)
        with self.assertRaisesRegex(ValueError, "cross"):
            ConstrainedDelaunay.from_rings([(0, 0), (1, 1), (1, 0), (0, 1)])
        with self.assertRaisesRegex(ValueError, "No rings"):
            ConstrainedDelaunay.from_rings()

    def test_an_open_border_has_nothing_inside(self):
        sides = [[0, 1], [1, 2], [2, 3]]
        self.assertFalse(ConstrainedDelaunay(SQUARE, sides, border=True).inside.any())
        self.assertTrue(ConstrainedDelaunay(SQUARE, sides + [[3, 0]], border=True).inside.all())

    def test_a_copy_and_a_pickle_answer_alike(self):
        d = ConstrainedDelaunay(SQUARE, [[0, 1], [1, 3], [3, 0]], True)
        for other in (pickle.loads(pickle.dumps(d)), copy.copy(d), copy.deepcopy(d)):
            self.assertEqual(other.simplices.tolist(), d.simplices.tolist())
            self.assertEqual(other.inside.tolist(), d.inside.tolist())
            self.assertEqual(other.constrained_edges.tolist(), d.constrained_edges.tolist())
            self.assertIsInstance(other, ConstrainedDelaunay)


if __name__ == "__main__":
    unittest.main()
