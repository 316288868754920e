"""The methods for Node, and their types: clients/js/lib/table.js, clients/js/table.d.ts."""

import methods

HEAD = """// The commands whose methods follow from the table of commands.
// %s
'use strict';

const { nothing, number, table, text, truth, typedKeys } = require('./framing.js');
const { checkField, checkSet, flag, list, option, real, whole, word } = require('./values.js');

/** The commands that need no more than their words. As the last argument each takes the options of request(). */
class Table {
"""
TAIL = """}

module.exports = { Table };
"""
TYPES_HEAD = """// The types of the commands whose methods follow from the table of commands.
// %s
import { RequestOptions } from './index';

/** The commands that need no more than their words. */
export interface Table {
"""
TAKES = {"set": "checkSet", "field": "checkField", "integer": "whole", "double": "real", "text": "word"}
TYPES = {"set": "string", "field": "string", "integer": "number", "double": "number", "text": "string"}
READS = {"i": "number", "d": "number", "b": "truth", "s": "text"}
FACTS = {"i": "number", "d": "number", "b": "boolean", "s": "string"}


def camel(words):
    return words[0] + "".join(w.capitalize() for w in words[1:])


def name_of(value):
    return value.name + "s" * value.many


def option_names(method):
    return [camel(methods.option_name(o)) for o in method.options]


def words(method):
    yield "'%s'" % method.command.name
    for v in method.values:
        take = TAKES[v.kind()]
        yield ("list(%s, %s)" % (name_of(v), take) if v.many else "option([], %s, %s)" % (name_of(v), take) if v.optional else "%s(%s)" % (take, name_of(v)))
    for o, name in zip(method.options, option_names(method)):
        if not o.values and not o.choices:
            yield "flag('%s', %s)" % (o.keyword, name)
        else:
            yield "option('%s', %s, %s)" % (o.keyword, name, TAKES[o.kind()] if len(o.values) < 2 else "(all) => list(all, %s)" % TAKES[o.kind()])


def read(command):
    if command.rows:
        return "table('%s')" % command.rows
    if not command.facts:
        return "nothing"
    if len(command.facts) > 1:
        return "typedKeys"
    return "%s('%s')" % (READS[command.facts[0].type], command.facts[0].key)


def code(method):
    options = "{ %s, ...options } = {}" % ", ".join(option_names(method)) if method.options else "options"
    parameters = ", ".join([name_of(v) for v in method.values] + [options])
    text = "  /** %s */\n  async %s(%s) {\n" % (method.doc("Resolves with"), camel(method.words), parameters)
    return text + "    return %s(await this._ask([%s], options));\n  }\n" % (read(method.command), ", ".join(words(method)))


def result_type(command):
    if command.rows:
        return "(string | number)[][]"
    if not command.facts:
        return "void"
    if len(command.facts) == 1:
        fact = command.facts[0]
        return FACTS[fact.type] + " | undefined" * fact.optional
    return "{ %s }" % "; ".join("%s%s: %s" % (f.key, "?" * f.optional, FACTS[f.type]) for f in command.facts)


def option_type(option):
    if option.choices:
        return " | ".join("'%s'" % choice for choice in option.choices)
    if not option.values:
        return "boolean"
    return TYPES[option.kind()] if len(option.values) == 1 else "ArrayLike<%s>" % TYPES[option.kind()]


def type_of(method):
    parameters = []
    for v in method.values:
        of = "Iterable<%s>" % TYPES[v.kind()] if v.many else TYPES[v.kind()]
        parameters.append("%s%s: %s" % (name_of(v), "?" * v.optional, of))
    options = ["%s?: %s" % (name, option_type(o)) for o, name in zip(method.options, option_names(method))]
    parameters.append("options?: RequestOptions" + (" & { %s }" % "; ".join(options) if options else ""))
    text = "  /** %s */\n  %s(%s)" % (method.doc("Resolves with"), camel(method.words), ", ".join(parameters))
    return text + ": Promise<%s>;\n" % result_type(method.command)


def chosen(commands, by_hand):
    return [m for m in methods.read(commands) if camel(m.words) not in by_hand]


def generate(commands, by_hand, says):
    return HEAD % says + "\n".join(map(code, chosen(commands, by_hand))) + TAIL


def generate_types(commands, by_hand, says):
    return TYPES_HEAD % says + "".join(map(type_of, chosen(commands, by_hand))) + "}\n"
