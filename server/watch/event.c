/* event.c - see event.h. */
#include "server/watch/event.h"

#include "proto/reply.h"

#include <stdlib.h>

enum { PART_BYTES = 32 * 1024, PART_STEPS = 100000 /* about half a millisecond */ };

bool event_is_full(const struct event *e)
{
    return buf_len(&e->rows) >= PART_BYTES || e->steps >= PART_STEPS;
}

static void put_ring(struct event *e, const struct dt *dt, uint32_t id)
{
    uint32_t representative;
    bool boundary;
    e->ring.n = 0;
    e->steps += e->line;
    enum dt_status status = dt_ring(dt, id, false, &e->ring, &representative, &boundary);
    if (status == DT_NOMEM)
        e->rows.failed = true;
    if (status != DT_OK || representative != id) /* no triangulation; an alias */
        return;
    buf_append_text(&e->rows, "list ");
    reply_u64(&e->rows, id);
    buf_append_text(&e->rows, boundary ? " b" : " i");
    if (e->ring.n > 0)
        buf_append_char(&e->rows, ' ');
    if (e->ring.n > 0)
        reply_row_ids(&e->rows, e->ring.v, e->ring.n);
    else
        reply_end(&e->rows);
    e->n++;
}

void event_put(struct event *e, const struct dt *dt, uint32_t id, enum event_what what)
{
    struct dt_point p;
    bool there = dt_get(dt, id, &p) == DT_OK;
    if (there && what != EVENT_RING) {
        buf_append_text(&e->rows, "point ");
        reply_row_point(&e->rows, id, p.x, p.y);
        e->n++;
    }
    if (there) {
        put_ring(e, dt, id);
    } else if (what != EVENT_NEW) {
        buf_append_text(&e->rows, "gone ");
        reply_row_ids(&e->rows, &id, 1);
        e->n++;
    }
}

static void begin_head(struct event *e, const char *set)
{
    buf_append_text(&e->head, "EVENT ");
    reply_u64(&e->head, e->n);
    reply_key_text(&e->head, "set", set);
}

void event_head(struct event *e, const char *set, uint64_t version, bool reset, bool more)
{
    begin_head(e, set);
    reply_key_u64(&e->head, "version", version);
    buf_append_text(&e->head, reset ? " reset" : "");
    buf_append_text(&e->head, more ? " more" : "");
    reply_end(&e->head);
}

void event_dropped(struct event *e, const char *set)
{
    begin_head(e, set);
    buf_append_text(&e->head, " dropped");
    reply_end(&e->head);
}

void event_free(struct event *e)
{
    buf_free(&e->head);
    buf_free(&e->rows);
    free(e->ring.v);
}
