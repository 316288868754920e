/* touched.h - which points edits touch, for those who follow a set. */
#ifndef DT_TOUCHED_H
#define DT_TOUCHED_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Keys of delaunay.h: the rows and rings that have changed, or the values. */
struct dt_touched_list {
    uint64_t *key; /* owns; not sorted, and a key may be repeated */
    size_t n, cap;
    bool all; /* too many to be noted, or a rebuild */
};

/* Whether all points are on one line, and whether that runs upwards from where it begins: the order of every ring depends on it.
 * On a line that is vertical, y decides. */
enum dt_touched_line { DT_NOT_ON_LINE, DT_LINE_UP, DT_LINE_DOWN };

/* Start with {0}. */
struct dt_touched {
    struct dt_touched_list rows, values;
    bool on, with_values;
    enum dt_touched_line line; /* when rows were taken last */
};

void dt_touched_clear(struct dt_touched *w);

static inline size_t dt_touched_memory(const struct dt_touched *w)
{
    return (w->rows.cap + w->values.cap) * sizeof *w->rows.key;
}

/* Notes a key; O(1) amortised. */
void dt_touched_note(struct dt_touched_list *w, uint64_t key);

#endif
