"""The list of requests in man/delaunay.1, and what the documents say about commands in comparison with the table."""

import re

import command_line

BEGIN, END = '.\\" %s\n', '.\\" End of what is generated.\n'


def entry(command):
    return ".TP\n.B %s\n%s" % (command_line.usage(command).replace("-", "\\-"), command_line.help_text(command).replace("-", "\\-"))


def generate_page(page, commands, by_hand, says):
    """The page with the list of requests as it should be."""
    begin = BEGIN % says
    before, rest = page.split(begin)
    return before + begin + "".join(map(entry, command_line.requests(commands, by_hand))) + END + rest.split(END)[1]


def words(usage):
    return set(re.findall(r"[^\s\[\]]+", usage)) - {"...", "|"}


def faults_of_headings(protocol, commands):
    """The headings of a command's sections have the words of its usage, and no others."""
    described = {}
    for heading in re.findall(r"^### ([A-Z]+\b.*)$", protocol, re.M):
        for form in re.split(r"[,;] ", heading):
            described.setdefault(form.split()[0], set()).update(words(form))
    for c in commands:
        if c.name not in described:
            yield "proto/PROTOCOL.md: there is no section about %s" % c.name
            continue
        for word in sorted(described.pop(c.name) ^ words(c.usage)):
            yield "proto/PROTOCOL.md: the headings of %s, or its usage: %s" % (c.name, word)
    for name in described:
        yield "proto/PROTOCOL.md: there is no command %s" % name


def faults_of_page(name, page, commands):
    """A request in bold, such as CONFIG RELOAD, has keywords of the command."""
    known = {c.name: set(c.keywords()) | {c.name} for c in commands}
    for request in re.findall(r'^\.BR? "?([A-Z]+(?: [A-Z]+\b)*)', page, re.M):
        for word in set(request.split()) - known.get(request.split()[0], set(request.split())):
            yield "%s: %s: %s" % (name, request, word)
