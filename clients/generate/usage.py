"""The arguments of a command, from its usage."""

import re
from typing import NamedTuple

INTEGERS = "id a b c first k n columns rows followers port".split()
TEXTS = "name address history digest token command section pattern".split()
DOUBLES = "x y x0 y0 x1 y1 r radius seconds t e step".split()


class Value(NamedTuple):
    """A value, which is needed, or may be left out, or as many as there are."""

    name: str
    optional: bool = False
    many: bool = False

    def kind(self):
        """What it is written from: a number, the name of a set or a field, another text, or any of these."""
        if self.name in ("set", "field"):
            return self.name
        of = {"integer": INTEGERS, "double": DOUBLES, "text": TEXTS}
        return next((kind for kind, names in of.items() if self.name in names), "word")


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
