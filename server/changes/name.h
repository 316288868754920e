/* name.h - a copy of the name of a set or of a field. */
#pragma once

#include "proto/request.h"

#include <string.h>

struct name {
    size_t len;                /* 0: none */
    char text[SET_NAME_LIMIT]; /* not NUL-terminated */
};

/* len <= SET_NAME_LIMIT. */
static inline struct name name_of(const char *text, size_t len)
{
    struct name n = {.len = len};
    memcpy(n.text, text, len);
    return n;
}

/* Borrows the name. */
static inline struct word name_word(const struct name *n)
{
    return (struct word){n->text, n->len};
}

static inline bool name_equals(const struct name *n, const char *text, size_t len)
{
    return n->len == len && memcmp(n->text, text, len) == 0;
}
