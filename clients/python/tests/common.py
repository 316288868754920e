"""A daemon for tests, $DELAUNAYD."""

import contextlib
import os
import subprocess
import unittest

from delaunayd import Client, Refused, _protocol

SQUARE = [(0, 0), (4, 0), (4, 4), (0, 4), (2, 2)]


@contextlib.contextmanager
def without_numpy():
    """Replies as on a machine that has no NumPy."""
    kept, _protocol.numpy = _protocol.numpy, None
    try:
        yield
    finally:
        _protocol.numpy = kept


class WithDaemon(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.daemon = subprocess.Popen(
            [os.environ["DELAUNAYD"], "--port", "0"], stdout=subprocess.PIPE, text=True
        )
        cls.url = "delaunay://" + cls.daemon.stdout.readline().split()[-1]

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
