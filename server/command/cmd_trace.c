/* cmd_trace.c - TRACE: the steps of the paper's algorithm, a row each.
 *
 * All rows are made before the first one is sent, because their number comes first. That is why the number of
 * points is limited: the rows of a thousand uniform points take about 350 KB. */
#include "server/command/command.h"

#include "proto/number.h"
#include "server/jobs/job.h"
#include "server/ops/limits.h"

#include <math.h>

enum { TRACE_AT_ONCE = 50 }; /* points up to which a reactor does it */

struct trace {
    struct job job;
    struct buf rows;
    uint64_t count;
};

/* The kinds of rows: a name, then a number of ids. */
static const struct {
    const char *name;
    unsigned ids;
} kinds[] = {
    [DT_EVENT_GRID] = {"grid", 0},     [DT_EVENT_START] = {"start", 2},
    [DT_EVENT_SEARCH] = {"search", 2}, [DT_EVENT_FIRST] = {"first", 3},
    [DT_EVENT_POINT] = {"point", 3},   [DT_EVENT_RIGHT] = {"right", 3},
    [DT_EVENT_LEFT] = {"left", 3},     [DT_EVENT_CAVE] = {"cave", 3},
    [DT_EVENT_BORDER] = {"border", 2}, [DT_EVENT_REMOVE] = {"remove", 1},
    [DT_EVENT_HULL] = {"hull", 1},
};

static void append_id(struct buf *out, uint32_t id)
{
    buf_append_char(out, ' ');
    reply_u64(out, id);
}

static void append_number(struct buf *out, double v)
{
    char *to = buf_reserve(out, 1 + PROTO_NUMBER_MAX);
    if (to == NULL)
        return;
    to[0] = ' ';
    buf_commit(out, 1 + proto_write_double(to + 1, v));
}

static void see(void *ctx, const struct dt_event *e)
{
    struct trace *t = ctx;
    const uint32_t id[] = {e->a, e->b, e->c};
    buf_append_text(&t->rows, kinds[e->kind].name);
    for (unsigned i = 0; i < kinds[e->kind].ids; i++)
        append_id(&t->rows, id[i]);
    if (e->kind == DT_EVENT_GRID || (e->kind == DT_EVENT_SEARCH && e->size < HUGE_VAL)) {
        append_number(&t->rows, e->p.x);
        append_number(&t->rows, e->p.y);
        append_number(&t->rows, e->size);
    }
    if (e->kind == DT_EVENT_GRID) {
        append_id(&t->rows, e->a);
        append_id(&t->rows, e->b);
    }
    buf_append_char(&t->rows, '\n');
    t->count++;
}

static void run(struct job *j)
{
    struct trace *t = (struct trace *)j;
    j->status = dt_trace(j->dt, &j->options, &(struct dt_observer){see, t});
    if (t->rows.failed)
        j->status = DT_NOMEM;
}

static void end(struct server *s, struct job *j, struct answer *a)
{
    struct trace *t = (struct trace *)j;
    if (job_succeeded(j, a)) {
        reply_ok(a->out, t->count);
        reply_end(a->out);
        buf_append(a->out, buf_head(&t->rows), buf_len(&t->rows));
    }
    buf_free(&t->rows);
}

void cmd_trace(struct server *s, struct dataset *set, const struct request *q, struct answer *a)
{
    if (set->current->sum.points > LIMIT_TRACE_POINTS) {
        answer_err(a, ERR_TOOBIG, "TRACE is for sets of at most %d points", LIMIT_TRACE_POINTS);
        return;
    }
    bool light = set->current->sum.points <= TRACE_AT_ONCE;
    struct trace *t = job_new_reading(s, a, sizeof *t, run, end, "tracing", NULL);
    if (t != NULL)
        job_read(s, a, &t->job, set->current, light ? JOB_LIGHT : JOB_SHORT);
}
