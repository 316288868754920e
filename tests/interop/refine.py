"""REFINE in rational arithmetic, on all families of tests/oracle/families.c: the triangles inside that break a limit are counted again, and
the least angle is measured again.

    refine.py BUILD_DIR [FAMILY...]
"""

import functools
import math
import sys
from fractions import Fraction

sys.path.insert(0, "tests/interop")
from surfaces import arguments, stages  # noqa: E402
from volumes import Asking, cross  # noqa: E402

checked = 0


def arctangent(inverse):
    """atan(1 / inverse), to 2^-260."""
    total, power, k = Fraction(0), Fraction(1, inverse), 0
    while power > Fraction(1, 2**260):
        total += power / (2 * k + 1) * (-1) ** k
        power /= inverse * inverse
        k += 1
    return total


PI = 16 * arctangent(5) - 4 * arctangent(239)


@functools.cache
def squared_cosine(degrees):
    """The double nearest to cos^2."""
    x = Fraction(degrees) * PI / 90
    total, term = Fraction(0), Fraction(1)
    for k in range(60):
        total += term
        term = -term * x * x / ((2 * k + 1) * (2 * k + 2))
    return Fraction(float((1 + total) / 2))


class Limits:
    """What the triangles are measured against, for coordinates that were multiplied by `scale`, which makes them integers."""

    def __init__(self, scale, angle, area, length):
        self.cosine = None if angle is None else squared_cosine(angle)
        self.doubled_area = None if area is None else math.floor(2 * Fraction(area) * scale * scale)
        self.square = None if length is None else math.floor(Fraction(length) ** 2 * scale * scale)


def integers(rows):
    """The places of points, multiplied by a power of two that makes all of them integers, and that power."""
    place = {int(row[0]): (Fraction(float(row[1])), Fraction(float(row[2]))) for row in rows}
    scale = max((v.denominator for p in place.values() for v in p), default=1)
    return {i: (int(x * scale), int(y * scale)) for i, (x, y) in place.items()}, scale


def dot(o, a, b):
    return (a[0] - o[0]) * (b[0] - o[0]) + (a[1] - o[1]) * (b[1] - o[1])


def breaks(corners, limits):
    if limits.doubled_area is not None and cross(*corners) > limits.doubled_area:
        return True
    for i in range(3):
        o, a, b = corners[i], corners[(i + 1) % 3], corners[(i + 2) % 3]
        if limits.square is not None and dot(a, b, b) > limits.square:
            return True
        d = dot(o, a, b)
        if limits.cosine is not None and d > 0:
            if d * d * limits.cosine.denominator > limits.cosine.numerator * dot(o, a, a) * dot(o, b, b):
                return True
    return False


def least_angle(triangles, place):
    """The greatest squared cosine of an angle below 90 degrees, as an angle in degrees."""
    best = None
    for ids in triangles:
        corners = [place[i] for i in ids]
        for i in range(3):
            o, a, b = corners[i], corners[(i + 1) % 3], corners[(i + 2) % 3]
            d, c = dot(o, a, b), cross(o, a, b)
            if d > 0 and (best is None or c * best[0] < best[1] * d):
                best = (d, c)
    return math.degrees(math.atan(float(Fraction(best[1], best[0]))))


def rows_of(connection, line):
    return [row.split() for row in connection.ask(line)]


def check(connection, name, words, angle, area, length, inside):
    global checked
    before = rows_of(connection, f"POINTS {name}")
    had_borders = any(row[2] == "border" for row in rows_of(connection, f"CONSTRAINTS {name}"))
    got = connection.status(f"REFINE {name} {words}{inside}")
    points = rows_of(connection, f"POINTS {name}")
    assert points[: len(before)] == before and len(points) == len(before) + int(got["added"]), (name, words)
    place, scale = integers(points)
    if not rows_of(connection, f"TRIANGLES {name}"):
        assert got["added"] == "0" and got["angle"] == "nan"
        return
    assert (int(got["hull"]) > 0) != had_borders
    triangles = [tuple(map(int, row)) for row in rows_of(connection, f"TRIANGLES {name}{inside or ' INSIDE'}")]
    limits = Limits(scale, angle, area, length)
    wrong = sum(breaks([place[i] for i in ids], limits) for ids in triangles)
    assert wrong == int(got["unrefined"]), (name, words, wrong, got)
    least = least_angle(triangles, place)
    assert abs(least - float(got["angle"])) <= 1e-13 * least, (name, words, least, got)
    assert connection.status(f"CHECK {name}")["delaunay"] == "yes"
    checked += 1


def compare(connection, model):
    name = model.name
    xs = [p[0] for p in model.points.values()]
    ys = [p[1] for p in model.points.values()]
    width = max(max(xs) - min(xs), max(ys) - min(ys))
    check(connection, name, "ANGLE 20.7", 20.7, None, None, "")
    if not connection.ask(f"TRIANGLES {name}"):
        return
    check(connection, name, "ANGLE 30 LIMIT 300", 30.0, None, None, " INSIDE 0")
    if width > 0:
        length = width / 7
        check(connection, name, f"LENGTH {length!r} LIMIT 300", None, None, length, "")
        area = width * width / 200
        if 2.0**-142 <= area <= 2.0**201:
            check(connection, name, f"KEEP AREA {area!r} ANGLE 25 LIMIT 200", 25.0, area, None, "")


def main():
    build, names = arguments()
    for connection, model, _ in stages(build, names, Asking, edits=0):
        compare(connection, model)
    print(checked, "requests")
    assert checked > 2 * len(names) - 6


if __name__ == "__main__":
    main()
