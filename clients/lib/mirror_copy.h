/* mirror_copy.h - the copy of a set that a mirror keeps, and the changes that an event of WATCH makes in it (PROTOCOL.md, section 6.5).
 *
 *     copy_begin(&c, reset);
 *     for each row: copy_row(&c, text, len);
 *     copy_commit(&c, &change);
 *
 * Rows are gathered aside, so the copy shows the last version until the commit. */
#pragma once

#include "clients/lib/delaunay_client.h"
#include "clients/lib/mirror_constraints.h"

/* The state of an id in the copy. */
struct copy_place {
    double x, y;
    size_t ring; /* the place of the first neighbour in the copy's words */
    uint32_t len;
    bool present, ringed, inner; /* ringed: it has a ring, of len neighbours */
};

/* The statement of an event about an id. */
struct copy_entry {
    uint32_t id, len;
    double x, y;
    size_t ring;  /* as in copy_place, in the words of the event */
    size_t value; /* the place of its first value in those of the event */
    bool point, gone, ringed, inner;
};

/* A growing array of ids. */
struct copy_words {
    uint32_t *at; /* owns */
    size_t n, cap;
};

struct copy {
    unsigned fields; /* values at each point */
    /* By id: */
    uint32_t ids, room;       /* ids that have been named are smaller; room for so many */
    struct copy_place *place; /* owns [room] */
    double *value;            /* owns [fields * room] */
    uint32_t *slot; /* owns [room]: 1 + the place in `entry`, 0: the event does not name it */
    struct copy_words rings; /* of the copy; replaced rings leave gaps */
    size_t ringed_words;     /* words of rings that are in use */
    size_t points;
    struct constraints constraints;
    /* The event that is being gathered: */
    bool reset;
    struct copy_entry *entry; /* owns */
    size_t entries, entry_room;
    struct copy_words event_rings;
    double *event_value; /* owns */
    size_t event_values, event_value_room;
    /* The last change: */
    struct copy_words added, moved, gone, triangles_added, triangles_removed;
};

/* An empty copy is all zero, except `fields`. */
void copy_free(struct copy *c);

/* Forgets the gathered rows. Cost: linear in their number. */
void copy_forget(struct copy *c);

/* A part of an event with everything begins: rows that were gathered before do not count. */
void copy_reset(struct copy *c);

/* Gathers a row. DELAUNAY_BROKEN: it is none of an event; DELAUNAY_NOMEM. */
enum delaunay_result copy_row(struct copy *c, const char *text, size_t len);

/* Applies the gathered rows. *change borrows from the copy until the next commit. DELAUNAY_NOMEM: the copy is as
 * before, and nothing is gathered any more. Cost: linear in the rows and in the rings that were replaced, on an
 * average over commits. */
enum delaunay_result copy_commit(struct copy *c, struct delaunay_change *change);

/* The place of an id; NULL if there is no such point. */
const struct copy_place *copy_place(const struct copy *c, uint32_t id);
