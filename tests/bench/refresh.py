#!/usr/bin/env python3
"""Writes the figures of a run of `make bench` into the tables of documents.

    refresh.py BENCH.md DOCUMENT...

A table of a document takes its figures from the table of the run whose headings include its own and which begins with
the same heading, the last one if there are several: families are measured with more and more points. Rows are matched by
their first cell. Cells for which the run has no figure stay as they are. A line that begins with "Machine: " is written
again. The texts around the tables are left to the reader.
"""
import os
import re
import subprocess
import sys


def cells(line):
    return [c.strip() for c in line.strip().strip('|').split('|')]


def tables(lines):
    """Yields (the line of the headings, the line after the last row) of every table."""
    at = 0
    while at < len(lines):
        end = at
        while end < len(lines) and lines[end].startswith('|'):
            end += 1
        if end - at > 2:
            yield at, end
        at = max(end, at + 1)


def read_run(path):
    """A list of tables, each a list of its headings and a dict from the first cell of a row to its cells."""
    lines = open(path, encoding='utf-8').read().split('\n')
    return [(cells(lines[a]), {cells(r)[0]: cells(r) for r in lines[a + 2:b]}) for a, b in tables(lines)]


def source_of(headings, run):
    for table in sorted(reversed(run), key=lambda t: t[0] != headings): # an equal one first, that of most points
        if table[0][0] == headings[0] and set(headings) <= set(table[0]):
            return table
    return None


def refreshed(row, headings, source):
    """The row with the figures of the run, and whether all of them are there."""
    old = cells(row)
    new = source[1].get(old[0])
    if new is None:
        return row, False
    figures = new if headings == source[0] else [new[source[0].index(h)] for h in headings]
    merged = [old[i] if f == '-' else f for i, f in enumerate(figures)]
    return '| ' + ' | '.join(merged) + ' |', '-' not in figures


def machine():
    model = re.search(r'model name\s*: (.*)', open('/proc/cpuinfo', encoding='utf-8').read())
    cc = subprocess.run([os.environ.get('CC', 'cc'), '-dumpfullversion'], capture_output=True, text=True, check=True)
    return 'Machine: %d cores of %s, gcc %s.' % (os.cpu_count(), model.group(1) if model else 'unknown', cc.stdout.strip())


def refresh(path, run):
    lines = open(path, encoding='utf-8').read().split('\n')
    done = []
    for at, end in tables(lines):
        headings = cells(lines[at])
        source = source_of(headings, run)
        if source is None:
            continue
        if headings in done:
            print('%s:%d: a second table with these headings was left as it is' % (path, at + 1))
            continue
        done.append(headings)
        for i in range(at + 2, end):
            lines[i], whole = refreshed(lines[i], headings, source)
            if not whole:
                print('%s:%d: the run has no figures, or not all, for "%s"' % (path, i + 1, cells(lines[i])[0]))
    lines = [machine() if line.startswith('Machine: ') else line for line in lines]
    open(path, 'w', encoding='utf-8').write('\n'.join(lines))
    print('%s: %d tables written' % (path, len(done)))


if len(sys.argv) < 3:
    sys.exit(__doc__)
for document in sys.argv[2:]:
    refresh(document, read_run(sys.argv[1]))
