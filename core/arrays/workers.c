/* workers.c - see workers.h. A thread inherits the floating-point environment of the one that starts it. */
#include "core/arrays/workers.h"

#ifndef __wasm__ /* which has no threads */
#include <pthread.h>
#endif

#define PIECE 1024u /* questions: some tenths of a millisecond */

fenv_t dt_call_begin(void)
{
    fenv_t caller;
    fegetenv(&caller);
    fesetenv(FE_DFL_ENV);
    return caller;
}

void dt_call_end(const fenv_t *caller)
{
    fesetenv(caller);
}

/* ---- the pool ---- */

struct run {
    void (*job)(void *arg, unsigned i);
    void *arg;
    unsigned n;
    atomic_uint next; /* the next job that nobody has taken */
};

static void *work(void *arg)
{
    struct run *r = arg;
    for (unsigned i = atomic_fetch_add(&r->next, 1); i < r->n; i = atomic_fetch_add(&r->next, 1))
        r->job(r->arg, i);
    return NULL;
}

/* If no thread can be started, the caller's thread does everything. */
static void run_jobs(void *ctx, unsigned n, void (*job)(void *arg, unsigned i), void *arg)
{
    struct run r = {.job = job, .arg = arg, .n = n};
#ifdef __wasm__
    work(&r);
#else
    const struct dt_workers *w = ctx;
    pthread_t thread[DT_MAX_THREADS];
    unsigned started = 0;
    while (started + 1 < w->pool.threads && started + 1 < n &&
           pthread_create(&thread[started], NULL, work, &r) == 0)
        started++;
    work(&r);
    while (started > 0)
        pthread_join(thread[--started], NULL);
#endif
}

void dt_workers_init(struct dt_workers *w, unsigned workers)
{
    workers = workers > DT_MAX_THREADS ? DT_MAX_THREADS : workers;
    w->pool = (struct dt_pool){.threads = workers > 0 ? workers : 1, .run = run_jobs, .ctx = w};
}

enum dt_status dt_call_build(struct dt **t, struct dt_pages *pages, unsigned workers,
                             enum dt_status (*build)(void *ctx, const struct dt_options *opt),
                             void *ctx)
{
    struct dt_workers w;
    fenv_t caller = dt_call_begin();
    dt_workers_init(&w, workers);
    *t = dt_new_in(0, pages);
    enum dt_status s = *t == NULL ? DT_NOMEM : build(ctx, &(struct dt_options){.pool = &w.pool});
    dt_call_end(&caller);
    return s;
}

/* ---- pieces ---- */

struct answers {
    const struct dt_pieces *pieces;
    size_t n;
    struct dt_stop stop;
};

static void answer_piece(void *arg, unsigned i)
{
    struct answers *all = arg;
    size_t from = (size_t)i * PIECE, n = all->n - from < PIECE ? all->n - from : PIECE;
    if (dt_stop_status(&all->stop) != DT_OK)
        return;
    enum dt_status s = all->pieces->answer(all->pieces->ctx, from, n);
    if (s != DT_OK)
        dt_stop_because(&all->stop, s);
}

enum dt_status dt_answer_all(const struct dt_pieces *p, size_t n, unsigned workers)
{
    struct answers all = {.pieces = p, .n = n, .stop = dt_stop_of(NULL)};
    struct dt_workers w;
    dt_workers_init(&w, workers);
    if (n / PIECE >= UINT32_MAX)
        return DT_TOOBIG;
    dt_run(&w.pool, (unsigned)((n + PIECE - 1) / PIECE), answer_piece, &all);
    return dt_stop_status(&all.stop);
}
