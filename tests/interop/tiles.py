"""Tiles of the Python package (delaunayd._tile), round by round until nothing is left to be sent, beside one triangulation, on all families of
tests/oracle/families.c. Two kinds of tiles: those of a k-d tree, and random
ones, whose boxes overlap. delaunayd.dask does the same by its own tiles and bands; its triangles and hulls are compared, too.

    tiles.py BUILD_DIR [FAMILY...]
"""

import subprocess
import sys

import dask
import numpy as np

sys.path.insert(0, "clients/python")
from delaunayd.dask import triangulate  # noqa: E402
from delaunayd.spatial import Delaunay  # noqa: E402
from tests.test_tile import cut, run_rounds  # noqa: E402


def families(build):
    listed = subprocess.run([build + "/tests/bench/points"], stdout=subprocess.PIPE, text=True).stdout
    return [line.split()[0] for line in listed.splitlines()]


def points_of(build, family, n, seed):
    body = subprocess.check_output([build + "/tests/bench/points", "--binary", family, str(n), str(seed)])
    return np.frombuffer(body, dtype="<f8").reshape(-1, 2).copy()


def scatter(points, tiles, random):
    _, place = np.unique(points + 0.0, axis=0, return_inverse=True)
    tile = random.integers(0, tiles, len(points))[place.ravel()]
    return [np.flatnonzero(tile == k) for k in range(tiles)]


def same(what, got, want):
    assert np.array_equal(got, want), what


def compare(points, parts):
    tiles = run_rounds(points, parts)
    want = Delaunay(points)
    rows = np.concatenate([tile.triangles(np.uint32) for tile in tiles])
    same("triangles", rows[np.lexsort(rows.T[::-1])], want.simplices)
    counts = [tile.counts for tile in tiles]
    same("points", sum(c.own for c in counts), len(points))
    same("coincident", sum(c.coincident for c in counts), len(want._coincident))
    same("postponed", sum(c.postponed for c in counts), 0)


def compare_dask(points, tiles):
    want = Delaunay(points)
    with triangulate(points, tile=-(-len(points) // tiles)) as tin:
        rows = tin.triangles.compute()
        same("triangles of delaunayd.dask", rows[np.lexsort(rows.T[::-1])], want.simplices)
        same("the hull of delaunayd.dask", tin.hull(), want._now.triangulation.hull())
        stats = tin.stats()
    same("points and coincident ones", (stats["points"], stats["coincident"]), (len(points), len(want._coincident)))


def main():
    build, chosen = sys.argv[1], sys.argv[2:]
    dask.config.set(scheduler="synchronous")
    chosen = chosen or families(build)
    for family in chosen:
        for n, tiles in ((1, 2), (2, 3), (5, 9), (30, 4), (300, 6), (3000, 12), (20000, 40)):
            random = np.random.default_rng(n)
            points = points_of(build, family, n, n)
            try:
                compare(points, cut(points, np.arange(n), tiles))
                if n <= 3000 or family in ("uniform", "clusters", "circle"):
                    compare_dask(points, tiles)
                if n <= 300:
                    compare(points, scatter(points, tiles, random))
            except AssertionError as error:
                sys.exit("%s of %d in %d tiles: %s" % (family, n, tiles, error))
    print("%d families" % len(chosen))


main()
