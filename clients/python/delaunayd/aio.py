"""The client for asyncio:

    from delaunayd.aio import Client

    async with Client() as c:
        await c.load("t", [(0, 0), (4, 0), (0, 4)])
        await c.triangulate("t")
        print(await c.nearest("t", 1, 1))

It has the methods of delaunayd.Client; each returns an awaitable. `Mirror` follows a set.
"""

from __future__ import annotations

import asyncio
from typing import Any, Callable, Iterable, List, Optional, Sequence, Union

from . import _address, _protocol as protocol
from ._aio_mirror import Mirror
from ._commands import Commands
from ._protocol import LINE, ConnectionLost, Progress, Refused, Reply, Request
from ._values import seconds

__all__ = ["Client", "Mirror"]

_AT_ONCE = 1000
_LINE_LIMIT = 1 << 30


class Client(Commands):
    """A connection to a daemon for the tasks of one event loop, used by one task at a time. `url` and `timeout`, which limits each
    exchange with the server, are as for delaunayd.Client. The first request connects; a request after a lost connection or after a
    cancelled request reconnects."""

    def __init__(self, url: Optional[str] = None, timeout: Optional[float] = None):
        self._address = _address.parse(url)
        self._where = _address.describe(self._address, None)
        self._timeout = seconds(timeout)
        self._lock: Optional[asyncio.Lock] = None
        self._reader: Optional[asyncio.StreamReader] = None
        self._writer: Optional[asyncio.StreamWriter] = None
        self._closed = False

    async def close(self) -> None:
        """Ends the connection."""
        self._closed = True
        self._disconnect()

    async def __aenter__(self) -> "Client":
        return self

    async def __aexit__(self, *_: object) -> None:
        await self.close()

    def __repr__(self) -> str:
        return "<delaunayd.aio.Client of %s>" % self._where

    def mirror(
        self,
        name: str,
        fields: Iterable[str] = (),
        within: Optional[Sequence[float]] = None,
        timeout: Optional[float] = None,
    ) -> Mirror:
        """An object that follows a set of this server, over a connection of its own, for `async with`: see Mirror."""
        return Mirror(self._address, name, fields, within, timeout)

    def _disconnect(self) -> None:
        writer, self._reader, self._writer = self._writer, None, None
        if writer is not None:
            writer.close()

    async def _connect(self) -> None:
        loop = asyncio.get_running_loop()
        s = await loop.run_in_executor(None, _address.connect, self._address, self._timeout)
        self._where = _address.describe(self._address, s)
        s.setblocking(False)
        self._reader, self._writer = await asyncio.open_connection(sock=s, limit=_LINE_LIMIT)
        if self._address.token:
            (reply,) = await self._exchange([protocol.request("AUTH", self._address.token)], None)
            if isinstance(reply, Refused):
                raise reply

    async def _receive(self, progress: Optional[Progress]) -> Union[Reply, Refused]:
        assert self._reader is not None
        parser = protocol.read_reply(progress)
        want = next(parser)
        try:
            while True:
                if want == LINE:
                    data = await self._reader.readline()
                else:
                    data = await self._reader.readexactly(want)
                want = parser.send(data)
        except StopIteration as end:
            return end.value
        except Refused as refusal:
            return refusal

    async def _exchange(
        self, requests: Sequence[Request], progress: Optional[Progress]
    ) -> List[Union[Reply, Refused]]:
        assert self._writer is not None
        for line, body in requests:
            self._writer.write(line)
            if len(body) > 0:
                self._writer.write(body)
                await self._writer.drain()
        return [await self._receive(progress) for _ in requests]

    async def _settle(
        self, requests: Sequence[Request], progress: Optional[Progress] = None
    ) -> List[Union[Reply, Refused]]:
        if self._lock is None:
            self._lock = asyncio.Lock()
        replies: List[Union[Reply, Refused]] = []
        async with self._lock:
            if self._closed:
                raise ConnectionLost("the client is closed")
            try:
                if self._reader is not None and self._reader.at_eof():
                    self._disconnect()
                if self._writer is None:
                    await self._connect()
                for at in range(0, len(requests), _AT_ONCE):
                    exchange = self._exchange(requests[at : at + _AT_ONCE], progress)
                    replies += await asyncio.wait_for(exchange, self._timeout)
            except (ConnectionResetError, BrokenPipeError, asyncio.IncompleteReadError) as error:
                self._disconnect()
                raise ConnectionLost("the connection was lost") from error
            except BaseException:
                self._disconnect()
                raise
        return replies

    async def _run(
        self, requests: Sequence[Request], read: Callable[[Any], Any], progress: Optional[Progress] = None
    ) -> Any:
        replies = await self._settle(requests, progress)
        for reply in replies:
            if isinstance(reply, Refused):
                raise reply
        return read(replies)
