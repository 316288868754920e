/* report.h - what reading a file has shown: notes, each a sentence without its name, which `load`, `run`, `draw`,
 * --dry-run and --json print. Each thing that is not used, missing, skipped or doubtful gets one note. */
#pragma once

#include <stddef.h>
#include <stdio.h>

enum note_kind {
    NOTE_READ,     /* how the file is read: the columns that are used */
    NOTE_UNUSED,   /* columns, members, layers that are not loaded */
    NOTE_MISSING,  /* values that are missing */
    NOTE_SKIPPED,  /* lines or features that are left out */
    NOTE_SPANNING, /* values that span lines */
    NOTE_DOUBT,    /* what may be meant otherwise */
    NOTE_KINDS
};

enum { REPORT_NOTES = 40, REPORT_NOTE_ROOM = 400 };

struct report {
    struct {
        enum note_kind kind;
        char text[REPORT_NOTE_ROOM];
    } note[REPORT_NOTES];
    size_t n;
    size_t lost; /* notes for which there was no room */
};

/* Adds a note; control characters become '?', bytes that are not UTF-8 are taken for Latin-1. A text that is too long
 * ends in "...". */
__attribute__((format(printf, 3, 4))) void report_add(struct report *r, enum note_kind kind,
                                                      const char *format, ...);

/* "read", "unused", "missing", "skipped", "spanning", "doubt". */
const char *report_kind(enum note_kind kind);

/* Prints each note as `delaunay: NAME: TEXT`, in the order of their kinds. */
void report_print(const struct report *r, const char *name, FILE *out);

/* Copies s[len] into to[room], at least 4 bytes, as printable UTF-8, as report_add does. Returns to. */
const char *report_clean(char *to, size_t room, const char *s, size_t len);
