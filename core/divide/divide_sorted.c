/* divide_sorted.c - builds the triangulation of sorted points by the steps of a plan (plan.h): blocks are pushed onto a
 * stack of parts, and merges join the upper two.
 *
 * For several threads, the merges of more than a small share of the points become a tree, whose leaves are tasks: ranges
 * of vertices whose steps make one part. Threads take tasks from left to right; the thread that finishes the second
 * child of a join does the join and continues upwards. The result is the same as on one thread. */
#include "core/control/parallel.h"
#include "core/divide/block.h"
#include "core/divide/divide.h"
#include "core/divide/merge.h"
#include "core/memory/memory.h"
#include "core/mesh/hull.h"

#define TASKS_PER_THREAD 32u
#define NONE UINT32_MAX

/* A task, if it has no children, or a join. */
struct node {
    uint32_t lo, hi; /* vertices */
    uint32_t child[2], parent;
    unsigned axis;
    atomic_uint finished; /* children */
    struct dt_part part;
};

struct build {
    struct dt_merging merging;
    const uint16_t *step;
    uint32_t n;
    const struct dt_options *opt;
    struct dt_stop stop;
    atomic_uint finished; /* points of finished tasks, for progress */
    uint32_t limit;       /* points of a task */
    struct node *node;    /* owns */
    uint32_t nodes, node_cap;
    uint32_t *task; /* owns: nodes from left to right */
    uint32_t tasks, task_cap;
};

static bool good(const struct build *b)
{
    return dt_stop_status(&b->stop) == DT_OK;
}

/* Room for one more item: the array, moved or not; NULL: out of memory, the build stops. */
static void *room_for_one(struct build *b, void *array, uint32_t used, uint32_t *cap, size_t size)
{
    if (used < *cap)
        return array;
    size_t want = dt_array_room(*cap, (size_t)used + 1, UINT32_MAX / 2);
    void *larger = dt_array_grow(array, used, want, size);
    if (larger == NULL)
        dt_stop_because(&b->stop, DT_NOMEM);
    else
        *cap = (uint32_t)want;
    return larger;
}

/* ---- a range of vertices ---- */

static void report(struct build *b, uint32_t n)
{
    uint32_t finished = atomic_fetch_add_explicit(&b->finished, n, memory_order_relaxed) + n;
    if (b->opt->progress != NULL)
        atomic_store_explicit(b->opt->progress, (unsigned)((uint64_t)finished * 99 / b->n),
                              memory_order_relaxed);
}

/* Parts that lie side by side. */
struct stack {
    struct dt_part *part; /* owns */
    uint32_t parts, cap;
};

/* The block at vertex v, and the merges after it, but for those that join the range with what is before. Returns where
 * it ends. */
static uint32_t run_step(struct build *b, struct stack *s, uint32_t v)
{
    uint32_t step = b->step[v], end = v + DT_STEP_POINTS(step);
    struct dt_part *part = room_for_one(b, s->part, s->parts, &s->cap, sizeof *part);
    if (part == NULL)
        return end;
    s->part = part;
    part += s->parts++;
    *part = dt_block(&b->merging, v, DT_STEP_POINTS(step));
    for (uint32_t k = DT_STEP_MERGES(step); k > 0 && s->parts > 1 && part->n > 0; k--, part--) {
        uint32_t mid = end - part->n;
        part[-1] = dt_merge_parts(&b->merging, part - 1, part, DT_STEP_AXIS(b->step[mid]), mid);
        s->parts--;
    }
    return end;
}

static struct dt_part run_range(struct build *b, uint32_t lo, uint32_t hi)
{
    enum { REPORT = 8192 }; /* points between two polls */
    struct stack s = {0};
    struct dt_part all = {0};
    uint32_t reported = lo;
    for (uint32_t v = lo; v < hi && good(b);) {
        v = run_step(b, &s, v);
        if (v - reported >= REPORT || v == hi) {
            report(b, v - reported);
            reported = v;
            dt_stopped(&b->stop);
        }
    }
    if (good(b))
        all = s.part[0];
    dt_array_free(s.part);
    return all;
}

/* ---- tasks ---- */

/* A range on the way to the tree: a node of it, or NONE while it is small; and the merges after it. */
struct item {
    uint32_t lo, hi, node, merges;
};

/* Ranges that lie side by side. */
struct items {
    struct item *item; /* owns */
    uint32_t n, cap;
};

/* The item's node; NONE: out of memory. */
static uint32_t node_of(struct build *b, struct item x)
{
    if (x.node != NONE || !good(b))
        return x.node;
    struct node *node = room_for_one(b, b->node, b->nodes, &b->node_cap, sizeof *node);
    uint32_t *task = room_for_one(b, b->task, b->tasks, &b->task_cap, sizeof *task);
    b->node = node == NULL ? b->node : node;
    b->task = task == NULL ? b->task : task;
    if (node == NULL || task == NULL)
        return NONE;
    task[b->tasks++] = b->nodes;
    node[b->nodes] = (struct node){.lo = x.lo, .hi = x.hi, .child = {NONE, NONE}, .parent = NONE};
    return b->nodes++;
}

static struct item join(struct build *b, struct item l, struct item r)
{
    if (r.hi - l.lo <= b->limit)
        return (struct item){l.lo, r.hi, NONE, 0};
    uint32_t left = node_of(b, l), right = node_of(b, r);
    struct node *node = room_for_one(b, b->node, b->nodes, &b->node_cap, sizeof *node);
    b->node = node == NULL ? b->node : node;
    if (!good(b))
        return (struct item){l.lo, r.hi, NONE, 0};
    node[left].parent = node[right].parent = b->nodes;
    node[b->nodes] = (struct node){.lo = l.lo,
                                   .hi = r.hi,
                                   .child = {left, right},
                                   .parent = NONE,
                                   .axis = DT_STEP_AXIS(b->step[r.lo])};
    return (struct item){l.lo, r.hi, b->nodes++, 0};
}

/* Appends the item, joined with those before it by the merges after it; unless `all` are wanted, only as long as the range is
 * small and the one before it awaits no merges itself. */
static void push(struct build *b, struct items *s, struct item x, bool all)
{
    while (s->n > 0 && x.merges > 0) {
        const struct item *before = &s->item[s->n - 1];
        uint32_t merges = x.merges - 1;
        if (!all && (before->merges > 0 || x.hi - before->lo > b->limit))
            break;
        x = join(b, *before, x);
        x.merges = merges;
        s->n--;
    }
    struct item *larger = room_for_one(b, s->item, s->n, &s->cap, sizeof *larger);
    if (larger == NULL)
        return;
    s->item = larger;
    larger[s->n++] = x;
}

/* Shares of the vertices, and what remains of their blocks after all merges of small ranges in them. */
struct shares {
    struct build *build;
    struct items share[DT_MAX_THREADS];
    unsigned n;
};

/* Share i begins with the first block that begins in slice i. */
static void fill_share(void *arg, unsigned i)
{
    struct shares *w = arg;
    struct build *b = w->build;
    uint32_t v = dt_slice(b->n, i, w->n), hi = dt_slice(b->n, i + 1, w->n);
    while (v < hi && b->step[v] == 0)
        v++;
    while (v < hi && good(b)) {
        uint32_t step = b->step[v], end = v + DT_STEP_POINTS(step);
        push(b, &w->share[i], (struct item){v, end, NONE, DT_STEP_MERGES(step)}, false);
        if (v / DT_POLL != end / DT_POLL)
            dt_stopped(&b->stop);
        v = end;
    }
}

/* Returns its root. */
static uint32_t make_tree(struct build *b, unsigned threads)
{
    struct shares w = {.build = b, .n = threads};
    struct items all = {0};
    dt_run(b->opt->pool, threads, fill_share, &w);
    for (unsigned i = 0; i < threads; i++) {
        for (uint32_t k = 0; k < w.share[i].n && good(b); k++)
            push(b, &all, w.share[i].item[k], true);
        dt_array_free(w.share[i].item);
    }
    uint32_t root = good(b) ? node_of(b, all.item[0]) : NONE;
    dt_array_free(all.item);
    return root;
}

/* Task i, and all joins for which it brings the second part. */
static void run_task(void *arg, unsigned i)
{
    struct build *b = arg;
    struct node *node = &b->node[b->task[i]];
    node->part = run_range(b, node->lo, node->hi);
    while (node->parent != NONE) {
        node = &b->node[node->parent];
        if (atomic_fetch_add(&node->finished, 1) == 0)
            return; /* the sibling's thread will join them */
        if (good(b))
            node->part = dt_merge_parts(&b->merging, &b->node[node->child[0]].part,
                                        &b->node[node->child[1]].part, node->axis,
                                        b->node[node->child[1]].lo);
    }
}

static struct dt_part run_tasks(struct build *b, unsigned threads)
{
    struct dt_part all = {0};
    b->limit = b->n / (threads * TASKS_PER_THREAD);
    uint32_t root = make_tree(b, threads);
    if (good(b)) {
        b->opt->pool->run(b->opt->pool->ctx, b->tasks, run_task, b);
        all = b->node[root].part;
    }
    dt_array_free(b->node);
    dt_array_free(b->task);
    return all;
}

/* The records of the whole mesh are there. Joins keep leaving[] of every vertex right, so only the hull is left to be
 * settled. */
static void finish(struct build *b, const struct dt_part *all)
{
    struct dt_mesh *m = b->merging.mesh;
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
    struct build b = {.merging = {.p = p, .mesh = m},
                      .step = step,
                      .n = n,
                      .opt = opt == NULL ? &none : opt,
                      .stop = dt_stop_of(opt)};
    b.merging.stop = &b.stop;
    unsigned threads = dt_threads_for(b.opt->pool, n);
    if (dt_mesh_reserve(m, n, 2 * n) != DT_OK)
        dt_stop_because(&b.stop, DT_NOMEM);
    struct dt_part all = {0};
    if (good(&b) && n > 0)
        all = threads > 1 ? run_tasks(&b, threads) : run_range(&b, 0, n);
    if (good(&b))
        finish(&b, &all);
    if (!good(&b))
        dt_mesh_clear(m);
    return dt_stop_status(&b.stop);
}
