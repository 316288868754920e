"""Interpolators compared with those of SciPy, and the surfaces of a client."""

import unittest
from array import array

from delaunayd import Refused, _protocol

from .common import SQUARE, WithDaemon

try:
    import numpy as np

    from delaunayd.interpolate import LinearNDInterpolator, NaturalNeighborInterpolator
    from delaunayd.spatial import Delaunay
except ImportError:
    np = None
try:
    import scipy.interpolate
    import scipy.spatial
except ImportError:
    scipy = None


@unittest.skipIf(np is None, "without NumPy")
class Interpolators(WithDaemon):
    def setUp(self):
        super().setUp()
        self.random = np.random.default_rng(16)
        self.points = self.random.random((2000, 2))

    def ours(self, *args, kind=None, **more):
        return (kind or LinearNDInterpolator)(*args, client=self.client, **more)

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
        for tri in (Delaunay(self.points, client=self.client), scipy.spatial.Delaunay(self.points)):
            self.assertAlmostEqual(float(self.ours(tri, values)(0.25, 0.5)), 0.75)

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
        with self.assertRaises(NotImplementedError):
            self.ours(SQUARE, range(5), rescale=True)
        with self.assertRaises(ValueError):
            self.ours(SQUARE, range(4))
        with self.assertRaises(ValueError):
            self.ours(SQUARE, [0, 1, 2, 3, np.inf])
        with self.assertRaises(ValueError):
            self.ours(np.zeros((5, 3)), range(5))

    def test_the_set_is_made_again_with_its_values(self):
        f = self.ours(SQUARE, [0, 1, 2, 3, 4])
        self.assertEqual(float(f(2, 2)), 4)
        self.client.drop(f.tri._name)
        self.assertEqual(float(f(2, 2)), 4)


@unittest.skipIf(np is None, "without NumPy")
class Surfaces(WithDaemon):
    def setUp(self):
        super().setUp()
        self.client.load("t", SQUARE, fields={"z": [0, 0, 0, 0, 8], "t": [1, 2, np.nan, 4, 5]})
        self.client.triangulate("t")

    def test_fields_are_loaded_with_points(self):
        fields = self.client.fields("t")
        self.assertEqual((fields["z"], fields["t"]), ((5, 0, 8), (4, 1, 5)))
        self.client.set_field("t", "z", [3, np.nan], first=1)
        np.testing.assert_array_equal(self.client.get_field("t", "z", range(5)), [0, 3, np.nan, 0, 8])
        with self.assertRaises(ValueError):
            self.client.load("u", SQUARE, fields={"z": [1, 2]})
        with self.assertRaises(Refused):
            self.client.load("u", SQUARE, fields={"z y": [1] * 5})
        self.assertEqual(self.client.load("u", np.empty((0, 2)), fields={"z": []}), 0)

    def test_values_and_rasters_are_arrays(self):
        np.testing.assert_array_equal(self.client.interpolate("t", "z", [(2, 2), (2, 1), (9, 9)]), [8, 4, np.nan])
        raster = self.client.raster("t", "z", (0, 0, 4, 2), 2, 1)
        np.testing.assert_array_equal(raster, [[4, 4]])
        self.assertEqual(self.client.raster("t", "z", (0, 0, 4, 4), 1, 3).shape, (3, 1))
        nearest = self.client.raster("t", "z", (0, 0, 4, 4), 1, 1, method="nearest", max_edge=100)
        np.testing.assert_array_equal(nearest, [[8]])

    def calls(self, command):
        facts = self.client.info("commands").get("command_" + command, "calls=0")
        return int(facts.split(",")[0][len("calls=") :])

    def test_values_of_any_number_of_places_are_one_request(self):
        places = np.random.default_rng(4).random((5000, 2)) * 4
        calls = self.calls("INTERPOLATEB")
        values = self.client.interpolate("t", "z", places, "natural")
        self.assertEqual(self.calls("INTERPOLATEB"), calls + 1)
        with self.client.pipeline() as p:
            for x, y in places[::500]:
                p.command("INTERPOLATE", "t", "z", x, y, "METHOD", "natural")
        np.testing.assert_array_equal(values[::500], [float(reply.rows[0]) for reply in p.results])
        self.assertEqual(self.client.interpolate("t", "z", []).shape, (0,))
        with self.assertRaises(Refused):
            self.client.interpolate("t", "none", [])

    def test_the_values_of_a_set_are_of_one_state_with_its_points(self):
        self.client.delete("t", [1])
        ids, xy, values = self.client.points("t", fields=["t", "z"])
        self.assertEqual((ids.tolist(), xy.tolist()), ([0, 2, 3, 4], [[0, 0], [4, 4], [0, 4], [2, 2]]))
        np.testing.assert_array_equal(values, [[1, 0], [np.nan, 0], [4, 0], [5, 8]])
        ids, t = self.client.field("t", "t")
        self.assertEqual(ids.tolist(), [0, 2, 3, 4])
        np.testing.assert_array_equal(t, [1, np.nan, 4, 5])
        self.assertEqual(self.client.points("t", fields=[])[2].shape, (4, 0))
        self.assertEqual(len(self.client.points("t")), 2)
        for names in (["none"], ["t,z"], "tz z"):
            with self.assertRaises(Refused):
                self.client.points("t", fields=names)

    def test_contours_are_lines(self):
        (line,) = self.client.contours("t", "z", levels=[4])
        self.assertEqual((line.level, line.closed, line.line.shape), (4, True, (4, 2)))
        self.assertEqual(sorted(line.line.tolist()), [[1, 1], [1, 3], [3, 1], [3, 3]])
        levels = [c.level for c in self.client.contours("t", "z", every=2, base=1)]
        self.assertEqual(levels, [1, 3, 5, 7])
        with self.assertRaises(ValueError):
            self.client.contours("t", "z")

    def test_without_numpy_there_are_flat_arrays(self):
        kept, _protocol.numpy = _protocol.numpy, None
        try:
            self.client.load("v", SQUARE, fields={"z": [1, 2, 3, 4, 5], "t": [6, 7, 8, 9, 10]})
            self.client.triangulate("v")
            self.client.set_field("v", "z", array("d", [9]), first=4)
            self.assertEqual(self.client.get_field("v", "z", range(5)), [1, 2, 3, 4, 9])
            self.assertEqual(self.client.get_field("v", "t", range(5)), [6, 7, 8, 9, 10])
            self.assertEqual(list(self.client.interpolate("v", "z", [(2, 2)])), [9])
            ids, xy, values = self.client.points("v", fields=["t", "z"])
            self.assertEqual((list(ids), list(xy[8:])), ([0, 1, 2, 3, 4], [2, 2]))
            self.assertEqual(list(values), [6, 1, 7, 2, 8, 3, 9, 4, 10, 9])
            self.assertEqual(self.client.field("v", "z")[1], array("d", [1, 2, 3, 4, 9]))
            self.assertEqual(len(self.client.contours("v", "z", levels=[6])[0].line) % 2, 0)
        finally:
            _protocol.numpy = kept


if __name__ == "__main__":
    unittest.main()
