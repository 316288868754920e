"""The points of a set of a daemon, for delaunayd.spatial.Delaunay(points, client=client, set="name").

The set is the daemon's; what is computed from its points is computed in this process, with the same triangles in the same order,
because a triangulation depends on its points alone.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Optional, Tuple

import numpy as np

from .client import Client

if TYPE_CHECKING:
    from ._types import Floats


class SharedSet:
    """A set of a daemon whose points a Delaunay object has."""

    def __init__(self, client: Optional[Client], url: Optional[str], name: str):
        self.client = client if client is not None else Client(url)
        self.name = name

    def _exists(self) -> bool:
        return self.name in self.client.sets()

    def _read(self) -> Tuple[Any, Floats]:
        ids, points = self.client.points(self.name)
        if float(self.client.stat(self.name)["tol"]) != 0:
            raise ValueError("the set %s joins points within a tolerance; Delaunay does not" % self.name)
        if len(self.client.command("CONSTRAINTS", self.name, "BINARY").data) > 0:
            raise ValueError("the set %s has constraints; Delaunay would have other triangles" % self.name)
        return np.asarray(ids), np.array(points, dtype=np.float64).reshape(-1, 2)

    def open(self, points: Optional[Floats]) -> Tuple[Any, Floats]:
        """The ids and points of the set. With points: it is created and triangulated with these, unless it has the same ones."""
        if points is None or self._exists():
            ids, there = self._read()
            if points is not None and not np.array_equal(points, there):
                raise ValueError(
                    "the set %s exists and has other points; Delaunay(client=client, set=name) takes those" % self.name
                )
            return ids, there
        self.client.create(self.name)
        first = self.client.load(self.name, points)
        self.client.triangulate(self.name)
        return np.arange(first, first + len(points)), points

    def add(self, ids: Any, points: Floats) -> Any:
        """Adds points to the set; returns all ids. The set must not have changed in between."""
        there, _ = self._read()
        if not np.array_equal(there, ids):
            raise ValueError("another client has changed the set %s; nothing was added" % self.name)
        first = self.client.load(self.name, points)
        return np.concatenate([ids, np.arange(first, first + len(points))])
