/* parallel.h - one pass over an array as slices, on the threads of a pool or on the caller's. */
#pragma once

#include "core/control/stop.h"

#define DT_PARALLEL 4096u /* fewer points are not worth several threads */
#define DT_MAX_THREADS 64u

/* Returns how many threads pay off for n points: 1 without a pool. */
static inline unsigned dt_threads_for(const struct dt_pool *pool, uint32_t n)
{
    if (pool == NULL || pool->threads < 2 || n < DT_PARALLEL)
        return 1;
    return pool->threads < DT_MAX_THREADS ? pool->threads : DT_MAX_THREADS;
}

/* Calls job(arg, 0 .. n - 1), in any order and at once; without a pool here, one after the other. */
static inline void dt_run(const struct dt_pool *pool, unsigned n,
                          void (*job)(void *arg, unsigned i), void *arg)
{
    if (pool != NULL && n > 1) {
        pool->run(pool->ctx, n, job, arg);
        return;
    }
    for (unsigned i = 0; i < n; i++)
        job(arg, i);
}

/* Returns the start of slice i of `slices` in an array of n, which is the end of slice i - 1. */
static inline uint32_t dt_slice(uint32_t n, unsigned i, unsigned slices)
{
    return (uint32_t)((uint64_t)n * i / slices);
}

/* The same as a pass in pieces (stop.h). */
static inline struct dt_piece dt_slice_pieces(uint32_t n, unsigned i, unsigned slices)
{
    return dt_pieces(dt_slice(n, i, slices), dt_slice(n, i + 1, slices));
}
