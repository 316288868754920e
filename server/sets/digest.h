/* digest.h - the digest of a set at one moment. It covers everything that clients can see of the set, except its name and the
 * memory that it takes. Equal sets have equal digests, with any history; different sets have different digests, with a
 * negligible exception (proto/records/hash.h).
 *
 * It covers, in this order:
 *
 *     facts   next id, number of points, whether it is triangulated and temporary, tolerance, when it is dropped, version
 *     rows    id, representative, x, y of every point, by id, DIGEST_ROWS of them at a time
 *     fields  by name: the name, and every page of DT_FIELD_PAGE ids that has a value: the first of these ids, the values
 *     constraints  their number, and a, b, 2 k (+ 1: a border) of each, as sorted by CONSTRAINTS; nothing if there are none
 *
 * The triangulation depends on these alone, so it is not read. The set is read through a view, so edits go on between
 * the pieces, each of which takes about 0.1 ms. */
#pragma once

#include "server/sets/dataset.h"

enum {
    DIGEST_ROWS = 4096,       /* part of what the digest means */
    DIGEST_PAGES = 32,        /* read in a piece, */
    DIGEST_CONSTRAINTS = 2048 /* and constraints, about */
};

struct digest {
    uint64_t value;   /* when all has been read: the digest */
    uint64_t version; /* of the set at the moment */
    uint32_t points;  /* then */
    /* private from here on */
    struct dt_view *view;         /* the caller's, see digest_begin */
    uint32_t next_id, columns;    /* of the set; its rows are a column, too */
    uint32_t from;                /* the next row */
    uint32_t column;              /* that is being read; 0: rows */
    const struct dt_field *field; /* of that column */
    uint64_t page;                /* of it, the next one */
    uint64_t constraints; /* their number then; if there are any, they are the last column */
    uint32_t end;         /* the first id whose constraints have not been read */
};

/* Begins with the set as it is now. On a reactor; no job edits the set in place. The caller ends d->view
 * (version_end_view). False: out of memory, with no view. */
bool digest_begin(struct digest *d, const struct dataset *set);

/* Reads the next piece of dt, the triangulation of the version that was current at the beginning, in the caller's visit.
 * *done: the set has been read. DT_NOMEM: the view cannot be read any more. */
enum dt_status digest_read(struct digest *d, const struct dt *dt, bool *done);

/* The share that has been read, per cent. */
unsigned digest_progress(const struct digest *d);
