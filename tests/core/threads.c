/* threads.c - see threads.h. */
#include "tests/core/threads.h"

#include <pthread.h>

static _Thread_local unsigned threads; /* of the pool that this thread made last */

struct jobs {
    void (*job)(void *arg, unsigned i);
    void *arg;
    unsigned n;
    atomic_uint next;
};

static void *work(void *arg)
{
    struct jobs *j = arg;
    for (unsigned i = atomic_fetch_add(&j->next, 1); i < j->n; i = atomic_fetch_add(&j->next, 1))
        j->job(j->arg, i);
    return NULL;
}

static void run(void *ctx, unsigned n, void (*job)(void *arg, unsigned i), void *arg)
{
    struct jobs j = {.job = job, .arg = arg, .n = n};
    pthread_t thread[64];
    unsigned started = 0;
    (void)ctx;
    while (started + 1 < threads && pthread_create(&thread[started], NULL, work, &j) == 0)
        started++;
    work(&j);
    while (started > 0)
        pthread_join(thread[--started], NULL);
}

struct dt_pool threads_pool(unsigned n)
{
    threads = n;
    return (struct dt_pool){.threads = n, .run = run};
}
