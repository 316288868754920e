"""Against a real daemon, $DELAUNAYD; with NumPy and SciPy what they give is compared."""

import socket
import threading
import unittest
from array import array

from delaunayd import Client, ConnectionLost, Refused
from delaunayd import _protocol as module

from .common import WithDaemon

try:
    import numpy
except ImportError:
    numpy = None
try:
    from scipy import spatial as scipy_spatial
except ImportError:
    scipy_spatial = None


SQUARE = [(0, 0), (4, 0), (4, 4), (0, 4), (2, 2)]


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
        with_numpy, module.numpy = module.numpy, None
        try:
            self.client.load("t", array("d", [0, 0, 1, 0, 0, 1]))
        finally:
            module.numpy = with_numpy
        self.assertEqual(self.client.stat("t")["points"], 3)


class WithoutNumPy(Commands):
    """The same with the standard library alone."""

    def setUp(self):
        super().setUp()
        self.numpy, module.numpy = module.numpy, None

    def tearDown(self):
        module.numpy = self.numpy


class Connections(unittest.TestCase):
    def test_a_lost_connection_is_told(self):
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


@unittest.skipIf(numpy is None, "NumPy is missing")
class Spatial(WithDaemon):
    def make(self, points):
        from delaunayd.spatial import Delaunay

        return Delaunay(points, client=self.client)

    def check_against_scipy(self, points):
        mine, theirs = self.make(points), scipy_spatial.Delaunay(points)
        self.assertEqual(mine.simplices.dtype, theirs.simplices.dtype)
        names = {tuple(sorted(s)): i for i, s in enumerate(mine.simplices.tolist())}
        number = [names[tuple(sorted(s))] for s in theirs.simplices.tolist()]
        self.assertEqual(sorted(number), list(range(mine.nsimplex)))
        for i, (s, n) in enumerate(zip(theirs.simplices.tolist(), theirs.neighbors.tolist())):
            own = mine.simplices[number[i]].tolist()
            for corner, neighbour in zip(s, n):
                want = -1 if neighbour < 0 else number[neighbour]
                self.assertEqual(mine.neighbors[number[i], own.index(corner)], want)
        self.assertEqual(
            {frozenset(e) for e in mine.convex_hull.tolist()},
            {frozenset(e) for e in theirs.convex_hull.tolist()},
        )
        for (indptr, indices), (indptr2, indices2) in [
            (mine.vertex_neighbor_vertices, theirs.vertex_neighbor_vertices)
        ]:
            for k in range(len(points)):
                self.assertEqual(
                    indices[indptr[k] : indptr[k + 1]].tolist(),
                    sorted(indices2[indptr2[k] : indptr2[k + 1]].tolist()),
                )
        places = numpy.random.default_rng(2).normal(size=(20, 10, 2))
        found, theirs_found = mine.find_simplex(places), theirs.find_simplex(places)
        self.assertEqual(found.shape, (20, 10))
        want = [-1 if f < 0 else number[f] for f in theirs_found.ravel().tolist()]
        self.assertEqual(found.ravel().tolist(), want)

    @unittest.skipIf(scipy_spatial is None, "SciPy is missing")
    def test_equals_scipy(self):
        rng = numpy.random.default_rng(1)
        self.check_against_scipy(rng.normal(size=(500, 2)))
        around = numpy.linspace(0, 6.2, 300)
        wheel = numpy.column_stack([numpy.cos(around), numpy.sin(around)])
        wheel *= rng.uniform(0.99, 1.01, size=(300, 1))
        self.check_against_scipy(numpy.vstack([wheel, [[0.01, 0.003]]]))

    def test_neighbors_share_the_edge_opposite_each_corner(self):
        rng = numpy.random.default_rng(4)
        around = numpy.linspace(0, 6.28, 400)
        wheel = numpy.column_stack([numpy.cos(around), numpy.sin(around)])
        wheel *= rng.uniform(0.9, 1.1, size=(400, 1))
        lattice = numpy.stack(numpy.meshgrid(numpy.arange(20.0), numpy.arange(15.0)), 2).reshape(-1, 2)
        sets = [numpy.insert(wheel, hub, (0.01, 0), axis=0) for hub in (0, 200, 400)]
        sets += [lattice, rng.permutation(lattice), rng.normal(size=(3000, 2)), SQUARE, SQUARE[:3], SQUARE[:4]]
        for points in sets:
            d = self.make(points)
            beyond = {}
            for i, s in enumerate(d.simplices.tolist()):
                for k in range(3):
                    beyond[s[(k + 1) % 3], s[(k + 2) % 3]] = i
            want = [
                [beyond.get((s[(k + 2) % 3], s[(k + 1) % 3]), -1) for k in range(3)]
                for s in d.simplices.tolist()
            ]
            self.assertEqual(d.neighbors.tolist(), want)

    def test_places_on_edges_and_points(self):
        d = self.make(SQUARE)
        for place, corners in (((2, 0), {0, 1}), ((1, 1), {0, 4}), ((4, 4), {2}), ((2, 2), {4})):
            simplex = int(d.find_simplex(place))
            self.assertTrue(corners <= set(d.simplices[simplex].tolist()))
        self.assertEqual(int(d.find_simplex((5, 5))), -1)

    def test_degenerate_sets(self):
        d = self.make([(0, 0), (1, 1), (2, 2), (1, 1)])
        self.assertEqual((d.nsimplex, d.npoints), (0, 4))
        self.assertEqual(d.convex_hull.tolist(), [[0, 1], [1, 2]])
        self.assertEqual(d.neighbors.shape, (0, 3))
        self.assertEqual(d.coplanar.tolist(), [[3, -1, 1]])
        self.assertEqual(int(d.find_simplex((1, 1))), -1)

    def test_the_set_goes_with_the_object(self):
        d = self.make(SQUARE)
        self.assertEqual(len(self.client.sets()), 1)
        del d
        self.assertEqual(self.client.sets(), [])

    def test_a_million_points(self):
        d = self.make(numpy.random.default_rng(3).random((1000000, 2)))
        n = d.neighbors
        self.assertEqual(d.nsimplex, 2 * d.npoints - 2 - len(d.convex_hull))
        self.assertEqual(int((n == -1).sum()), len(d.convex_hull))
        i = numpy.arange(0, d.nsimplex, 997)
        for k in range(3):
            inner = i[n[i, k] >= 0]
            self.assertTrue((n[n[inner, k]] == inner[:, None]).any(axis=1).all())


if __name__ == "__main__":
    unittest.main()
