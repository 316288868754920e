"""What delaunayd.dask reads from the tiles of a surface equals what a daemon answers, on all families."""

import unittest

from .common import WithDaemon

try:
    import dask
    import numpy as np

    from delaunayd.dask import triangulate

    from .sets import families, lattice
except ImportError:
    dask = None


def values_of(name, points):
    """Heights with plateaus; on lattices many points are exactly at levels."""
    if name.startswith("lattice"):
        return (points[:, 0] + points[:, 1]) % 5
    return np.sin(points[:, 0] * 7) + np.cos(np.arange(len(points)) % 13)


def box_of(name, points):
    """A box around the points and a shape; the cells of a lattice have its points as centres."""
    if name in ("lattice", "lattice, shuffled"):
        side = int(points.max()) + 1
        return (-0.5, -0.5, side - 0.5, side - 0.5), (side, side)
    if name in ("exponents", "outlier", "wide"):
        return (0, 0, 1, 1), (30, 40)
    return (*points.min(axis=0) - 0.1, *points.max(axis=0) + 0.1), (30, 40)


def places_near(points):
    """Places at random, points, and middles of pairs."""
    low, high = points.min(axis=0), points.max(axis=0)
    places = np.vstack([np.random.default_rng(0).random((200, 2)) * (high - low) + low, points[:30], (points[:30] + points[-30:]) / 2])
    size = np.abs(places)
    return places[((size == 0) | ((size >= 2.0**-142) & (size <= 2.0**201))).all(axis=1)]


@unittest.skipIf(dask is None, "NumPy or dask is missing")
class BesideTheDaemon(WithDaemon):
    def setUp(self):
        super().setUp()
        setting = dask.config.set(scheduler="synchronous")
        setting.__enter__()
        self.addCleanup(setting.__exit__, None, None, None)

    def check(self, name, points, z, tile):
        self.client.load("t", points, fields={"z": z})
        self.client.triangulate("t")
        with triangulate(points, z, tile=tile) as tin:
            self.assertEqual(tin.hull().tolist(), np.asarray(self.client.hull("t")).tolist(), name)
            levels = [-1, 0, 0.5, 1, 2]
            want, got = self.client.contours("t", "z", levels=levels), tin.contours(levels)
            self.assertEqual([(line.level, line.closed) for line in got], [(line.level, line.closed) for line in want], name)
            for a, b in zip(got, want):
                self.assertEqual(a.line.tobytes(), np.asarray(b.line).tobytes(), name)
            box, (rows, columns) = box_of(name, points)
            want = self.client.raster("t", "z", box, columns, rows)
            np.testing.assert_array_equal(tin.raster(box, (rows, columns)).compute(), want, name)
            places = places_near(points)
            np.testing.assert_array_equal(tin.locate(places), self.client.locate_triangles("t", places), name)
        self.client.drop("t")

    def test_hulls_contours_rasters_and_places_of_every_family(self):
        for n, tile in ((40, 6), (300, 60)):
            for name, points in families(n).items():
                self.check(name, points, values_of(name, points), tile)

    def test_heights_may_be_missing(self):
        points = np.random.default_rng(1).random((300, 2))
        z = np.where(np.arange(300) % 9 == 0, np.nan, points[:, 0])
        self.check("missing", points, z, 70)

    def test_a_plateau_at_a_level(self):
        points = lattice(20, 20)
        self.check("plateau", points, np.where(points[:, 0] < 10, 1.0, 0.0), 90)

    def test_boxes_may_be_turned_and_outside(self):
        points = np.random.default_rng(2).random((200, 2))
        self.client.load("t", points, fields={"z": points[:, 0]})
        self.client.triangulate("t")
        with triangulate(points, points[:, 0], tile=60) as tin:
            for box in ((1, 1, 0, 0), (0, 1, 1, 0), (5, 5, 6, 6)):
                want = self.client.raster("t", "z", box, 9, 7)
                np.testing.assert_array_equal(tin.raster(box, (7, 9)).compute(), want)

    def test_what_is_missing_is_said(self):
        points = np.random.default_rng(3).random((50, 2))
        with triangulate(points, tile=20) as tin:
            with self.assertRaisesRegex(ValueError, "no values"):
                tin.raster((0, 0, 1, 1), (2, 2))
            with self.assertRaisesRegex(ValueError, "no values"):
                tin.contours([1])
            with self.assertRaisesRegex(ValueError, "shape"):
                tin.locate([1, 2])
        with triangulate(points, points[:, 0], tile=20, keep=False) as tin:
            with self.assertRaisesRegex(ValueError, "keep=True"):
                tin.locate([(1, 2)])
        with triangulate(points, points[:, 0], tile=20) as tin:
            with self.assertRaisesRegex(ValueError, "linear, not natural"):
                tin.raster((0, 0, 1, 1), (2, 2), "natural")
            with self.assertRaisesRegex(ValueError, "level"):
                tin.contours([np.nan])


if __name__ == "__main__":
    unittest.main()
