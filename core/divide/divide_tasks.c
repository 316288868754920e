/* divide_tasks.c - the sort of the divide engine on several threads.
 *
 * The upper part of the recursion of divide.c is visited twice. The first time, all threads together sort every
 * range of a large share of the points by its grid; what has no more than a small share becomes a task:
 *
 *                  join              the whole set, sorted by all threads together
 *                 /    \
 *             join      join
 *            /    \    /    \
 *        task   task  range  task    a crowded cell, sorted by all threads together, if it is large enough
 *                    /     \
 *                 task     task      The tasks on the right are smaller than the others, so that
 *                                    all threads have something to do until the end.
 *
 * Then threads take tasks, from left to right. The second visit sorts nothing; it records the joins. The ranges are
 * disjoint (divide_level.h), so no two threads ever touch the same place, and the result is the same as on one thread. */
#include "core/divide/divide_level.h"
#include "core/memory/memory.h"

#define TASKS_PER_THREAD 16u
#define LAST_QUARTER 8u      /* times as many tasks in there */
#define RANGES_PER_THREAD 4u /* crowded cells of a larger share are not left to one thread */

/* A task or a range that all threads have sorted. */
struct node {
    struct node *next; /* in the order of visits */
    bool is_task;
    struct dt_level
        *level; /* the task's cells, or the range's grid; NULL: the range is cut at its median */
    uint32_t key, s;       /* of a task */
    struct dt_blocks part; /* of a task that is done */
    uint32_t half;         /* of a range that is cut: the points of the first part */
    unsigned axis;
};

struct visit {
    struct dt_division *d;
    unsigned threads;
    uint32_t limit;        /* points of a task */
    struct dt_arena arena; /* owns nodes and levels */
    struct node *first, **next;
    uint32_t tasks;
    struct node **task; /* in the arena: from left to right */
    bool again;         /* the second visit: all nodes are there */
};

static bool good(const struct visit *w)
{
    return dt_stop_status(&w->d->stop) == DT_OK;
}

static void *take(struct visit *w, size_t n, size_t size)
{
    void *p = dt_arena_take(&w->arena, n, size);
    if (p == NULL)
        dt_stop_because(&w->d->stop, DT_NOMEM);
    return p;
}

/* The next node, which the first visit makes; NULL: out of memory. */
static struct node *next_node(struct visit *w)
{
    struct node *node = w->again ? *w->next : take(w, 1, sizeof *node);
    if (node == NULL)
        return NULL;
    if (!w->again)
        *node = (struct node){0};
    *w->next = node;
    w->next = &node->next;
    return node;
}

static struct dt_blocks visit_task(struct visit *w, struct dt_level *level, uint32_t key,
                                   uint32_t s)
{
    struct node *node = next_node(w);
    if (node == NULL)
        return (struct dt_blocks){0};
    if (!w->again) {
        node->is_task = true;
        node->level = level;
        node->key = key;
        node->s = s;
        w->tasks++;
    }
    return node->part;
}

static struct dt_blocks visit_range(struct visit *w, struct dt_source src, uint32_t lo, uint32_t n,
                                    unsigned skew);

/* The cells of the level whose key starts with `key`. Before tasks are done, they have no parts, and joins record
 * nothing. */
static struct dt_blocks visit_cells(struct visit *w, struct dt_level *level, uint32_t key,
                                    uint32_t s)
{
    uint32_t hi, lo = dt_level_range(level, key, s, &hi), n = hi - lo, all = w->d->n;
    uint32_t limit = s > 0 ? w->limit : all / (w->threads * RANGES_PER_THREAD);
    if (s > 0 && lo >= all - all / 4)
        limit /= LAST_QUARTER;
    if (n <= limit || n <= DT_BLOCK)
        return visit_task(w, level, key, s);
    if (s == 0)
        return visit_range(w, dt_level_source(w->d, level, lo), lo, n, level->skew);
    struct dt_blocks a = visit_cells(w, level, 2 * key, s - 1);
    struct dt_blocks b = visit_cells(w, level, 2 * key + 1, s - 1);
    return dt_plan_join(&w->d->plan, a, b, level->order.axis[s - 1]);
}

/* All threads sort the range, or part it. */
static void open_range(struct visit *w, struct node *node, struct dt_source src, uint32_t lo,
                       uint32_t n, unsigned skew)
{
    struct dt_level *level = take(w, 1, sizeof *level);
    if (level == NULL)
        return;
    enum dt_opening opening = dt_level_open(w->d, &w->arena, w->threads, src, lo, n, skew, level);
    if (opening == DT_LEVEL_OPEN)
        node->level = level;
    if (opening == DT_LEVEL_SKEWED)
        node->half = dt_level_halve(w->d, src, lo, n, &node->axis);
}

static struct dt_blocks visit_range(struct visit *w, struct dt_source src, uint32_t lo, uint32_t n,
                                    unsigned skew)
{
    const struct dt_division *d = w->d;
    struct node *node = next_node(w);
    if (node != NULL && !w->again)
        open_range(w, node, src, lo, n, skew);
    if (!good(w))
        return (struct dt_blocks){0};
    if (node->level != NULL)
        return visit_cells(w, node->level, 0, node->level->order.bits);
    uint32_t mid = lo + node->half;
    struct dt_source left = {d->p + lo, d->from + lo}, right = {d->p + mid, d->from + mid};
    struct dt_blocks a = visit_range(w, left, lo, node->half, 0);
    struct dt_blocks b = visit_range(w, right, mid, n - node->half, 0);
    return dt_plan_join(&d->plan, a, b, node->axis);
}

static void run_task(void *arg, unsigned i)
{
    struct visit *w = arg;
    struct dt_arena arena = {.pages = w->d->pages};
    struct node *node = w->task[i];
    node->part = dt_divide_cells(w->d, &arena, node->level, node->key, node->s);
    dt_arena_clear(&arena);
}

static void run_tasks(struct visit *w)
{
    uint32_t n = 0;
    w->task = take(w, w->tasks, sizeof(struct node *));
    for (struct node *node = w->first; w->task != NULL && node != NULL; node = node->next)
        if (node->is_task)
            w->task[n++] = node;
    if (good(w))
        w->d->opt->pool->run(w->d->opt->pool->ctx, n, run_task, w);
}

void dt_divide_tasks(struct dt_division *d, struct dt_source in, unsigned threads)
{
    struct visit w = {.d = d,
                      .threads = threads,
                      .limit = d->n / (threads * TASKS_PER_THREAD),
                      .arena = {.pages = d->pages},
                      .next = &w.first};
    visit_range(&w, in, 0, d->n, 0);
    if (good(&w))
        run_tasks(&w);
    if (good(&w)) {
        w.next = &w.first;
        w.again = true;
        visit_range(&w, in, 0, d->n, 0);
    }
    dt_arena_clear(&w.arena);
}
