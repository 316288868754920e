"""How a method of a client asks: with requests to send, and a function that reads their replies."""

from __future__ import annotations

from typing import Any, Callable, Optional, Sequence, TypeVar

from . import _protocol as protocol
from ._protocol import Progress, Reply, Request, Word

_T = TypeVar("_T")


class Asking:
    """What every kind of client does in its own way."""

    def _run(
        self, requests: Sequence[Request], read: Callable[[Any], Any], progress: Optional[Progress] = None
    ) -> Any:
        """Sends the requests and returns read(list of replies). Raises the first Refused."""
        raise NotImplementedError

    def _ask(
        self, read: Callable[[Reply], _T], *words: Word, body: Any = b"", progress: Optional[Progress] = None
    ) -> _T:
        answer: _T = self._run([protocol.request(*words, body=body)], lambda replies: read(replies[0]), progress)
        return answer
