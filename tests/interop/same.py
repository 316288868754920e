#!/usr/bin/env python3
"""Compares the replies of two builds of the daemon byte for byte, on all families of tests/oracle/families.c.

    same.py BUILD_DIR OLDER_DAEMON POINTS [FAMILY...]

The older daemon loads the points at once and triangulates on two threads. The daemon of BUILD_DIR has four histories: the same on one
thread and on two; a part first and the others by edits; the paper's engine, up to 20,000 points. Then all get the same requests: the
steps of the paper's engine on some of the points, values, whole tables, searches, surfaces, edits, and all but the first two again. A
command that the older daemon does not know is not compared.
"""

import hashlib
import math
import random
import re
import socket
import struct
import subprocess
import sys

MOST_FOR_SHELLING = 20000
SEARCHES = 150
TRACED = 300
EDITS = 400
VARIES = re.compile(r" (ms|version)=\S+")


class Daemon:
    """Has one set, t."""

    def __init__(self, program, threads):
        self.process = subprocess.Popen([program, "--port", "0", "--threads", str(threads)], stdout=subprocess.PIPE,
                                        stderr=subprocess.DEVNULL, text=True)
        port = int(re.match(r"ready on .*:(\d+)$", self.process.stdout.readline()).group(1))
        self.file = socket.create_connection(("127.0.0.1", port), timeout=600).makefile("rwb")

    def stop(self):
        self.process.kill()
        self.process.wait()

    def ask(self, line, body=b""):
        """What must be the same: the status line without times and versions, and a hash of the rest; of an error only its code."""
        self.file.write(line.encode() + b"\n" + body)
        self.file.flush()
        status = "#"
        while status.startswith("#"):
            status = self.file.readline().decode()
        if not status.startswith("OK"):
            return status.split()[:2]
        rest = hashlib.md5(usedforsecurity=False)
        size = re.search(r" bytes=(\d+)", status)
        if size:
            rest.update(self.file.read(int(size.group(1))))
        for _ in range(0 if size else int(status.split()[1])):
            rest.update(self.file.readline())
        return VARIES.sub("", status), rest.hexdigest()

    def load(self, points, name="t"):
        return self.ask(f"LOADB {name} {len(points)}", b"".join(struct.pack("<2d", *p) for p in points))


def at_once(daemon, points, triangulate="TRIANGULATE t"):
    daemon.load(points)
    daemon.ask(triangulate)


def by_the_paper(daemon, points):
    at_once(daemon, points, "TRIANGULATE t METHOD shelling")


def in_pieces(daemon, points):
    at_once(daemon, points[: len(points) // 2])
    rng, done = random.Random(9), len(points) // 2
    while done < len(points):
        n = rng.choice([1, 3, 100, 5000, 40000])
        daemon.load(points[done : done + n])
        done += n


def number(x):
    return repr(x) if math.isfinite(x) else "0"


def values(points):
    """Some tens of values, so that contours have plateaus; one is missing."""
    for i in range(0, len(points), 500):
        yield "FSET t z " + " ".join(f"{k} {k * 7919 % 61}" for k in range(i, min(i + 500, len(points))))
    yield "FSET t z 1 nan"


def surfaces(points, rng):
    yield from ("AREAS t BINARY", "CONTOUR t z EVERY 7", "CONTOUR t z 30.5 60", "VOLUME t z LEVEL 30.5", "ALPHA t AUTO", "PROFILE t z -5 -5 200 130 40 7")
    yield "RASTER t z -5 -5 200 130 40 7 AS aspect"
    yield from ("DROP few", "SIMPLIFY t z ERROR 9 IDS id INTO few", "POINTS few FIELDS z,id", "CONSTRAINTS few")
    for method in ("linear", "natural", "laplace", "nearest"):
        (ax, ay), (bx, by) = rng.choice(points), rng.choice(points)
        box = " ".join(number(v) for v in (min(ax, bx), min(ay, by), max(ax, bx), max(ay, by)))
        yield f"RASTER t z {box} 40 30 METHOD {method} BINARY"
        yield f"INTERPOLATE t z {number(ax / 2 + bx / 2)} {number(ay / 2 + by / 2)} {number(ax)} {number(by)} METHOD {method}"


def searches(points):
    """Requests at points, between them, and at corners of boxes around two of them."""
    rng = random.Random(3)
    yield from surfaces(points, random.Random(4))
    for table in ("LISTS", "TRIANGLES", "EDGES", "POINTS", "VORONOI"):
        yield f"{table} t BINARY"
    yield from ("HULL t", "COINCIDENT t", "CHECK t", "QUALITY t")
    for i in range(SEARCHES):
        (ax, ay), (bx, by) = rng.choice(points), rng.choice(points)
        at = f"{number(ax)} {number(ay)}" if i % 3 == 0 else f"{number(ax / 2 + bx / 2)} {number(ay / 2 + by / 2)}"
        yield from (f"LOCATE t {at}", f"NEAREST t {at}", f"NEAREST t {at} {rng.choice([2, 5, 40])}", f"WEIGHTS t {at} METHOD natural")
        if i % 10 == 0:
            box = " ".join(number(v) for v in (min(ax, bx), min(ay, by), max(ax, bx), max(ay, by)))
            radius = number(abs(ax / 9 - bx / 9))
            yield from (f"WITHIN t {box}", f"WITHIN t {at} {radius}", f"LISTS t {rng.randrange(len(points))}", f"ALPHA t {radius}")


def edits(points):
    rng, n = random.Random(7), len(points)
    for i in range(EDITS):
        (ax, ay), (bx, by), point = rng.choice(points), rng.choice(points), rng.randrange(n)
        x, y = points[point]
        yield (f"DEL t {point}",
               f"MOVE t {point} {number(ax / 2 + bx / 2)} {number(by)}",
               f"ADD t {number(ax)} {number(by)}",
               f"MOVE t {point} {number(x * (1 + 2**-23))} {number(y)}")[i % 4]
    ids = rng.sample(range(n), min(n // 10, 20000))
    for i in range(0, len(ids), 997):
        yield "DEL t " + " ".join(map(str, ids[i : i + 997]))


def replies(program, threads, history, points):
    """Request by request."""
    daemon = Daemon(program, threads)
    try:
        daemon.load(points[:TRACED], "u")
        history(daemon, points)
        asked = [("TRACE u", daemon.ask("TRACE u"))]
        asked += [(request, daemon.ask(request)) for requests in (values, searches, edits) for request in requests(points)]
        rng = random.Random(8)
        batch = [(rng.choice(points)[0], rng.choice(points)[1]) for _ in range(min(len(points) // 10, 20000))]
        asked.append(("a batch", daemon.load(batch)))
        return asked + [(request, daemon.ask(request)) for request in searches(points)]
    finally:
        daemon.stop()


def compare(family, points, older, newer):
    """How many histories passed, and how many did not."""
    expected = replies(older, 2, at_once, points)
    passed = failed = 0
    for threads, history in ((1, at_once), (2, at_once), (2, in_pieces), (1, by_the_paper)):
        if history == by_the_paper and len(points) > MOST_FOR_SHELLING:
            continue
        asked = replies(newer, threads, history, points)
        wrong = [(r, e, a) for (r, e), (_, a) in zip(expected, asked) if e != a and e[:2] != ["ERR", "UNKNOWN"]]
        passed, failed = passed + (not wrong), failed + bool(wrong)
        if wrong:
            print("FAIL", family, history.__name__, f"{threads} threads, {len(wrong)} replies differ, first:", *wrong[0], flush=True)
    return passed, failed


def main():
    build, older, n, *names = sys.argv[1:]
    program = build + "/tests/bench/points"
    listed = subprocess.run([program], stdout=subprocess.PIPE, text=True, check=False).stdout.splitlines()
    total = [0, 0]
    for family in names or [line.split()[0] for line in listed]:
        data = subprocess.run([program, "--binary", family, n], stdout=subprocess.PIPE, check=True).stdout
        counts = compare(family, list(struct.iter_unpack("<2d", data)), older, build + "/delaunayd")
        total = [t + c for t, c in zip(total, counts)]
    print(f"{total[0]} passed, {total[1]} failed")
    sys.exit(total[1] > 0)


if __name__ == "__main__":
    main()
