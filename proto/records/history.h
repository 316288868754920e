/* history.h - the history of a data directory: which changes it may have in common with another one.
 *
 * A directory gets a random origin when it is new. Each promotion of a follower to a leader (FOLLOW NONE) begins a new
 * generation of the history with a random nonce, and remembers the nonce of the generation before as its parent. So two
 * followers that are promoted at the same time have different histories, and of two leaders with the same origin the one
 * with the later generation is newer. Its text: origin, generation and nonce, `4f1c09d2a87be653.2.91a0c37e`. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct history {
    uint64_t origin; /* 0: unknown */
    uint32_t generation, nonce;
    uint32_t parent; /* the nonce of the generation before; 0: there is none */
};

enum { HISTORY_TEXT = 48 }; /* bytes of its text, the NUL included */

/* A new history, from random bits. */
struct history history_begin(uint64_t random);

/* Its next generation. */
struct history history_next(const struct history *h, uint32_t random);

/* The relation of a history to another one, `own`. */
enum history_relation {
    HISTORY_SAME,
    HISTORY_NEWER,    /* a later generation of the same origin */
    HISTORY_OLDER,    /* an earlier one */
    HISTORY_BESIDE,   /* another one of the same number: two followers were promoted */
    HISTORY_DIFFERENT /* of another origin, or one of them is unknown */
};
enum history_relation history_relation(const struct history *h, const struct history *own);

void history_write(char text[HISTORY_TEXT], const struct history *h);

/* Reads the text; h->parent is 0. */
bool history_read(const char *text, size_t n, struct history *h);
