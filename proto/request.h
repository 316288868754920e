/* request.h - the words of a request line, separated by spaces or tabs; the first one is the command. */
#pragma once

#include <stdbool.h>
#include <stddef.h>

enum { SET_NAME_LIMIT = 64 };

struct word {
    const char *text; /* borrows the line; not NUL-terminated */
    size_t len;
};

struct request {
    struct word *word; /* owns; reused from line to line */
    size_t n, cap;
};

/* Splits a line into words; n is 0 for a blank line. False, with no words, when out of memory. */
bool request_split(struct request *q, const char *text, size_t len);

/* Appends one word. False, with nothing changed, when out of memory. */
bool request_add(struct request *q, const char *text, size_t len);

/* Sets the words to n words that have been parsed before. False, with no words, when out of memory. */
bool request_set(struct request *q, const struct word *word, size_t n);
void request_free(struct request *q);

/* The full comparison of word_is. */
bool word_is_whole(const struct word *w, const char *upper);

/* Whether the word equals `upper` (not empty, in capitals), case-insensitive. */
static inline bool word_is(const struct word *w, const char *upper)
{
    /* In a search of a table, the first letters distinguish most words. */
    return w->len > 0 && ((w->text[0] ^ upper[0]) & ~0x20) == 0 && word_is_whole(w, upper);
}

/* Whether the word may name a set: [A-Za-z0-9_.:-]{1,64}. */
bool word_is_set_name(const struct word *w);

/* Whether the word may name a field: a set's name that begins with a letter or `_`. */
bool word_is_field_name(const struct word *w);

/* Whether the line is a request that the server answers without more input. It is not if it is blank or a comment, or contains a
 * line break or a NUL byte. It is not if a body follows: LOAD and every command whose name ends in B, also after TIMEOUT. */
bool line_is_whole_request(const char *text, size_t len);

/* Whether the first line is that of a browser or another HTTP client: it ends in " HTTP/1.x". */
bool line_is_http(const char *text, size_t len);
