"""delaunayd.dask on a cluster of processes."""

import contextlib
import io
import logging
import os
import signal
import tempfile
import time
import unittest
from pathlib import Path
from unittest import mock

try:
    import dask
    import dask.array
    import numpy as np
    from distributed import Client, LocalCluster

    from delaunayd.dask import triangulate
    from delaunayd.dask.engine import Engine

    from .sets import families
    from .test_dask import in_order, lines_of, of_process
except ImportError:
    dask = None


@unittest.skipIf(dask is None, "NumPy, dask or distributed is missing")
class OnACluster(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        # Killed workers are replaced by forks of a process that has imported everything, and a cluster that is busy gives none of them up.
        method, timeout = "distributed.worker.multiprocessing-method", "distributed.deploy.lost-worker-timeout"
        setting = dask.config.set({method: "forkserver", timeout: "1 hour"})
        setting.__enter__()
        cls.addClassCleanup(setting.__exit__, None, None, None)
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

    def test_a_worker_that_is_killed_in_any_phase_changes_nothing(self):
        points = dask.array.from_array(np.random.default_rng(1).random((20000, 2)), chunks=(7000, 2))
        want, deaths = results(points), {}

        def deadly(method):
            def run(engine, name, function, *rest):
                flag = os.path.join(self.folder.name, function.__name__)
                if function.__name__ not in deaths:
                    self.wait_for_workers()
                    deaths[function.__name__] = flag
                    open(flag, "w").close()
                return method(engine, name, Dying(function, flag), *rest)

            return run

        with mock.patch.object(Engine, "run", deadly(Engine.run)), mock.patch.object(Engine, "run_blocks", deadly(Engine.run_blocks)):
            got = results(points)
        self.wait_for_workers()
        self.assertEqual([(k, got[k] == want[k]) for k in want], [(k, True) for k in want])
        phases = ["write_block", "split", "build", "exchange", "finish", "copy", "linear", "nearest", "answer", "pieces", "join", "locate", "hull"]
        self.assertEqual(list(deaths), phases)
        self.assertEqual([flag for flag in deaths.values() if os.path.exists(flag)], [])

    def wait_for_workers(self):
        """A nanny does not replace a worker that is killed before the nanny has heard from it."""
        end = time.monotonic() + 120
        while len(self.client.scheduler_info()["workers"]) < 2 or any(
            nanny.process is None or nanny.process.status.name != "running" for nanny in self.cluster.workers.values()
        ):
            self.assertLess(time.monotonic(), end, "a nanny has not replaced its worker")
            time.sleep(0.01)

    def test_a_task_that_kills_every_worker_is_an_error(self):
        self.wait_for_workers()
        with mock.patch.object(self.cluster.scheduler, "allowed_failures", 0):
            with self.assertRaisesRegex(RuntimeError, "workers have died while they ran delaunayd-build.*use a smaller tile"):
                Engine(self.client, False).run("build", die, [(0,)])
        self.wait_for_workers()


@unittest.skipIf(dask is None, "NumPy, dask or distributed is missing")
class WithoutWorkers(unittest.TestCase):
    def setUp(self):
        self.cluster = LocalCluster(n_workers=0, threads_per_worker=1, processes=False, dashboard_address=None)
        self.addCleanup(self.cluster.close)
        self.client = Client(self.cluster)
        self.addCleanup(self.client.close)

    def test_a_call_waits_for_a_while(self):
        with tempfile.TemporaryDirectory() as folder, self.assertLogs("delaunayd.dask", "WARNING") as said:
            with self.assertRaisesRegex(TimeoutError, "the cluster has had no workers for 0.2 seconds"):
                triangulate([(0, 0), (1, 0), (0, 1)], timeout=0.2, spill=folder)
            self.assertEqual(os.listdir(folder), [])
        self.assertIn("the cluster has no workers; waiting for some, at most 0.2 seconds", said.output[0])

    def test_tasks_wait_for_a_while(self):
        for progress in (False, True):
            with self.assertLogs("delaunayd.dask", "WARNING"), contextlib.redirect_stdout(io.StringIO()):
                with self.assertRaisesRegex(TimeoutError, "no workers"):
                    Engine(self.client, progress, 0.2).run("build", abs, [(-1,), (2,)])

    def send_a_worker(self, record):
        self.cluster.scale(1)
        return True

    def test_a_worker_that_comes_ends_the_waiting(self):
        with mock.patch("delaunayd.dask.watch._PATIENCE", 0.01), self.assertLogs("delaunayd.dask", "WARNING") as said:
            log = logging.getLogger("delaunayd.dask")
            log.addFilter(self.send_a_worker)
            self.addCleanup(log.removeFilter, self.send_a_worker)
            with triangulate([(0, 0), (1, 0), (0, 1)]) as tin:
                self.assertEqual(tin.triangles.compute().tolist(), [[0, 1, 2]])
        self.assertIn("waiting for some, at most 300 seconds", said.output[0])


def results(points):
    """What a Tin of these points has to say, as bytes."""
    with triangulate(points, dask.array.sin(9 * points).sum(axis=1), tile=4000) as tin, tempfile.TemporaryDirectory() as folder:
        tin.to_npy(folder + "/triangles.npy")
        box, shape = (-0.1, -0.1, 1.1, 1.1), (30, 40)
        return {
            "triangles": Path(folder, "triangles.npy").read_bytes(),
            "linear": tin.raster(box, shape).compute().tobytes(),
            "nearest": tin.raster(box, shape, "nearest").compute().tobytes(),
            "contours": lines_of(tin.contours([-0.5, 0.5])),
            "places": tin.locate(np.random.default_rng(2).random((50, 2))).tobytes(),
            "hull": tin.hull().tobytes(),
            "stats": tin.stats(),
        }


def die(*_):
    os.kill(os.getpid(), signal.SIGKILL)


class Dying:
    """A task that kills the first process that finds the flag: when the first file of the task is complete and has no name yet, or else at the end."""

    def __init__(self, function, flag):
        self.function, self.flag = function, flag

    def __call__(self, *call):
        try:
            os.remove(self.flag)
        except FileNotFoundError:
            return self.function(*call)
        os.replace = die
        self.function(*call)
        return die()


class Small:
    """A client whose workers have very little memory."""

    def __init__(self, client):
        self._client = client

    def __getattr__(self, name):
        return getattr(self._client, name)

    def scheduler_info(self):
        return {"workers": {"w": {"memory_limit": 1 << 20, "nthreads": 1}}}


if __name__ == "__main__":
    unittest.main()
