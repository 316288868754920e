/* renew.c - see renew.h. */
#include "server/jobs/renew.h"

#include "server/jobs/job.h"
#include "server/ops/cost.h"

struct renew {
    struct job job;
    struct dt_renewal *fresh; /* owns */
    struct renew *then;       /* owns: installs it */
};

static void run_renew(struct job *j)
{
    j->status = dt_renew(j->dt, &j->options, &((struct renew *)j)->fresh);
}

static void run_install(struct job *j)
{
    struct renew *r = (struct renew *)j;
    dt_renewed(j->dt, r->fresh);
    r->fresh = NULL;
}

static void end_install(struct server *s, struct job *j, struct answer *a)
{
    (void)s, (void)a;
    dt_renewal_free(((struct renew *)j)->fresh);
}

/* Out of memory: it is tried again later. Cancelled: the next search that needs a grid builds it. */
static void end_renew(struct server *s, struct job *j, struct answer *a)
{
    struct renew *r = (struct renew *)j;
    if (r->then == NULL)
        return;
    r->then->fresh = r->fresh;
    if (a == NULL || j->status == DT_CANCELLED) {
        job_free(s, &r->then->job);
        return;
    }
    r->then->job.memory = server_reservation(s, BUDGET_BUILDS);
    reservation_set(&r->then->job.memory, dt_prepare_memory(j->dt));
    job_change(s, NULL, &r->then->job, j->set, JOB_LIGHT);
}

static bool start(struct server *s, struct dataset *set)
{
    struct renew *r = job_new(sizeof *r, run_renew, end_renew);
    if (r == NULL)
        return false;
    r->then = job_new(sizeof *r->then, run_install, end_install);
    r->job.memory = server_reservation(s, BUDGET_BUILDS);
    if (r->then == NULL ||
        !reservation_resize(&r->job.memory, dt_prepare_memory(set->current->dt))) {
        job_free(s, &r->job); /* searches work without a grid, with longer walks */
        return false;
    }
    r->job.set = set;
    job_read(s, NULL, &r->job, set->current, JOB_SHORT);
    return true;
}

bool renew_has_grid(struct server *s, struct dataset *set)
{
    struct version *v = set->current;
    if (v->sum.searchable)
        return true;
    if (set->writer != NULL)
        return false;
    bool later = s->workers != NULL && !s->stopping && !cost_at_once(COST_GRID, v->sum.points);
    if (later || !version_try_edit(v))
        return !start(s, set);
    (void)dt_prepare(v->dt, NULL);
    version_update(&s->sets, v);
    version_unlock(v);
    return true;
}

void renew_if_due(struct server *s, struct dataset *set)
{
    if (s->workers == NULL || s->stopping || set->writer != NULL || !dt_renew_due(set->current->dt))
        return;
    (void)start(s, set);
}
