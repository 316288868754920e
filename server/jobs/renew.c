/* renew.c - see renew.h. */
#include "server/jobs/renew.h"

#include "server/jobs/job.h"
#include "server/ops/cost.h"

struct renew {
    struct job job;
    struct dt_renewal *fresh; /* owns */
};

static void run_renew(struct job *j)
{
    j->status = dt_renew(j->dt, &j->options, &((struct renew *)j)->fresh);
}

static void clear_renew(struct job *j)
{
    dt_renewal_free(((struct renew *)j)->fresh);
}

/* Out of memory: it is tried again later. Cancelled: the next search that needs a grid builds it. */
static void install_renewed(struct job *j)
{
    struct renew *r = (struct renew *)j;
    dt_renewed(j->dt, r->fresh);
    r->fresh = NULL;
}

static void renewed(struct server *s, struct job *j, struct answer *a)
{
    (void)s, (void)j, (void)a;
}

static bool start(struct server *s, struct dataset *set)
{
    struct renew *r = job_new(sizeof *r, run_renew, renewed);
    struct answer nobody = {0};
    if (r == NULL)
        return false;
    r->job.clear = clear_renew;
    r->job.install = install_renewed;
    r->job.memory = server_reservation(s, BUDGET_BUILDS);
    if (!reservation_resize(&r->job.memory, dt_prepare_memory(set->current->dt))) {
        job_free(&r->job); /* searches work without a grid, with longer walks */
        return false;
    }
    job_beside(s, &nobody, &r->job, set, JOB_HEAVY | JOB_BRIEF);
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
