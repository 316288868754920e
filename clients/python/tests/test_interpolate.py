"""Interpolators compared with those of SciPy."""

import copy
import pickle
import unittest

from .common import SQUARE

try:
    import numpy as np

    from delaunayd.interpolate import (
        CloughTocher2DInterpolator,
        LinearNDInterpolator,
        NaturalNeighborInterpolator,
        NearestNDInterpolator,
        SmoothInterpolator,
        griddata,
    )
    from delaunayd.spatial import ConstrainedDelaunay, Delaunay
except ImportError:
    np = None
try:
    import scipy.interpolate
    import scipy.spatial
except ImportError:
    scipy = None


@unittest.skipIf(np is None, "without NumPy")
class Interpolators(unittest.TestCase):
    def setUp(self):
        self.random = np.random.default_rng(16)
        self.points = self.random.random((2000, 2))

    def ours(self, *args, kind=None, **more):
        return (kind or LinearNDInterpolator)(*args, **more)

    @unittest.skipIf(scipy is None, "without SciPy")
    def test_linear_values_are_those_of_scipy(self):
        places = self.random.random((5000, 2)) * 1.2 - 0.1
        for shape in ((), (1,), (3,), (2, 2)):
            values = self.random.random((2000,) + shape)
            for fill in (np.nan, -7.0):
                theirs = scipy.interpolate.LinearNDInterpolator(self.points, values, fill)(places)
                ours = self.ours(self.points, values, fill)(places)
                self.assertEqual(ours.shape, theirs.shape)
                np.testing.assert_allclose(ours, theirs, rtol=0, atol=1e-12)
        values = values + 1j * self.random.random(values.shape)
        theirs = scipy.interpolate.LinearNDInterpolator(self.points, values)(places)
        np.testing.assert_allclose(self.ours(self.points, values)(places), theirs, rtol=0, atol=1e-12)

    @unittest.skipIf(scipy is None, "without SciPy")
    def test_calls_are_those_of_scipy(self):
        values = self.points @ [2, -3]
        theirs, ours = scipy.interpolate.LinearNDInterpolator(self.points, values), self.ours(self.points, values)
        x, y = np.meshgrid(np.linspace(0.1, 0.9, 7), np.linspace(0.2, 0.8, 5))
        calls = [(x, y), ((x, y),), (np.stack([x, y], -1),), (0.5, y), ([0.5, 0.5],), ([[0.5, 0.5]],), (0.25, 0.5), (x[:1], y[:, :1])]
        for args in calls:
            self.assertEqual(np.shape(ours(*args)), np.shape(theirs(*args)))
            np.testing.assert_allclose(ours(*args), theirs(*args), rtol=0, atol=1e-12)
        self.assertEqual(ours(np.empty((0, 2))).shape, (0,))
        for args in (([1, 2, 3],), (x, y, y), (np.zeros((4, 3)),)):
            with self.assertRaises(ValueError):
                ours(*args)

    @unittest.skipIf(scipy is None, "without SciPy")
    def test_a_triangulation_may_stand_for_points(self):
        values = self.points.sum(axis=1)
        for tri in (Delaunay(self.points), scipy.spatial.Delaunay(self.points)):
            self.assertAlmostEqual(float(self.ours(tri, values)(0.25, 0.5)), 0.75)

    def test_smooth_values_need_no_scipy(self):
        places = 0.1 + 0.8 * self.random.random((3000, 2))
        plane = self.points @ [2, -3] + 1
        np.testing.assert_allclose(SmoothInterpolator(self.points, plane)(places), places @ [2, -3] + 1, rtol=0, atol=1e-11)
        wave = np.sin(7 * self.points[:, 0]) * np.cos(5 * self.points[:, 1])
        want = np.sin(7 * places[:, 0]) * np.cos(5 * places[:, 1])
        ours = SmoothInterpolator(self.points, wave)(places)
        linear = LinearNDInterpolator(self.points, wave)(places)
        self.assertLess(np.abs(ours - want).mean(), np.abs(linear - want).mean() / 2)
        np.testing.assert_array_equal(griddata(self.points, wave, places, "smooth"), ours)
        self.assertTrue(np.isnan(SmoothInterpolator(self.points, wave)(9, 9)))
        if scipy is not None:
            theirs = scipy.interpolate.CloughTocher2DInterpolator(self.points, wave)(places)
            self.assertLess(np.abs(ours - theirs).max(), 0.02)

    def test_segments_that_a_triangulation_keeps_shape_the_surface(self):
        points, values = [(0, 0), (10, 0), (5, 1), (5, -1)], [0, 0, 1, 1]
        ridge, valley = Delaunay(points), ConstrainedDelaunay(points, [(0, 1)])
        for make in (LinearNDInterpolator, lambda tri, values: LinearNDInterpolator(pickle.loads(pickle.dumps(tri)), values)):
            self.assertEqual((float(make(ridge, values)(5, 0)), float(make(valley, values)(5, 0))), (1, 0))
        with self.assertRaisesRegex(ValueError, "natural neighbours need a triangulation without segments"):
            NaturalNeighborInterpolator(valley, values)(5, 0)

    def test_natural_neighbours_reproduce_planes_and_points(self):
        values = self.points @ [2, -3] + 1
        places = self.random.random((500, 2)) * 0.9 + 0.05
        for method in ("natural", "laplace"):
            f = self.ours(self.points, values, kind=NaturalNeighborInterpolator, method=method)
            got = f(places)
            inside = ~np.isnan(got)
            self.assertGreater(inside.sum(), 480)
            np.testing.assert_allclose(got[inside], (places @ [2, -3] + 1)[inside], rtol=0, atol=1e-11)
            np.testing.assert_array_equal(f(self.points), values)
        with self.assertRaises(ValueError):
            NaturalNeighborInterpolator(self.points, values, method="cubic")

    def test_missing_values_and_places_that_are_no_numbers(self):
        f = self.ours(SQUARE, [0, 1, 2, 3, np.nan], -1.0)
        got = f([[2, 1], [9, 9], [0, 0], [1, 0], [np.nan, 0], [np.inf, 0], [1e300, 0], [1e-200, 0]])
        np.testing.assert_array_equal(got, [np.nan, -1, 0, 0.25, -1, -1, -1, 0])

    def test_long_edges_have_no_values(self):
        f = self.ours(SQUARE, [1] * 5, max_edge=3.0)
        self.assertTrue(np.isnan(f(2, 0.5)))

    def test_what_cannot_be_done_is_refused(self):
        with self.assertRaises(ValueError):
            self.ours(SQUARE, range(4))
        with self.assertRaises(ValueError):
            self.ours(SQUARE, [0, 1, 2, 3, np.inf])
        with self.assertRaises(ValueError):
            self.ours(np.zeros((5, 3)), range(5))

    def test_interpolators_that_share_a_triangulation_have_values_of_their_own(self):
        tri = Delaunay(self.points)
        many = [self.ours(tri, k + self.points) for k in range(40)]
        for k in (0, 1, 0, 39, 38, 1, 20) + tuple(range(40)):
            np.testing.assert_allclose(many[k](0.25, 0.5), [k + 0.25, k + 0.5], rtol=0, atol=1e-12)
        again = pickle.loads(pickle.dumps(many[:1]))[0]
        for f in (again, many[0], copy.copy(many[0]), many[1]):
            self.assertAlmostEqual(float(f(0.25, 0.5)[0]) % 1, 0.25)

    def test_values_that_are_assigned_are_used_by_the_next_call(self):
        for shape in ((), (3,), (2, 2)):
            given = self.random.random((5,) + shape)
            first = self.ours(SQUARE, given)
            for f in (first, pickle.loads(pickle.dumps(first)), copy.deepcopy(first)):
                self.assertEqual(f(2, 2).tolist(), given[4].tolist())
                f.values[4] = 7
                self.assertEqual(f(2, 2).tolist(), np.full(shape, 7.0).tolist())
                f.values = np.arange(5) * 1j
                self.assertEqual(complex(f(2, 2)), 4j)
                self.assertTrue(f.is_complex)
                with self.assertRaises(ValueError):
                    f.values = np.arange(4)
                self.assertEqual(complex(f(2, 2)), 4j)

    def test_a_triangulation_with_more_points_than_values_is_refused(self):
        tri = Delaunay(SQUARE, incremental=True)
        kinds = [LinearNDInterpolator(tri, range(5)), NearestNDInterpolator(tri, range(5))]
        tri.add_points([(1, 2)])
        for f in kinds:
            with self.assertRaisesRegex(ValueError, "more than there are values"):
                f(1, 1)

    @unittest.skipIf(scipy is None, "without SciPy")
    def test_griddata_and_the_nearest_are_those_of_scipy(self):
        places = self.random.random((400, 2)) * 1.2 - 0.1
        x, y = np.meshgrid(np.linspace(-0.1, 1.1, 13), np.linspace(0, 1, 7))
        wide = self.points * [1000, 1]
        for values in (self.random.random(2000), self.random.random((2000, 2)) + 2j):
            for method in ("nearest", "linear", "cubic"):
                for rescale in (False, True):
                    points = wide if rescale else self.points
                    for xi in (places, (x, y), [(0.5, 0.5)]):
                        args = (points, values, xi, method, -1, rescale)
                        want = scipy.interpolate.griddata(*args)
                        got = griddata(*args)
                        self.assertEqual((got.shape, got.dtype), (want.shape, want.dtype))
                        np.testing.assert_allclose(got, want, rtol=0, atol=1e-9)
        self.assertEqual(griddata(SQUARE, [1, 1, 1, 1, 1], [(1, 1)], "natural").tolist(), [1])
        args = (self.points, self.points.sum(axis=1), -1, 1e-3, 7, True)
        want = scipy.interpolate.CloughTocher2DInterpolator(*args)(places)
        np.testing.assert_allclose(CloughTocher2DInterpolator(*args)(places), want, rtol=0, atol=1e-9)
        with self.assertRaises(ValueError):
            griddata(SQUARE, range(5), [(1, 1)], "spline")

    def test_the_nearest_value_is_that_of_the_first_of_equal_points(self):
        f = NearestNDInterpolator([(1, 1), (0, 0), (1, 1), (0, 0)], ["a", "b", "c", "d"])
        self.assertEqual(f([(0.9, 2), (-5, 0)]).tolist(), ["a", "b"])
        g = NearestNDInterpolator(SQUARE, range(5))
        np.testing.assert_array_equal(g([(2, 2.5), (99, 0)], distance_upper_bound=3), [4, np.nan])

    def test_masked_arrays_without_masked_points_are_arrays(self):
        values = self.points.sum(axis=1)
        f = self.ours(np.ma.masked_array(self.points, mask=False), np.ma.masked_array(values))
        self.assertAlmostEqual(float(f(0.25, 0.5)), 0.75)
        with self.assertRaises(ValueError):
            self.ours(np.ma.masked_array(self.points, mask=self.points > 0.9), values)


if __name__ == "__main__":
    unittest.main()
