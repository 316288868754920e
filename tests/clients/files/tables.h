/* tables.h - reads texts as files of points, for tests. */
#pragma once

#include "clients/files/source.h"

/* The result of a file: `x y z; ...` with all fields, or `line: fault` if it was refused; and the notes, one a line. */
struct outcome {
    char points[4000], notes[8000];
    bool read;
};

/* Reads the text as a file with this ending; `choose` may set options before. NULL: none. */
void tables_read(struct outcome *o, const char *ending, const char *text, size_t n,
                 void (*choose)(struct source *s));

/* Expects these points and, unless it is NULL, a note that contains this text; "" expects no notes at all. */
void tables_expect(const char *ending, const char *text, const char *points, const char *note);

/* Expects that the file is refused, with a fault that contains this text. */
void tables_refuse(const char *ending, const char *text, const char *fault);
