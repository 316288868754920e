"""delaunayd.dask: what it reads and writes, the command line, and what does not suffice."""

import contextlib
import gzip
import io
import json
import os
import signal
import struct
import subprocess
import sys
import tempfile
import time
import types
import unittest
from pathlib import Path
from unittest import mock

from .test_dask import Synchronous, in_order, lines_of, of_process, python, with_tiling

try:
    import dask
    import dask.array
    import numpy as np

    from delaunayd.dask import laser, limits, reading, triangulate
    from delaunayd.dask.engine import Engine
    from delaunayd.dask.tiling import tiling_of
    from delaunayd.spatial import Delaunay
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


@unittest.skipIf(dask is None, "NumPy or dask is missing")
class Files(Synchronous):
    def setUp(self):
        super().setUp()
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = folder.name
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
        whole = np.random.default_rng(2).integers(-(10**6), 10**9, (500, 3)).astype("<i4")
        for version, kind, record, scale, offset in ((2, 1, 28, 0.001, 1e5), (4, 6, 33, 0.01, 2.5), (3, 3, 34, 0.03, 0.1)):
            header = bytearray(375 if version == 4 else 227)
            header[:4], header[24:26] = b"LASF", bytes([1, version])
            struct.pack_into("<HII", header, 94, len(header), len(header) + 5, 0)
            struct.pack_into("<BHI", header, 104, kind, record, 0 if version == 4 else 500)
            struct.pack_into("<6d", header, 131, *[scale] * 3, *[offset] * 3)
            if version == 4:
                struct.pack_into("<Q", header, 247, 500)
            rows = np.zeros((500, record), dtype=np.uint8)
            rows[:, :12] = whole.view(np.uint8)
            Path(self.path("a.las")).write_bytes(bytes(header) + b"stuff" + rows.tobytes())
            # Decimal fractions are those that a program reads from their text.
            want = [[float("%.3f" % (w * scale + offset)) for w in row] for row in whole.tolist()] if scale < 0.03 else whole * scale + offset
            with mock.patch("delaunayd.dask.laser.ROWS", 200):
                got = np.concatenate(list(laser.blocks_of(self.path("a.las"))))
            self.assertEqual(got.tolist(), np.asarray(want).tolist())
            with triangulate(self.path("a.las"), tile=90) as tin:
                self.assertEqual(in_order(tin.triangles.compute()).tobytes(), of_process(got[:, :2]).tobytes())
        good = bytes(header) + b"stuff" + rows.tobytes()
        for at, part, message in (
            (0, b"F", "not a file of LAS"), (25, b"\5", "1.0 to 1.4"), (104, b"\x83", "compressed"), (104, b"\x0b", "header"),
            (105, b"\x21", "header"), (131, bytes(8), "header"), (109, b"\x09", "ends before"),
        ):
            Path(self.path("a.las")).write_bytes(good[:at] + part + good[at + len(part) :])
            with self.assertRaisesRegex(ValueError, r"a\.las .*" + message, msg=at):
                triangulate(self.path("a.las"))

    def test_compressed_laser_points(self):
        class Reader(contextlib.nullcontext):
            header = types.SimpleNamespace(scales=[0.5, 0.25, 0.1], offsets=[0.0, 100.0, 0.0])

            def __enter__(self):
                return self

            def chunk_iterator(self, size):
                return (types.SimpleNamespace(X=p[0], Y=p[1], Z=p[2]) for p in (np.arange(30).reshape(3, 10), np.arange(9).reshape(3, 3)))

        path = self.path("a.LAZ", "")
        with mock.patch.dict(sys.modules, {"laspy": types.SimpleNamespace(open=lambda path: Reader())}):
            got = np.concatenate(list(laser.blocks_of(path)))
        self.assertEqual(got[[1, 12]].tolist(), [[0.5, 102.75, 2.1], [1.0, 101.25, 0.8]])
        with mock.patch.dict(sys.modules, {"laspy": None}), self.assertRaisesRegex(ImportError, "a.LAZ needs laspy, which is not installed"):
            triangulate(path)

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
            ("id,x,y\n1,2,3\n", r"a\.csv: the columns are id, x, y; the first ones must be x and y"),
            ("Lat,Lon,z\n1,2,3\n", r"a\.csv: the columns are lat, lon, z"),
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
            tin.to_npy(target)
            with mock.patch("os.link", side_effect=OSError):  # as on another file system
                tin.to_npy(self.path("copy.npy"))
            self.assertEqual(Path(self.path("copy.npy")).read_bytes(), Path(target).read_bytes())
            self.assertNotEqual(os.stat(self.path("copy.npy")).st_ino, os.stat(target).st_ino)
            with self.assertRaises(OSError):
                tin.to_npy(self.path("missing/triangles.npy"))
            with mock.patch("importlib.util.find_spec", return_value=None), self.assertRaisesRegex(ImportError, "pyarrow or fastparquet"):
                tin.to_parquet(self.path("triangles"))
        self.assertEqual(sorted(os.listdir(self.folder)), ["copy.npy", "triangles.npy"])
        self.assertEqual(in_order(np.load(target)).tobytes(), of_process(self.points).tobytes())

    def test_the_disk_holds_each_triangle_once(self):
        """Triangles that have been gathered are removed tile by tile, and the file of to_npy is the one of the spill folder."""
        sizes, run = [], Engine.run

        def watched(engine, name, function, calls, ended=None):
            def noted(i):
                ended(i)
                sizes.append(sum(os.stat(path).st_blocks * 512 for path in Path(self.folder).rglob("*") if path.is_file()))

            return run(engine, name, function, calls, noted if function.__name__ == "copy" else ended)

        points = np.random.default_rng(1).random((100000, 2))
        patches = mock.patch.object(Engine, "run", watched), mock.patch("delaunayd.dask.tasks._BLOCK", 10000)
        with patches[0], patches[1], triangulate(points, tile=20000, keep=False, spill=self.folder) as tin:
            tin.to_npy(self.path("triangles.npy"))
            here = [path for path in Path(self.folder).rglob("triangles*")]
            self.assertEqual([path.stat().st_nlink for path in here], [2, 2])
        self.assertGreater(len(sizes), 20)
        self.assertLess(max(sizes), 24 * 1.15 * len(points))

    def test_numbers_beyond_32_bits(self):
        tiling, before, box = tiling_of(self.points, 5), 2**33, (0, 0, 1, 1)
        with with_tiling(self.points, tiling, self.z, before) as tin, with_tiling(self.points, tiling, self.z) as small:
            got = tin.triangles.compute()
            self.assertEqual(got.dtype, np.uint64)
            np.testing.assert_array_equal(in_order(got) - np.uint64(before), of_process(self.points).astype(np.uint64))
            np.testing.assert_array_equal(tin.locate(self.points), small.locate(self.points) + np.uint64(before))
            np.testing.assert_array_equal(np.sort(tin.hull()), np.unique(Delaunay(self.points).convex_hull) + before)
            for method in ("linear", "nearest"):
                self.assertEqual(tin.raster(box, (20, 30), method).compute().tobytes(), small.raster(box, (20, 30), method).compute().tobytes())
            self.assertEqual(lines_of(tin.contours([2, 3, 5])), lines_of(small.contours([2, 3, 5])))

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
            with self.assertRaisesRegex(OSError, "500 points need about 0.0 MB in the spill folder .* has 0.0 MB"):
                triangulate(self.points, spill=self.folder)
        self.assertEqual(os.listdir(self.folder), [])

    def test_a_disk_that_fills_up_is_an_error_and_leaves_nothing(self):
        text = (
            "import os, resource, sys, dask, numpy as np\nfrom delaunayd.dask import triangulate\n"
            "dask.config.set(scheduler='synchronous')\n"
            "resource.setrlimit(resource.RLIMIT_FSIZE, (int(sys.argv[2]), resource.RLIM_INFINITY))\n"
            "try:\n    with triangulate(sys.argv[1] + '/p.npy', tile=3000, spill=sys.argv[1]) as tin:\n"
            "        tin.to_npy(sys.argv[1] + '/triangles.npy')\n"
            "except OSError as error:\n    print(error.strerror, os.path.basename(error.filename))\n"
        )
        np.save(self.path("p.npy"), np.random.default_rng(1).random((20000, 2)))
        for limit, kind in ((1000, "piece-"), (59000, "done-"), (200000, "triangles")):
            said = python("-c", text, self.folder, str(limit)).communicate()[0]
            self.assertTrue(said.startswith("File too large " + kind), said)
            self.assertEqual(os.listdir(self.folder), ["p.npy"])


@unittest.skipIf(dask is None, "NumPy or dask is missing")
class KilledProcesses(unittest.TestCase):
    def test_their_folders_are_removed_and_no_others(self):
        text = (
            "import sys, dask, numpy as np\nfrom delaunayd.dask import triangulate\ndask.config.set(scheduler='synchronous')\n"
            "tin = triangulate(np.random.default_rng(1).random((300, 2)), tile=90, spill=sys.argv[1])\n"
            "print(tin._job.folder, flush=True)\nsys.stdin.read()\n"
        )

        def started():
            process = python("-c", text, folder, stdin=subprocess.PIPE)
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
            said = python("-m", "delaunayd.dask", *(words % (folder, folder)).split()).communicate()[0]
            self.assertEqual(json.loads(said)["points"], 3000)
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
            words = [pipe, "--out", folder + "/out", "--workers", "1", "--quiet", "--tile", "1000"]
            heeds = lambda: signal.signal(signal.SIGINT, signal.SIG_DFL)  # a shell's background job ignores it
            process = python("-m", "delaunayd.dask", *words, stderr=subprocess.DEVNULL, preexec_fn=heeds)
            writer = None
            while writer is None and process.poll() is None:
                try:
                    writer = os.open(pipe, os.O_WRONLY | os.O_NONBLOCK)  # OSError: nothing reads the pipe yet
                except OSError:
                    time.sleep(0.05)
            self.assertIsNotNone(writer)
            process.send_signal(signal.SIGINT)
            process.communicate()
            self.assertEqual(process.returncode, 130)
            os.close(writer)
            self.assertEqual(os.listdir(folder + "/out"), [])

    def test_errors_are_one_line(self):
        from delaunayd.dask.__main__ import main

        for words, message in (
            (["--memory", "much"], "--memory much is not a size such as 3GB\n"),
            (["--raster", *"0011", "0", "9"], "a raster needs a box of finite numbers, and at least one row and one column\n"),
            (["--raster", *"0011", "some", "9"], "--raster: COLUMNS and ROWS are whole numbers, not some 9\n"),
        ):
            said = io.StringIO()
            with tempfile.TemporaryDirectory() as folder, contextlib.redirect_stderr(said):
                self.assertEqual(main([folder + "/p.npy", "--out", folder, *words]), 1)
            self.assertEqual(said.getvalue(), "delaunayd.dask: " + message)
        for option, kind, value in (("--workers", "natural", "0"), ("--timeout", "seconds", "nan"), ("--timeout", "seconds", "-1")):
            with self.assertRaises(SystemExit), contextlib.redirect_stderr(said):
                main(["p.npy", "--out", "p", option, value])
            self.assertIn("argument %s: invalid %s value: '%s'" % (option, kind, value), said.getvalue())


if __name__ == "__main__":
    unittest.main()
