"""delaunayd.aio.Mirror, a set followed by the tasks of an event loop."""

from __future__ import annotations

import asyncio
import socket
from typing import AsyncIterator, Optional, Tuple

from . import _address, _mirror
from ._mirror import LATER, PIECE, Change
from ._protocol import ConnectionLost, Refused

_Streams = Tuple[asyncio.StreamReader, asyncio.StreamWriter]


class Mirror(_mirror.Mirror):
    """As delaunayd.Mirror, for one task:

        async with Mirror(url, "t") as m:
            async for change in m:
                print(m.version, change.triangles_added)

    The state is complete after open() or at the beginning of `async with`; `timeout` in seconds limits connecting and the wait for
    it. poll() and wait() may be cancelled, with asyncio.wait_for, and called again."""

    _streams: Optional[_Streams] = None

    async def open(self) -> None:
        """Connects and waits for the first state. Raises Refused, ConnectionError or TimeoutError."""

        async def first_state() -> None:
            self._streams = await self._connect()
            while not self._has_begun():
                await self._read(self._streams)

        try:
            await asyncio.wait_for(first_state(), self._timeout)
        except asyncio.TimeoutError:
            await self.close()
            raise TimeoutError("the set %s did not arrive in time" % self.name) from None
        except BaseException:
            await self.close()
            raise

    async def close(self) -> None:
        """Ends the connection; the state remains."""
        self._closed = True
        self._disconnect()

    async def __aenter__(self) -> "Mirror":
        await self.open()
        return self

    async def __aexit__(self, *_: object) -> None:
        await self.close()

    async def poll(self) -> Optional[Change]:
        """The next change, however long that takes; None if the set has been dropped, or the mirror is closed."""
        while True:
            try:
                change = self._step()
                if change is not None:
                    self._pause = 0.0
                    return change
                if self.dropped:
                    self._disconnect()
                if self.dropped or self._closed:
                    return None
                await self._read(self._streams or await self._reconnect())
            except Refused as refusal:
                self._disconnect()
                if refusal.code not in LATER:
                    raise
            except OSError:
                self._disconnect()

    async def wait(self, version: int) -> bool:
        """Waits until the mirror has that version or a later one. False: the set has been dropped, or the mirror is closed."""
        while self.version < version:
            if await self.poll() is None:
                return False
        return True

    async def __aiter__(self) -> AsyncIterator[Change]:
        """Every change, until the set is dropped or the mirror is closed."""
        while True:
            change = await self.poll()
            if change is None:
                return
            yield change

    # ---- the connection ----

    def _disconnect(self) -> None:
        streams, self._streams = self._streams, None
        if streams is not None:
            streams[1].close()
            self._begin_connection()

    async def _connect(self) -> _Streams:
        loop = asyncio.get_running_loop()
        s: socket.socket = await loop.run_in_executor(None, _address.connect, self._address, self._timeout)
        s.setblocking(False)
        s.setsockopt(socket.SOL_SOCKET, socket.SO_KEEPALIVE, 1)
        streams = await asyncio.open_connection(sock=s)
        self._begin_connection()
        streams[1].write(self._request())
        return streams

    async def _reconnect(self) -> _Streams:
        await asyncio.sleep(self._pause)
        self._lengthen_pause()
        self._streams = await self._connect()
        return self._streams

    async def _read(self, streams: _Streams) -> None:
        data = await streams[0].read(PIECE)
        if not data:
            raise ConnectionLost("the connection was lost")
        self._receive(data)
