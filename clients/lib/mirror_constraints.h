/* mirror_constraints.h - the constraints that a mirror has, and the changes that an event makes in them.
 *
 *     constraints_gather(&s, &c, declared), for each row
 *     constraints_compare(&s, reset)
 *     constraints_apply(&s)
 *
 * Rows are gathered aside, and their changes are found before they are applied. A hash table finds a constraint by its ends, kind and
 * number. The rows are sorted when that is asked for. */
#pragma once

#include "clients/lib/delaunay_client.h"

/* A growing array. */
struct constraint_list {
    struct delaunay_segment *at; /* owns */
    size_t n, cap;
};

/* The statement of an event about a constraint. */
struct constraint_said {
    struct delaunay_segment what; /* first */
    bool declared;
    size_t number; /* of the row */
};

/* All zero: none. */
struct constraints {
    struct constraint_list rows;
    bool is_sorted; /* in the order of CONSTRAINTS, else in any order */
    uint32_t *slot; /* owns: 1 + the place in rows; 0: free; linear probing */
    size_t slots;   /* a power of two, or 0 */
    /* The event that is being gathered: */
    struct constraint_said *said; /* owns */
    size_t n_said, said_room;
    /* The last change: */
    struct constraint_list added, released;
};

void constraints_free(struct constraints *s);

/* Forgets the gathered rows. */
void constraints_forget(struct constraints *s);

/* False: out of memory; nothing is gathered. */
bool constraints_gather(struct constraints *s, const struct delaunay_segment *c, bool declared);

/* Finds what the event changes, into `added` and `released`, and makes room for it; reset: what it does not name is not there any
 * more. False: out of memory. Cost: O(n log n) in the rows; of a reset also in the constraints before. */
bool constraints_compare(struct constraints *s, bool reset);

/* Applies that. Cost: linear. */
void constraints_apply(struct constraints *s);

/* Sorts the rows, in the order of CONSTRAINTS. Cost: constant if nothing has changed since, else O(n log n). */
void constraints_sort(struct constraints *s);
