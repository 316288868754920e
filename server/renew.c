/* renew.c - see renew.h. */
#include "server/renew.h"

#include "server/job.h"

enum { AT_ONCE = 500 }; /* points of a set whose grid the I/O thread makes itself */

struct renew {
    struct job job;
    struct dt_renewal *fresh; /* owns */
};

static void run_renew(struct job *j)
{
    j->status = dt_renew(j->dt, j->options.pool, &((struct renew *)j)->fresh);
}

/* Whether anybody but the set, the job and perhaps a snapshot refers to the version. */
static bool is_read_by_others(const struct version *v)
{
    return v->refs > (v->saved ? 3u : 2u);
}

/* A worker that reads this version just now may be using its grid, if it has one; in that case the next
 * edit makes a copy of the set, which will ask again. */
static void renew_done(struct server *s, struct job *j, struct answer *a)
{
    struct renew *r = (struct renew *)j;
    (void)a;
    if (j->base->sum.searchable && is_read_by_others(j->base))
        return;
    dt_renewed(j->dt, r->fresh);
    r->fresh = NULL;
    version_update(&s->sets, j->base);
}

static void clear_renew(struct job *j)
{
    dt_renewal_free(((struct renew *)j)->fresh);
}

static bool start(struct server *s, struct dataset *set)
{
    struct renew *r = job_new(sizeof *r, run_renew, renew_done);
    if (r == NULL)
        return false;
    r->job.clear = clear_renew;
    job_beside(s, &r->job, set);
    return true;
}

bool renew_has_grid(struct server *s, struct dataset *set)
{
    struct version *v = set->current;
    if (v->sum.searchable)
        return true;
    if (set->writer != NULL)
        return false;
    if (s->workers != NULL && !s->stopping && v->sum.points > AT_ONCE)
        return !start(s, set);
    (void)dt_prepare(v->dt, NULL);
    version_update(&s->sets, v);
    return true;
}

void renew_if_aged(struct server *s, struct dataset *set)
{
    if (s->workers == NULL || s->stopping || set->writer != NULL || version_is_read(set->current) ||
        !dt_is_aged(set->current->dt))
        return;
    (void)start(s, set);
}
