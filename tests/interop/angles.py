"""QUALITY in rational arithmetic, on all families of tests/oracle/families.c: bins are decided by squared cosines in fractions, and are
compared with REFINE, which decides alike. Angles are compared with those of 60 digits.

    angles.py BUILD_DIR [FAMILY...]
"""

import sys
from decimal import Decimal, localcontext
from fractions import Fraction

sys.path.insert(0, "tests/interop")
from surfaces import arguments, stages  # noqa: E402
from volumes import Asking  # noqa: E402

checked = 0
DIGITS = 60


def decimal(fraction):
    return Decimal(fraction.numerator) / Decimal(fraction.denominator)


def arc_tangent(t):
    """0 <= t <= 1."""
    for _ in range(8):
        t = t / (1 + (1 + t * t).sqrt())
    total, term, k = Decimal(0), t, 1
    while term != 0 and abs(term) > abs(total) * Decimal(10) ** -DIGITS:
        total += term / k
        term, k = -term * t * t, k + 2
    return 256 * total


def degrees(cross, dot):
    """The angle with these products, in degrees."""
    half = 4 * arc_tangent(Decimal(1))
    a, b = decimal(cross), decimal(abs(dot))
    angle = arc_tangent(a / b) if a <= b else half / 2 - arc_tangent(b / a)
    return (half - angle if dot < 0 else angle) * 180 / half


def cosine(degree):
    half, x, k = 4 * arc_tangent(Decimal(1)), Decimal(1), 0
    angle, total = half * degree / 180, Decimal(0)
    while abs(x) > Decimal(10) ** -DIGITS:
        total += x
        k += 2
        x = -x * angle * angle / (k * (k - 1))
    return total


def limits():
    """The doubles nearest to the squared cosines of 5, 10, ... 55 degrees."""
    return [Fraction(float(cosine(Decimal(degree)) ** 2)) for degree in range(5, 60, 5)]


def products(r, p, q):
    ux, uy, vx, vy = p[0] - r[0], p[1] - r[1], q[0] - r[0], q[1] - r[1]
    return ux * vy - uy * vx, ux * vx + uy * vy, ux * ux + uy * uy, vx * vx + vy * vy


def bin_of(corner, limit):
    _, dot, u, v = corner
    return next((i for i, c in enumerate(limit) if dot > 0 and dot * dot > c * u * v), len(limit))


def is_root(text, square):
    root = Fraction(float(text))
    return (root * (1 - Fraction(1, 2**51))) ** 2 <= square <= (root * (1 + Fraction(1, 2**51))) ** 2


def recount(triangles, place, limit):
    counts, area, corners = [0] * 12, Fraction(0), []
    for a, b, c in triangles:
        p, q, r = place[a], place[b], place[c]
        three = [products(p, q, r), products(q, r, p), products(r, p, q)]
        counts[min(bin_of(corner, limit) for corner in three)] += 1
        area += three[0][0] / 2
        corners += three
    return counts, area, corners


def compare(connection, model, words, table, limit):
    global checked
    place = {i: tuple(map(Fraction, p)) for i, p in model.points.items()}
    triangles = [tuple(map(int, row.split())) for row in connection.ask(table)]
    counts, area, corners = recount(triangles, place, limit)
    got = connection.status(f"QUALITY {model.name}{words}")
    rows = [tuple(map(int, connection.file.readline().split())) for _ in range(12)]
    assert rows == [(5 * i, 5 * i + 5, n) for i, n in enumerate(counts)], (model.name, rows, counts)
    assert int(got["triangles"]) == len(triangles) and Fraction(float(got["area"])) == Fraction(float(area)), (model.name, got)
    if not corners:
        assert got["angle"] == got["largest"] == got["shortest"] == got["longest"] == "nan"
    else:
        sides = [corner[2] for corner in corners]
        assert is_root(got["shortest"], min(sides)) and is_root(got["longest"], max(sides)), (model.name, got)
        sharpest = max(corners, key=lambda corner: corner[1] / corner[0])
        bluntest = min(corners, key=lambda corner: corner[1] / corner[0])
        for key, corner in (("angle", sharpest), ("largest", bluntest)):
            want = float(degrees(corner[0], corner[1]))
            assert float(got[key]) == want, (model.name, key, got[key], want)
    checked += 1


def main():
    build, names = arguments()
    with localcontext() as context:
        context.prec = DIGITS + 20
        limit = limits()
        assert limit[5] == Fraction(3, 4) and limit[8] == Fraction(1, 2)
        for connection, model, edited in stages(build, names, Asking):
            compare(connection, model, "", f"TRIANGLES {model.name}", limit)
            if not edited or not connection.ask(f"TRIANGLES {model.name}"):
                continue
            refined = connection.status(f"REFINE {model.name} ANGLE 20 LIMIT 200")
            inside = connection.status(f"QUALITY {model.name} INSIDE")
            below = sum(int(connection.file.readline().split()[2]) * (i < 4) for i in range(12))
            assert inside["angle"] == refined["angle"] and below == int(refined["unrefined"]), (model.name, inside, refined, below)
    print(checked, "requests")
    assert checked == 4 * len(names)


if __name__ == "__main__":
    main()
