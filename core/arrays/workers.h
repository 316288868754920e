/* workers.h - threads that last as long as one call, and the floating-point environment of a call. */
#pragma once

#include <fenv.h>

#include "core/control/parallel.h"
#include "core/delaunay.h"

/* The caller's environment, to be restored at the end of a call. */
fenv_t dt_call_begin(void);
void dt_call_end(const fenv_t *caller);

/* A pool (delaunay.h) that starts its threads for each run and joins them. Nothing to free. */
struct dt_workers {
    struct dt_pool pool;
};

/* pool.ctx points into *w. */
void dt_workers_init(struct dt_workers *w, unsigned workers);

/* Makes an empty set *t and calls build(ctx, opt), which fills it, with a pool of `workers` threads, within the floating-point environment
 * of a call. The caller owns *t, even if it fails. DT_NOMEM: there is no set; otherwise what build returns. */
enum dt_status dt_call_build(struct dt **t, struct dt_pages *pages, unsigned workers,
                             enum dt_status (*build)(void *ctx, const struct dt_options *opt),
                             void *ctx);

/* Answers to n questions in pieces: answer(ctx, from, n) gives the answers from .. from + n - 1. */
struct dt_pieces {
    enum dt_status (*answer)(void *ctx, size_t from, size_t n);
    void *ctx;
};

/* Runs all pieces; the first failure ends it and is returned. */
enum dt_status dt_answer_all(const struct dt_pieces *p, size_t n, unsigned workers);
