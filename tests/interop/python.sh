#!/usr/bin/env bash
# The Python package: its tests, SciPy's tests with our classes, in process beside the daemon, tiles, mirrors, its installation.
#
#     python.sh BUILD_DIR        prints what failed, and at the end one line: N passed, N failed
. "$(dirname "$0")/common.sh" "$1"

# SciPy, Matplotlib, shapely and GeoPandas must be there: without them a test would be skipped.
python_package_passes() {
    DELAUNAYD=$build/delaunayd "$python" -m unittest discover -s clients/python/tests -t clients/python >"$scratch/unittest" 2>&1
    local status=$?
    cat "$scratch/unittest"
    [ "$status" -eq 0 ] && ! grep -q 'skipped=' "$scratch/unittest"
}

# From a copy of the repository, in which nothing may be left behind; the package includes the daemon.
python_package_installs() {
    local copy=$scratch/copy before
    mkdir -p "$copy" && cp -r --parents clients/python "$copy" && find "$copy" -name __pycache__ -exec rm -r {} + &&
        before=$(find "$copy" | sort) &&
        DELAUNAYD=$build/delaunayd "$python" -m pip install -q --no-cache-dir --no-index --no-deps --target "$scratch/site" \
            "$copy/clients/python" && [ "$(find "$copy" | sort)" = "$before" ] &&
        env -u DELAUNAYD -u DELAUNAY_URL PYTHONPATH="$scratch/site" "$python" -c '
import delaunayd, os
with delaunayd.Client("private:") as c:
    c.load("t", [(0, 0), (4, 0), (0, 4)])
    assert c.triangulate("t")["triangles"] == 1
here = os.path.dirname(delaunayd.__file__)
assert delaunayd._private.find_program().startswith(here)
from delaunayd import _library
from delaunayd.spatial import Delaunay
assert Delaunay([(0, 0), (4, 0), (0, 4)]).nsimplex == 1 and _library.library()._name.startswith(here)
assert os.path.isfile(here + "/py.typed")'
}

# From a tree without a build, into an empty virtual environment: daemon and library are compiled, and nothing else is needed. Without
# optimisation, which takes most of the time of a compiler.
python_package_compiles_the_daemon() {
    local repository=$scratch/repository found
    mkdir "$repository" && git archive HEAD | tar -x -C "$repository" && python3 -m venv "$scratch/venv" &&
        env -u DELAUNAYD -u MAKEFLAGS CFLAGS=-O0 "$scratch/venv/bin/pip" install -q --no-index --no-cache-dir "$repository/clients/python" &&
        [ ! -e "$repository/build" ] &&
        found=$(env -u DELAUNAYD -u DELAUNAY_URL "$scratch/venv/bin/python" -c '
import delaunayd
from delaunayd import _library
with delaunayd.Client("private:") as c:
    c.load("t", [(0, 0), (4, 0), (0, 4)])
    print(c.triangulate("t")["triangles"], delaunayd._private.find_program(), _library.library()._name)') &&
        [[ $found == "1 $scratch/venv/"*" $scratch/venv/"* ]] && [ -s "$scratch"/venv/lib/python*/site-packages/delaunayd-*.dist-info/LICENSE ]
}

count "the Python package, nothing skipped" python_package_passes
count "SciPy's own tests of Delaunay and interpolation, with ours" env PYTHONPATH=clients/python \
    "$python" clients/python/tests/scipy_tests.py
count "the Python package in process equals the daemon on all families" "$python" tests/interop/in_process.py "$build"
count "tiles equal one triangulation on all families" "$python" tests/interop/tiles.py "$build"
count "mirrors equal the set, with kills, lost connections and pauses" "$python" tests/interop/mirrors.py "$build"
count "the Python package can be installed, with the daemon and the library" python_package_installs
if python3 -m venv --help >/dev/null 2>&1 && python3 -c 'import ensurepip' 2>/dev/null; then
    count "the Python package compiles daemon and library where there are none" python_package_compiles_the_daemon
else
    skip "the Python package compiles daemon and library where there are none" "the Debian package python3-venv is missing"
fi
result
