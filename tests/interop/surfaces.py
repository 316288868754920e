"""CONTOUR, INTERPOLATE and VORONOI on all families of tests/oracle/families.c, beside Matplotlib and SciPy: after loading, after
random edits of points and values, and again after the daemon was killed and has read its log; half of the requests in RESP.

    surfaces.py BUILD_DIR [FAMILY...]

Contours are also compared with their definition, a piece in each triangle that the level crosses, on plateaus and saddles too.
Rounding moves a place by a few units in the last place of its edge's coordinates, so crossings that are nearer to each other
than that count as one place.
"""

import itertools
import math
import random
import re
import subprocess
import sys
import tempfile
import time
from collections import Counter

import numpy as np
from matplotlib.figure import Figure
from matplotlib.tri import Triangulation
from scipy.interpolate import LinearNDInterpolator
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components
from scipy.spatial import Delaunay, QhullError, Voronoi

sys.path.insert(0, "tests/interop")
from weights import Connection  # noqa: E402

EPS = 2.0**-52
ROUNDS = 3
counted = Counter()
axes = Figure().subplots()


# ---- a daemon with a data directory, and its two framings ----


class Daemon:
    def __init__(self, build, data):
        self.process = subprocess.Popen([build + "/delaunayd", "--port", "0", "--data", data], stdout=subprocess.PIPE,
                                        stderr=subprocess.DEVNULL, text=True)
        self.port = int(re.match(r"ready on .*:(\d+)$", self.process.stdout.readline()).group(1))

    def kill(self):
        self.process.kill()
        self.process.wait()


class Both(Connection):
    """Asks in lines or in RESP, by turns."""

    turn = 0

    def ask(self, line):
        self.turn += 1
        return super().ask(line) if self.turn % 2 else self.ask_resp(line.split())

    def ask_resp(self, words):
        self.file.write(f"*{len(words)}\r\n" + "".join(f"${len(w)}\r\n{w}\r\n" for w in words))
        self.file.flush()
        status = self.file.readline()
        assert status[0] in "+*", (words, status)
        rows = []
        for _ in range(int(status[1:]) if status[0] == "*" else 0):
            length = int(self.file.readline()[1:])
            rows.append(self.file.read(length + 2)[:length])
        return rows

    def await_triangulation(self, name):
        for _ in range(6000):
            self.file.write(f"HULL {name}\n")
            self.file.flush()
            status = self.file.readline()
            if status.startswith("OK"):
                return [self.file.readline() for _ in range(int(status.split()[1]))]
            assert status.startswith("ERR LOADING"), status
            time.sleep(0.01)
        raise AssertionError("still loading after a minute")


# ---- the model of a set: points, heights, and steps, whose values are small integers ----


class Model:
    def __init__(self, family, n, build):
        self.name = f"{family}.{n}"
        self.fresh = [self.family(build, family, n, seed) for seed in range(1, ROUNDS + 1)]
        self.points, self.z, self.s = {}, {}, {}
        self.rng = random.Random(self.name)
        self.next = 0

    @staticmethod
    def family(build, family, n, seed):
        text = subprocess.run([build + "/tests/bench/points", family, str(n), str(seed)], capture_output=True, text=True, check=True)
        return [tuple(map(float, line.split())) for line in text.stdout.splitlines()]

    def values(self):
        z = math.nan if self.rng.random() < 0.03 else self.rng.uniform(-100, 100)
        return z, float(self.rng.randrange(4))

    def add(self, places):
        """The request that adds the places with values."""
        words = [f"ADD {self.name} FIELDS z,s"]
        for x, y in places:
            z, s = self.values()
            self.points[self.next], self.z[self.next], self.s[self.next] = (x, y), z, s
            self.next += 1
            words.append(f"{x!r} {y!r} {z!r} {s!r}")
        return " ".join(words)

    def edit(self, place):
        kind, id = self.rng.randrange(4), self.rng.choice(sorted(self.points))
        if kind == 0 or len(self.points) < 5:
            return self.add([place])
        if kind == 1:
            del self.points[id], self.z[id], self.s[id]
            return f"DEL {self.name} {id}"
        if kind == 2:
            self.points[id] = place
            return f"MOVE {self.name} {id} {place[0]!r} {place[1]!r}"
        self.z[id] = self.values()[0]
        return f"FSET {self.name} z {id} {self.z[id]!r}"


class Mesh:
    """The daemon's triangulation in arrays; CGAL's comparison proves it. Coincident points are represented by the first."""

    def __init__(self, connection, model):
        first = {}
        for id in sorted(model.points):
            first.setdefault(model.points[id], id)
        self.ids = sorted(first.values())
        self.place = {id: i for i, id in enumerate(self.ids)}
        self.xy = np.array([model.points[id] for id in self.ids]).reshape(-1, 2)
        self.z = np.array([model.z[id] for id in self.ids])
        self.s = np.array([model.s[id] for id in self.ids])
        rows = [[self.place[int(w)] for w in row.split()] for row in connection.ask(f"TRIANGLES {model.name}")]
        self.triangles = np.array(rows, dtype=int).reshape(-1, 3)


# ---- contours ----


class Crossings:
    """The edges of some triangles that a level crosses, each with its place and its cluster."""

    def __init__(self, mesh, z, level, triangles):
        self.pieces, self.uses = [], Counter()
        edges = {}

        def crossing(a, b):
            return edges.setdefault((min(a, b), max(a, b)), len(edges))

        above = z[triangles] >= level
        count = above.sum(axis=1)
        for t, flags, n in zip(triangles.tolist(), above.tolist(), count):
            if n in (0, 3):
                continue
            lone = flags.index(n == 1)
            a, b, c = t[lone], t[lone - 2], t[lone - 1]
            ends = crossing(a, b), crossing(c, a)
            self.uses.update(ends)
            self.pieces.append(ends if n == 1 else ends[::-1])  # higher ground on the left
        self.edges = list(edges)
        ab = np.array(self.edges, dtype=int).reshape(-1, 2)
        p, q = mesh.xy[ab[:, 0]], mesh.xy[ab[:, 1]]
        zp, zq = z[ab[:, 0]], z[ab[:, 1]]
        t = ((level - zp) / (zq - zp))[:, None]
        self.at = p * (1 - t) + q * t
        self.error = 8 * EPS * np.maximum(abs(p), abs(q))
        near = self.near(self.at, self.error)
        self.clusters, self.cluster = connected_components(coo_matrix(near)) if len(ab) else (0, np.zeros(0, int))
        self.border = {int(self.cluster[e]) for e, n in self.uses.items() if n == 1}
        self.borders = sum(n == 1 for n in self.uses.values())
        self.apart = self.clusters == len(ab)
        self.edge = dict(zip(self.cluster[::-1].tolist(), self.edges[::-1]))

    def near(self, places, error):
        return (abs(places[:, None] - self.at[None]) <= error[:, None] + self.error[None]).all(axis=2)

    def clusters_of(self, line):
        near = self.near(line, np.zeros_like(line))
        assert near.any(axis=1).all(), line[~near.any(axis=1)]
        return [int(self.cluster[k]) for k in near.argmax(axis=1)]

    def flow(self, lines):
        """How often each step between clusters is gone, less the way back; for lines of clusters."""
        steps = Counter()
        for line in lines:
            for a, b in zip(line, line[1:]):
                if a != b:
                    steps[min(a, b), max(a, b)] += 1 if a < b else -1
        return {step: n for step, n in steps.items() if n}

    def defined(self):
        return self.flow([[int(self.cluster[k]) for k in piece] for piece in self.pieces])


def read_contours(rows):
    for row in rows:
        level, kind, k, *xy = row.split()
        line = np.array(xy, dtype=float).reshape(-1, 2)
        assert kind in ("open", "closed") and len(line) == int(k) >= (3 if kind == "closed" else 2), row
        assert (line[1:] != line[:-1]).any(axis=1).all() and (kind == "open" or (line[0] != line[-1]).any()), row
        yield float(level), kind == "closed", line


def check_lines(crossings, found):
    """What PROTOCOL.md promises about the lines of one level."""
    lines, begins = [], []
    for closed, line in found:
        way = crossings.clusters_of(line)
        if not closed:
            assert {way[0], way[-1]} <= crossings.border
        lines.append(way + way[:1] if closed else way)
        begins.append(crossings.edge[way[0]])
        if crossings.apart:
            assert not closed or begins[-1] == min(crossings.edge[c] for c in way)
    assert crossings.flow(lines) == crossings.defined()
    if crossings.apart:
        assert sum(not closed for closed, _ in found) == crossings.borders / 2
        visits = Counter(itertools.chain.from_iterable(line[: -1 if closed else None] for (closed, _), line in zip(found, lines)))
        assert set(visits.values()) <= {1}  # no branch
        assert begins == sorted(begins)
    return crossings.flow(lines)


def check_no_crossing(crossings, found):
    """No two segments pass through each other by more than rounding."""
    pieces = [np.concatenate([line, line[:1]]) if closed else line for closed, line in found]
    a = np.concatenate([line[:-1] for line in pieces])
    b = np.concatenate([line[1:] for line in pieces])
    size = max(abs(a).max(), abs(b).max())

    def side(p, q, r):
        u, v = q - p, r - p
        cross = u[..., 0] * v[..., 1] - u[..., 1] * v[..., 0]
        slack = 64 * EPS * size * (abs(u).sum(axis=-1) + abs(v).sum(axis=-1))
        return np.where(abs(cross) > slack, np.sign(cross), 0)

    p, q, r, s = a[:, None], b[:, None], a[None], b[None]
    through = (side(p, q, r) * side(p, q, s) < 0) & (side(r, s, p) * side(r, s, q) < 0)
    assert not through.any()


def beside_matplotlib(mesh, z, levels, triangles, crossings, flows):
    drawn = axes.tricontour(Triangulation(mesh.xy[:, 0], mesh.xy[:, 1], triangles), np.nan_to_num(z), levels=levels)
    for level, lines in zip(drawn.levels, drawn.allsegs):
        ways = [crossings[level].clusters_of(line) for line in lines if len(line)]
        assert crossings[level].flow(ways) == flows[level], level
        counted["lines of Matplotlib"] += len(ways)
    for artist in list(axes.collections):
        artist.remove()


def check_contours(connection, name, mesh, field, levels, longest):
    z = getattr(mesh, field)
    triangles = mesh.triangles[~np.isnan(z[mesh.triangles]).any(axis=1)]
    words = "" if longest is None else f" MAXEDGE {longest!r}"
    if longest is not None:
        corner = mesh.xy[triangles]
        triangles = triangles[(np.hypot(*(corner - np.roll(corner, 1, axis=1)).transpose(2, 0, 1)) <= longest).all(axis=1)]
    rows = list(read_contours(connection.ask(f"CONTOUR {name} {field} {' '.join(map(repr, levels))}{words}")))
    assert [level for level, _, _ in rows] == sorted(level for level, _, _ in rows)
    crossings = {level: Crossings(mesh, z, level, triangles) for level in levels}
    flows = {}
    for level in levels:
        found = [(closed, line) for other, closed, line in rows if other == level]
        flows[level] = check_lines(crossings[level], found)
        if found:
            check_no_crossing(crossings[level], found)
        counted["lines"] += len(found)
        counted["closed lines"] += sum(closed for closed, _ in found)
    plain = [level for level in levels if level not in z and crossings[level].pieces]
    if plain:
        beside_matplotlib(mesh, z, plain, triangles, crossings, flows)


def compare_contours(connection, name, mesh, rng):
    levels = sorted(rng.uniform(-90, 90) for _ in range(3))
    check_contours(connection, name, mesh, "z", levels, None)
    check_contours(connection, name, mesh, "s", [0.5, 1.0, 1.5, 2.0, 3.0], None)
    corner = mesh.xy[mesh.triangles]
    lengths = np.unique(np.hypot(*(corner - np.roll(corner, 1, axis=1)).transpose(2, 0, 1)))
    k = len(lengths) * 4 // 5
    longest = float(lengths[k] + lengths[min(k + 1, len(lengths) - 1)]) / 2
    if longest > lengths[k] * 1.0005 and 2.0**-142 <= longest <= 2.0**201:
        check_contours(connection, name, mesh, "z", levels, longest)
        counted["contours between long edges"] += 1


# ---- SciPy ----


def condition(corner):
    """Of the matrix of two sides of a triangle, in the maximum norm."""
    side = corner[:2] - corner[2]
    det = side[0, 0] * side[1, 1] - side[0, 1] * side[1, 0]
    if det == 0:
        return math.inf
    inverse = np.array([[side[1, 1], -side[0, 1]], [-side[1, 0], side[0, 0]]]) / det
    return abs(side).sum(axis=1).max() * abs(inverse).sum(axis=1).max()


def compare_values(connection, name, mesh, rng, theirs):
    """METHOD linear where SciPy has the same triangle, and that is not too thin for its arithmetic."""
    found = LinearNDInterpolator(theirs, mesh.z)
    for _ in range(20):
        t = rng.choice(mesh.triangles)
        u, v = sorted((rng.random(), rng.random()))
        x, y = map(float, np.array([u, v - u, 1 - v]) @ mesh.xy[t])
        if min(abs(x), abs(y)) < 2.0**-142:
            continue
        located = connection.ask(f"LOCATE {name} {x!r} {y!r}")
        corners = {mesh.place[int(w)] for w in located[0].split()} if located else set()
        k = int(theirs.find_simplex((x, y)))
        limit = condition(mesh.xy[theirs.simplices[k]]) if k >= 0 else math.inf
        if len(corners) != 3 or set(theirs.simplices[k]) != corners or limit > 1e12:
            continue
        (row,) = connection.ask(f"INTERPOLATE {name} z {x!r} {y!r}")
        got, want = float(row), float(found(x, y))
        assert math.isnan(got) == math.isnan(want), (x, y)
        assert math.isnan(got) or abs(got - want) <= 64 * EPS * limit * 100, (x, y, got, want, limit)
        counted["values of SciPy"] += 1


def vertex_errors(diagram):
    """A bound for the error of each of SciPy's Voronoi vertices: it solves for the centre with squares of coordinates."""
    sites = [set() for _ in diagram.vertices]
    for site, region in enumerate(diagram.point_region):
        for v in diagram.regions[region]:
            if v >= 0:
                sites[v].add(site)
    size = abs(diagram.points).max()
    errors = np.full(len(sites), math.inf)
    for v, around in enumerate(sites):
        for three in itertools.combinations(sorted(around)[:6], 3):
            a, b, c = diagram.points[list(three)]
            height = abs((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])) / max(abs(b - a).max(), abs(c - a).max())
            if height > 0:
                errors[v] = min(errors[v], 64 * EPS * size * size / height)
    return errors


def compare_cells(connection, name, mesh):
    corner = mesh.xy[mesh.triangles]
    if abs(corner).max() > 1e5 * np.hypot(*(corner - np.roll(corner, 1, axis=1)).transpose(2, 0, 1)).min():
        return  # Qhull merges what is so near, relative to the squares of coordinates
    low, high = mesh.xy.min(axis=0), mesh.xy.max(axis=0)
    wide = np.array((*(low - (high - low) - 1), *(high + (high - low) + 1)))
    x0, y0, x1, y1 = map(float, wide.clip(-(2.0**201), 2.0**201))
    rows = {}
    for row in connection.ask(f"VORONOI {name} BOX {x0!r} {y0!r} {x1!r} {y1!r}"):
        id, k, *xy = row.split()
        rows[mesh.place[int(id)]] = np.array(xy, dtype=float).reshape(-1, 2)
        assert len(xy) == 2 * int(k)
    assert sorted(rows) == list(range(len(mesh.ids)))
    diagram = Voronoi(mesh.xy)
    errors = vertex_errors(diagram)
    for site, region in enumerate(diagram.point_region):
        corners = diagram.regions[region]
        if not corners or -1 in corners:
            continue
        want, error = diagram.vertices[corners], errors[corners][:, None]
        if not ((want > (x0, y0)) & (want < (x1, y1))).all() or error.max() > 1e-3 * np.ptp(rows[site], axis=0).max():
            continue
        near = (abs(want[:, None] - rows[site][None]) <= error[:, None]).all(axis=2)
        assert near.any(axis=1).all() and near.any(axis=0).all(), (site, want, rows[site])
        counted["cells of SciPy"] += 1


# ---- all of it ----


def compare(connection, model, seed):
    mesh, rng = Mesh(connection, model), random.Random(seed)
    if len(mesh.triangles) == 0:
        assert connection.ask(f"CONTOUR {model.name} z 0") == []
        return
    compare_contours(connection, model.name, mesh, rng)
    try:
        theirs = Delaunay(mesh.xy)
    except QhullError:  # nearly flat
        return
    compare_values(connection, model.name, mesh, rng, theirs)
    compare_cells(connection, model.name, mesh)


def change(connection, model, round):
    fresh = model.fresh[round]
    if round == 0:
        connection.ask(f"CREATE {model.name}")
        connection.ask(model.add(fresh))
        connection.ask(f"TRIANGULATE {model.name}")
        return
    for _ in range(6 + len(fresh) // 8):
        connection.ask(model.edit(model.rng.choice(fresh)))


def arguments():
    """The build directory, and the families that are named, or all."""
    build = sys.argv[1]
    listing = subprocess.run([build + "/tests/bench/points"], capture_output=True, text=True).stdout
    return build, sys.argv[2:] or [line.split()[0] for line in listing.splitlines()]


def stages(build, names, connect, most=60, edits=20):
    """For a small and a larger set of each family, in a new daemon: (connection, model, False) when it is triangulated, and
    (connection, model, True) after that many edits, unless that is 0."""
    with tempfile.TemporaryDirectory() as data:
        daemon = Daemon(build, data)
        try:
            connection = connect(daemon.port)
            for model in (Model(name, n, build) for name in names for n in (8, most)):
                connection.ask(model.add(model.fresh[0]))
                connection.ask(f"TRIANGULATE {model.name}")
                yield connection, model, False
                for _ in range(edits):
                    connection.ask(model.edit(model.rng.choice(model.fresh[1])))
                if edits > 0:
                    yield connection, model, True
        finally:
            daemon.kill()


def main():
    build, names = arguments()
    models = [Model(name, n, build) for name in names for n in (8, 120)]
    with tempfile.TemporaryDirectory() as data:
        daemon = Daemon(build, data)
        try:
            connection = Both(daemon.port)
            for model in models:
                for round in range(ROUNDS):
                    change(connection, model, round)
                    where = f"{model.name}, round {round}"
                    compare(connection, model, where)
            daemon.kill()
            daemon = Daemon(build, data)
            connection = Both(daemon.port)
            for model in models:
                where = f"{model.name}, after a restart"
                connection.await_triangulation(model.name)
                compare(connection, model, where)
        except AssertionError:
            print("failed:", where)
            raise
        finally:
            daemon.kill()
    print(dict(counted))
    least = {"lines of Matplotlib": 100, "closed lines": 50, "contours between long edges": 1, "values of SciPy": 20,
             "cells of SciPy": 30}
    for what, n in least.items():
        assert counted[what] >= n * len(names), what


if __name__ == "__main__":
    main()
