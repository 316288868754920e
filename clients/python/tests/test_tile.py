"""Tiles in one process, round by round until nothing is left to be sent, against one triangulation; tests/interop/tiles.py has all
families."""

import os
import tempfile
import unittest
from pathlib import Path

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


def boxes_of(tiles):
    return np.array([tile.box or (np.nan,) * 4 for tile in tiles])


def run_rounds(tiles):
    """Returns the number of rounds, the last one, in which nothing is sent, included."""
    boxes, rounds, sent = boxes_of(tiles), 0, 1
    while sent > 0:
        rounds += 1
        opened = [tile.open(boxes, me) for me, tile in enumerate(tiles)]
        sent = sum(len(vertices) for _, vertices in opened)
        for tile, (offsets, vertices) in zip(tiles, opened):
            for to, other in enumerate(tiles):
                other.insert(*tile.points(vertices[offsets[to] : offsets[to + 1]]))
    return rounds


def triangles_of(points, tiles, dtype="uint32", base=0):
    points = np.asarray(points, dtype=np.float64)
    parts = cut(points, np.arange(len(points)), tiles)
    made = [Tile(points[part], part.astype(np.uint64) + np.uint64(base)) for part in parts]
    run_rounds(made)
    rows = np.concatenate([tile.triangles(dtype) for tile in made])
    return rows[np.lexsort(rows.T[::-1])], np.concatenate([tile.hull() for tile in made]) - np.uint64(base)


@unittest.skipIf(np is None, "NumPy is missing")
class Tiles(unittest.TestCase):
    def same(self, points, tiles):
        points = np.asarray(points, dtype=np.float64).reshape(-1, 2)
        want = Delaunay(points).simplices if len(points) > 0 else np.empty((0, 3))
        got, edges = triangles_of(points, tiles)
        sides = {(a, b) for row in want.tolist() for a, b in zip(row, row[1:] + row[:1])}
        if len(want) > 0:
            self.assertEqual(sorted(map(tuple, edges.tolist())), sorted((a, b) for a, b in sides if (b, a) not in sides))
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

    def test_places_have_the_first_triangle_that_any_tile_finds(self):
        points = np.random.default_rng(7).integers(0, 30, (600, 2)).astype(float)
        places = np.vstack([points[:50], (points[:200] + points[50:250]) / 2, [(np.nan, 0), (99, 1)]])
        made = [Tile(points[part], part) for part in cut(points, np.arange(600), 6)]
        run_rounds(made)
        rows = [tile.locate(places).tolist() for tile in made]
        found = [tuple(min(of_tiles)) for of_tiles in zip(*rows)]
        d = Delaunay(points)
        want = [tuple(d.simplices[row].tolist()) if row >= 0 else ((1 << 64) - 1,) * 3 for row in d.find_simplex(places, tol=0)]
        self.assertEqual(found, want)

    def test_ids_beyond_32_bits(self):
        points = np.random.default_rng(3).random((500, 2))
        rows, _ = triangles_of(points, 3, np.uint64, 1 << 40)
        self.assertEqual(rows.dtype, np.uint64)
        self.assertEqual((rows - np.uint64(1 << 40)).tolist(), Delaunay(points).simplices.tolist())
        with self.assertRaisesRegex(ValueError, "does not fit"):
            triangles_of(points, 3, np.uint32, 1 << 40)

    def test_counts_and_box(self):
        tile = Tile([(0, 0), (4, 0), (4, 4), (0, 4), (0, 0)], [1, 3, 5, 8, 9])
        tile.insert([(9, 9), (4, 4)], np.array([2, 5], dtype=np.uint32))
        self.assertEqual(tuple(tile.counts), (5, 1, 1, 4, 4, 0))
        self.assertEqual(tile.box, (0, 0, 4, 4))
        self.assertEqual(tile.points([4])[1].tolist(), [9])
        self.assertIsNone(Tile(np.empty((0, 2)), []).box)

    def test_a_tile_waits_in_a_file(self):
        points = np.random.default_rng(4).random((2000, 2))
        ids = np.arange(2000)
        left = points[:, 0] < 0.5
        tiles = [Tile(points[left], ids[left]), Tile(points[~left], ids[~left])]
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "tile"
            boxes = boxes_of(tiles)
            offsets, vertices = tiles[0].open(boxes, 0)
            tiles[0].save(path)
            tiles[0] = Tile.load(path)
            self.assertEqual(os.listdir(folder), ["tile"])
            tiles[1].insert(*tiles[0].points(vertices))
            run_rounds(tiles)
            rows = np.concatenate([tile.triangles(np.uint32) for tile in tiles])
            self.assertEqual(rows[np.lexsort(rows.T[::-1])].tolist(), Delaunay(points).simplices.tolist())
            self.assertGreater(len(vertices), 0)

    def test_damaged_files_are_refused(self):
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "tile"
            Tile([(0, 0), (1, 0), (0, 1)], [0, 1, 2]).save(path)
            whole = path.read_bytes()
            for damaged in [whole[:n] for n in range(len(whole))] + [
                whole[:i] + bytes([whole[i] ^ 1]) + whole[i + 1 :] for i in range(len(whole))
            ]:
                path.write_bytes(damaged)
                with self.assertRaises(ValueError):
                    Tile.load(path)
            with self.assertRaises(FileNotFoundError):
                Tile.load(Path(folder) / "none")

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
        with self.assertRaisesRegex(ValueError, "exist"):
            tile.points([3])
        with self.assertRaisesRegex(ValueError, "uint32"):
            tile.triangles(np.int32)
        self.assertEqual(tuple(tile.counts), (3, 0, 0, 1, 3, 0))
