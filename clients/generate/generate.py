#!/usr/bin/env python3
"""Writes the parts of the clients that follow from the daemon's table of commands.

    generate.py DAEMON            writes the files, in the repository
    generate.py DAEMON --check    names the files that are not what it would write, one a line
"""

import re
import sys
from pathlib import Path

import command_line
import table

CLIENTS = Path(__file__).resolve().parent.parent
SAYS = "Generated from the table of commands by `make generate`, not to be edited."


def names(path, pattern):
    """What is written by hand in a file, and therefore not generated."""
    return set(re.findall(pattern, (CLIENTS / path).read_text(), re.M))


def files(commands):
    by_hand = names("cli/subcommand.c", r'^    \{"([a-z]+)", ')
    yield "cli/requests.h", command_line.generate(commands, by_hand, SAYS)


def main(daemon, check=None):
    for path, text in files(table.read(daemon)):
        file = CLIENTS / path
        if file.exists() and file.read_text() == text:
            continue
        if check is None:
            file.write_text(text)
        else:
            print("clients/%s: not what `make generate` writes" % path)


if __name__ == "__main__":
    main(*sys.argv[1:])
