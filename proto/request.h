/* request.h - a request line as words: separated by spaces or tabs, the first one names the
 * command. */
#ifndef PROTO_REQUEST_H
#define PROTO_REQUEST_H

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

/* Makes it n words that have been read before. False, with none, when out of memory. */
bool request_set(struct request *q, const struct word *word, size_t n);
void request_free(struct request *q);

/* The same as word_is, all of the word looked at. */
bool word_is_whole(const struct word *w, const char *upper);

/* Whether the word is `upper` (not empty, in capitals), whatever its own case. */
static inline bool word_is(const struct word *w, const char *upper)
{
    /* Most words that a table is searched for are told apart by their first letters. */
    return w->len > 0 && ((w->text[0] ^ upper[0]) & ~0x20) == 0 && word_is_whole(w, upper);
}

/* Whether the word may name a set: [A-Za-z0-9_.:-]{1,64}. */
bool word_is_set_name(const struct word *w);

/* Whether a first line gives away a browser or some other HTTP client: it ends in " HTTP/1.x". */
bool line_is_http(const char *text, size_t len);

#endif
