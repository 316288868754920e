/* restart.c - see restart.h. */
#include "server/jobs/restart.h"

#include "server/jobs/durable.h"
#include "server/jobs/job.h"
#include "server/system/notice.h"

#include <stdlib.h>

static void triangulate_next(struct server *s);

static void run_triangulate(struct job *j)
{
    j->status = dt_triangulate(j->dt, &j->options);
}

static void end_triangulate(struct server *s, struct job *j, struct answer *a)
{
    j->set->loading = false;
    if (j->status != DT_OK && !s->stopping)
        notice_error("the set %s could not be triangulated again: out of memory", j->set->name);
    if (!s->stopping)
        triangulate_next(s);
}

/* Everything on the disk is read, with any --max-memory, because it was acknowledged. */
static void report_memory(const struct server *s)
{
    size_t taken = budget_of(&s->budget, BUDGET_SETS);
    if (!budget_fits(&s->budget, BUDGET_SETS, 0))
        notice(NOTICE_WARNING,
               "the sets take %zu bytes, all that --max-memory allows: points can be deleted, "
               "but not added",
               taken);
}

/* The smallest one. When none is left, the daemon has all that is on the disk. */
static void triangulate_next(struct server *s)
{
    struct loading *l = &s->loading;
    while (l->n > 0) {
        struct dataset *set = l->set[--l->n];
        struct job *j = job_new(sizeof *j, run_triangulate, end_triangulate);
        if (j != NULL) {
            job_change(s, NULL, j, set, JOB_SHORT);
            return;
        }
        notice_error("out of memory: the set %s is not triangulated", set->name);
        set->loading = false;
    }
    free(l->set);
    l->set = NULL;
    durable_complete(s);
    report_memory(s);
}

static int larger_first(const void *a, const void *b)
{
    const struct dataset *const *x = a, *const *y = b;
    uint32_t m = (*x)->current->sum.points, n = (*y)->current->sum.points;
    return m > n ? -1 : m < n;
}

static void note_set(struct dataset *set, void *ctx)
{
    struct loading *l = ctx;
    set->loading = set->triangulated;
    if (set->triangulated)
        l->set[l->n++] = set;
}

static bool begin(struct server *s)
{
    struct loading *l = &s->loading;
    l->set = malloc((s->sets.sets + 1) * sizeof(struct dataset *));
    if (l->set == NULL)
        return notice_error("out of memory");
    registry_each(&s->sets, note_set, l);
    qsort(l->set, l->n, sizeof(struct dataset *), larger_first);
    triangulate_next(s);
    return true;
}

bool restart_on_durable_event(struct server *s)
{
    enum durable_news news = durable_on_event(s);
    return news == DURABLE_READ ? begin(s) : news != DURABLE_FAILED;
}

void restart_refuse(struct answer *a, const struct dataset *set)
{
    answer_err(a, ERR_LOADING, "the set %s is being triangulated, %u %% so far; try again",
               set->name, set->writer != NULL ? set->writer->progress : 0);
}
