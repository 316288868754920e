"""INTERPOLATE compared with its definition in rational arithmetic.

    values.py PORT
"""

import random
import sys
from fractions import Fraction

from weights import Connection, by_cells, families, in_triangle, place

BOUND = Fraction(1, 2**40)


def means(connection, points, values, q):
    """The means of the values at q, strictly inside a triangle, by method; none elsewhere."""
    located = connection.ask(f"LOCATE v {q[0]!r} {q[1]!r}")
    if not located or len(located[0].split()) != 3:
        return {}
    corners = [int(word) for word in located[0].split()]
    weights = {"linear": dict(zip(corners, in_triangle([points[v] for v in corners], q)))}
    for method in ("natural", "laplace"):
        weights[method] = dict(enumerate(by_cells(points, q, method == "natural")))
    result = {}
    for method, weight in weights.items():
        count = [Fraction(values[v]) for v, w in weight.items() if w > 0]
        mean = sum(w * Fraction(values[v]) for v, w in weight.items())
        result[method] = (mean, max(count) - min(count), max(abs(z) for z in count))
    return result


def check(connection, points, values, q):
    compared = 0
    for method, (want, spread, size) in means(connection, points, values, q).items():
        (row,) = connection.ask(f"INTERPOLATE v z {q[0]!r} {q[1]!r} METHOD {method}")
        error = abs(Fraction(float(row)) - want)
        assert error <= BOUND * spread + size / 2**51, (method, q, float(error), float(spread))
        compared += 1
    return compared


def outside(points, hull, q):
    """The nearest place of the hull, points in their order, as weights of points; None inside."""
    q = (Fraction(q[0]), Fraction(q[1]))
    best, result, seen = None, None, False
    for i, b in enumerate(hull):
        a = hull[i - 1]
        ax, ay, bx, by = (Fraction(c) for p in (points[a], points[b]) for c in p)
        ex, ey = bx - ax, by - ay
        seen |= ex * (q[1] - ay) - ey * (q[0] - ax) < 0
        along = max(Fraction(0), min(Fraction(1), ((q[0] - ax) * ex + (q[1] - ay) * ey) / (ex * ex + ey * ey)))
        square = (ax + along * ex - q[0]) ** 2 + (ay + along * ey - q[1]) ** 2
        if best is None or square < best:
            best, result = square, {v: w for v, w in ((a, 1 - along), (b, along)) if w}
    return result if seen else None


def check_outside(connection, points, hull, values, q):
    weight = outside(points, hull, q)
    rows = [connection.ask(f"INTERPOLATE v z {q[0]!r} {q[1]!r} METHOD {method} OUTSIDE nearest")[0]
            for method in ("linear", "natural", "laplace")]
    if weight is None:
        return 0
    assert rows[0] == rows[1] == rows[2], (q, rows)
    count = [Fraction(values[v]) for v in weight]
    error = abs(Fraction(float(rows[0])) - sum(w * Fraction(values[v]) for v, w in weight.items()))
    assert error <= BOUND * (max(count) - min(count)) + max(map(abs, count)) / 2**51, (q, float(error))
    return 1


def far_place(points, rng):
    p, q = rng.sample(points, 2)
    far = rng.choice((0.5, 1.0, 3.0, 1e3, 1e9)) * rng.random()
    most = 2.0**200
    return tuple(max(-most, min(most, a + (a - b) * far)) for a, b in zip(p, q))


def fill(connection, points, values):
    connection.ask("CREATE v")
    for i in range(0, len(points), 500):
        connection.ask("ADD v " + " ".join(f"{x!r} {y!r}" for x, y in points[i : i + 500]))
        connection.ask("FSET v z " + " ".join(f"{i + k} {z!r}" for k, z in enumerate(values[i : i + 500])))
    connection.ask("TRIANGULATE v")


def main():
    connection, rng, compared = Connection(int(sys.argv[1])), random.Random(21), 0
    for name, points in families(rng):
        points = list(dict.fromkeys(points))
        values = [1000 + rng.random() for _ in points]
        fill(connection, points, values)
        before = compared
        for _ in range(6):
            compared += check(connection, points, values, place(points, rng))
        assert compared > before, name
        hull, before = [int(row.split()[0]) for row in connection.ask("HULL v")], compared
        for _ in range(20):
            compared += check_outside(connection, points, hull, values, far_place(points, rng))
        assert compared > before, name
        connection.ask("DROP v")
    assert compared > 100, compared
    print(compared)


if __name__ == "__main__":
    main()
