"""delaunayd.spatial and delaunayd.interpolate in this process beside SciPy: the ratio of their times on the wall, the best of some
alternating runs each, beside its goal. With a port, the raster of a daemon there is measured, too.

    beside_scipy.py N [PORT]
"""

import subprocess
import sys
import time

import numpy as np
from scipy import interpolate as scipy_interpolate, spatial as scipy_spatial

sys.path.insert(0, "clients/python")
from delaunayd import Client  # noqa: E402
from delaunayd.interpolate import LinearNDInterpolator, SmoothInterpolator  # noqa: E402
from delaunayd.spatial import Delaunay  # noqa: E402


def seconds_of(run, repeats=1):
    start = time.perf_counter()
    for _ in range(repeats):
        run()
    return (time.perf_counter() - start) / repeats


def compare(what, ours, theirs, goal, runs=5, repeats=1, share=1.0):
    """`share`: SciPy does that share of the work, because it is slow."""
    mine, others = [], []
    for _ in range(runs):
        mine.append(seconds_of(ours, repeats))
        if len(others) < 3 or repeats > 1:
            others.append(seconds_of(theirs, repeats) / share)
    a, b = min(mine), min(others)
    print("| %s | %.3g | %.3g | %.4f | %s |" % (what, 1e3 * a, 1e3 * b, a / b, goal), flush=True)


def triangulations(n):
    points = np.random.default_rng(1).random((n, 2))
    few = dict(runs=20, repeats=10) if n < 100000 else {}
    compare("Delaunay of %d points" % n, lambda: Delaunay(points), lambda: scipy_spatial.Delaunay(points),
            "0.2" if n < 100000 else "0.03", **few)
    compare("the same, and neighbors", lambda: Delaunay(points).neighbors, lambda: scipy_spatial.Delaunay(points).neighbors, "", **few)
    if n < 100000:
        ours, theirs, place = Delaunay(points), scipy_spatial.Delaunay(points), points.mean(axis=0)
        compare("find_simplex of one place", lambda: ours.find_simplex(place), lambda: theirs.find_simplex(place), "1.5", 20, 1000)
    return points


def searches(points):
    n = len(points)
    random = np.random.default_rng(2)
    places, heights = random.random((n, 2)), np.sin(7 * points[:, 0])
    some = places[: max(1, n // 100)]
    share = len(some) / n
    ours, theirs = Delaunay(points), scipy_spatial.Delaunay(points)
    theirs.find_simplex(some[:1])
    compare("find_simplex of %d random places" % n, lambda: ours.find_simplex(places), lambda: theirs.find_simplex(some), "0.003",
            share=share)
    assert ((ours.find_simplex(some) >= 0) == (theirs.find_simplex(some) >= 0)).all()
    linear, their_linear = LinearNDInterpolator(ours, heights), scipy_interpolate.LinearNDInterpolator(theirs, heights)
    compare("LinearNDInterpolator there", lambda: linear(places), lambda: their_linear(some), "0.005", share=share)
    tree = scipy_spatial.cKDTree(points)
    compare("query(workers=-1) there, beside cKDTree", lambda: ours.query(places, workers=-1),
            lambda: tree.query(places, workers=-1), "")


def imports():
    def milliseconds(text):
        command = [sys.executable, "-c", "import time, numpy; t = time.perf_counter(); %s; print(time.perf_counter() - t)" % text]
        return min(1e3 * float(subprocess.check_output(command, env={"PYTHONPATH": "clients/python"})) for _ in range(7))

    ours, theirs = milliseconds("import delaunayd.spatial"), milliseconds("import scipy.spatial")
    print("| import, beyond NumPy's | %.3g | %.3g | %.4f | 20 ms |" % (ours, theirs, ours / theirs), flush=True)


def smooth(points):
    """A smooth raster of as many cells as there are points, slopes included; neither time includes the triangulation. SciPy's
    slopes are those of least curvature."""
    side = int(len(points) ** 0.5)
    heights = np.sin(7 * points[:, 0]) * np.cos(5 * points[:, 1])
    x, y = np.meshgrid((np.arange(side) + 0.5) / side, (np.arange(side)[::-1] + 0.5) / side)
    ours, theirs = Delaunay(points), scipy_spatial.Delaunay(points)
    theirs.find_simplex(points[:1])
    compare("smooth raster of %d cells, beside CloughTocher2DInterpolator" % side**2,
            lambda: SmoothInterpolator(ours, heights)(x, y),
            lambda: scipy_interpolate.CloughTocher2DInterpolator(theirs, heights)(x, y), "0.3", runs=3)


def rasters(port, points):
    """A linear raster of as many cells as there are points; neither time includes the triangulation."""
    side = int(len(points) ** 0.5)
    heights = np.sin(7 * points[:, 0]) * np.cos(5 * points[:, 1])
    centres = (np.arange(side) + 0.5) / side
    linear = scipy_interpolate.LinearNDInterpolator(scipy_spatial.Delaunay(points), heights)
    with Client("delaunay://127.0.0.1:" + port) as client:
        client.load("raster", points, {"z": heights})
        client.triangulate("raster")
        compare("linear raster of %d cells, by the daemon" % side**2,
                lambda: client.raster("raster", "z", (0, 0, 1, 1), side, side),
                lambda: linear(*np.meshgrid(centres, centres[::-1])), "")
        client.drop("raster")


def main():
    n = int(sys.argv[1])
    print("| what | delaunayd, ms | SciPy, ms | ratio | goal |\n|---|---|---|---|---|")
    imports()
    triangulations(1000)
    points = triangulations(n)
    searches(points)
    smooth(points)
    if len(sys.argv) > 2:
        rasters(sys.argv[2], points)


main()
