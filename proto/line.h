/* line.h - cuts bytes into lines: LF or CRLF ends one, a NUL byte or more than LINE_LIMIT bytes
 * spoil it. */
#ifndef PROTO_LINE_H
#define PROTO_LINE_H

#include <stdbool.h>
#include <stddef.h>

enum { LINE_LIMIT = 65536 }; /* bytes of a line, its end not counted */

enum line_fault { LINE_WHOLE, LINE_NUL, LINE_TOO_LONG };

struct line {
    const char *text; /* borrows the input; without its LF or CRLF */
    size_t len;
    enum line_fault fault;
};

/* Reads the first line of bytes[n]. Returns how many bytes it took, its end included; 0 if its end
 * has not arrived yet; -1 if it is spoilt, with the reason in out->fault. With `last`, no more
 * bytes will come: a rest without its LF counts as a line. Cost: linear in the line. */
ptrdiff_t line_read(const char *bytes, size_t n, bool last, struct line *out);

/* The sentence for people. */
const char *line_fault_text(enum line_fault fault);

#endif
