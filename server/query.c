/* query.c - see query.h. */
#include "server/query.h"

#include "server/job.h"
#include "server/stream.h"

#include <stdlib.h>

struct query_job {
    struct job job;
    struct query query;
};

/* opt: NULL on the I/O thread. */
static enum dt_status run(const struct dt *dt, struct query *q, const struct dt_options *opt)
{
    switch (q->kind) {
    case QUERY_LISTS:
        return dt_lists_order(dt, q->cw, q->ids.v, q->ids.n, opt, &q->ids.n, &q->interior);
    case QUERY_NEAREST:
        return dt_nearest_place(dt, &q->place, q->k, opt, &q->ids);
    case QUERY_BOX:
        return dt_within_box(dt, q->place.at, q->hi, opt, &q->ids);
    case QUERY_DISC:
        return dt_within_disc(dt, q->place.at, q->radius, opt, &q->ids);
    }
    return DT_OK;
}

/* Writes the reply, rows from version v. */
static void tell(struct answer *a, struct version *v, struct query *q, enum dt_status status)
{
    struct rows rows = {.version = v, .form = ROW_POINT, .from = q->place.at, .cw = q->cw};
    if (status != DT_OK) {
        answer_status(a, status);
        return;
    }
    reply_ok(a->out, q->ids.n);
    if (q->kind == QUERY_LISTS) {
        rows.form = ROW_RING;
        reply_key_u64(a->out, "interior", q->interior);
        reply_key_u64(a->out, "boundary", q->ids.n - q->interior);
    } else if (q->kind == QUERY_NEAREST) {
        rows.form = ROW_NEIGHBOUR;
    }
    reply_end(a->out);
    stream_answer(a, &rows, &q->ids);
}

/* ---- by a worker ---- */

static void run_job(struct job *j)
{
    j->status = run(j->dt, &((struct query_job *)j)->query, &j->options);
}

static void job_done(struct server *s, struct job *j, struct answer *a)
{
    (void)s;
    tell(a, j->base, &((struct query_job *)j)->query, j->status);
}

static void clear_job(struct job *j)
{
    free(((struct query_job *)j)->query.ids.v);
}

static void answer_later(struct server *s, struct answer *a, struct dataset *set, struct query *q)
{
    struct query_job *j = job_new(sizeof *j, run_job, job_done);
    if (j == NULL) {
        free(q->ids.v);
        answer_out_of_memory(a);
        return;
    }
    j->job.clear = clear_job;
    j->job.what = "searching";
    j->query = *q;
    job_read(s, a, &j->job, set->current, JOB_HEAVY);
}

/* ---- at once ---- */

static void answer_now(struct server *s, struct answer *a, struct dataset *set, struct query *q)
{
    bool borrows = q->ids.v == NULL;
    if (borrows) {
        q->ids = s->scratch;
        q->ids.n = 0;
        s->scratch = (struct dt_ids){0};
    }
    enum dt_status status = run(set->current->dt, q, NULL);
    tell(a, set->current, q, status);
    if (borrows)
        s->scratch = q->ids; /* empty if a stream has taken them */
    else
        free(q->ids.v);
}

void query_answer(struct server *s, struct answer *a, struct dataset *set, struct query *q,
                  bool heavy)
{
    if (heavy && s->workers != NULL)
        answer_later(s, a, set, q);
    else
        answer_now(s, a, set, q);
}
