"""A triangulation whose triangles and points are in files of a spill folder."""

from __future__ import annotations

import importlib.util
import math
import operator
import os
import weakref
from typing import TYPE_CHECKING, Any, Dict, List, Tuple

import numpy as np

from .._triangulation import Triangulation
from .._values import doubles
from . import contours, nearest, rasters, spill, surfaces
from .band import points_type, xy_of
from .chunks import npy_header
from .engine import Engine
from .folders import remove_folder
from .imported import module
from .rounds import Outcome

if TYPE_CHECKING:
    from .._types import NDArray


class Tin:
    """What triangulate() returns. Its files are removed when the object is, or by close()."""

    def __init__(self, engine: Engine, outcome: Outcome, keep: bool):
        self._engine, self._outcome, self._keep = engine, outcome, keep
        self._job = outcome.job
        self._results = 0
        self._end = weakref.finalize(self, remove_folder, self._job.folder)

    def close(self) -> None:
        """Removes the files; arrays that are not computed yet cannot be computed any more."""
        self._end()

    def __enter__(self) -> "Tin":
        return self

    def __exit__(self, *error: Any) -> None:
        self.close()

    @property
    def triangles(self) -> Any:
        """A dask array of shape (m, 3), one chunk for each tile: numbers of points, counterclockwise, the smallest first; each triangle
        exactly once. uint32 below 2^32 points, otherwise uint64."""
        rows = tuple(tile.triangles for tile in self._outcome.tiles)
        return spill.lazy(spill.path_of(self._job.folder, "triangles"), rows or -1)

    def to_npy(self, path: str) -> None:
        """Writes the triangles to one .npy file. There is no such file until it is complete. On the file system of the spill folder it is a
        link to the file there, and takes no more space; do not write into it while this object uses that file."""
        spill.publish(spill.path_of(self._job.folder, "triangles"), os.path.abspath(path))

    def to_parquet(self, path: str) -> None:
        """Writes the triangles as a folder of Parquet files with the columns a, b and c. Needs pandas, and pyarrow or fastparquet."""
        if not any(importlib.util.find_spec(name) for name in ("pyarrow", "fastparquet")):
            raise ImportError("to_parquet needs pyarrow or fastparquet, and neither is installed")
        frames = module("dask.dataframe", "to_parquet")
        frames.from_dask_array(self.triangles, columns=["a", "b", "c"]).to_parquet(path)

    # ---- the surface ----

    def locate(self, places: Any) -> NDArray[Any]:
        """The corners of the triangle that contains each place of shape (k, 2), as a row of `triangles` has them: shape (k, 3); rows of
        places outside have the greatest number of the type, 2^32 - 1 or 2^64 - 1. Exact. On an edge or a point it is the first of the
        triangles that meet there."""
        wanted = doubles(places)
        if wanted.ndim != 2 or wanted.shape[1] != 2:
            raise ValueError("places must have the shape (k, 2), not %s" % (wanted.shape,))
        self._needs_points()
        corners = np.full((len(wanted), 3), np.iinfo(self._job.dtype).max, dtype=self._job.dtype)
        calls = [(self._job, tile, wanted) for tile in self._outcome.tiles]
        for rows, found in self._engine.run("locate", surfaces.locate, calls):
            better = _less(found, corners[rows])
            corners[rows[better]] = found[better]
        return corners

    def raster(self, bounds: Any, shape: Any, method: str = "linear", field: Any = 0) -> Any:
        """The values at the centres of the cells of a box, two opposite corners (x0, y0, x1, y1), the northernmost row first, nan outside the hull: a dask array
        of the shape (rows, columns) on disk. The method is linear or nearest. `field`: its number or name; of several, a list, the shape is
        (rows, columns, fields)."""
        if method not in ("linear", "nearest"):
            raise ValueError("the method of rasters in tiles is linear or nearest, not %s" % method)
        self._needs_points()
        several = isinstance(field, (list, tuple))
        fields = tuple(map(self._field, field if several else [field]))
        grid = rasters.grid_of(bounds, shape)
        name = self._new("raster")
        calls = [(self._job, tile, grid, fields, name) for tile in self._outcome.tiles]
        try:
            task = rasters.linear if method == "linear" else nearest.nearest
            asked = self._engine.run("raster", task, calls)
            if method == "nearest":
                self._answer(asked, grid, fields, name)
            self._assemble(grid, len(fields) if several else 0, name, nearest.decided(self._job.folder, grid, fields, name))
        finally:
            spill.remove_all(self._job.folder, name + "-")
        return spill.lazy(spill.path_of(self._job.folder, name))

    def _answer(self, asked: List[List[int]], grid: rasters.Grid, fields: Tuple[int, ...], name: str) -> None:
        """Tiles answer what others ask about cells."""
        askers: Dict[int, List[int]] = {}
        for tile, others in zip(self._outcome.tiles, asked):
            for other in others:
                askers.setdefault(other, []).append(tile.number)
        answering = [tile for tile in self._outcome.tiles if tile.number in askers]
        self._engine.run(
            "raster", nearest.answer, [(self._job, tile, grid, fields, name, askers[tile.number]) for tile in answering]
        )

    def _assemble(self, grid: rasters.Grid, fields: int, name: str, last: Tuple[Any, Any]) -> None:
        """Writes the raster: what tiles have written, and `last`, cells and their values. fields: 0 for one without an axis of its own."""
        shape = (grid.rows, grid.columns) + (fields,) * (fields > 0)
        with spill.complete(spill.path_of(self._job.folder, name)) as file:
            file.write(npy_header(shape))
            os.posix_fallocate(file.fileno(), 0, spill.HEADER + 8 * math.prod(shape))
            out = np.memmap(file.name, dtype="<f8", mode="r+", offset=spill.HEADER, shape=(grid.rows * grid.columns, max(fields, 1)))
            out[:] = np.nan
            for path in spill.numbered(self._job.folder, name):
                cells, values = rasters.read_part(path, max(fields, 1))
                out[cells] = values
            out[last[0]] = last[1]
            out.flush()

    def contours(self, levels: Any, field: Any = 0) -> contours.Contours:
        """The contour lines of a field at levels, with the higher ground on the left, each as (level, closed, line): those of a daemon's CONTOUR, byte for byte,
        in the same order. A sequence, whose lines are read from disk one by one, and dask arrays of all lines."""
        self._needs_points()
        column = self._field(field)
        wanted = tuple(sorted(set(map(float, levels))))
        if any(math.isnan(level) for level in wanted):
            raise ValueError("a level is not a number")
        name = self._new("contours")
        tiles = self._outcome.tiles
        try:
            self._engine.run("contours", contours.pieces, [(self._job, tile, column, wanted, name) for tile in tiles])
            calls = [(self._job.folder, tuple(tile.number for tile in tiles), level, name, k) for k, level in enumerate(wanted)]
            self._engine.run("contours", contours.join, calls)
        finally:
            spill.remove_all(self._job.folder, name + "-piece-")
        return contours.Contours(self._job.folder, name, wanted)

    def hull(self) -> NDArray[Any]:
        """The numbers of the points of the hull, counterclockwise from the smallest; those of a line from end to end."""
        self._needs_points()
        found = self._engine.run("hull", surfaces.hull, [(self._job, tile) for tile in self._outcome.tiles])
        points = np.sort(np.concatenate([np.empty(0, dtype=points_type(0)), *found]), order="id")
        numbers: NDArray[Any] = points["id"][Triangulation(xy_of(points), 1).hull()].astype(self._job.dtype)
        return numbers

    def _needs_points(self) -> None:
        if not self._keep:
            raise ValueError("the points are not there any more: triangulate(..., keep=True) keeps them")

    def _field(self, field: Any) -> int:
        """The number of a field, which its number or its name says."""
        names = self._job.fields
        if len(names) == 0:
            raise ValueError("the points have no values")
        if field in names:
            return names.index(field)
        if isinstance(field, str) or not 0 <= operator.index(field) < len(names):
            raise ValueError("there is no field %s among %s" % (field, ", ".join(names)))
        return operator.index(field)

    def _new(self, kind: str) -> str:
        """A name of files that nothing else has."""
        self._results += 1
        return "%s-%d" % (kind, self._results)

    def stats(self) -> Dict[str, Any]:
        """points, coincident, triangles, tiles (those with points), rounds, and halo: how many points tiles have received, all added."""
        tiles = self._outcome.tiles
        return {
            "points": sum(tile.points for tile in tiles),
            "coincident": sum(tile.coincident for tile in tiles),
            "triangles": sum(tile.triangles for tile in tiles),
            "tiles": len(tiles),
            "rounds": self._outcome.rounds,
            "halo": sum(tile.halo for tile in tiles),
        }


def _less(a: NDArray[Any], b: NDArray[Any]) -> NDArray[np.bool_]:
    """Whether each row of a is before the row of b."""
    less: NDArray[np.bool_] = np.zeros(len(a), dtype=bool)
    for k in reversed(range(3)):
        less = (a[:, k] < b[:, k]) | ((a[:, k] == b[:, k]) & less)
    return less
