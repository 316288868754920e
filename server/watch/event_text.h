/* event_text.h - the text of an event: its rows, and its first line.
 *
 *     EVENT 3 set=t version=17        the rows of what is different now
 *     point 7 1 0.5                   its place, and values; the ring that it had does not count any more
 *     list 7 i 1 2 3                  its ring, as in LISTS
 *     gone 4
 *     constraint 3 7 line 0           it is declared; with a box, and the places of 3 and of 7
 *     released 3 4 border 1 */
#pragma once

#include "core/delaunay_constraints.h"
#include "proto/buf.h"
#include "server/watch/known.h"
#include "server/watch/scope.h"

/* Start with {0} and who it is for. */
struct event {
    const struct scope *scope; /* borrows; its fields have been found */
    struct known *known;   /* borrows; with a box: all points that one of its readers may know */
    uint32_t ids;          /* of the set, the next one */
    uint32_t line;         /* so many points are on one line: a ring costs so many steps; else 0 */
    bool reset;            /* it begins one */
    uint64_t lsn;          /* it is sent when that is durable */
    struct buf head, rows; /* own */
    struct buf text[2];    /* own: both, in lines and in RESP 3, once they have been asked for */
    struct buf gone;       /* owns: ids in `known` of which it says so, an uint32_t each */
    size_t n;              /* rows */
    struct dt_ids ring;    /* owns: workspace */
    uint64_t steps;        /* of rings on a line, of ids that have no row, and of constraints */
};

/* The statement about an id: that it is gone, or its place and its ring; its ring alone; no statement if it is gone. */
enum event_what { EVENT_ALL, EVENT_RING, EVENT_NEW };

void event_put(struct event *e, const struct dt *dt, uint32_t id, enum event_what what);

/* Says of a constraint that it is declared, or released if it is not, or does not meet the box. `moved`: only that an end has moved;
 * `known`: a reader may know it. */
void event_put_constraint(struct event *e, const struct dt *dt, const struct dt_constraint *c,
                          bool moved, bool known);

/* Whether it is large enough for a part, or has taken so long. */
bool event_is_full(const struct event *e);

/* Writes the first line, when all rows have been written. */
void event_head(struct event *e, const char *set, uint64_t version, bool more);
void event_dropped(struct event *e, const char *set);

/* Returns the bytes for connections; typed: as a push of RESP 3. NULL: out of memory. The event lends them to the caller. */
const struct buf *event_text(struct event *e, bool typed);

size_t event_memory(const struct event *e);
void event_free(struct event *e); /* it is {0} then */
