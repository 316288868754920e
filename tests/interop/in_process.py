"""The Python package in its own process beside a daemon, on all families of tests/oracle/families.c: triangles in the same order,
edges, hulls and coincident points; triangles of places; linear and natural values, byte for byte; the nearest points; the points of simplify.

    in_process.py BUILD_DIR [FAMILY...]
"""

import os
import subprocess
import sys

import numpy as np

sys.path.insert(0, "clients/python")
from delaunayd import Client, Refused  # noqa: E402
from delaunayd.interpolate import LinearNDInterpolator, NaturalNeighborInterpolator  # noqa: E402
from delaunayd.spatial import Delaunay, simplify  # noqa: E402

NONE = 0xFFFFFFFF


def families(build):
    listed = subprocess.run([build + "/tests/bench/points"], stdout=subprocess.PIPE, text=True).stdout
    return [line.split()[0] for line in listed.splitlines()]


def points_of(build, family, n, seed):
    body = subprocess.check_output([build + "/tests/bench/points", "--binary", family, str(n), str(seed)])
    return np.frombuffer(body, dtype="<f8").reshape(-1, 2).copy()


def same(what, got, want):
    got, want = np.asarray(got), np.asarray(want)
    assert got.shape == want.shape and np.array_equal(got, want, equal_nan=got.dtype.kind == "f"), what


def compare_tables(client, d):
    triangulation = d._now.triangulation
    same("triangles", d.simplices, client.triangles("t").view(np.int32))
    same("edges", triangulation.edges(), client.edges("t").view(np.int32))
    same("hull", triangulation.hull(), client.hull("t"))
    same("coincident", triangulation.coincident().ravel(), np.array(client.coincident("t"), dtype=np.int32).ravel())
    rows, corners = np.nonzero(d.neighbors >= 0)
    there = d.neighbors[rows, corners]
    assert (d.neighbors[there] == rows[:, None]).any(axis=1).all(), "neighbors"
    assert (d.neighbors < 0).sum() == (len(d.convex_hull) if d.nsimplex > 0 else 0), "neighbors at the hull"


def compare_places(client, d, places, values):
    corners = client.locate_triangles("t", places)
    rows = d.find_simplex(places, tol=0)
    same("inside", rows >= 0, corners[:, 0] != NONE)
    same("triangles of places", d.simplices[rows[rows >= 0]], corners[rows >= 0].view(np.int32))
    for kind, method in ((LinearNDInterpolator, "linear"), (NaturalNeighborInterpolator, "natural")):
        want = client.interpolate("t", "z", places, method)
        inside = ~np.isnan(want)  # outside, the package gives values beside the hull
        same(method, kind(d, values)(places)[inside], want[inside])
    if len(d._coincident) == 0:
        _, ids = d.query(places, 3)
        want = client.nearest_all("t", places, 3).astype(np.int64)
        same("nearest", ids, np.where(want == NONE, d.npoints, want))


def compare_simplified(client, points, values):
    values = np.where(np.arange(len(points)) % 7 == 3, np.nan, values)
    client.set_field("t", "z", values)
    for options in ({"error": 0.0}, {"error": 0.3}, {"error": 0.0, "most": 40}):
        most = options.get("most")
        try:
            client.simplify("t", "z", options["error"], "few", points=most, ids="old")
        except Refused as refused:  # the points that must stay are too many
            assert most is not None and "must stay" in str(refused), refused
            continue
        same("points of simplify", simplify(points, values, **options), client.field("few", "old")[1].astype(np.int64))
        client.drop("few")


def compare(client, build, family, n):
    points = points_of(build, family, n, n)
    places = np.vstack([points_of(build, family, 200, 7), points[: n // 4], (points[: n // 2] + points[n - n // 2 :]) / 2])
    size = np.abs(places)
    places = places[((size == 0) | ((size >= 2.0**-142) & (size <= 2.0**201))).all(axis=1)]
    values = np.sin(np.arange(n))
    client.load("t", points, {"z": values})
    client.triangulate("t")
    d = Delaunay(points)
    compare_tables(client, d)
    compare_places(client, d, places, values)
    compare_simplified(client, points, values)
    client.drop("t")


def main():
    build = sys.argv[1]
    os.environ["DELAUNAYD"] = build + "/delaunayd"
    with Client("private:") as client:
        for family in sys.argv[2:] or families(build):
            for n in (1, 2, 3, 10, 100, 3000):
                try:
                    compare(client, build, family, n)
                except AssertionError as error:
                    sys.exit("%s of %d: %s" % (family, n, error))
    print("%d families" % len(sys.argv[2:] or families(build)))


main()
