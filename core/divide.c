/* divide.c - divide and conquer over grid order [Dwyer 1987; the grid is the paper's], in place on
 * the final arrays.
 *
 *     in --- sorted by tiles ---> aside --- each tile by cells ---> p --- in blocks of <= 6 ---.
 *                                   ^                               |      (block.c)           |
 *                                   '----- zoom: a crowded cell ----'                          |
 *                                                                                              v
 *     mesh  <--- the halves of ever larger boxes joined along alternating cuts (merge.c) --- blocks
 *
 *           the keys of one grid        +-----+-----+     A join sees two neighbours on either side
 *           and what its bits cut:      | 010 | 011 |     of a cut, knits them from the lower to the
 *                                       +-----+-----+     upper tangent, and turns ghosts into
 *           1xx | 11x | 111 ...         | 000 | 001 |     triangles and back in their own records.
 *                                       +-----+-----+
 *
 * A range of the sorted points [lo, hi) owns the vertices lo .. hi - 1 and the records 2 lo .. 2 hi -
 * 1 of the mesh, so parts need no allocator and no locks (merge.h). Until blocks fill them, the
 * records are where points are put aside: fresh memory is too expensive to be used once.
 *
 * The recursion goes down the bits of the key; where one grid ends, the next one begins: a tile gets
 * its own cells, a crowded cell a grid on its own tight box (a zoom), or, if it holds a dozen points
 * at most, one cut between two blocks (few.c). Along a curve, a grid is a row of strips (order.c).
 * Where a few points lie far out, it suits the others, and its outermost cells take in the few. If
 * three zooms in a row leave more than half of the points in one cell, the range is cut at its median,
 * and grids have their chance again: so the depth is bounded by about four grids for every halving.
 *
 * The way down can also be gone on its own (dt_divide_sort): a load does that, since it makes coincident points
 * neighbours, and records the blocks and merges that are left for the build (plan.h, divide_sorted.c).
 *
 * What each trick is worth: ns per point with all of them but that one, on sets of 1e4 uniform
 * points, where all of them together need 138 (gcc 12, Zen 3 at 3.4 GHz; best of five runs, which
 * differ by some per cent).
 *
 *     two products a candidate, not a new in-circle test         196
 *     blocks of up to 6 points instead of 3                      175
 *     cuts that alternate instead of all columns first           171
 *     2 points a cell instead of 8                               169
 *     candidates of both sides looked at together, in lanes      164
 *     blocks sorted without a branch, compiled for each size     157
 *     no other coordinates packed into vectors (see Makefile)    147
 *     next and previous half edge by arithmetic, not a branch    145
 *     leaving[] remembers the ghost at every hull vertex         141
 *     points put aside in the mesh: at 1e6 points 171 instead of 185
 *     tiles: at 1e7 points 237 instead of 213 (before the lanes), at 1e6 no difference
 *
 * and on other sets, of 2e5 points, one after the other:
 *
 *                                             circle   near_collinear   lattice
 *     none of the following                     191         186           101
 *     a dozen points need no grid               182         173           101
 *     strips along a curve                      167         148           101
 *     zero seen before it is computed           167         150            79
 *     two filters, of which a merge has one     150         144            79
 *
 * Points must be distinct: the set has set coincident ones aside (points.h). */
#include "core/divide.h"

#include <string.h>

#include "core/block.h"
#include "core/divide_level.h"
#include "core/few.h"
#include "core/hull.h"
#include "core/memory.h"

#define ASK_TO_STOP 4096u /* points that are worth the question */

static void report(struct dt_division *d, uint32_t n)
{
    uint32_t finished = atomic_fetch_add_explicit(&d->finished, n, memory_order_relaxed) + n;
    if (d->opt->progress != NULL)
        atomic_store_explicit(d->opt->progress, (unsigned)((uint64_t)finished * 99 / d->n),
                              memory_order_relaxed);
}

/* At most DT_FEW points, which are in p. */
static struct dt_part few(struct dt_division *d, uint32_t lo, uint32_t n)
{
    if (d->plan.step != NULL)
        return dt_plan_few(&d->plan, d->p, d->from, lo, n);
    return dt_few(&d->merging, d->p, d->from, lo, n);
}

struct dt_part dt_divide_cells(struct dt_division *d, struct dt_arena *arena,
                               const struct dt_level *level, uint32_t key, uint32_t s)
{
    uint32_t hi, lo = dt_level_range(level, key, s, &hi), n = hi - lo;
    if (n == 0)
        return level->done;
    if (n <= DT_BLOCK && !level->tiles) /* tiles lie apart */
        return few(d, lo, n);
    if (s == 0) {
        struct dt_part part =
            dt_divide_range(d, arena, dt_level_source(d, level, lo, n), lo, n, level->skew);
        if (level->tiles)
            report(d, n);
        return part;
    }
    if (n > ASK_TO_STOP && dt_stopped(&d->stop))
        return (struct dt_part){0};
    struct dt_part a = dt_divide_cells(d, arena, level, 2 * key, s - 1);
    struct dt_part b = dt_divide_cells(d, arena, level, 2 * key + 1, s - 1);
    uint32_t mid = level->lo + level->start[(2 * (size_t)key + 1) << (s - 1)];
    return dt_divide_join(d, &a, &b, level->order.axis[s - 1], mid);
}

static struct dt_part divide_halves(struct dt_division *d, struct dt_arena *arena,
                                    struct dt_source src, uint32_t lo, uint32_t n)
{
    unsigned axis;
    uint32_t half = n / 2, mid = lo + half;
    dt_level_median(d, src, lo, n, &axis);
    struct dt_part a =
        dt_divide_range(d, arena, (struct dt_source){d->p + lo, d->from + lo}, lo, half, 0);
    struct dt_part b =
        dt_divide_range(d, arena, (struct dt_source){d->p + mid, d->from + mid}, mid, n - half, 0);
    return dt_divide_join(d, &a, &b, axis, mid);
}

struct dt_part dt_divide_range(struct dt_division *d, struct dt_arena *arena, struct dt_source src,
                               uint32_t lo, uint32_t n, unsigned skew)
{
    if (n <= DT_FEW) {
        if (src.p != d->p + lo) {
            memcpy(d->p + lo, src.p, n * sizeof *src.p);
            for (uint32_t i = 0; i < n; i++)
                d->from[lo + i] = src.from == NULL ? i : src.from[i];
        }
        return few(d, lo, n);
    }
    struct dt_part part = {0};
    if (dt_stopped(&d->stop))
        return part;
    struct dt_arena_mark mark = dt_arena_mark(arena);
    struct dt_level level;
    enum dt_opening opening = dt_level_open(d, arena, 1, src, lo, n, skew, &level);
    if (opening == DT_LEVEL_OPEN)
        part = dt_divide_cells(d, arena, &level, 0, level.order.bits);
    dt_arena_return(arena, mark);
    if (opening == DT_LEVEL_SKEWED)
        part = divide_halves(d, arena, src, lo, n);
    return part;
}

void dt_divide_finish(struct dt_mesh *m, uint32_t n, const struct dt_part *all,
                      const struct dt_pool *pool, struct dt_stop *stop)
{
    m->vertices = n;
    m->tri_end = n > 1 ? 2 * n - 2 : 0;
    m->dead = m->ghosts = 0;
    m->free_list = m->hull = DT_NONE;
    if (n == 1)
        m->leaving[0] = DT_NONE;
    if (n > 1)
        m->ghosts = dt_hull_settle_built(m, all->ghost, pool, stop);
}

static struct dt_part divide_all(struct dt_division *d, struct dt_source in)
{
    unsigned threads = dt_threads_for(d->opt->pool, d->n);
    struct dt_part all = {0};
    if (threads > 1) {
        all = dt_divide_tasks(d, in, threads);
    } else if (d->n > 0) {
        struct dt_arena arena = {.pages = d->merging.mesh->pages};
        all = dt_divide_range(d, &arena, in, 0, d->n, 0);
        dt_arena_clear(&arena);
    }
    return all;
}

enum dt_status dt_divide(const struct dt_point *in, const uint32_t *names, uint32_t n,
                         struct dt_point *p, uint32_t *from, struct dt_mesh *m,
                         const struct dt_options *opt)
{
    static const struct dt_options none;
    struct dt_division d = {.merging = {.p = p, .mesh = m},
                            .p = p,
                            .from = from,
                            .n = n,
                            .opt = opt == NULL ? &none : opt,
                            .stop = dt_stop_of(opt)};
    d.merging.stop = &d.stop;
    if (dt_mesh_reserve(m, n, 2 * n) != DT_OK) {
        dt_stop_because(&d.stop, DT_NOMEM);
    } else {
        struct dt_part all = divide_all(&d, (struct dt_source){in, names});
        if (dt_stop_status(&d.stop) == DT_OK)
            dt_divide_finish(m, n, &all, d.opt->pool, &d.stop);
    }
    if (dt_stop_status(&d.stop) != DT_OK)
        dt_mesh_clear(m);
    return dt_stop_status(&d.stop);
}

enum dt_status dt_divide_sort(struct dt_source in, uint32_t n, struct dt_named out,
                              struct dt_named spare, struct dt_plan plan, struct dt_pages *pages,
                              const struct dt_options *opt)
{
    struct dt_mesh none = {.pages = pages};
    struct dt_division d = {.merging = {.p = out.p, .mesh = &none},
                            .p = out.p,
                            .from = out.from,
                            .n = n,
                            .opt = opt,
                            .plan = plan,
                            .spare = spare,
                            .stop = dt_stop_of(opt)};
    d.merging.stop = &d.stop;
    divide_all(&d, in);
    return dt_stop_status(&d.stop);
}
