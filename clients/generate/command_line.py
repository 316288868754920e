"""The commands as subcommands of `delaunay`: a list of rows for clients/cli/subcommand.c."""

import re
import textwrap

from table import WITH_EVENTS

WIDTH = 100


def is_value(word):
    return word != "auto" and re.fullmatch(r"[a-z][a-z0-9]*(,[a-z]+)*", word)


def usage(command):
    """`move SET id x y` as `move SET ID X Y`, which is how the command line shows values; choices stay as they are."""
    words = re.split(r"([A-Za-z0-9,|]+)", command.usage)
    shown = [w.lower() if w == command.name else w.upper() if is_value(w) else w for w in words]
    return "".join(shown)


def help_text(command):
    """The help as a sentence, with names of values of one or two characters as in the usage. "a" is an article."""
    named = {w for w in re.findall(r"[a-z][0-9]?\b", command.usage)} - {"a"}
    shown = re.sub(r"\b[a-z][0-9]?\b", lambda w: w[0].upper() if w[0] in named else w[0], command.help)
    return textwrap.fill(shown[0].upper() + shown[1:] + ".", WIDTH) + "\n"


def quoted(text):
    return '"%s"' % text.replace("\\", "\\\\").replace('"', '\\"').replace("\n", "\\n")


def row(command):
    about_set = "true" if command.about == "set" else "false"
    words = quoted(" ".join(command.keywords())) if command.keywords() else "NULL"
    first = '{"%s", NULL, false, %s, %s' % (command.name.lower(), about_set, quoted(usage(command)))
    return "%s,\n %s, NULL, false, %s},\n" % (first, quoted(help_text(command)), words)


def requests(commands, by_hand):
    """Those that are sent as they are. Bodies are binary: `load` and other subcommands send them. `by_hand`: names of rows."""
    return [c for c in commands if not c.body and c.name not in WITH_EVENTS and c.name.lower() not in by_hand]


def generate(commands, by_hand, says):
    rows = [row(c) for c in requests(commands, by_hand)]
    return "/* subcommand_rows.h - rows of the table in subcommand.c.\n * %s */\n/* clang-format off */\n" % says + "".join(rows)
