"""delaunayd.spatial.Delaunay, compared with SciPy's where that is installed."""

import copy
import importlib.util
import pickle
import unittest
import warnings

from .common import SQUARE, WithDaemon

try:
    import numpy

    from delaunayd.spatial import Delaunay
except ImportError:
    numpy = None
try:
    from scipy import spatial as scipy_spatial
except ImportError:
    scipy_spatial = None


@unittest.skipIf(numpy is None, "NumPy is missing")
class Spatial(WithDaemon):
    def make(self, points, **options):
        return Delaunay(points, **options)

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

    def test_a_million_points(self):
        d = self.make(numpy.random.default_rng(3).random((1000000, 2)))
        n = d.neighbors
        self.assertEqual(d.nsimplex, 2 * d.npoints - 2 - len(d.convex_hull))
        self.assertEqual(int((n == -1).sum()), len(d.convex_hull))
        i = numpy.arange(0, d.nsimplex, 997)
        for k in range(3):
            inner = i[n[i, k] >= 0]
            self.assertTrue((n[n[inner, k]] == inner[:, None]).any(axis=1).all())

    # ---- like SciPy's ----

    @unittest.skipIf(scipy_spatial is None, "SciPy is missing")
    def test_derived_tables_equal_scipys(self):
        rng = numpy.random.default_rng(6)
        points = rng.normal(size=(300, 2)) * [3, 0.5] + [7, -2]
        mine, theirs = self.make(points), scipy_spatial.Delaunay(points)
        names = {tuple(sorted(s)): i for i, s in enumerate(mine.simplices.tolist())}
        number = [names[tuple(sorted(s))] for s in theirs.simplices.tolist()]
        close = numpy.testing.assert_allclose
        close(mine.paraboloid_scale, theirs.paraboloid_scale)
        close(mine.paraboloid_shift, theirs.paraboloid_shift)
        close(mine.equations[number], theirs.equations, rtol=1e-6, atol=1e-9)
        self.assertEqual(mine.good.tolist(), [1] * mine.nsimplex)
        places = rng.normal(size=(4, 5, 2)) * [3, 0.5] + [7, -2]
        close(mine.lift_points(places), theirs.lift_points(places))
        close(mine.plane_distance(places)[..., number], theirs.plane_distance(places), rtol=1e-6, atol=1e-9)
        for wrong in ([[1], [2]], [1, 2, 3]):
            for method in (mine.plane_distance, mine.lift_points):
                with self.assertRaises(ValueError):
                    method(wrong)
        close(mine.min_bound, theirs.min_bound)
        close(mine.max_bound, theirs.max_bound)
        corner = points[mine.simplices]
        for k in range(3):
            c = numpy.einsum("ijk,ik->ij", mine.transform[:, :2], corner[:, k] - mine.transform[:, 2])
            close(c, numpy.tile(numpy.eye(3)[k, :2], (mine.nsimplex, 1)), atol=1e-6)
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            self.assertIs(mine.vertices, mine.simplices)
        self.assertEqual(caught[0].category, DeprecationWarning)

    @unittest.skipIf(scipy_spatial is None, "SciPy is missing")
    def test_interpolators_take_it_and_give_the_same(self):
        from scipy import interpolate

        rng = numpy.random.default_rng(7)
        points, places = rng.random((500, 2)), rng.random((2000, 2)) * 1.2 - 0.1
        values = numpy.sin(points[:, 0] * 5) * points[:, 1]
        mine, theirs = self.make(points), scipy_spatial.Delaunay(points)
        self.assertIsInstance(mine, scipy_spatial.Delaunay)
        self.assertIsInstance(mine, Delaunay)
        for kind in (interpolate.LinearNDInterpolator, interpolate.CloughTocher2DInterpolator):
            numpy.testing.assert_allclose(kind(mine, values)(places), kind(theirs, values)(places), atol=1e-6)

    def test_nan_and_infinity_are_outside(self):
        d = self.make(SQUARE)
        inf, nan = float("inf"), float("nan")
        self.assertEqual(d.find_simplex([(nan, 1), (1, nan), (inf, 1), (1, -inf), (1e300, 1)]).tolist(), [-1] * 5)
        self.assertEqual(d.find_simplex(numpy.empty((0, 2))).shape, (0,))
        with self.assertRaises(ValueError):
            d.find_simplex([1, 2, 3])

    def test_what_cannot_be_triangulated_is_refused(self):
        nan = float("nan")
        masked = numpy.ma.masked_all((4, 2))
        for points in ([(0, 0), (nan, 1)], [(0, 0, 0)] * 4, [1, 2, 3], numpy.empty((0, 2)), masked):
            with self.assertRaises(ValueError):
                self.make(points)
        for options in ({"furthest_site": True}, {"qhull_options": "Qu"}):
            with self.assertRaises(NotImplementedError):
                self.make(SQUARE, **options)
        with self.assertRaises(NotImplementedError):
            self.make(SQUARE + SQUARE, qhull_options="QJ")
        self.assertEqual(self.make(SQUARE, qhull_options="QJ Pp").nsimplex, 4)
        self.assertEqual(self.client.sets(), [])  # no daemon is asked

    def test_points_can_be_added(self):
        rng = numpy.random.default_rng(8)
        points = rng.random((300, 2))
        for restart in (False, True):
            with self.make(points[:100], incremental=True) as d:
                self.assertEqual(d.neighbors.shape, (d.nsimplex, 3))
                d.add_points(points[100:200], restart=restart)
                d.add_points(points[200:])
                d.add_points(numpy.empty((0, 2)))
                want = self.make(points)
                self.assertEqual(d.simplices.tolist(), want.simplices.tolist())
                self.assertEqual(d.neighbors.tolist(), want.neighbors.tolist())
                self.assertEqual(d.npoints, 300)
            with self.assertRaises(RuntimeError):
                d.add_points([(0.5, 0.5)])
            self.assertEqual(d.find_simplex(points[d.simplices].mean(axis=1)).tolist(), list(range(d.nsimplex)))
        with self.assertRaises(RuntimeError):
            self.make(points).add_points([(1, 1)])

    def test_a_copy_and_a_pickle_answer_alike(self):
        points = numpy.random.default_rng(9).random((200, 2))
        d = Delaunay(points, workers=1)
        for other in (pickle.loads(pickle.dumps(d)), copy.copy(d), copy.deepcopy(d)):
            self.assertEqual(type(other), Delaunay)
            self.assertEqual(other.simplices.tolist(), d.simplices.tolist())
            places = points[:50] + 0.001
            self.assertEqual(other.find_simplex(places).tolist(), d.find_simplex(places).tolist())

    def test_a_pickle_has_the_attributes_that_users_have_set(self):
        class Named(Delaunay):
            pass

        d = Delaunay(SQUARE, incremental=True)
        d.name = "towns"
        for other in (pickle.loads(pickle.dumps(d)), copy.copy(d), copy.deepcopy(d)):
            other.add_points([(1, 2)])
            self.assertEqual((other.name, other.npoints, d.npoints), ("towns", 6, 5))
        self.assertIs(type(copy.copy(Named(SQUARE))), Named)

    def test_it_does_not_change_with_the_array_of_its_points(self):
        points = numpy.array(SQUARE, dtype=float)
        d = Delaunay(points)
        points += 5
        self.assertEqual(d.points.tolist(), [list(map(float, p)) for p in SQUARE])
        self.assertEqual((d.min_bound.tolist(), d.max_bound.tolist()), ([0, 0], [4, 4]))
        self.assertEqual(d.transform[0, 2].tolist(), [2, 2])
        self.assertEqual(pickle.loads(pickle.dumps(d)).simplices.tolist(), d.simplices.tolist())

    def test_its_tables_can_be_written_to(self):
        d = self.make(SQUARE)
        d.simplices.sort(axis=1)

    @unittest.skipIf(scipy_spatial is None, "SciPy is missing")
    def test_the_nearest_points_equal_those_of_a_tree(self):
        rng = numpy.random.default_rng(12)
        points, places = rng.random((300, 2)), rng.random((40, 5, 2)) * 2 - 0.5
        d, tree = self.make(points), scipy_spatial.cKDTree(points)
        for k in (1, 4):
            for got, want in zip(d.query(places, k), tree.query(places, k)):
                self.assertEqual(got.shape, want.shape)
                numpy.testing.assert_allclose(got, want, rtol=1e-12)
        distance, ids = self.make(SQUARE).query((2, 2), 7)
        self.assertEqual(ids.tolist()[0], 4)
        self.assertEqual(ids.tolist()[5:], [5, 5])
        self.assertTrue(numpy.isinf(distance[5:]).all())
        with self.assertRaises(ValueError):
            d.query((float("nan"), 0))

    def test_places_beside_a_hub_are_found(self):
        around = numpy.linspace(0, 6.28, 400)
        points = numpy.vstack([[[0.01, 0]], numpy.column_stack([numpy.cos(around), numpy.sin(around)])])
        d = self.make(points)
        self.assertEqual(d.find_simplex(points[d.simplices].mean(axis=1)).tolist(), list(range(d.nsimplex)))

    @unittest.skipIf(scipy_spatial is None, "SciPy is missing")
    def test_searches_take_the_whole_signature_of_a_tree(self):
        rng = numpy.random.default_rng(13)
        points = numpy.vstack([rng.random((300, 2)), rng.random((20, 2)).repeat(3, axis=0)])
        places = rng.random((30, 4, 2)) * 1.4 - 0.2
        d, tree = self.make(points), scipy_spatial.cKDTree(points)
        for p in (1, 1.5, 2, 3, numpy.inf):
            for k in (1, [1], [3, 1, 7], 5, 400):
                for upper in (numpy.inf, 0.05):
                    args = dict(k=k, p=p, distance_upper_bound=upper)
                    got, ids = d.query(places, eps=0.1, workers=2, **args)
                    want, _ = tree.query(places, workers=2, **args)
                    self.assertEqual((got.shape, ids.shape), (want.shape, want.shape))
                    numpy.testing.assert_allclose(got, want, rtol=1e-12)
                    there = ids < len(points)
                    self.assertEqual(there.tolist(), numpy.isfinite(want).tolist())
                    self.assertTrue((ids[~there] == len(points)).all())
            radii = rng.random((30, 4)) * 0.2
            for r in (0.1, radii, 0, numpy.inf):
                got, want = d.query_ball_point(places, r, p=p), tree.query_ball_point(places, r, p=p, return_sorted=True)
                self.assertEqual(got.tolist(), want.tolist())
                lengths = d.query_ball_point(places, r, p=p, workers=-1, return_length=True)
                self.assertEqual(lengths.tolist(), [[len(ids) for ids in row] for row in want.tolist()])
        self.assertEqual(d.query_ball_point(points[0], 0.1), tree.query_ball_point(points[0], 0.1, return_sorted=True))
        one, theirs = d.query(places[0, 0]), tree.query(places[0, 0])
        self.assertEqual((type(one[0]), type(one[1]), one[1]), (float, int, theirs[1]))
        for bad in ({"k": 0}, {"k": []}, {"p": 0.5}, {"eps": -1}, {"workers": 0}):
            with self.assertRaises(ValueError):
                d.query(places, **bad)
        with self.assertRaises(ValueError):
            d.query_ball_point(places, -1)

    @unittest.skipIf(scipy_spatial is None, "SciPy is missing")
    def test_places_on_the_hull_have_a_triangle_as_for_scipy(self):
        rng = numpy.random.default_rng(14)
        corners = numpy.array([(0, 0), (1, 0.3), (0.7, 1.3), (-0.3, 1)])
        points = numpy.vstack([corners, rng.random((50, 2)) * 0.3 + [0.2, 0.5]])
        t = rng.random((1000, 1))
        places = numpy.vstack([corners[k] * t + corners[(k + 1) % 4] * (1 - t) for k in range(4)])
        d, theirs = self.make(points), scipy_spatial.Delaunay(points)
        self.assertTrue((theirs.find_simplex(places) >= 0).all())
        self.assertTrue((d.find_simplex(places) >= 0).all())
        self.assertGreater(int((d.find_simplex(places, tol=0) < 0).sum()), 100)
        self.assertEqual(int((d.find_simplex(places + [1e-9, -1e-9]) < 0).sum() > 0), 1)
        from scipy import interpolate

        from delaunayd.interpolate import LinearNDInterpolator

        values = points @ [2, -3]
        for kind in (LinearNDInterpolator, interpolate.LinearNDInterpolator):
            numpy.testing.assert_allclose(kind(points, values)(places), places @ [2, -3], rtol=0, atol=1e-12)

    # ---- a set of a daemon ----

    def test_a_shared_set_has_the_points_and_the_same_triangles(self):
        points = numpy.random.default_rng(15).random((500, 2))
        d = Delaunay(points, client=self.client, set="t", incremental=True)
        self.assertEqual(self.client.sets(), ["t"])
        self.assertEqual(d.simplices.tolist(), self.client.triangles("t").tolist())
        same = Delaunay(points, url=self.url, set="t")
        taken = Delaunay(client=self.client, set="t")
        for other in (same, taken):
            self.assertEqual(other.simplices.tolist(), d.simplices.tolist())
            self.assertEqual(other.ids.tolist(), list(range(500)))
        d.add_points([(0.5, 0.5), (2, 2)])
        self.assertEqual(pickle.loads(pickle.dumps(d)).ids.tolist(), d.ids.tolist())
        self.assertEqual(d.simplices.tolist(), self.client.triangles("t").tolist())
        self.assertEqual(d.ids.tolist(), list(range(502)))
        self.client.delete("t", [3])
        gaps = Delaunay(client=self.client, set="t")
        self.assertEqual(gaps.ids.tolist(), [i for i in range(502) if i != 3])
        self.assertEqual(gaps.ids[gaps.simplices].tolist(), self.client.triangles("t").tolist())

    def test_a_shared_set_that_others_have_made_or_changed_is_left_alone(self):
        Delaunay(SQUARE, client=self.client, set="t")
        with self.assertRaisesRegex(ValueError, "has other points"):
            Delaunay(SQUARE[:4], client=self.client, set="t")
        d = Delaunay(client=self.client, set="t", incremental=True)
        self.client.add("t", 9, 9)
        with self.assertRaisesRegex(ValueError, "another client"):
            d.add_points([(5, 5)])
        self.assertEqual((d.npoints, self.client.stat("t")["points"]), (5, 6))
        self.client.create("loose", tolerance=0.5)
        with self.assertRaisesRegex(ValueError, "tolerance"):
            Delaunay(client=self.client, set="loose")
        self.client.command("CONSTRAIN", "t", 0, 2)
        with self.assertRaisesRegex(ValueError, "constraints"):
            Delaunay(client=self.client, set="t")
        for nothing in ({}, {"client": self.client}):
            with self.assertRaises(ValueError):
                Delaunay(**nothing)

    # ---- Matplotlib ----

    @unittest.skipIf(importlib.util.find_spec("matplotlib") is None, "Matplotlib is missing")
    def test_matplotlib_draws_it(self):
        import matplotlib

        matplotlib.use("Agg")
        from matplotlib import pyplot, tri

        points = numpy.random.default_rng(11).random((100, 2))
        d = self.make(points)
        t = tri.Triangulation(points[:, 0], points[:, 1], d.simplices)
        self.assertEqual(t.edges.shape, d._now.triangulation.edges().shape)
        interpolated = tri.LinearTriInterpolator(t, points[:, 0])(0.5, 0.5)
        self.assertAlmostEqual(float(interpolated), 0.5)
        lines, _ = pyplot.triplot(points[:, 0], points[:, 1], d.simplices)
        self.assertGreater(len(lines.get_xdata()), 100)
        if scipy_spatial is not None:
            scipy_spatial.delaunay_plot_2d(d)
        pyplot.close("all")


if __name__ == "__main__":
    unittest.main()
