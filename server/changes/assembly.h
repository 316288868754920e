/* assembly.h - joins the records of a LOAD, which are one change: RECORD_LOAD, points, values of fields, constraints,
 * RECORD_LOADED. */
#pragma once

#include "server/changes/change.h"

struct assembly {
    struct dt_pages *pages;    /* borrows; NULL: the system */
    struct reservation memory; /* of what has been collected; without a budget there is no limit */
    bool begun;                /* a LOAD has begun and is not complete */
    bool skips;                /* it is not wanted: nothing is collected */
    /* private */
    struct change change; /* of RECORD_LOAD; its points */
    size_t points_cap, released_cap, added_cap;
    struct pslg_lists lists; /* constraints */
    struct buf values;       /* owns: doubles, column after column */
    uint32_t first, n;       /* of the first column */
};

enum assembled {
    ASSEMBLY_MORE, /* the record belongs to it, and there are more to come */
    ASSEMBLY_DONE, /* it was the last one: *c is the change, which the caller owns, and `memory` is still reserved for it */
    ASSEMBLY_ENDED,  /* it was the last one of a LOAD that is not wanted */
    ASSEMBLY_NOMEM,  /* nothing has changed: the same record may come again */
    ASSEMBLY_INVALID /* the record cannot follow */
};

/* Takes a record for which change_is_part. */
enum assembled assembly_take(struct assembly *s, const struct record *r, struct change *c);

/* Drops the collected records of a LOAD that is not complete. */
void assembly_clear(struct assembly *s);
