"""SIMPLIFY in rational arithmetic, on all families of tests/oracle/families.c: every point is compared with the linear surface of the
new set, as the daemon triangulates that, and no point that is kept may be needless.

    simplify.py BUILD_DIR [FAMILY...]
"""

import math
import sys
from fractions import Fraction

sys.path.insert(0, "tests/interop")
from surfaces import arguments, stages  # noqa: E402
from volumes import Asking, cross  # noqa: E402

checked = 0


def between(a, b, q):
    return cross(a, b, q) == 0 and min(a, b) <= q <= max(a, b)


def surfaces_at(q, triangles, edges, place, z):
    """The values at q of all triangles that contain it, or of edges if there are no triangles; None: no value."""
    for ids in triangles or edges:
        corners = [place[i] for i in ids]
        if len(ids) == 2:
            inside = between(*corners, q)
            a, b = corners
            k = 0 if a[0] != b[0] else 1
            weights = [(b[k] - q[k]) / (b[k] - a[k]), (q[k] - a[k]) / (b[k] - a[k])] if inside else []
        else:
            area = cross(*corners)
            weights = [cross(q, corners[1], corners[2]) / area, cross(q, corners[2], corners[0]) / area, cross(q, corners[0], corners[1]) / area]
            inside = min(weights) >= 0
        if inside:
            values = [z[i] for i in ids]
            yield None if None in values else sum(w * v for w, v in zip(weights, values))


def fractions(row):
    return tuple(Fraction(float(w)) for w in row.split()[1:3])


def check(connection, model, bound, options=""):
    """Every point with a value is on a vertex, or within the bound of the surface; and error= is the largest distance."""
    global checked
    facts = connection.status(f"SIMPLIFY {model.name} z ERROR {bound!r} {options} IDS old INTO few")
    connection.ask("TRIANGULATE few")
    rows = connection.ask("POINTS few FIELDS z,old")
    place = {int(row.split()[0]): fractions(row) for row in rows}
    z = {int(row.split()[0]): None if row.split()[3] == "nan" else Fraction(float(row.split()[3])) for row in rows}
    for row in rows:
        words = row.split()
        old = int(float(words[4]))
        assert tuple(map(float, words[1:3])) == model.points[old], (model.name, row)
        assert str(float(words[3])) == str(model.z[old]), (model.name, row)
    triangles = [tuple(map(int, row.split())) for row in connection.ask("TRIANGLES few")]
    edges = [tuple(map(int, row.split())) for row in connection.ask("EDGES few")]
    aliases = {int(row.split()[0]) for row in connection.ask(f"COINCIDENT {model.name}")}
    worst, vertices = Fraction(0), set(place.values())
    for i, p in model.points.items():
        q = tuple(map(Fraction, p))
        if i in aliases or math.isnan(model.z[i]) or q in vertices:
            continue
        values = list(surfaces_at(q, triangles, edges, place, z))
        assert values and None not in values, (model.name, i, "is outside of the surface")
        worst = max(worst, *(abs(v - Fraction(model.z[i])) for v in values))
    assert options or worst <= Fraction(bound), (model.name, bound, float(worst))
    assert abs(Fraction(float(facts["error"])) - worst) <= Fraction(2) ** -8, (model.name, facts, float(worst))
    connection.ask("DROP few")
    checked += 1
    return int(facts["points"])


def compare(connection, model):
    all_of_them = check(connection, model, 0.0)
    assert check(connection, model, 5.0) <= all_of_them
    assert check(connection, model, 60.0) <= all_of_them
    ids = sorted(model.points)
    for _ in range(6):
        if len(ids) > 1:
            a, b = model.rng.sample(ids, 2)
            connection.file.write(f"CONSTRAIN {model.name} {a} {b}\n")
            connection.file.flush()
            connection.file.readline()  # it may cross others
    check(connection, model, 20.0)
    connection.ask(f"RELEASE {model.name} ALL")


def main():
    build, names = arguments()
    for connection, model, _ in stages(build, names, Asking, most=50, edits=15):
        compare(connection, model)
    print(checked, "requests")
    assert checked == 16 * len(names)


if __name__ == "__main__":
    main()
