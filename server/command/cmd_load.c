/* cmd_load.c - LOAD and LOADB. The points are collected as they arrive and added all at once at the
 * end, so that a load is all or nothing and nobody sees half of one. */
#include "server/command/load.h"

#include "proto/number.h"
#include "server/command/command.h"
#include "server/jobs/durable.h"
#include "server/jobs/edit.h"
#include "server/jobs/journal.h"
#include "server/jobs/rebuild.h"

#include <stdlib.h>
#include <string.h>

_Static_assert(sizeof(struct dt_point) == 2 * sizeof(double), "a body's x, y pairs are points");

/* ---- the commands: they only prepare for what follows ---- */

static void start_counted(struct server *s, const struct request *q, struct answer *a,
                          enum body_form form)
{
    uint32_t count;
    if (proto_read_u32(q->word[2].text, q->word[2].len, &count)) {
        load_start(s, a, &q->word[1], form, count);
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
    load_start(s, a, &q->word[1], BODY_DOT, 0);
}

void cmd_loadb(struct server *s, struct dataset *set, const struct request *q, struct answer *a)
{
    (void)set;
    start_counted(s, q, a, BODY_BINARY);
}

/* ---- when the points have come ---- */

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

/* Adds the points, if there is memory for them; else they stay. */
static void add_points(struct server *s, struct load *l, struct answer *a,
                       const struct dataset *set)
{
    struct word name = {l->name, l->name_len};
    struct arrival points = {.n = l->body.n};
    if (!edit_may_add(s, a, set, points.n, &points.memory))
        return;
    points.p = (struct dt_point *)(void *)l->body.xy;
    points.expected = load_hand_on_expected(s, l);
    l->body.xy = NULL;
    reservation_move(&points.memory, &l->memory);
    edit_add(s, a, &name, &points);
}

static void commit(struct server *s, struct load *l, struct answer *a, struct dataset *set)
{
    a->lsn = journal_of(s, set);
    if (set != NULL && !dataset_admits(set, true, a->turn))
        answer_wait(a, &set->queue, true);
    else
        add_points(s, l, a, set);
}

void load_commit(struct server *s, struct load *l, struct answer *a)
{
    struct word name = {l->name, l->name_len};
    struct dataset *set = registry_find(&s->sets, &name);
    if (l->refused)
        return;
    if (l->body.fault != BODY_GOOD)
        tell_fault(s, l, a);
    else if (set != NULL && set->loading)
        rebuild_refuse(s, a, set);
    else if (durable_admits_change(s, a, false))
        commit(s, l, a, set);
}
