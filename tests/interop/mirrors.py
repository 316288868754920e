"""Mirrors of a set that is edited at random, while the daemon is killed and started again, connections are lost, and those who
watch stop reading for a while. At equal versions the mirrors must equal POINTS, LISTS, TRIANGLES and CONSTRAINTS byte for byte.

    mirrors.py BUILD_DIR [--edits N] [--seeds N] [--first-seed N]

With --edits, one history of N acknowledged edits of a set of thousands of points; then --seeds histories of small sets.
"""

import argparse
import os
import random
import socket
import struct
import subprocess
import sys
import tempfile
import time
from fractions import Fraction

sys.path.insert(0, "clients/python")
import delaunayd  # noqa: E402
from delaunayd import _protocol  # noqa: E402

_protocol.numpy = None  # tables of small sets
WAIT = 120
BOX = (0.25, 0.25, 0.75, 0.75)
REFUSALS = (b"NOPOINT", b"NOFIELD", b"UNTRIANGULATED", b"CROSSES", b"CONSTRAINED", b"NOCONSTRAINT")


class Daemon:
    """One daemon after the other, on one directory and at one address."""

    def __init__(self, program, directory, *options):
        self.program, self.directory, self.options = program, directory, options
        self.url = os.path.join(directory, "socket")
        self.kills = -1
        self.process = None
        self.restart()

    def restart(self):
        self.stop()
        self.kills += 1
        where = ("--port", "0", "--unix", self.url, "--data", os.path.join(self.directory, "data"))
        self.process = subprocess.Popen([self.program, *where, "--log-level", "error", *self.options], stdout=subprocess.PIPE)
        assert self.process.stdout.readline(), "the daemon did not start"

    def stop(self):
        if self.process is not None:
            self.process.kill()
            self.process.wait()
            self.process.stdout.close()


def connect(path):
    s = socket.socket(socket.AF_UNIX)
    s.settimeout(WAIT)
    s.connect(path)
    return s


class Editor:
    """Sends pipelined edits, and knows which ids there are."""

    def __init__(self, daemon, rnd, size, place):
        self.daemon, self.rnd, self.size, self.place = daemon, rnd, size, place
        self.edits = self.refused = 0
        self.constrains = rnd.choice((0, 0.05, 0.3))
        self.client = delaunayd.Client(daemon.url, timeout=WAIT)
        self.begin()

    def begin(self):
        """After a start of the daemon. The set was made before, or its making was not acknowledged."""
        self.socket = connect(self.daemon.url)
        self.replies = self.socket.makefile("rb")
        while True:
            try:
                self.client.create("t")
            except delaunayd.Refused as refusal:
                if refusal.code == "EXISTS":
                    break
                assert refusal.code == "LOADING", refusal
                time.sleep(0.01)
        if not self.ask(lambda: self.client.fields("t")):
            self.client.load("t", [(0.5, 0.5)], fields={"z": [1.0]})
        self.ids = self.ask(lambda: list(self.client.points("t")[0]))
        self.used = max(self.ids, default=-1) + 1

    def ask(self, question):
        """Asks again while the daemon is loading the set."""
        while True:
            try:
                return question()
            except delaunayd.Refused as refusal:
                assert refusal.code == "LOADING", refusal
                time.sleep(0.01)

    def close(self):
        self.replies.close()
        self.socket.close()
        self.client.close()

    def some_id(self):
        return self.rnd.choice(self.ids) if self.ids and self.rnd.random() < 0.98 else self.rnd.randrange(self.used + 3)

    def places(self, n):
        return " ".join("%r %r" % self.place(self.rnd) for _ in range(n))

    def constraint(self):
        rnd, kind = self.rnd, self.rnd.choice(("", " BORDER")) + " OF %d" % self.rnd.randrange(3)
        what = rnd.random()
        if what < 0.75:
            return "CONSTRAIN t%s%s %d %d" % (kind, rnd.choice(("", " SPLIT")), self.some_id(), self.some_id())
        if what < 0.9:
            return "CONSTRAIN t%s PATH %d %d %d" % (kind, self.some_id(), self.some_id(), self.some_id())
        return "RELEASE t ALL" if what < 0.92 else "RELEASE t%s" % kind

    def request(self):
        rnd, what = self.rnd, self.rnd.random()
        if rnd.random() < self.constrains:
            return self.constraint()
        shrink = len(self.ids) > self.size * rnd.uniform(0.5, 1.5)
        if what < 0.4:
            if shrink:
                return "DEL t " + " ".join({str(self.some_id()) for _ in range(rnd.choice((1, 1, 1, 2, 7)))}) + rnd.choice(("", " CASCADE"))
            return "ADD t " + self.places(rnd.choice((1, 1, 1, 1, 5)))
        if what < 0.75:
            return "MOVE t %d %s" % (self.some_id(), self.places(1))
        if what < 0.9:
            return "FSET t z %d %r" % (self.some_id(), rnd.choice((0.5, rnd.random(), float("nan"))))
        if what < 0.995:
            return "DEL t %d" % self.some_id() if shrink else "ADD t FIELDS z %s %r" % (self.places(1), rnd.random())
        if what < 0.998:
            n = rnd.randrange(1, 2 + self.size // 20)
            return "LOAD t %d\n%s" % (n, "\n".join(self.places(1) for _ in range(n)))
        return "TRIANGULATE t"

    def batch(self, n, heard=None):
        """Sends n requests, and reads the replies, all or the first ones."""
        requests = [self.request() for _ in range(n)]
        self.socket.sendall(("\n".join(requests) + "\n").encode())
        gone = set()
        for request in requests[:heard]:
            reply = b"#"
            while reply.startswith(b"#"):
                reply = self.replies.readline()
            words = reply.split()
            assert words and words[0] in (b"OK", b"ERR"), (request, reply)
            if words[0] == b"ERR":
                assert words[1] in REFUSALS or (words[1] == b"SYNTAX" and b"one end only" in reply), (request, reply)
                self.refused += 1
                continue
            self.edits += 1
            if b"first=" in reply:
                first, added = (int(next(w for w in words if w.startswith(k)).split(b"=")[1]) for k in (b"first=", b"added="))
                self.ids += range(first, first + added)
                self.used = first + added
            elif request.startswith("DEL"):
                gone.update(int(word) for word in request.split()[2:] if word != "CASCADE")
        if gone:
            self.ids = [id for id in self.ids if id not in gone]

    def kill(self):
        self.socket.close()
        self.daemon.restart()
        self.begin()


# ---- those who watch ----


class Stalled:
    """Watches the set, reads little, and goes without a goodbye."""

    def __init__(self, url, rnd):
        self.socket = connect(url)
        self.socket.sendall(b"WATCH t\n")
        self.socket.setblocking(False)
        self.rnd = rnd

    def read(self):
        try:
            self.socket.recv(self.rnd.choice((1, 100, 5000)))
        except OSError:
            pass

    def close(self):
        self.socket.close()


class Followed:
    """A mirror, and what its changes make of what it had at first."""

    def __init__(self, url, **options):
        while True:
            try:
                self.mirror = delaunayd.Mirror(url, "t", timeout=WAIT, on_change=self.apply, **options)
                break
            except delaunayd.Refused as refusal:
                assert refusal.code == "LOADING", refusal
                time.sleep(0.01)
        self.points = set(self.mirror.points()[0])
        self.triangles = self.listed()
        self.constraints = set(self.mirror.constraints())
        self.changes = 0

    def listed(self):
        flat = self.mirror.triangles()
        return set(zip(flat[::3], flat[1::3], flat[2::3]))

    def apply(self, change):
        assert self.points.isdisjoint(change.added) and self.points.issuperset(change.gone + change.moved + change.valued)
        assert self.triangles.isdisjoint(change.triangles_added) and self.triangles.issuperset(change.triangles_removed)
        self.points = (self.points - set(change.gone)) | set(change.added)
        self.triangles = (self.triangles - set(change.triangles_removed)) | set(change.triangles_added)
        assert self.constraints.issuperset(change.constraints_released)
        assert self.mirror.within or self.constraints.isdisjoint(change.constraints_added)
        self.constraints = (self.constraints - set(change.constraints_released)) | set(change.constraints_added)
        self.changes += 1


def binary(mirror):
    """POINTS, LISTS and TRIANGLES with BINARY, of a mirror."""
    ids, xy, *values = mirror.points()
    width = len(mirror.fields)
    rows = (
        struct.pack("<I%dd" % (2 + width), id, *xy[2 * k : 2 * k + 2], *(values[0][k * width : (k + 1) * width] if values else ()))
        for k, id in enumerate(ids)
    )
    rings = (struct.pack("<%dI" % (2 + len(ring)), id, len(ring), *ring) for id, ring in mirror.lists().items())
    return b"".join(rows), b"".join(rings), mirror.triangles().tobytes()


def meets(a, b, box):
    """Whether the closed segment meets the closed box; exact."""
    x0, y0, x1, y1 = map(Fraction, box)
    ax, ay, bx, by = map(Fraction, (*a, *b))
    if max(ax, bx) < x0 or min(ax, bx) > x1 or max(ay, by) < y0 or min(ay, by) > y1:
        return False
    sides = {((bx - ax) * (y - ay) > (by - ay) * (x - ax)) - ((bx - ax) * (y - ay) < (by - ay) * (x - ax)) for x in (x0, x1) for y in (y0, y1)}
    return sides not in ({1}, {-1})


def constraints(client):
    rows = [row.split() for row in client.command("CONSTRAINTS", "t").rows]
    return [(int(a), int(b), kind == "border", int(k)) for a, b, kind, k in rows]


def compare_part(editor, m):
    """A mirror of a box."""
    client = editor.client
    ids, xy, z = client.points("t", ["z"])
    inside = set(client.within("t", *m.within))
    want = {id: (xy[2 * k], xy[2 * k + 1], repr(z[k])) for k, id in enumerate(ids) if id in inside}
    got = {id: (*m.point(id), repr(m.values(id)[0])) for id in m.points()[0]}
    assert got == want, "points of %r" % m
    place = {id: (xy[2 * k], xy[2 * k + 1]) for k, id in enumerate(ids)}
    assert m.constraints() == [c for c in constraints(client) if meets(place[c[0]], place[c[1]], m.within)], "constraints of %r" % m
    assert all(m.ends(c) == (place[c.a], place[c.b]) for c in m.constraints()), "ends of constraints of %r" % m
    rings, triangles = {}, set()
    if client.stat("t")["triangulated"]:
        rings = editor.ask(lambda: client.lists("t", within=m.within))
        flat = client.triangles("t")
        triangles = {t for t in zip(flat[::3], flat[1::3], flat[2::3]) if not inside.isdisjoint(t)}
        if not flat:  # the rings of a part do not show that all points are on one line
            return
    assert m.lists() == rings, "rings of %r" % m
    flat = m.triangles()
    assert set(zip(flat[::3], flat[1::3], flat[2::3])) == triangles, "triangles of %r" % m


def compare(editor, followed):
    """All mirrors with the set; no edit is under way."""
    client = editor.client
    stat = editor.ask(lambda: client.stat("t"))
    want = {}
    for f in followed:
        m = f.mirror
        assert m.wait(int(stat["version"]), WAIT), "version %s did not arrive: %r" % (stat["version"], m)
        assert m.version == stat["version"], (m, stat["version"])
        assert f.points == set(m.points()[0]) and f.triangles == f.listed(), "the changes of %r do not add up" % m
        assert f.constraints == set(m.constraints()), "the changes of %r do not add up" % m
        if m.within:
            compare_part(editor, m)
            continue
        assert m.constraints() == constraints(client), "constraints of %r" % m
        words = ("FIELDS", "z") if m.fields else ()
        if words not in want:
            want[words] = client.command("POINTS", "t", *words, "BINARY").data
        points, rings, triangles = binary(m)
        assert points == want[words], "points of %r" % m
        if stat["triangulated"]:
            assert rings == editor.ask(lambda: client.command("LISTS", "t", "BINARY")).data, "rings of %r" % m
            assert triangles == editor.ask(lambda: client.command("TRIANGLES", "t", "BINARY")).data, "triangles of %r" % m
        else:
            assert rings == triangles == b"", "there is no triangulation, but %r has one" % m


# ---- histories ----

PLACES = {
    "uniform": lambda rnd: (rnd.random(), rnd.random()),
    "lattice": lambda rnd: (rnd.randrange(40) / 40, rnd.randrange(40) / 40),
    "small lattice": lambda rnd: (rnd.randrange(4) / 4, rnd.randrange(4) / 4),
    "line": lambda rnd: (rnd.randrange(30) / 32, 0.5 if rnd.random() < 0.97 else rnd.random()),
    "mixed": lambda rnd: (rnd.random(), rnd.choice((0.5, rnd.random()))),
}


def history(program, seed, edits, size, family, calm):
    """`calm`: how many batches go by between disturbances, on average."""
    rnd = random.Random(seed)
    with tempfile.TemporaryDirectory() as directory:
        daemon = Daemon(program, directory, "--fsync", rnd.choice(("always", "everysec")), "--compact-at", rnd.choice(("100k", "64m")))
        editor = Editor(daemon, rnd, size, PLACES[family])
        if rnd.random() < 0.8:
            editor.client.triangulate("t")
        followed = [Followed(daemon.url), Followed(daemon.url, fields=["z"]), Followed(daemon.url, fields=["z"], within=BOX)]
        lazy = followed[0]
        stalled, losses = [], 0
        try:
            while editor.edits < edits:
                n = rnd.choice((1, 3, 30, 300)) if size < 1000 else rnd.randrange(1, 900)
                if rnd.random() < 0.3 / calm:
                    editor.batch(n, rnd.randrange(n))
                    editor.kill()
                    stalled.clear()
                else:
                    editor.batch(n)
                for f in followed:
                    while f is not lazy and f.mirror.poll(0) is not None:
                        pass
                for s in stalled:
                    s.read()
                if rnd.random() < 1 / calm:
                    rnd.choice(followed).mirror._disconnect()  # perhaps within an event
                    losses += 1
                if rnd.random() < 1 / calm:
                    stalled.append(Stalled(daemon.url, rnd))
                if len(stalled) > 5:
                    stalled.pop(rnd.randrange(5)).close()
                if rnd.random() < 0.5 / calm:
                    lazy.mirror.poll(0)
                if rnd.random() < 0.5 / calm:
                    compare(editor, followed)
                    lazy = rnd.choice(followed)
            compare(editor, followed)
            editor.client.drop("t")
            for f in followed:
                while f.mirror.poll(WAIT) is not None:
                    pass
                assert f.mirror.dropped
        except BaseException:
            print("seed %d, %s, after %d edits and %d kills:" % (seed, family, editor.edits, daemon.kills), file=sys.stderr)
            raise
        finally:
            for one in (editor, *stalled, *(f.mirror for f in followed)):
                one.close()
            daemon.stop()
        return editor.edits, daemon.kills, losses, sum(f.changes for f in followed)


def main():
    parser = argparse.ArgumentParser(usage=__doc__)
    parser.add_argument("build")
    parser.add_argument("--edits", type=int, default=0)
    parser.add_argument("--seeds", type=int, default=10)
    parser.add_argument("--first-seed", type=int, default=1)
    o = parser.parse_args()
    program = os.path.join(o.build, "delaunayd")
    total = [0, 0, 0, 0]
    if o.edits:
        found = history(program, o.first_seed, o.edits, 4000, "mixed", 20)
        print("one history: %d edits, %d kills of the daemon, %d lost connections, %d changes" % found, flush=True)
    for seed in range(o.first_seed, o.first_seed + o.seeds):
        family = list(PLACES)[seed % len(PLACES)]
        size = (4, 12, 60, 300)[seed // len(PLACES) % 4]
        for k, n in enumerate(history(program, seed, 400, size, family, 4)):
            total[k] += n
    print("%d seeds: %d edits, %d kills of the daemon, %d lost connections, %d changes" % (o.seeds, *total))


if __name__ == "__main__":
    main()
