/* line.h - splits bytes into lines, which end in LF or CRLF; a line with a NUL byte or with more than LINE_LIMIT bytes
 * is invalid. */
#pragma once

#include <stdbool.h>
#include <stddef.h>

enum { LINE_LIMIT = 65536 }; /* bytes of a line, without its end */

enum line_fault { LINE_WHOLE, LINE_NUL, LINE_TOO_LONG };

struct line {
    const char *text; /* borrows the input; without its LF or CRLF */
    size_t len;
    enum line_fault fault;
};

/* Reads the first line of bytes[n]. Returns its bytes, with its end; 0 if the end has not arrived yet; -1 if the line is
 * invalid, with the reason in out->fault. `last`: there will be no more bytes, and a rest without LF counts as a
 * line. Cost: linear in the line. */
ptrdiff_t line_read(const char *bytes, size_t n, bool last, struct line *out);

/* The error message. */
const char *line_fault_text(enum line_fault fault);
