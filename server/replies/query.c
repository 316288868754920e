/* query.c - see query.h. */
#include "server/replies/query.h"

#include "core/delaunay_constraints.h"
#include "server/jobs/job.h"
#include "server/ops/cost.h"
#include "server/rows/answer_rows.h"
#include "server/rows/constraint_rows.h"

#include <stdlib.h>

enum {
    STEPS_A_VISIT = 20000,  /* steps of a worker in one visit, */
    SHARE_A_VISIT = 64,     /* or the number of points divided by this, if that is more */
    SWEEP_ROWS = 4096,      /* rows that a sweep reads in one visit, */
    CONSTRAINT_STEPS = 2048 /* or constraints, about */
};

struct query_job {
    struct job job;
    struct query query;
    uint32_t steps; /* limit of the search in one visit; 0: none */
    /* owns, until it moves to a stream: the moment of the result. That of the job is open for longer: so edits keep the triangulation */
    struct dt_view *view;
};

/* ---- searching ---- */

/* Applies the limit on steps to searches of the core that have no limit of their own. */
static enum dt_status check_degree(const struct dt *dt, const struct query *q, uint32_t steps)
{
    uint32_t least = steps;
    for (unsigned i = 0; i < q->corners && i < 2; i++) { /* the smaller of two stars counts */
        uint32_t degree = dt_degree_up_to(dt, q->corner[i], least);
        least = degree < least ? degree : least;
    }
    return steps > 0 && least >= steps ? DT_TOOLONG : DT_OK;
}

static enum dt_status find_triangles(const struct dt *dt, struct query *q)
{
    const uint32_t *id = q->corner;
    switch (q->corners) {
    case 1:
        return dt_triangles_at_point(dt, id[0], q->cw, &q->ids);
    case 2:
        return dt_triangles_at_edge(dt, id[0], id[1], q->cw, &q->ids);
    default:
        return dt_triangles_at_triangle(dt, id[0], id[1], id[2], q->cw, &q->ids);
    }
}

/* The edges to the neighbours of a point, a < b each, in the order of its ring. */
static enum dt_status find_edges(const struct dt *dt, struct query *q)
{
    struct dt_ids *ids = &q->ids;
    uint32_t rep;
    bool boundary;
    enum dt_status status = dt_ring(dt, q->corner[0], q->cw, ids, &rep, &boundary);
    if (status != DT_OK)
        return status;
    size_t n = ids->n;
    uint32_t *v = realloc(ids->v, (2 * n + 1) * sizeof *v);
    if (v == NULL)
        return DT_NOMEM;
    for (size_t i = n; i-- > 0;) { /* from the end, so that nothing is overwritten unread */
        uint32_t other = v[i];
        v[2 * i] = rep < other ? rep : other;
        v[2 * i + 1] = rep < other ? other : rep;
    }
    *ids = (struct dt_ids){v, 2 * n, 2 * n + 1};
    return DT_OK;
}

/* The rings of a few points are written at once, so they must not be long. */
static enum dt_status order_lists(const struct dt *dt, struct query *q,
                                  const struct dt_options *opt)
{
    uint32_t left = opt->steps;
    for (size_t i = 0; opt->steps > 0 && i < q->ids.n; i++) {
        uint32_t degree = dt_degree_up_to(dt, q->ids.v[i], left);
        if (degree >= left)
            return DT_TOOLONG;
        left -= degree;
    }
    return dt_lists_order(dt, q->cw, q->ids.v, q->ids.n, opt, &q->ids.n, &q->interior);
}

/* The words of the rows in binary; degrees have been looked at before. */
static uint64_t list_words(const struct dt *dt, const struct dt_ids *ids)
{
    uint64_t words = 0;
    for (size_t i = 0; i < ids->n; i++)
        words += 2 + (uint64_t)dt_degree_up_to(dt, ids->v[i], DT_NONE);
    return words;
}

static enum dt_status find_within(const struct dt *dt, struct query *q,
                                  const struct dt_options *opt)
{
    enum dt_status status;
    if (q->kind == QUERY_TRIANGLES) {
        status = dt_within_triangles(dt, q->place.at, q->hi, q->cw, opt, &q->ids);
        q->words = q->ids.n;
        return status;
    }
    status = dt_within_box(dt, q->place.at, q->hi, opt, &q->ids);
    if (status == DT_OK)
        status = order_lists(dt, q, opt);
    if (status != DT_OK)
        q->ids.n = 0;
    else if (q->binary)
        q->words = list_words(dt, &q->ids);
    return status;
}

/* Computes the weights as rows of the result; the set is not needed for that. */
static enum dt_status finish_weights(struct dt_weigher *w, const struct dt_options *opt,
                                     struct dt_ids *ids)
{
    struct dt_weight *row;
    size_t n;
    enum dt_status status = dt_weights_end(w, opt, &row, &n);
    uint32_t *v = status == DT_OK ? realloc(ids->v, (n + 1) * ROW_VALUE_WORDS * sizeof *v) : NULL;
    if (status == DT_OK && v == NULL)
        status = DT_NOMEM;
    if (v != NULL)
        *ids = (struct dt_ids){v, n * ROW_VALUE_WORDS, (n + 1) * ROW_VALUE_WORDS};
    for (size_t i = 0; status == DT_OK && i < n; i++)
        row_value_put(v + i * ROW_VALUE_WORDS, row[i].id, row[i].weight);
    free(row);
    return status;
}

static enum dt_status find_weights(const struct dt *dt, struct query *q,
                                   const struct dt_options *opt)
{
    struct dt_weigher *w;
    enum dt_status status = dt_weights_begin(dt, q->place.at, q->how, opt, &w);
    if (status == DT_OK)
        status = finish_weights(w, opt, &q->ids);
    dt_weights_free(w);
    return status;
}

/* All constraints, or those of a number, at once. */
static enum dt_status find_all_constraints(const struct dt *dt, struct query *q,
                                           const struct dt_options *opt)
{
    uint32_t from = 0;
    if (opt->steps > 0 && dt_constraints_count(dt) > opt->steps)
        return DT_TOOLONG;
    return constraint_rows_read(dt, NULL, q->numbered ? q->k : DT_NONE, &from, SIZE_MAX, &q->ids);
}

static enum dt_status find_constraints(const struct dt *dt, struct query *q,
                                       const struct dt_options *opt)
{
    enum dt_status status = q->kind == QUERY_CONSTRAINED ? constraint_edges(dt, opt, &q->ids)
                            : q->ended                   ? constraint_rows_at(dt, opt, &q->ids)
                                                         : find_all_constraints(dt, q, opt);
    q->words = q->ids.n;
    return status;
}

/* DT_TOOLONG leaves the query unchanged. */
static enum dt_status search(const struct dt *dt, struct query *q, const struct dt_options *opt)
{
    enum dt_status status = DT_OK;
    if (q->within)
        return find_within(dt, q, opt);
    switch (q->kind) {
    case QUERY_LISTS:
        return order_lists(dt, q, opt);
    case QUERY_TRIANGLES:
        status = check_degree(dt, q, opt->steps);
        return status == DT_OK ? find_triangles(dt, q) : status;
    case QUERY_EDGES:
        status = check_degree(dt, q, opt->steps);
        return status == DT_OK ? find_edges(dt, q) : status;
    case QUERY_NEAREST:
        return dt_nearest_place(dt, &q->place, q->k, opt, &q->ids);
    case QUERY_BOX:
        return dt_within_box(dt, q->place.at, q->hi, opt, &q->ids);
    case QUERY_DISC:
        return dt_within_disc(dt, q->place.at, q->radius, opt, &q->ids);
    case QUERY_WEIGHTS:
        return find_weights(dt, q, opt);
    case QUERY_CONSTRAINTS:
    case QUERY_CONSTRAINED:
        return find_constraints(dt, q, opt);
    }
    return status;
}

/* ---- the reply ---- */

static inline struct rows rows_of(const struct query *q, struct version *v)
{
    static const struct {
        enum row_form form;
        size_t width;
        const char *format;
    } of[] = {[QUERY_LISTS] = {ROW_RING, 1, NULL},
              [QUERY_TRIANGLES] = {ROW_IDS, 3, NULL},
              [QUERY_EDGES] = {ROW_IDS, 2, NULL},
              [QUERY_NEAREST] = {ROW_NEIGHBOUR, 1, NULL},
              [QUERY_BOX] = {ROW_POINT, 1, NULL},
              [QUERY_DISC] = {ROW_POINT, 1, NULL},
              [QUERY_WEIGHTS] = {ROW_WORDS, ROW_VALUE_WORDS, ROW_VALUE},
              [QUERY_CONSTRAINTS] = {ROW_WORDS, ROW_CONSTRAINT_WORDS, ROW_CONSTRAINT},
              [QUERY_CONSTRAINED] = {ROW_IDS, 2, NULL}};
    struct rows rows = {.version = v,
                        .form = of[q->kind].form,
                        .width = of[q->kind].width,
                        .format = of[q->kind].format,
                        .from = q->place.at,
                        .cw = q->cw,
                        .binary = q->binary};
    return rows;
}

/* Writes the reply; *rows are those of the result. */
static inline void answer(struct server *s, struct answer *a, struct query *q, struct rows *rows)
{
    size_t n = q->ids.n / rows->width;
    reply_ok(a->out, q->binary ? 0 : n);
    if (q->kind == QUERY_LISTS) {
        reply_key_u64(a->out, "interior", q->interior);
        reply_key_u64(a->out, "boundary", q->ids.n - q->interior);
    } else if (q->binary) {
        reply_key_u64(a->out, "rows", n);
    }
    if (q->binary)
        reply_key_u64(a->out, "bytes", q->words * sizeof(uint32_t));
    reply_end(a->out);
    answer_rows(s, a, rows, &q->ids);
}

/* ---- by a worker ---- */

/* Reserves the memory of the result after the next piece. */
static enum dt_status reserve_result(struct query_job *j, const struct dt_sweep *sweep)
{
    return job_reserve(&j->job, dt_sweep_memory(sweep, &j->query.ids));
}

/* Finds the result by a sweep over the set at the moment of j->view. A worker is a visitor on entry and on return,
 * but not between the pieces. */
static enum dt_status sweep(struct query_job *j)
{
    struct version *v = j->job.base;
    struct query *q = &j->query;
    struct dt_sweep sweep = {.kind = q->kind == QUERY_NEAREST ? DT_SWEEP_NEAREST
                                     : q->kind == QUERY_BOX   ? DT_SWEEP_BOX
                                                              : DT_SWEEP_DISC,
                             .at = q->place.at,
                             .hi = q->hi,
                             .radius = q->radius,
                             .k = q->k};
    enum dt_status status = DT_OK;
    for (bool done = false; !done && status == DT_OK;) {
        status = dt_sweep_read(v->dt, j->view, &sweep, SWEEP_ROWS);
        job_end_visit(&j->job);
        if (status == DT_OK)
            status = reserve_result(j, &sweep);
        if (status == DT_OK)
            status = dt_sweep_sift(&sweep, &q->ids, &done);
        if (status == DT_OK && atomic_load(&j->job.cancel))
            status = DT_CANCELLED;
        job_visit(&j->job);
    }
    if (status == DT_OK)
        status = reserve_result(j, &sweep);
    if (status == DT_OK)
        status = dt_sweep_end(&sweep, &j->job.options, &q->ids);
    dt_sweep_clear(&sweep);
    return status;
}

/* The same for rows of tables in a box. */
static enum dt_status sift(struct query_job *j)
{
    struct version *v = j->job.base;
    bool done = false;
    struct query *q = &j->query;
    struct dt_sift sift = {.lo = q->place.at, .hi = q->hi};
    enum dt_status status = dt_table_begin(
        v->dt, j->view, q->kind == QUERY_LISTS ? DT_LISTS : DT_TRIANGLES, q->cw, &sift.cursor);
    while (status == DT_OK && !done) {
        size_t more = q->ids.cap + 2 * (q->ids.n + 3 * SWEEP_ROWS);
        status = job_reserve(&j->job, more * sizeof(uint32_t));
        if (status == DT_OK)
            status = dt_sift_read(v->dt, &sift, SWEEP_ROWS, &q->ids, &done);
        status = job_pause(&j->job, status);
    }
    q->interior = sift.interior;
    q->words = sift.words;
    return status;
}

/* The same for constraints. */
static enum dt_status read_constraints(struct query_job *j)
{
    struct version *v = j->job.base;
    struct query *q = &j->query;
    uint32_t from = 0, number = q->numbered ? q->k : DT_NONE;
    enum dt_status status = DT_OK;
    while (status == DT_OK && from != DT_NONE) {
        size_t words = q->ids.n + ROW_CONSTRAINT_WORDS * CONSTRAINT_STEPS;
        status = job_reserve(&j->job, (words + words / 2) * sizeof(uint32_t));
        if (status == DT_OK)
            status = constraint_rows_read(v->dt, j->view, number, &from, CONSTRAINT_STEPS, &q->ids);
        status = job_pause(&j->job, status);
    }
    q->words = q->ids.n;
    return status;
}

/* Computes the weights within a limit, or exactly, if there is memory for that. */
static enum dt_status weigh_reserved(struct query_job *j, struct dt_weigher *w, bool exact)
{
    struct dt_options opt = j->job.options;
    opt.steps = exact ? 0 : COST_STEPS_AT_ONCE;
    enum dt_status status = job_reserve(&j->job, dt_weights_memory(w, exact));
    return status == DT_OK ? finish_weights(w, &opt, &j->query.ids) : status;
}

/* The weights of many natural neighbours take long: a worker computes them while edits continue. It is a
 * visitor on entry and on return. */
static enum dt_status weigh(struct query_job *j)
{
    struct version *v = j->job.base;
    struct dt_weigher *w;
    enum dt_status status =
        dt_weights_begin(v->dt, j->query.place.at, j->query.how, &j->job.options, &w);
    job_end_visit(&j->job);
    if (status == DT_OK)
        status = weigh_reserved(j, w, false);
    if (status == DT_TOOLONG)
        status = weigh_reserved(j, w, true);
    dt_weights_free(w);
    job_visit(&j->job);
    return status;
}

static bool may_sweep(const struct query *q)
{
    return q->kind == QUERY_NEAREST || q->kind == QUERY_BOX || q->kind == QUERY_DISC;
}

static void run_job(struct job *job)
{
    struct query_job *j = (struct query_job *)job;
    struct dt_options opt = job->options;
    opt.steps = j->steps;
    enum row_form form = rows_of(&j->query, job->base).form;
    if (j->query.kind == QUERY_WEIGHTS) {
        job->status = weigh(j);
        return;
    }
    bool lists = j->query.kind == QUERY_CONSTRAINTS && !j->query.ended;
    bool reads = !row_is_of_list(form) || j->query.within || lists; /* in pieces, or later */
    if (reads)
        j->view = dt_view_begin(job->dt, j->query.kind == QUERY_LISTS || j->query.within);
    if (reads && j->view == NULL)
        job->status = DT_NOMEM;
    else
        job->status = lists ? read_constraints(j) : search(job->dt, &j->query, &opt);
    if (job->status == DT_TOOLONG && j->query.within)
        job->status = sift(j);
    else if (job->status == DT_TOOLONG ||
             (job->status == DT_UNTRIANGULATED && may_sweep(&j->query)))
        job->status = sweep(j);
}

static void end_job(struct server *s, struct job *job, struct answer *a)
{
    struct query_job *j = (struct query_job *)job;
    struct rows rows = rows_of(&j->query, job->base);
    bool found = job_succeeded(job, a);
    rows.heavy = found && job->queued_ns > 0;
    if (rows.heavy)
        rows.view = j->view;
    else if (j->view != NULL) /* the set has not changed since */
        version_end_view(&s->sets, job->base, j->view);
    if (found)
        answer(s, a, &j->query, &rows);
    free(j->query.ids.v);
}

/* The limit on steps of a worker's search in one visit. */
static uint32_t steps_a_visit(uint32_t points)
{
    uint32_t share = points / SHARE_A_VISIT;
    return share > STEPS_A_VISIT ? share : STEPS_A_VISIT;
}

/* Submits the query to a worker; a sweep over a small set runs on this thread. */
static void answer_by_job(struct server *s, struct answer *a, struct dataset *set, struct query *q)
{
    struct version *v = set->current;
    bool sweeps = !v->sum.triangulated, light = sweeps && cost_at_once(COST_SWEEP, v->sum.points);
    struct query_job *j = job_new_reading(s, a, sizeof *j, run_job, end_job, "searching", NULL);
    if (j == NULL) {
        free(q->ids.v);
        return;
    }
    j->query = *q;
    if (!sweeps && !job_begin_view(s, a, &j->job, v, true))
        return;
    j->steps = may_sweep(q) || q->within ? steps_a_visit(v->sum.points) : 0;
    job_read(s, a, &j->job, v, light ? JOB_LIGHT : q->kind == QUERY_WEIGHTS ? JOB_SLOW : JOB_SHORT);
}

/* ---- at once ---- */

void query_answer(struct server *s, struct answer *a, struct dataset *set, struct query *q)
{
    struct dt_options opt = {.steps = s->workers != NULL ? COST_STEPS_AT_ONCE : 0};
    struct dt_ids *scratch = &a->reactor->scratch;
    bool borrows = q->ids.v == NULL;
    if (!set->current->sum.triangulated && q->kind != QUERY_CONSTRAINTS) {
        answer_by_job(s, a, set, q);
        return;
    }
    if (borrows) {
        q->ids = *scratch;
        q->ids.n = 0;
        *scratch = (struct dt_ids){0};
    }
    enum dt_status status = search(set->current->dt, q, &opt);
    if (status == DT_TOOLONG) {
        if (borrows) {
            *scratch = q->ids;
            q->ids = (struct dt_ids){0};
        }
        answer_by_job(s, a, set, q);
        return;
    }
    if (status == DT_OK) {
        struct rows rows = rows_of(q, set->current);
        answer(s, a, q, &rows);
    } else {
        answer_status(a, status);
    }
    if (borrows)
        *scratch = q->ids; /* empty if they have moved to a stream */
    else
        free(q->ids.v);
}
