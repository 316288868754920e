"""The arguments of a command, from its usage."""

import re
from typing import NamedTuple

# The names of values in usages.
KINDS = {
    "set": "set",
    "field": "field",
    "integer": "id a b c first k n columns rows followers port",
    "text": "name address history digest token command section pattern",
    "double": "x y x0 y0 x1 y1 r radius seconds t e step",
}


class Value(NamedTuple):
    """A value, which is needed, or may be left out, or as many as there are."""

    name: str
    optional: bool = False
    many: bool = False

    def kind(self):
        """What it is written from: a number, the name of a set or a field, or another text."""
        for kind, names in KINDS.items():
            if self.name in names.split():
                return kind
        raise SystemExit("clients/generate/usage.py: KINDS does not say of which kind a value `%s` is" % self.name)


class Option(NamedTuple):
    """A keyword that may be left out: a flag without values, or with values, or with one of several choices."""

    keyword: str
    values: tuple
    choices: tuple

    def kind(self):
        return "text" if self.choices else Value(self.values[0]).kind()


def read(command):
    """Its values and its options; None if they need more than a list of values: a body, several forms, brackets in brackets."""
    if command.body or len(command.forms()) > 1 or re.search(r"\[[^\]]*\[", command.usage):
        return None
    values, options = [], []
    for part in re.findall(r"\[[^\]]*\]|[^\s\[]+", command.usage)[1:]:
        words = part.strip("[]").split()
        if words[-1] == "..." and len(words) == 2 and words[0].islower():
            if values and values[-1].name == words[0]:
                values.pop()
            values.append(Value(words[0], many=True))
        elif words[-1] == "..." or any("," in word for word in words) or (part[0] != "[" and not part.islower()):
            return None
        elif words[0].islower() and len(words) == 1:
            values.append(Value(words[0], optional=part[0] == "["))
        elif words[0].isupper():
            options.append(option(words[0], words[1:]))
        else:
            return None
    return values, [o for o in options if o.keyword != "BINARY"]  # rows are text


def option(keyword, values):
    choices = values[0].split("|") if len(values) == 1 and "|" in values[0] else ()
    return Option(keyword, () if choices else tuple(values), tuple(choices))
