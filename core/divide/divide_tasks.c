/* divide_tasks.c - the sort of the divide engine on several threads.
 *
 * The top of the recursion is written down as a tree, from its root down, in rounds: a range of too
 * many points gets a grid (divide_level.h), whose cells are joined in pairs, and so on up; a cell
 * that is still too large waits for the next round. Thus the leaves become tasks, none of more than
 * a small share of the points.
 *
 *                  join              round 1: the whole set, sorted by all threads together
 *                 /    \
 *             join      join         round 2: crowded cells, a thread each, and the largest
 *            /    \    /    \                 ones by all threads together
 *        task   task  range  task
 *                      |             The tasks on the right are smaller than the others, so that
 *                     ...            all threads have something to do until the end.
 *
 * Then threads take tasks, from left to right, and at the end the joins are recorded. The ranges are disjoint
 * (divide_level.h), so no two threads ever touch the same place, and the result is the same as on one thread. */
#include "core/divide/divide_level.h"
#include "core/memory/memory.h"

#define TASKS_PER_THREAD 16u
#define LAST_QUARTER 8u /* times as many tasks in there */

/* A task (level != NULL), a join of the nodes child and child + 1, or, while the tree grows, a range
 * that waits. */
struct node {
    const struct dt_level *level;
    uint32_t key, s;
    uint32_t child;
    unsigned axis;
    struct dt_blocks part; /* of a task that is done */
};

/* Some points that get a grid, or are cut at their median. */
struct range {
    struct dt_source src;
    uint32_t lo, n;
    unsigned skew;
    uint32_t node;
    struct dt_arena arena; /* owns the level */
    struct dt_level *level;
    enum dt_opening opening;
    uint32_t half; /* if it is cut: the points of the first part */
    unsigned axis;
};

struct tree {
    struct dt_division *d;
    unsigned threads;
    uint32_t limit;    /* points of a task */
    struct node *node; /* owns; the root first */
    uint32_t nodes, node_cap;
    struct range *range; /* owns; in order of rounds */
    uint32_t ranges, range_cap;
    uint32_t first; /* range of this round */
    uint32_t *task; /* owns: the leaves from left to right */
    uint32_t tasks, task_cap;
};

static bool good(const struct tree *w)
{
    return dt_stop_status(&w->d->stop) == DT_OK;
}

/* ---- the tree grows ---- */

/* Room for `more` items: the array itself, moved or not; NULL: out of memory, nothing has changed. */
static void *room_for(struct tree *w, void *array, uint32_t used, uint32_t more, uint32_t *cap,
                      size_t size)
{
    if (*cap - used >= more)
        return array;
    size_t want = dt_array_room(*cap, (size_t)used + more, UINT32_MAX / 2);
    void *larger = dt_array_grow(array, used, want, size);
    if (larger == NULL)
        dt_stop_because(&w->d->stop, DT_NOMEM);
    else
        *cap = (uint32_t)want;
    return larger;
}

/* The node has to wait for a grid on the n points from lo on. */
static void wait_for_grid(struct tree *w, uint32_t node, struct dt_source src, uint32_t lo,
                          uint32_t n, unsigned skew)
{
    struct range *range = room_for(w, w->range, w->ranges, 1, &w->range_cap, sizeof *range);
    if (range == NULL)
        return;
    w->range = range;
    range[w->ranges++] = (struct range){.src = src,
                                        .lo = lo,
                                        .n = n,
                                        .skew = skew,
                                        .node = node,
                                        .arena = {.pages = w->d->pages, .tight = true}};
}

/* The node becomes a join; returns the first of its two children, 0 if there is no memory. */
static uint32_t make_join(struct tree *w, uint32_t at, unsigned axis)
{
    struct node *node = room_for(w, w->node, w->nodes, 2, &w->node_cap, sizeof *node);
    if (node == NULL)
        return 0;
    w->node = node;
    node[at].axis = axis;
    node[at].child = w->nodes;
    for (int i = 0; i < 2; i++)
        node[w->nodes++] = (struct node){0};
    return node[at].child;
}

/* The node represents the cells of the level whose key starts with `key`. */
static void plan_cells(struct tree *w, uint32_t at, const struct dt_level *level, uint32_t key,
                       uint32_t s)
{
    uint32_t hi, lo = dt_level_range(level, key, s, &hi), n = hi - lo, all = w->d->n;
    uint32_t limit = s > 0 && lo >= all - all / 4 ? w->limit / LAST_QUARTER : w->limit;
    if (n <= limit || n <= DT_BLOCK) {
        w->node[at].level = level;
        w->node[at].key = key;
        w->node[at].s = s;
    } else if (s == 0) {
        wait_for_grid(w, at, dt_level_source(w->d, level, lo), lo, n, level->skew);
    } else {
        uint32_t child = make_join(w, at, level->order.axis[s - 1]);
        if (child == 0)
            return;
        plan_cells(w, child, level, 2 * key, s - 1);
        plan_cells(w, child + 1, level, 2 * key + 1, s - 1);
    }
}

static void open_range(struct tree *w, struct range *r, unsigned threads)
{
    struct dt_division *d = w->d;
    r->opening = DT_LEVEL_FAILED;
    r->level = dt_arena_take(&r->arena, 1, sizeof *r->level);
    if (r->level == NULL)
        dt_stop_because(&d->stop, DT_NOMEM);
    else
        r->opening = dt_level_open(d, &r->arena, threads, r->src, r->lo, r->n, r->skew, r->level);
    dt_arena_trim(&r->arena);
    if (r->opening == DT_LEVEL_SKEWED)
        r->half = dt_level_halve(d, r->src, r->lo, r->n, &r->axis);
}

/* A range that is worth all threads. */
static bool is_shared(const struct tree *w, const struct range *r)
{
    return r->n > w->d->n / (2 * w->threads);
}

static void open_alone(void *arg, unsigned i)
{
    struct tree *w = arg;
    struct range *r = &w->range[w->first + i];
    if (!is_shared(w, r))
        open_range(w, r, 1);
}

/* Replaces a range in the tree by its result. */
static void plan_range(struct tree *w, struct range r)
{
    struct dt_division *d = w->d;
    if (r.opening == DT_LEVEL_OPEN)
        plan_cells(w, r.node, r.level, 0, r.level->order.bits);
    if (r.opening != DT_LEVEL_SKEWED)
        return;
    uint32_t mid = r.lo + r.half, child = make_join(w, r.node, r.axis);
    if (child == 0)
        return;
    wait_for_grid(w, child, (struct dt_source){d->p + r.lo, d->from + r.lo}, r.lo, r.half, 0);
    wait_for_grid(w, child + 1, (struct dt_source){d->p + mid, d->from + mid}, mid, r.n - r.half,
                  0);
}

static void open_round(struct tree *w, uint32_t end)
{
    unsigned alone = 0;
    for (uint32_t i = w->first; i < end; i++) {
        if (is_shared(w, &w->range[i]))
            open_range(w, &w->range[i], w->threads);
        else
            alone++;
    }
    if (alone > 0)
        dt_run(w->d->opt->pool, end - w->first, open_alone, w);
    for (uint32_t i = w->first; i < end && good(w); i++)
        plan_range(w, w->range[i]);
}

static void grow(struct tree *w, struct dt_source in)
{
    w->node = room_for(w, NULL, 0, 1, &w->node_cap, sizeof *w->node);
    if (w->node == NULL)
        return;
    w->node[w->nodes++] = (struct node){0};
    wait_for_grid(w, 0, in, 0, w->d->n, 0);
    for (uint32_t end; good(w) && w->first < w->ranges; w->first = end) {
        end = w->ranges;
        open_round(w, end);
    }
}

/* ---- the tasks ---- */

/* Lists the tasks below a node. The depth is that of the tree, which is bounded (divide.c). */
static void list_tasks(struct tree *w, uint32_t at)
{
    if (w->node[at].level == NULL) {
        list_tasks(w, w->node[at].child);
        list_tasks(w, w->node[at].child + 1);
    } else {
        w->task[w->tasks++] = at;
    }
}

static void run_task(void *arg, unsigned i)
{
    struct tree *w = arg;
    struct dt_arena arena = {.pages = w->d->pages};
    struct node *node = &w->node[w->task[i]];
    node->part = dt_divide_cells(w->d, &arena, node->level, node->key, node->s);
    dt_arena_clear(&arena);
}

/* Records the joins below a node, whose tasks are done. */
static struct dt_blocks join_all(struct tree *w, uint32_t at)
{
    const struct node *node = &w->node[at];
    if (node->level != NULL)
        return node->part;
    struct dt_blocks a = join_all(w, node->child), b = join_all(w, node->child + 1);
    return dt_plan_join(&w->d->plan, a, b, node->axis);
}

void dt_divide_tasks(struct dt_division *d, struct dt_source in, unsigned threads)
{
    struct tree w = {.d = d, .threads = threads, .limit = d->n / (threads * TASKS_PER_THREAD)};
    if (w.limit < DT_BLOCK)
        w.limit = DT_BLOCK;
    grow(&w, in);
    if (good(&w))
        w.task = room_for(&w, NULL, 0, w.nodes, &w.task_cap, sizeof *w.task);
    if (good(&w)) {
        list_tasks(&w, 0);
        d->opt->pool->run(d->opt->pool->ctx, w.tasks, run_task, &w);
        join_all(&w, 0);
    }
    for (uint32_t i = 0; i < w.ranges; i++)
        dt_arena_clear(&w.range[i].arena);
    dt_array_free(w.range);
    dt_array_free(w.task);
    dt_array_free(w.node);
}
