"""generate.py - random mutants: one line of a C file changed in one of the ways in which people go wrong."""
import random
import re

RELATIONS = {"<": ["<=", ">"], "<=": ["<", "=="], ">": [">=", "<"], ">=": [">", "=="], "==": ["!="], "!=": ["=="]}
OTHERS = {"&&": ["||"], "||": ["&&"], "+": ["-"], "-": ["+"], "*": ["+"], "/": ["*"], "%": ["/"], "&": ["|"], "|": ["&"], "<<": [">>"], ">>": ["<<"],
          "++": ["--"], "--": ["++"], "+=": ["-=", "="], "-=": ["+=", "="], "|=": ["&=", "="], "&=": ["|=", "="]}
OPERATORS = {**RELATIONS, **OTHERS}
# Binary operators have blanks around them, so that pointers, signs and addresses are left alone. Unary operators have none.
OPERATOR = re.compile(r"(?<= )(?:" + "|".join(re.escape(o) for o in sorted(OPERATORS, key=len, reverse=True) if o not in ("++", "--")) + r")(?= )|\+\+|--")
NUMBER = re.compile(r"(?<![\w.\"'])(\d+)(?=[uUlL]*(?![\w.xX]))")
KEYWORDS = {"return", "if", "for", "while", "else", "switch", "case", "goto", "do", "break", "continue", "default", "static", "const", "struct",
            "enum", "unsigned", "sizeof"}
CALL = re.compile(r"(?:\*?[\w.>\[\]-]+ (?:[-+|&*]?= .*)|\w+\(.*\)|\(void\)\w+\(.*\)|[\w.>\[\]-]+(?:\+\+|--)|(?:\+\+|--)[\w.>\[\]-]+);")
ARGUMENTS = re.compile(r"(\w+)\(([\w.>&\[\]-]+), ([\w.>&\[\]-]+)(?=[,)])")


# Declarations without a value, prefetches and messages, which change no result, and what only gives memory back: a sanitizer notices leaks.
NO_EFFECT = re.compile(r"(?:(?:static|const|unsigned|char|int|size_t|double|bool|u?int\d+_t|(?:struct|enum) \w+) )+[^=(]*;|(?:dt_fetch|__builtin_prefetch|fprintf\(stderr|free\()\b.*")


def code_lines(text):
    """(number, line) of the lines inside functions, without comments, directives, tables of constants and what has no effect."""
    inside, comment, table = False, False, False
    for number, line in enumerate(text.split("\n"), 1):
        bare = line.strip()
        if line.startswith("{"):
            inside = True
        elif line.startswith("}"):
            inside = False
        if bare.startswith("/*"):
            comment = True
        if inside and not comment and bare.startswith("static const"):
            table = True
        if inside and not comment and not table and line.startswith("    ") and not bare.startswith(("#", "assert(", "notice(", "enum ")) \
                and not NO_EFFECT.fullmatch(bare):
            yield number, line
        if "*/" in line:
            comment = False
        if bare.endswith(";"):
            table = False


def split_comment(line):
    """The code of a line, and the comment behind it."""
    at = line.find("/*")
    return (line, "") if at < 0 else (line[:at], line[at:])


def masked(code):
    """The code with its strings and characters blanked, at the same places."""
    return re.sub(r"\"(?:\\.|[^\"\\])*\"|'(?:\\.|[^'\\])*'", lambda m: "_" * len(m.group()), code)


def replacements(code, pattern, choices):
    for m in pattern.finditer(masked(code)):
        for new in choices(m):
            yield code[: m.start()] + new + code[m.end():]


def operators(code):
    return replacements(code, OPERATOR, lambda m: OPERATORS[m.group()])


def constants(code):
    yield from replacements(code, NUMBER, lambda m: [str(int(m.group(1)) + 1)] + ([str(int(m.group(1)) - 1)] if int(m.group(1)) else []))
    yield from replacements(code, re.compile(r"\b(true|false)\b"), lambda m: ["false" if m.group() == "true" else "true"])


def conditions(code):
    m = re.match(r"(\s*(?:\} else )?(?:if|while) )\((.*)\)( \{)?\s*$", code)
    if m and m.group(2).count("(") == m.group(2).count(")"):
        for new in (f"!({m.group(2)})", "false", *(["true"] if "while" not in m.group(1) else [])):
            yield f"{m.group(1)}({new}){m.group(3) or ''}"
    yield from replacements(code, re.compile(r"!(?=[\w(])"), lambda m: [""])


def removals(code):
    bare = code.strip()
    first = re.search(r"\w+", bare)
    if CALL.fullmatch(bare) and first.group() not in KEYWORDS and bare.count("(") == bare.count(")"):
        yield code[: len(code) - len(code.lstrip())] + ";"
    if bare in ("break;", "continue;"):
        yield code.replace(bare, "continue;" if bare == "break;" else "break;")


def arguments(code):
    for m in ARGUMENTS.finditer(masked(code)):
        if m.group(2) != m.group(3) and m.group(1) not in KEYWORDS:
            yield code[: m.start(2)] + m.group(3) + ", " + m.group(2) + code[m.end(3):]


def returns(code):
    m = re.match(r"(\s*return )([^;]+);\s*$", code)
    if m and m.group(2) not in ("true", "false", "NULL", "0"):
        yield f"{m.group(1)}0;"
        if not re.search(r"[*&]|NULL|\?", m.group(2)):
            yield f"{m.group(1)}!({m.group(2)});"


def indices(code):
    return replacements(code, re.compile(r"\[(\w+)\]"), lambda m: [f"[{m.group(1)} + 1]"])


KINDS = (operators, constants, conditions, removals, arguments, returns, indices)


def changes(line):
    """All changed lines, by kind; kinds without any are left out."""
    code, comment = split_comment(line)
    found = [[new + comment for new in kind(code.rstrip()) if new.strip() != code.strip()] for kind in KINDS]
    return [f for f in found if f]


def draw(rng: random.Random, texts):
    """A random mutant of one of the files (a dictionary from names to texts): (file, line number, old line, new line). Each line that
    can be changed is as likely as any other, whatever its file."""
    lines = [(file, number, line) for file in sorted(texts) for number, line in code_lines(texts[file]) if changes(line)]
    while True:
        file, number, line = rng.choice(lines)
        yield file, number, line, rng.choice(rng.choice(changes(line)))
