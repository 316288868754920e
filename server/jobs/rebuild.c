/* rebuild.c - see rebuild.h. */
#include "server/jobs/rebuild.h"

#include "server/jobs/durable.h"
#include "server/jobs/job.h"
#include "server/system/notice.h"

#include <stdlib.h>

struct rebuild {
    struct dataset **set; /* owns n; those from `at` on are not triangulated yet */
    size_t n, at;
    struct job *job; /* borrows: triangulates set[at] */
};

static void rebuild_next(struct server *s);

static void run_rebuild(struct job *j)
{
    j->status = dt_triangulate(j->dt, &j->options);
}

static void end_rebuild(struct server *s, struct job *j, struct answer *a)
{
    (void)a;
    j->set->loading = false;
    s->rebuild->job = NULL;
    if (j->status != DT_OK && !s->stopping)
        notice(NOTICE_ERROR, "the set %s could not be triangulated again: out of memory",
               j->set->name);
    s->rebuild->at++;
    if (!s->stopping)
        rebuild_next(s);
}

/* Everything on the disk is read, whatever --max-memory is, because it was acknowledged. */
static void report_memory(const struct server *s)
{
    size_t taken = budget_of(&s->budget, BUDGET_SETS);
    if (!budget_fits(&s->budget, BUDGET_SETS, 0))
        notice(NOTICE_WARNING,
               "the sets take %zu bytes, all that --max-memory allows: points can be deleted, "
               "but not added",
               taken);
}

static void rebuild_next(struct server *s)
{
    struct rebuild *r = s->rebuild;
    if (r->at < r->n) {
        struct job *j = job_new(sizeof *j, run_rebuild, end_rebuild);
        r->job = j;
        if (j != NULL)
            job_change(s, NULL, j, r->set[r->at], JOB_SHORT);
        if (j != NULL)
            return;
        notice(NOTICE_ERROR, "out of memory; some sets are not triangulated");
        for (; r->at < r->n; r->at++)
            r->set[r->at]->loading = false;
    }
    durable_complete(s);
    report_memory(s);
}

static int by_size(const void *a, const void *b)
{
    const struct dataset *const *x = a, *const *y = b;
    uint32_t m = (*x)->current->sum.points, n = (*y)->current->sum.points;
    return m < n ? -1 : m > n;
}

static void count_set(struct dataset *set, void *ctx)
{
    struct rebuild *r = ctx;
    r->n += set->triangulated;
}

static void note_set(struct dataset *set, void *ctx)
{
    struct rebuild *r = ctx;
    set->loading = set->triangulated;
    if (set->triangulated)
        r->set[r->at++] = set;
}

static bool begin(struct server *s)
{
    struct rebuild *r = s->rebuild = calloc(1, sizeof *r);
    if (r != NULL) {
        registry_each(&s->sets, count_set, r);
        r->set = malloc((r->n + 1) * sizeof(struct dataset *));
    }
    if (r == NULL || r->set == NULL) {
        notice(NOTICE_ERROR, "out of memory");
        return false;
    }
    registry_each(&s->sets, note_set, r);
    r->at = 0;
    qsort(r->set, r->n, sizeof(struct dataset *), by_size);
    rebuild_next(s);
    return true;
}

bool rebuild_on_durable_event(struct server *s)
{
    enum durable_news news = durable_on_event(s);
    return news == DURABLE_READ ? begin(s) : news != DURABLE_FAILED;
}

void rebuild_refuse(const struct server *s, struct answer *a, const struct dataset *set)
{
    const struct rebuild *r = s->rebuild;
    bool first = r->job != NULL && r->set[r->at] == set;
    answer_err(a, ERR_LOADING, "the set %s is being triangulated, %u %% so far; try again",
               set->name, first ? r->job->progress : 0);
}

void rebuild_free(struct server *s)
{
    if (s->rebuild != NULL)
        free(s->rebuild->set);
    free(s->rebuild);
    s->rebuild = NULL;
}
