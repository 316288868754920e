/* row.h - the rows of a text table and their values: separators, quotes, comments, ends of lines.
 *
 * A value may be quoted where it begins with a quote whose closing one is followed by a separator or the end of the
 * row. Any other quote is an ordinary character. A quoted value may span lines, unless each of these lines is a row
 * with all its columns: then the quotes are ordinary characters, too. */
#pragma once

#include "proto/text.h"

#include <stddef.h>

struct value {
    const char *text;
    size_t len;
};

struct row_style {
    char separator; /* ' ' means any number of blanks */
    char line_end;  /* LF, or CR in files that have no LF */
    size_t columns; /* of most rows; 0: not known yet */
};

enum {
    ROW_LONGEST = 16 << 20, /* bytes of a line, which may have a polygon in it */
    ROW_MOST_BYTES = 65536  /* of a row that spans lines */
};

enum row_kind { ROW_BLANK, ROW_COMMENT, ROW_SEGMENT, ROW_VALUES };

/* The quotes that row_end has seen. */
struct row_quotes {
    size_t breaks; /* line breaks within quotes */
    bool lone;     /* a value begins with a quote that is not closed */
};

static inline bool value_is_blank(char c)
{
    return text_is_blank(c) || c == '\r';
}

/* Without blanks at both ends. */
struct value value_trim(const char *s, const char *end);

/* Whether it is that word, in upper or lower case. */
bool value_is_word(struct value v, const char *word);

/* The line end of the row at s. NULL: it is not before `end`, so more text is needed, or, with `last`, the row ends
 * at `end`. Sets *quotes only if there are any. */
const char *row_end(const struct row_style *style, const char *s, const char *end, bool last,
                    struct row_quotes *quotes);

/* A comment begins with #, % or //, a segment (as GMT has them) with >. */
enum row_kind row_kind(const char *s, const char *end);

/* Stores the first `room` values of the row; returns how many there are. */
size_t row_split(const struct row_style *style, const char *s, const char *end, struct value *value,
                 size_t room);
