"""A daemon for tests, $DELAUNAYD."""

import contextlib
import os
import subprocess
import unittest
from unittest import mock

from delaunayd import Client, Refused, _protocol, _values

SQUARE = [(0, 0), (4, 0), (4, 4), (0, 4), (2, 2)]


@contextlib.contextmanager
def without_numpy():
    """Replies as on a machine that has no NumPy."""
    with mock.patch.object(_protocol, "numpy", None), mock.patch.object(_values, "numpy", None):
        yield


def start_daemon(*options):
    """A daemon and its address; the options come after those of a free port."""
    daemon = subprocess.Popen([os.environ["DELAUNAYD"], "--port", "0", *options], stdout=subprocess.PIPE, text=True)
    return daemon, daemon.stdout.readline().split()[-1]


def end_daemon(daemon):
    daemon.kill()
    daemon.wait()
    daemon.stdout.close()


class WithDaemon(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.daemon, address = start_daemon()
        cls.url = "delaunay://" + address

    @classmethod
    def tearDownClass(cls):
        cls.daemon.terminate()
        if cls.daemon.wait(10) != 0:
            raise AssertionError("the daemon did not stop cleanly")
        cls.daemon.stdout.close()

    def setUp(self):
        self.client = Client(self.url, timeout=60)
        self.addCleanup(self.client.close)
        for name in self.client.sets():
            with contextlib.suppress(Refused):  # a temporary one that ends just now
                self.client.drop(name)

    def load(self, name, points, fields=None):
        """A set, triangulated."""
        self.client.load(name, points, fields)
        self.client.triangulate(name)
