"""MISSING skip on all families of tests/oracle/families.c: every reply equals, byte for byte, that of a set that never had the points without
a value, nor constraints that end at one. Few values are missing, or half, or all but two, or all; with constraints and without.

    missing.py BUILD_DIR [FAMILY...]
"""

import math
import sys

sys.path[:0] = ["tests/interop", "tests/interop/fields"]
from surfaces import arguments, stages  # noqa: E402
from weights import Connection  # noqa: E402

METHODS = ("linear", "nearest", "natural", "laplace", "smooth")
checked = 0


class Asking(Connection):
    """Replies as they are: errors, too."""

    def reply(self, line):
        self.file.write(line + "\n")
        self.file.flush()
        status = self.file.readline()
        rows = int(status.split()[1]) if status.startswith("OK") else 0
        return [status] + [self.file.readline() for _ in range(rows)]


def words(values):
    return " ".join(repr(float(v)) for v in values)


def box(model):
    xs, ys = zip(*model.points.values())
    return min(xs), min(ys), max(xs), max(ys)


def places_of(model, n):
    """n points, n places in their box and one outside, of coordinates that the daemon takes."""
    (x0, y0, x1, y1), r = box(model), model.rng
    places = [r.choice(list(model.points.values())) for _ in range(n)]
    places += [(r.uniform(x0, x1), r.uniform(y0, y1)) for _ in range(n)] + [(2 * x1 - x0, y1)]
    return [v for place in places if all(v == 0 or 2**-142 <= abs(v) <= 2**201 for v in place) for v in place]


def requests(model):
    """Pairs: what comes before the name of the set, and behind it."""
    points = list(model.points.values())
    (x0, y0, x1, y1), places = box(model), places_of(model, 20)
    way = [v for _ in range(3) for v in model.rng.choice(points)]
    for method in METHODS:
        yield "INTERPOLATE", f"z {words(places)} METHOD {method}"
        yield "RASTER", f"z {words((x0, y0, x1, y1))} 9 7 METHOD {method} OUTSIDE nearest"
    for inside in ("", " INSIDE", " INSIDE 1"):
        yield "RASTER", f"z {words((x0, y0, x1, y1))} 9 7 AS slope{inside}"
        yield "GRADIENT", f"z {words(places)}{inside}"
        yield "CONTOUR", f"z EVERY 40{inside}"
        yield "CONTOUR", f"z -50 0 50 BANDS{inside}"
        yield "PROFILE", f"z {words(way)}{inside}"
        yield "VOLUME", f"z LEVEL 2.5{inside}"


def constraints(connection, model):
    """Edges of the triangulation, and a triangle as border 1: these cannot cross."""
    triangles = [row.split() for row in connection.ask(f"TRIANGLES {model.name}")]
    lines = [t[:2] for t in model.rng.sample(triangles, min(len(triangles), 8))]
    ring = model.rng.choice(triangles) if triangles else []
    borders = [[ring[i], ring[(i + 1) % 3]] for i in range(3)] if ring else []
    return [(a, b, "") for a, b in lines] + [(a, b, "BORDER OF 1 ") for a, b in borders]


def make_other(connection, model, kept, declared):
    """The set that never had the other points."""
    ids = {id: i for i, id in enumerate(kept)}
    connection.reply("DROP other")
    connection.reply("CREATE other")
    if kept:
        connection.reply("ADD other FIELDS z " + " ".join(f"{words(model.points[i])} {model.z[i]!r}" for i in kept))
    else:
        connection.reply("ADD other FIELDS z 0 0 1")
        connection.reply("DEL other 0")
    assert connection.reply("TRIANGULATE other")[0].startswith("OK")
    for a, b, kind in declared:
        if int(a) in ids and int(b) in ids:
            got = connection.reply(f"CONSTRAIN other {kind}{ids[int(a)]} {ids[int(b)]}")
            assert got[0].startswith("OK"), got


def compare(connection, model, declared):
    global checked
    kept = [id for id in sorted(model.points) if model.z[id] == model.z[id]]
    make_other(connection, model, kept, declared)
    for command, rest in requests(model):
        got = connection.reply(f"{command} {model.name} {rest} MISSING skip")
        want = connection.reply(f"{command} other {rest}")
        assert got == want, (model.name, command, rest, got[:3], want[:3])
        checked += 1


def lose(connection, model, ids):
    for id in ids:
        model.z[id] = math.nan
    if ids:
        connection.reply(f"FSET {model.name} z " + " ".join(f"{id} nan" for id in ids))


def main():
    build, names = arguments()
    for connection, model, _ in stages(build, names, Asking):
        compare(connection, model, [])
        ids = sorted(model.points)
        declared = constraints(connection, model)
        for a, b, kind in declared:
            assert connection.reply(f"CONSTRAIN {model.name} {kind}{a} {b}")[0].startswith("OK")
        kept = dict(model.z)
        for lost in ([], model.rng.sample(ids, len(ids) // 2), ids[: max(len(ids) - 2, 0)], ids):
            lose(connection, model, lost)
            compare(connection, model, declared)
        model.z = kept
        connection.reply(f"FSET {model.name} z " + " ".join(f"{id} {z!r}" for id, z in kept.items()))
        if declared:
            assert connection.reply(f"RELEASE {model.name} ALL")[0].startswith("OK")
    print(checked, "requests")
    assert checked > 100 * len(names)


if __name__ == "__main__":
    main()
