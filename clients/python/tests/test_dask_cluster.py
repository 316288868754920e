"""delaunayd.dask on a cluster of processes."""

import os
import signal
import tempfile
import time
import unittest
from unittest import mock

try:
    import dask
    import numpy as np
    from distributed import Client, LocalCluster

    from delaunayd.dask import triangulate
    from delaunayd.dask.engine import Engine

    from .sets import families
    from .test_dask import in_order, of_process
except ImportError:
    dask = None


@unittest.skipIf(dask is None, "NumPy, dask or distributed is missing")
class OnACluster(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.cluster = LocalCluster(
            n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None, memory_limit="2GB", local_directory=cls.folder.name
        )
        cls.client = Client(cls.cluster)

    @classmethod
    def tearDownClass(cls):
        cls.client.close()
        cls.cluster.close()
        cls.folder.cleanup()

    def check(self, tin, points):
        with tin:
            self.assertEqual(in_order(tin.triangles.compute()).tobytes(), of_process(points).tobytes())
            self.assertEqual(tin.stats()["points"], len(points))

    def test_processes_make_the_same_triangles(self):
        sets = families(3000)
        for name in ("uniform", "lattice, shuffled", "cross", "duplicates", "line up"):
            self.check(triangulate(sets[name], tile=700), sets[name])

    def test_an_error_leaves_nothing(self):
        points = np.random.default_rng(2).random((200000, 2))
        points[7777] = np.nan
        with tempfile.TemporaryDirectory() as folder, mock.patch("delaunayd.dask.chunks.ROWS", 5000):
            with self.assertRaisesRegex(ValueError, "points, row 7777: nan, nan is not a point"):
                triangulate(points, tile=20000, spill=folder)
            self.assertEqual(os.listdir(folder), [])
        with self.assertRaisesRegex(MemoryError, "use tile="):
            triangulate(points[:7000], tile=1 << 20, client=Small(self.client))

    def test_what_one_task_needs_is_removed_while_another_runs(self):
        def done_when_gone(path):
            while path is not None and os.path.exists(path):
                time.sleep(0.01)
            return path

        with tempfile.NamedTemporaryFile(delete=False) as file:
            calls = [(None,), (file.name,)]
        found = Engine(self.client, False).run("build", done_when_gone, calls, lambda i: os.remove(file.name) if i == 0 else None)
        self.assertEqual(found, [None, file.name])

    def test_a_worker_that_is_killed_changes_nothing(self):
        points = np.random.default_rng(1).random((300000, 2))
        victims = [info["pid"] for info in self.client.run(lambda: {"pid": os.getpid()}).values()]
        killed = []

        def kill_in_the_middle(prefix):
            if len(killed) < len(victims):
                os.kill(victims[len(killed)], signal.SIGKILL)
                killed.append(prefix)

        tin = triangulate(points, tile=20000, client=Deadly(self.client, kill_in_the_middle), keep=False)
        self.assertEqual(killed, ["delaunayd-build", "delaunayd-round"])
        self.check(tin, points)


class Small:
    """A client whose workers have very little memory."""

    def __init__(self, client):
        self._client = client

    def __getattr__(self, name):
        return getattr(self._client, name)

    def scheduler_info(self):
        return {"workers": {"w": {"memory_limit": 1 << 20, "nthreads": 1}}}


class Deadly:
    """A client that runs a function while tasks of building and of rounds are under way."""

    def __init__(self, client, strike):
        self._client, self._strike = client, strike
        self._names = ["delaunayd-build", "delaunayd-round"]

    def __getattr__(self, name):
        return getattr(self._client, name)

    def map(self, function, *columns, key, **options):
        futures = self._client.map(function, *columns, key=key, **options)
        if self._names and key[0].startswith(self._names[0]):
            while not any(future.done() for future in futures):
                time.sleep(0.001)
            self._strike(self._names.pop(0))
        return futures


if __name__ == "__main__":
    unittest.main()
