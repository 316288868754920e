"""python -m delaunayd.dask: triangulates files without a script."""

from __future__ import annotations

import argparse
import json
import os
import re
import sys
from typing import Any, Iterator, List, Optional

from .folders import new_folder, remove_folder
from .imported import dask, module
from .making import TILE, triangulate
from .rasters import Grid, grid_of
from .results import Tin
from .spill import write, write_array


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="python -m delaunayd.dask",
        description="The Delaunay triangulation of the points of files (.npy, .csv, .csv.gz, .las, .laz), in tiles, by processes of this machine or "
        "on a cluster of Dask. Writes DIR/triangles.npy: rows of three points, numbered by their rows in all files.",
    )
    parser.add_argument("files", nargs="+", metavar="FILE", help="points x,y or x,y,z")
    parser.add_argument("--out", required=True, metavar="DIR", help="the folder of the results; it is made if it does not exist")
    parser.add_argument(
        "--raster", nargs=6, metavar=("X0", "Y0", "X1", "Y1", "COLUMNS", "ROWS"), help="also DIR/raster.npy: z at the centres of cells"
    )
    parser.add_argument("--contours", nargs="+", type=float, metavar="LEVEL", help="also DIR/contours.geojson: lines of equal z")
    parser.add_argument("--tile", type=natural, default=TILE, metavar="N", help="about how many points a tile has (default: %(default)s)")
    parser.add_argument("--workers", type=natural, default=None, metavar="N", help="processes (default: as many as processors)")
    parser.add_argument("--memory", default="auto", metavar="SIZE", help="the memory of each process, such as 3GB (default: its share)")
    parser.add_argument("--scheduler", metavar="ADDRESS", help="use a cluster of Dask that runs, instead of own processes")
    parser.add_argument("--timeout", type=seconds, default=300.0, metavar="SECONDS", help="how long to wait for workers (default: %(default)g)")
    parser.add_argument("--spill", metavar="DIR", help="where files wait that are removed at the end (default: in --out)")
    parser.add_argument("--quiet", action="store_true", help="no progress bars")
    return parser


def seconds(word: str) -> float:
    """A number of at least 0."""
    number = float(word)
    if not number >= 0:
        raise ValueError(word)
    return number


def natural(word: str) -> int:
    """A whole number from 1 on."""
    number = int(word)
    if number < 1:
        raise ValueError(word)
    return number


def _grid(words: List[str]) -> Grid:
    try:
        shape = (int(words[5]), int(words[4]))
    except ValueError:
        raise ValueError("--raster: COLUMNS and ROWS are whole numbers, not %s %s" % (words[4], words[5])) from None
    return grid_of(words[:4], shape)


def _geojson(tin: Tin, levels: List[float]) -> Iterator[bytes]:
    yield b'{"type":"FeatureCollection","features":['
    for k, line in enumerate(tin.contours(levels)):
        places = line.line.tolist()
        feature = {
            "type": "Feature",
            "properties": {"level": line.level},
            "geometry": {"type": "LineString", "coordinates": places + places[:1] if line.closed else places},
        }
        yield (",\n" if k > 0 else "\n").encode() + json.dumps(feature, separators=(",", ":")).encode()
    yield b"\n]}\n"


def _cluster(options: argparse.Namespace, folder: str) -> Any:
    distributed = module("distributed", "python -m delaunayd.dask")
    if options.scheduler:
        return distributed.Client(options.scheduler)
    memory = options.memory if re.fullmatch(r"auto|[0-9.]+ *[kMGT]?i?B?", options.memory) else None
    if memory is None:
        raise ValueError("--memory %s is not a size such as 3GB" % options.memory)
    dask.config.set({"distributed.deploy.lost-worker-timeout": "1 day"})  # a busy machine may need long to replace a worker that has died
    return distributed.Client(
        n_workers=options.workers or len(os.sched_getaffinity(0)), threads_per_worker=1, processes=True, memory_limit=memory,
        dashboard_address=None, local_directory=folder,
    )


def run(options: argparse.Namespace) -> None:
    """Carries out what the command line says."""
    if options.raster is not None:
        _grid(options.raster)  # before hours of work
    os.makedirs(options.out, exist_ok=True)
    folder = new_folder(options.spill or options.out)
    try:
        with _cluster(options, folder) as client:
            _write(options, folder, client)
    finally:
        remove_folder(folder)


def _write(options: argparse.Namespace, folder: str, client: Any) -> None:
    surface = options.raster is not None or options.contours is not None
    with triangulate(options.files, tile=options.tile, client=client, spill=folder, keep=surface, progress=not options.quiet,
                     timeout=options.timeout) as tin:
        tin.to_npy(os.path.join(options.out, "triangles.npy"))
        if options.raster is not None:
            grid = _grid(options.raster)
            write_array(os.path.join(options.out, "raster.npy"), tin.raster(grid.box, (grid.rows, grid.columns)).compute())
        if options.contours is not None:
            write(os.path.join(options.out, "contours.geojson"), _geojson(tin, options.contours))
        print(json.dumps(tin.stats()))


def main(words: Optional[List[str]] = None) -> int:
    """The exit status."""
    options = _parser().parse_args(words)
    try:
        run(options)
    except (OSError, ValueError, MemoryError, ImportError, RuntimeError) as error:
        print("delaunayd.dask: %s" % error, file=sys.stderr)
        return 1
    except KeyboardInterrupt:
        return 130
    return 0


if __name__ == "__main__":
    sys.exit(main())
