"""Tiles in one process, round by round until nothing is left to be sent, against one triangulation; tests/interop/tiles.py has all
families."""

import unittest

try:
    import numpy as np

    from delaunayd._tile import Tile
    from delaunayd.spatial import Delaunay
except ImportError:
    np = None


def cut(points, ids, tiles):
    """A k-d tree: equal coordinates go to one side."""
    if tiles == 1:
        return [ids]
    axis = int(np.ptp(points[ids], axis=0).argmax()) if len(ids) > 0 else 0
    along = points[ids, axis]
    low = along <= (np.median(along) if len(ids) > 0 else 0)
    return cut(points, ids[low], tiles // 2) + cut(points, ids[~low], tiles - tiles // 2)


def run_rounds(points, parts, base=0):
    """Tiles of these rows, when nothing is left to be sent; far more rounds than any set needs are an error."""
    ids = [part.astype(np.uint64) + np.uint64(base) for part in parts]
    tiles = [Tile(points[part], own) for part, own in zip(parts, ids)]
    boxes = np.array([(*points[part].min(0), *points[part].max(0)) if len(part) > 0 else (np.nan,) * 4 for part in parts])
    for _ in range(10):
        opened = [tile.open(boxes, me) for me, tile in enumerate(tiles)]
        if not any(opened):
            return tiles
        for part, own, sent in zip(parts, ids, opened):
            for to, rows in sent.items():
                tiles[to].insert(points[part[rows]], own[rows])
    raise AssertionError("the rounds do not end")


def triangles_of(points, tiles, dtype="uint32", base=0):
    points = np.asarray(points, dtype=np.float64)
    made = run_rounds(points, cut(points, np.arange(len(points)), tiles), base)
    rows = np.concatenate([tile.triangles(dtype) for tile in made])
    return rows[np.lexsort(rows.T[::-1])]


@unittest.skipIf(np is None, "NumPy is missing")
class Tiles(unittest.TestCase):
    def same(self, points, tiles):
        points = np.asarray(points, dtype=np.float64).reshape(-1, 2)
        want = Delaunay(points).simplices if len(points) > 0 else np.empty((0, 3))
        got = triangles_of(points, tiles)
        self.assertEqual(got.dtype, np.uint32)
        self.assertEqual(got.tolist(), want.tolist())

    def test_uniform_points_clusters_lattices_circles_and_lines(self):
        r = np.random.default_rng(1)
        angle = np.arange(360) * np.pi / 180
        x, y = np.meshgrid(np.arange(20), np.arange(20))
        along = np.arange(50)
        for tiles in (1, 2, 5, 8):
            self.same(r.random((3000, 2)), tiles)
            self.same(r.standard_normal((2000, 2)) ** 3, tiles)
            self.same(np.column_stack([x.ravel(), y.ravel()]), tiles)
            self.same(np.column_stack([np.cos(angle), np.sin(angle)]), tiles)
            self.same(np.column_stack([along, 2 * along]), tiles)
            self.same(np.vstack([np.column_stack([along, 0 * along]), [[25, 1]]]), tiles)

    def test_coincident_points_empty_tiles_and_more_tiles_than_points(self):
        r = np.random.default_rng(2)
        self.same(r.integers(0, 5, (400, 2)), 7)
        for n in range(6):
            self.same(r.random((n, 2)), 9)
        self.same([(1, 1)] * 10, 4)

    def test_ids_beyond_32_bits(self):
        points = np.random.default_rng(3).random((500, 2))
        rows = triangles_of(points, 3, np.uint64, 1 << 40)
        self.assertEqual(rows.dtype, np.uint64)
        self.assertEqual((rows - np.uint64(1 << 40)).tolist(), Delaunay(points).simplices.tolist())
        with self.assertRaisesRegex(ValueError, "does not fit"):
            triangles_of(points, 3, np.uint32, 1 << 40)

    def test_counts(self):
        tile = Tile([(0, 0), (4, 0), (4, 4), (0, 4), (0, 0)], [1, 3, 5, 8, 9])
        tile.insert([(9, 9), (4, 4)], np.array([2, 5], dtype=np.uint32))
        self.assertEqual(tuple(tile.counts), (5, 1, 1, 4, 0))

    def test_wrong_arguments_are_refused_and_change_nothing(self):
        tile = Tile([(0, 0), (1, 0), (0, 1)], [0, 1, 2])
        for points, ids, what in (
            ([(0, 0), (1, 1)], [1, 1], "ascend"), ([(0, np.nan)], [1], "point 0"), ([(0, 0)], [1, 2], "1 integers"),
            ([(0, 0)], [-1], "negative"), ([(0, 0)], [0.5], "integers"), ([0, 0], [1], "shape"),
        ):
            with self.assertRaisesRegex(ValueError, what):
                Tile(points, ids)
        for points, ids, what in (([(1, 0)], [7], "coincident"), ([(5, 5)], [1], "one place"), ([(np.inf, 5)], [7], "point 0")):
            with self.assertRaisesRegex(ValueError, what):
                tile.insert(points, ids)
        for boxes, me, what in (([[0, 0, 1, 1]], 1, "no tile 1"), ([[0, 0, 1, 1], [3, 0, 2, 1]], 0, "box"), ([0, 0, 1, 1], 0, "shape")):
            with self.assertRaisesRegex(ValueError, what):
                tile.open(boxes, me)
        with self.assertRaisesRegex(ValueError, "uint32"):
            tile.triangles(np.int32)
        self.assertEqual(tuple(tile.counts), (3, 0, 0, 1, 0))
