"""Runs SciPy's own tests of its Delaunay class, as installed, with our class instead of SciPy's:

    DELAUNAYD=build/delaunayd PYTHONPATH=clients/python python3 -m tests.scipy_tests

Nothing is copied from SciPy. Tests in more dimensions than two are left out. DIFFERENCES lists the tests that must fail with ours,
and why; it is an error if one of them passes.
"""

import sys
import types

import numpy as np
import pytest
import scipy.spatial._qhull as qhull

from delaunayd.spatial import Delaunay

MODULES = ("scipy.spatial.tests.test_qhull", "scipy.interpolate.tests.test_interpnd", "scipy.interpolate.tests.test_ndgriddata")
CLASSES = ("TestUtilities", "TestVertexNeighborVertices", "TestDelaunay")  # of test_qhull; the others are not about Delaunay

_ORDER = "expects Qhull's order of triangles, or of edges of the hull"
DIFFERENCES = {
    "test_find_simplex": _ORDER,
    "test_convex_hull": _ORDER,
    "test_2d_square": _ORDER,
    "test_degenerate_barycentric_transforms": "limits how many triangles are too thin for a transform; 31 exact ones are, 22 of Qhull's",
    "test_joggle": "expects the option QJ to move coincident points apart",
    "test_furthest_site": "expects a furthest-site triangulation",
    "test_vertices_deprecation": "expects a warning that names a version of SciPy",
}


def planar(points, *args, **kwargs):
    """Ours in the plane, else SciPy's."""
    shape = np.shape(points)
    return qhull.Delaunay(points, *args, **kwargs) if len(shape) == 2 and shape[1] != 2 else Delaunay(points, *args, **kwargs)


class Substitute:
    """A plugin of pytest."""

    def __init__(self):
        self.made = 0

    def pytest_collection_modifyitems(self, config, items):
        kept = [item for item in items if self.is_ours(item)]
        config.hook.pytest_deselected(items=[item for item in items if item not in kept])
        items[:] = kept
        for item in items:
            theirs = types.ModuleType("qhull")
            theirs.__dict__.update(qhull.__dict__)
            theirs.Delaunay = planar
            item.module.qhull = theirs
            reason = DIFFERENCES.get(item.name)
            if reason is not None:
                item.add_marker(pytest.mark.xfail(reason=reason, strict=True))

    @staticmethod
    def is_ours(item):
        if item.module.__name__.endswith("test_qhull"):
            name = item.name
            return item.cls.__name__ in CLASSES and not any(d in name for d in ("3d", "4d", "5d", "6d", "7d", "8d", "volume_area"))
        return item.module.__name__.endswith("test_interpnd")


if __name__ == "__main__":
    sys.exit(pytest.main(["-q", "-p", "no:cacheprovider", "--pyargs", *MODULES[:2], *sys.argv[1:]], plugins=[Substitute()]))
