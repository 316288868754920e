"""One client in several threads, and connections that are lost."""

import os
import socket
import threading
import time
import unittest

from delaunayd import Client, ConnectionLost, Refused

from .common import WithDaemon, end_daemon, start_daemon


def in_threads(n, work):
    """Runs work(0) to work(n - 1) in parallel; raises what one of them raises."""
    failed = []

    def run(i):
        try:
            work(i)
        except BaseException as error:
            failed.append(error)

    threads = [threading.Thread(target=run, args=(i,), daemon=True) for i in range(n)]
    for t in threads:
        t.start()
    for t in threads:
        t.join(60)
        if t.is_alive():
            raise AssertionError("a thread hangs")
    if failed:
        raise failed[0]


class Threads(WithDaemon):
    def test_each_thread_gets_its_own_answers(self):
        self.client.load("t", [(i, 0.5) for i in range(1000)])

        def work(i):
            for k in range(i, 1000, 8):
                self.assertEqual(self.client.nearest("t", k + 0.25, 0.5)[0].id, k)
                self.assertEqual(self.client.get("t", [k]), [(k, 0.5)])
                with self.assertRaises(Refused):
                    self.client.stat("missing%d" % i)

        in_threads(8, work)

    def test_each_thread_gets_its_own_replies_to_what_it_sends(self):
        self.client.load("t", [(i, 0.5) for i in range(100)])

        def work(i):
            for _ in range(50):
                for k in range(i, 100, 8):
                    self.client.send("GET", "t", k)
                for k in range(i, 100, 8):
                    self.assertEqual(self.client.receive().rows, ["%d %d 0.5" % (k, k)])

        in_threads(8, work)

    def test_a_request_among_replies_to_come_is_refused_and_harms_nobody(self):
        self.client.send("PING")
        with self.assertRaises(RuntimeError):
            self.client.ping()
        self.client.receive()
        with self.assertRaises(RuntimeError):
            self.client.receive()
        in_threads(2, lambda _: self.client.ping())

    def test_closing_frees_those_who_wait(self):
        self.client.send("PING")
        self.client.close()
        in_threads(1, lambda _: self.assertRaises(ConnectionLost, self.client.ping))

    def test_a_pipeline_returns_results_in_order(self):
        with self.client.pipeline() as p:
            p.load("t", [(0, 0), (4, 0), (0, 4)])
            p.triangulate("t")
            p.locate_all("t", [(1, 1), (9, 9)])
            p.nearest("t", 0, 1)
        self.assertEqual(p.results[0], 0)
        self.assertEqual([f.where for f in p.results[2]], ["inside", "outside"])
        self.assertEqual(p.results[3][0].id, 0)
        with self.assertRaises(Refused):
            with self.client.pipeline() as p:
                p.stat("missing")
                p.add("t", 1, 1)
        self.assertEqual(p.results[1], 3)

    def test_a_bad_name_leaves_the_connection(self):
        for name in ("no/name", "two words", "", "x" * 65):
            for call in (lambda: self.client.load(name, [(0, 0)]), lambda: self.client.stat(name)):
                with self.assertRaises(Refused) as raised:
                    call()
                self.assertEqual(raised.exception.code, "SYNTAX")
        self.client.ping()

    def test_numbers_come_as_numbers(self):
        self.client.create("t", tolerance=0.5)
        self.client.load("t", [(0, 0), (4, 0), (0, 4)])
        stat = self.client.stat("t")
        self.assertEqual((stat["points"], stat["tol"], stat["triangulated"]), (3, 0.5, False))
        self.assertIsInstance(self.client.triangulate("t")["ms"], float)
        self.assertIsInstance(self.client.info("memory")["max_memory"], int)

    def test_a_temporary_set_ends_with_its_client(self):
        other = Client(self.url)
        other.create("scratch", temporary=True)
        self.assertEqual(self.client.sets(), ["scratch"])
        other.close()
        for _ in range(2000):
            if self.client.sets() == []:
                break
            time.sleep(0.02)
        self.assertEqual(self.client.sets(), [])

    def test_a_child_has_a_connection_of_its_own(self):
        self.client.load("t", [(i, 0) for i in range(10)])
        pids = []
        for _ in range(3):
            pid = os.fork()
            if pid == 0:
                good = all(self.client.get("t", [i % 10]) == [(i % 10, 0)] for i in range(300))
                os._exit(0 if good else 1)
            pids.append(pid)
        for i in range(300):
            self.assertEqual(self.client.get("t", [i % 10]), [(i % 10, 0)])
        for pid in pids:
            self.assertEqual(os.waitpid(pid, 0)[1], 0)


class Reconnecting(unittest.TestCase):
    def start(self, port):
        daemon, address = start_daemon("--port", str(port))
        self.addCleanup(end_daemon, daemon)
        return daemon, int(address.split(":")[-1])

    def test_the_next_request_connects_again(self):
        daemon, port = self.start(0)
        client = Client("delaunay://127.0.0.1:%d" % port)
        self.addCleanup(client.close)
        client.add("t", 1, 2)
        daemon.kill()
        daemon.wait()
        with self.assertRaises(ConnectionError):
            client.sets()
        self.start(port)
        self.assertEqual(client.sets(), [])
        client.add("t", 1, 2)

    def serve(self, answers):
        """A server that answers the n-th request of each connection with answers[connection][n], and hangs where that is
        None."""
        server = socket.create_server(("127.0.0.1", 0))
        self.addCleanup(server.close)

        def run():
            for answer in answers:
                peer, _ = server.accept()
                self.addCleanup(peer.close)
                with peer.makefile("rb") as lines:
                    for one in answer:
                        lines.readline()
                        if one is None:
                            break
                        peer.sendall(one)
                    else:
                        peer.close()

        threading.Thread(target=run, daemon=True).start()
        return "delaunay://127.0.0.1:%d" % server.getsockname()[1]

    def test_a_request_that_changes_nothing_is_tried_once_more(self):
        with Client(self.serve([[b"OK 0\n", b""], [b"OK 0\n"]])) as c:
            c.ping()
            c.ping()

    def test_a_change_is_not_tried_twice(self):
        with Client(self.serve([[b"OK 0\n", b""], [b"OK 0 first=0\n"]])) as c:
            c.ping()
            with self.assertRaises(ConnectionLost):
                c.add("t", 1, 1)
            self.assertEqual(c.add("t", 1, 1), 0)

    def test_a_late_answer_is_nobodys(self):
        with Client(self.serve([[None], [b"OK 0 first=7\n"]]), timeout=0.2) as c:
            with self.assertRaises(OSError):
                c.add("t", 1, 1)
            self.assertEqual(c.add("t", 1, 1), 7)

    def test_an_interrupted_request_leaves_no_answer_behind(self):
        with Client(self.serve([[b"# progress 1 x\nOK 0\n"], [b"OK 0 first=7\n"]])) as c:

            def interrupt(_):
                raise KeyboardInterrupt

            with self.assertRaises(KeyboardInterrupt):
                c.command("TRIANGULATE", "t", progress=interrupt)
            self.assertEqual(c.add("t", 1, 1), 7)


if __name__ == "__main__":
    unittest.main()
