"""The private daemon: without a URL, and with no server at the default address."""

import os
import subprocess
import sys
import textwrap
import time
import unittest
from pathlib import Path
from unittest import mock

from delaunayd import Client, _address, _private, aio

HERE = str(Path(__file__).parent.parent)


def script(text):
    """A Python program, started."""
    return subprocess.Popen(
        [sys.executable, "-c", textwrap.dedent(text)],
        env={**os.environ, "PYTHONPATH": HERE},
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )


class Private(unittest.TestCase):
    def test_clients_of_a_process_share_it(self):
        with Client("private:") as one, Client("private:") as two:
            one.load("t", [(0, 0), (1, 0), (0, 1)])
            self.assertEqual(two.sets(), ["t"])
            one.drop("t")

    def test_a_pipeline_may_be_larger_than_the_buffers_of_sockets(self):
        with Client("private:", timeout=20) as c:
            c.load("long", [(i / 7, -i / 3) for i in range(1000)])
            with c.pipeline() as p:
                for _ in range(300):
                    p.get("long", range(1000))
            self.assertEqual([len(rows) for rows in p.results], [1000] * 300)
            c.drop("long")

    def test_it_is_started_where_nobody_listens_at_the_default_address(self):
        nobody = _address.Address(host="127.0.0.1", port=1, default=True)
        with mock.patch.object(_address, "parse", lambda url: nobody), Client() as c:
            self.assertEqual(c.command("CONFIG", "GET", "private").rows, ["private yes"])
            self.assertIn("a private daemon, whose sets are in memory alone", repr(c))
            self.assertIn("no server listens at 127.0.0.1:1>", repr(c))

    def test_a_client_that_is_not_connected_yet_says_what_it_will_use(self):
        with mock.patch.dict(os.environ):
            os.environ.pop("DELAUNAY_URL", None)
            self.assertIn("a private daemon, whose sets are in memory alone", repr(aio.Client("private:")))
            self.assertIn("localhost:6374, or else a private daemon>", repr(aio.Client()))
            self.assertIn("Client of somewhere:1>", repr(aio.Client("delaunay://somewhere:1")))

    def test_who_starts_it_learns_that_in_the_log(self):
        with script(
            """
            import logging, sys
            logging.basicConfig(level=logging.INFO, stream=sys.stdout, format="%(name)s %(levelname)s %(message)s")
            from delaunayd import Client
            print(Client("private:"), Client("private:"))
            """
        ) as owner:
            said, wrong = owner.communicate()
            self.assertEqual(wrong, "")
            self.assertRegex(said, r"^delaunayd INFO started the private daemon .*, process \d+: sets are in memory alone")
            self.assertEqual(said.count("INFO"), 1)
            self.assertNotIn("no server", said)

    def test_a_url_is_never_replaced_by_it(self):
        with self.assertRaises(ConnectionRefusedError):
            Client("delaunay://127.0.0.1:1")

    def test_one_that_was_killed_is_replaced(self):
        with Client("private:") as c:
            c.ping()
            _private._process.kill()
            _private._process.wait()
            c.ping()

    def expect_ended(self, path):
        for _ in range(2000):
            if not os.path.exists(os.path.dirname(path)):
                return
            time.sleep(0.02)
        raise AssertionError("the daemon has not ended")

    def test_it_ends_with_its_owner_however_that_ends(self):
        text = """
            import sys, time, os
            from delaunayd import Client, _private
            c = Client("private:")
            c.add("t", 1, 2)
            print(_private._path, flush=True)
            %s
            """
        for last in ("", "sys.exit(0)", "os._exit(0)", "os.kill(os.getpid(), 9)", "os.kill(os.getpid(), 15)"):
            with script(text % last) as owner:
                path = owner.stdout.readline().strip()
                self.assertTrue(path.startswith("/"), owner.stderr.read() if not path else path)
                owner.wait()
                self.expect_ended(path)
                self.assertEqual(owner.stderr.read(), "")

    def test_it_outlives_the_thread_that_started_it(self):
        with script(
            """
            import threading, time
            from delaunayd import Client
            made = []
            t = threading.Thread(target=lambda: made.append(Client("private:")))
            t.start(); t.join(); time.sleep(0.1)
            made[0].ping()
            print("good")
            """
        ) as owner:
            self.assertEqual(owner.communicate(), ("good\n", ""))

    def test_an_interrupt_of_the_terminal_does_not_end_it(self):
        with script(
            """
            import os, signal
            from delaunayd import Client
            os.setpgid(0, 0)
            signal.signal(signal.SIGINT, signal.default_int_handler)  # a shell's background job ignores it
            c = Client("private:")
            try:
                os.killpg(0, signal.SIGINT)
                signal.pause()
            except KeyboardInterrupt:
                c.ping()
                print("good")
            """
        ) as owner:
            self.assertEqual(owner.communicate(), ("good\n", ""))

    def test_who_has_no_daemon_learns_what_to_do(self):
        with mock.patch.dict(os.environ, {"PATH": "/nowhere"}):
            del os.environ["DELAUNAYD"]
            with self.assertRaisesRegex(ConnectionError, "DELAUNAYD"):
                _private.find_program()


URLS = Path(__file__).resolve().parents[3] / "tests" / "data" / "urls.txt"


class Addresses(unittest.TestCase):
    def test_urls_are_read_as_in_all_clients(self):
        A = _address.Address
        rows = [row.split() for row in URLS.read_text().splitlines() if row[0] != "#"]
        self.assertGreater(len(rows), 30)
        for url, host, *others in rows:
            if not others and host == "malformed":
                with self.assertRaises(ValueError, msg=url):
                    _address.parse(url)
                continue
            port, token = (word.replace("-", "") for word in others)
            want = A(host, int(port), "", token) if port else A(path=host, token=token)
            self.assertEqual(_address.parse(url), A(private=True) if host == "private" else want, url)

    def test_a_port_that_no_address_has_is_named(self):
        with self.assertRaisesRegex(ValueError, "^delaunay://h:65536: a port is at most 65535$"):
            _address.parse("delaunay://h:65536")

    def test_a_token_that_is_no_text_is_refused(self):
        for url in ("delaunay://:%FF@h", "unix://:a%C3@/s"):
            with self.assertRaisesRegex(ValueError, "token of the URL is not text"):
                _address.parse(url)

    def test_a_path_is_an_address(self):
        self.assertEqual(_address.parse("/run/d.sock"), _address.Address(path="/run/d.sock"))

    def test_the_environment_has_the_url(self):
        with mock.patch.dict(os.environ, {"DELAUNAY_URL": "delaunay://there:9"}):
            self.assertEqual(_address.parse(None), _address.Address("there", 9))


if __name__ == "__main__":
    unittest.main()
