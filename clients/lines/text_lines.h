/* text_lines.h - the lines of a text file in memory, as words. */
#pragma once

#include "clients/points/points_file.h"
#include "clients/reading/row.h"

struct text_lines_scan {
    const char *p, *end;
    uint64_t line;
    const char *text; /* the line that was read last, without its end and without a comment */
    size_t len;
    struct value *word; /* owns: its words */
    size_t n, cap;
};

struct text_lines_scan text_lines_begin(const char *text, size_t n);

/* The next line that has words; what follows # is a comment. Sets f->line. False at the end, or, with a fault, out of memory. */
bool text_lines_next(struct text_lines_scan *s, struct points_file *f);
void text_lines_end(struct text_lines_scan *s);

/* Removes the path that has been begun. */
void text_lines_take_back(struct points_file *f);
