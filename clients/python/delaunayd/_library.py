"""Finds libdelaunay-core, the geometry as a C library, and declares what the package calls. Loading waits for the first call.

Calls through ctypes release the GIL. Each function is described in core/delaunay_arrays.h or core/delaunay_tiles.h.
"""

from __future__ import annotations

import ctypes
import os
from ctypes import POINTER, byref, c_bool, c_double, c_int, c_size_t, c_uint, c_uint32, c_void_p
from pathlib import Path
from typing import Any, List, Optional

NAME = "libdelaunay-core.so.0"
_KEPT = 256 << 20  # bytes of freed triangulations that are kept for the next ones

LINEAR, NATURAL, LAPLACE, _, SMOOTH = range(5)  # enum dt_interpolation
COINCIDENT, EDGES, HULL = 1, 4, 5  # enum dt_table

_NOMEM, TOOBIG, RANGE, NOPOINT, NOEDGE, CROSSES, _NOTDELAUNAY = 1, 2, 3, 4, 5, 13, 16  # enum dt_status


_NOREGION, _OPEN = 18, 19


class Counts(ctypes.Structure):
    """What dt_arrays_counts writes."""

    _fields_ = [(name, c_uint32) for name in ("points", "coincident", "triangles", "edges", "hull")]


class Ids(ctypes.Structure):
    """struct dt_ids."""

    _fields_ = [("v", c_void_p), ("n", c_size_t), ("cap", c_size_t)]


class Region(ctypes.Structure):
    """struct dt_region."""

    _fields_ = [("number", c_uint32), ("closed", c_bool), ("triangles", c_uint32), ("area", c_double)]


class Constraint(ctypes.Structure):
    """struct dt_constraint."""

    _fields_ = [("a", c_uint32), ("b", c_uint32), ("border", c_bool), ("number", c_uint32)]


class Split(ctypes.Structure):
    """struct dt_split."""

    _fields_ = [
        ("point", c_void_p), ("released", c_void_p), ("added", c_void_p), ("n_points", c_size_t), ("n_released", c_size_t),
        ("n_added", c_size_t), ("column", c_void_p), ("value", c_void_p), ("columns", c_size_t), ("split", c_size_t),
        ("deviation", c_double), ("crossed", Constraint * 2)
    ]


class Quality(ctypes.Structure):
    """struct dt_quality."""

    _fields_ = [
        ("angle", c_double), ("area", c_double), ("length", c_double), ("number", c_uint32), ("keep", c_bool), ("most", c_size_t),
        ("reserve", c_void_p), ("ctx", c_void_p)
    ]


class Refined(ctypes.Structure):
    """struct dt_arrays_refined."""

    _fields_ = [
        ("point", c_void_p), ("constraint", c_void_p), ("points", c_size_t), ("constraints", c_size_t), ("added", c_size_t),
        ("split", c_size_t), ("unrefined", c_size_t), ("hull", c_size_t), ("angle", c_double)
    ]


class Thinning(ctypes.Structure):
    """struct dt_thinning."""

    _fields_ = [
        ("point", c_void_p), ("value", c_void_p), ("n", c_uint32), ("constraint", c_void_p), ("constraints", c_size_t),
        ("error", c_double), ("most", c_uint32), ("reserve", c_void_p), ("ctx", c_void_p)
    ]


class Thinned(ctypes.Structure):
    """struct dt_thinned."""

    _fields_ = [("kept", c_void_p), ("n", c_uint32), ("least", c_uint32), ("error", c_double)]


_FUNCTIONS = {
    "dt_arrays_new": [c_void_p, c_size_t, c_void_p, c_uint, c_void_p, POINTER(c_void_p)],
    "dt_arrays_declared": [
        c_void_p, c_size_t, c_void_p, c_size_t, c_void_p, c_uint, c_void_p, POINTER(c_void_p), POINTER(c_uint32)
    ],
    "dt_arrays_split": [c_void_p, c_void_p, c_size_t, c_void_p, c_size_t, POINTER(Split), POINTER(c_uint32)],
    "dt_split_clear": [POINTER(Split)],
    "dt_arrays_constrained_edges": [c_void_p, POINTER(Ids)],
    "dt_arrays_inside": [c_void_p, c_void_p, c_void_p],
    "dt_arrays_faces": [c_void_p, c_void_p, POINTER(Ids), POINTER(Ids)],
    "dt_arrays_regions": [c_void_p, POINTER(POINTER(Region)), POINTER(c_size_t), POINTER(Region)],
    "dt_arrays_refine": [c_void_p, POINTER(Quality), POINTER(Refined)],
    "dt_arrays_thin": [POINTER(Thinning), POINTER(Thinned)],
    "dt_pages_release": [c_void_p],
    "dt_arrays_counts": [c_void_p, POINTER(Counts)],
    "dt_arrays_table": [c_void_p, c_int, c_void_p],
    "dt_arrays_twins": [c_void_p, c_void_p],
    "dt_arrays_locate": [c_void_p, c_void_p, c_size_t, c_double, c_uint, c_void_p],
    "dt_arrays_values": [
        c_void_p, c_void_p, c_int, c_double, c_void_p, c_size_t, c_double, c_double, c_uint, c_void_p
    ],
    "dt_arrays_nearest": [c_void_p, c_void_p, c_size_t, c_uint32, c_uint, c_void_p, c_void_p],
    "dt_arrays_within": [c_void_p, c_void_p, c_void_p, c_size_t, c_uint, POINTER(Ids), c_void_p],
    "dt_arrays_free": [c_void_p],
    "dt_arrays_release": [c_void_p],
    "dt_tile_new": [c_void_p, c_void_p, c_size_t, c_void_p, c_uint, POINTER(c_void_p)],
    "dt_tile_counts": [c_void_p, c_void_p],
    "dt_tile_insert": [c_void_p, c_void_p, c_void_p, c_size_t],
    "dt_tile_open": [c_void_p, c_void_p, c_size_t, c_size_t, c_void_p, POINTER(Ids)],
    "dt_tile_triangles": [c_void_p, c_bool, c_void_p, POINTER(c_size_t)],
    "dt_tile_free": [c_void_p],
}
_NO_STATUS = frozenset(
    ["dt_arrays_counts", "dt_arrays_free", "dt_arrays_release", "dt_arrays_twins", "dt_pages_release", "dt_split_clear", "dt_tile_counts",
     "dt_tile_free"]
)

_loaded: Any = None
pages: Optional[int] = None  # the keeper of pages of all triangulations


def candidates() -> List[str]:
    """Where the library may be, best first: $DELAUNAY_CORE alone; or in this package, in the build folder of the checkout, and
    where the system looks."""
    chosen = os.environ.get("DELAUNAY_CORE")
    if chosen:
        return [chosen]
    here = Path(__file__).resolve().parent
    files = [here / "lib" / NAME, here.parent.parent.parent / "build" / "lib" / NAME]
    return [str(path) for path in files if path.is_file()] + [NAME]


def _open() -> Any:
    try:
        return ctypes.CDLL(candidates()[0])
    except OSError as error:
        raise ImportError(
            "%s: delaunayd.spatial computes with the C library %s. `make lib` in the repository builds it, `pip install` of "
            "clients/python puts it into the package, and $DELAUNAY_CORE may name it" % (error, NAME)
        ) from None


def library() -> Any:
    """The library, loaded on first use. Raises ImportError."""
    global _loaded, pages
    if _loaded is None:
        opened = _open()
        try:
            for name, arguments in _FUNCTIONS.items():
                function = getattr(opened, name)
                function.argtypes = arguments
                function.restype = None if name in _NO_STATUS else c_int
        except AttributeError:
            raise ImportError(
                "%s is of another version of delaunayd, it lacks %s: `make lib` or `pip install` again" % (opened._name, name)
            ) from None
        opened.dt_pages_new.argtypes, opened.dt_pages_new.restype = [c_size_t], c_void_p
        opened.dt_status_text.argtypes, opened.dt_status_text.restype = [c_int], ctypes.c_char_p
        pages = opened.dt_pages_new(_KEPT)
        _loaded = opened
    return _loaded


def check(status: int, what: str) -> None:
    """Raises the exception of a status of the library unless that is 0."""
    if status == 0:
        return
    if status == _NOMEM:
        raise MemoryError(what)
    if status == RANGE:
        raise ValueError(what + ": magnitudes other than 0 are at least 2^-142 and at most 2^201")
    if status == TOOBIG:
        raise ValueError(what + ": there are too many")
    if status == NOPOINT:
        raise ValueError(what + " does not exist")
    if status == NOEDGE:
        raise ValueError(what + " is both ends of a segment")
    if status in (_NOREGION, _OPEN):
        raise ValueError(what + ": there is no border of this number" if status == _NOREGION else what + ": the border is open")
    if status == _NOTDELAUNAY:
        raise ValueError("natural neighbours need a triangulation without segments")
    raise RuntimeError("%s: %s" % (what, library().dt_status_text(status).decode()))


__all__ = [
    "COINCIDENT", "CROSSES", "Counts", "EDGES", "HULL", "Ids", "LAPLACE", "LINEAR", "NATURAL", "NOEDGE", "NOPOINT", "Quality", "RANGE",
    "Refined", "Region", "SMOOTH", "Split", "Thinned", "Thinning", "TOOBIG", "byref", "check", "library",
]
