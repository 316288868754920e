/* event_text.c - see event_text.h. */
#include "server/watch/event_text.h"

#include "proto/reply.h"
#include "server/changes/constraint.h"
#include "server/replies/resp3.h"

#include <math.h>
#include <stdlib.h>

enum {
    PART_BYTES = 32 * 1024,
    PART_STEPS = 100000, /* about half a millisecond */
    LOOKED_AT = 10,      /* steps for a point that is not in the event, */
    CONSTRAINT = 100     /* or for a constraint: it is looked up, and so are both its ends */
};

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

static void put_point(struct event *e, uint32_t id, struct dt_point p)
{
    buf_append_text(&e->rows, "point ");
    reply_row_values(&e->rows, id, &p.x, 2);
    for (uint32_t i = 0; i < e->scope->fields; i++) {
        double value = (double)NAN;
        if (e->scope->field[i] != NULL)
            dt_field_values(e->scope->field[i], NULL, &id, 1, &value);
        if (!e->rows.failed)
            reply_more_value(&e->rows, value);
    }
    e->n++;
}

static void put_gone(struct event *e, uint32_t id)
{
    if (e->scope->boxed && !known_has(e->known, id))
        return;
    if (e->scope->boxed)
        buf_append(&e->gone, &id, sizeof id);
    buf_append_text(&e->rows, "gone ");
    reply_row_ids(&e->rows, &id, 1);
    e->n++;
}

void event_put(struct event *e, const struct dt *dt, uint32_t id, enum event_what what)
{
    struct dt_point p;
    if (!scope_has_point(e->scope, dt, id, &p)) {
        e->steps += LOOKED_AT;
        if (what != EVENT_NEW)
            put_gone(e, id);
        return;
    }
    if (e->scope->boxed && !known_add(e->known, id, e->ids))
        e->rows.failed = true;
    if (what != EVENT_RING)
        put_point(e, id, p);
    put_ring(e, dt, id);
}

static void put_constraint(struct event *e, const char *what, const struct dt_constraint *c)
{
    const uint32_t word[] = {c->a, c->b, constraint_what(c->border, c->number)};
    buf_append_text(&e->rows, what);
    reply_row(&e->rows, "iib", word);
    e->n++;
}

static void put_declared(struct event *e, const struct dt_constraint *c,
                         const struct dt_point at[2])
{
    put_constraint(e, "constraint ", c);
    for (int i = 0; e->scope->boxed && i < 2 && !e->rows.failed; i++) {
        reply_more_value(&e->rows, at[i].x);
        reply_more_value(&e->rows, at[i].y);
    }
}

void event_put_constraint(struct event *e, const struct dt *dt, const struct dt_constraint *c,
                          bool moved, bool known)
{
    struct dt_point at[2];
    bool declared = dt_constraint_has(dt, c) && dt_get(dt, c->a, &at[0]) == DT_OK &&
                    dt_get(dt, c->b, &at[1]) == DT_OK;
    e->steps += CONSTRAINT;
    if (moved && !e->scope->boxed) /* the ids are the same */
        return;
    if (declared && scope_has_segment(e->scope, at)) {
        put_declared(e, c, at);
    } else if (known) {
        put_constraint(e, "released ", c);
    }
}

static void begin_head(struct event *e, const char *set)
{
    buf_append_text(&e->head, "EVENT ");
    reply_u64(&e->head, e->n);
    reply_key_text(&e->head, "set", set);
}

void event_head(struct event *e, const char *set, uint64_t version, bool more)
{
    begin_head(e, set);
    reply_key_u64(&e->head, "version", version);
    buf_append_text(&e->head, e->reset ? " reset" : "");
    buf_append_text(&e->head, more ? " more" : "");
    reply_end(&e->head);
}

void event_dropped(struct event *e, const char *set)
{
    begin_head(e, set);
    buf_append_text(&e->head, " dropped");
    reply_end(&e->head);
}

const struct buf *event_text(struct event *e, bool typed)
{
    struct buf *text = &e->text[typed];
    if (e->head.failed || e->rows.failed)
        return NULL;
    if (buf_len(text) == 0 && typed) {
        resp3_push(text, buf_head(&e->head), buf_len(&e->head), buf_head(&e->rows),
                   buf_len(&e->rows), e->n);
    } else if (buf_len(text) == 0) {
        buf_append(text, buf_head(&e->head), buf_len(&e->head));
        buf_append(text, buf_head(&e->rows), buf_len(&e->rows));
    }
    return text->failed ? NULL : text;
}

size_t event_memory(const struct event *e)
{
    return e->head.cap + e->rows.cap + e->text[0].cap + e->text[1].cap + e->gone.cap;
}

void event_free(struct event *e)
{
    buf_free(&e->head);
    buf_free(&e->rows);
    buf_free(&e->text[0]);
    buf_free(&e->text[1]);
    buf_free(&e->gone);
    free(e->ring.v);
    *e = (struct event){.n = 0};
}
