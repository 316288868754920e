/* json_scan.h - a scanner of JSON text [RFC 8259] that is in memory: it finds where values begin and end, and checks that
 * brackets match. Words and numbers are not judged; the caller reads those that it needs. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

enum { JSON_DEPTH = 64 };

/* A place in the text; a copy of it is a bookmark. */
struct json_scan {
    const char *p, *end;
    uint64_t line; /* of p, from 1 */
    int depth;
};

/* A part of the text: a string without its quotes, as it is written, or a whole value. */
struct json_part {
    const char *text;
    size_t len;
};

/* The next character that is not blank; 0 at the end, and for a NUL byte. */
char json_peek(struct json_scan *j);

/* Passes that character if it is c. */
bool json_take(struct json_scan *j, char c);

/* Pass a string, or any value; false if there is none, or if it is nested more deeply than JSON_DEPTH. */
bool json_take_string(struct json_scan *j, struct json_part *part);
bool json_take_value(struct json_scan *j, struct json_part *part);

static inline bool json_is(struct json_part part, const char *text)
{
    return part.len == strlen(text) && memcmp(part.text, text, part.len) == 0;
}
