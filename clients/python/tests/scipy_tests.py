"""Runs SciPy's own tests of its Delaunay class and of its interpolators, as installed, with ours instead of SciPy's:

    PYTHONPATH=clients/python python3 clients/python/tests/scipy_tests.py

Nothing is copied from SciPy. Tests in more dimensions than two are left out. DIFFERENCES lists the tests that must fail with ours,
and why; it is an error if one of them passes.
"""

import sys
import types

import numpy as np
import pytest
import scipy.spatial._qhull as qhull

from delaunayd import interpolate
from delaunayd.spatial import Delaunay, tsearch

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


def is_planar(points):
    shape = np.shape(points)
    if isinstance(points, tuple):
        return len(points) == 2
    return hasattr(points, "simplices") or (len(shape) == 2 and shape[1] == 2)


def instead_of(theirs, ours):
    """Ours in the plane, else SciPy's."""

    def choose(points, *args, **kwargs):
        return (ours if is_planar(points) else theirs)(points, *args, **kwargs)

    return choose


def module_with(theirs, **ours):
    """A copy of a module of SciPy's in which names are ours."""
    copy = types.ModuleType(theirs.__name__)
    copy.__dict__.update(theirs.__dict__)
    for name, one in ours.items():
        setattr(copy, name, instead_of(getattr(theirs, name), one))
    return copy


INTERPOLATORS = {
    name: getattr(interpolate, name)
    for name in ("LinearNDInterpolator", "CloughTocher2DInterpolator", "NearestNDInterpolator", "griddata")
}


class Substitute:
    """A plugin of pytest."""

    def pytest_collection_modifyitems(self, config, items):
        kept = [item for item in items if self.is_ours(item)]
        config.hook.pytest_deselected(items=[item for item in items if item not in kept])
        items[:] = kept
        for module in {item.module for item in items}:
            self.substitute(module)
        for item in items:
            reason = DIFFERENCES.get(item.name)
            if reason is not None:
                item.add_marker(pytest.mark.xfail(reason=reason, strict=True))

    @staticmethod
    def substitute(module):
        if hasattr(module, "qhull"):
            module.qhull = module_with(qhull, Delaunay=Delaunay)
            module.qhull.tsearch = tsearch
        if hasattr(module, "interpnd"):
            two = ("LinearNDInterpolator", "CloughTocher2DInterpolator")
            module.interpnd = module_with(module.interpnd, **{name: INTERPOLATORS[name] for name in two})
        for name, ours in INTERPOLATORS.items():
            if hasattr(module, name):
                setattr(module, name, instead_of(getattr(module, name), ours))

    @staticmethod
    def is_ours(item):
        if item.module.__name__.endswith("test_qhull"):
            name = item.name
            return item.cls.__name__ in CLASSES and not any(d in name for d in ("3d", "4d", "5d", "6d", "7d", "8d", "volume_area"))
        return True


if __name__ == "__main__":
    sys.exit(pytest.main(["-q", "-p", "no:cacheprovider", "--pyargs", *MODULES, *sys.argv[1:]], plugins=[Substitute()]))
