/* divide_tasks.c - the divide engine on several threads.
 *
 * The top of the recursion is written down as a tree: its leaves are tasks, none of more than a
 * small share of the points (crowded cells are zoomed into until that is so), its inner nodes are
 * joins. Threads take tasks in any order; whoever finishes the second child of a join does the join
 * and goes on upwards. Counting sorts of large ranges are shared by all threads. The ranges are
 * disjoint (divide_level.h), so no two threads ever touch the same record, and the result is the
 * same as on one thread. */
#include "core/divide_level.h"
#include "core/memory.h"

#define NO_NODE UINT32_MAX
#define TASKS_PER_THREAD 16u

/* A leaf (level != NULL) or a join of nodes a and b. */
struct node {
    const struct dt_level *level;
    uint32_t key, s;
    uint32_t a, b, mid;
    unsigned axis;
    uint32_t parent;
    atomic_uint finished; /* children of a join */
    struct dt_part part;
};

struct plan {
    struct dt_division *d;
    struct dt_arena arena; /* owns the levels */
    unsigned threads;
    uint32_t limit;    /* points of a task */
    struct node *node; /* owns */
    uint32_t nodes, cap;
    uint32_t *task; /* owns: the leaves, in order */
    uint32_t tasks;
};

static uint32_t plan_range(struct plan *w, struct dt_source src, uint32_t lo, uint32_t n,
                           unsigned skew);

static uint32_t new_node(struct plan *w, struct node value)
{
    if (w->nodes == w->cap) {
        size_t cap = dt_array_room(w->cap, (size_t)w->nodes + 1, UINT32_MAX / 2);
        struct node *node = dt_array_grow(w->node, w->nodes, cap, sizeof *node);
        if (node == NULL) {
            dt_division_fail(w->d, DT_NOMEM);
            return NO_NODE;
        }
        w->node = node;
        w->cap = (uint32_t)cap;
    }
    w->node[w->nodes] = value;
    return w->nodes++;
}

static uint32_t new_join(struct plan *w, uint32_t a, uint32_t b, unsigned axis, uint32_t mid)
{
    if (a == NO_NODE || b == NO_NODE)
        return NO_NODE;
    uint32_t join =
        new_node(w, (struct node){.a = a, .b = b, .axis = axis, .mid = mid, .parent = NO_NODE});
    if (join != NO_NODE)
        w->node[a].parent = w->node[b].parent = join;
    return join;
}

static uint32_t plan_cells(struct plan *w, const struct dt_level *level, uint32_t key, uint32_t s)
{
    uint32_t hi, lo = dt_level_range(level, key, s, &hi), n = hi - lo;
    if (n <= w->limit) {
        w->tasks++;
        return new_node(w, (struct node){.level = level, .key = key, .s = s, .parent = NO_NODE});
    }
    if (s == 0) {
        struct dt_aside aside = dt_aside(w->d, lo, n);
        struct dt_source src = level->tiles ? (struct dt_source){aside.p, aside.from}
                                            : (struct dt_source){w->d->p + lo, w->d->from + lo};
        return plan_range(w, src, lo, n, level->skew);
    }
    uint32_t a = plan_cells(w, level, 2 * key, s - 1);
    uint32_t b = plan_cells(w, level, 2 * key + 1, s - 1);
    uint32_t mid = level->lo + level->start[(2 * (size_t)key + 1) << (s - 1)];
    return new_join(w, a, b, level->order.axis[s - 1], mid);
}

/* n > limit >= DT_BLOCK points. */
static uint32_t plan_range(struct plan *w, struct dt_source src, uint32_t lo, uint32_t n,
                           unsigned skew)
{
    struct dt_division *d = w->d;
    struct dt_level *level = dt_arena_take(&w->arena, 1, sizeof *level);
    if (level == NULL) {
        dt_division_fail(d, DT_NOMEM);
        return NO_NODE;
    }
    switch (dt_level_open(d, &w->arena, w->threads, src, lo, n, skew, level)) {
    case DT_LEVEL_OPEN:
        return plan_cells(w, level, 0, level->order.bits);
    case DT_LEVEL_SKEWED:
        break;
    case DT_LEVEL_FAILED:
        return NO_NODE;
    }
    unsigned axis;
    uint32_t half = dt_level_median(d, src, lo, n, &axis), mid = lo + half;
    uint32_t a = plan_range(w, (struct dt_source){d->p + lo, d->from + lo}, lo, half, 0);
    uint32_t b = plan_range(w, (struct dt_source){d->p + mid, d->from + mid}, mid, n - half, 0);
    return new_join(w, a, b, axis, mid);
}

/* Task i, and all joins for which it brings the second part. */
static void run_task(void *arg, unsigned i)
{
    struct plan *w = arg;
    struct dt_arena arena = {.pages = w->arena.pages};
    uint32_t at = w->task[i];
    struct node *node = &w->node[at];
    node->part = dt_divide_cells(w->d, &arena, node->level, node->key, node->s);
    dt_arena_clear(&arena);
    while (node->parent != NO_NODE) {
        node = &w->node[node->parent];
        if (atomic_fetch_add(&node->finished, 1) == 0)
            return; /* the sibling's thread will join them */
        if (atomic_load(&w->d->status) != DT_OK)
            continue;
        node->part = dt_merge_parts(&w->d->merging, &w->node[node->a].part, &w->node[node->b].part,
                                    node->axis, node->mid);
    }
}

struct dt_part dt_divide_tasks(struct dt_division *d, const struct dt_point *in, unsigned threads)
{
    struct plan w = {.d = d,
                     .arena = {.pages = d->merging.mesh->pages},
                     .threads = threads,
                     .limit = d->n / (threads * TASKS_PER_THREAD)};
    if (w.limit < DT_BLOCK)
        w.limit = DT_BLOCK;
    struct dt_part all = {0};
    uint32_t root = plan_range(&w, (struct dt_source){in, NULL}, 0, d->n, 0);
    w.task = dt_array_new(w.tasks, sizeof *w.task);
    if (w.task == NULL)
        dt_division_fail(d, DT_NOMEM);
    if (atomic_load(&d->status) == DT_OK) {
        uint32_t n = 0;
        for (uint32_t i = 0; i < w.nodes; i++)
            if (w.node[i].level != NULL)
                w.task[n++] = i;
        d->opt->pool->run(d->opt->pool->ctx, n, run_task, &w);
        all = w.node[root].part;
    }
    dt_array_free(w.task);
    dt_array_free(w.node);
    dt_arena_clear(&w.arena);
    return all;
}
