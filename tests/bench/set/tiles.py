"""Uniform points from a .npy file to a .npy file of triangles by delaunayd.dask on a cluster of processes, beside one triangulation in process.

    tiles.py POINTS [TILE [WORKERS]]     a table for Markdown; the folder is $TMPDIR
    tiles.py --raster POINTS TILE        a raster of as many cells, in this process, beside those of the tiles by delaunayd.interpolate
"""

import os
import subprocess
import sys
import tempfile
import threading
import time

import numpy as np

sys.path.insert(0, "clients/python")
os.environ["PYTHONPATH"] = os.path.abspath("clients/python")
BLOCK = 1 << 22


def write_points(path, n):
    """Uniform points, the same for equal n."""
    points = np.lib.format.open_memmap(path, mode="w+", dtype=np.float64, shape=(n, 2))
    for at in range(0, n, BLOCK):
        points[at : at + BLOCK] = np.random.default_rng(at).random((len(points[at : at + BLOCK]), 2))


def of_process():
    """Processor time and the peak of memory of this process. ru_maxrss would begin with that of the process that started it."""
    with open("/proc/self/status") as status:
        peak = next(line for line in status if line.startswith("VmHWM:"))
    return time.process_time(), int(peak.split()[1]) * 1024


def alone(path):
    """One triangulation in process; prints processor time, bytes, and the digest of the sorted triangles."""
    from delaunayd.spatial import Delaunay

    points = np.load(path)
    begin = time.process_time()
    triangles = Delaunay(points, workers=1).simplices
    print(time.process_time() - begin, of_process()[1], digest(triangles.astype(np.uint32)))


def digest(triangles):
    """The same for the same triangles in any order."""
    total, parity = 0, 0
    for at in range(0, len(triangles), BLOCK):
        mixed = np.zeros(len(triangles[at : at + BLOCK]), dtype=np.uint64)
        with np.errstate(over="ignore"):
            for column in triangles[at : at + BLOCK].T:
                mixed = (mixed ^ column) * np.uint64(0x9E3779B97F4A7C15)
                mixed ^= mixed >> np.uint64(29)
            total += int(mixed.sum())
            parity ^= int(np.bitwise_xor.reduce(mixed * mixed | np.uint64(1)))
    return "%d:%x:%x" % (len(triangles), total % 2**64, parity)


class DiskPeak:
    """The most bytes that a folder holds while `with` lasts, looked at twice a second."""

    def __init__(self, folder):
        self.folder, self.bytes, self.over = folder, 0, threading.Event()
        self.thread = threading.Thread(target=self.look)

    def look(self):
        while not self.over.wait(0.5):
            total = 0
            for path, _, names in os.walk(self.folder):
                for name in names:
                    try:
                        total += os.stat(os.path.join(path, name)).st_blocks * 512
                    except FileNotFoundError:  # it has just been removed
                        pass
            self.bytes = max(self.bytes, total)

    def __enter__(self):
        self.thread.start()
        return self

    def __exit__(self, *what):
        self.over.set()
        self.thread.join()


def main():
    from distributed import Client, LocalCluster

    from delaunayd.dask import triangulate

    n = int(float(sys.argv[1]))
    tile = int(float(sys.argv[2])) if len(sys.argv) > 2 else max(1, n // 6)
    workers = int(sys.argv[3]) if len(sys.argv) > 3 else 2
    with tempfile.TemporaryDirectory() as folder:
        source, target = folder + "/points.npy", folder + "/triangles.npy"
        write_points(source, n)
        cluster = LocalCluster(
            n_workers=workers, threads_per_worker=1, processes=True, dashboard_address=None, memory_limit="3GB", local_directory=folder
        )
        with cluster, Client(cluster) as client, DiskPeak(folder) as disk:
            before = [cpu for cpu, _ in client.run(of_process).values()]
            begin = time.time()
            with triangulate(source, tile=tile, spill=folder, keep=False) as tin:
                tin.to_npy(target)
                wall, stats = time.time() - begin, tin.stats()
            after, driver = list(client.run(of_process).values()), of_process()[1]
        cpu = sum(cpu for cpu, _ in after) - sum(before)
        found = digest(np.load(target, mmap_mode="r"))
        said = subprocess.check_output([sys.executable, __file__, "--alone", source], text=True).split() if n <= 40_000_000 else None
    print("| points | tiles | workers | ns wall | ns processor | rounds | halo, % | peak of a worker, MB | of the driver, MB | "
          "disk, bytes a point | alone, ns processor | alone, MB |")
    print("|---|---|---|---|---|---|---|---|---|---|---|---|")
    print("| %d | %d | %d | %.0f | %.0f | %d | %.2f | %.0f | %.0f | %.0f | %s | %s |" % (
        n, stats["tiles"], workers, wall / n * 1e9, cpu / n * 1e9, stats["rounds"], 100 * stats["halo"] / n,
        max(peak for _, peak in after) / 1e6, driver / 1e6, disk.bytes / n, "%.0f" % (float(said[0]) / n * 1e9) if said else "-",
        "%.0f" % (int(said[1]) / 1e6) if said else "-"))
    if said and said[2] != found:
        sys.exit("the triangles differ: %s, not %s" % (found, said[2]))


def of_tiles(tin, points, z, grid):
    """Processor time of the rasters of all tiles, each a triangulation of its own points alone."""
    from delaunayd.dask import rasters, tasks
    from delaunayd.interpolate import LinearNDInterpolator

    (x, y), job, total = grid.centres(), tin._outcome.job, 0
    for tile in tin._outcome.tiles:
        xy, ids, _ = tasks.own_points(job, tile.number, tile.chunks, ())
        columns, rows = rasters._in_box(job.boxes[tile.number], x, y)
        here = z[ids]
        begin = time.process_time()
        LinearNDInterpolator(xy, here, workers=1)(*np.meshgrid(x[columns], y[rows]))
        total += time.process_time() - begin
    return total


def raster(n, tile):
    import dask

    from delaunayd.dask import rasters, triangulate

    points, side = np.random.default_rng(1).random((n, 2)), int(n**0.5)
    z, grid, times = points[:, 0] * points[:, 1], rasters.Grid((0.0, 0.0, 1.0, 1.0), side, side), []
    with dask.config.set(scheduler="synchronous"), triangulate(points, z, tile=tile) as tin:
        for _ in range(3):
            begin = time.process_time()
            tin.raster(grid.box, (side, side))
            times.append((time.process_time() - begin, of_tiles(tin, points, z, grid)))
        tiles = tin.stats()["tiles"]
    whole, parts = (min(column) / side**2 * 1e9 for column in zip(*times))
    print("| points and cells | tiles | raster of the whole, ns processor a cell | of the tiles | ratio, at most 1.2 |\n|---|---|---|---|---|")
    print("| %d | %d | %.0f | %.0f | %.2f |" % (n, tiles, whole, parts, whole / parts))


if __name__ == "__main__":
    if sys.argv[1] == "--raster":
        raster(int(float(sys.argv[2])), int(float(sys.argv[3])))
    else:
        alone(sys.argv[2]) if sys.argv[1] == "--alone" else main()
