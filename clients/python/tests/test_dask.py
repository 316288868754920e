"""delaunayd.dask: the triangles of all tilings of all families equal those of one triangulation in process."""

import gc
import os
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

try:
    import dask
    import numpy as np

    from delaunayd.dask import making, triangulate
    from delaunayd.dask.engine import Engine
    from delaunayd.dask.tiling import Cut, Tiling, tiling_of
    from delaunayd.spatial import Delaunay

    from .sets import families, lattice, line
except ImportError:
    dask = None

HERE = str(Path(__file__).resolve().parent.parent)


def in_order(triangles):
    return triangles[np.lexsort(triangles.T[::-1])]


def of_process(points):
    return Delaunay(points).simplices.astype(np.uint32) if len(points) > 0 else np.empty((0, 3), dtype=np.uint32)


def lines_of(contours):
    """All that contour lines have, to be compared."""
    return [(line.level, line.closed, np.asarray(line.line).tobytes()) for line in contours]


def with_tiling(points, tiling, values=None, before=0):
    """As triangulate(), with tiles that it would not choose, and with points before the first."""
    engine, folder = Engine(None, False), tempfile.mkdtemp()
    return making.tin_of(engine, folder, making.reading.chunks_of(points, values, engine, folder), tiling, True, before)


def python(*words, **options):
    """A Python that has this package."""
    return subprocess.Popen([sys.executable, *words], env={**os.environ, "PYTHONPATH": HERE}, text=True, stdout=subprocess.PIPE, **options)


class Synchronous(unittest.TestCase):
    """Tasks run in this process."""

    def setUp(self):
        super().setUp()
        setting = dask.config.set(scheduler="synchronous")
        setting.__enter__()
        self.addCleanup(setting.__exit__, None, None, None)


@unittest.skipIf(dask is None, "NumPy or dask is missing")
class Triangles(Synchronous):
    def check(self, tin, points, what):
        with tin:
            got = in_order(tin.triangles.compute())
            want = of_process(points)
            self.assertEqual(got.dtype, np.uint32)
            self.assertEqual(got.tobytes(), want.tobytes(), what)
            stats = tin.stats()
            self.assertEqual(stats["points"], len(points))
            self.assertEqual(stats["triangles"], len(want))
            distinct = len(np.unique(points + 0.0, axis=0)) if len(points) > 0 else 0
            self.assertEqual(stats["coincident"], len(points) - distinct)

    def test_every_family_equals_one_triangulation(self):
        for n, tile in ((1, 1), (2, 1), (7, 1), (40, 3), (40, 100), (600, 90)):
            for name, points in families(n, n).items():
                self.check(triangulate(points, tile=tile), points, "%s of %d in tiles of %d" % (name, n, tile))

    def test_no_points_have_no_triangles(self):
        self.check(triangulate(np.empty((0, 2))), np.empty((0, 2)), "none")

    def test_random_small_sets_in_random_tilings(self):
        rng = np.random.default_rng(1)
        for k in range(150):
            points = rng.integers(0, rng.integers(2, 9), (rng.integers(1, 30), 2)).astype(np.float64)
            cut = 0

            def divide(depth):
                nonlocal cut
                if depth == 0:
                    cut += 1
                    return cut - 1
                return Cut(int(rng.integers(0, 2)), float(rng.integers(-1, 9)), divide(depth - 1), divide(depth - 1))

            self.check(with_tiling(points, Tiling(divide(3))), points, "set %d: %s" % (k, points.tolist()))

    def test_tiles_may_be_empty(self):
        points = lattice(20, 20)
        nothing = Cut(0, -5.0, 0, Cut(1, 99.0, Cut(0, 10.0, 1, Cut(1, 7.0, 2, 3)), 4))
        self.check(with_tiling(points, Tiling(nothing)), points, "empty tiles")

    def test_lines_of_two_tiles_have_triangles_together(self):
        points = np.concatenate([line(5, 1, 0) - [5, 0], line(5, 1, 0) + [1, 1]])
        self.check(with_tiling(points, Tiling(Cut(0, 0.0, 0, 1))), points, "two lines")

    def test_uniform_points_need_at_most_five_rounds(self):
        points = np.random.default_rng(2).random((40000, 2))
        tin = triangulate(points, tile=3000)
        self.assertLessEqual(tin.stats()["rounds"], 5)
        self.assertEqual(tin.stats()["tiles"], 14)
        self.check(tin, points, "uniform")

    def test_there_is_one_lazy_chunk_for_each_tile(self):
        points = np.random.default_rng(3).random((1000, 2))
        with triangulate(points, tile=300) as tin:
            self.assertEqual(tin.triangles.numblocks, (4, 1))
            self.assertEqual(sum(tin.triangles.chunks[0]), len(of_process(points)))

    def test_files_are_removed_with_the_object_and_after_an_error(self):
        with tempfile.TemporaryDirectory() as folder:
            tin = triangulate(np.random.default_rng(4).random((100, 2)), tile=30, spill=folder)
            self.assertEqual(len(os.listdir(folder)), 1)
            del tin
            gc.collect()
            self.assertEqual(os.listdir(folder), [])
            with self.assertRaisesRegex(ValueError, r"points, row 3: nan, 1.0 is not a point"):
                triangulate([(0, 0), (1, 0), (0, 1), (np.nan, 1), (np.nan, 2)], spill=folder)
            with self.assertRaisesRegex(ValueError, "row 1: 1e-60, 0.0"):
                triangulate([(0, 0), (1e-60, 0)], spill=folder)
            self.assertEqual(os.listdir(folder), [])

    def test_wrong_arguments_are_refused(self):
        for points in ([1, 2, 3], [[1, 2, 3, 4]], 5):
            with self.assertRaisesRegex(ValueError, "shape"):
                triangulate(points)
        with self.assertRaisesRegex(ValueError, "at least 1 point"):
            triangulate([(0, 0)], tile=0)
        with self.assertRaisesRegex(ValueError, "values"):
            triangulate([(0, 0)], [1, 2])

    def test_a_cut_puts_equal_coordinates_on_one_side(self):
        points = np.random.default_rng(5).integers(0, 5, (500, 2)).astype(np.float64)
        tiles = tiling_of(points, 16).split(points)
        self.assertEqual(sum(len(rows) for _, rows in tiles), 500)
        seen = [set(map(tuple, points[rows].tolist())) for _, rows in tiles]
        self.assertEqual(sum(map(len, seen)), len(set().union(*seen)))


class WithoutDask(unittest.TestCase):
    def test_the_package_can_be_imported_without_dask(self):
        text = (
            "import sys\nsys.modules['dask'] = None\nimport delaunayd, delaunayd.client\n"
            "try:\n    import delaunayd.dask\nexcept ImportError:\n    pass\nelse:\n    raise AssertionError\n"
        )
        with python("-c", text) as process:
            self.assertEqual(process.wait(), 0)


if __name__ == "__main__":
    unittest.main()
