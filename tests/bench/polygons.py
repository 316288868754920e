"""Polygons of many corners in this process beside CGAL (constrained Delaunay, then domains marked), one thread each, in processor time: the
least of runs that alternate, and the ratio beside its goal.

    polygons.py CGAL_POLYGON [CORNERS]

star: random radii at equal angles. curve: the outline of Hilbert's curve. coast: a fractal line, midpoints displaced at random, around a circle.
"""

import subprocess
import sys
import time

import numpy as np

sys.path.insert(0, "clients/python")
from delaunayd.spatial import triangulate_polygon  # noqa: E402

GOAL, RUNS = 0.5, 5


def star(n):
    angle = 2 * np.pi * np.arange(n) / n
    radius = np.random.default_rng(1).uniform(100, 1000, n)
    return np.column_stack([radius * np.cos(angle), radius * np.sin(angle)])


def hilbert(order):
    """The curve as places of a grid [Skilling's transpose, one level at a time]."""
    curve = np.zeros((1, 2), dtype=int)
    for k in range(order):
        side = 2**k
        first = curve[:, ::-1]
        last = [2 * side - 1, side - 1] - curve[:, ::-1]
        curve = np.concatenate([first, curve + [0, side], curve + [side, side], last])
    return curve


def curve(n):
    """Both sides of the curve, at a third of its step."""
    order = round(np.log2(n / 2) / 2)
    way = hilbert(order).astype(float)
    along = np.gradient(way, axis=0)
    aside = np.column_stack([-along[:, 1], along[:, 0]]) / 3
    return np.concatenate([way + aside, (way - aside)[::-1]])


def coast(n):
    """Displacements shrink with the length of the piece, so that it does not cross itself: they are radial."""
    random = np.random.default_rng(2)
    radius = np.ones(4)
    size = 0.3
    while len(radius) < n:
        middle = (radius + np.roll(radius, -1)) / 2 * np.exp(size * random.normal(size=len(radius)))
        radius = np.column_stack([radius, middle]).ravel()
        size *= 0.55
    angle = 2 * np.pi * np.arange(len(radius)) / len(radius)
    return 1000 * np.column_stack([radius * np.cos(angle), radius * np.sin(angle)])


def ours(ring):
    start = time.process_time()
    _, triangles = triangulate_polygon(ring, workers=1)
    return time.process_time() - start, len(triangles)


def theirs(program, ring):
    seconds, triangles = subprocess.run([program, "1"], input=ring.tobytes(), stdout=subprocess.PIPE, check=True).stdout.split()
    return float(seconds), int(triangles)


def main():
    program, n = sys.argv[1], int(sys.argv[2]) if len(sys.argv) > 2 else 100000
    missed = False
    print("| polygon | corners | delaunayd, ms | CGAL, ms | ratio | goal |\n|---|---|---|---|---|---|")
    for family in (star, curve, coast):
        ring = family(n)
        runs = [(ours(ring), theirs(program, ring)) for _ in range(RUNS)]
        assert len({count for pair in runs for _, count in pair}) == 1, "the numbers of triangles differ: %s" % runs
        a, b = (min(pair[k][0] for pair in runs) for k in (0, 1))
        print("| %s | %d | %.1f | %.1f | %.2f | %s |" % (family.__name__, len(ring), 1e3 * a, 1e3 * b, a / b, GOAL), flush=True)
        missed |= a / b > GOAL
    sys.exit(missed)


main()
