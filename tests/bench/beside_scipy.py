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


main()
