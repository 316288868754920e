"""Arguments that could be read in two ways, or only in part, are refused, and the set stays as it is. The test of the package for Node has
the same table: values.test.mjs."""

import unittest
from array import array
from decimal import Decimal
from fractions import Fraction

from delaunayd import Client, _values, aio

from .common import SQUARE, WithDaemon, without_numpy

try:
    import numpy as np

    from delaunayd.interpolate import LinearNDInterpolator
    from delaunayd.spatial import ConstrainedDelaunay, Delaunay, simplify, triangulate_polygon
except ImportError:
    np = None

NAN, INF = float("nan"), float("inf")
NUMBERS = [  # calls with a bad number
    lambda c, v: c.add("t", v, 1), lambda c, v: c.move("t", 0, 1, v), lambda c, v: c.locate("t", v, 0), lambda c, v: c.nearest("t", 0, v),
    lambda c, v: c.alpha("t", v), lambda c, v: c.create("u", v), lambda c, v: c.expire("t", v), lambda c, v: c.within("t", 0, 0, v),
    lambda c, v: c.interpolate("t", "z", [(1, 1)], max_edge=v), lambda c, v: c.contours("t", "z", [v]), lambda c, v: c.bands("t", "z", every=v),
    lambda c, v: c.simplify("t", "z", v, "u"), lambda c, v: c.volume("t", "z", level=v), lambda c, v: c.triangles("t", within=(0, 0, 1, v)),
    lambda c, v: c.set_field("t", "z", [v]), lambda c, v: c.load_paths("t", [[(v, v), (v, v)]]), lambda c, v: c.load("t", [(v, v)]),
    lambda c, v: c.load("t", SQUARE, {"z": [v] * 5}), lambda c, v: c.regions_at("t", [(v, v)]), lambda c, v: c.refine("t", angle=v),
]
IDS = [  # calls with a bad whole number
    lambda c, v: c.delete("t", [v]), lambda c, v: c.get("t", [v]), lambda c, v: c.get_field("t", "z", [v]), lambda c, v: c.move("t", v, 1, 1),
    lambda c, v: c.constrain_path("t", [0, v]), lambda c, v: c.voronoi("t", [v]), lambda c, v: c.nearest("t", 0, 0, v),
    lambda c, v: c.nearest_all("t", [(0, 0)], v), lambda c, v: c.constrain("t", [(0, 1)], number=v), lambda c, v: c.set_field("t", "z", [1], first=v),
    lambda c, v: c.raster("t", "z", (0, 0, 1, 1), v, 1), lambda c, v: c.refine("t", limit=v), lambda c, v: c.constraints("t", [v]),
    lambda c, v: c.wait(v, 0), lambda c, v: c.neighbors("t", v), lambda c, v: c.constrain("t", [(v, v)]),
]


class Refusals(WithDaemon):
    def setUp(self):
        super().setUp()
        self.load("t", SQUARE, {"z": [0, 1, 2, 3, 4]})
        self.before = self.client.digest("t")

    def refused(self, calls, values, *errors):
        for k, call in enumerate(calls):
            for value in values:
                with self.subTest(call=k, value=value):
                    with self.assertRaises(errors):
                        call(self.client, value)
                    self.assertEqual((self.client.digest("t"), self.client.sets()), (self.before, ["t"]))

    def test_what_looks_like_a_number(self):
        self.refused(NUMBERS + IDS, ["3", "", b"3", True, [1, 2], {}, object(), 3j, "x"], TypeError, ValueError)

    def test_an_id_has_no_fraction(self):
        self.refused(IDS, [1.5, NAN, INF, Decimal("0.5"), Fraction(1, 2)], ValueError)

    def test_whole_numbers_that_no_double_equals(self):
        self.refused(NUMBERS, [2**53 + 1, -(2**62) - 1], ValueError)

    def test_text_is_no_list_and_a_point_is_a_pair(self):
        lists = [lambda c, v: c.delete("t", v), lambda c, v: c.get("t", v), lambda c, v: c.constrain_path("t", v), lambda c, v: c.load("t", v),
                 lambda c, v: c.set_field("t", "z", v), lambda c, v: c.contours("t", "z", v), lambda c, v: c.voronoi("t", v)]
        self.refused(lists, ["12", b"12345678", 12, {1: 2}], TypeError, ValueError)
        self.refused([lambda c, v: c.load("t", v)], [[(1, 2, 3)], [(1,)], [1, 2, 3], ["12"]], TypeError, ValueError)
        self.refused([lambda c, v: c.areas("t", box=v)], [(0, 0, 1), (0, 0, 1, 1, 2), ()], ValueError)

    def test_arguments_that_contradict_each_other(self):
        self.refused([lambda c, v: c.contours("t", "z", [1], **v)], [{"every": 2}, {"base": 2}], ValueError)
        self.refused([lambda c, v: c.constraints("t", [1], number=v), lambda c, v: c.release_all("t", border=v or True)], [0], ValueError)

    def test_times_truth_values_and_words(self):
        times = [lambda c, v: Client("private:", timeout=v), lambda c, v: c.mirror("t", timeout=v), lambda c, v: aio.Client("private:", timeout=v)]
        self.refused(times, [-1, 0, NAN, INF, "5", True, [5]], TypeError, ValueError)
        facts = [lambda c, v: c.delete("t", [0], cascade=v), lambda c, v: c.constrain("t", [(0, 1)], border=v), lambda c, v: c.edges("t", constrained=v),
                 lambda c, v: c.constrain_path("t", [0, 1, 2], closed=v), lambda c, v: c.create("u", temporary=v), lambda c, v: c.refine("t", keep=v),
                 lambda c, v: c.load("t", SQUARE, replace=v)]
        self.refused(facts, ["no", "false", 2, [], 1.0], TypeError)
        words = [lambda c, v: c.triangulate("t", v), lambda c, v: c.interpolate("t", "z", [(1, 1)], v), lambda c, v: c.backup(v), lambda c, v: c.info(v)]
        self.refused(words, ["divide BINARY", "", "auto\n", 5, ["linear"]], TypeError)
        self.refused([lambda c, v: c.command("GET", "t", v)], [True, None, [1], 3j], TypeError)

    def test_what_is_a_number_is_taken(self):
        for value in (2, 2.0, Decimal(2), Fraction(2), *([np.int8(2), np.float32(2), np.array(2)] if np else [])):
            self.assertEqual(self.client.get("t", [value]), [(4, 4)])
            self.client.move("t", value, value, 1)
            self.assertEqual(self.client.get("t", range(2, 3)), [(2, 1)])
            self.client.move("t", 2, 4, 4)
        self.client.constrain_path("t", [0, 1, 4], closed=True, border=True, number=1)
        for inside in (1, True, *([np.bool_(True), np.array(1), np.int8(1)] if np else [])):
            self.assertEqual(bytes(self.client.triangles("t", inside=inside)), bytes(array("I", [0, 1, 4])))
        for inside in (False, *([np.bool_(False)] if np else [])):
            self.assertEqual(len(bytes(self.client.triangles("t", inside=inside))), 4 * 12)
        self.assertEqual(len(self.client.triangles("t", inside=None, within=None)), len(self.client.triangles("t")))
        self.assertEqual(list(self.client.points("t", fields="z")[0]), [0, 1, 2, 3, 4])

    def test_iterables_of_points_and_values(self):
        x, y = zip(*SQUARE)
        makers = [
            lambda: (point for point in SQUARE), lambda: map(tuple, SQUARE), lambda: zip(x, y), lambda: iter(SQUARE), lambda: dict.fromkeys(SQUARE).keys(),
        ]
        for make in makers:
            self.assertEqual(self.client.load("u", make(), {"z": (v for v in range(5))}, replace=True), 0)
            self.assertEqual(self.client.get("u", iter(range(5))), [(float(a), float(b)) for a, b in SQUARE])
            self.client.set_field("u", "w", map(float, dict(enumerate(range(5))).values()))
            self.assertEqual(self.client.get_field("u", "z", range(5)), self.client.get_field("u", "w", range(5)))
        self.client.drop("u")
        self.client.load("u", set(SQUARE), {"z": set(range(5))})
        self.assertEqual(sorted(self.client.get("u", range(5))), sorted((float(a), float(b)) for a, b in SQUARE))
        self.client.constrain("t", ((0, i) for i in (1, 3)))
        self.assertEqual(self.client.release("t", zip([0, 0], [1, 3])), 2)
        self.client.load("v", iter(()), {"z": iter(())})
        self.assertEqual(self.client.stat("v")["points"], 0)

    def test_none_is_a_missing_value_and_no_coordinate(self):
        self.refused([lambda c, v: c.load("t", [(v, 1)]), lambda c, v: c.add("t", v, 1), lambda c, v: c.contours("t", "z", [v])], [None], TypeError)
        self.client.load("u", SQUARE, {"z": [1, None, 3, NAN, 5], "none": [None] * 5}, replace=True)
        self.client.load_paths("u", [[(9, 9), (10, 9)]], fields={"z": [iter([None, 2])]})
        found = self.client.get_field("u", "z", range(7))
        self.assertEqual([v for v in found if v == v], [1, 3, 5, 2])
        self.client.set_field("u", "z", [None], first=0)
        self.assertEqual([self.client.fields("u")[name].values for name in ("z", "none")], [3, 0])


class RefusalsWithoutNumPy(Refusals):
    def run(self, result=None):
        with without_numpy():
            return super().run(result)


@unittest.skipIf(np is None, "without NumPy")
class Arrays(unittest.TestCase):
    def test_numbers_of_all_types_and_orders_arrive(self):
        wanted = np.array([[1, 2], [3, 4], [-5, 6]], dtype="f8")
        for dtype in ("f2", "f4", ">f8", ">f4", "i1", ">i2", "i8", "g", "O"):
            np.testing.assert_array_equal(_values.doubles(wanted.astype(dtype)), wanted)
        np.testing.assert_array_equal(_values.doubles(np.repeat(wanted, 2, axis=1)[:, ::2]), wanted)
        np.testing.assert_array_equal(_values.doubles(wanted[::-1]), wanted[::-1])
        np.testing.assert_array_equal(_values.doubles(np.array([2**53, 2**60, -(2**53)])), [2.0**53, 2.0**60, -(2.0**53)])
        self.assertTrue(np.shares_memory(_values.doubles(wanted), wanted))
        self.assertEqual(bytes(_values.pairs(array("d", [1, 2]))[0]), bytes(_values.pairs([(1, 2)])[0]))

    def test_arrays_without_numbers_are_refused_everywhere(self):
        points = np.array(SQUARE, dtype="f8")
        d = Delaunay(points)
        takers = (
            _values.doubles, Delaunay, d.find_simplex, d.query, LinearNDInterpolator(d, points[:, 0]),
            lambda v: LinearNDInterpolator(points, v[:, 0]), lambda v: ConstrainedDelaunay(points, [], z=v[:, 0]), lambda v: simplify(points, v[:, 0]),
        )
        masked = np.ma.masked_array(points, mask=np.eye(5, 2))
        large = np.array([[2**53 + 1, 2]] * 5)
        for bad in (points.astype(str), points > 2, masked, large, large.astype("O"), points.astype("M8[s]"), np.array([["a", None]] * 5)):
            for k, take in enumerate(takers):
                with self.subTest(taker=k, dtype=bad.dtype), self.assertRaises((TypeError, ValueError)):
                    take(bad)
        with self.assertRaises(TypeError):
            Delaunay(points + 1j)

    def test_iterables_and_missing_values_of_classes_in_process(self):
        values = [1, None, 3, None, 5]
        for taken in (_values.known(v for v in values), LinearNDInterpolator(iter(SQUARE), values).values.ravel(), ConstrainedDelaunay(SQUARE, [], z=values).z):
            np.testing.assert_array_equal(taken, [1, NAN, 3, NAN, 5])
        np.testing.assert_array_equal(Delaunay(zip(*zip(*SQUARE))).points, SQUARE)
        for wrong in (values, (v for v in values), {1: 2}, object()):
            with self.subTest(wrong=wrong), self.assertRaises(TypeError):
                _values.doubles(wrong)

    def test_arguments_of_classes_in_process(self):
        points = np.array(SQUARE, dtype="f8")
        d, c = Delaunay(points), ConstrainedDelaunay(points, [(0, 1), (1, 2), (2, 3), (3, 0)], True)
        takers = (
            lambda v: Delaunay(points, workers=v), lambda v: Delaunay(points, incremental=v), lambda v: d.query([(0, 0)], v), lambda v: d.query_ball_point([(0, 0)], v),
            lambda v: d.find_simplex([(0, 0)], tol=v), lambda v: ConstrainedDelaunay(points, [(0, 1)], v), lambda v: ConstrainedDelaunay(points, [(0, 1)], split=v),
            lambda v: ConstrainedDelaunay(points, [(0, 1)], number=v), lambda v: c.refine(v), lambda v: c.refine(limit=v), lambda v: c.refine(keep=v),
            lambda v: simplify(points, points[:, 0], v), lambda v: simplify(points, points[:, 0], most=v), lambda v: LinearNDInterpolator(d, points[:, 0], max_edge=v),
            lambda v: LinearNDInterpolator(points, points[:, 0], rescale=v),
            lambda v: triangulate_polygon({"type": "Polygon", "coordinates": [[(0, 0), (v, 0), (0, v)]]}),
        )
        for k, take in enumerate(takers):
            for value in ("3", "no", "", b"1", {}, 2j):
                with self.subTest(taker=k, value=value), self.assertRaises((TypeError, ValueError)):
                    take(value)
        self.assertEqual(len(ConstrainedDelaunay(points, [], border=[], number=[]).simplices), 4)
        for take in takers[:1] + takers[9:10] + takers[12:13]:
            with self.assertRaises(ValueError):
                take(1.5)


if __name__ == "__main__":
    unittest.main()
