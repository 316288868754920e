/* raster_clip.c - see surface.h. */
#include "server/replies/surface.h"

#include "core/delaunay_constraints.h"
#include "server/jobs/job.h"
#include "server/jobs/upkeep.h"

#include <stdlib.h>

enum {
    CELLS_AT_ONCE = 4096,   /* are marked by the reactor, about a millisecond of work, */
    CELLS_SHORT = 1 << 22,  /* or by a worker in some milliseconds */
    WORKSPACE = 1024 * 1024 /* bytes, of dt_raster_inside, beside a bit for each cell */
};

bool raster_clip_ready(struct server *s, struct answer *a, struct dataset *other)
{
    if (!dt_has_borders(other->current->dt))
        return answer_err(a, ERR_NOREGION, "the set %s has no borders", other->name);
    if (!upkeep_survey(s, a, other))
        return false;
    return dt_has_closed_border(other->current->dt) ||
           answer_err(a, ERR_OPEN, "all borders of the set %s are open", other->name);
}

/* ---- the job: it reads the other set ---- */

struct raster_clip_job {
    struct job job;
    struct surface q;        /* places.kept: owns the bits */
    struct surface_moment m; /* pinned, and its view is owned */
};

static void run_job(struct job *job)
{
    struct raster_clip_job *j = (struct raster_clip_job *)job;
    const struct dt_raster *r = &j->q.raster;
    job->status = job_reserve(job, WORKSPACE + (size_t)((uint64_t)r->columns * r->rows / 8));
    if (job->status == DT_OK)
        job->status =
            dt_raster_inside(job->dt, DT_NONE, &j->q.raster, &job->options, j->q.places.kept);
}

static void end_job(struct server *s, struct job *job, struct answer *a)
{
    struct raster_clip_job *j = (struct raster_clip_job *)job;
    struct dt_view *view = j->m.view;
    if (job_succeeded(job, a)) {
        surface_answer_values(s, a, &j->m, &j->q);
        view = NULL;
    }
    version_end_view(&s->sets, j->m.version, view);
    version_unpin(&s->sets, j->m.version);
    surface_clear(&j->q);
}

/* Room for the bits. False: there is no memory. */
static bool make_room(struct server *s, struct answer *a, struct surface *q)
{
    size_t bytes = ((size_t)q->raster.columns * q->raster.rows + 7) / 8;
    q->places.memory = server_reservation(s, BUDGET_REPLIES);
    if (!reservation_resize(&q->places.memory, bytes))
        answer_busy(a);
    else if ((q->places.kept = dt_pages_grow(s->pages, NULL, 0, bytes)) == NULL)
        answer_out_of_memory(a);
    return q->places.kept != NULL;
}

void raster_clip_answer(struct server *s, struct answer *a, struct version *v, struct surface *q)
{
    struct dataset *other = q->clip;
    uint64_t cells = (uint64_t)q->raster.columns * q->raster.rows;
    bool light = s->workers == NULL || cells <= CELLS_AT_ONCE;
    /* Edits of the other set wait, because regions are those of now. */
    struct raster_clip_job *j =
        job_new_reading(s, a, sizeof *j, run_job, end_job, "marking cells", other);
    if (j == NULL)
        return;
    bool room = make_room(s, a, q);
    j->q = *q;
    j->m.version = version_pin(v);
    if (!light)
        j->m.view = dt_view_begin(v->dt, true);
    if (!room || (!light && j->m.view == NULL)) {
        answer_out_of_memory(a);
        job_free(s, &j->job);
        return;
    }
    job_read(s, a, &j->job, other->current,
             light                  ? JOB_LIGHT
             : cells <= CELLS_SHORT ? JOB_SHORT
                                    : JOB_LONG);
}
