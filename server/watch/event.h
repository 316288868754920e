/* event.h - the text of an event: its rows, and its first line.
 *
 *     EVENT 3 set=t version=17        the rows of what is different now
 *     point 7 1 0.5                   its place; the ring that it had does not count any more
 *     list 7 i 1 2 3                  its ring, as in LISTS
 *     gone 4 */
#ifndef SERVER_EVENT_H
#define SERVER_EVENT_H

#include "core/delaunay.h"
#include "proto/buf.h"

/* Start with {0}. */
struct event {
    struct buf head, rows; /* own */
    size_t n;              /* rows */
    struct dt_ids ring;    /* owns: workspace */
    uint32_t line;         /* so many points are on one line: a ring costs so many steps; else 0 */
    uint64_t steps;        /* of rings on a line so far */
};

/* What is said of an id: that it is gone, its place and its ring; its ring alone; or nothing if it is gone. */
enum event_what { EVENT_ALL, EVENT_RING, EVENT_NEW };

void event_put(struct event *e, const struct dt *dt, uint32_t id, enum event_what what);

/* Whether it is large enough for a part. */
bool event_is_full(const struct event *e);

/* The first line, when all rows are there. */
void event_head(struct event *e, const char *set, uint64_t version, bool reset, bool more);
void event_dropped(struct event *e, const char *set);

void event_free(struct event *e);

#endif
