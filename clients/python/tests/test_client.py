"""The methods of a client, with NumPy and without."""

import os
import pickle
import socket
import tempfile
import threading
import unittest
from array import array

from delaunayd import Client, ConnectionLost, Refused
from delaunayd import _protocol as module

from .common import SQUARE, WithDaemon, end_daemon, start_daemon, without_numpy

try:
    import numpy
except ImportError:
    numpy = None


def as_lists(table, width):
    flat = [int(v) for v in (table.ravel() if hasattr(table, "ravel") else table)]
    return [flat[i : i + width] for i in range(0, len(flat), width)]


class Commands(WithDaemon):
    def test_a_session(self):
        c = self.client
        self.assertEqual(c.load("t", SQUARE), 0)
        self.assertEqual(c.triangulate("t")["triangles"], 4)
        self.assertEqual(as_lists(c.triangles("t"), 3), [[0, 1, 4], [0, 4, 3], [1, 2, 4], [2, 3, 4]])
        self.assertEqual(len(as_lists(c.edges("t"), 2)), 8)
        rings = c.lists("t")
        self.assertEqual(list(rings), [4, 0, 1, 2, 3])
        self.assertEqual([int(i) for i in rings[0]], [1, 4, 3])
        self.assertEqual(c.hull("t"), [0, 1, 2, 3])
        self.assertEqual(c.nearest("t", 3, 2)[0], (4, 2.0, 2.0, 1.0))
        self.assertEqual(c.locate("t", 2, 1), ("inside", (0, 1, 4)))
        self.assertEqual(c.locate("t", 9, 1), ("outside", ()))
        self.assertEqual(c.within("t", 0, 0, 4, 2), [0, 1, 4])
        self.assertEqual(as_lists(c.locate_triangles("t", [(2, 1), (9, 1)]), 3), [[0, 1, 4], [4294967295] * 3])
        self.assertEqual(as_lists(c.nearest_all("t", [(3, 2), (0, 1)], 2), 2)[0][0], 4)
        self.assertEqual(c.within("t", 2, 2, 0), [4])
        self.assertEqual(c.add("t", 2, 2), 5)
        self.assertEqual(c.coincident("t"), [(5, 4)])
        c.move("t", 5, 1e-7, 3)
        self.assertEqual(c.delete("t", [0, 1]), 2)
        ids, xy = c.points("t")
        self.assertEqual([int(i) for i in ids], [2, 3, 4, 5])
        self.assertEqual(as_lists(ids, 1)[-1], [5])
        flat = xy.ravel() if numpy is not None and module.numpy is not None else xy
        self.assertEqual(list(flat)[-2:], [1e-7, 3.0])
        self.assertEqual(c.check("t")["delaunay"], True)
        self.assertIn("uptime_s", c.info())

    def test_load_doubles_points_or_replaces_them(self):
        c = self.client
        self.assertEqual(c.load("t", SQUARE, replace=True), 0)  # there was none
        self.assertEqual(c.load("t", SQUARE), 5)
        self.assertEqual(c.stat("t")["points"], 10)
        self.assertEqual(c.load("t", [(7, 7), (8, 8)], {"z": [1, 2]}, replace=True), 0)
        self.assertEqual((c.stat("t")["points"], list(c.fields("t"))), (2, ["z"]))
        nan, inf = float("nan"), float("inf")
        for bad, fields in (([(0, nan)], None), ([(0, 0), (1e300, 0)], None), ([(1e-60, 0)], None), ([(0, 0)], {"z": [-inf]})):
            with self.assertRaisesRegex(ValueError, "points\\["):
                c.load("t", bad, fields, replace=True)
            self.assertEqual(c.get("t", [0, 1]), [(7, 7), (8, 8)])
        c.load("t", [(0, 0)], {"z": [nan]}, replace=True)
        with c.pipeline() as p:
            p.load("t", SQUARE, replace=True)
            p.get("t", [4])
        self.assertEqual(p.results, [0, [(2, 2)]])

    def test_an_error_names_the_index_of_the_row(self):
        nan = float("nan")
        self.client.load("t", SQUARE)
        for ask in (
            lambda: self.client.load("t", [(0, 0), (1, nan)]),
            lambda: self.client.set_field("t", "z", [0, float("inf")]),
            lambda: self.client.nearest_all("t", [(0, 0), (nan, 1)]),
        ):
            with self.assertRaisesRegex(Refused, r"2: .* \(index 1\)") as caught:
                ask()
            self.assertEqual(pickle.loads(pickle.dumps(caught.exception)).index, 1)
        with self.assertRaises(Refused) as caught:
            self.client.stat("missing")
        self.assertEqual((caught.exception.index, caught.exception.code), (None, "NOSET"))

    def test_a_client_says_what_it_is_connected_to(self):
        self.assertEqual(repr(self.client), "<delaunayd.Client of %s>" % self.url.split("//")[1])

    def test_results_of_commands_without_methods_written_by_hand(self):
        c = self.client
        c.create("t", temporary=True)
        self.assertEqual(c.stat("t")["temporary"], True)
        self.assertIsNone(c.create("u", 0.5))
        self.assertEqual(c.stat("u")["tol"], 0.5)
        c.load("t", SQUARE)
        self.assertEqual(c.ttl("t"), None)
        self.assertIsNone(c.expire("t", 1000))
        self.assertTrue(900 < c.ttl("t") <= 1000)
        self.assertIs(c.persist("t"), True)
        self.assertIs(c.persist("t"), False)
        self.assertRegex(c.digest("t"), "^[0-9a-f]{16}$")
        self.assertEqual(c.digest("t"), c.digest("t"))
        self.assertEqual(c.trace("t")[0][0], "grid")
        self.assertEqual(c.wait(0, 1), 0)

    def test_backups_and_snapshots(self):
        with tempfile.TemporaryDirectory() as path:
            daemon, address = start_daemon("--data", path + "/data", "--backup-dir", path + "/backups")
            self.addCleanup(end_daemon, daemon)
            with Client("delaunay://" + address) as c:
                c.load("t", SQUARE)
                self.assertGreaterEqual(c.snapshot(), 1)
                backup = c.backup("monday")
                self.assertGreaterEqual(backup["lsn"], 1)
                self.assertEqual(backup["files"], len(os.listdir(path + "/backups/monday")))
            daemon.terminate()
            daemon.wait()

    def test_errors_leave_the_connection(self):
        with self.assertRaises(Refused) as raised:
            self.client.triangulate("missing")
        self.assertEqual(raised.exception.code, "NOSET")
        with self.assertRaises(Refused) as raised:
            self.client.load("t", [(0, 0), (float("nan"), 1)])
        self.assertEqual(raised.exception.code, "NUMBER")
        with self.assertRaises(Refused):
            self.client.locate_all("missing", [(0, 0)] * 3)
        with self.assertRaises(ValueError):
            self.client.command("PING\nPING")
        with self.assertRaises(ValueError):
            self.client.load("t", [(1, 2, 3)])
        self.assertEqual(self.client.sets(), [])

    def test_requests_may_be_pipelined(self):
        for i in range(200):
            self.client.send("ADD", "t", i, 0.5)
        firsts = [self.client.receive().keys["first"] for _ in range(200)]
        self.assertEqual(firsts, [str(i) for i in range(200)])

    def test_array_of_doubles_is_taken_without_numpy(self):
        with without_numpy():
            self.client.load("t", array("d", [0, 0, 1, 0, 0, 1]))
        self.assertEqual(self.client.stat("t")["points"], 3)


class WithoutNumPy(Commands):
    """The same with the standard library alone."""

    def setUp(self):
        super().setUp()
        without = without_numpy()
        without.__enter__()
        self.addCleanup(without.__exit__, None, None, None)


class Connections(unittest.TestCase):
    def test_a_lost_connection_is_reported(self):
        for answer in (b"", b"OK 3\n1\n", b"OK 0 bytes=9\nabc", b"what?\n", b"OK x\n"):
            with socket.create_server(("127.0.0.1", 0)) as server:

                def serve():
                    with server.accept()[0] as peer:
                        peer.recv(100)
                        peer.sendall(answer)

                thread = threading.Thread(target=serve)
                thread.start()
                with Client("delaunay://127.0.0.1:%d" % server.getsockname()[1]) as c:
                    with self.assertRaises(ConnectionLost):
                        c.command("PING")
                thread.join()

    def test_bad_urls(self):
        for url in ("http://localhost", "delaunay://", "localhost:6374"):
            with self.assertRaises(ValueError):
                Client(url)


if __name__ == "__main__":
    unittest.main()
