"""The commands whose methods follow from the table of commands.

Generated from the table of commands by `make generate`, not to be edited.
"""

from __future__ import annotations

from typing import Any, Dict, Iterable, List, Optional, Sequence, Tuple

from . import _protocol as protocol
from ._protocol import Asking, Value, field_name, set_name
from ._values import each, flag, option, real, whole, word

# Requests that change nothing, so that they can be sent again.
READS = frozenset(
    b"SETS TTL STAT DIGEST GET POINTS COINCIDENT FIELDS FGET CONSTRAINTS REGIONS QUALITY CHECK "
    b"LISTS TRIANGLES EDGES HULL LOCATE NEAREST LOCATEB NEARESTB WITHIN WEIGHTS VORONOI AREAS "
    b"INTERPOLATE INTERPOLATEB GRADIENT GRADIENTB RASTER CONTOUR PROFILE VOLUME ALPHA TRACE".split()
)


class Table(Asking):
    """The commands that need no more than their words."""

    def create(self, name: str, tolerance: Optional[float] = None, temporary: bool = False) -> None:
        """A new, empty set with a coincidence tolerance, for good or as long as the connection."""
        return self._ask(protocol.nothing, "CREATE", set_name(name), *option("TOL", tolerance, real), *flag("TEMPORARY", temporary))

    def drop(self, name: str) -> None:
        """Deletes a set."""
        return self._ask(protocol.nothing, "DROP", set_name(name))

    def expire(self, name: str, seconds: float) -> None:
        """Drops the set after this number of seconds."""
        return self._ask(protocol.nothing, "EXPIRE", set_name(name), real(seconds))

    def ttl(self, name: str) -> Optional[float]:
        """In how many seconds a set is dropped. Returns `ttl`."""
        return self._ask(protocol.fact_if_any("ttl", float), "TTL", set_name(name))

    def persist(self, name: str) -> bool:
        """Takes EXPIRE back: the set stays. Returns `changed`."""
        return self._ask(protocol.fact("changed", protocol.truth), "PERSIST", set_name(name))

    def stat(self, name: str) -> Dict[str, Value]:
        """Counts and memory of a set."""
        return self._ask(protocol.values, "STAT", set_name(name))

    def digest(self, name: str) -> str:
        """A number of the whole set: equal sets have equal numbers. Returns `digest`."""
        return self._ask(protocol.fact("digest", str), "DIGEST", set_name(name))

    def delete(self, name: str, ids: Iterable[int], cascade: bool = False) -> int:
        """Deletes points; with CASCADE also the constraints that end there. Returns `deleted`."""
        return self._ask(protocol.fact("deleted", int), "DEL", set_name(name), *each(ids, whole), *flag("CASCADE", cascade))

    def drop_field(self, name: str, field: str) -> None:
        """Deletes a field."""
        return self._ask(protocol.nothing, "FDROP", set_name(name), field_name(field))

    def check(self, name: str) -> Dict[str, Value]:
        """Proves the triangulation exactly."""
        return self._ask(protocol.values, "CHECK", set_name(name))

    def trace(self, name: str) -> List[Tuple[Any, ...]]:
        """The steps of the shelling algorithm, for sets of up to 1000 points."""
        return self._ask(protocol.table("w"), "TRACE", set_name(name))

    def snapshot(self) -> int:
        """Begins to write all sets to the data directory, and begins a new log. Returns `lsn`."""
        return self._ask(protocol.fact("lsn", int), "SNAPSHOT")

    def backup(self, name: str) -> Dict[str, Value]:
        """Writes a copy of the data directory, while it is in use, below --backup-dir."""
        return self._ask(protocol.values, "BACKUP", word(name))

    def wait(self, followers: int, seconds: float) -> int:
        """Waits until so many followers have the changes of this connection on disk. Returns `followers`."""
        return self._ask(protocol.fact("followers", int), "WAIT", whole(followers), real(seconds))
