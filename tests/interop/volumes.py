"""VOLUME in rational arithmetic, on all families of tests/oracle/families.c: each triangle is cut along the line where the surface has the
level, and both parts are measured as prisms with a slanting top, in fractions.

    volumes.py BUILD_DIR [FAMILY...]
"""

import sys
from fractions import Fraction

sys.path.insert(0, "tests/interop")
from surfaces import arguments, stages  # noqa: E402
from weights import Connection  # noqa: E402

BOUND = Fraction(1, 2**45)
checked = 0


class Asking(Connection):
    def status(self, line):
        self.file.write(line + "\n")
        self.file.flush()
        words = self.file.readline().split()
        assert words[0] == "OK", (line, words)
        return dict(word.split("=") for word in words[2:])


def cross(o, a, b):
    return (a[0] - o[0]) * (b[1] - o[1]) - (a[1] - o[1]) * (b[0] - o[0])


def part(corners, sign):
    """What is above (sign 1) or below (-1): corners (x, y, h), clipped where h changes its sign."""
    kept = []
    for i, a in enumerate(corners):
        b = corners[(i + 1) % len(corners)]
        if sign * a[2] >= 0:
            kept.append(a)
        if a[2] * b[2] < 0:
            t = a[2] / (a[2] - b[2])
            kept.append((a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1]), Fraction(0)))
    return kept


def prism(corners):
    """The integral of h over a convex polygon."""
    total = Fraction(0)
    for i in range(1, len(corners) - 1):
        a, b, c = corners[0], corners[i], corners[i + 1]
        total += cross(a, b, c) / 2 * (a[2] + b[2] + c[2]) / 3
    return total


def in_box(corners, box):
    """Corners (x, y, h), clipped at the sides of a box."""
    for axis in (0, 1):
        for side, sign in ((box[axis], 1), (box[2 + axis], -1)):
            kept = []
            for i, a in enumerate(corners):
                b = corners[(i + 1) % len(corners)]
                at_a, at_b = sign * (a[axis] - side), sign * (b[axis] - side)
                if at_a >= 0:
                    kept.append(a)
                if at_a * at_b < 0:
                    t = at_a / (at_a - at_b)
                    kept.append(tuple(u + t * (v - u) for u, v in zip(a, b)))
            corners = kept
    return corners


def area_of(corners):
    return sum((cross(corners[0], corners[i], corners[i + 1]) / 2 for i in range(1, len(corners) - 1)), Fraction(0))


def volumes(triangles, place, height, box):
    above = below = area = Fraction(0)
    for ids in triangles:
        if any(height[i] is None for i in ids):
            continue
        corners = [(*place[i], height[i]) for i in ids]
        if box:
            corners = in_box(corners, box)
        above += prism(part(corners, 1))
        below -= prism(part(corners, -1))
        area += area_of(corners)
    return above, below, area


def check(connection, name, words, triangles, place, height, box=None):
    global checked
    if box:
        words += " BOX " + " ".join(repr(float(v)) for v in box)
    got = connection.status(f"VOLUME {name} {words}")
    above, below, area = volumes(triangles, place, height, box)
    for key, want, limit in (("above", above, above + below), ("below", below, above + below), ("area", area, area)):
        error = abs(Fraction(float(got[key])) - want)
        assert error <= limit * BOUND + Fraction(1, 2**1070), (name, words, key, got[key], float(want))
    checked += 1


def heights(values, base):
    return {i: None if v != v or base(i) is None else Fraction(v) - base(i) for i, v in values.items()}


def boxes(model):
    """Two boxes between points, and one that touches a few triangles near one of them at a tiny corner."""
    for tiny in (False, False, True):
        (ax, ay), (bx, by) = model.rng.choice(list(model.points.values())), model.rng.choice(list(model.points.values()))
        if tiny:
            bx, by = ax + max(abs(ax), 1e-20) * 2**-40, ay - max(abs(ay), 1e-20) * 2**-30
        yield [Fraction(v) for v in (min(ax, bx), min(ay, by), max(ax, bx), max(ay, by))]


def compare(connection, model):
    place = {i: tuple(map(Fraction, p)) for i, p in model.points.items()}
    triangles = [tuple(map(int, row.split())) for row in connection.ask(f"TRIANGLES {model.name}")]
    z, s = model.z, model.s
    some = next((v for v in z.values() if v == v), 0.0)
    for level in (0.0, 2.5, some, -1000.0):
        check(connection, model.name, f"z LEVEL {level!r}", triangles, place, heights(z, lambda i: Fraction(level)))
    for level in (0.0, 1.0):
        check(connection, model.name, f"s LEVEL {level!r}", triangles, place, heights(s, lambda i: Fraction(level)))
    for box in boxes(model):
        check(connection, model.name, f"z LEVEL {some!r}", triangles, place, heights(z, lambda i: Fraction(some)), box)
        check(connection, model.name, "z MINUS s", triangles, place, heights(z, lambda i: Fraction(s[i])), box)
    check(connection, model.name, "z MINUS s", triangles, place, heights(z, lambda i: Fraction(s[i])))
    check(connection, model.name, "s MINUS z", triangles, place, heights(s, lambda i: None if z[i] != z[i] else Fraction(z[i])))


def main():
    build, names = arguments()
    for connection, model, _ in stages(build, names, Asking):
        compare(connection, model)
    print(checked, "requests")
    assert checked == 56 * len(names)


if __name__ == "__main__":
    main()
