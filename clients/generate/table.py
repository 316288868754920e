"""The table of commands, as `delaunayd --commands` prints it.

A usage is forms between bars: words in lower case stand for values, those in capitals for themselves; `[...]` may be left out,
`[id ...]` means as many as there are, `linear|natural` is a choice.
"""

import json
import re
import subprocess
from typing import NamedTuple

# Events come between the replies to these; only mirrors can read them.
WITH_EVENTS = ("WATCH", "UNWATCH")


class Fact(NamedTuple):
    """A word key=value of a status line; the type is i, d, b or s."""

    key: str
    type: str
    optional: bool


def read_fact(word):
    key, of = word.rstrip("?").split(":")
    return Fact(key, of, word.endswith("?"))


class Command:
    def __init__(self, row):
        self.name = row["name"]
        self.usage = row["usage"]
        self.help = row["help"]
        self.body = row["body"]
        self.changes = row["changes"]
        self.role = row["role"]
        self.about = row["about"]
        self.facts = [read_fact(word) for word in row.get("result", "").split()]
        self.rows = row.get("rows")

    def forms(self):
        return self.usage.split(" | ")

    def keywords(self):
        """The words that stand for themselves, without the name."""
        words = re.findall(r"[A-Za-z0-9]+(?:\|[a-z]+)+|[A-Z]+", self.usage)
        return list(dict.fromkeys(k for w in words for k in w.split("|") if k != self.name))

    def only_reads(self):
        """Whether it reads sets and does nothing else, so that a request can be sent again."""
        return self.about != "server" and not self.changes and self.role == "ro" and self.name not in WITH_EVENTS


def read(daemon):
    printed = subprocess.run([daemon, "--commands"], check=True, stdout=subprocess.PIPE).stdout
    return [Command(row) for row in json.loads(printed)]
