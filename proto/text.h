/* text.h - kinds of characters, in ASCII: the locale has no effect. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <string.h>

/* A separator of words in a line. Most characters are decided by the first comparison. */
static inline bool text_is_blank(char c)
{
    return (unsigned char)c <= ' ' && (c == ' ' || c == '\t');
}

/* A blank, or part of the end of a line. */
static inline bool text_is_space(char c)
{
    return text_is_blank(c) || c == '\r' || c == '\n';
}

static inline bool text_is_digit(char c)
{
    return (unsigned char)(c - '0') < 10;
}

/* The length of the byte order mark of UTF-8 at the front. */
static inline size_t text_mark_length(const char *text, size_t n)
{
    return n >= 3 && memcmp(text, "\xEF\xBB\xBF", 3) == 0 ? 3 : 0;
}
