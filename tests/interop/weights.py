"""WEIGHTS against its definition in rational arithmetic: the Voronoi cell of a place is cut out of the plane by one half
plane after the other, and its parts are measured, in fractions.

    weights.py PORT
"""

import random
import socket
import sys
from fractions import Fraction

BOUND = Fraction(1, 2**40)
FAR = Fraction(2) ** 700


class Connection:
    def __init__(self, port):
        self.file = socket.create_connection(("127.0.0.1", port)).makefile("rw", newline="\n")

    def ask(self, line):
        self.file.write(line + "\n")
        self.file.flush()
        status = self.file.readline()
        assert status.startswith("OK"), (line, status)
        return [self.file.readline() for _ in range(int(status.split()[1]))]


def clip(polygon, a, b, site):
    """The part of the polygon that is nearer to a than to b; each corner has the site beyond the side that begins there."""
    d = (b[0] - a[0], b[1] - a[1])
    half = (b[0] ** 2 + b[1] ** 2 - a[0] ** 2 - a[1] ** 2) / 2
    side = [c[0] * d[0] + c[1] * d[1] - half for c, _ in polygon]
    result = []
    for i, (corner, beyond) in enumerate(polygon):
        k = (i + 1) % len(polygon)
        if side[i] <= 0:
            result.append((corner, beyond))
        if (side[i] <= 0) != (side[k] <= 0):
            t = side[i] / (side[i] - side[k])
            then = polygon[k][0]
            at = (corner[0] + t * (then[0] - corner[0]), corner[1] + t * (then[1] - corner[1]))
            result.append((at, site if side[i] <= 0 else beyond))
    return result


def area(polygon):
    total = Fraction(0)
    for i in range(len(polygon)):
        a, b = polygon[i][0], polygon[(i + 1) % len(polygon)][0]
        total += a[0] * b[1] - a[1] * b[0]
    return total


def by_cells(points, q, sibson):
    """The weights of all points at q, which is strictly inside their hull and none of them."""
    sites = [(Fraction(x) - Fraction(q[0]), Fraction(y) - Fraction(q[1])) for x, y in points]
    cell = [((sx * FAR, sy * FAR), None) for sx, sy in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
    for i, site in enumerate(sites):
        cell = clip(cell, (0, 0), site, i)
    share = [Fraction(0)] * len(sites)
    for k, (corner, v) in enumerate(cell):
        assert v is not None
        if sibson:
            part = cell
            for _, other in cell:
                if other != v and part:
                    part = clip(part, sites[v], sites[other], other)
            share[v] = area(part)
        else:
            then = cell[(k + 1) % len(cell)][0]
            x, y = sites[v]
            share[v] = (x * (then[1] - corner[1]) - y * (then[0] - corner[0])) / (x * x + y * y)
    total = sum(share)
    return [s / total for s in share]


def in_triangle(points, q):
    """The weights of a triangle's corners at q in it."""
    (ax, ay), (bx, by), (cx, cy) = [(Fraction(x) - Fraction(q[0]), Fraction(y) - Fraction(q[1])) for x, y in points]
    share = [bx * cy - by * cx, cx * ay - cy * ax, ax * by - ay * bx]
    return [s / sum(share) for s in share]


def families(rng):
    yield "uniform", [(rng.random(), rng.random()) for _ in range(30)]
    yield "lattice", [(float(x), float(y)) for x in range(6) for y in range(5)]
    yield "circle", [(a / c, b / c) for a, b, c in ((3, 4, 5), (5, 12, 13), (8, 15, 17), (7, 24, 25)) for a, b in
                     ((a, b), (-a, b), (a, -b), (-a, -b), (b, a))]
    yield "integers on a circle", [(x, y) for x in range(-65, 66) for y in range(-65, 66) if x * x + y * y == 65 * 65]
    yield "slivers", [(i + rng.random(), rng.random() * 1e-9) for i in range(15)] + [(7.0, 3.0)]
    yield "nearly flat hull", [(i / 16, (i / 16) ** 2 * 1e-14) for i in range(17)] + [(0.5, 1.0)]
    yield "huge offset", [(1e9 + rng.random(), -1e9 + rng.random()) for _ in range(25)]
    yield "outlier", [(rng.random(), rng.random()) for _ in range(20)] + [(1e30, 2e29)]
    yield "wide exponents", [(rng.choice((1, -1)) * 2.0 ** rng.randrange(-140, 200),
                              rng.choice((1, -1)) * 2.0 ** rng.randrange(-140, 200)) for _ in range(20)]


def place(points, rng):
    (ax, ay), (bx, by), (cx, cy) = rng.sample(points, 3)
    s, t = sorted((rng.random(), rng.random()))
    return (ax * s + bx * (t - s) + cx * (1 - t), ay * s + by * (t - s) + cy * (1 - t))


def check(connection, points, q):
    """How many weights were compared at q."""
    where = f"{q[0]!r} {q[1]!r}"
    located = connection.ask(f"LOCATE w {where}")
    if not located or len(located[0].split()) != 3:
        return 0
    corners = [int(word) for word in located[0].split()]
    compared = 0
    for method in ("linear", "natural", "laplace"):
        rows = [row.split() for row in connection.ask(f"WEIGHTS w {where} METHOD {method}")]
        got = {int(id): Fraction(float(weight)) for id, weight in rows}
        if method == "linear":
            want = dict(zip(corners, in_triangle([points[v] for v in corners], q)))
        else:
            want = dict(enumerate(by_cells(points, q, method == "natural")))
        assert list(got) == sorted(got) and min(got.values()) >= 0
        error = sum(abs(got.get(v, 0) - w) for v, w in want.items())
        assert error < BOUND, (method, where, float(error))
        assert set(got) == {v for v, w in want.items() if w > 0}, (method, where)
        compared += 1
    return compared


def main():
    connection, rng, compared = Connection(int(sys.argv[1])), random.Random(20), 0
    for name, points in families(rng):
        points = list(dict.fromkeys(points))
        connection.ask("CREATE w")
        connection.ask("ADD w " + " ".join(f"{x!r} {y!r}" for x, y in points))
        connection.ask("TRIANGULATE w")
        before = compared
        for _ in range(8):
            compared += check(connection, points, place(points, rng))
        assert compared > before, name
        connection.ask("DROP w")
    assert compared > 130, compared


if __name__ == "__main__":
    main()
