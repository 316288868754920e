"""From an array of points to arrays of simplices and neighbors: the daemon by way of the Python package, and SciPy. Seconds on
the wall, the best of three.

    beside_scipy.py PORT N
"""

import sys
import time

import numpy as np

sys.path.insert(0, "clients/python")
from delaunayd import Client  # noqa: E402
from delaunayd.spatial import Delaunay  # noqa: E402


def best_of(runs, triangulate, *args):
    best = None
    for _ in range(runs):
        start = time.perf_counter()
        view = triangulate(*args)
        simplices, neighbors = view.simplices, view.neighbors
        seconds = time.perf_counter() - start
        best = seconds if best is None else min(best, seconds)
        size = len(simplices), len(neighbors)
        if hasattr(view, "close") and callable(view.close) and "delaunayd" in type(view).__module__:
            view.close()
    return best, size


def main():
    port, n = sys.argv[1], int(sys.argv[2])
    points = np.random.default_rng(1).random((n, 2))
    print("| program | s | ratio |\n|---|---|---|")
    with Client("delaunay://127.0.0.1:" + port) as client:
        ours, size = best_of(3, lambda p: Delaunay(p, client=client), points)
    print("| delaunayd.spatial.Delaunay | %.2f | |" % ours)
    try:
        from scipy.spatial import Delaunay as SciPy
    except ImportError:
        print("| (no SciPy: python3-scipy) | | |")
        return
    theirs, their_size = best_of(3, SciPy, points)
    assert size == their_size, (size, their_size)
    print("| scipy.spatial.Delaunay | %.2f | %.3f |" % (theirs, ours / theirs))
    compare_places(port, points, SciPy)
    compare_rasters(port, points, SciPy)


def seconds_of(find, places):
    start = time.perf_counter()
    found = find(places)
    return time.perf_counter() - start, found


def compare_places(port, points, scipy_delaunay):
    """find_simplex of as many random places as there are points; SciPy, which is slow, gets a tenth of them."""
    places = np.random.default_rng(2).random(points.shape)
    few = places[: max(1, len(places) // 10)]
    with Client("delaunay://127.0.0.1:" + port) as client:
        view = Delaunay(points, client=client)
        view.find_simplex(few)
        ours = min(seconds_of(view.find_simplex, places)[0] for _ in range(3))
        found = view.find_simplex(few)
        theirs, their_found = seconds_of(scipy_delaunay(points).find_simplex, few)
        assert ((found >= 0) == (their_found >= 0)).all()
        view.close()
    each = ours / len(places), theirs / len(few)
    print("\n| find_simplex | us a place | ratio |\n|---|---|---|")
    print("| delaunayd.spatial.Delaunay, %d places | %.2f | |" % (len(places), each[0] * 1e6))
    print("| scipy.spatial.Delaunay, %d places | %.2f | %.4f |" % (len(few), each[1] * 1e6, each[0] / each[1]))


def compare_rasters(port, points, scipy_delaunay):
    """A linear raster of as many cells as there are points; neither time includes the triangulation."""
    from scipy.interpolate import LinearNDInterpolator

    side = int(len(points) ** 0.5)
    heights = np.sin(7 * points[:, 0]) * np.cos(5 * points[:, 1])
    centres = (np.arange(side) + 0.5) / side
    with Client("delaunay://127.0.0.1:" + port) as client:
        client.load("raster", points, {"z": heights})
        client.triangulate("raster")
        box = (0, 0, 1, 1)
        ours = min(seconds_of(lambda b: client.raster("raster", "z", b, side, side), box)[0] for _ in range(3))
        client.drop("raster")
    linear = LinearNDInterpolator(scipy_delaunay(points), heights)
    theirs, _ = seconds_of(lambda c: linear(*np.meshgrid(c, c[::-1])), centres)
    print("\n| linear raster | s | ratio |\n|---|---|---|")
    print("| RASTER BINARY, %d cells | %.3f | |" % (side * side, ours))
    print("| scipy.interpolate.LinearNDInterpolator | %.3f | %.4f |" % (theirs, ours / theirs))


main()
