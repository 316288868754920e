"""The steps of TRACE, replayed from PROTOCOL.md's description alone, make the triangles of TRIANGLES; and the film that
`delaunay trace` makes of them is XML and shows those triangles.

    trace.py DELAUNAY PORT
"""

import random
import subprocess
import sys
import xml.etree.ElementTree as ElementTree

sys.path.insert(0, "clients/python")
from delaunayd import Client  # noqa: E402

SVG = "{http://www.w3.org/2000/svg}"


def canonical(a, b, c):
    return min((a, b, c), (b, c, a), (c, a, b))


def replay(rows):
    """The triangles, and the hull, which is the front at the end."""
    front, triangles, removed, hull = {}, [], [], []
    for row in rows:
        kind, *words = row.split(" ")
        if kind in ("grid", "search"):
            continue
        v = [int(w) for w in words]
        if kind == "first":
            a, b, c = v
            front = {a: c, c: b, b: a}
        elif kind == "point":
            a, b, c = v
            assert front[a] == b and c not in front and c not in removed, row
            front[a], front[c] = c, b
        elif kind == "right":
            a, b, c = v
            assert front[a] == b and front[b] == c, row
            front[a] = c
            del front[b]
        elif kind == "left":
            a, b, c = v
            assert front[c] == a and front[a] == b, row
            front[c] = b
            del front[a]
        elif kind == "cave":
            a, b, c = v
            assert front[a] == b and c in front and front[b] != c and front[c] != a, row
        elif kind == "border":
            assert front[v[0]] == v[1], row
        elif kind == "remove":
            assert v[0] not in front, row
            removed.append(v[0])
        elif kind == "hull":
            assert not hull or not front or front[hull[-1]] == v[0], row
            hull.append(v[0])
        else:
            assert kind == "start", row
        if kind in ("first", "point", "right", "left"):
            triangles.append(canonical(*v))
    assert set(front) in (set(hull), set()) and not set(hull) & set(removed)
    return sorted(triangles), hull


def check_film(text, triangles, points):
    root = ElementTree.fromstring(text)
    assert root.tag == SVG + "svg" and len(list(root.iter(SVG + "circle"))) == points
    assert not list(root.iter(SVG + "script"))
    shown = [p for p in root.iter(SVG + "path") if p.get("fill") == "#e9f1fa"]
    assert len(shown) == triangles, (len(shown), triangles)
    total = {a.get("dur") for a in root.iter(SVG + "animate")}
    assert len(total) == 1, total
    for a in root.iter(SVG + "animate"):
        times = [float(t) for t in (a.get("keyTimes") or "0").split(";")]
        assert times == sorted(times) and times[0] == 0 and times[-1] < 1, a.attrib
        assert a.get("values") is None or len(a.get("values").split(";")) == len(times), a.attrib


def check(client, command, points):
    client.load("film", points)
    rows = client.command("TRACE", "film").rows
    triangles, hull = replay(rows)
    client.triangulate("film")
    table = client.triangles("film")
    assert triangles == [tuple(map(int, row)) for row in table], len(points)
    assert sorted(hull) == sorted(client.hull("film"))
    film = subprocess.run(command + ["trace", "film", "-"], check=True, stdout=subprocess.PIPE).stdout
    check_film(film, len(triangles), len(points))
    client.drop("film")


def main():
    delaunay, port = sys.argv[1:]
    command = [delaunay, "-h", "127.0.0.1", "-p", port]
    rng = random.Random(7)
    with Client("delaunay://127.0.0.1:" + port) as client:
        for n in (3, 4, 7, 30, 200, 1000):
            check(client, command, [(rng.random(), rng.random()) for _ in range(n)])
            check(client, command, [(rng.randrange(9), rng.randrange(40)) for _ in range(n)])
            check(client, command, [(rng.gauss(0, 1) ** 3, rng.gauss(0, 1)) for _ in range(n)])


main()
