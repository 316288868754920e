/* divide_sorted.c - builds the triangulation of sorted points by the steps of a plan (plan.h). It makes the blocks from left
 * to right, and merges each with parts on its left as often as the plan says.
 *
 *     points    3     2     4      1
 *     merges    0     1     0      2
 *     part   [0 1 2][3 4][5 6 7 8][9]      the merge after 3 4 makes one part of the first two
 *
 * A part is stored at its end, in the two records that it does not need (part.h), so the part on the left of any vertex is
 * known by its place.
 *
 * Several threads make the parts of slices of the vertices, and merge inside of each slice as far as possible. Then each part
 * meets a neighbour. A part that is to be merged with the part on its left meets it where it begins, any other part meets its
 * neighbour where it ends. The second thread at that place merges the two and continues with the result. So the merges are
 * the same as on one thread. */
#include "core/control/parallel.h"
#include "core/divide/divide.h"
#include "core/divide/part.h"
#include "core/mesh/hull.h"

#define SLICES_PER_THREAD 32u

struct build {
    struct dt_merging merging;
    const uint16_t *step;
    uint32_t n;
    const struct dt_options *opt;
    struct dt_stop stop;
    atomic_uint finished; /* points of finished slices, for progress */
    unsigned slices;
};

/* The end of a part. */
struct end {
    struct dt_part part;
    uint32_t merges;     /* that join it with parts on its left, still to be done */
    uint32_t right;      /* the end of the part on its right, if that has come here */
    atomic_uint arrived; /* parts that have come here to be joined */
};
_Static_assert(sizeof(struct end) <= 2 * 8 * sizeof(uint32_t),
               "an end takes two records of the mesh");

static bool good(const struct build *b)
{
    return dt_stop_status(&b->stop) == DT_OK;
}

static struct end *end_at(const struct build *b, uint32_t v)
{
    return (void *)(b->merging.half + 16 * (size_t)v - 16);
}

static uint32_t begin_of(const struct build *b, uint32_t end)
{
    return end - end_at(b, end)->part.n;
}

/* Joins the parts that meet at mid; the right one ends at `end`, as does the result. */
static void join(struct build *b, uint32_t mid, uint32_t end)
{
    struct end *e = end_at(b, end);
    e->part = dt_merge_parts(&b->merging, &end_at(b, mid)->part, &e->part,
                             DT_STEP_AXIS(b->step[mid]), mid);
    e->merges--;
}

/* ---- slices ---- */

static void report(struct build *b, uint32_t n)
{
    uint32_t finished = atomic_fetch_add_explicit(&b->finished, n, memory_order_relaxed) + n;
    if (b->opt->progress != NULL)
        atomic_store_explicit(b->opt->progress, (unsigned)((uint64_t)finished * 99 / b->n),
                              memory_order_relaxed);
}

/* The slice begins with the first block that begins in it. */
static uint32_t begin_of_slice(const struct build *b, unsigned i)
{
    uint32_t v = dt_slice(b->n, i, b->slices);
    while (v < b->n && DT_STEP_POINTS(b->step[v]) == 0)
        v++;
    return v;
}

/* The block at vertex v, and the merges after it with parts that begin at `lo` or later and await no merge
 * themselves. Returns its end. */
static uint32_t run_step(struct build *b, uint32_t lo, uint32_t v)
{
    uint32_t points = DT_STEP_POINTS(b->step[v]), end = v + points, begin;
    struct end *e = end_at(b, end);
    e->part = dt_block(&b->merging, v, points);
    e->merges = DT_STEP_MERGES(b->step[end - 1]);
    for (begin = v; e->merges > 0 && begin > lo && end_at(b, begin)->merges == 0;
         begin = begin_of(b, end))
        join(b, begin, end);
    return end;
}

/* The part that ends there meets its neighbours. */
static void meet(struct build *b, uint32_t end)
{
    while (good(b)) {
        bool begins = end_at(b, end)->merges > 0; /* it waits for the part on its left */
        uint32_t at = begins ? begin_of(b, end) : end;
        if (at == b->n)
            return;
        if (begins)
            end_at(b, at)->right = end;
        if (atomic_fetch_add(&end_at(b, at)->arrived, 1) == 0)
            return;
        end = end_at(b, at)->right;
        join(b, at, end);
    }
}

static void run_slice(void *arg, unsigned i)
{
    enum { REPORT = 8192 }; /* points between two polls */
    struct build *b = arg;
    uint32_t lo = begin_of_slice(b, i), hi = begin_of_slice(b, i + 1), reported = lo;
    for (uint32_t v = lo; v < hi && good(b);) {
        v = run_step(b, lo, v);
        if (v - reported >= REPORT || v == hi) {
            report(b, v - reported);
            reported = v;
            dt_stopped(&b->stop);
        }
    }
    for (uint32_t end = hi; end > lo && good(b); end = begin_of(b, end))
        if (end < hi)
            atomic_init(&end_at(b, end)->arrived, 0);
    for (uint32_t end = hi, next; end > lo && good(b); end = next) {
        next = begin_of(b, end);
        meet(b, end);
    }
}

/* Returns the part of all points. */
static struct dt_part run(struct build *b)
{
    unsigned threads = dt_threads_for(b->opt->pool, b->n);
    b->slices = threads > 1 ? threads * SLICES_PER_THREAD : 1;
    for (unsigned i = 1; i < b->slices; i++)
        atomic_init(&end_at(b, begin_of_slice(b, i))->arrived, 0);
    dt_run(b->opt->pool, b->slices, run_slice, b);
    return end_at(b, b->n)->part;
}

/* The records of the whole mesh are complete. Merges keep leaving[] of every vertex right, so only the hull has to be
 * settled. */
static void finish(struct build *b, struct dt_mesh *m, const struct dt_part *all)
{
    m->vertices = b->n;
    m->tri_end = b->n > 1 ? 2 * b->n - 2 : 0;
    m->dead = m->ghosts = 0;
    m->free_list = m->hull = DT_NONE;
    if (b->n == 1)
        m->leaving[0] = DT_NONE;
    if (b->n > 1)
        m->ghosts = dt_hull_settle(m, all->ghost, &b->stop);
}

enum dt_status dt_divide_sorted(const struct dt_point *p, uint32_t n, const uint16_t *step,
                                struct dt_mesh *m, const struct dt_options *opt)
{
    static const struct dt_options none;
    struct build b = {
        .step = step, .n = n, .opt = opt == NULL ? &none : opt, .stop = dt_stop_of(opt)};
    if (dt_mesh_reserve(m, n, 2 * n) != DT_OK)
        dt_stop_because(&b.stop, DT_NOMEM);
    b.merging = dt_merging_of(p, m, &b.stop);
    struct dt_part all = {0};
    if (good(&b) && n > 0)
        all = run(&b);
    if (good(&b))
        finish(&b, m, &all);
    if (!good(&b))
        dt_mesh_clear(m);
    return dt_stop_status(&b.stop);
}
