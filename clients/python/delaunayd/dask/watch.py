"""Watches a cluster, which may have lost all workers: Dask would wait for others without a word, and without an end."""

from __future__ import annotations

import contextlib
import logging
import threading
import time
from typing import Any, List, Sequence

_log = logging.getLogger("delaunayd.dask")
_PATIENCE = 10.0  # seconds without workers that need no warning


class Watch:
    """While `with` lasts, a thread asks for workers. If there have been none for a while, it warns; after `timeout` seconds it cancels the futures, and `with`
    ends with TimeoutError."""

    def __init__(self, client: Any, timeout: float, futures: Sequence[Any] = ()):
        self._client, self._timeout, self._futures = client, timeout, list(futures)
        self._over, self._expired = threading.Event(), False

    def __enter__(self) -> "Watch":
        threading.Thread(target=self._look, daemon=True).start()
        return self

    def __exit__(self, *error: Any) -> None:
        self._over.set()
        if self._expired:
            raise TimeoutError("the cluster has had no workers for %g seconds" % self._timeout) from None

    def wait(self) -> List[Any]:
        """What is known of each worker, when there are some; of none when time is over."""
        found = self._workers()
        while not found and not self._expired:
            time.sleep(0.05)
            found = self._workers()
        return found

    def _workers(self) -> List[Any]:
        return list(self._client.scheduler_info()["workers"].values())

    def _look(self) -> None:
        since, patience = time.monotonic(), min(_PATIENCE, self._timeout / 2)
        warned = False
        with contextlib.suppress(Exception):  # the client may have been closed
            while not self._over.wait(min(1.0, patience / 2)):
                now = time.monotonic()
                if self._workers():
                    since, warned = now, False
                elif now - since >= patience and not warned:
                    _log.warning("the cluster has no workers; waiting for some, at most %g seconds", self._timeout)
                    warned = True
                elif now - since >= self._timeout:
                    self._expired = True
                    self._client.cancel(self._futures)
                    return
