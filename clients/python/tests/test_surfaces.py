"""Surfaces: weights, fields, values, rasters, contours, and Voronoi cells; the cells are compared with SciPy's where it is installed."""

import struct
import unittest
from array import array

from delaunayd import Refused, _protocol

from .common import SQUARE, WithDaemon, without_numpy

try:
    import numpy as np
except ImportError:
    np = None
try:
    import scipy.spatial
except ImportError:
    scipy = None


@unittest.skipIf(np is None, "without NumPy")
class Voronoi(WithDaemon):
    def test_cells_are_arrays(self):
        self.load("t", SQUARE)
        cells = self.client.voronoi("t")
        self.assertEqual(cells.box, (-2, -2, 6, 6))
        self.assertEqual(cells.ids.tolist(), [0, 1, 2, 3, 4])
        self.assertEqual(cells.offsets.tolist(), [0, 5, 10, 15, 20, 24])
        self.assertEqual(cells.corners[cells.offsets[4] :].tolist(), [[0, 2], [2, 0], [4, 2], [2, 4]])
        ids, areas = self.client.areas("t")
        self.assertEqual((ids.tolist(), areas.tolist()), ([0, 1, 2, 3, 4], [14, 14, 14, 14, 8]))
        some = self.client.voronoi("t", ids=[4, 0], box=(0, 0, 1, 1))
        self.assertEqual((some.ids.tolist(), some.offsets.tolist()), ([0, 4], [0, 4, 4]))
        with self.assertRaises(Refused):
            self.client.voronoi("t", box=(0, 0, 0, 1))

    @unittest.skipIf(scipy is None, "without SciPy")
    def test_cells_are_those_of_scipy(self):
        points = np.random.default_rng(16).random((3000, 2))
        self.load("u", points)
        cells = self.client.voronoi("u", box=(-100, -100, 100, 100))
        theirs = scipy.spatial.Voronoi(points)
        compared = 0
        for i, region in enumerate(theirs.point_region):
            corners = theirs.vertices[theirs.regions[region]]
            if -1 in theirs.regions[region] or np.abs(corners).max() > 99:
                continue
            ours = cells.corners[cells.offsets[i] : cells.offsets[i + 1]]
            self.assertEqual(len(ours), len(corners))
            gap = np.abs(ours[:, None, :] - corners[None, :, :]).max(axis=2).min(axis=1)
            self.assertLess((gap / (1 + np.abs(ours).max(axis=1))).max(), 1e-9)
            compared += 1
        self.assertGreater(compared, 2900)

    def test_corners_that_look_like_the_beginning_of_a_row(self):
        def check(rows):
            data = b"".join(struct.pack("<II%dd" % (2 * len(xy)), id, len(xy), *sum(xy, ())) for id, xy in rows)
            cells = _protocol.cells(_protocol.Reply({"box": "0,0,1,1"}, [], data))
            self.assertEqual(cells.ids.tolist(), [id for id, _ in rows])
            ends = zip(cells.offsets, cells.offsets[1:])
            self.assertEqual([cells.corners[a:b].tolist() for a, b in ends], [list(map(list, xy)) for _, xy in rows])

        check([])
        check([(0, []), (1, [(0.0, -0.0), (1.0, 0.0)]), (7, []), (8, [(0.0, 0.0), (0.5, 5.0), (0.0, 1.0)])])
        check([(3, [(5e-324, 1.0), (1.0, 2e-310), (-5e-324, 0.0)]), (4, [(1e-320, 1e-320)] * 3)])  # subnormal
        check([(0, [(0.0, 0.0)] * 5)])

    def test_without_numpy_cells_are_flat(self):
        self.load("t", SQUARE)
        with without_numpy():
            cells = self.client.voronoi("t", ids=[4])
            ids, areas = self.client.areas("t")
        self.assertEqual(cells.corners, array("d", [0, 2, 2, 0, 4, 2, 2, 4]))
        self.assertEqual((list(cells.ids), list(cells.offsets)), ([4], [0, 4]))
        self.assertEqual((list(ids), list(areas)), ([0, 1, 2, 3, 4], [14, 14, 14, 14, 8]))


class Shapes(WithDaemon):
    def setUp(self):
        super().setUp()
        self.load("t", SQUARE)

    def test_alpha_shapes_are_loops(self):
        self.assertEqual(self.client.alpha("t", 2), [(False, [0, 1, 2, 3])])
        self.assertEqual(self.client.alpha("t", 1.5), [])
        ring = [(x, y) for x in range(6) for y in range(6) if not (x in (2, 3) and y in (2, 3))]
        self.load("u", ring)
        outer, hole = self.client.alpha("u", 1)
        self.assertEqual((outer.hole, hole.hole), (False, True))
        self.assertEqual((outer.ids[0], len(outer.ids), len(hole.ids)), (0, 20, 8))
        with self.assertRaises(Refused):
            self.client.alpha("t", -1)

    def test_the_automatic_radius_gives_one_piece(self):
        self.assertEqual(self.client.alpha_auto("t"), (2, [(False, [0, 1, 2, 3])]))
        self.load("l", [(0, 0), (1, 1)])
        self.assertEqual(self.client.alpha_auto("l"), (0, []))

    def test_a_simplified_set_is_within_the_error(self):
        self.client.load("many", [(x, y) for x in range(9) for y in range(9)])
        self.client.set_field("many", "z", [abs(x - 4) + y / 8 for x in range(9) for y in range(9)])
        facts = self.client.simplify("many", "z", 0.25, "few", ids="old")
        self.assertLess(facts["points"], 20)
        self.assertLessEqual(facts["error"], 0.25)
        self.client.triangulate("few")
        for x in range(9):
            for y in range(9):
                (z,) = self.client.interpolate("few", "z", [(x, y)])
                self.assertLessEqual(abs(z - abs(x - 4) - y / 8), 0.25 + 1e-12)
        self.assertEqual(self.client.simplify("many", "z", 0, "five", points=5)["points"], 5)
        with self.assertRaises(Refused):
            self.client.simplify("many", "z", 1, "few")

    def test_volumes_are_between_a_surface_and_a_level_or_another_surface(self):
        self.client.set_field("t", "z", [0, 0, 0, 0, 3])
        self.client.set_field("t", "low", [1, 1, 1, 1, 1])
        self.assertEqual(self.client.volume("t", "z"), {"above": 16, "below": 0, "area": 16})
        above = self.client.volume("t", "z", level=1)
        self.assertAlmostEqual(above["above"], 128 / 27, 12)
        self.assertEqual(self.client.volume("t", "z", minus="low"), above)
        self.assertEqual(self.client.volume("t", "z", box=(0, 0, 4, 2)), {"above": 8, "below": 0, "area": 8})
        self.client.constrain("t", [(0, 1), (1, 4), (4, 0)], border=True, number=7)
        self.assertEqual(self.client.volume("t", "z", inside=7), {"above": 4, "below": 0, "area": 4})
        with self.assertRaises(Refused):
            self.client.volume("t", "none")

    def test_profiles_have_places_and_the_edges_between(self):
        self.client.set_field("t", "z", [0, 0, 0, 0, 2])
        got = self.client.profile("t", "z", [(0, 1), (2, 1), (2, 5)])
        want = [0, 0, 1, 0, 1, 1, 1, 1, 2, 2, 1, 1, 3, 2, 2, 2, 5, 2, 4, 0, 6, 2, 5, float("nan")]
        self.assertEqual(list(map(str, _flat(got))), list(map(str, map(float, want))))
        with without_numpy():
            self.assertEqual(list(self.client.profile("t", "z", [(0, 1), (1, 1)])), [0, 0, 1, 0, 1, 1, 1, 1])
        self.assertEqual(list(_flat(self.client.profile("t", "z", [(1, 1), (3, 1)], max_edge=4)))[3::4], [1, 1])
        with self.assertRaises(Refused):
            self.client.profile("t", "z", [(0, 1)])
        with self.assertRaises(ValueError):
            self.client.profile("t", "z", [(1, 2, 3)])

    def test_gradients_and_rasters_of_slopes(self):
        self.client.set_field("t", "z", [0, 0, 0, 0, 2])
        self.assertEqual(list(_flat(self.client.gradient("t", "z", [(2, 1), (1, 2), (3, 2)]))), [0, 1, 1, 0, -1, 0])
        self.assertEqual(str(_flat(self.client.gradient("t", "z", [(2, 1)], max_edge=3))[0]), "nan")
        slopes = self.client.raster("t", "z", (0, 0, 4, 4), 2, 2, quantity="slope")
        self.assertEqual(list(_flat(slopes)), [45] * 4)
        aspects = self.client.raster("t", "z", (1, 0, 3, 4), 1, 4, quantity="aspect")
        self.assertEqual(list(_flat(aspects)), [0, 0, 180, 180])
        with self.assertRaises(Refused):
            self.client.raster("t", "z", (0, 0, 4, 4), 2, 2, quantity="slope", method="natural")

    def test_lists_and_triangles_of_a_box(self):
        everything = self.client.lists("t")
        some = self.client.lists("t", within=(0, 0, 2, 2))
        self.assertEqual({i: list(ring) for i, ring in some.items()}, {i: list(everything[i]) for i in (4, 0)})
        flat = list(map(int, _flat(self.client.triangles("t", within=(3, 1.5, 3, 1.75)))))
        self.assertEqual(flat, [1, 2, 4])
        with self.assertRaises(ValueError):
            self.client.triangles("t", within=(0, 0, 1))


def _flat(ids):
    return ids.reshape(-1) if np is not None else ids


class Fields(WithDaemon):
    def test_facts_and_dropped_fields(self):
        self.client.load("t", SQUARE)
        self.client.command("FSET", "t", "z", 0, 1.5, 4, -2.0)
        self.client.command("FSET", "t", "none", 0, "nan")
        fields = self.client.fields("t")
        self.assertEqual(list(fields), ["none", "z"])
        self.assertEqual(fields["z"], (2, -2, 1.5))
        self.assertTrue(fields["none"].least != fields["none"].least)
        self.client.drop_field("t", "none")
        self.assertEqual(list(self.client.fields("t")), ["z"])
        for name in ("", "1z", "a b", "z" * 65):
            with self.assertRaises(Refused):
                self.client.drop_field("t", name)

    def test_weights(self):
        self.load("t", SQUARE)
        self.assertEqual(self.client.weights("t", 2, 1), {0: 0.25, 1: 0.25, 4: 0.5})
        self.assertEqual(self.client.weights("t", 2, -1, "natural"), {})


@unittest.skipIf(np is None, "without NumPy")
class Surfaces(WithDaemon):
    def setUp(self):
        super().setUp()
        self.load("t", SQUARE, fields={"z": [0, 0, 0, 0, 8], "t": [1, 2, np.nan, 4, 5]})

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

    def test_missing_values_are_skipped(self):
        self.load("lacking", SQUARE, fields={"z": [0, 0, 8, 8, np.nan]})
        self.assertTrue(np.isnan(self.client.interpolate("lacking", "z", [(2, 2)])).all())
        skip = {"missing": "skip"}
        np.testing.assert_array_equal(self.client.interpolate("lacking", "z", [(2, 2), (2, 1)], **skip), [4, 2])
        np.testing.assert_array_equal(self.client.raster("lacking", "z", (0, 0, 4, 4), 1, 2, **skip), [[6], [2]])
        np.testing.assert_array_equal(self.client.gradient("lacking", "z", [(1, 1)], **skip), [[0, 2]])
        np.testing.assert_array_equal(self.client.profile("lacking", "z", [(0, 1), (0, 2)], **skip)[:, 3], [2, 4])
        self.assertEqual(self.client.volume("lacking", "z", **skip), {"above": 64, "below": 0, "area": 16})
        self.assertEqual([line.level for line in self.client.contours("lacking", "z", [2], **skip)], [2])
        self.assertEqual(len(self.client.bands("lacking", "z", [2, 6], **skip)), 1)
        self.assertEqual(self.client.contours("lacking", "z", [2], missing="nan"), [])
        with self.assertRaises(Refused):
            self.client.interpolate("lacking", ["z", "z"], [(2, 2)], **skip)

    def test_several_fields_are_an_axis(self):
        self.load("both", SQUARE, fields={"z": [0, 0, 8, 8, 4], "s": [1, 2, 3, 4, np.nan]})
        np.testing.assert_array_equal(self.client.interpolate("both", ["z", "s"], [(0, 0), (2, 2), (4, 2)]), [[0, 1], [4, np.nan], [4, 2.5]])
        self.assertEqual(self.client.interpolate("both", ["z"], [(0, 0)]).shape, (1, 1))
        self.assertEqual(self.client.interpolate("both", ["z", "s"], []).shape, (0, 2))
        gradient = self.client.gradient("both", ("z", "s"), [(1, 1), (2, 2), (3, 1)])
        self.assertEqual(gradient.shape, (3, 2, 2))
        np.testing.assert_array_equal(gradient[:, 0], [[0, 2]] * 3)
        raster = self.client.raster("both", ["s", "z", "s"], (0, 0, 4, 4), 5, 4)
        self.assertEqual(raster.shape, (4, 5, 3))
        for k, field in enumerate("szs"):
            np.testing.assert_array_equal(raster[:, :, k], self.client.raster("both", field, (0, 0, 4, 4), 5, 4))
        with self.assertRaises(Refused):
            self.client.interpolate("both", ["z", "s,z"], [(0, 0)])

    def test_values_go_on_beyond_the_hull_and_are_clipped(self):
        self.client.set_field("t", "z", [1, 5])
        np.testing.assert_array_equal(self.client.interpolate("t", "z", [(2, -3), (9, -1)], outside="nearest"), [3, 5])
        np.testing.assert_array_equal(self.client.interpolate("t", "z", [(2, -3)], outside="nan"), [np.nan])
        raster = self.client.raster("t", "z", (0, -4, 4, 4), 2, 2, outside="nearest")
        np.testing.assert_array_equal(raster[1], [2, 4])
        self.client.load("field", [(0, 0), (2, 0), (2, 9), (0, 9)])
        self.client.constrain_path("field", [0, 1, 2, 3], closed=True, border=True)
        self.client.triangulate("field")
        raster = self.client.raster("t", "z", (0, 0, 4, 4), 2, 1, clip="field")
        np.testing.assert_array_equal(np.isnan(raster), [[False, True]])
        with self.assertRaises(Refused):
            self.client.raster("t", "z", (0, 0, 4, 4), 2, 1, clip="none")

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

    def test_bands_are_polygons_with_holes(self):
        low, high = self.client.bands("t", "z", levels=[2, 4, float("inf")])
        self.assertEqual((low.low, low.high, high.low, high.high), (2, 4, 4, float("inf")))
        self.assertEqual([ring.tolist() for ring in low.rings],
                         [[[0.5, 0.5], [3.5, 0.5], [3.5, 3.5], [0.5, 3.5]], [[1, 1], [1, 3], [3, 3], [3, 1]]])
        self.assertEqual(high.rings[0].tolist(), low.rings[1][[0, 3, 2, 1]].tolist())
        self.assertEqual([(b.low, b.high) for b in self.client.bands("t", "z", every=5, base=1)], [(-4, 1), (1, 6), (6, 11)])
        self.assertEqual(self.client.bands("t", "z", levels=[1]), [])
        shape = low.__geo_interface__
        self.assertEqual((shape["type"], [len(ring) for ring in shape["coordinates"]]), ("Polygon", [5, 5]))
        self.assertEqual({ring[0] == ring[-1] for ring in shape["coordinates"]}, {True})
        with self.assertRaises(ValueError):
            self.client.bands("t", "z")

    def test_bands_in_shapely_and_matplotlib(self):
        try:
            import matplotlib  # noqa: F401
            from shapely.geometry import shape
        except ImportError:
            self.skipTest("without shapely and Matplotlib")
        low, high = self.client.bands("t", "z", levels=[2, 4, 9])
        self.assertEqual((shape(low).is_valid, shape(low).area, shape(high).area), (True, 5, 4))
        self.assertEqual([len(ring) for ring in low.path().to_polygons()], [5, 5])

    def test_without_numpy_there_are_flat_arrays(self):
        with without_numpy():
            self.load("v", SQUARE, fields={"z": [1, 2, 3, 4, 5], "t": [6, 7, 8, 9, 10]})
            self.client.set_field("v", "z", array("d", [9]), first=4)
            self.assertEqual(self.client.get_field("v", "z", range(5)), [1, 2, 3, 4, 9])
            self.assertEqual(self.client.get_field("v", "t", range(5)), [6, 7, 8, 9, 10])
            self.assertEqual(list(self.client.interpolate("v", "z", [(2, 2)])), [9])
            ids, xy, values = self.client.points("v", fields=["t", "z"])
            self.assertEqual((list(ids), list(xy[8:])), ([0, 1, 2, 3, 4], [2, 2]))
            self.assertEqual(list(values), [6, 1, 7, 2, 8, 3, 9, 4, 10, 9])
            self.assertEqual(self.client.field("v", "z")[1], array("d", [1, 2, 3, 4, 9]))
            self.assertEqual(len(self.client.contours("v", "z", levels=[6])[0].line) % 2, 0)
            (band,) = self.client.bands("v", "z", levels=[float("-inf"), float("inf")])
            self.assertEqual(list(band.rings[0]), [0, 0, 4, 0, 4, 4, 0, 4])
            self.assertEqual(band.__geo_interface__["coordinates"], (((0, 0), (4, 0), (4, 4), (0, 4), (0, 0)),))


if __name__ == "__main__":
    unittest.main()
