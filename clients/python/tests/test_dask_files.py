"""delaunayd.dask: what it reads and writes, the command line, and what does not suffice."""

import contextlib
import gzip
import io
import json
import os
import signal
import subprocess
import sys
import tempfile
import time
import types
import unittest
from pathlib import Path
from unittest import mock

try:
    import dask
    import dask.array
    import numpy as np

    from delaunayd.dask import limits, making, reading, triangulate
    from delaunayd.dask.engine import Engine
    from delaunayd.spatial import Delaunay

    from .test_dask import in_order, of_process
except ImportError:
    dask = None

try:
    import pandas
except ImportError:
    pandas = None
try:
    import distributed
except ImportError:
    distributed = None

HERE = str(Path(__file__).resolve().parent.parent)


@unittest.skipIf(dask is None, "NumPy or dask is missing")
class Files(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = folder.name
        setting = dask.config.set(scheduler="synchronous")
        setting.__enter__()
        self.addCleanup(setting.__exit__, None, None, None)
        self.points = np.random.default_rng(1).random((500, 2))
        self.z = self.points @ [3.0, 4.0]

    def path(self, name, text=None):
        path = os.path.join(self.folder, name)
        if text is not None:
            with gzip.open(path, "wt") if name.endswith("gz") else open(path, "w") as file:
                file.write(text)
        return path

    def check(self, points, values=None, has_values=False):
        with triangulate(points, values, tile=90, spill=self.folder) as tin:
            self.assertEqual(in_order(tin.triangles.compute()).tobytes(), of_process(self.points).tobytes())
            if has_values:
                cells = tin.raster((0.3, 0.3, 0.7, 0.7), (5, 5)).compute()
                centres = 0.34 + 0.08 * np.arange(5)
                np.testing.assert_allclose(cells, 4 * centres[::-1, None] + 3 * centres, atol=1e-12)

    def test_files_of_arrays(self):
        table = np.column_stack([self.points, self.z])
        np.save(self.path("a.npy"), self.points[:200])
        np.save(self.path("b.npy"), self.points[200:])
        np.save(self.path("z.npy"), np.asfortranarray(table))
        self.check([self.path("a.npy"), Path(self.path("b.npy"))])
        self.check(self.path("z.npy"), has_values=True)
        with self.assertRaisesRegex(ValueError, "z.npy has values, and .*a.npy has none"):
            triangulate([self.path("a.npy"), self.path("z.npy")])

    def test_files_of_text(self):
        rows = ["%r,%r,%r\n" % (*p, z) for p, z in zip(self.points.tolist(), self.z.tolist())]
        plain = self.path("a.csv", "x,y,z\n" + "".join(rows[:300]))
        packed = self.path("b.csv.gz", "".join(rows[300:]) + "\n")
        with mock.patch.object(reading, "_LINES", 70):
            self.check([plain, packed], has_values=True)

    def test_chunks_smaller_than_files(self):
        np.save(self.path("a.npy"), self.points)
        with mock.patch("delaunayd.dask.chunks.ROWS", 64):
            self.check(self.path("a.npy"))
            self.check(self.points, self.z, True)

    def test_laser_points(self):
        parts = [self.points[:100], self.points[100:]]

        class Reader:
            def __enter__(self):
                return self

            def __exit__(self, *error):
                pass

            def chunk_iterator(self, size):
                return (types.SimpleNamespace(x=p[:, 0], y=p[:, 1], z=p @ [3.0, 4.0]) for p in parts)

        with mock.patch.dict(sys.modules, {"laspy": types.SimpleNamespace(open=lambda path: Reader())}):
            self.check(self.path("a.laz", ""), has_values=True)
        with mock.patch.dict(sys.modules, {"laspy": None}), self.assertRaisesRegex(ImportError, "a.laz needs laspy"):
            triangulate(self.path("a.laz"))

    def test_collections_of_dask(self):
        array = dask.array.from_array(self.points, chunks=(130, 1))
        self.check(array)
        self.check(dask.array.from_array(self.points, chunks=(130, 2)), dask.array.from_array(self.z, chunks=130), True)
        self.check(dask.array.concatenate([array, dask.array.from_array(self.z, chunks=130)[:, None]], axis=1), has_values=True)
        with self.assertRaisesRegex(ValueError, "chunks of points"):
            triangulate(array, dask.array.from_array(self.z, chunks=100))

    @unittest.skipIf(pandas is None, "pandas is missing")
    def test_dataframes(self):
        import dask.dataframe

        frame = pandas.DataFrame({"name": "p", "z": self.z, "y": self.points[:, 1], "x": self.points[:, 0]})
        self.check(dask.dataframe.from_pandas(frame, npartitions=4), has_values=True)
        with self.assertRaisesRegex(ValueError, "columns x and y"):
            triangulate(dask.dataframe.from_pandas(frame[["x"]], npartitions=1))

    def test_a_bad_row_is_named(self):
        bad = self.points.copy()
        bad[321, 1] = np.nan
        np.save(self.path("good.npy"), self.points)
        np.save(self.path("bad.npy"), bad)
        before = sorted(os.listdir(self.folder))
        with self.assertRaisesRegex(ValueError, r"bad\.npy, row 321: .*, nan is not a point"):
            triangulate([self.path("good.npy"), self.path("bad.npy")], spill=self.folder)
        for text, message in (
            ("1,2\n3,4\n5,six\n", r"a\.csv, row 2: '5,six' is not a point"),
            ("x,y\n1,2\n3\n", r"a\.csv, row 1: '3' is not a point"),
            ("1,2\n3,inf\n", r"a\.csv, row 1: 3.0, inf is not a point"),
            ("1\n2\n", r"a\.csv, row 0: there are 1 columns"),
        ):
            with self.assertRaisesRegex(ValueError, message):
                triangulate(self.path("a.csv", text), spill=self.folder)
        os.remove(self.path("a.csv"))
        self.assertEqual(sorted(os.listdir(self.folder)), before)
        with self.assertRaises(FileNotFoundError):
            triangulate(self.path("nothing.npy"))
        with self.assertRaisesRegex(ValueError, "must end with .npy"):
            triangulate(self.path("points.shp"))

    def test_files_without_rows_among_others(self):
        np.save(self.path("a.npy"), np.column_stack([self.points, self.z]))
        np.save(self.path("none.npy"), np.empty((0, 2)))
        for name, text in (("zero.csv", ""), ("blank.csv", "\n \n"), ("names.csv", "x,y,z\n"), ("names.csv.gz", "x,y\n")):
            self.path(name, text)
        nothing = [self.path(name) for name in ("none.npy", "zero.csv", "blank.csv", "names.csv", "names.csv.gz")]
        self.check([*nothing, self.path("a.npy"), *nothing], has_values=True)
        with triangulate(nothing, spill=self.folder) as tin:
            self.assertEqual((tin.triangles.compute().shape, tin.stats()["points"]), ((0, 3), 0))

    def test_text_of_other_programs(self):
        rows = ["%r , %r,%r" % (*p, z) for p, z in zip(self.points.tolist(), self.z.tolist())]
        for text in (
            "x,y,z\r\n" + "\r\n".join(rows), "\n\nx,y,z\n\n" + "\n\n".join(rows) + "\n \n", "\ufeff" + "\n".join(rows),
            '\ufeff"x","y","z"\n' + "\n".join(rows), "\r".join(rows),
        ):
            with open(self.path("a.csv"), "w", newline="", encoding="utf-8") as file:
                file.write(text)
            with mock.patch.object(reading, "_LINES", 2):
                self.check(self.path("a.csv"), has_values=True)

    def test_numbers_of_every_type_and_order(self):
        whole = np.random.default_rng(3).integers(0, 99, (500, 2))
        for points in (
            whole, whole.astype(np.uint8), whole.astype(">i4"), self.points.astype(np.float32), self.points.astype(np.float16),
            self.points.astype(">f8"), np.asfortranarray(self.points), self.points.astype(np.longdouble),
        ):
            np.save(self.path("a.npy"), points)
            for given in (self.path("a.npy"), points):
                with triangulate(given, tile=90, spill=self.folder) as tin:
                    got = in_order(tin.triangles.compute())
                    self.assertEqual(got.tobytes(), of_process(points.astype(np.float64)).tobytes(), points.dtype)

    def test_files_that_are_no_points_are_named(self):
        for dtype in (complex, bool, "U20", object):
            np.save(self.path("a.npy"), self.points.astype(dtype))
            with self.assertRaisesRegex(ValueError, r"a\.npy .*(not numbers|not a file of numbers)"):
                triangulate(self.path("a.npy"), spill=self.folder)
        with self.assertRaisesRegex(ValueError, "complex"):
            triangulate(self.points.astype(complex))
        np.save(self.path("a.npy"), self.points)
        whole = Path(self.path("a.npy")).read_bytes()
        packed = gzip.compress(b"1,2\n" * 100)
        for name, content in (
            ("a.npy", whole[:-1]), ("a.npy", b""), ("a.npy", b"1,2\n"), ("a.csv", b"1,2\n\xe9,3\n"), ("a.csv.gz", b"1,2\n"),
            ("a.csv.gz", packed[:-9]), ("a.csv.gz", packed[:12] + b"\xff" * 20), ("a.csv", b"1,two\n3,4\n"),
        ):
            Path(self.path(name)).write_bytes(content)
            with self.assertRaisesRegex(ValueError, r"/%s(, | is )" % name.replace(".", r"\."), msg=content):
                triangulate(self.path(name), spill=self.folder)
        self.assertEqual(sorted(os.listdir(self.folder)), ["a.csv", "a.csv.gz", "a.npy"])

    def test_triangles_are_written_to_one_file(self):
        target = self.path("triangles.npy")
        with triangulate(self.points, tile=90) as tin:
            tin.to_npy(target)
            written = np.load(target)
            self.assertEqual(written.dtype, np.uint32)
            self.assertEqual(written.tobytes(), tin.triangles.compute().tobytes())
            with self.assertRaises(OSError):
                tin.to_npy(self.path("missing/triangles.npy"))
            with mock.patch("importlib.util.find_spec", return_value=None), self.assertRaisesRegex(ImportError, "pyarrow or fastparquet"):
                tin.to_parquet(self.path("triangles"))
        self.assertEqual(os.listdir(self.folder), ["triangles.npy"])

    def test_numbers_beyond_32_bits(self):
        shifted = np.arange(0, 500, 100)
        engine, folder = Engine(None, False), tempfile.mkdtemp(dir=self.folder)
        chunks = [chunk for chunk in making.reading.chunks_of(self.points, None, engine, folder).chunks]
        job = making.Job(folder, (), "<u8", (2**33,))  # as if other files were before this one
        course = making.Course(engine, job, chunks, making.tiling_of(self.points, 5), True)
        course.split()
        with making.Tin(engine, course.run(), True) as tin:
            got = tin.triangles.compute()
            self.assertEqual(got.dtype, np.uint64)
            np.testing.assert_array_equal(in_order(got) - np.uint64(2**33), of_process(self.points).astype(np.uint64))
            np.testing.assert_array_equal(tin.locate(self.points[shifted]).min(axis=1) >= 2**33, True)
            np.testing.assert_array_equal(np.sort(tin.hull()), np.unique(Delaunay(self.points).convex_hull) + 2**33)

    def test_too_little_memory_is_an_error_before_anything_is_read(self):
        class Small(Engine):
            def memory(self):
                return 1 << 30, 2

        limits.check_memory(Small(None, False), 4_000_000, 0)
        with self.assertRaisesRegex(MemoryError, r"a tile of 10000000 points needs about .* GB, and each of 2 threads .*: use tile=\d+ or less"):
            limits.check_memory(Small(None, False), 10_000_000, 0)
        with self.assertRaisesRegex(ValueError, "2\\^28"):
            limits.check_memory(Small(None, False), 1 << 29, 0)

    def test_text_is_not_read_if_a_tile_of_it_is_too_large(self):
        path = self.path("a.csv", "0,0\n" + " " * (128 << 20))
        self.assertEqual(reading.least([path, path]), 2 << 20)
        with mock.patch.object(Engine, "memory", return_value=(1 << 29, 2)), mock.patch.object(reading, "convert") as convert:
            with self.assertRaisesRegex(MemoryError, "a tile of 2097152 points"):
                triangulate([path, path], spill=self.folder)
            convert.assert_not_called()
        self.assertEqual(os.listdir(self.folder), ["a.csv"])

    def test_too_little_disk_is_an_error_before_anything_is_written(self):
        with mock.patch("shutil.disk_usage", return_value=types.SimpleNamespace(free=20000)):
            with self.assertRaisesRegex(OSError, "500 points need about .* in the spill folder"):
                triangulate(self.points, spill=self.folder)
        self.assertEqual(os.listdir(self.folder), [])

    def test_a_disk_that_fills_up_is_an_error_and_leaves_nothing(self):
        text = (
            "import os, resource, sys, dask, numpy as np\nfrom delaunayd.dask import triangulate\n"
            "dask.config.set(scheduler='synchronous')\n"
            "resource.setrlimit(resource.RLIMIT_FSIZE, (int(sys.argv[2]), resource.RLIM_INFINITY))\n"
            "try:\n    with triangulate(np.random.default_rng(1).random((20000, 2)), tile=3000, spill=sys.argv[1]) as tin:\n"
            "        tin.to_npy(sys.argv[1] + '/triangles.npy')\n"
            "except OSError as error:\n    print(error.strerror, os.path.basename(error.filename))\n"
        )
        env = {**os.environ, "PYTHONPATH": HERE}
        for limit, kind in ((1000, "piece-"), (59000, "done-"), (200000, "triangles.npy.")):
            said = subprocess.check_output([sys.executable, "-c", text, self.folder, str(limit)], text=True, env=env)
            self.assertTrue(said.startswith("File too large " + kind), said)
            self.assertEqual(os.listdir(self.folder), [])


@unittest.skipIf(dask is None, "NumPy or dask is missing")
class KilledProcesses(unittest.TestCase):
    def test_their_folders_are_removed_and_no_others(self):
        text = (
            "import sys, dask, numpy as np\nfrom delaunayd.dask import triangulate\ndask.config.set(scheduler='synchronous')\n"
            "tin = triangulate(np.random.default_rng(1).random((300, 2)), tile=90, spill=sys.argv[1])\n"
            "print(tin._job.folder, flush=True)\nsys.stdin.read()\n"
        )

        def started():
            process = subprocess.Popen(
                [sys.executable, "-c", text, folder], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True,
                env={**os.environ, "PYTHONPATH": HERE},
            )
            return process, os.path.basename(process.stdout.readline().strip())

        def ended(process):
            process.communicate()
            return process.returncode

        with tempfile.TemporaryDirectory() as folder:
            for name, owner in (("delaunayd-notes", None), ("delaunayd-others", "me"), ("delaunayd-away", "delaunayd.dask another-machine\n")):
                os.mkdir(os.path.join(folder, name))
                if owner is not None:
                    Path(folder, name, "owner").write_text(owner)
            others = set(os.listdir(folder))
            dead, left = started()
            dead.kill()
            self.assertEqual(ended(dead), -9)
            self.assertEqual(set(os.listdir(folder)), others | {left})
            self.assertGreater(len(os.listdir(os.path.join(folder, left))), 4)
            living, kept = started()
            self.assertEqual(set(os.listdir(folder)), others | {kept})
            points = np.random.default_rng(2).random((50, 2))
            with triangulate(points, spill=folder) as tin:
                self.assertEqual(len(os.listdir(folder)), len(others) + 2)
                self.assertEqual(in_order(tin.triangles.compute()).tobytes(), of_process(points).tobytes())
            self.assertEqual(set(os.listdir(folder)), others | {kept})
            self.assertEqual(ended(living), 0)
            self.assertEqual(set(os.listdir(folder)), others)


@unittest.skipIf(dask is None or distributed is None, "NumPy, dask or distributed is missing")
class CommandLine(unittest.TestCase):
    def test_files_become_triangles_a_raster_and_contours(self):
        points = np.random.default_rng(1).random((3000, 2))
        with tempfile.TemporaryDirectory() as folder:
            np.save(folder + "/p.npy", np.column_stack([points, points[:, 0]]))
            words = "%s/p.npy --out %s/out --tile 800 --workers 1 --memory 1GB --quiet --contours 0.5 --raster 0.2 0.2 0.8 0.8 6 3"
            env = {**os.environ, "PYTHONPATH": HERE}
            command = [sys.executable, "-m", "delaunayd.dask", *(words % (folder, folder)).split()]
            said = subprocess.run(command, env=env, check=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
            self.assertEqual(json.loads(said.stdout)["points"], 3000)
            self.assertEqual(sorted(os.listdir(folder + "/out")), ["contours.geojson", "raster.npy", "triangles.npy"])
            self.assertEqual(in_order(np.load(folder + "/out/triangles.npy")).tobytes(), of_process(points).tobytes())
            np.testing.assert_allclose(np.load(folder + "/out/raster.npy"), [[0.25, 0.35, 0.45, 0.55, 0.65, 0.75]] * 3, atol=1e-12)
            lines = json.loads(Path(folder + "/out/contours.geojson").read_text())["features"]
            self.assertEqual([line["properties"]["level"] for line in lines], [0.5])
            np.testing.assert_allclose(np.array(lines[0]["geometry"]["coordinates"])[:, 0], 0.5, atol=1e-12)

    def test_an_interrupt_leaves_nothing(self):
        with tempfile.TemporaryDirectory() as folder:
            pipe = folder + "/p.csv"
            os.mkfifo(pipe)
            command = [sys.executable, "-m", "delaunayd.dask", pipe, "--out", folder + "/out", "--workers", "1", "--quiet", "--tile", "1000"]
            env = {**os.environ, "PYTHONPATH": HERE}
            heeds = lambda: signal.signal(signal.SIGINT, signal.SIG_DFL)  # a shell's background job ignores it
            process = subprocess.Popen(command, env=env, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, preexec_fn=heeds)
            writer = None
            while writer is None and process.poll() is None:
                try:
                    writer = os.open(pipe, os.O_WRONLY | os.O_NONBLOCK)  # OSError: nothing reads the pipe yet
                except OSError:
                    time.sleep(0.05)
            self.assertIsNotNone(writer)
            process.send_signal(signal.SIGINT)
            self.assertEqual(process.wait(), 130)
            os.close(writer)
            self.assertEqual(os.listdir(folder + "/out"), [])

    def test_errors_are_one_line(self):
        from delaunayd.dask.__main__ import main

        said = io.StringIO()
        with tempfile.TemporaryDirectory() as folder, contextlib.redirect_stderr(said):
            self.assertEqual(main([folder + "/p.npy", "--out", folder, "--memory", "much"]), 1)
        self.assertEqual(said.getvalue(), "delaunayd.dask: --memory much is not a size such as 3GB\n")


if __name__ == "__main__":
    unittest.main()
