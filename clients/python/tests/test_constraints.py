"""Constraints and regions of a daemon's sets, with NumPy and without."""

import asyncio
import unittest
from array import array

from delaunayd import Refused, aio

from .common import WithDaemon, without_numpy

try:
    import numpy
except ImportError:
    numpy = None

# Two parcels with a common side, the left one with a hole, and heights.
PLACES = [(0, 0), (6, 0), (6, 6), (0, 6), (2, 2), (4, 2), (4, 4), (2, 4), (12, 0), (12, 6)]
OUTER, HOLE, RIGHT = [0, 1, 2, 3], [4, 5, 6, 7], [1, 8, 9, 2]


def flat(table):
    return [int(v) for v in (table.ravel() if hasattr(table, "ravel") else table)]


class Constraining(WithDaemon):
    def load_parcels(self):
        c = self.client
        c.load("t", PLACES, {"z": [float(x) for x, _ in PLACES]})
        c.triangulate("t")
        for ring, number in ((OUTER, 1), (HOLE, 1), (RIGHT, 2)):
            self.assertEqual(c.constrain_path("t", ring, closed=True, border=True, number=number)["added"], 4)

    def test_meshes_are_refined_and_what_is_left_is_counted(self):
        c = self.client
        self.load_parcels()
        done = c.refine("t", angle=30, area=0.5, inside=2)
        self.assertEqual((done["first"], done["unrefined"], done["hull"]), (10, 0, 0))
        self.assertGreaterEqual(done["angle"], 30)
        self.assertTrue(done["added"] > 50 and done["split"] > 0 and isinstance(done["added"], int))
        self.assertEqual(c.regions("t").borders[2].triangles * 0.5 >= 36, True)
        self.assertEqual(c.refine("t", length=4, keep=True, limit=0)["added"], 0)
        with self.assertRaises(Refused):
            c.refine("t", angle=60)
        c.load("plain", [(0, 0), (8, 0), (8, 1), (0, 1)])
        c.triangulate("plain")
        self.assertEqual(c.refine("plain")["hull"], 4)

    def test_constraints_are_declared_listed_and_released(self):
        c = self.client
        self.load_parcels()
        self.assertEqual(c.constrain("t", [(0, 4), (6, 2)], number=7)["added"], 2)
        self.assertEqual(c.constrain("t", [(4, 0)], number=7)["added"], 0)
        of = c.constraints("t", number=7)
        self.assertEqual((flat(of.ends), list(of.border), list(of.number)), ([0, 4, 2, 6], [False, False], [7, 7]))
        of = c.constraints("t", ids=[8])
        self.assertEqual((flat(of.ends), list(of.border), list(of.number)), ([1, 8, 8, 9], [True, True], [2, 2]))
        self.assertEqual(len(c.constraints("t").number), 14)
        self.assertEqual(flat(c.edges("t", constrained=True))[:4], [0, 1, 0, 3])
        with self.assertRaises(ValueError):
            c.constraints("t", ids=[1], number=2)
        with self.assertRaises(Refused) as caught:
            c.release("t", [(0, 4)])  # of the number 0
        self.assertEqual(caught.exception.code, "NOCONSTRAINT")
        self.assertEqual(c.release("t", [(0, 4), (0, 4)], number=7), 1)
        self.assertEqual(c.release_all("t", number=2, border=True), 4)
        self.assertEqual(c.release_all("t"), 9)
        self.assertEqual(c.release_all("t"), 0)
        none = c.constraints("t")
        self.assertEqual((len(none.ends), len(none.border), len(none.number)), (0, 0, 0))

    def test_what_is_refused_changes_nothing(self):
        c = self.client
        self.load_parcels()
        for ask, code in [
            (lambda: c.constrain("t", [(3, 4), (0, 7)]), "CROSSES"),
            (lambda: c.constrain("t", [(0, 99)]), "NOPOINT"),
            (lambda: c.constrain("t", [(3, 3)]), "SYNTAX"),
            (lambda: c.constrain("none", [(0, 1)]), "NOSET"),
            (lambda: c.triangles("t", inside=5), "NOREGION"),
        ]:
            with self.assertRaises(Refused) as caught:
                ask()
            self.assertEqual(caught.exception.code, code)
        for bad in ([(0, -1)], [(0, 2**32)], [(0, 1, 2)]):
            with self.assertRaises((ValueError, OverflowError)):
                c.constrain("t", bad)
        for bad in ([1], []):
            with self.assertRaises(ValueError):
                c.constrain_path("t", bad)
        with self.assertRaises(ValueError):
            c.constrain_path("t", [0, 1], closed=True)
        self.assertEqual(len(c.constraints("t").number), 12)

    def test_crossing_constraints_get_points_in_common(self):
        c = self.client
        c.load("t", [(0, 0), (4, 4), (0, 4), (4, 0)], {"z": [0, 4, 4, 0]})
        facts = c.constrain("t", [(0, 1), (2, 3)], number=3, split=True)
        self.assertEqual([facts[key] for key in ("first", "added", "split", "deviation")], [4, 1, 2, 0])
        self.assertEqual(c.get("t", [4]), [(2, 2)])
        self.assertEqual(c.get_field("t", "z", [4]), [2])
        self.assertEqual(set(c.constraints("t").number), {3})

    def test_the_angles_of_triangles(self):
        c = self.client
        c.load("t", [(0, 0), (4, 0), (4, 4), (0, 4), (3, 1)])
        c.triangulate("t")
        found = c.quality("t")
        self.assertEqual((found.triangles, found.area, found.longest), (4, 16, 18**0.5))
        self.assertEqual(found.counts, (0, 0, 0, 2, 0, 0, 0, 0, 0, 2, 0, 0))
        self.assertAlmostEqual(found.angle, 18.43494882292201, 12)
        c.constrain_path("t", [0, 4, 3], closed=True, border=True, number=2)
        inside = c.quality("t", inside=2)
        self.assertEqual((inside.triangles, inside.area, inside.angle), (1, 6, 45))
        self.assertEqual(c.quality("t", inside=True), inside)
        with self.assertRaises(Refused):
            c.quality("t", inside=3)

    def test_regions(self):
        c = self.client
        self.load_parcels()
        found = c.regions("t")
        self.assertEqual((found.area, found.borders[1].area, found.borders[2].area), (68, 32, 36))
        self.assertEqual(found.triangles, found.borders[1].triangles + found.borders[2].triangles)
        self.assertTrue(found.borders[1].closed)
        places = [(1, 1), (3, 3), (6, 3), (9, 3), (13, 3)]
        want = [(1,), (), (1, 2), (2,), ()]
        self.assertEqual(c.regions_at("t", places), want)
        self.assertEqual(c.regions_at("t", places * 500), want * 500)  # more than a line has
        self.assertEqual(c.regions_at("t", []), [])
        c.release("t", [(8, 9)], border=True, number=2)
        self.assertEqual(c.regions("t").borders[2], (False, 0, 0))
        with self.assertRaises(Refused) as caught:
            c.triangles("t", inside=2)
        self.assertEqual(caught.exception.code, "OPEN")

    def test_nothing_outside_of_a_border(self):
        c = self.client
        self.load_parcels()
        self.assertEqual(len(flat(c.triangles("t", inside=2))), 3 * 2)
        self.assertEqual(len(flat(c.triangles("t", inside=True))), 3 * 10)
        self.assertEqual(len(flat(c.triangles("t"))), 3 * 12)
        self.assertEqual(len(flat(c.edges("t", inside=2))), 2 * 5)
        places = [(1, 1), (3, 3), (9, 3)]
        for inside, want in ((None, [1, 3, 9]), (True, [1, None, 9]), (1, [1, None, None])):
            got = [None if v != v else v for v in map(float, c.interpolate("t", "z", places, inside=inside))]
            self.assertEqual(got, want)
        cells = list(map(float, flat_values(c.raster("t", "z", (0, 2, 12, 4), 4, 1, inside=2))))
        self.assertEqual([v == v for v in cells], [False, False, True, True])
        lines = c.contours("t", "z", levels=[3], inside=True)
        self.assertEqual(len(lines), 2)  # above and below the hole
        self.assertEqual(len(c.contours("t", "z", levels=[3])), 1)

    def test_paths_become_points_and_constraints_in_one_request(self):
        c = self.client
        ring = [(0, 0), (4, 0), (0, 4), (0, 0)]
        facts = c.load_paths("t", [ring, [(1, 1), (2, 1)]], border=True, number=3, fields={"z": [[1, 2, 3, 1], [float("nan"), 5]]})
        self.assertEqual((facts["first"], facts["added"], facts["constraints"]), (0, 5, 4))
        self.assertEqual(flat(c.constraints("t").number), [3, 3, 3, 4])
        self.assertEqual(c.get_field("t", "z", [4]), [5])
        c.triangulate("t")
        with self.assertRaisesRegex(Refused, "line 3 crosses"):
            c.load_paths("t", [[(-1, 1.5), (1.5, 1.5)]])
        facts = c.load_paths("t", [array("d", [-1, 1.5, 1.5, 1.5])], split=True)
        self.assertEqual((facts["added"], facts["split"]), (3, 2))
        for paths, fields in (([[(0, 0)]], {"z": [[1, 2]]}), ([[(0, 0)]], {"z": []})):
            with self.assertRaises(ValueError):
                c.load_paths("t", paths, fields=fields)
        self.assertEqual(c.load_paths("u", [])["added"], 0)
        self.assertEqual(c.load_paths("u", [[(1e-7, 1 / 3)]], fields={"z": [[0.1]]})["constraints"], 0)
        self.assertEqual(c.get("u", [0]), [(1e-7, 1 / 3)])

    def test_a_pipeline_and_asyncio(self):
        self.load_parcels()
        with self.client.pipeline() as p:
            p.regions_at("t", [(1, 1)] * 600)
            p.constrain("t", [(0, 4)])
            p.release_all("t", number=0)
        self.assertEqual((p.results[0], p.results[1]["added"], p.results[2]), ([(1,)] * 600, 1, 1))

        async def main():
            async with aio.Client(self.url) as c:
                self.assertEqual(await c.regions_at("t", [(1, 1), (9, 1)]), [(1,), (2,)])
                self.assertEqual(await c.regions_at("t", []), [])
                self.assertEqual((await c.constraints("t")).ends[0].tolist() if numpy else [0, 1], [0, 1])
                self.assertEqual((await c.load_paths("u", [[(0, 0), (1, 1)]]))["constraints"], 1)

        asyncio.run(main())


class WithoutNumPy(Constraining):
    def run(self, result=None):
        with without_numpy():
            return super().run(result)

    def test_a_pipeline_and_asyncio(self):
        self.assertEqual(self.client.load_paths("u", [array("d", [0, 0, 1, 1])])["constraints"], 1)
        self.assertEqual(self.client.constraints("u").ends, array("I", [0, 1]))


def flat_values(table):
    return table.ravel() if hasattr(table, "ravel") else table


if __name__ == "__main__":
    unittest.main()
