"""delaunayd.spatial in this process: threads, forks, memory, rounding, and without a library."""

import ctypes
import gc
import multiprocessing
import os
import subprocess
import sys
import tempfile
import threading
import unittest
from pathlib import Path
from unittest import mock

from delaunayd import _library

from .common import SQUARE, WithDaemon
from .test_threads import in_threads

try:
    import numpy as np

    from delaunayd.interpolate import LinearNDInterpolator, NaturalNeighborInterpolator
    from delaunayd.spatial import Delaunay
except ImportError:
    np = None

HERE = str(Path(__file__).parent.parent)


def centres_are_found(d):
    centres = d.points[d.simplices].mean(axis=1)
    return d.find_simplex(centres).tolist() == list(range(d.nsimplex))


def work_of_a_child(seed):
    d = Delaunay(np.random.default_rng(seed).random((5000, 2)))
    return centres_are_found(d)


def resident():
    return int(Path("/proc/self/statm").read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE")


@unittest.skipIf(np is None, "NumPy is missing")
class InProcess(unittest.TestCase):
    def test_no_daemon_is_started_and_no_client_imported(self):
        text = (
            "import sys, delaunayd.spatial, delaunayd.interpolate as i\n"
            "assert i.LinearNDInterpolator([(0, 0), (4, 0), (0, 4)], [1, 2, 3])(1, 1) == 1.75\n"
            "assert not any(name in sys.modules for name in ('delaunayd.client', 'socket', 'subprocess', 'numpy.typing'))\n"
        )
        env = {**os.environ, "PYTHONPATH": HERE, "PATH": "/nowhere", "DELAUNAYD": "/nowhere"}
        subprocess.run([sys.executable, "-c", text], env=env, check=True)

    def test_threads_use_one_triangulation_while_points_are_added(self):
        points = np.random.default_rng(1).random((20000, 2))
        d = Delaunay(points[:10000], incremental=True)
        f = LinearNDInterpolator(Delaunay(points), points @ [2, -3])

        def work(i):
            if i == 0:
                for k in range(10000, 20000, 1000):
                    d.add_points(points[k : k + 1000])
                return
            places = np.random.default_rng(i).random((3000, 2)) * 0.8 + 0.1
            for _ in range(20):
                self.assertTrue((d.find_simplex(places) >= 0).all())
                distance, ids = d.query(places, 2)
                self.assertTrue((distance[:, 0] <= distance[:, 1]).all())
                np.testing.assert_allclose(f(places), places @ [2, -3], rtol=0, atol=1e-12)

        in_threads(4, work)
        self.assertEqual(d.simplices.tolist(), Delaunay(points).simplices.tolist())

    def test_other_threads_go_on_meanwhile(self):
        points = np.random.default_rng(2).random((300000, 2))
        counted, done = [0], threading.Event()

        def count():
            while not done.is_set():
                counted[0] += 1

        other = threading.Thread(target=count)
        other.start()
        start = counted[0]
        Delaunay(points, workers=1)
        steps = counted[0] - start
        done.set()
        other.join()
        self.assertGreater(steps, 1000)

    def test_forked_processes_use_it_while_threads_of_the_parent_do(self):
        points = np.random.default_rng(3).random((20000, 2))
        d = Delaunay(points)
        done = threading.Event()

        def work():
            while not done.is_set():
                d.find_simplex(points)
                Delaunay(points)

        threads = [threading.Thread(target=work) for _ in range(3)]
        for thread in threads:
            thread.start()
        try:
            for _ in range(20):
                pid = os.fork()
                if pid == 0:
                    os._exit(0 if centres_are_found(d) and centres_are_found(Delaunay(points)) else 1)
                self.assertEqual(os.waitpid(pid, 0)[1], 0)
        finally:
            done.set()
            for thread in threads:
                thread.join()

    def test_pools_of_processes_use_it(self):
        for method in ("fork", "spawn"):
            with multiprocessing.get_context(method).Pool(2) as pool:
                self.assertEqual(pool.map(work_of_a_child, range(4)), [True] * 4)

    def test_memory_does_not_grow_with_the_number_of_objects(self):
        places = np.random.default_rng(4).random((10, 2))

        def make(n):
            for _ in range(n):
                d = Delaunay(SQUARE)
                d.neighbors, d.find_simplex(places), d.query_ball_point(places, 1)
                LinearNDInterpolator(d, range(5))(places)

        large = np.random.default_rng(5).random((100000, 2))
        make(2000), Delaunay(large), Delaunay(large)
        gc.collect()
        before = resident()
        make(20000)
        for _ in range(20):
            Delaunay(large).find_simplex(large)
        gc.collect()
        self.assertLess(resident() - before, 8 << 20)

    def test_the_rounding_mode_of_the_caller_changes_nothing(self):
        libm = ctypes.CDLL("libm.so.6")
        points = np.stack(np.meshgrid(np.arange(20.0), np.arange(20.0)), 2).reshape(-1, 2) @ [[0.6, 0.8], [-0.8, 0.6]]
        places = np.random.default_rng(6).random((500, 2)) * 10
        values = points @ [1, 2]

        def answers():
            d = Delaunay(points)
            return [d.simplices, d.find_simplex(places), NaturalNeighborInterpolator(d, values)(places)]

        want = answers()
        for mode in (0x400, 0x800, 0xC00):  # FE_DOWNWARD, FE_UPWARD, FE_TOWARDZERO of x86
            if libm.fesetround(mode) != 0:
                continue  # another machine
            try:
                got = answers()
                self.assertEqual(libm.fegetround(), mode)
            finally:
                libm.fesetround(0)
            for a, b in zip(got, want):
                np.testing.assert_array_equal(a, b)

    def test_the_number_of_workers_changes_nothing(self):
        points = np.random.default_rng(7).random((50000, 2))
        one, all = Delaunay(points, workers=1), Delaunay(points, workers=-1)
        np.testing.assert_array_equal(one.simplices, all.simplices)
        np.testing.assert_array_equal(one.find_simplex(points), all.find_simplex(points))
        np.testing.assert_array_equal(one.query(points + 0.001, 3)[1], all.query(points + 0.001, 3, workers=3)[1])
        with self.assertRaises(ValueError):
            Delaunay(points, workers=0)

    def test_arrays_in_any_order_are_read(self):
        points = np.random.default_rng(8).random((100, 4))
        want = Delaunay(points[:, ::2].copy())
        for other in (points[:, ::2], np.asfortranarray(points[:, ::2]), points[:, ::2].tolist()):
            d = Delaunay(other)
            self.assertEqual(d.simplices.tolist(), want.simplices.tolist())
            self.assertEqual(d.find_simplex(points[::-1, ::2]).tolist(), want.find_simplex(want.points[::-1]).tolist())
        single = Delaunay(points[:, ::2].astype(np.float32))
        self.assertEqual(single.points.dtype, np.float64)

    def test_a_point_out_of_range_is_named(self):
        with self.assertRaisesRegex(ValueError, r"points\[2\]"):
            Delaunay([(0, 0), (1, 0), (1e-60, 1), (0, 1e90)])

    def test_who_has_no_library_learns_what_to_do(self):
        with mock.patch.object(_library, "_loaded", None):
            with mock.patch.dict(os.environ, {"DELAUNAY_CORE": "/nowhere/libdelaunay-core.so.0"}):
                with self.assertRaisesRegex(ImportError, "make lib"):
                    Delaunay(SQUARE)
            with tempfile.TemporaryDirectory() as folder:
                empty = folder + "/another.so"
                subprocess.run(["cc", "-shared", "-x", "c", "/dev/null", "-o", empty], check=True)
                with mock.patch.dict(os.environ, {"DELAUNAY_CORE": empty}):
                    with self.assertRaisesRegex(ImportError, "another version"):
                        Delaunay(SQUARE)


@unittest.skipIf(np is None, "NumPy is missing")
class BesideTheDaemon(WithDaemon):
    def test_triangles_values_and_neighbours_are_those_of_the_daemon(self):
        rng = np.random.default_rng(9)
        lattice = np.stack(np.meshgrid(np.arange(15.0), np.arange(12.0)), 2).reshape(-1, 2)
        around = np.linspace(0, 6.28, 300)
        circle = np.column_stack([np.cos(around), np.sin(around)])
        sets = [rng.random((2000, 2)), lattice, rng.permutation(lattice), circle, np.vstack([circle, [[0, 0]]]), lattice[:15],
                lattice @ [[0.6, 0.8], [-0.8, 0.6]], rng.integers(0, 9, (300, 2)) * 1.0, lattice[:1]]
        for k, points in enumerate(sets):
            name, values, places = "t%d" % k, rng.random(len(points)), rng.random((300, 2)) * 3
            self.client.load(name, points, fields={"z": values})
            self.client.triangulate(name)
            d = Delaunay(points)
            self.assertEqual(d.simplices.tolist(), self.client.triangles(name).tolist())
            self.assertEqual(d._now.triangulation.hull().tolist(), self.client.hull(name))
            self.assertEqual(d._coincident.tolist(), [list(pair) for pair in self.client.coincident(name)])
            for kind, method in ((LinearNDInterpolator, "linear"), (NaturalNeighborInterpolator, "natural")):
                want = self.client.interpolate(name, "z", places, method)
                np.testing.assert_array_equal(kind(d, values)(places)[~np.isnan(want)], want[~np.isnan(want)])


if __name__ == "__main__":
    unittest.main()
