"""Dask's modules, whose names have no types."""

from __future__ import annotations

from importlib import import_module
from typing import Any

dask: Any = import_module("dask")
array: Any = import_module("dask.array")


def module(name: str, what: str) -> Any:
    """A module that may be missing; ImportError says what needs it."""
    try:
        return import_module(name)
    except ImportError as error:
        raise ImportError("%s needs %s, which is not installed" % (what, name)) from error
