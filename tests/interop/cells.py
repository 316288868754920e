"""VORONOI and AREAS against their definition in rational arithmetic: a cell is cut out of the box by one half plane after the
other, and its corners are rounded once. After random edits, too.

    cells.py PORT
"""

import random
import sys
from fractions import Fraction

sys.path.insert(0, "tests/interop")
from weights import Connection, families  # noqa: E402


def clip(polygon, inside):
    """The part of the polygon where the linear function `inside` is not negative."""
    value, result = [inside(c) for c in polygon], []
    for i, a in enumerate(polygon):
        k = (i + 1) % len(polygon)
        if value[i] >= 0:
            result.append(a)
        if value[i] * value[k] < 0:
            t, b = value[i] / (value[i] - value[k]), polygon[k]
            result.append((a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])))
    return result


def nearer(a, b):
    dx, dy, half = b[0] - a[0], b[1] - a[1], (b[0] ** 2 + b[1] ** 2 - a[0] ** 2 - a[1] ** 2) / 2
    return lambda c: half - c[0] * dx - c[1] * dy


def area(polygon):
    return sum(a[0] * b[1] - a[1] * b[0] for a, b in zip(polygon, polygon[1:] + polygon[:1])) / 2


def area_error(polygon):
    xs, ys = [x for x, _ in polygon] or [0], [y for _, y in polygon] or [0]
    return abs(area(polygon)) / 2**52 + len(polygon) * (max(xs) - min(xs)) * (max(ys) - min(ys)) / 2**98


def exact_cell(site, sites, box):
    x0, y0, x1, y1 = box
    cell = [(x0, y0), (x1, y0), (x1, y1), (x0, y1)]
    for other in sites:
        if other != site and cell:
            cell = clip(cell, nearer(site, other))
    return cell if len(cell) > 2 and area(cell) > 0 else []


def rounded(cell):
    """Python rounds a quotient of integers once, to the nearest double."""
    corners = [(float(x), float(y)) for x, y in cell]
    corners = [c for i, c in enumerate(corners) if c != corners[i - 1]]
    if not corners:
        return []
    return min(corners[i:] + corners[:i] for i in range(len(corners)))


def check(connection, points, box):
    """How many cells were compared; points: place by id."""
    exact = {id: (Fraction(x), Fraction(y)) for id, (x, y) in points.items()}
    where = "" if box is None else " BOX " + " ".join(map(repr, box))
    connection.file.write(f"VORONOI c{where}\n")
    connection.file.flush()
    status = connection.file.readline().split()
    sides = [Fraction(float(v)) for v in status[2][4:].split(",")]
    rows = [connection.file.readline().split() for _ in range(int(status[1]))]
    areas = [float(row.split()[1]) for row in connection.ask(f"AREAS c{where}")]
    assert [int(row[0]) for row in rows] == sorted(points)
    for row, size in zip(rows, areas):
        got = [(float(row[i]), float(row[i + 1])) for i in range(2, len(row), 2)]
        cell = exact_cell(exact[int(row[0])], exact.values(), sides)
        assert len(got) == int(row[1])
        assert got == rounded(cell), (row[0], got, rounded(cell))
        polygon = [(Fraction(x), Fraction(y)) for x, y in got]
        assert abs(Fraction(size) - area(polygon)) <= area_error(polygon), (row[0], size, float(area(polygon)))
    whole = (sides[2] - sides[0]) * (sides[3] - sides[1])
    assert abs(sum(map(Fraction, areas)) - whole) <= whole / 10**12
    return len(rows)


def edit(connection, points, family, rng):
    for _ in range(6):
        id, place = rng.choice(sorted(points)), rng.choice(family)
        if rng.random() < 0.5 and len(points) > 3:
            connection.ask(f"DEL c {id}")
            del points[id]
        elif place not in points.values():
            connection.ask(f"MOVE c {id} {place[0]!r} {place[1]!r}")
            points[id] = place


def boxes(points, rng):
    yield None
    for _ in range(3):
        (ax, ay), (bx, by) = rng.sample(sorted(points.values()), 2)
        if ax != bx and ay != by:
            yield (ax, ay, bx, by)
        else:
            yield (ax - 1.75, ay - 0.3, ax + 0.5, ay + 1)


def many(rng):
    """So many points that a worker computes all areas at once."""
    yield [(rng.random(), rng.random()) for _ in range(74)]
    yield [(x / 7, y / 3) for x in range(11) for y in range(7)]
    yield [(i + rng.random(), rng.random() * 1e-9) for i in range(73)] + [(7.0, 3.0)]
    yield [(1e9 + rng.random(), -1e9 + rng.random()) for _ in range(73)] + [(1e30, 2e29)]


def main():
    connection, rng, compared = Connection(int(sys.argv[1])), random.Random(21), 0
    lines = [("a line", [(i / 7, i / 7) for i in range(9)]), ("a slanted line", [(3.0 * i, 1e-3 * i) for i in range(9)]),
             ("an upright line", [(0.1, float(i * i)) for i in range(7)]), ("two points", [(0.1, 0.7), (0.3, -5.0)])]
    large = [("many", family) for family in many(random.Random(22))]
    for name, family in [*families(rng), *lines, *large]:
        family = list(dict.fromkeys(family))
        points = dict(enumerate(family))
        connection.ask("CREATE c")
        connection.ask("ADD c " + " ".join(f"{x!r} {y!r}" for x, y in family))
        connection.ask("TRIANGULATE c")
        for _ in range(3):
            for box in [None] if name == "many" else boxes(points, rng):
                compared += check(connection, points, box)
            edit(connection, points, family, rng)
        connection.ask("DROP c")
    assert compared > 1000, compared


if __name__ == "__main__":
    main()
