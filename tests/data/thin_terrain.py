"""Chooses points of a lattice of heights so that the triangulation of them is nowhere more than TOLERANCE metres off.

    python3 thin_terrain.py jacksboro_fault_dem.npz TOLERANCE >terrain.xyz

Greedy insertion [Garland & Heckbert 1995], many points at once: of each square of 6 x 6 samples the worst one, as
long as its error is at least a third of the worst of all. Degrees become whole metres east and north of the centre.
"""
import math
import sys

import numpy as np
from scipy.interpolate import LinearNDInterpolator

EARTH = 6371008.8  # mean radius in metres

dem = np.load(sys.argv[1])
tolerance = float(sys.argv[2])
rows, columns = dem["elevation"].shape
z = dem["elevation"].astype(float).ravel()

metres = math.radians(1) * EARTH
latitude = math.radians(float(dem["ymin"] + dem["ymax"]) / 2)
x = np.rint((np.arange(columns) - (columns - 1) / 2) * float(dem["dx"]) * metres * math.cos(latitude))
y = np.rint(((rows - 1) / 2 - np.arange(rows)) * float(dem["dy"]) * metres)
xy = np.column_stack([axis.ravel() for axis in np.meshgrid(x, y)])
square = (np.arange(rows)[:, None] // 6 * columns + np.arange(columns) // 6).ravel()

chosen = [0, columns - 1, (rows - 1) * columns, rows * columns - 1]
while True:
    error = np.abs(LinearNDInterpolator(xy[chosen], z[chosen])(xy) - z)
    error[chosen] = 0
    worst = error.max()
    if worst <= tolerance:
        break
    order = np.argsort(-error, kind="stable")
    order = order[error[order] > max(tolerance, worst / 3)]
    chosen += order[np.sort(np.unique(square[order], return_index=True)[1])].tolist()

for i in chosen:
    print("%d %d %d" % (xy[i, 0], xy[i, 1], z[i]))
