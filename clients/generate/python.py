"""The methods for Python, and the types of all methods of the client for asyncio: clients/python/delaunayd/_table.py, aio.pyi."""

import ast
import textwrap

import methods

HEAD = '''"""The commands whose methods follow from the table of commands.

%s
"""

from __future__ import annotations

from typing import Any, Dict, Iterable, List, Optional, Sequence, Tuple

from . import _protocol as protocol
from ._protocol import Asking, Value, field_name, set_name
from ._values import each, flag, option, real, whole, word

# Requests that change nothing, so that they can be sent again.
READS = frozenset(
    b"%s".split()
)


class Table(Asking):
    """The commands that need no more than their words."""
'''
TYPES = {"set": "str", "field": "str", "integer": "int", "double": "float", "text": "str"}
TAKES = {"set": "set_name", "field": "field_name", "integer": "whole", "double": "real", "text": "word"}
FACTS = {"i": "int", "d": "float", "b": "bool", "s": "str"}


def name_of(value, method):
    """The set is `name`; another name beside it is `other`."""
    if value.name == "name" and method.command.about == "set":
        return "other"
    return "name" if value.name == "set" else value.name + "s" * value.many


def parameters(method):
    for v in method.values:
        of = TYPES[v.kind()]
        if v.many:
            yield "%s: Iterable[%s]" % (name_of(v, method), of)
        else:
            yield "%s: %s" % (name_of(v, method), "Optional[%s] = None" % of if v.optional else of)
    for o in method.options:
        name = "_".join(methods.option_name(o))
        if not o.values and not o.choices:
            yield name + ": bool = False"
        else:
            yield "%s: Optional[%s] = None" % (name, TYPES[o.kind()] if len(o.values) < 2 else "Sequence[%s]" % TYPES[o.kind()])


def words(method):
    yield '"%s"' % method.command.name
    for v in method.values:
        name, take = name_of(v, method), TAKES[v.kind()]
        if v.many:
            yield "*each(%s, %s)" % (name, take)
        else:
            yield ("*option(None, %s, %s)" if v.optional else "%s") % ((name, take) if v.optional else "%s(%s)" % (take, name))
    for o in method.options:
        name, take = "_".join(methods.option_name(o)), TAKES[o.kind()] if o.values or o.choices else ""
        if not take:
            yield '*flag("%s", %s)' % (o.keyword, name)
        else:
            yield '*option("%s", %s, %s)' % (o.keyword, name, take if len(o.values) < 2 else "lambda all: each(all, %s)" % take)


def result(command):
    """The type, and what reads it from the reply."""
    if command.rows:
        return "List[Tuple[Any, ...]]", 'protocol.table("%s")' % command.rows
    if not command.facts:
        return "None", "protocol.nothing"
    if len(command.facts) > 1:
        return "Dict[str, Value]", "protocol.values"
    fact = command.facts[0]
    of = FACTS[fact.type]
    read = 'protocol.%s("%s", %s)' % ("fact_if_any" if fact.optional else "fact", fact.key, "protocol.truth" if of == "bool" else of)
    return "Optional[%s]" % of if fact.optional else of, read


def generate(commands, by_hand, says):
    reads = textwrap.wrap(" ".join(c.name for c in commands if c.only_reads()), 90)
    text = HEAD % (says, ' "\n    b"'.join(reads))
    for m in methods.read(commands):
        name = "_".join(m.words)
        if name not in by_hand:
            of, read = result(m.command)
            text += "\n    def %s(%s) -> %s:\n" % (name, ", ".join(["self", *parameters(m)]), of)
            text += '        """%s"""\n' % m.doc("Returns")
            text += "        return self._ask(%s)\n" % ", ".join([read, *words(m)])
    return text


AIO_HEAD = '''"""Types of delaunayd.aio: the methods of _commands.py, _constraints.py and _table.py as coroutines.

%s
"""

from typing import Any, Dict, Iterable, List, Mapping, Optional, Sequence, Tuple

from ._aio_mirror import Mirror as Mirror
from ._commands import Fields
from ._constraints import Constraints, Quality, Regions
from ._protocol import Band, Cells, Contour, Field, Located, Loop, Neighbour, Progress, Reply, Value
from ._values import Inside, Word
from ._types import Floats, Uint32s

__all__ = ["Client", "Mirror"]

class Client:
    def __init__(self, url: Optional[str] = None, timeout: Optional[float] = None): ...
    async def close(self) -> None: ...
    async def __aenter__(self) -> "Client": ...
    async def __aexit__(self, *_: object) -> None: ...
    def mirror(
        self, name: str, fields: Iterable[str] = (), within: Optional[Sequence[float]] = None, timeout: Optional[float] = None
    ) -> Mirror: ...
'''


def class_from(source, base):
    (of,) = (node for node in ast.parse(source).body if isinstance(node, ast.ClassDef) and [ast.unparse(b) for b in node.bases] == [base])
    return of


def generate_aio(commands, constraints, table, says):
    """From the text of these modules, each of which has one class that asks."""
    text = AIO_HEAD % says
    for source, base in ((commands, "ConstraintCommands"), (constraints, "Table"), (table, "Asking")):
        of = class_from(source, base)
        for f in of.body:
            if isinstance(f, ast.FunctionDef) and not f.name.startswith("_"):
                text += "    async def %s(%s) -> %s: ...\n" % (f.name, ast.unparse(f.args), ast.unparse(f.returns))
    return text
