"""Mirrors: objects that follow a set."""

import asyncio
import os
import random
import socket
import tempfile
import threading
import unittest

from delaunayd import Client, ConnectionLost, Mirror, Refused, _mirror, aio

from .common import SQUARE, WithDaemon, end_daemon, start_daemon, without_numpy

WAIT = 60


def plain(table):
    return table.tolist() if hasattr(table, "tolist") else table


def triples(triangles):
    """With or without NumPy."""
    flat = [int(id) for id in (triangles.reshape(-1) if hasattr(triangles, "reshape") else triangles)]
    return list(zip(flat[::3], flat[1::3], flat[2::3]))


def state(client, name):
    """Points, rings in their order, triangles."""
    rings = triangles = []
    if client.stat(name)["triangulated"]:
        rings = [(id, plain(ring)) for id, ring in client.lists(name).items()]
        triangles = plain(client.triangles(name))
    return [plain(table) for table in client.points(name)], rings, triangles


def mirrored(mirror):
    rings = [(id, plain(ring)) for id, ring in mirror.lists().items()]
    return [plain(table) for table in mirror.points()], rings, plain(mirror.triangles())


def apply(change, points, triangles):
    """A change, applied to a set of ids and a set of triangles."""
    assert not points & set(change.added) and points >= {*change.gone, *change.moved, *change.valued}
    assert not triangles & set(change.triangles_added) and triangles >= set(change.triangles_removed)
    points.difference_update(change.gone)
    points.update(change.added)
    triangles.difference_update(change.triangles_removed)
    triangles.update(change.triangles_added)


def edit(client, name, rnd, place):
    """A random edit; returns whether it was carried out."""
    ids = plain(client.points(name)[0])
    what = rnd.random()
    try:
        if what < 0.4 or not ids:
            client.add(name, *place(rnd))
        elif what < 0.6:
            client.delete(name, rnd.sample(ids, min(len(ids), rnd.choice((1, 1, 3, 9)))))
        elif what < 0.85:
            client.move(name, rnd.choice(ids), *place(rnd))
        elif what < 0.95:
            client.load(name, [place(rnd) for _ in range(rnd.choice((2, 40)))])
        else:
            client.triangulate(name)
    except Refused as refusal:
        assert refusal.code in ("NOPOINT", "UNTRIANGULATED"), refusal
        return False
    return True

class Changes(unittest.TestCase):
    def test_an_end_of_a_line_that_leaves_a_box_changes_no_triangles(self):
        m = _mirror.Mirror(None, "t", (), (0, 0, 2, 2))
        m._receive(b"OK 0\nEVENT 4 set=t version=1 reset\npoint 0 0 0\nlist 0 b 7\npoint 1 1 0\nlist 1 b 5 6\n")
        self.assertIsNone(m._step())
        m._receive(b"EVENT 1 set=t version=2\ngone 0\n")
        change = m._step()
        self.assertEqual((change.triangles_added, change.triangles_removed), ([], []))
        self.assertEqual(triples(m.triangles()), [(1, 5, 6)])

    def test_a_point_of_a_box_on_a_line_is_no_triangle_once_a_neighbour_is_in_the_box_too(self):
        m = _mirror.Mirror(None, "t", (), (0, 0, 2, 2))
        m._receive(b"OK 0\nEVENT 2 set=t version=1 reset\npoint 1 1 0\nlist 1 b 5 6\n")
        self.assertIsNone(m._step())
        self.assertEqual(triples(m.triangles()), [(1, 5, 6)])  # what a part does not show
        m._receive(b"EVENT 4 set=t version=2 reset\npoint 1 1 0\nlist 1 b 5 6\npoint 5 0 0\nlist 5 b 7 1\n")
        change = m._step()
        self.assertEqual((change.triangles_added, change.triangles_removed), ([], [(1, 5, 6)]))
        self.assertEqual(triples(m.triangles()), [])


class Following(WithDaemon):
    def mirror(self, name="t", **options):
        mirror = self.client.mirror(name, timeout=WAIT, **options)
        self.addCleanup(mirror.close)
        return mirror

    def version(self, name="t"):
        return int(self.client.stat(name)["version"])

    def catch_up(self, mirror, name="t"):
        self.assertTrue(mirror.wait(self.version(name), WAIT))

    def test_a_mirror_has_the_points_rings_and_triangles_of_a_set(self):
        self.load("t", SQUARE + [(2, 2), (1, 3)])
        with self.client.mirror("t", timeout=WAIT) as m:
            self.assertEqual(mirrored(m), state(self.client, "t"))
            self.assertEqual((len(m), m.version, m.dropped), (7, self.version(), False))
            self.assertEqual((m.point(6), 6 in m, 7 in m), ((1.0, 3.0), True, False))
            self.assertEqual(m.neighbors(4), self.client.neighbors("t", 4))
            self.assertEqual((m.is_boundary(0), m.is_boundary(4), m.hull()), (True, False, self.client.hull("t")))
            with self.assertRaises(KeyError):
                m.neighbors(5)  # an alias
            with without_numpy():
                self.assertEqual(plain(m.triangles()), plain(self.client.triangles("t")))

    def test_edits_are_changes(self):
        self.load("t", SQUARE)
        heard = []
        m = self.mirror(on_change=heard.append)
        self.client.add("t", 1, 2)
        change = m.poll(WAIT)
        self.assertEqual((change.version, change.added, change.moved, change.gone), (self.version(), [5], [], []))
        self.assertEqual(change.triangles_removed, [(0, 4, 3)])
        self.assertEqual(change.triangles_added, [(0, 4, 5), (0, 5, 3), (3, 5, 4)])
        self.client.move("t", 5, 1, 2.125)
        change = m.poll(WAIT)
        self.assertEqual((change.added, change.moved, change.gone), ([], [5], []))
        self.assertEqual((change.triangles_removed, change.triangles_added), ([], []))
        self.client.delete("t", [5])
        change = m.poll(WAIT)
        self.assertEqual((change.gone, change.triangles_added), ([5], [(0, 4, 3)]))
        self.assertEqual([c.version for c in heard], sorted({c.version for c in heard}))
        self.assertEqual(heard[-1], change)
        self.assertIsNone(m.poll(0))

    def test_constraints_are_changes(self):
        self.load("t", [(0, 0), (4, 0), (4.5, 4), (0, 4)])
        m = self.mirror()
        self.client.command("CONSTRAIN", "t", "BORDER", "OF", 7, 2, 0)
        change = m.poll(WAIT)
        self.assertEqual((change.constraints_added, change.constraints_released), ([(0, 2, True, 7)], []))
        self.assertEqual((change.triangles_added, change.triangles_removed), ([(0, 1, 2), (0, 2, 3)], [(0, 1, 3), (1, 2, 3)]))
        self.assertEqual((m.constraints(), m.ends(m.constraints()[0])), ([(0, 2, True, 7)], ((0, 0), (4.5, 4))))
        self.client.command("CONSTRAIN", "t", 1, 0, 0, 3)
        m.poll(WAIT)
        self.assertEqual(self.mirror().constraints(), [(0, 1, False, 0), (0, 2, True, 7), (0, 3, False, 0)])
        self.client.command("DEL", "t", 0, "CASCADE")
        change = m.poll(WAIT)
        self.assertEqual((change.gone, len(change.constraints_released), m.constraints()), ([0], 3, []))

    def test_a_mirror_of_a_box_has_the_constraints_that_meet_it(self):
        self.client.load("t", [(0, 0), (9, 9), (9, 0), (8, 0)])
        self.client.command("CONSTRAIN", "t", 0, 1, 2, 3)
        m = self.mirror(within=(2, 2, 4, 3))
        self.assertEqual((m.constraints(), m.ends(m.constraints()[0])), ([(0, 1, False, 0)], ((0, 0), (9, 9))))
        self.client.move("t", 1, 9, 8.5)
        self.assertEqual(m.poll(WAIT).constraints_added, [(0, 1, False, 0)])
        self.assertEqual(m.ends(m.constraints()[0]), ((0, 0), (9, 8.5)))
        self.client.move("t", 1, 9, 0.5)
        self.assertEqual(m.poll(WAIT).constraints_released, [(0, 1, False, 0)])

    def test_a_reset_tells_which_constraints_are_different(self):
        m = _mirror.Mirror(None, "t")
        m._receive(b"OK 0\nEVENT 2 set=t version=1 reset\nconstraint 0 1 line 0\nconstraint 0 1 line 3\n")
        self.assertIsNone(m._step())
        m._receive(b"EVENT 2 set=t version=2 reset\nconstraint 0 1 line 3\nconstraint 0 1 border 3\n")
        change = m._step()
        self.assertEqual((change.constraints_added, change.constraints_released), ([(0, 1, True, 3)], [(0, 1, False, 0)]))
        m._receive(b"EVENT 2 set=t version=3\nreleased 7 8 line 0\nconstraint 0 1 line 3\n")
        change = m._step()
        self.assertEqual((change.constraints_added, change.constraints_released), ([], []))

    def test_a_mirror_equals_the_set_after_every_edit(self):
        places = (
            lambda rnd: (rnd.random(), rnd.random()),
            lambda rnd: (rnd.randrange(5), rnd.randrange(5)),
            lambda rnd: (rnd.randrange(9), 0 if rnd.random() < 0.95 else 1),  # mostly on one line
        )
        for seed in range(12):
            rnd, name = random.Random(seed), "s%d" % seed
            self.client.create(name)
            m = self.mirror(name)
            points, triangles = set(), set()
            for _ in range(60):
                if not edit(self.client, name, rnd, places[seed % 3]) or rnd.random() < 0.3:
                    continue
                version = self.version(name)
                while m.version < version:
                    apply(m.poll(WAIT), points, triangles)
                with self.subTest(seed=seed, version=version):
                    self.assertEqual(mirrored(m), state(self.client, name))
                    self.assertEqual(points, set(plain(m.points()[0])))
                    self.assertEqual(triangles, set(triples(m.triangles())))
            m.close()

    def test_a_set_that_is_loaded_and_triangulated_later(self):
        self.client.create("t")
        m = self.mirror()
        rnd = random.Random(1)
        self.client.load("t", [(rnd.random(), rnd.random()) for _ in range(5000)])
        self.catch_up(m)
        self.assertEqual((len(m), triples(m.triangles())), (5000, []))
        self.client.triangulate("t")
        self.catch_up(m)
        self.assertEqual(mirrored(m), state(self.client, "t"))

    def test_an_edit_costs_a_mirror_as_much_as_what_it_changes(self):
        rnd = random.Random(2)
        self.load("t", [(rnd.random(), rnd.random()) for _ in range(20000)])
        m = self.mirror()
        starred = []
        star, _mirror._star = _mirror._star, lambda id, *rest: starred.append(id) or star(id, *rest)
        self.addCleanup(setattr, _mirror, "_star", star)
        for k in range(50):
            self.client.move("t", k, rnd.random(), rnd.random())
            self.catch_up(m)
        self.assertLess(len(starred), 50 * 100)

    def test_the_iteration_ends_when_the_set_is_dropped(self):
        self.client.load("t", SQUARE)
        m = self.mirror()
        self.client.add("t", 1, 2)
        self.client.drop("t")
        for change in m:
            pass
        self.assertTrue(m.dropped)
        self.assertIsNone(m.poll(WAIT))
        self.assertFalse(m.wait(m.version + 1, WAIT))

    def test_a_closed_mirror_keeps_its_state(self):
        self.client.load("t", SQUARE)
        m = self.mirror()
        m.close()
        m.close()
        self.assertEqual(list(m), [])
        self.assertEqual(len(m), 5)

    def test_what_cannot_be_followed_is_refused(self):
        with self.assertRaises(Refused) as caught:
            self.client.mirror("nothing")
        self.assertEqual(caught.exception.code, "NOSET")
        with self.assertRaises(Refused):
            self.client.mirror("a b")
        with self.assertRaises(Refused):
            self.client.mirror("t", fields=["1"])

    def test_a_mirror_that_is_not_read_hears_the_net_change(self):
        self.load("t", SQUARE)
        m = self.mirror()
        with self.client.pipeline() as p:
            for k in range(3000):
                p.add("t", k % 61, k % 67)
            for k in range(3000):
                p.delete("t", [5 + k])
        points, triangles = set(range(5)), set(triples(m.triangles()))
        want = self.version()
        while m.version < want:
            apply(m.poll(WAIT), points, triangles)
        self.assertEqual(points, set(range(5)))
        self.assertEqual(mirrored(m), state(self.client, "t"))


    def test_tasks_follow_a_set(self):
        self.load("t", SQUARE)

        async def follow(m):
            return [change async for change in m]

        async def main():
            async with aio.Client(self.url) as c, c.mirror("t", timeout=WAIT) as m:
                await c.add("t", 1, 2)
                self.assertTrue(await asyncio.wait_for(m.wait(int((await c.stat("t"))["version"])), WAIT))
                self.assertEqual(mirrored(m), state(self.client, "t"))
                with self.assertRaises(asyncio.TimeoutError):
                    await asyncio.wait_for(m.poll(), 0.01)
                await c.delete("t", [5])
                await c.drop("t")
                changes = await asyncio.wait_for(follow(m), WAIT)
                self.assertEqual([change.gone for change in changes if change.gone], [[5]] if changes else [])
                self.assertTrue(m.dropped)
            with self.assertRaises(Refused):
                await aio.Mirror(self.url, "t").open()

        asyncio.run(main())


class Reconnecting(unittest.TestCase):
    """A daemon that is killed and started again, at one address."""

    def setUp(self):
        directory = tempfile.TemporaryDirectory()
        self.addCleanup(directory.cleanup)
        self.data, self.path = os.path.join(directory.name, "d"), os.path.join(directory.name, "s")
        self.start()
        self.addCleanup(self.kill)

    def start(self, *options):
        self.daemon, _ = start_daemon("--unix", self.path, *(options or ("--data", self.data)))

    def kill(self):
        end_daemon(self.daemon)

    def test_a_mirror_continues_after_the_daemon_was_killed(self):
        with Client(self.path) as c:
            c.load("t", SQUARE)
            c.triangulate("t")
            with c.mirror("t", timeout=WAIT) as m:
                self.kill()
                self.assertIsNone(m.poll(0.01))
                self.start()
                c.add("t", 1, 2)
                found = []
                while m.version < c.stat("t")["version"]:
                    found.append(m.poll(WAIT))
                self.assertEqual([id for change in found for id in change.added], [5])
                self.assertEqual(sum(len(change.triangles_added) for change in found), 3)
                self.assertEqual(sum(len(change.triangles_removed) for change in found), 1)
                self.assertEqual(mirrored(m), state(c, "t"))

    def test_a_mirror_continues_without_a_field_that_was_dropped_meanwhile(self):
        with Client(self.path) as c:
            c.load("t", SQUARE, fields={"z": [1.0] * 5})
            with c.mirror("t", fields=["z"], timeout=WAIT) as m:
                self.kill()
                self.assertIsNone(m.poll(0.01))
                self.start()
                c.drop_field("t", "z")
                self.assertTrue(m.wait(int(c.stat("t")["version"]), WAIT))
                self.assertNotEqual(m.values(0)[0], m.values(0)[0])

    def test_a_mirror_of_tasks_continues_after_the_daemon_was_killed(self):
        async def main():
            with Client(self.path) as c:
                c.load("t", SQUARE)
                c.triangulate("t")
                async with aio.Mirror(self.path, "t", timeout=WAIT) as m:
                    self.kill()
                    with self.assertRaises(asyncio.TimeoutError):
                        await asyncio.wait_for(m.poll(), 0.01)
                    self.start()
                    c.add("t", 1, 2)
                    self.assertTrue(await asyncio.wait_for(m.wait(int(c.stat("t")["version"])), WAIT))
                    self.assertEqual(mirrored(m), state(c, "t"))

        asyncio.run(main())

    def test_a_set_that_is_gone_after_a_restart_counts_as_dropped(self):
        with Client(self.path) as c:
            c.load("t", SQUARE)
            m = c.mirror("t", timeout=WAIT)
            self.kill()
            self.start("--threads", "1")
            self.assertEqual((list(m), m.dropped, len(m)), ([], True, 5))

    def test_threads_follow_a_set_through_restarts(self):
        with Client(self.path) as c:
            c.load("t", SQUARE)
            c.triangulate("t")
            seen = []

            def follow():
                with Mirror(self.path, "t", timeout=WAIT) as m:
                    ready.wait(WAIT)
                    for _ in m:
                        pass
                    seen.append(len(m))

            ready = threading.Barrier(4)
            threads = [threading.Thread(target=follow) for _ in range(3)]
            for thread in threads:
                thread.start()
            ready.wait(WAIT)
            for k in range(2):
                c.add("t", k, 1.5)
                self.kill()
                self.start()
            last = c.mirror("t", timeout=WAIT)
            self.assertEqual(mirrored(last), state(c, "t"))
            last.close()
            c.drop("t")
            for thread in threads:
                thread.join(WAIT)
            self.assertEqual(len(seen), 3)


class Speaking(unittest.TestCase):
    """A server that sends what the test says."""

    def setUp(self):
        self.server = socket.create_server(("127.0.0.1", 0))
        self.server.settimeout(WAIT)
        self.addCleanup(self.server.close)
        self.url = "delaunay://127.0.0.1:%d" % self.server.getsockname()[1]
        self.requests = []

    def serve(self, *conversations, pieces=1 << 20):
        def run():
            for text in conversations:
                connection, _ = self.server.accept()
                with connection, connection.makefile("rb") as lines:
                    self.requests.append(lines.readline().decode())
                    for at in range(0, len(text), pieces):
                        connection.sendall(text[at : at + pieces].encode())

        thread = threading.Thread(target=run)
        thread.start()
        self.addCleanup(thread.join)

    FIRST = "OK 0 version=7\nEVENT 2 set=t version=7 reset\npoint 0 1 2 nan\nlist 0 b\n"

    def test_it_continues_with_its_version_box_and_fields(self):
        self.serve(self.FIRST, "OK 0 version=8\nEVENT 2 set=t version=8\npoint 0 1 2 0.5\nlist 0 b\n", "ERR NOSET gone\n")
        with Mirror(self.url, "t", fields=["z"], within=(0, 0, 4, 4.5), timeout=WAIT) as m:
            self.assertNotEqual(m.values(0)[0], m.values(0)[0])
            changes = list(m)
        self.assertEqual([c.valued for c in changes], [[0]])
        self.assertEqual((m.point(0), m.values(0), list(m.points()[2])), ((1.0, 2.0), (0.5,), [0.5]))
        self.assertEqual(self.requests[0], "WATCH t WITHIN 0.0 0.0 4.0 4.5 FIELDS z CONSTRAINTS\n")
        self.assertEqual(self.requests[1], "WATCH t SINCE 7 WITHIN 0.0 0.0 4.0 4.5 FIELDS z CONSTRAINTS\n")
        self.assertEqual(self.requests[2], "WATCH t SINCE 8 WITHIN 0.0 0.0 4.0 4.5 FIELDS z CONSTRAINTS\n")

    def test_parts_of_an_event_are_one_change_however_they_arrive(self):
        first = "OK 0 version=1\nEVENT 1 set=t version=1 reset more\npoint 0 0 0\nEVENT 1 set=t version=2\npoint 1 1 1\n"
        later = "EVENT 1 set=t version=3 more\ngone 0\nEVENT 2 set=t version=4\npoint 2 2 2\ngone 9\n"
        self.serve(first + later + "EVENT 0 set=t version=4\nEVENT 0 set=t dropped\n", pieces=3)
        with Mirror(self.url, "t", timeout=WAIT) as m:
            self.assertEqual((m.version, plain(m.points()[0])), (2, [0, 1]))
            (change,) = list(m)
        self.assertEqual((change.version, change.added, change.gone), (4, [2], [0]))

    def test_a_part_whose_rest_was_lost_is_forgotten(self):
        begun = "EVENT 1 set=t version=8 reset more\npoint 5 5 5\nEVENT 9 set=t version=8\npoint 6 6 6\n"
        self.serve(self.FIRST.replace(" nan", "") + begun, "ERR LOADING\n", "OK 0 version=7\n", "ERR NOSET gone\n")
        with Mirror(self.url, "t", timeout=WAIT) as m:
            self.assertEqual(list(m), [])
            self.assertEqual((m.version, plain(m.points()[0])), (7, [0]))

    def test_a_reset_is_reported_as_the_difference(self):
        rings = "list 0 b 1 2\nlist 1 b 2 0\nlist 2 b 0 1\n"
        points = "point 0 0 0\npoint 1 4 0\npoint 2 0 4\n"
        line = "point 0 0 0\nlist 0 b 1\npoint 1 4 0\nlist 1 b 2 0\npoint 2 8 0\nlist 2 b 1\n"
        heads = ["EVENT 6 set=t version=%d reset\n" % k for k in (1, 2, 3)]
        self.serve("OK 0 version=1\n%s%s%s%s%s%s%sEVENT 0 set=t dropped\n" % (
            heads[0], points, rings, heads[1], line, heads[2], points + rings))
        with Mirror(self.url, "t", timeout=WAIT) as m:
            flat, back = list(m)
        self.assertEqual((flat.added, flat.moved, flat.triangles_added, flat.triangles_removed), ([], [2], [], [(0, 1, 2)]))
        self.assertEqual((back.moved, back.triangles_added, back.triangles_removed), ([2], [(0, 1, 2)], []))

    def test_of_a_box_a_triangle_goes_with_the_last_of_its_corners(self):
        first = "EVENT 4 set=t version=1 reset\npoint 5 0 0\nlist 5 b 6 9\npoint 6 1 0\nlist 6 b 9 5\n"
        self.serve("OK 0 version=1\n" + first + "EVENT 1 set=t version=2\ngone 6\nEVENT 1 set=t version=3\ngone 5\nEVENT 0 set=t dropped\n")
        with Mirror(self.url, "t", within=(0, 0, 1, 1), timeout=WAIT) as m:
            self.assertEqual(triples(m.triangles()), [(5, 6, 9)])
            one, both = list(m)
        self.assertEqual((one.triangles_removed, both.triangles_removed), ([], [(5, 6, 9)]))

    def test_a_set_that_does_not_arrive_in_time(self):
        stop = threading.Event()
        self.addCleanup(stop.set)

        def run():
            connection, _ = self.server.accept()
            with connection:
                stop.wait(WAIT)

        threading.Thread(target=run).start()
        with self.assertRaises(TimeoutError):
            Mirror(self.url, "t", timeout=0.05)

    def test_bytes_that_are_not_events(self):
        for nonsense in ("hello\n", "EVENT 1 set=t version=1\nring 1 2\n"):
            self.serve(nonsense)
            with self.assertRaises(ConnectionLost):
                Mirror(self.url, "t", timeout=WAIT)


if __name__ == "__main__":
    unittest.main()
