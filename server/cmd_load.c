/* cmd_load.c - LOAD and LOADB. The points are collected as they arrive and added all at once at the
 * end, so that a load is all or nothing and nobody sees half of one. */
#include "server/cmd_load.h"

#include "proto/number.h"
#include "server/command.h"
#include "server/durable.h"
#include "server/edit.h"
#include "server/journal.h"
#include "server/keep.h"

#include <stdlib.h>
#include <string.h>

enum {
    MANY = 1 << 17,        /* points for which pages are made ready as they arrive */
    BYTES_PER_POINT = 120, /* what they take until they are triangulated, at the peak */
    BYTES_WHEN_ADDED = 84  /* of these, when they have been added */
};

_Static_assert(sizeof(struct dt_point) == 2 * sizeof(double), "a body's x, y pairs are points");

/* ---- the commands: they only prepare for what follows ---- */

static void *grow_points(void *ctx, void *p, size_t used, size_t bytes)
{
    struct load *l = ctx;
    struct server *s = l->server;
    size_t before = l->memory.bytes;
    if (!reservation_resize(&l->memory, bytes)) {
        l->shortage = budget_could_fit(&s->budget, bytes) ? ERR_BUSY : ERR_NOMEM;
        return NULL;
    }
    void *larger = dt_pages_grow(s->pages, p, used, bytes);
    if (larger == NULL)
        reservation_set(&l->memory, before);
    keep_account(s);
    return larger;
}

static void start(struct server *s, struct answer *a, enum body_form form, uint32_t count)
{
    struct load *l = calloc(1, sizeof *l);
    if (l == NULL) {
        answer_out_of_memory(a);
        a->next = ANSWER_CLOSING; /* what follows could not be told from requests */
        return;
    }
    body_init(&l->body, form, count, s->config->max_points, dt_coordinate_ok);
    l->body.memory = (struct body_memory){grow_points, dt_pages_release, l};
    l->server = s;
    l->memory = server_reservation(s, BUDGET_LOADS);
    l->shortage = ERR_NOMEM;
    a->next = ANSWER_BODY;
    a->load = l;
}

static void keep_name(struct load *l, const struct word *name)
{
    l->name_len = name->len;
    memcpy(l->name, name->text, l->name_len);
}

static void start_counted(struct server *s, const struct request *q, struct answer *a,
                          enum body_form form)
{
    uint32_t count;
    if (proto_read_u32(q->word[2].text, q->word[2].len, &count)) {
        start(s, a, form, count);
        if (a->next == ANSWER_BODY)
            keep_name(a->load, &q->word[1]);
        return;
    }
    reply_err(a->out, ERR_NUMBER, "%.*s does not tell how much follows", QUOTED(&q->word[2]));
    a->next = ANSWER_CLOSING;
}

void cmd_load(struct server *s, struct dataset *set, const struct request *q, struct answer *a)
{
    (void)set;
    if (q->n != 2) {
        start_counted(s, q, a, BODY_LINES);
        return;
    }
    start(s, a, BODY_DOT, 0);
    if (a->next == ANSWER_BODY)
        keep_name(a->load, &q->word[1]);
}

void cmd_loadb(struct server *s, struct dataset *set, const struct request *q, struct answer *a)
{
    (void)set;
    start_counted(s, q, a, BODY_BINARY);
}

void load_skip(struct server *s, const struct request *q, struct answer *a)
{
    bool binary = word_is(&q->word[0], "LOADB"), dot = !binary && q->n == 2;
    uint32_t count = 0;
    /* Those who have shown no token may not keep the server reading. */
    if (a->role == ROLE_NONE || (!dot && q->n != 3) ||
        (!dot && !proto_read_u32(q->word[2].text, q->word[2].len, &count))) {
        a->next = ANSWER_CLOSING;
        return;
    }
    start(s, a, binary ? BODY_BINARY : dot ? BODY_DOT : BODY_LINES, count);
    if (a->next != ANSWER_BODY)
        return;
    a->load->refused = true;
    body_fail(&a->load->body, BODY_SYNTAX); /* so that no point is kept */
}

/* ---- the body ---- */

/* Tells what the points that have come will take when they are added and triangulated. */
static void expect(struct server *s, struct load *l)
{
    size_t expected = l->body.n < MANY ? 0 : l->body.n * BYTES_PER_POINT;
    if (expected == l->expected)
        return;
    keep_expect(s, expected, l->expected);
    l->expected = expected;
}

ptrdiff_t load_feed(struct server *s, struct load *l, const char *bytes, size_t n, bool last)
{
    ptrdiff_t took = body_feed(&l->body, bytes, n, last);
    l->came += took > 0 ? (uint64_t)took : 0;
    if (l->body.fault != BODY_GOOD)
        reservation_set(&l->memory, 0);
    expect(s, l);
    return took;
}

bool load_stalls(struct load *l, int64_t now_ms)
{
    enum {
        SHARE = 1024
    }; /* of its memory has to come: a client cannot hold much by sending little */
    int64_t limit_ms = (int64_t)l->server->config->load_timeout_s * 1000;
    if (l->seen_ms == 0 || l->came - l->seen > l->memory.bytes / SHARE) {
        l->seen = l->came;
        l->seen_ms = now_ms;
    }
    return limit_ms > 0 && now_ms - l->seen_ms >= limit_ms;
}

void load_free(struct server *s, struct load *l)
{
    bool reserved = l->memory.bytes > 0;
    keep_expect(s, 0, l->expected);
    body_free(&l->body);
    reservation_set(&l->memory, 0);
    if (reserved)
        server_reserved_less(s);
    free(l);
}

/* ---- the end ---- */

static void tell_fault(struct server *s, const struct load *l, struct answer *a)
{
    const struct body *b = &l->body;
    const char *unit = b->form == BODY_BINARY ? "point" : "line";
    unsigned long long line = b->fault_line;
    switch (b->fault) {
    case BODY_GOOD:
        break;
    case BODY_SYNTAX:
        reply_err(a->out, ERR_SYNTAX, "%s %llu: not `x y`; nothing was loaded", unit, line);
        break;
    case BODY_ENDED:
        reply_err(a->out, ERR_SYNTAX, "%s %llu: the input ended too early; nothing was loaded",
                  unit, line);
        break;
    case BODY_LONGER:
        reply_err(a->out, ERR_SYNTAX, "more than %llu %ss; nothing was loaded", line, unit);
        break;
    case BODY_NUMBER:
        reply_err(a->out, ERR_NUMBER, "%s %llu: not a number; nothing was loaded", unit, line);
        break;
    case BODY_RANGE:
        reply_err(a->out, ERR_RANGE,
                  "%s %llu: a coordinate is 0 or has a magnitude from 2^-142 to 2^201; nothing was "
                  "loaded",
                  unit, line);
        break;
    case BODY_TOOBIG:
        reply_err(a->out, ERR_TOOBIG,
                  "%s %llu: a set holds at most %u points (--max-points); nothing was loaded", unit,
                  line, s->config->max_points);
        break;
    case BODY_NOMEM:
        reply_err(a->out, l->shortage, "%s %llu: out of memory; nothing was loaded", unit, line);
        break;
    }
}

/* What they are still going to take when they have been added. */
static size_t hand_on_expected(struct server *s, struct load *l)
{
    size_t rest = l->expected / BYTES_PER_POINT * BYTES_WHEN_ADDED;
    keep_expect(s, rest, l->expected);
    l->expected = 0;
    return rest;
}

/* Adds the points, if there is memory for them; else they stay. */
static void add_points(struct server *s, struct load *l, struct answer *a,
                       const struct dataset *set)
{
    struct word name = {l->name, l->name_len};
    struct arrival points = {.n = l->body.n};
    if (!edit_may_add(s, a, set, points.n, &points.memory))
        return;
    points.p = (struct dt_point *)(void *)l->body.xy;
    points.expected = hand_on_expected(s, l);
    l->body.xy = NULL;
    reservation_move(&points.memory, &l->memory);
    edit_add(s, a, &name, &points);
}

void load_commit(struct server *s, struct load *l, struct answer *a)
{
    struct word name = {l->name, l->name_len};
    struct dataset *set = registry_find(&s->sets, &name);
    if (l->refused)
        return;
    if (l->body.fault != BODY_GOOD)
        tell_fault(s, l, a);
    if (l->body.fault != BODY_GOOD || !durable_admits(s, a, set, true, false))
        return;
    a->lsn = journal_of(s, set);
    if (set != NULL && !dataset_admits(set, true, a->turn))
        answer_wait(a, &set->queue, true);
    else
        add_points(s, l, a, set);
}
