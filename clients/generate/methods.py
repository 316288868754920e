"""Which commands become methods of the clients, with their names, arguments and results."""

from typing import NamedTuple

import usage
from table import WITH_EVENTS

NAMES = {"TOL": "tolerance", "CW": "clockwise", "MAXEDGE": "max edge"}


class Method(NamedTuple):
    command: object
    words: list  # of its name: ["drop", "field"]
    values: list
    options: list

    def doc(self, gives):
        help, facts = self.command.help, self.command.facts
        return help[0].upper() + help[1:] + "." + (" %s `%s`." % (gives, facts[0].key) if len(facts) == 1 else "")


def name_of(command, values):
    """A command about a field is F and a verb: verb, field. Python and JavaScript have a word del of their own."""
    if command.name[0] == "F" and len(values) > 1 and values[1].name == "field":
        return [command.name[1:].lower(), "field"]
    return ["delete" if command.name == "DEL" else command.name.lower()]


def option_name(option):
    return NAMES.get(option.keyword, option.keyword.lower()).split()


def read(commands):
    """Of the commands about sets, and those of any client; what needs a token for writing and is about the server, is for operators."""
    for c in commands:
        if c.role == "none" or (c.about == "server" and c.role == "rw") or c.name in WITH_EVENTS:
            continue
        arguments = usage.read(c)
        if arguments is not None:
            yield Method(c, name_of(c, arguments[0]), *arguments)
