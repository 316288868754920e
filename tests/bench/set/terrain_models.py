"""From a terrain model to points, in processor time, beside gdal_translate, which writes the points as text; and from the model to a light
mesh. Runs alternate between the programs; the least of each counts.

    terrain_models.py BUILD_DIR [SIDE]
"""

import math
import os
import resource
import subprocess
import sys
import tempfile

ROUNDS = 5
ERROR = 1.0


def write_grid(path, side):
    with open(path, "w") as f:
        f.write(f"ncols {side}\nnrows {side}\nxllcorner 500000\nyllcorner 5900000\ncellsize 10\nNODATA_value -9999\n")
        for row in range(side):
            rough = ((row * 7919 + column * 104729) % 1000 / 2000 for column in range(side))
            f.write(" ".join("%.2f" % (300 + 30 * math.sin(row / 40) * math.cos(c / 53) + r) for c, r in enumerate(rough)) + "\n")


def seconds(*words):
    """Of the processors, with those of the programs that it starts."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run(words, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, check=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def main():
    build, side = sys.argv[1], int(sys.argv[2]) if len(sys.argv) > 2 else 1000
    os.environ["DELAUNAYD"] = build + "/delaunayd"
    delaunay = build + "/delaunay"
    with tempfile.TemporaryDirectory() as scratch:
        grid, tiff, text, mesh = (scratch + "/" + name for name in ("a.asc", "a.tif", "a.xyz", "a.obj"))
        write_grid(grid, side)
        subprocess.run(["gdal_translate", "-q", grid, tiff], check=True)
        tasks = {
            "`gdal_translate -of XYZ`, an ASCII grid": ("gdal_translate", "-q", "-of", "XYZ", grid, text),
            "`delaunay draw --dry-run`, the same": (delaunay, "draw", "--dry-run", grid),
            "`gdal_translate -of XYZ`, a GeoTIFF": ("gdal_translate", "-q", "-of", "XYZ", tiff, text),
            "`delaunay draw --dry-run`, the same GeoTIFF": (delaunay, "draw", "--dry-run", tiff),
            f"`delaunay run --error {ERROR:g}`, from the ASCII grid to a mesh": (delaunay, "run", grid, mesh, "--error", str(ERROR), "--force"),
        }
        runs = [[seconds(*words) for words in tasks.values()] for _ in range(ROUNDS)]
    least = [min(column) for column in zip(*runs)]
    print(f"Terrain models of {side} x {side} cells, processor time.\n\n| | seconds | ratio |\n|---|---|---|")
    for i, name in enumerate(tasks):
        print(f"| {name} | {least[i]:.3f} | {'%.2f' % (least[i] / least[i - 1]) if i in (1, 3) else ''} |")


if __name__ == "__main__":
    main()
