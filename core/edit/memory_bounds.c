/* memory_bounds.c - upper bounds of the peak memory of work on a set: measured on families of point sets, and checked
 * by a test (tests/core/edit/memory_bounds_test.c). They count memory that is touched: the unused room of a large array
 * costs nothing. */
#include "core/control/parallel.h"
#include "core/delaunay_constraints.h"
#include "core/edit/arrivals.h"
#include "core/edit/update.h"
#include "core/set/set.h"

/* Bytes per vertex. A build makes coordinates and order (20), mesh (68) and a grid on every level of
 * the recursion; if vertices were deleted, also dense copies of coordinates and order. */
#define BUILD_BYTES 136
#define BUILD_DENSE_BYTES 24
#define PREPARE_BYTES 48

/* Bytes per point that is added as a vertex or as an alias; an alias takes more. */
#define ADD_BYTES 104

/* Bytes per existing point, if an index of their places must be built first. */
#define INDEX_BYTES (size_t)16

/* Bytes per existing point, if these are sorted together with the added ones (arrivals.c). */
#define SORT_BYTES (size_t)48

/* Bytes per constraint: its row, in the table and in the lists of its ends; while they grow, twice; and during a call. */
#define CONSTRAINT_BYTES (size_t)112

/* More bytes per constraint that a build makes a chain of edges, if others cover its edges, too. */
#define CHAIN_BYTES (size_t)32

#define THREAD_BYTES ((size_t)512 << 10)    /* for each thread's arena */
#define ADD_THREAD_BYTES ((size_t)64 << 10) /* the same while points are sorted */
#define COPIED_BYTES ((size_t)12 << 20)     /* of arrays so small that they are copied to grow */

/* The bytes that do not grow with the number of points. */
static size_t slack(size_t n)
{
    return n < 4096 ? 1024 + n * 256 : (size_t)1 << 20;
}

/* Returns how many threads besides the caller's work on n points. */
static size_t more_threads(const struct dt_options *opt, size_t n)
{
    return dt_threads_for(opt == NULL ? NULL : opt->pool, (uint32_t)n) - 1;
}

/* The memory of a build of n vertices. */
static size_t build_memory(const struct dt *t, size_t n, const struct dt_options *opt)
{
    size_t bytes = t->points.free_count > 0 ? BUILD_BYTES + BUILD_DENSE_BYTES : BUILD_BYTES;
    return n * bytes + more_threads(opt, n) * THREAD_BYTES + slack(n) +
           dt_constraints_count(t) * CHAIN_BYTES;
}

size_t dt_build_memory(const struct dt *t, const struct dt_options *opt)
{
    return build_memory(t, dt_points_vertices(&t->points), opt);
}

size_t dt_constrain_memory(const struct dt *t, size_t n)
{
    size_t rows = dt_constraints_count(t) + n;
    return rows * CONSTRAINT_BYTES + slack(rows);
}

size_t dt_prepare_memory(const struct dt *t)
{
    size_t n = dt_points_vertices(&t->points);
    return n * PREPARE_BYTES + slack(n);
}

size_t dt_add_memory(const struct dt *t, size_t n, const struct dt_options *opt)
{
    struct dt_summary sum;
    dt_summary(t, &sum);
    size_t vertices = dt_points_vertices(&t->points);
    size_t copied = sum.memory < COPIED_BYTES ? sum.memory : COPIED_BYTES;
    size_t bytes = copied / 2 * 3 + slack(vertices + n);
    bool later = t->triangulated && (!t->current || dt_is_large_batch(t, n));
    n = n < DT_MAX_POINTS - vertices ? n : DT_MAX_POINTS - vertices;
    if (t->points.places.bucket == NULL && (t->points.tol > 0 || later || !t->triangulated))
        bytes += vertices * INDEX_BYTES;
    if (dt_arrivals_suit(&t->points, n) && t->points.end > 0)
        bytes += vertices * SORT_BYTES;
    if (later)
        bytes += build_memory(t, vertices + n, opt);
    return bytes + n * ADD_BYTES + more_threads(opt, n) * ADD_THREAD_BYTES;
}
