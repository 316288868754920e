/* job.c - see job.h. */
#include "server/jobs/job.h"

#include "server/jobs/durable.h"
#include "server/ops/cost.h"
#include "server/ops/limits.h"
#include "server/system/loop.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

void *job_new(size_t size, void (*run)(struct job *),
              void (*end)(struct server *, struct job *, struct answer *))
{
    struct job *j = malloc(size); /* calloc would not reuse recently freed blocks */
    if (j == NULL)
        return NULL;
    *j = (struct job){.run = run, .end = end};
    memset(j + 1, 0, size - sizeof *j);
    j->options.cancel = &j->cancel;
    j->options.progress = &j->progress;
    return j;
}

void *job_new_reading(struct server *s, struct answer *a, size_t size, void (*run)(struct job *),
                      void (*end)(struct server *, struct job *, struct answer *), const char *what,
                      struct dataset *set)
{
    if (!world_alone(a))
        return NULL;
    struct job *j = job_new(size, run, end);
    if (j == NULL) {
        answer_out_of_memory(a);
        return NULL;
    }
    j->what = what;
    j->set = set;
    j->memory = server_reservation(s, BUDGET_REPLIES);
    return j;
}

/* After `end`. */
static void release(struct server *s, struct job *j)
{
    if (j->base != NULL) {
        version_end_view(&s->sets, j->base, j->view);
        version_unpin(&s->sets, j->base);
    } else {
        dt_view_end(j->view);
    }
    reservation_set(&j->memory, 0);
    free(j->fresh);
    free(j);
}

void job_free(struct server *s, struct job *j)
{
    j->end(s, j, NULL);
    release(s, j);
}

bool job_succeeded(const struct job *j, struct answer *a)
{
    if (a == NULL || j->status == DT_OK)
        return a != NULL;
    return j->busy ? answer_busy(a) : answer_status(a, j->status);
}

enum dt_status job_reserve(struct job *j, size_t bytes)
{
    j->busy = !reservation_resize(&j->memory, bytes);
    return j->busy ? DT_NOMEM : DT_OK;
}

enum dt_status job_grow(struct job *j, struct dt_ids *words, size_t n)
{
    if (n <= words->cap - words->n)
        return DT_OK;
    size_t cap = words->cap + words->cap / 2 + n;
    enum dt_status status = job_reserve(j, (words->cap + cap) * sizeof *words->v);
    uint32_t *v = status == DT_OK ? realloc(words->v, cap * sizeof *v) : NULL;
    if (v == NULL)
        return DT_NOMEM;
    words->v = v;
    words->cap = cap;
    return DT_OK;
}

void job_end_visit(const struct job *j)
{
    if (j->queued_ns > 0)
        gate_end_visit(&j->base->gate);
}

void job_visit(const struct job *j)
{
    if (j->queued_ns > 0)
        gate_visit(&j->base->gate);
}

enum dt_status job_pause(const struct job *j, enum dt_status status)
{
    if (status != DT_OK)
        return status;
    job_end_visit(j);
    job_visit(j);
    return atomic_load(&j->cancel) ? DT_CANCELLED : DT_OK;
}

bool job_begin_view(struct server *s, struct answer *a, struct job *j, const struct version *v,
                    bool rings)
{
    j->view = dt_view_begin(v->dt, rings);
    if (j->view != NULL)
        return true;
    answer_out_of_memory(a);
    job_free(s, j);
    return false;
}

static bool edits_in_place(const struct job *j)
{
    return j->changes && j->fresh == NULL;
}

/* ---- on a worker, or at once ---- */

static void run(struct job *j)
{
    if (j->fresh != NULL) {
        gate_visit(&j->base->gate);
        j->status = dt_clone_points(j->base->dt, &j->options, &j->dt);
        gate_end_visit(&j->base->gate);
        if (j->status != DT_OK) {
            j->dt = NULL;
            return;
        }
        j->options.disposable = true;
    }
    if (j->views)
        j->view = dt_view_begin(j->dt, true);
    if (j->views && j->view == NULL)
        j->status = DT_NOMEM;
    else
        j->run(j);
    if (j->log != NULL && j->status == DT_OK && edits_in_place(j) && !change_is_void(j->change)) {
        durable_append(j->log, j->set, j->change);
        j->base->lsn = j->change->lsn; /* before others can read what has changed */
    }
}

/* Within the version's gate, except for a build of a copy, which needs that only for copying. */
static void run_later(struct work *w)
{
    struct job *j = (struct job *)w;
    j->began_ns = clock_ns();
    reservation_trim_heap(&j->memory);
    bool edits = edits_in_place(j), reads = !j->changes && j->base != NULL;
    if (edits)
        gate_close(&j->base->gate);
    else if (reads)
        gate_visit(&j->base->gate);
    run(j);
    if (edits)
        gate_open(&j->base->gate);
    else if (reads)
        gate_end_visit(&j->base->gate);
}

/* ---- on a reactor ---- */

/* Closes the gate of the version that the job edits. False: a piece of the set is being read, which takes microseconds unless
 * the processors are busy. */
static bool close_gate(struct server *s, struct job *j)
{
    if (s->workers != NULL)
        return gate_try_close(&j->base->gate);
    gate_close(&j->base->gate); /* there is nobody else */
    return true;
}

/* Runs the job on this thread. False, with nothing done, if that would block all clients: it would take more steps than this
 * thread may do, or wait for a reader. */
static bool run_now(struct server *s, const struct answer *a, struct job *j, enum job_weight weight)
{
    bool edits = edits_in_place(j), limited = s->workers != NULL && (edits || weight == JOB_TRY);
    bool closed = a != NULL && answer_shares(a); /* the gate is, by who carries out the request */
    assert(!edits || !closed || gate_is_closed(&j->base->gate));
    if (edits && !closed && !close_gate(s, j))
        return false;
    j->options.steps = limited ? COST_STEPS_AT_ONCE : 0;
    run(j);
    j->options.steps = 0;
    if (edits && !closed)
        gate_open(&j->base->gate);
    return !limited || j->status != DT_TOOLONG;
}

static void finish_for_nobody(struct server *s, struct job *j)
{
    struct buf out = {0};
    struct answer nobody = {.out = &out};
    job_finish(s, j, &nobody);
    buf_free(&out);
}

static void submit_to_worker(struct server *s, struct answer *a, struct job *j,
                             enum job_weight weight)
{
    static const enum work_kind kind[] = {WORK_SHORT, WORK_LONG, WORK_SHORT, WORK_LONG, WORK_SLOW};
    j->queued_ns = clock_ns();
    j->options.pool = workers_pool(s->workers);
    j->work.run = run_later;
    if (s->draining)
        job_drain(j);
    s->count.jobs++;
    list_append(&s->jobs, &j->link);
    if (a != NULL) {
        a->next = ANSWER_WORK;
        a->job = j;
    }
    workers_submit(s->workers, kind[weight], &j->work);
}

/* Whether too many jobs wait already. A job without an answer, or of a leader, is never refused. */
static bool is_crowded(const struct server *s, const struct answer *a, enum job_weight weight)
{
    return (weight == JOB_TRY || weight == JOB_LONG) && !a->of_leader &&
           workers_backlog(s->workers) >= LIMIT_QUEUED_JOBS;
}

/* Whether a worker may have the job, which becomes the writer of its set. If not, the answer says why. */
static bool may_submit(struct server *s, struct answer *a, struct job *j, enum job_weight weight)
{
    if (a != NULL && !world_alone(a))
        return false;
    if (a != NULL && is_crowded(s, a, weight))
        return answer_err(a, ERR_BUSY, "too many requests are waiting for a worker; try again");
    if (j->set == NULL || j->set->writer == j)
        return true;
    if (a != NULL && !dataset_admits(j->set, true, a->turn))
        return answer_wait(a, &j->set->queue, true);
    j->set->writer = j;
    return true;
}

/* Drops a set that a failed request has created. */
static void drop_unborn(struct server *s, struct dataset *set)
{
    if (!set->born)
        registry_drop(&s->sets, set);
}

/* The set has no writer any more, if the job was that. Returns the set; NULL: another job is the writer, or the job has no set. */
static struct dataset *leave_set(struct job *j)
{
    struct dataset *set = j->set;
    if (set == NULL || set->writer != j)
        return NULL;
    set->writer = NULL;
    set->exclusive = false;
    return set;
}

/* As if the job had not been begun. */
static void take_back(struct server *s, struct job *j)
{
    struct dataset *set = j->changes ? j->set : NULL;
    leave_set(j);
    job_free(s, j);
    if (set != NULL)
        drop_unborn(s, set);
}

static void start(struct server *s, struct answer *a, struct job *j, enum job_weight weight)
{
    j->owner = a != NULL ? a->owner : 0;
    bool now = s->workers == NULL || weight == JOB_LIGHT || weight == JOB_TRY;
    if (!now || !run_now(s, a, j, weight)) {
        if (may_submit(s, a, j, weight))
            submit_to_worker(s, a, j, weight);
        else
            take_back(s, j);
    } else if (a != NULL) {
        job_finish(s, j, a);
    } else {
        finish_for_nobody(s, j);
    }
}

void job_aside(struct server *s, struct answer *a, struct job *j, enum job_weight weight)
{
    start(s, a, j, weight);
}

void job_read(struct server *s, struct answer *a, struct job *j, struct version *v,
              enum job_weight weight)
{
    j->base = version_pin(v);
    j->dt = v->dt;
    start(s, a, j, weight);
}

/* ---- changes ---- */

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
static bool choose_copy(struct server *s, struct answer *a, struct job *j, struct dataset *set)
{
    bool must = dt_view_blocks(set->current->dt, j->points);
    if (!must && !j->copies)
        return true;
    if (reserve_copy(s, j, set->current->sum.points)) {
        j->fresh = version_new(&s->sets, NULL);
        if (j->fresh == NULL && a != NULL)
            answer_out_of_memory(a);
        return j->fresh != NULL;
    }
    if (must && a != NULL)
        answer_err(a, ERR_BUSY,
                   "the set is being read, and there is no memory for a copy of it; try again");
    return !must;
}

/* Whether the job is an edit that builds the grid for searches first, and needs a worker for that. */
static bool makes_grid(const struct job *j, const struct dt_summary *sum)
{
    return j->points > 0 && sum->current && !sum->searchable &&
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

/* Whether the job does more than edit its set at once, in place. */
static bool needs_world(const struct job *j, const struct dataset *set, enum job_weight weight)
{
    return weight != JOB_LIGHT || j->copies || makes_grid(j, &set->current->sum) ||
           dt_view_blocks(set->current->dt, j->points);
}

/* Decides whether the job changes a copy, and whether a worker carries it out. False: the answer says why it cannot begin. */
static bool prepare(struct server *s, struct answer *a, struct job *j, enum job_weight *weight)
{
    const struct dt_summary *sum = &j->set->current->sum;
    if (a != NULL && needs_world(j, j->set, *weight) && !world_alone(a))
        return false;
    if (*weight == JOB_LIGHT && makes_grid(j, sum)) {
        *weight = JOB_SHORT;
        count_grid(s, j, j->set->current->dt);
    }
    if (!choose_copy(s, a, j, j->set))
        return false;
    if (j->fresh != NULL && *weight == JOB_LIGHT && !cost_at_once(COST_COPY, sum->points))
        *weight = JOB_LONG;
    return true;
}

void job_change(struct server *s, struct answer *a, struct job *j, struct dataset *set,
                enum job_weight weight)
{
    j->changes = true;
    j->set = set;
    if (!prepare(s, a, j, &weight)) {
        take_back(s, j);
        return;
    }
    j->base = version_pin(set->current);
    j->dt = j->fresh == NULL ? j->base->dt : NULL;
    j->log = j->change != NULL && set->born ? durable_log_of(s, set) : NULL;
    set->writer = j;
    set->exclusive = j->fresh == NULL;
    start(s, a, j, weight);
}

/* The first half of a job beside its set. */
struct making {
    struct job job;
    struct job *change; /* owns: the second half */
    void (*make)(struct job *change);
};

static void run_making(struct job *j)
{
    struct making *m = (struct making *)j;
    reservation_trim_heap(&m->change->memory);
    m->change->dt = j->dt;
    m->change->options.pool = j->options.pool;
    m->change->options.cancel = &j->cancel;
    m->change->options.progress = &j->progress;
    m->make(m->change);
    j->status = m->change->status;
}

static void end_making(struct server *s, struct job *j, struct answer *a)
{
    struct job *change = ((struct making *)j)->change;
    change->options.cancel = &change->cancel;
    change->options.progress = &change->progress;
    if (a != NULL && change->status == DT_OK) {
        job_change(s, a, change, j->set, JOB_LIGHT);
        return;
    }
    change->end(s, change, a);
    reservation_set(&change->memory, 0);
    free(change);
    server_memory_freed(s);
}

void job_beside(struct server *s, struct answer *a, struct job *j, struct dataset *set,
                void (*make)(struct job *j), enum job_weight weight)
{
    struct making *m = job_new(sizeof *m, run_making, end_making);
    if (m == NULL) {
        job_free(s, j);
        if (a != NULL)
            answer_out_of_memory(a);
        return;
    }
    m->change = j;
    m->make = make;
    m->job.what = j->what;
    m->job.acknowledges = j->acknowledges;
    m->job.set = set;
    job_read(s, a, &m->job, set->current, weight);
}

void job_drain(struct job *j)
{
    if (j->what != NULL && (j->points == 0 || j->plans))
        j->cancel = true;
}

/* ---- the end ---- */

/* The result of the writer of the set becomes current, and other requests may have the set. */
static void publish(struct server *s, struct job *j, struct dataset *set)
{
    bool memory = true; /* it may have changed */
    if (j->fresh == NULL) {
        memory = version_update(&s->sets, j->base);
    } else if (j->status == DT_OK) {
        j->fresh->dt = j->dt;
        version_update(&s->sets, j->fresh);
        dataset_publish(&s->sets, set, j->fresh);
        j->fresh = NULL;
    } else if (j->dt != NULL) {
        s->sets.discard(s->sets.discard_ctx, j->dt);
    }
    if (j->status == DT_OK && !set->born)
        set->born = true;
    if (memory)
        server_limit_pages(s);
}

/* The reply shows what the job has read, and acknowledges nothing yet. */
static void note_shown(const struct job *j, struct answer *a)
{
    a->lsn = 0;
    if (j->base != NULL && j->status != DT_CANCELLED && !j->acknowledges && j->base->lsn > a->shown)
        a->shown = j->base->lsn; /* at least that of what it has read */
}

/* The set counts its own memory once the result is published, so that of the job is released before. The end of the job
 * logs and answers what is current, and may begin another job, which answers instead; it comes before the requests that wait. */
void job_finish(struct server *s, struct job *j, struct answer *a)
{
    struct dataset *set = leave_set(j);
    bool reserved = j->memory.bytes > 0;
    list_remove(&j->link);
    reservation_set(&j->memory, 0);
    if (set != NULL)
        publish(s, j, set);
    note_shown(j, a);
    j->end(s, j, a);
    if (j->acknowledges && j->status != DT_CANCELLED)
        a->lsn = j->set->current->lsn;
    release(s, j);
    if (reserved)
        server_memory_freed(s);
    if (set != NULL) {
        queue_call(&set->queue);
        drop_unborn(s, set);
    }
}

/* ---- freeing ---- */

static void run_discard(struct job *j)
{
    dt_free(j->dt);
}

static void end_discard(struct server *s, struct job *j, struct answer *a)
{
    (void)s, (void)j, (void)a;
}

void job_discard(struct server *s, struct dt *dt)
{
    struct dt_summary sum;
    dt_summary(dt, &sum);
    struct job *j = NULL;
    if (s->workers != NULL && !s->stopping && !cost_at_once(COST_FREE, sum.memory / 1024))
        j = job_new(sizeof *j, run_discard, end_discard);
    if (j == NULL) {
        dt_free(dt);
        return;
    }
    j->dt = dt;
    j->memory = server_reservation(s, BUDGET_EDITS);
    reservation_set(&j->memory, sum.memory); /* until it is freed */
    job_aside(s, NULL, j, JOB_SHORT);
}
