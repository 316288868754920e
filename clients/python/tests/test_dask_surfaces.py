"""What delaunayd.dask reads from the tiles of a surface equals what a daemon answers, on all families."""

import unittest

from .common import WithDaemon
from .test_dask import Synchronous, lines_of, with_tiling

try:
    import dask
    import dask.array
    import numpy as np

    from delaunayd.dask import triangulate
    from delaunayd.dask.tiling import Cut, Tiling

    from .sets import families, lattice
except ImportError:
    dask = None
try:
    import pandas
    from dask import dataframe
except ImportError:
    pandas = None


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
class BesideTheDaemon(Synchronous, WithDaemon):
    def check(self, name, points, z, tile):
        self.client.load("t", points, fields={"z": z})
        self.client.triangulate("t")
        with triangulate(points, z, tile=tile) as tin:
            self.assertEqual(tin.hull().tolist(), np.asarray(self.client.hull("t")).tolist(), name)
            levels = [-1, 0, 0.5, 1, 2]
            self.assertEqual(lines_of(tin.contours(levels)), lines_of(self.client.contours("t", "z", levels=levels)), name)
            box, (rows, columns) = box_of(name, points)
            for method in ("linear", "nearest"):
                want = self.client.raster("t", "z", box, columns, rows, method=method)
                np.testing.assert_array_equal(tin.raster(box, (rows, columns), method).compute(), want, (name, method))
            places = places_near(points)
            np.testing.assert_array_equal(tin.locate(places), self.client.locate_triangles("t", places), name)
        self.client.drop("t")

    def test_hulls_contours_rasters_and_places_of_every_family(self):
        for n, tile in ((40, 6), (300, 60)):
            for name, points in families(n).items():
                self.check(name, points, values_of(name, points), tile)

    def test_cells_on_a_line_that_all_points_are_on(self):
        along = np.arange(40.0)
        for a, b in ((1, 0), (0, 1), (1, 1), (-1, 1)):
            points = np.random.default_rng(4).permutation(np.column_stack([a * along, b * along])[[0, 1, 2, *range(5, 31), 39]])
            self.client.load("t", points, fields={"z": points @ [2, 5]})
            self.client.triangulate("t")
            side = (min(39 * a, 0) - 0.25, min(39 * b, 0) - 0.25, max(39 * a, 0) + 0.25, max(39 * b, 0) + 0.25)
            shape = (79 if b else 1, 79 if a else 1)
            with triangulate(points, points @ [2, 5], tile=7) as tin:
                for method in ("linear", "nearest"):
                    want = self.client.raster("t", "z", side, shape[1], shape[0], method=method)
                    self.assertEqual((~np.isnan(want)).sum(), 79)
                    np.testing.assert_array_equal(tin.raster(side, shape, method).compute(), want, (a, b, method))
            self.client.drop("t")
        with triangulate([(3, 4)] * 3, [7, 8, 9], tile=1) as tin:
            for method in ("linear", "nearest"):
                self.assertEqual(tin.raster((2, 3, 4, 5), (1, 1), method).compute().tolist(), [[7.0]])

    def test_the_nearest_point_is_far_inside_another_tile(self):
        """The triangle of the places has corners of three tiles, and the nearest point is of a fourth one, behind two neighbours."""
        triangle = [(-10, 0), (10, 0), (0, 100)]
        tip = [(0, -2), (-0.5, -1.98), (0.5, -1.98)]
        below = [(x / 4, -3 - y) for x in range(-40, 41) for y in range(3)]
        points = np.array([*triangle, *tip, *below])
        for tiling in (Cut(1, -1.0, 0, Cut(1, 50.0, Cut(0, 0.0, 1, 2), 3)), Cut(0, 0.0, 0, Cut(1, 1.0, 1, 2))):
            z = np.arange(len(points), dtype=float)
            self.client.load("t", points, fields={"z": z})
            self.client.triangulate("t")
            with with_tiling(points, Tiling(tiling), z) as tin:
                self.assertGreater(tin.stats()["tiles"], 2)
                box = (-12, -6, 12, 100)
                want = self.client.raster("t", "z", box, 31, 211, method="nearest")
                np.testing.assert_array_equal(tin.raster(box, (211, 31), "nearest").compute(), want)
            self.client.drop("t")

    def test_several_fields_by_numbers_and_names(self):
        points = np.random.default_rng(5).random((400, 2))
        fields = {"z": points[:, 0] ** 2, "t": np.where(np.arange(400) % 7 == 0, np.nan, points[:, 1]), "w": np.arange(400.0)}
        self.client.load("t", points, fields=fields)
        self.client.triangulate("t")
        z = np.column_stack(list(fields.values()))
        chunked = dask.array.from_array(points, chunks=(150, 2))
        frame = [] if pandas is None else [dataframe.from_pandas(pandas.DataFrame({"x": points[:, 0], "y": points[:, 1], **fields}), npartitions=3)]
        lists = {name: [None if v != v else v for v in of.tolist()] for name, of in fields.items()}
        ways = [(points, fields, "zt", "w"), (map(tuple, points), lists, "zt", "w"), (points, z, (0, 1), 2), (chunked, dask.array.from_array(z, chunks=(150, 2)), (0, "1"), "2"),
                (chunked, {k: dask.array.from_array(v, chunks=150) for k, v in fields.items()}, "zt", "w")]
        for given, values, two, last in [*ways, *((one, ["z", "t", "w"], "zt", 2) for one in frame)]:
            with triangulate(given, values, tile=90) as tin:
                box = (0, 0, 1, 1)
                for method in ("linear", "nearest"):
                    want = self.client.raster("t", ["z", "t"], box, 20, 30, method=method)
                    got = tin.raster(box, (30, 20), method, list(two)).compute()
                    np.testing.assert_array_equal(got, want)
                    np.testing.assert_array_equal(tin.raster(box, (30, 20), method, two[1]).compute(), want[:, :, 1])
                self.assertEqual(lines_of(tin.contours([100, 250], last)), lines_of(self.client.contours("t", "w", levels=[100, 250])))
                for wrong in (3, -1, "u"):
                    with self.assertRaisesRegex(ValueError, "no field"):
                        tin.contours([1], wrong)
        self.client.drop("t")

    def test_contours_are_arrays_of_dask_and_outlive_the_files(self):
        points = np.random.default_rng(6).random((500, 2))
        with triangulate(points, np.sin(9 * points).sum(axis=1), tile=90) as tin:
            lines = tin.contours([5, 0.1, -0.2])
            none = tin.contours([])
            levels, closed, ends, places = dask.compute(lines.levels, lines.closed, lines.ends, lines.places)
            self.assertEqual(lines.places.numblocks, (2, 1))  # nothing is as high as 5
            self.assertEqual([part.compute().shape for part in (none.levels, none.closed, none.ends, none.places)], [(0,)] * 3 + [(0, 2)])
        self.assertEqual((len(none), list(none)), (0, []))
        self.assertGreater(len(lines), 2)
        self.assertEqual((levels.dtype, closed.dtype, ends.dtype), (np.float64, np.bool_, np.int64))
        parts = np.split(places, ends[:-1])
        self.assertEqual([(line.level, line.closed, line.line.tolist()) for line in lines],
                         list(zip(levels.tolist(), closed.tolist(), [part.tolist() for part in parts])))
        self.assertEqual([line.level for line in lines[::-1]], levels[::-1].tolist())
        self.assertEqual(lines[-1].line.tolist(), parts[-1].tolist())
        with self.assertRaises(IndexError):
            lines[len(lines)]

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
            for box, shape in (((0, 0, 1, np.nan), (7, 9)), ((0, 0, 1, np.inf), (7, 9)), ((0, 0, 1, 1), (0, 9)), ((0, 0, 1, 1), (7, -1))):
                with self.assertRaisesRegex(ValueError, "a box of finite numbers, and at least one row"):
                    tin.raster(box, shape)

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
            with self.assertRaisesRegex(ValueError, "linear or nearest, not natural"):
                tin.raster((0, 0, 1, 1), (2, 2), "natural")
            with self.assertRaisesRegex(ValueError, "level"):
                tin.contours([np.nan])


if __name__ == "__main__":
    unittest.main()
