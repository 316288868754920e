/* touched.h - which points edits touch, for those who follow a set. */
#ifndef DT_TOUCHED_H
#define DT_TOUCHED_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Start with {0}. */
struct dt_touched {
    uint64_t *key; /* owns: 2 id, or 2 id + 1 if only the ring of the id may have changed */
    size_t n, cap;
    bool on;
    bool all; /* too many, or a rebuild */
};

void dt_touched_clear(struct dt_touched *w);

/* Notes a key; O(1) amortised. */
void dt_touched_note(struct dt_touched *w, uint64_t key);

#endif
