/* pool.h - persistent threads for the core's jobs, as simple as possible. */
#pragma once

#include "core/delaunay.h"

struct pool;

/* threads >= 1, the caller's own included. NULL when out of memory or threads. */
struct pool *pool_new(unsigned threads);
void pool_free(struct pool *p);

/* The pool in the form that dt_options needs; borrows p. */
struct dt_pool pool_face(struct pool *p);
