"""CONTOUR ... BANDS in rational arithmetic, on all families of tests/oracle/families.c: each triangle is cut along the levels in fractions,
pieces of a band that share more than a point are joined, and the sides that no two of them share are the sides of one polygon.

    bands.py BUILD_DIR [FAMILY...]

The polygons of the reply must have exactly these sides, byte for byte: a place on an edge is computed in doubles, by the formula of
PROTOCOL.md, and must be near its exact place. So areas, orientation and nesting are checked with the exact places. Values include
plateaus, ridges and saddles at a level, and gaps.
"""

import itertools
import math
import sys
from collections import Counter, defaultdict
from fractions import Fraction

sys.path.insert(0, "tests/interop")
from surfaces import Both, arguments, stages  # noqa: E402

counted = Counter()


# ---- the surface, cut along the levels ----


class Surface:
    """Nodes are points, or the places of levels on edges; each has an exact place, and a rounded one."""

    def __init__(self, points, values, triangles):
        self.points, self.values, self.triangles = points, values, triangles
        self.exact, self.rounded = {}, {}

    def vertex(self, i):
        self.rounded[i] = self.points[i]
        self.exact[i] = tuple(map(Fraction, self.points[i]))
        return i

    def crossing(self, a, b, level):
        """Of the edge a b, which the level crosses between its ends."""
        high, low = (a, b) if self.values[a] > self.values[b] else (b, a)
        node = (high, low, level)
        if node in self.exact:
            return node
        top, bottom = self.values[high], self.values[low]
        share = (top - level) / (top - bottom)
        t = (Fraction(top) - Fraction(level)) / (Fraction(top) - Fraction(bottom))
        place, exact = [], []
        for x, y in zip(self.points[high], self.points[low]):
            place.append(min(max(x + (y - x) * share, min(x, y)), max(x, y)))
            exact.append(Fraction(x) + t * (Fraction(y) - Fraction(x)))
            assert abs(Fraction(place[-1]) - exact[-1]) <= 4 * Fraction(math.ulp(max(abs(x), abs(y))))
        self.rounded[node], self.exact[node] = tuple(place), tuple(exact)
        return node

    def piece(self, ids, low, high):
        """The nodes around the part of a triangle between two levels, counterclockwise; None: it has no area."""
        if len({self.values[i] for i in ids}) == 1 and not low <= self.values[ids[0]] < high:
            return None
        nodes = []
        for a, b in zip(ids, ids[1:] + ids[:1]):
            p, q = self.values[a], self.values[b]
            if low <= p <= high:
                nodes.append(self.vertex(a))
            for level in (low, high) if p < q else (high, low):
                if min(p, q) < level < max(p, q):
                    nodes.append(self.crossing(a, b, level))
        return nodes if len(nodes) >= 3 and self.area(nodes) > 0 else None

    def area(self, nodes):
        places = [self.exact[n] for n in nodes]
        return sum(a[0] * b[1] - a[1] * b[0] for a, b in zip(places, places[1:] + places[:1])) / 2

    def polygons(self, low, high):
        """The connected parts of a band, each as its area and its sides."""
        pieces = [p for p in (self.piece(ids, low, high) for ids in self.triangles) if p is not None]
        parent = list(range(len(pieces)))

        def root(i):
            while parent[i] != i:
                parent[i] = i = parent[parent[i]]
            return i

        first = {}
        for i, piece in enumerate(pieces):
            for a, b in zip(piece, piece[1:] + piece[:1]):
                k = first.setdefault(frozenset((a, b)), i)
                parent[root(i)] = root(k)
        parts = defaultdict(list)
        for i, piece in enumerate(pieces):
            parts[root(i)].append(piece)
        for part in parts.values():
            sides = Counter((a, b) for piece in part for a, b in zip(piece, piece[1:] + piece[:1]))
            yield sum(map(self.area, part)), [s for s in sides if s[::-1] not in sides]


# ---- the reply ----


def read(rows):
    """Polygons (low, high, rings), each ring as its places."""
    found = []
    for row in rows:
        low, high, number, kind, k, *xy = row.split()
        ring = list(zip(map(float, xy[::2]), map(float, xy[1::2])))
        assert len(ring) == int(k) >= 3 and len(xy) == 2 * len(ring), row
        assert ring[0] == min(ring) and all(a != b for a, b in zip(ring, ring[1:] + ring[:1])), row
        assert kind == ("outer" if int(number) == len(found) else "hole"), row
        if kind == "outer":
            found.append((float(low), float(high), [ring]))
        else:
            assert int(number) == len(found) - 1 and found[-1][:2] == (float(low), float(high)), row
            found[-1][2].append(ring)
    assert found == sorted(found, key=lambda p: (p[0], p[2][0]))
    assert all(rings[1:] == sorted(rings[1:]) for _, _, rings in found)
    return found


def is_within(ring, q):
    """Whether q is inside a ring or on it, in fractions."""
    inside = False
    for a, b in zip(ring, ring[1:] + ring[:1]):
        turn = (b[0] - a[0]) * (q[1] - a[1]) - (b[1] - a[1]) * (q[0] - a[0])
        if turn == 0 and min(a, b) <= q <= max(a, b):
            return True
        if (a[1] > q[1]) != (b[1] > q[1]) and (turn > 0) == (b[1] > a[1]):
            inside = not inside
    return inside


def check_rings(surface, rings, sides):
    """Orientation, simplicity and nesting of the exact places, if each rounded place stands for one exact place."""
    node = {}
    for n in set(itertools.chain.from_iterable(sides)):
        if node.setdefault(surface.rounded[n], n) != n:
            return False
    around = [[node[p] for p in ring] for ring in rings]
    for i, ring in enumerate(around):
        assert len(set(ring)) == len(ring), rings
        assert (surface.area(ring) > 0) == (i == 0), rings
    outer = [surface.exact[n] for n in around[0]]
    assert all(is_within(outer, surface.exact[n]) for ring in around[1:] for n in ring), rings
    return True


def sides_of(rings):
    return frozenset(Counter(side for ring in rings for side in zip(ring, ring[1:] + ring[:1])).items())


def check(connection, model, field, words, levels, triangles):
    values = getattr(model, field)
    surface = Surface(model.points, values, [t for t in triangles if not any(math.isnan(values[i]) for i in t)])
    got = read(connection.ask(f"CONTOUR {model.name} {field} {words}"))
    total = Fraction(0)
    for low, high in zip(levels, levels[1:]):
        mine = [(rings, sides_of(rings)) for a, b, rings in got if (a, b) == (low, high)]
        of_sides = dict((sides, rings) for rings, sides in mine)
        for area, sides in surface.polygons(low, high):
            total += area
            rounded = [(surface.rounded[a], surface.rounded[b]) for a, b in sides]
            key = frozenset(Counter(s for s in rounded if s[0] != s[1]).items())
            if key not in of_sides:  # rounding leaves no ring of three places, or leaves out a hole
                distinct = len(set(itertools.chain.from_iterable(rounded)))
                assert distinct < len(set(itertools.chain.from_iterable(sides))), (model.name, field, words, low, rounded)
                counted["polygons that rounding changes"] += 1
                continue
            rings = of_sides.pop(key)
            counted["holes"] += len(rings) - 1
            counted["polygons"] += 1
            counted["polygons with exact places"] += check_rings(surface, rings, sides)
            bound = sum(4 * Fraction(math.ulp(max(map(abs, a + b)))) * (abs(Fraction(a[0]) - Fraction(b[0])) +
                        abs(Fraction(a[1]) - Fraction(b[1]))) for a, b in rounded)
            places = [[tuple(map(Fraction, p)) for p in ring] for ring in rings]
            mine = sum(a[0] * b[1] - a[1] * b[0] for r in places for a, b in zip(r, r[1:] + r[:1])) / 2
            assert abs(mine - area) <= 2 * bound + Fraction(1, 2**1000), (model.name, float(mine), float(area))
        counted["polygons beside"] += len(of_sides)
        assert counted["polygons beside"] <= counted["polygons that rounding changes"], (model.name, words, of_sides)
    if levels[0] == -math.inf and levels[-1] == math.inf:
        assert total == sum(surface.area([surface.vertex(i) for i in t]) for t in surface.triangles)
    counted["requests"] += 1


# ---- all of it ----

INF = math.inf
LEVELS = {"z": [[-INF, -50.0, 0.0, 12.5, 60.0, INF], [-30.0, 30.0]],
          "s": [[0.0, 1.0, 2.0, 3.0], [-INF, 0.5, 1.0, 1.5, 2.0, 2.75, INF], [1.0, 2.0], [-INF, 1.0], [2.0, INF]]}


def rows_of(connection, name, words=""):
    return [tuple(map(int, row.split())) for row in connection.ask(f"TRIANGLES {name}{words}")]


def is_short(model, ids, longest):
    corner = [tuple(map(Fraction, model.points[i])) for i in ids]
    return all((a[0] - b[0]) ** 2 + (a[1] - b[1]) ** 2 <= Fraction(longest) ** 2 for a, b in zip(corner, corner[1:] + corner[:1]))


def compare(connection, model):
    rng, triangles = model.rng, rows_of(connection, model.name)
    some = [v for v in model.z.values() if v == v]
    for field, lists in LEVELS.items():
        for levels in lists + ([sorted(set(rng.sample(some, min(3, len(some))))) + [INF]] if field == "z" else []):
            check(connection, model, field, " ".join(map(repr, levels)) + " BANDS", levels, triangles)
    check(connection, model, "s", "EVERY 1 BASE 0.5 BANDS", [x + 0.5 for x in range(-1, 4)
          if not triangles or x + 1.5 > min(model.s.values()) and x - 0.5 <= max(model.s.values())], triangles)
    if not triangles:
        return
    a, b, _ = rng.choice(triangles)
    longest = 1.25 * math.dist(model.points[a], model.points[b])
    if 2.0**-140 < longest < 2.0**200:
        check(connection, model, "s", f"0 1 2 inf BANDS MAXEDGE {longest!r}", [0.0, 1.0, 2.0, INF],
              [t for t in triangles if is_short(model, t, longest)])


def compare_inside(connection, model):
    """With a border of three points, inside of which the triangles are those that TRIANGLES lists."""
    three = model.rng.sample(sorted(model.points), 3)
    connection.ask(f"CONSTRAIN {model.name} BORDER RING {' '.join(map(str, three))}")
    check(connection, model, "s", "0 1 2 inf BANDS INSIDE", [0.0, 1.0, 2.0, INF], rows_of(connection, model.name, " INSIDE"))
    check(connection, model, "z", "-inf 0 inf BANDS", [-INF, 0.0, INF], rows_of(connection, model.name))


def main():
    build, names = arguments()
    for connection, model, edited in stages(build, names, Both):
        compare(connection, model)
        if edited:
            compare_inside(connection, model)
    print(dict(counted))
    least = {"polygons": 200, "holes": 5, "polygons with exact places": 100, "requests": 20}
    for what, n in least.items():
        assert counted[what] >= n * len(names), what


if __name__ == "__main__":
    main()
