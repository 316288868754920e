"""Surfaces: weights, fields, and Voronoi cells, these beside SciPy's where it is installed."""

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
