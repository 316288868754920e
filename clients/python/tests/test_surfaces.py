"""Surfaces: weights, fields, and Voronoi cells; the cells are compared with SciPy's where it is installed."""

import struct
import unittest
from array import array

from delaunayd import Refused, _protocol

from .common import SQUARE, WithDaemon

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
        self.client.load("t", SQUARE)
        self.client.triangulate("t")
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
        self.client.load("u", points)
        self.client.triangulate("u")
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
        self.client.load("t", SQUARE)
        self.client.triangulate("t")
        kept, _protocol.numpy = _protocol.numpy, None
        try:
            cells = self.client.voronoi("t", ids=[4])
            ids, areas = self.client.areas("t")
        finally:
            _protocol.numpy = kept
        self.assertEqual(cells.corners, array("d", [0, 2, 2, 0, 4, 2, 2, 4]))
        self.assertEqual((list(cells.ids), list(cells.offsets)), ([4], [0, 4]))
        self.assertEqual((list(ids), list(areas)), ([0, 1, 2, 3, 4], [14, 14, 14, 14, 8]))


class Shapes(WithDaemon):
    def setUp(self):
        super().setUp()
        self.client.load("t", SQUARE)
        self.client.triangulate("t")

    def test_alpha_shapes_are_loops(self):
        self.assertEqual(self.client.alpha("t", 2), [(False, [0, 1, 2, 3])])
        self.assertEqual(self.client.alpha("t", 1.5), [])
        ring = [(x, y) for x in range(6) for y in range(6) if not (x in (2, 3) and y in (2, 3))]
        self.client.load("u", ring)
        self.client.triangulate("u")
        outer, hole = self.client.alpha("u", 1)
        self.assertEqual((outer.hole, hole.hole), (False, True))
        self.assertEqual((outer.ids[0], len(outer.ids), len(hole.ids)), (0, 20, 8))
        with self.assertRaises(Refused):
            self.client.alpha("t", -1)

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
    def test_facts_and_values(self):
        self.client.load("t", SQUARE)
        self.client.command("FSET", "t", "z", 0, 1.5, 4, -2.0)
        self.client.command("FSET", "t", "none", 0, "nan")
        fields = self.client.fields("t")
        self.assertEqual(list(fields), ["none", "z"])
        self.assertEqual(fields["z"], (2, -2, 1.5))
        self.assertTrue(fields["none"].least != fields["none"].least)
        self.assertEqual(self.client.get_field("t", "z", [4, 0]), [-2, 1.5])
        self.client.drop_field("t", "none")
        self.assertEqual(list(self.client.fields("t")), ["z"])
        for name in ("", "1z", "a b", "z" * 65):
            with self.assertRaises(Refused):
                self.client.drop_field("t", name)

    def test_weights(self):
        self.client.load("t", SQUARE)
        self.client.triangulate("t")
        self.assertEqual(self.client.weights("t", 2, 1), {0: 0.25, 1: 0.25, 4: 0.5})
        self.assertEqual(self.client.weights("t", 2, -1, "natural"), {})


if __name__ == "__main__":
    unittest.main()
