#!/usr/bin/env python3
"""Writes the parts of the clients that follow from the daemon's table of commands.

    generate.py DAEMON            writes the files, in the repository
    generate.py DAEMON --check    names the files that are not what it would write, and what documents say otherwise, one a line
"""

import re
import sys
from pathlib import Path

import command_line
import documents
import node
import python
import table

REPOSITORY = Path(__file__).resolve().parent.parent.parent
SAYS = "Generated from the table of commands by `make generate`, not to be edited."


def read(path):
    return (REPOSITORY / path).read_text()


def names(pattern, *paths):
    """What is written by hand in these files, and therefore not generated."""
    return {name for path in paths for name in re.findall(pattern, read(path), re.M)}


def files(commands):
    by_hand = names(r'^    \{"([a-z]+)", ', "clients/cli/subcommand.c")
    yield "clients/cli/subcommand_rows.h", command_line.generate(commands, by_hand, SAYS)
    yield "man/delaunay.1", documents.generate_page(read("man/delaunay.1"), commands, by_hand, SAYS)
    package = "clients/python/delaunayd/"
    by_hand = names(r"^    def ([a-z_]+)\(", package + "_commands.py", package + "_constraints.py", package + "client.py")
    methods = python.generate(commands, by_hand, SAYS)
    yield package + "_table.py", methods
    yield package + "aio.pyi", python.generate_aio(read(package + "_commands.py"), read(package + "_constraints.py"), methods, SAYS)
    by_hand = names(r"^  (?:async )?([A-Za-z]+)\(", "clients/js/lib/client.js", "clients/js/lib/commands.js", "clients/js/lib/constraints.js")
    yield "clients/js/lib/table.js", node.generate(commands, by_hand, SAYS)
    yield "clients/js/table.d.ts", node.generate_types(commands, by_hand, SAYS)


def faults(commands):
    for path, text in files(commands):
        if read(path) != text:
            yield path + ": not what `make generate` writes"
    yield from documents.faults_of_headings(read("proto/PROTOCOL.md"), commands)
    for page in ("man/delaunay.1", "man/delaunayd.8"):
        yield from documents.faults_of_page(page, read(page), commands)


def main(daemon, check=None):
    commands = table.read(daemon)
    if check is None:
        for path, text in files(commands):
            (REPOSITORY / path).write_text(text)
    else:
        for fault in faults(commands):
            print(fault)


if __name__ == "__main__":
    main(*sys.argv[1:])
