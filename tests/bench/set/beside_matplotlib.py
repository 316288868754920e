"""Bands between 20 levels of a smooth surface, in processor time, beside Matplotlib's tricontourf on the same triangles; with the goal:
at most 0.25 s for a million points. Runs alternate between the programs; the least of each counts.

    beside_matplotlib.py BUILD_DIR [POINTS]
"""

import re
import subprocess
import sys
import time

import numpy as np
from matplotlib.figure import Figure
from matplotlib.tri import Triangulation
from scipy.spatial import Delaunay

ROUNDS, GOAL = 3, 0.25e-6  # seconds for each point
LEVELS = 2 * (np.arange(20) + 0.5) / 20 - 1  # as tests/bench/set/surface.c


def ours(build, points):
    """Seconds, of the core in one thread."""
    table = subprocess.run([build + "/tests/bench/set/surface", str(points), "1000"], capture_output=True, text=True, check=True).stdout
    return float(re.search(r"bands between 20 levels[^|]*\| (\d+)", table).group(1)) * 1e-9 * points


def theirs(triangulation, z):
    axes = Figure().subplots()
    start = time.process_time()
    axes.tricontourf(triangulation, z, levels=LEVELS)
    return time.process_time() - start


def main():
    build, points = sys.argv[1], int(sys.argv[2]) if len(sys.argv) > 2 else 1_000_000
    xy = np.random.default_rng(1).random((points, 2))
    triangulation = Triangulation(*xy.T, Delaunay(xy).simplices)
    z = np.sin(7 * xy[:, 0]) * np.cos(5 * xy[:, 1])
    runs = [(ours(build, points), theirs(triangulation, z)) for _ in range(ROUNDS)]
    us, them = map(min, zip(*runs))
    print(f"Bands between 20 levels, {points} points, one thread, processor time.\n")
    print("| | seconds | ratio | goal |\n|---|---|---|---|")
    print(f"| delaunayd | {us:.3f} | {us / them:.2f} | {GOAL * points:.3f}{'' if us <= GOAL * points else ', missed'} |")
    print(f"| Matplotlib's tricontourf | {them:.3f} | | |")


if __name__ == "__main__":
    main()
