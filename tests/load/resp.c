/* resp.c - see resp.h. */
#include "tests/load/resp.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

size_t resp_encode(char *to, const char *line, size_t len)
{
    unsigned words = 1;
    for (size_t i = 0; i < len; i++)
        words += line[i] == ' ';
    size_t n = (size_t)sprintf(to, "*%u\r\n", words);
    for (size_t at = 0; at < len;) {
        size_t word = strcspn(line + at, " \n");
        n += (size_t)sprintf(to + n, "$%zu\r\n", word);
        memcpy(to + n, line + at, word);
        memcpy(to + n + word, "\r\n", 2);
        n += word + 2;
        at += word + 1;
    }
    return n;
}

/* The length of the first line with its end; 0: it is not complete. */
static size_t line_length(const char *text, size_t len)
{
    const char *end = len > 0 ? memchr(text, '\n', len) : NULL;
    return end != NULL ? (size_t)(end + 1 - text) : 0;
}

/* The length of a bulk string, with its framing. */
static ptrdiff_t bulk_length(const char *text, size_t len)
{
    size_t head = line_length(text, len);
    if (head == 0)
        return 0;
    long n = text[0] == '$' ? strtol(text + 1, NULL, 10) : -1;
    if (n < 0)
        return -1;
    size_t all = head + (size_t)n + 2;
    return all <= len ? (ptrdiff_t)all : 0;
}

ptrdiff_t resp_reply(const char *text, size_t len, bool *error)
{
    size_t at = line_length(text, len);
    *error = at > 0 && text[0] == '-';
    if (at == 0 || text[0] == '+' || text[0] == '-')
        return (ptrdiff_t)at;
    if (text[0] == '$')
        return bulk_length(text, len);
    if (text[0] != '*')
        return -1;
    for (long left = strtol(text + 1, NULL, 10); left > 0; left--) {
        ptrdiff_t n = bulk_length(text + at, len - at);
        if (n <= 0)
            return n;
        at += (size_t)n;
    }
    return (ptrdiff_t)at;
}
