/* regions.c - see regions.h. */
#include "server/replies/regions.h"

#include "core/delaunay_constraints.h"
#include "server/jobs/job.h"
#include "server/jobs/upkeep.h"
#include "server/ops/cost.h"
#include "server/rows/answer_rows.h"

#include <stdlib.h>

enum { STEPS_PLACE = 20 }; /* that finding a place takes, about */

bool regions_ready(struct server *s, struct answer *a, struct dataset *set, struct inside inside)
{
    return upkeep_survey(s, a, set) && regions_check(a, set->current->dt, inside);
}

bool regions_check(struct answer *a, const struct dt *t, struct inside inside)
{
    if (!dt_has_borders(t))
        return answer_err(a, ERR_NOREGION, "the set has no borders");
    return answer_region(a, dt_region_check(t, inside.number), inside.number);
}

/* ---- LOCATE ---- */

/* inside: at least one border has the place inside. */
static enum dt_status find_region(const struct dt *t, struct dt_point at,
                                  const struct dt_options *opt, const char **region)
{
    struct dt_ids in = {0}, on = {0};
    enum dt_status status = dt_regions_at(t, at, opt, &in, &on);
    *region = in.n > 0 ? "inside" : on.n > 0 ? "border" : "outside";
    free(in.v);
    free(on.v);
    return status;
}

/* region: NULL, the set has no borders. */
static void write_location(struct answer *a, const struct dt_location *at, const char *region)
{
    static const char *const where[] = {[DT_OUTSIDE] = "outside",
                                        [DT_ON_VERTEX] = "vertex",
                                        [DT_ON_EDGE] = "edge",
                                        [DT_INSIDE] = "inside"};
    static const size_t ids[] = {
        [DT_OUTSIDE] = 0, [DT_ON_VERTEX] = 1, [DT_ON_EDGE] = 2, [DT_INSIDE] = 3};
    reply_ok(a->out, at->where != DT_OUTSIDE);
    reply_key_text(a->out, "where", where[at->where]);
    if (region != NULL)
        reply_key_text(a->out, "region", region);
    reply_end(a->out);
    if (at->where != DT_OUTSIDE)
        reply_row_ids(a->out, at->id, ids[at->where]);
}

/* ---- the job ---- */

struct regions_job {
    struct job job;
    struct regions_query q;
    struct dt_ids words; /* owns: of the rows */
    size_t rows;
    struct dt_region all; /* REGIONS_ALL: of all that is inside */
    const char *region;   /* REGIONS_LOCATION */
};

static enum dt_status find_all(struct regions_job *j)
{
    struct dt_region *row;
    enum dt_status status = dt_regions(j->job.dt, &row, &j->rows, &j->all);
    if (status != DT_OK)
        return status;
    status = job_grow(&j->job, &j->words, j->rows * ROW_REGION_WORDS);
    for (size_t i = 0; status == DT_OK && i < j->rows; i++) {
        row_region_put(j->words.v + j->words.n, &row[i]);
        j->words.n += ROW_REGION_WORDS;
    }
    free(row);
    return status;
}

static int by_number(const void *a, const void *b)
{
    uint32_t x = *(const uint32_t *)a, y = *(const uint32_t *)b;
    return (x > y) - (x < y);
}

/* Appends the row of a place: how many borders have it inside or on the edge of their regions, and which. */
static enum dt_status find_at(struct regions_job *j, struct dt_point at, struct dt_ids found[2])
{
    struct dt_ids *in = &found[0], *on = &found[1], *w = &j->words;
    in->n = on->n = 0;
    enum dt_status status = dt_regions_at(j->job.dt, at, &j->job.options, in, on);
    size_t n = in->n + on->n;
    if (status == DT_OK)
        status = job_grow(&j->job, w, n + 1);
    if (status != DT_OK)
        return status;
    w->v[w->n++] = (uint32_t)n;
    for (size_t i = 0; i < n; i++)
        w->v[w->n + i] = i < in->n ? in->v[i] : on->v[i - in->n];
    if (on->n > 0)
        qsort(w->v + w->n, n, sizeof *w->v, by_number);
    w->n += n;
    return DT_OK;
}

/* The steps of the job are for all places together, so each gets what is left. */
static enum dt_status find_places(struct regions_job *j)
{
    struct dt_ids found[2] = {{0}, {0}};
    enum dt_status status = DT_OK;
    uint32_t steps = j->job.options.steps;
    j->rows = j->q.places.n;
    for (size_t i = 0; status == DT_OK && i < j->rows; i++) {
        size_t before = j->words.n;
        status = atomic_load(&j->job.cancel) ? DT_CANCELLED : find_at(j, j->q.places.p[i], found);
        uint32_t took = (uint32_t)(j->words.n - before) + STEPS_PLACE;
        if (steps > 0 && status == DT_OK && j->job.options.steps <= took)
            status = i + 1 < j->rows ? DT_TOOLONG : DT_OK;
        j->job.options.steps -= steps > 0 && status == DT_OK ? took : 0;
    }
    j->job.options.steps = steps;
    free(found[0].v);
    free(found[1].v);
    return status;
}

static uint32_t width_of(const struct regions_query *q)
{
    if (q->kind == REGIONS_ALL)
        return ROW_REGION_WORDS;
    return q->kind == REGIONS_AT ? 1 : q->table == DT_EDGES ? 2 : 3;
}

static enum dt_status find_rows(struct regions_job *j)
{
    enum { GROWS = 3 }; /* times the result, while it is copied */
    const struct dt_summary *sum = &j->job.base->sum;
    size_t rows = j->q.table == DT_EDGES ? sum->edges : sum->triangles, width = width_of(&j->q);
    enum dt_status status = job_reserve(&j->job, GROWS * rows * width * sizeof *j->words.v);
    if (status == DT_OK)
        status = dt_inside(j->job.dt, j->q.inside.number, j->q.table, j->q.cw, &j->job.options,
                           &j->words);
    j->rows = j->words.n / width;
    return status;
}

static void run_job(struct job *job)
{
    struct regions_job *j = (struct regions_job *)job;
    j->words.n = 0;
    switch (j->q.kind) {
    case REGIONS_ALL:
        job->status = find_all(j);
        break;
    case REGIONS_AT:
        job->status = find_places(j);
        break;
    case REGIONS_LOCATION:
        job->status = find_region(job->dt, j->q.place, &job->options, &j->region);
        break;
    case REGIONS_TABLE:
        job->status = find_rows(j);
        break;
    }
}

/* ---- the reply ---- */

static void answer(struct server *s, struct answer *a, struct regions_job *j)
{
    static const char *const format[] = {[REGIONS_ALL] = ROW_REGION, [REGIONS_AT] = "I"};
    if (j->q.kind == REGIONS_LOCATION) {
        write_location(a, &j->q.at, j->region);
        return;
    }
    struct rows rows = {.version = j->job.base,
                        .form = j->q.kind == REGIONS_TABLE ? ROW_IDS : ROW_WORDS,
                        .format = j->q.kind == REGIONS_TABLE ? NULL : format[j->q.kind],
                        .width = width_of(&j->q),
                        .heavy = j->job.queued_ns > 0,
                        .binary = j->q.binary};
    reply_ok(a->out, j->q.binary ? 0 : j->rows);
    if (j->q.kind == REGIONS_ALL) {
        reply_key_u64(a->out, "inside", j->all.triangles);
        reply_key_double(a->out, "area", j->all.area);
    }
    if (j->q.binary) {
        reply_key_u64(a->out, "rows", j->rows);
        reply_key_u64(a->out, "bytes", j->words.n * sizeof *j->words.v);
    }
    reply_end(a->out);
    answer_rows(s, a, &rows, &j->words);
}

static void end_job(struct server *s, struct job *job, struct answer *a)
{
    struct regions_job *j = (struct regions_job *)job;
    if (job_succeeded(job, a))
        answer(s, a, j);
    dt_pages_release(j->q.places.p);
    free(j->words.v);
}

static void submit(struct server *s, struct answer *a, struct dataset *set, struct regions_query *q,
                   enum job_weight weight)
{
    struct regions_job *j =
        job_new_reading(s, a, sizeof *j, run_job, end_job, "finding what is inside", set);
    if (j == NULL) {
        dt_pages_release(q->places.p);
        return;
    }
    j->q = *q;
    job_read(s, a, &j->job, set->current, weight);
}

/* ---- places ---- */

void regions_answer(struct server *s, struct answer *a, struct dataset *set,
                    struct regions_query *q)
{
    bool light = q->kind == REGIONS_AT || cost_at_once(COST_SURVEY, set->current->sum.points);
    submit(s, a, set, q, light ? JOB_TRY : JOB_LONG);
}

void regions_locate(struct server *s, struct answer *a, struct dataset *set,
                    const struct dt_place *place)
{
    struct regions_query q = {.kind = REGIONS_LOCATION, .place = place->at};
    struct dt_options opt = {.steps = s->workers != NULL ? COST_STEPS_AT_ONCE : 0};
    const struct dt *t = set->current->dt;
    const char *region = NULL;
    enum dt_status status = dt_locate_place(t, place, &q.at);
    if (status == DT_OK && dt_has_borders(t)) {
        if (!upkeep_survey(s, a, set))
            return;
        status = find_region(set->current->dt, place->at, &opt, &region);
    }
    if (status == DT_TOOLONG)
        submit(s, a, set, &q, JOB_LONG);
    else if (status == DT_OK)
        write_location(a, &q.at, region);
    else
        answer_status(a, status);
}
