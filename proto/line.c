/* line.c - see line.h. */
#include "proto/line.h"

#include <string.h>

static ptrdiff_t invalid(struct line *out, enum line_fault fault)
{
    out->fault = fault;
    return -1;
}

ptrdiff_t line_read(const char *bytes, size_t n, bool last, struct line *out)
{
    if (n == 0)
        return 0;
    const char *lf = memchr(bytes, '\n', n);
    size_t len = lf != NULL ? (size_t)(lf - bytes) : n;
    size_t took = lf != NULL ? len + 1 : n;
    /* An incomplete line is checked, too: the client may wait for the error before it sends the LF. */
    if (memchr(bytes, '\0', len) != NULL)
        return invalid(out, LINE_NUL);
    if (len > 0 && bytes[len - 1] == '\r')
        len--;
    if (len > LINE_LIMIT)
        return invalid(out, LINE_TOO_LONG);
    if (lf == NULL && !last)
        return 0;
    *out = (struct line){.text = bytes, .len = len, .fault = LINE_WHOLE};
    return (ptrdiff_t)took;
}

const char *line_fault_text(enum line_fault fault)
{
    switch (fault) {
    case LINE_NUL:
        return "NUL byte in request";
    case LINE_TOO_LONG:
        return "line longer than 65536 bytes";
    case LINE_WHOLE:
        break;
    }
    return "";
}
