/* worker.c - see worker.h. One mutex guards everything; what is done under it is a few pointer
 * moves. */
#include "server/worker.h"

#include "server/priority.h"

#include <pthread.h>
#include <stdint.h>
#include <stdlib.h>
#include <sys/eventfd.h>
#include <unistd.h>

struct queue {
    struct work *first, *last;
    unsigned n;
};

/* One call of the core's pool: n jobs, taken by number. Lives on the caller's stack. */
struct batch {
    struct batch *next;
    void (*job)(void *arg, unsigned i);
    void *arg;
    unsigned n;
    atomic_uint taken;
    unsigned helpers; /* workers inside, guarded by the mutex */
};

struct workers {
    pthread_mutex_t mutex;
    pthread_cond_t wake;   /* there is work, or a batch to help, or it is over */
    pthread_cond_t helped; /* a helper has left its batch */
    struct queue queue[2]; /* by enum work_kind */
    struct queue done;
    struct batch *batches; /* those that may still have jobs to take */
    bool stopping;
    int event;
    struct dt_pool pool;
    unsigned threads;
    pthread_t thread[];
};

static void push(struct queue *q, struct work *work)
{
    work->next = NULL;
    if (q->first == NULL)
        q->first = work;
    else
        q->last->next = work;
    q->last = work;
    q->n++;
}

static struct work *pop(struct queue *q)
{
    struct work *work = q->first;
    if (work != NULL) {
        q->first = work->next;
        q->n--;
    }
    return work;
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
    for (struct batch *b = w->batches; b != NULL; b = b->next)
        if (has_jobs(b))
            return b;
    return NULL;
}

static void unlink_batch(struct workers *w, struct batch *b)
{
    struct batch **at = &w->batches;
    while (*at != b)
        at = &(*at)->next;
    *at = b->next;
}

static void pool_run(void *ctx, unsigned n, void (*job)(void *arg, unsigned i), void *arg)
{
    struct workers *w = ctx;
    struct batch b = {.job = job, .arg = arg, .n = n};
    pthread_mutex_lock(&w->mutex);
    b.next = w->batches;
    w->batches = &b;
    pthread_cond_broadcast(&w->wake);
    pthread_mutex_unlock(&w->mutex);
    take_jobs(&b);
    pthread_mutex_lock(&w->mutex);
    unlink_batch(w, &b); /* nobody enters any more; b may go when the last helper has left */
    while (b.helpers > 0)
        pthread_cond_wait(&w->helped, &w->mutex);
    pthread_mutex_unlock(&w->mutex);
}

/* ---- threads ---- */

/* The mutex is held on entry and on return, not in between. */
static void do_work(struct workers *w, struct work *work)
{
    pthread_mutex_unlock(&w->mutex);
    work->run(work);
    pthread_mutex_lock(&w->mutex);
    bool first = w->done.first == NULL;
    push(&w->done, work);
    uint64_t one = 1;
    /* An eventfd takes eight bytes or fails for a reason that cannot occur: its counter is near
     * zero. */
    if (first && write(w->event, &one, sizeof one) != (ssize_t)sizeof one)
        abort();
}

static void help(struct workers *w, struct batch *b)
{
    b->helpers++;
    pthread_mutex_unlock(&w->mutex);
    take_jobs(b);
    pthread_mutex_lock(&w->mutex);
    if (--b->helpers == 0)
        pthread_cond_broadcast(&w->helped);
}

/* Runs until the workers stop and what this thread may do is done. */
static void *serve(struct workers *w, bool all)
{
    pthread_mutex_lock(&w->mutex);
    for (;;) {
        struct work *work = pop(&w->queue[WORK_SHORT]);
        if (work == NULL && all)
            work = pop(&w->queue[WORK_LONG]);
        struct batch *b = work == NULL && all ? batch_to_help(w) : NULL;
        if (work != NULL)
            do_work(w, work);
        else if (b != NULL)
            help(w, b);
        else if (w->stopping)
            break;
        else
            pthread_cond_wait(&w->wake, &w->mutex);
    }
    pthread_mutex_unlock(&w->mutex);
    return NULL;
}

static void *serve_all(void *arg)
{
    priority_patient();
    return serve(arg, true);
}

static void *serve_short(void *arg)
{
    return serve(arg, false);
}

/* ---- life ---- */

struct workers *workers_new(unsigned threads)
{
    struct workers *w = calloc(1, sizeof *w + (threads + 1) * sizeof w->thread[0]);
    if (w == NULL)
        return NULL;
    w->pool = (struct dt_pool){.threads = threads, .run = pool_run, .ctx = w};
    w->event = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
    pthread_mutex_init(&w->mutex, NULL);
    pthread_cond_init(&w->wake, NULL);
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
    pthread_cond_broadcast(&w->wake);
    pthread_mutex_unlock(&w->mutex);
    for (unsigned i = 0; i < w->threads; i++)
        pthread_join(w->thread[i], NULL);
    if (w->event >= 0)
        close(w->event);
    pthread_cond_destroy(&w->helped);
    pthread_cond_destroy(&w->wake);
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
    /* Broadcast: a single waiter that is woken might be the one that may not do it. */
    pthread_cond_broadcast(&w->wake);
    pthread_mutex_unlock(&w->mutex);
}

struct work *workers_collect(struct workers *w)
{
    uint64_t count;
    pthread_mutex_lock(&w->mutex);
    /* Emptying the counter under the mutex keeps it in step with the list; nothing to read is no
     * error. */
    ssize_t ignored = read(w->event, &count, sizeof count);
    (void)ignored;
    struct work *first = w->done.first;
    w->done = (struct queue){0};
    pthread_mutex_unlock(&w->mutex);
    return first;
}

const struct dt_pool *workers_pool(const struct workers *w)
{
    return &w->pool;
}
