"""Finds a daemon: by URL, else $DELAUNAY_URL, else localhost:6374, else, if no server listens there, a private daemon."""

from __future__ import annotations

import os
import re
import socket
from typing import NamedTuple, Optional
from urllib.parse import unquote

from . import _private

PORT = 6374
_PRIVATE = "a private daemon, whose sets are in memory alone and end with this process"
_TCP = re.compile(r"delaunay://(?:[^@/:]*:([^@/]*)@)?(?:\[([^\]/]+)\]|([^@/:\[\]]+))(?::([0-9]{1,5}))?/?\Z")
_UNIX = re.compile(r"unix://(?:[^@/:]*:([^@/]*)@)?(/.+)\Z")
_FORMS = "a URL is delaunay://[:token@]host[:port], unix://[:token@]/path or private:"


class Address(NamedTuple):
    host: str = "localhost"
    port: int = PORT
    path: str = ""  # of a Unix socket
    token: str = ""
    private: bool = False  # the private daemon
    default: bool = False  # or else the private daemon

    def __str__(self) -> str:
        return _PRIVATE if self.private else self.path or "%s:%d" % (self.host, self.port)


def _token(text: Optional[str]) -> str:
    try:
        return unquote(text or "", errors="strict")
    except UnicodeDecodeError:
        raise ValueError("the token of the URL is not text in UTF-8") from None


def parse(url: Optional[str]) -> Address:
    """Raises ValueError if it is not a valid URL."""
    url = url or os.environ.get("DELAUNAY_URL")
    if not url:
        return Address(default=True)
    if url == "private:":
        return Address(private=True)
    if url.startswith("/"):
        return Address(path=url)
    found = _TCP.match(url)
    if found is not None:
        token, v6, host, port = found.groups()
        if int(port or PORT) >= 2**16:
            raise ValueError("%s: a port is at most 65535" % url)
        return Address(v6 or host, int(port or PORT), "", _token(token))
    found = _UNIX.match(url)
    if found is None:
        raise ValueError(_FORMS)
    token, path = found.groups()
    return Address(path=path, token=_token(token))


def _connect_to(address: Address, timeout: Optional[float]) -> socket.socket:
    if not address.path:
        s = socket.create_connection((address.host, address.port), timeout)
        s.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        return s
    s = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
    try:
        s.settimeout(timeout)
        s.connect(address.path)
    except BaseException:
        s.close()
        raise
    return s


def _connect_to_private(timeout: Optional[float]) -> socket.socket:
    path = _private.socket_path()
    try:
        return _connect_to(Address(path=path), timeout)
    except (ConnectionRefusedError, FileNotFoundError):  # it was killed
        return _connect_to(Address(path=_private.socket_path(instead_of=path)), timeout)


def describe(address: Address, s: Optional[socket.socket]) -> str:
    """What a socket is connected with, for people; None: it is not connected yet."""
    if not address.default:
        return str(address)
    if s is None:
        return "%s, or else a private daemon" % (address,)
    return str(address) if s.family != socket.AF_UNIX else "%s, because no server listens at %s" % (_PRIVATE, address)


def connect(address: Address, timeout: Optional[float]) -> socket.socket:
    """A connected socket."""
    if address.private:
        return _connect_to_private(timeout)
    try:
        return _connect_to(address, timeout)
    except ConnectionRefusedError:
        if not address.default:
            raise
    return _connect_to_private(timeout)
