/* worker.c - see worker.h. One mutex guards everything; it is held only for a few pointer operations.
 *
 * Idle threads sleep in two crews: one for short work, one for all work. New work wakes one thread, not
 * all of them. A thread chooses its work when it runs, not when it is woken, because a busy thread may
 * become free sooner. The thread of the short crew may find only long work, which it may not do, because the
 * short work has been taken. So unlock_and_wake compares the work with the number of threads
 * that have been signalled, both when work is submitted and whenever a thread has taken some. Invariant:
 * for all waiting work a thread has been signalled, or every thread that may do it is busy and looks for
 * more work before it sleeps. */
#include "server/jobs/worker.h"

#include "server/system/priority.h"

#include <pthread.h>
#include <stdlib.h>
#include <sys/eventfd.h>
#include <unistd.h>

struct queue {
    struct list list;
    unsigned n;
};

/* One call of the core's pool: n jobs, taken by number. Lives on the caller's stack. */
struct batch {
    struct list_link link; /* first */
    void (*job)(void *arg, unsigned i);
    void *arg;
    unsigned n;
    atomic_uint taken;
    unsigned helpers; /* workers inside, guarded by the mutex */
};

struct crew {
    pthread_cond_t wake;
    unsigned asleep; /* threads that wait for `wake`, including those that have been signalled */
    unsigned coming; /* of these, signalled and not awake yet; at most `asleep` */
};

enum { KINDS = WORK_SLOW + 1 };

struct workers {
    pthread_mutex_t mutex;
    struct crew brief, all; /* of the thread for short work; of those for all work */
    pthread_cond_t helped;  /* a helper has left its batch */
    struct queue queue[KINDS];
    unsigned slow, most_slow; /* threads that do slow work, and how many may */
    struct list done;
    struct list batches; /* those that may have jobs left */
    bool stopping;
    int event;
    struct dt_pool pool;
    unsigned threads;
    pthread_t thread[];
};

static void push(struct queue *q, struct work *work)
{
    list_append(&q->list, &work->link);
    q->n++;
}

static struct work *pop(struct queue *q)
{
    q->n -= q->n > 0;
    return list_pop(&q->list);
}

/* ---- sleeping and waking ---- */

static unsigned lesser(unsigned a, unsigned b)
{
    return a < b ? a : b;
}

/* The number of works of this kind that may be begun. */
static unsigned ready(const struct workers *w, enum work_kind kind)
{
    unsigned n = w->queue[kind].n;
    return kind == WORK_SLOW ? lesser(n, w->most_slow - w->slow) : n;
}

/* Returns how many more threads the batches could use. */
static unsigned jobs_left(const struct workers *w)
{
    unsigned n = 0;
    for (struct batch *b = list_first(&w->batches); b != NULL; b = list_next(&w->batches, b)) {
        unsigned taken = atomic_load(&b->taken);
        n += taken < b->n ? b->n - taken : 0;
    }
    return n;
}

static unsigned less(unsigned a, unsigned b)
{
    return a > b ? a - b : 0;
}

/* The number of threads of the crew to signal so that `wanted` have been signalled, or all; they count as signalled. */
static unsigned call_up_to(struct crew *c, unsigned wanted)
{
    unsigned n = less(lesser(wanted, c->asleep), c->coming);
    c->coming += n;
    return n;
}

static void signal_each(struct crew *c, unsigned n)
{
    while (n-- > 0)
        pthread_cond_signal(&c->wake);
}

/* Releases the mutex and wakes enough threads for the waiting work, in this order, because they need the mutex. The
 * short crew comes first, so that the other threads stay free for long work. */
static void unlock_and_wake(struct workers *w)
{
    struct crew *brief = &w->brief, *all = &w->all;
    unsigned n_brief = ready(w, WORK_SHORT);
    unsigned n_long = ready(w, WORK_LONG) + ready(w, WORK_SLOW) + jobs_left(w);
    unsigned short_calls = call_up_to(brief, less(n_brief, less(all->coming, n_long)));
    unsigned long_calls = call_up_to(all, n_long + less(n_brief, brief->coming));
    pthread_mutex_unlock(&w->mutex);
    signal_each(brief, short_calls);
    signal_each(all, long_calls);
}

/* A spurious wake-up may decrement `coming` on behalf of another thread. That thread still looks for work when
 * it wakes up; `coming` is a lower bound. */
static void sleep_with(struct workers *w, struct crew *c)
{
    c->asleep++;
    pthread_cond_wait(&c->wake, &w->mutex);
    c->asleep--;
    if (c->coming > 0)
        c->coming--;
}

/* ---- the core's pool ---- */

static void take_jobs(struct batch *b)
{
    for (;;) {
        unsigned i = atomic_fetch_add(&b->taken, 1);
        if (i >= b->n)
            return;
        b->job(b->arg, i);
    }
}

static bool has_jobs(struct batch *b)
{
    return atomic_load(&b->taken) < b->n;
}

static struct batch *batch_to_help(struct workers *w)
{
    for (struct batch *b = list_first(&w->batches); b != NULL; b = list_next(&w->batches, b))
        if (has_jobs(b))
            return b;
    return NULL;
}

static void pool_run(void *ctx, unsigned n, void (*job)(void *arg, unsigned i), void *arg)
{
    struct workers *w = ctx;
    struct batch b = {.job = job, .arg = arg, .n = n};
    pthread_mutex_lock(&w->mutex);
    list_prepend(&w->batches, &b.link);
    unlock_and_wake(w);
    take_jobs(&b);
    pthread_mutex_lock(&w->mutex);
    list_remove(
        &b.link); /* no helper can enter any more; b may be freed when the last one has left */
    while (b.helpers > 0)
        pthread_cond_wait(&w->helped, &w->mutex);
    pthread_mutex_unlock(&w->mutex);
}

/* ---- threads ---- */

/* The mutex is held on entry and on return. It is not held while the event is written: that wakes a reactor, which
 * may take this processor at once, and needs the mutex first. */
static void do_work(struct workers *w, enum work_kind kind, struct work *work)
{
    w->slow += kind == WORK_SLOW;
    unlock_and_wake(w); /* for what is left */
    work->run(work);
    pthread_mutex_lock(&w->mutex);
    w->slow -= kind == WORK_SLOW;
    bool first = list_is_empty(&w->done);
    list_append(&w->done, &work->link);
    pthread_mutex_unlock(&w->mutex);
    /* It could fail only if the counter were full, but it is near zero. */
    if (first && eventfd_write(w->event, 1) != 0)
        abort();
    pthread_mutex_lock(&w->mutex);
}

static void help(struct workers *w, struct batch *b)
{
    b->helpers++;
    unlock_and_wake(w); /* for what is left */
    take_jobs(b);
    pthread_mutex_lock(&w->mutex);
    if (--b->helpers == 0)
        pthread_cond_broadcast(&w->helped);
}

/* Takes the next work of a thread for all kinds, beginning with the kind after *kind, which becomes the kind of the work.
 * NULL: there is none. */
static struct work *take_turn(struct workers *w, enum work_kind *kind)
{
    for (int i = 0; i < KINDS; i++) {
        *kind = (*kind + 1) % KINDS;
        if (ready(w, *kind) > 0)
            return pop(&w->queue[*kind]);
    }
    return NULL;
}

/* Runs until the workers are stopping and no work is left that this thread may do. */
static void *serve(struct workers *w, struct crew *crew)
{
    bool all = crew == &w->all;
    enum work_kind kind = WORK_SHORT;
    pthread_mutex_lock(&w->mutex);
    for (;;) {
        struct work *work = all ? take_turn(w, &kind) : pop(&w->queue[WORK_SHORT]);
        struct batch *b = work == NULL && all ? batch_to_help(w) : NULL;
        if (work != NULL)
            do_work(w, kind, work);
        else if (b != NULL)
            help(w, b);
        else if (w->stopping)
            break;
        else
            sleep_with(w, crew);
    }
    pthread_mutex_unlock(&w->mutex);
    return NULL;
}

static void *serve_all(void *arg)
{
    priority_patient();
    return serve(arg, &((struct workers *)arg)->all);
}

static void *serve_short(void *arg)
{
    return serve(arg, &((struct workers *)arg)->brief);
}

/* ---- life ---- */

struct workers *workers_new(unsigned threads)
{
    struct workers *w = calloc(1, sizeof *w + (threads + 1) * sizeof w->thread[0]);
    if (w == NULL)
        return NULL;
    w->pool = (struct dt_pool){.threads = threads, .run = pool_run, .ctx = w};
    w->most_slow = threads > 1 ? threads - 1 : 1;
    w->event = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
    pthread_mutex_init(&w->mutex, NULL);
    pthread_cond_init(&w->brief.wake, NULL);
    pthread_cond_init(&w->all.wake, NULL);
    pthread_cond_init(&w->helped, NULL);
    for (; w->event >= 0 && w->threads <= threads; w->threads++)
        if (pthread_create(&w->thread[w->threads], NULL, w->threads == 0 ? serve_short : serve_all,
                           w) != 0)
            break;
    if (w->threads < threads + 1) {
        workers_free(w);
        return NULL;
    }
    return w;
}

void workers_free(struct workers *w)
{
    pthread_mutex_lock(&w->mutex);
    w->stopping = true;
    pthread_cond_broadcast(&w->brief.wake);
    pthread_cond_broadcast(&w->all.wake);
    pthread_mutex_unlock(&w->mutex);
    for (unsigned i = 0; i < w->threads; i++)
        pthread_join(w->thread[i], NULL);
    if (w->event >= 0)
        close(w->event);
    pthread_cond_destroy(&w->helped);
    pthread_cond_destroy(&w->brief.wake);
    pthread_cond_destroy(&w->all.wake);
    pthread_mutex_destroy(&w->mutex);
    free(w);
}

int workers_event(const struct workers *w)
{
    return w->event;
}

unsigned workers_backlog(struct workers *w)
{
    pthread_mutex_lock(&w->mutex);
    unsigned n = w->queue[WORK_LONG].n;
    pthread_mutex_unlock(&w->mutex);
    return n;
}

void workers_submit(struct workers *w, enum work_kind kind, struct work *work)
{
    pthread_mutex_lock(&w->mutex);
    push(&w->queue[kind], work);
    unlock_and_wake(w);
}

void workers_collect(struct workers *w, struct list *to)
{
    enum { AT_ONCE = 64 }; /* other clients come before the rest */
    eventfd_t count;
    struct work *work;
    pthread_mutex_lock(&w->mutex);
    for (int i = 0; i < AT_ONCE && (work = list_pop(&w->done)) != NULL; i++)
        list_append(to, &work->link);
    /* Reset under the mutex, so that no event for later work is lost. The counter may be empty still: then the event
     * follows, and there may be nothing to collect. */
    if (list_is_empty(&w->done))
        eventfd_read(w->event, &count);
    pthread_mutex_unlock(&w->mutex);
}

const struct dt_pool *workers_pool(const struct workers *w)
{
    return &w->pool;
}
