/* resp.h - requests and replies in RESP, for loads in this framing. */
#pragma once

#include <stdbool.h>
#include <stddef.h>

/* Writes the request line[len] as an array of bulk strings; returns its length. The words of the line are separated by
 * single blanks, and it ends in LF. to has room for 32 + 4 * len bytes. */
size_t resp_encode(char *to, const char *line, size_t len);

/* The length of the reply that text[len] starts with, 0 if it is not complete yet, -1 if it is invalid.
 * *error: it is an error. Arrays hold bulk strings. */
ptrdiff_t resp_reply(const char *text, size_t len, bool *error);
