/* pool.c - a round of jobs is announced under a lock; threads draw job numbers from an atomic
 * counter. */
#include "tests/bench/pool.h"

#include <pthread.h>
#include <stdlib.h>

enum { MAX_THREADS = 64 };

struct pool {
    pthread_mutex_t lock;
    pthread_cond_t start, finished;
    pthread_t thread[MAX_THREADS];
    unsigned threads, round, busy;
    bool closing;
    void (*job)(void *arg, unsigned i);
    void *arg;
    unsigned jobs;
    atomic_uint next;
};

static void draw_jobs(struct pool *p)
{
    unsigned i;
    while ((i = atomic_fetch_add(&p->next, 1)) < p->jobs)
        p->job(p->arg, i);
}

static void *work(void *arg)
{
    struct pool *p = arg;
    unsigned seen = 0;
    pthread_mutex_lock(&p->lock);
    for (;;) {
        while (p->round == seen && !p->closing)
            pthread_cond_wait(&p->start, &p->lock);
        if (p->closing)
            break;
        seen = p->round;
        pthread_mutex_unlock(&p->lock);
        draw_jobs(p);
        pthread_mutex_lock(&p->lock);
        if (--p->busy == 0)
            pthread_cond_signal(&p->finished);
    }
    pthread_mutex_unlock(&p->lock);
    return NULL;
}

static void run(void *ctx, unsigned n, void (*job)(void *arg, unsigned i), void *arg)
{
    struct pool *p = ctx;
    pthread_mutex_lock(&p->lock);
    p->job = job;
    p->arg = arg;
    p->jobs = n;
    p->next = 0;
    p->busy = p->threads - 1;
    p->round++;
    pthread_cond_broadcast(&p->start);
    pthread_mutex_unlock(&p->lock);
    draw_jobs(p);
    pthread_mutex_lock(&p->lock);
    while (p->busy > 0)
        pthread_cond_wait(&p->finished, &p->lock);
    pthread_mutex_unlock(&p->lock);
}

struct pool *pool_new(unsigned threads)
{
    struct pool *p = calloc(1, sizeof *p);
    if (p == NULL)
        return NULL;
    pthread_mutex_init(&p->lock, NULL);
    pthread_cond_init(&p->start, NULL);
    pthread_cond_init(&p->finished, NULL);
    for (p->threads = 1; p->threads < threads && p->threads < MAX_THREADS; p->threads++)
        if (pthread_create(&p->thread[p->threads], NULL, work, p) != 0)
            break;
    return p;
}

void pool_free(struct pool *p)
{
    pthread_mutex_lock(&p->lock);
    p->closing = true;
    pthread_cond_broadcast(&p->start);
    pthread_mutex_unlock(&p->lock);
    for (unsigned i = 1; i < p->threads; i++)
        pthread_join(p->thread[i], NULL);
    free(p);
}

struct dt_pool pool_face(struct pool *p)
{
    return (struct dt_pool){p->threads, run, p};
}
