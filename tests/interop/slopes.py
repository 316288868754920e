"""GRADIENT and PROFILE in rational arithmetic, on all families of tests/oracle/families.c: slopes are the nearest doubles; a profile
has every edge and corner on its way, in order, with places that are rounded once. Slope and aspect of a plane, and beside
gdaldem's if GDAL is there.

    slopes.py BUILD_DIR [FAMILY...]
"""

import math
import shutil
import struct
import subprocess
import sys
import tempfile
from fractions import Fraction

sys.path.insert(0, "tests/interop")
from surfaces import arguments, stages  # noqa: E402
from weights import Connection  # noqa: E402

LEAST = Fraction(1, 2**142)  # of coordinates
checked = 0


def cross(o, a, b):
    return (a[0] - o[0]) * (b[1] - o[1]) - (a[1] - o[1]) * (b[0] - o[0])


def nearest(value):
    return float(value) + 0.0


def nearest_coordinate(value):
    size = abs(value)
    if 0 < size < LEAST:
        return math.copysign(float(LEAST), value) if size > LEAST / 2 else 0.0
    return nearest(value)


def same(got, want):
    return got == want or (got != got and want != want)


class Mesh:
    def __init__(self, connection, model):
        self.place = {i: tuple(map(Fraction, p)) for i, p in model.points.items()}
        self.z = model.z
        rows = connection.ask(f"TRIANGLES {model.name}")
        self.triangles = [tuple(map(int, row.split())) for row in rows]
        self.edges = [tuple(map(int, row.split())) for row in connection.ask(f"EDGES {model.name}")]
        first = {}
        for i in sorted(model.points):
            first.setdefault(model.points[i], i)
        self.corners = sorted(first.values())

    def gradient(self, q):
        for ids in self.triangles:  # in order
            a, b, c = (self.place[i] for i in ids)
            if min(cross(a, b, q), cross(b, c, q), cross(c, a, q)) < 0:
                continue
            if any(self.z[i] != self.z[i] for i in ids):
                return math.nan, math.nan
            za, zb, zc = (Fraction(self.z[i]) for i in ids)
            area = cross(a, b, c)
            dx = ((zb - za) * (c[1] - a[1]) - (zc - za) * (b[1] - a[1])) / area
            dy = ((zc - za) * (b[0] - a[0]) - (zb - za) * (c[0] - a[0])) / area
            return nearest(dx), nearest(dy)
        return math.nan, math.nan

    def between(self, p, q):
        """(share of the way, place, exact value or None) of all that lies strictly between two places."""
        found, axis = [], 0 if p[0] != q[0] else 1
        for i in self.corners if p != q else ():
            v = self.place[i]
            share = (v[axis] - p[axis]) / (q[axis] - p[axis])
            if cross(p, q, v) == 0 and 0 < share < 1:
                found.append((share, v, None if self.z[i] != self.z[i] else Fraction(self.z[i]), 0))
        for i, k in self.edges:
            a, b = self.place[i], self.place[k]
            at_a, at_b, at_p, at_q = cross(p, q, a), cross(p, q, b), cross(a, b, p), cross(a, b, q)
            if at_a * at_b >= 0 or at_p * at_q >= 0:
                continue
            share, across = at_p / (at_p - at_q), at_a / (at_a - at_b)
            place = tuple(u + share * (v - u) for u, v in zip(p, q))
            value, spread = None, 0
            if self.z[i] == self.z[i] and self.z[k] == self.z[k]:
                spread = abs(Fraction(self.z[k]) - Fraction(self.z[i]))
                value = Fraction(self.z[i]) + across * (Fraction(self.z[k]) - Fraction(self.z[i]))
            found.append((share, place, value, spread))
        return sorted(found, key=lambda row: row[0])


def near_root(got, square, before):
    """Whether got is within 2^-52 of before + sqrt(square)."""
    low, high = Fraction(got) * (1 - Fraction(1, 2**52)) - before, Fraction(got) * (1 + Fraction(1, 2**52)) - before
    return (low < 0 or low * low <= square) and high >= 0 and high * high >= square


def root(square):
    """The square root, with 200 bits."""
    scale = 2 ** (2 * 1000)
    return Fraction(math.isqrt(square.numerator * scale // square.denominator), 2**1000)


def check_profile(connection, name, mesh, places):
    global checked
    way = [tuple(map(Fraction, q)) for q in places]
    rows = [tuple(map(float, row.split())) for row in connection.ask(f"PROFILE {name} z " + " ".join(f"{x!r} {y!r}" for x, y in places))]
    at, begin = 0, Fraction(0)
    for i, q in enumerate(way):
        square = sum((v - u) ** 2 for u, v in zip(way[i - 1], q)) if i else Fraction(0)
        for share, place, value, spread in mesh.between(way[i - 1], q) if i else ():
            distance, x, y, got = rows[at]
            assert (x, y) == tuple(map(nearest_coordinate, place)), (name, places, rows[at], tuple(map(float, place)))
            assert near_root(distance, share * share * square, begin), (name, places, rows[at])
            if value is None:
                assert got != got, (name, rows[at])
            else:
                bound = abs(value) / 2**52 + spread / 2**68 + Fraction(1, 2**1074)
                assert abs(Fraction(got) - value) <= bound, (name, places, rows[at], float(value))
            at += 1
        distance, x, y, got = rows[at]
        assert (x, y) == places[i] and near_root(distance, square, begin), (name, places, rows[at])
        (want,) = connection.ask(f"INTERPOLATE {name} z {x!r} {y!r}")
        assert same(got, float(want)), (name, rows[at], want)
        begin += root(square)
        at += 1
    assert at == len(rows), (name, places, at, len(rows))
    assert all(a[0] <= b[0] for a, b in zip(rows, rows[1:]))
    checked += 1


def some_place(model):
    """A point, the middle of two, or beyond them."""
    (ax, ay), (bx, by) = model.rng.choice(list(model.points.values())), model.rng.choice(list(model.points.values()))
    t = model.rng.choice((0, 0, 0.5, 0.25, 2))
    x, y = ax + t * (bx - ax), ay + t * (by - ay)
    return tuple(0.0 if abs(v) < 1e-40 else max(-3e60, min(3e60, v)) for v in (x, y))


def compare(connection, model):
    global checked
    mesh = Mesh(connection, model)
    places = [some_place(model) for _ in range(12)]
    rows = connection.ask(f"GRADIENT {model.name} z " + " ".join(f"{x!r} {y!r}" for x, y in places))
    for q, row in zip(places, rows):
        got, want = tuple(map(float, row.split())), mesh.gradient(tuple(map(Fraction, q)))
        assert all(map(same, got, want)), (model.name, q, got, want)
    checked += 1
    for n in (2, 4):
        check_profile(connection, model.name, mesh, [some_place(model) for _ in range(n)])


SIDE = 9


def raster(connection, quantity):
    rows = connection.ask(f"RASTER plane z 0 0 {SIDE} {SIDE} {SIDE} {SIDE}" + (f" AS {quantity}" if quantity else ""))
    return [list(map(float, row.split())) for row in rows]


def gdaldem(cells, quantity, scratch):
    """What gdaldem makes of the heights; the outermost cells are missing there."""
    with open(scratch + "/z.asc", "w") as file:
        file.write(f"ncols {SIDE}\nnrows {SIDE}\nxllcorner 0\nyllcorner 0\ncellsize 1\nNODATA_value -9999\n")
        file.write("\n".join(" ".join(map(repr, row)) for row in cells))
    command = ["gdaldem", quantity, scratch + "/z.asc", scratch + "/out.bin", "-of", "ENVI", "-q"]
    subprocess.run(command, check=True, capture_output=True)
    with open(scratch + "/out.bin", "rb") as file:
        flat = struct.unpack(f"<{SIDE * SIDE}f", file.read())
    return [flat[i : i + SIDE] for i in range(0, SIDE * SIDE, SIDE)]


def compare_planes(connection, scratch):
    """Planes that fall in twelve directions."""
    global checked
    for k in range(12):
        a, b = 0.75 * math.sin(k * math.pi / 6), 0.75 * math.cos(k * math.pi / 6)
        connection.ask("CREATE plane")
        corners = [(-1, -1), (SIDE + 1, -1), (SIDE + 1, SIDE + 1), (-1, SIDE + 1), (3.3, 4.1)]
        connection.ask("ADD plane FIELDS z " + " ".join(f"{x} {y} {-a * x - b * y!r}" for x, y in corners))
        connection.ask("TRIANGULATE plane")
        for quantity, want in (("slope", math.degrees(math.atan(0.75))), ("aspect", 30.0 * k)):
            got = raster(connection, quantity)
            turn = 360 if quantity == "aspect" else 1000
            apart = [abs(v - want) for row in got for v in row]
            assert all(min(d, turn - d) < 1e-11 for d in apart), (k, quantity, max(apart))
            if shutil.which("gdaldem"):
                other = gdaldem(raster(connection, None), quantity, scratch)
                inner = [abs(other[i][j] - got[i][j]) for i in range(1, SIDE - 1) for j in range(1, SIDE - 1)]
                assert all(min(d, turn - d) < 1e-3 for d in inner), (k, quantity, max(inner))
            checked += 1
        connection.ask("DROP plane")


def main():
    build, names = arguments()
    planes = False
    for connection, model, _ in stages(build, names, Connection):
        if not planes:
            with tempfile.TemporaryDirectory() as files:
                compare_planes(connection, files)
            planes = True
        compare(connection, model)
    print(checked, "requests")
    assert checked == 24 + 12 * len(names)


if __name__ == "__main__":
    main()
