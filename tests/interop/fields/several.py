"""Several fields of one request on all families of tests/oracle/families.c: each value equals, byte for byte, that of a request for the field
alone.

    several.py BUILD_DIR [FAMILY...]
"""

import math
import sys

sys.path[:0] = ["tests/interop", "tests/interop/fields"]
from missing import METHODS, Asking, box, lose, places_of, words  # noqa: E402
from surfaces import arguments, stages  # noqa: E402

checked = 0


def check(connection, name, command, numbers, rest):
    """The command for three fields, of `numbers` numbers each at a place, and for each of them alone."""
    global checked
    got = connection.reply(f"{command} {name} z,s,q {rest}")
    assert got[0].startswith("OK") and " fields=3" in got[0], got[0]
    alone = [connection.reply(f"{command} {name} {field} {rest}") for field in "zsq"]
    for i in range(1, len(got)):
        row, rows = got[i].split(), [reply[i].split() for reply in alone]
        places = len(row) // (3 * numbers)
        want = [rows[k][p * numbers + n] for p in range(places) for k in range(3) for n in range(numbers)]
        assert row == want, (name, command, rest, row, want)
    checked += 1


def compare(connection, model):
    (x0, y0, x1, y1), places = box(model), places_of(model, 15)
    cells = f"{words((x0, y0, x1, y1))} 9 7"
    for method in METHODS:
        for beyond in ("nan", "nearest"):
            check(connection, model.name, "INTERPOLATE", 1, f"{words(places)} METHOD {method} OUTSIDE {beyond}")
            check(connection, model.name, "RASTER", 1, f"{cells} METHOD {method} OUTSIDE {beyond}")
    check(connection, model.name, "RASTER", 1, f"{cells} AS slope")
    check(connection, model.name, "RASTER", 1, f"{cells} AS aspect MAXEDGE {(x1 - x0) / 8 + 1!r}")
    check(connection, model.name, "GRADIENT", 2, words(places))


def main():
    build, names = arguments()
    for connection, model, _ in stages(build, names, Asking):
        ids = sorted(model.points)
        connection.reply(f"FSET {model.name} q " + " ".join(f"{i} {model.rng.choice((math.nan, -1.0, 0.25, 1e300))!r}" for i in ids))
        compare(connection, model)
        lose(connection, model, ids)
        compare(connection, model)
    print(checked, "requests")
    assert checked > 50 * len(names)


if __name__ == "__main__":
    main()
