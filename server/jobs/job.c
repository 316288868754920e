/* job.c - see job.h. */
#include "server/jobs/job.h"

#include "server/jobs/durable.h"
#include "server/ops/cost.h"
#include "server/ops/limits.h"
#include "server/system/loop.h"

#include <stdlib.h>
#include <string.h>

void *job_new(size_t size, void (*run)(struct job *),
              void (*done)(struct server *, struct job *, struct answer *))
{
    struct job *j = malloc(size); /* calloc would not reuse recently freed blocks */
    if (j == NULL)
        return NULL;
    *j = (struct job){.run = run, .done = done};
    memset(j + 1, 0, size - sizeof *j);
    j->options.cancel = &j->cancel;
    j->options.progress = &j->progress;
    return j;
}

void job_free(struct job *j)
{
    if (j->clear != NULL)
        j->clear(j);
    reservation_set(&j->memory, 0);
    free(j);
}

static bool edits_in_place(const struct job *j)
{
    return j->set != NULL && j->fresh == NULL && !j->beside;
}

/* ---- on a worker, or at once ---- */

static void run(struct job *j)
{
    if (j->fresh != NULL) {
        version_lock_read(j->base);
        j->status = dt_clone_points(j->base->dt, &j->options, &j->dt);
        version_unlock(j->base);
        if (j->status != DT_OK) {
            j->dt = NULL;
            return;
        }
        j->options.disposable = true;
    }
    j->run(j);
}

/* Under the version's lock, except for a build of a copy, which needs it only for copying. */
static void run_later(struct work *w)
{
    struct job *j = (struct job *)w;
    j->began_ns = clock_ns();
    reservation_trim_heap(&j->memory);
    bool edits = edits_in_place(j), reads = !edits && j->base != NULL && j->fresh == NULL;
    if (edits)
        version_lock_edit(j->base);
    else if (reads)
        version_lock_read(j->base);
    run(j);
    if (edits || reads)
        version_unlock(j->base);
}

/* ---- on the I/O thread ---- */

/* Runs the job on this thread. False, with nothing done, if that would block all clients: it takes more steps
 * than this thread may do; or it edits in place while a piece of the set is being read, which takes
 * microseconds unless the processors are busy. */
static bool run_now(struct server *s, struct job *j)
{
    if (!edits_in_place(j)) {
        run(j);
        return true;
    }
    if (!version_try_edit(j->base))
        return false;
    j->options.steps = s->workers == NULL ? 0 : COST_STEPS_AT_ONCE;
    run(j);
    j->options.steps = 0;
    version_unlock(j->base);
    return j->status != DT_TOOLONG;
}

static enum work_kind work_kind(unsigned how)
{
    return (how & JOB_BRIEF) != 0 ? WORK_SHORT : (how & JOB_SLOW) != 0 ? WORK_SLOW : WORK_LONG;
}

static void start(struct server *s, struct answer *a, struct job *j, unsigned how)
{
    j->owner = a->owner;
    if (s->workers == NULL || (how & JOB_HEAVY) == 0) {
        if (run_now(s, j)) {
            job_finish(s, j, a);
            return;
        }
        how = JOB_HEAVY | JOB_BRIEF;
    }
    j->queued_ns = clock_ns();
    j->options.pool = workers_pool(s->workers);
    j->work.run = run_later;
    if (s->draining)
        job_drain(j);
    s->count.jobs++;
    list_append(&s->jobs, &j->link);
    a->next = ANSWER_WORK;
    a->job = j;
    workers_submit(s->workers, work_kind(how), &j->work);
}

static bool too_busy(struct server *s, struct answer *a, unsigned how)
{
    if (a->of_leader || s->workers == NULL ||
        (how & (JOB_HEAVY | JOB_BRIEF | JOB_BEGUN | JOB_SLOW)) != JOB_HEAVY ||
        workers_backlog(s->workers) < LIMIT_QUEUED_JOBS)
        return false;
    answer_err(a, ERR_BUSY, "too many requests are waiting for a worker; try again");
    return true;
}

void job_read(struct server *s, struct answer *a, struct job *j, struct version *v, unsigned how)
{
    if (too_busy(s, a, how)) {
        job_free(j);
        return;
    }
    j->base = version_pin(v);
    j->dt = v->dt;
    start(s, a, j, how);
}

/* Drops a set that a failed request has created. */
static void drop_unborn(struct server *s, struct dataset *set)
{
    if (!set->born)
        registry_drop(&s->sets, set);
}

struct dt_options job_options(const struct server *s)
{
    return (struct dt_options){.pool = s->workers != NULL ? workers_pool(s->workers) : NULL};
}

bool job_reserve_build(struct server *s, struct answer *a, const struct dataset *set,
                       struct reservation *r)
{
    struct dt_options options = job_options(s);
    return server_reserve(s, a, r, dt_build_memory(set->current->dt, &options));
}

/* Whether there is memory for a copy of a set of this number of points. */
static bool reserve_copy(struct server *s, struct job *j, uint32_t points)
{
    enum { BYTES_PER_POINT = 32 };
    if (j->memory.budget == NULL)
        j->memory = server_reservation(s, BUDGET_EDITS);
    return cost_at_once(COST_COPY, points) ||
           reservation_resize(&j->memory, j->memory.bytes + (size_t)points * BYTES_PER_POINT);
}

/* Decides whether the job works on a copy of the set's points: because it must, or because it requests that and
 * there is memory. False: it must, but there is no memory; the error has been set. */
static bool choose_copy(struct server *s, struct answer *a, struct job *j, struct dataset *set,
                        unsigned how)
{
    bool must = dt_view_blocks(set->current->dt, j->changes);
    if (!must && (how & JOB_COPY) == 0)
        return true;
    if (reserve_copy(s, j, set->current->sum.points)) {
        j->fresh = version_new(NULL);
        if (j->fresh == NULL)
            answer_out_of_memory(a);
        return j->fresh != NULL;
    }
    if (must)
        answer_err(a, ERR_BUSY,
                   "the set is being read, and there is no memory for a copy of it; try again");
    return !must;
}

/* Whether the job is an edit that builds the grid for searches first, and needs a worker for that. */
static bool makes_grid(const struct job *j, const struct dt_summary *sum)
{
    return j->changes > 0 && sum->current && !sum->searchable &&
           !cost_at_once(COST_GRID, sum->points);
}

/* Counts the memory of that grid. The job is not refused for lack of it, because it may be a deletion that frees
 * memory. */
static void count_grid(struct server *s, struct job *j, const struct dt *dt)
{
    if (j->memory.budget == NULL)
        j->memory = server_reservation(s, BUDGET_BUILDS);
    reservation_set(&j->memory, j->memory.bytes + dt_prepare_memory(dt));
}

void job_write(struct server *s, struct answer *a, struct job *j, struct dataset *set, unsigned how)
{
    const struct dt_summary *sum = &set->current->sum;
    if ((how & JOB_HEAVY) == 0 && makes_grid(j, sum)) {
        how |= JOB_HEAVY | JOB_BRIEF;
        count_grid(s, j, set->current->dt);
    }
    bool good = choose_copy(s, a, j, set, how), in_place = j->fresh == NULL;
    if (!in_place && !cost_at_once(COST_COPY, sum->points))
        how |= JOB_HEAVY;
    if (!good || too_busy(s, a, how)) {
        version_free(j->fresh);
        job_free(j);
        drop_unborn(s, set);
        return;
    }
    j->set = set;
    j->base = version_pin(set->current);
    j->dt = in_place ? j->base->dt : NULL;
    set->writer = j;
    set->exclusive = j->base->edited = in_place;
    start(s, a, j, how);
}

void job_beside(struct server *s, struct answer *a, struct job *j, struct dataset *set,
                unsigned how)
{
    if (too_busy(s, a, how)) {
        job_free(j);
        return;
    }
    j->beside = true;
    j->set = set;
    j->base = version_pin(set->current);
    j->dt = j->base->dt;
    set->writer = j;
    start(s, a, j, how);
}

void job_apart(struct server *s, struct answer *a, struct job *j)
{
    if (too_busy(s, a, JOB_HEAVY))
        job_free(j);
    else
        start(s, a, j, JOB_HEAVY);
}

void job_drain(struct job *j)
{
    if (j->what != NULL && j->changes == 0)
        j->cancel = true;
}

/* ---- the end ---- */

static void publish(struct server *s, struct job *j)
{
    if (j->fresh == NULL) {
        version_update(&s->sets, j->base);
    } else if (j->status == DT_OK) {
        j->fresh->dt = j->dt;
        version_update(&s->sets, j->fresh);
        dataset_publish(&s->sets, j->set, j->fresh);
    } else {
        if (j->dt != NULL)
            s->sets.discard(s->sets.discard_ctx, j->dt);
        version_free(j->fresh);
    }
    j->set->writer = NULL;
    j->set->exclusive = false;
    if (j->status == DT_OK)
        j->set->born = true;
}

bool job_is_early(const struct server *s, const struct job *j)
{
    return j->set == NULL && j->base != NULL && j->base->edited && j->owner != 0 &&
           j->status != DT_CANCELLED && durable_log(s) != NULL;
}

bool job_give_up_early(struct server *s, struct job *j)
{
    const struct work *w = list_first(&s->early);
    while (w != NULL && w != &j->work)
        w = list_next(&s->early, w);
    if (w == NULL)
        return false;
    list_remove(&j->work.link);
    j->status = DT_CANCELLED;
    return true;
}

bool job_install(struct server *s, struct job *j)
{
    void (*install)(struct job *) = j->install;
    j->install = NULL;
    if (install == NULL || j->status == DT_CANCELLED)
        return true;
    if (version_try_edit(j->base)) {
        install(j);
        version_unlock(j->base);
        return true;
    }
    j->run = install;
    j->beside = false;
    j->set->exclusive = j->base->edited = true;
    workers_submit(s->workers, WORK_SHORT, &j->work);
    return false;
}

/* Sets the changes that the reply acknowledges or shows. A writer without a record, such as an update of the
 * triangulation before a query, only shows changes of others. */
static void note_changes(const struct job *j, struct answer *a)
{
    a->lsn = 0;
    if (j->base == NULL || j->status == DT_CANCELLED)
        return;
    if (j->record != NULL)
        a->lsn = j->set->current->lsn;
    else if (j->base->lsn > a->shown)
        a->shown = j->base->lsn;
}

void job_finish(struct server *s, struct job *j, struct answer *a)
{
    struct dataset *set = j->set;
    bool reserved = j->memory.bytes > 0;
    reservation_set(&j->memory, 0); /* what the set has grown by is recorded by version_update */
    list_remove(&j->link);
    if (set != NULL) {
        publish(s, j);
        server_limit_pages(s);
    }
    if (set != NULL && j->status == DT_OK && j->record != NULL)
        j->record(s, j);
    if (edits_in_place(j))
        j->base->edited = false;
    note_changes(j, a);
    j->done(s, j, a);
    if (j->base != NULL)
        version_unpin(&s->sets, j->base);
    job_free(j);
    if (reserved)
        server_memory_freed(s);
    if (set != NULL) {
        wait_call(&set->queue);
        drop_unborn(s, set);
    }
}

/* ---- freeing ---- */

void job_aside(struct server *s, struct job *j)
{
    struct buf out = {0};
    struct answer nobody = {.out = &out};
    start(s, &nobody, j, JOB_HEAVY | JOB_BRIEF);
}

static void run_discard(struct job *j)
{
    dt_free(j->dt);
}

static void discarded(struct server *s, struct job *j, struct answer *a)
{
    (void)s, (void)j, (void)a;
}

void job_discard(struct server *s, struct dt *dt)
{
    struct dt_summary sum;
    dt_summary(dt, &sum);
    struct job *j = NULL;
    if (s->workers != NULL && !s->stopping && !cost_at_once(COST_FREE, sum.memory / 1024))
        j = job_new(sizeof *j, run_discard, discarded);
    if (j == NULL) {
        dt_free(dt);
        return;
    }
    j->dt = dt;
    j->memory = server_reservation(s, BUDGET_EDITS);
    reservation_set(&j->memory, sum.memory); /* until it is freed */
    job_aside(s, j);
}
