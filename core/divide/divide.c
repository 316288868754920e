/* divide.c - divide and conquer over grid order [Dwyer 1987; the grid is the paper's], in place on
 * the final arrays.
 *
 *     in --- sorted by tiles ---> spare --- each tile by cells ---> p --- in blocks of <= 6 ---> plan
 *                                   ^                               |      (small_sort.c)                |
 *                                   '----- zoom: a crowded cell ----'                             v
 *                                                                                               blocks
 *     mesh  <--- the halves of ever larger boxes joined along alternating cuts (merge.c) ---  (block.c)
 *
 *           the keys of one grid        +-----+-----+
 *           and what its bits cut:      | 010 | 011 |
 *                                       +-----+-----+
 *           1xx | 11x | 111 ...         | 000 | 001 |
 *                                       +-----+-----+
 *
 * A merge sees two vertices on either side of a cut. It knits the sides from the lower tangent to the upper one, and
 * turns ghosts into triangles and back in their own records.
 *
 * The way down, in this file, sorts the points and records the blocks and merges (plan.h); the way up carries these
 * out (divide_sorted.c). A load does the way down, because that makes coincident points neighbours; its build then
 * only does the way up.
 *
 * A range [lo, hi) of the sorted points owns the vertices lo .. hi - 1 and the records 2 lo .. 2 hi - 1 of the mesh.
 * So parts need no allocator and no locks (part.h). Until blocks fill the mesh, it is the scratch memory for points:
 * fresh memory is too expensive to be used once.
 *
 * With several threads, all of them sort a range of a large share of the points together; a range of a small share
 * becomes a task. Then threads take tasks, from left to right. The ranges are disjoint, so no two threads ever
 * touch the same place, and the result is the same as on one thread.
 *
 * The recursion goes down the bits of the key; where one grid ends, the next one begins. A tile gets its own cells. A
 * crowded cell gets a grid on its own tight box (a zoom). A cell of at most a dozen points gets one cut between two
 * blocks (small_sort.c). Along a curve, a grid is a row of strips (order.c).
 * If there are a few outliers, the grid fits the other points, and its outermost cells contain the outliers. If
 * three zooms in a row leave more than half of the points in one cell, the range is cut at its median. Its halves
 * get grids again, so the depth is at most about four grids for every halving.
 *
 * The gain of each technique: ns per point without it, on sets of 1e4 uniform points. All of them together need 138.
 * (gcc 12, Zen 3 at 3.4 GHz; best of five runs, which differ by some per cent.)
 *
 *     two products a candidate, not a new in-circle test         196
 *     blocks of up to 6 points instead of 3                      175
 *     cuts that alternate instead of all columns first           171
 *     2 points a cell instead of 8                               169
 *     candidates of both sides examined together, in lanes       164
 *     blocks sorted without a branch, compiled for each size     157
 *     no other coordinates packed into vectors (see Makefile)    147
 *     next and previous half edge by arithmetic, not a branch    145
 *     leaving[] remembers the ghost at every hull vertex         141
 *     points stored temporarily in the mesh: at 1e6 points 171 instead of 185
 *     tiles: at 1e7 points 237 instead of 213 (before the lanes), at 1e6 no difference
 *
 * On other sets, of 2e5 points, with the techniques added one after the other:
 *
 *                                             circle   near_collinear   lattice
 *     none of the following                     191         186           101
 *     a dozen points need no grid               182         173           101
 *     strips along a curve                      167         148           101
 *     zero seen before it is computed           167         150            79
 *     two filters, of which a merge has one     150         144            79
 *
 * Later, for 3e4 uniform points, the least of many alternating runs was 120. It became 117 when candidates and apexes
 * were looked up at a change of a ghost and not at every step, 114 with deletions inlined, 111 with signs from sign bits.
 * Two experiments brought no gain: the lookup of the ghost after the next one, and a search for the tangent without a
 * branch. One function for both sides of a merge, with an index instead of a branch, was 2 % slower. Keeping the sight of
 * an apex when the apex became the candidate was 5 % slower.
 */
#include "core/divide/divide.h"

#include <string.h>

#include "core/divide/divide_level.h"
#include "core/memory/memory.h"

#define ASK_TO_STOP 4096u /* points that are worth the question */
#define TASKS_PER_THREAD 16u
#define LAST_QUARTER 8u      /* times as many tasks in there */
#define RANGES_PER_THREAD 4u /* crowded cells of a larger share are not left to one thread */

/* Cells of a level that one thread will sort. */
struct task {
    struct task *next;
    const struct dt_level *level;
    uint32_t key, s;
};

/* Goes down the grids. */
struct walk {
    struct dt_division *d;
    struct dt_arena arena; /* owns levels, and tasks */
    unsigned threads;      /* that sort a range together; one: there are no tasks */
    struct task *first, **end;
    uint32_t tasks;
    struct task *_Atomic next; /* to be run */
};

static void *take(struct walk *w, size_t size)
{
    void *p = dt_arena_take(&w->arena, 1, size);
    if (p == NULL)
        dt_stop_because(&w->d->stop, DT_NOMEM);
    return p;
}

static void add_task(struct walk *w, struct task it)
{
    struct task *task = take(w, sizeof *task);
    if (task == NULL)
        return;
    *task = it;
    *w->end = task;
    w->end = &task->next;
    w->tasks++;
}

/* Whether n points from lo on, with s bits of their key to go, are left to one of several threads. The last tasks are smaller,
 * so that all threads have something to do until the end. */
static bool is_task(const struct walk *w, uint32_t lo, uint32_t n, uint32_t s)
{
    uint32_t all = w->d->n;
    uint32_t limit = all / (w->threads * (s > 0 ? TASKS_PER_THREAD : RANGES_PER_THREAD));
    if (s > 0 && lo >= all - all / 4)
        limit /= LAST_QUARTER;
    return n <= limit || n <= DT_BLOCK;
}

static void sort_range(struct walk *w, struct dt_source src, uint32_t lo, uint32_t n,
                       unsigned skew);

/* Sorts the points of a level whose key starts with `key`, with s bits to go. */
static void sort_cells(struct walk *w, const struct dt_level *level, uint32_t key, uint32_t s)
{
    struct dt_division *d = w->d;
    uint32_t hi, lo = dt_level_range(level, key, s, &hi), n = hi - lo, mid;
    if (n == 0)
        return;
    if (w->threads > 1 && is_task(w, lo, n, s)) {
        add_task(w, (struct task){.level = level, .key = key, .s = s});
        return;
    }
    if (n <= DT_BLOCK && !level->spare) {
        dt_plan_few(&d->plan, d->p, d->from, lo, n);
        return;
    }
    if (n <= DT_BLOCK || s == 0) {
        sort_range(w, dt_level_source(d, level, lo), lo, n, level->skew);
        return;
    }
    if (n > ASK_TO_STOP && dt_stopped(&d->stop))
        return;
    (void)dt_level_range(level, 2 * key, s - 1, &mid);
    dt_plan_cut(&d->plan, lo, mid, hi, level->order.axis[s - 1]);
    sort_cells(w, level, 2 * key, s - 1);
    sort_cells(w, level, 2 * key + 1, s - 1);
}

static void sort_halves(struct walk *w, struct dt_source src, uint32_t lo, uint32_t n)
{
    struct dt_division *d = w->d;
    unsigned axis;
    uint32_t half = dt_level_halve(d, src, lo, n, &axis), mid = lo + half;
    if (dt_stopped(&d->stop))
        return;
    dt_plan_cut(&d->plan, lo, mid, lo + n, axis);
    sort_range(w, (struct dt_source){d->p + lo, d->from + lo}, lo, half, 0);
    sort_range(w, (struct dt_source){d->p + mid, d->from + mid}, mid, n - half, 0);
}

/* Sorts the points src[0 .. n-1], n > 0, to the places lo .. lo + n - 1. */
static void sort_range(struct walk *w, struct dt_source src, uint32_t lo, uint32_t n, unsigned skew)
{
    struct dt_division *d = w->d;
    if (n <= DT_FEW) {
        for (uint32_t i = 0; src.p != d->p + lo && i < n; i++) {
            d->p[lo + i] = src.p[i];
            d->from[lo + i] = src.from == NULL ? i : src.from[i];
        }
        dt_plan_few(&d->plan, d->p, d->from, lo, n);
        return;
    }
    struct dt_arena_mark mark = dt_arena_mark(&w->arena);
    struct dt_level *level = take(w, sizeof *level);
    if (dt_stopped(&d->stop))
        return;
    enum dt_opening opening = dt_level_open(d, &w->arena, w->threads, src, lo, n, skew, level);
    if (opening == DT_LEVEL_OPEN)
        sort_cells(w, level, 0, level->order.bits);
    if (w->threads == 1)
        dt_arena_return(&w->arena, mark);
    if (opening == DT_LEVEL_SKEWED)
        sort_halves(w, src, lo, n);
}

/* The next task, from left to right. */
static void run_task(void *arg, unsigned i)
{
    struct walk *all = arg, w = {.d = all->d, .arena = {.pages = all->d->pages}, .threads = 1};
    struct task *task = atomic_load(&all->next);
    while (!atomic_compare_exchange_weak(&all->next, &task, task->next))
        continue;
    sort_cells(&w, task->level, task->key, task->s);
    dt_arena_clear(&w.arena);
}

enum dt_status dt_divide_sort(struct dt_source in, uint32_t n, struct dt_named out,
                              struct dt_named spare, struct dt_plan plan, struct dt_pages *pages,
                              const struct dt_options *opt)
{
    static const struct dt_options none;
    struct dt_division d = {.p = out.p,
                            .from = out.from,
                            .n = n,
                            .plan = plan,
                            .spare = spare,
                            .pages = pages,
                            .opt = opt == NULL ? &none : opt,
                            .stop = dt_stop_of(opt)};
    struct walk w = {.d = &d,
                     .arena = {.pages = pages},
                     .threads = dt_threads_for(d.opt->pool, n),
                     .end = &w.first};
    for (struct dt_piece at = dt_pieces(0, n); dt_next_piece(&d.stop, &at);)
        memset(plan.step + at.a, 0, (at.b - at.a) * sizeof *plan.step);
    if (n > 0)
        sort_range(&w, in, 0, n, 0);
    atomic_init(&w.next, w.first);
    if (w.tasks > 0 && dt_stop_status(&d.stop) == DT_OK)
        dt_run(d.opt->pool, w.tasks, run_task, &w);
    dt_arena_clear(&w.arena);
    return dt_stop_status(&d.stop);
}

/* Until merges write it, the mesh is the scratch memory: it has 64 bytes a point. */
static enum dt_status sort_in_mesh(struct dt_source in, uint32_t n, struct dt_named out,
                                   struct dt_mesh *m, const struct dt_options *opt, uint16_t **step)
{
    uint32_t *half = m->half;
    struct dt_named spare = {(void *)half, half + 4 * (size_t)n};
    struct dt_plan plan = {.step = (void *)(half + 5 * (size_t)n)};
    enum dt_status status = dt_divide_sort(in, n, out, spare, plan, m->pages, opt);
    if (status != DT_OK)
        return status;
    *step = dt_array_new_in(m->pages, n, sizeof **step);
    if (*step == NULL)
        return DT_NOMEM;
    memcpy(*step, plan.step, n * sizeof **step);
    return DT_OK;
}

enum dt_status dt_divide(const struct dt_point *in, const uint32_t *names, uint32_t n,
                         struct dt_point *p, uint32_t *from, struct dt_mesh *m,
                         const struct dt_options *opt)
{
    uint16_t *step = NULL;
    enum dt_status status = dt_mesh_reserve(m, n, 2 * n);
    if (status == DT_OK && n > 0)
        status = sort_in_mesh((struct dt_source){in, names}, n, (struct dt_named){p, from}, m, opt,
                              &step);
    if (status == DT_OK)
        status = dt_divide_sorted(p, n, step, m, opt);
    else
        dt_mesh_clear(m);
    dt_array_free(step);
    return status;
}
