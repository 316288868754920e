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


# ---- METHOD smooth, by another way: the patch is found from its slopes, by linear equations, in fractions ----


def slopes(points, values, ring, v):
    """Least squares over the neighbours, weighted by 1 / d^2."""
    a = b = c = r = s = Fraction(0)
    for u in ring:
        x, y = (Fraction(p) - Fraction(q) for p, q in zip(points[u], points[v]))
        z, weight = Fraction(values[u]) - Fraction(values[v]), 1 / (x * x + y * y)
        a, b, c, r, s = a + weight * x * x, b + weight * x * y, c + weight * y * y, r + weight * x * z, s + weight * y * z
    det = a * c - b * b
    flat = det <= (a + c) ** 2 / 2**30
    return (r / (a + c), s / (a + c)) if flat else ((c * r - b * s) / det, (a * s - b * r) / det)


def dot(a, b):
    return a[0] * b[0] + a[1] * b[1]


def minus(a, b):
    return (a[0] - b[0], a[1] - b[1])


def patch_value(corner, value, slope, q):
    """The surface over the third of the triangle that contains q."""
    centre = (sum(p[0] for p in corner) / 3, sum(p[1] for p in corner) / 3)
    beside = []
    for k in range(3):
        i, j = (k + 1) % 3, (k + 2) % 3
        side = minus(corner[j], corner[i])
        normal = (-side[1], side[0])
        middle = ((corner[i][0] + corner[j][0]) / 2, (corner[i][1] + corner[j][1]) / 2)
        across = (dot(slope[i], normal) + dot(slope[j], normal)) / 2
        rise = value[j] - value[i]
        along = (Fraction(3, 2) * rise - (dot(slope[i], side) + dot(slope[j], side)) / 4)
        gradient = tuple((across * n + along * s) / dot(side, side) for n, s in zip(normal, side))
        ordinate = {name: value[m] + dot(slope[m], minus(to, corner[m])) / 3
                    for name, m, to in (("ij", i, corner[j]), ("ji", j, corner[i]), ("ic", i, centre), ("jc", j, centre))}
        # The slope at the middle towards the centre is 3/4 (ic + 2 beside + jc) - 3/8 (i + 3 ij + 3 ji + j) there.
        steep = dot(gradient, minus(centre, middle))
        edge = (value[i] + 3 * ordinate["ij"] + 3 * ordinate["ji"] + value[j]) / 8
        beside.append((Fraction(4, 3) * (steep + 3 * edge) - ordinate["ic"] - ordinate["jc"]) / 2)
    toward = [value[m] + dot(slope[m], minus(centre, corner[m])) / 3 for m in range(3)]
    inner = [(toward[m] + beside[(m + 1) % 3] + beside[(m + 2) % 3]) / 3 for m in range(3)]
    weight = in_triangle(corner, q)
    k = weight.index(min(weight))
    i, j = (k + 1) % 3, (k + 2) % 3
    u, v, w = weight[i] - weight[k], weight[j] - weight[k], 3 * weight[k]
    on = [value[m] + dot(slope[m], minus(corner[n], corner[m])) / 3 for m, n in ((i, j), (j, i))]
    return (u**3 * value[i] + v**3 * value[j] + w**3 * sum(inner) / 3 + 3 * u * u * v * on[0] + 3 * u * v * v * on[1]
            + 3 * u * u * w * toward[i] + 3 * v * v * w * toward[j] + 3 * u * w * w * inner[i] + 3 * v * w * w * inner[j]
            + 6 * u * v * w * beside[k])


def check_smooth(connection, points, values, q):
    located = connection.ask(f"LOCATE v {q[0]!r} {q[1]!r}")
    if not located or len(located[0].split()) != 3:
        return 0
    ids = [int(word) for word in located[0].split()]
    rings = [[int(word) for word in connection.ask(f"LISTS v {v}")[0].split()[1:]] for v in ids]
    slope = [slopes(points, values, ring, v) for ring, v in zip(rings, ids)]
    corner = [tuple(map(Fraction, points[v])) for v in ids]
    want = patch_value(corner, [Fraction(values[v]) for v in ids], slope, tuple(map(Fraction, q)))
    (row,) = connection.ask(f"INTERPOLATE v z {q[0]!r} {q[1]!r} METHOD smooth")
    size = max(abs(dot(g, minus(a, b))) for g in slope for a in corner for b in corner)
    return abs(Fraction(float(row)) - want) / (size + 1000)


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
        if name not in ("wide exponents", "outlier", "nearly flat hull", "slivers"):
            error = max(check_smooth(connection, points, values, place(points, rng)) for _ in range(10))
            assert error < 1e-11, (name, float(error))
        hull, before = [int(row.split()[0]) for row in connection.ask("HULL v")], compared
        for _ in range(20):
            compared += check_outside(connection, points, hull, values, far_place(points, rng))
        assert compared > before, name
        connection.ask("DROP v")
    assert compared > 100, compared
    print(compared)


if __name__ == "__main__":
    main()
