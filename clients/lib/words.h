/* words.h - the words of a row of a reply, between blanks; and those of a request. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include "proto/number.h"

/* The rest of the row: s .. end. */
struct words {
    const char *s, *end;
};

/* The length of the next word, which begins at *word; 0 at the end of the row. */
static inline size_t words_next(struct words *w, const char **word)
{
    while (w->s < w->end && *w->s == ' ')
        w->s++;
    *word = w->s;
    while (w->s < w->end && *w->s != ' ')
        w->s++;
    return (size_t)(w->s - *word);
}

/* Read the next word; false if it is no such number, or there is none. */
static inline bool words_next_u32(struct words *w, uint32_t *v)
{
    const char *word;
    size_t n = words_next(w, &word);
    return proto_read_u32(word, n, v);
}

static inline bool words_next_double(struct words *w, double *v)
{
    const char *word;
    size_t n = words_next(w, &word);
    return proto_read_double(word, n, v);
}

/* Appends ` WORD VALUE` to line[n], unless the value is NULL; returns the new n, which is beyond `room` if there is no room. */
static inline size_t words_put(char *line, size_t n, size_t room, const char *word,
                               const char *value)
{
    if (value == NULL || n >= room)
        return n;
    return n + (size_t)snprintf(line + n, room - n, " %s%s%s", word, value[0] != '\0' ? " " : "",
                                value);
}

/* The value of INSIDE for a border of that number, or for `any`. */
static inline const char *words_inside(const char *border)
{
    return border != NULL && strcmp(border, "any") == 0 ? "" : border;
}
