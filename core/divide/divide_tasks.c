/* divide_tasks.c - the sort of the divide engine on several threads.
 *
 * The upper part of the recursion of divide.c only goes down: all threads together sort every range of a large share of
 * the points by its grid; what has no more than a small share becomes a task:
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
 * Then threads take tasks, from left to right. At the end the joins are recorded, each after what it joins. The
 * ranges are disjoint (divide_level.h), so no two threads ever touch the same place, and the result is the same as on
 * one thread. */
#include "core/divide/divide_level.h"
#include "core/memory/memory.h"

#define TASKS_PER_THREAD 16u
#define LAST_QUARTER 8u      /* times as many tasks in there */
#define RANGES_PER_THREAD 4u /* crowded cells of a larger share are not left to one thread */

/* A task, or a join of the last two parts before it that no other join has taken. */
struct node {
    struct node *next;      /* every join comes after what it joins */
    struct node *below;     /* the last part on the left that is not joined yet */
    struct dt_level *level; /* of a task; NULL: a join */
    uint32_t key, s;        /* of a task: its cells */
    unsigned axis;          /* of a join */
    struct dt_blocks part;
};

struct tasks {
    struct dt_division *d;
    unsigned threads;
    uint32_t limit;        /* points of a task */
    struct dt_arena arena; /* owns nodes and levels */
    struct node *first, **end;
    uint32_t n;         /* tasks, without joins */
    struct node **task; /* in the arena: from left to right */
};

static bool good(const struct tasks *w)
{
    return dt_stop_status(&w->d->stop) == DT_OK;
}

static void *take(struct tasks *w, size_t n, size_t size)
{
    void *p = dt_arena_take(&w->arena, n, size);
    if (p == NULL)
        dt_stop_because(&w->d->stop, DT_NOMEM);
    return p;
}

/* Appends a copy of it. */
static void append(struct tasks *w, struct node it)
{
    struct node *node = take(w, 1, sizeof *node);
    if (node == NULL)
        return;
    *node = it;
    *w->end = node;
    w->end = &node->next;
    w->n += it.level != NULL;
}

static void visit_range(struct tasks *w, struct dt_source src, uint32_t lo, uint32_t n,
                        unsigned skew);

/* The cells of the level whose key starts with `key`. */
static void visit_cells(struct tasks *w, struct dt_level *level, uint32_t key, uint32_t s)
{
    uint32_t hi, lo = dt_level_range(level, key, s, &hi), n = hi - lo, all = w->d->n;
    uint32_t limit = s > 0 ? w->limit : all / (w->threads * RANGES_PER_THREAD);
    if (s > 0 && lo >= all - all / 4)
        limit /= LAST_QUARTER;
    if (n <= limit || n <= DT_BLOCK) {
        append(w, (struct node){.level = level, .key = key, .s = s});
    } else if (s == 0) {
        visit_range(w, dt_level_source(w->d, level, lo), lo, n, level->skew);
    } else {
        visit_cells(w, level, 2 * key, s - 1);
        visit_cells(w, level, 2 * key + 1, s - 1);
        append(w, (struct node){.axis = level->order.axis[s - 1]});
    }
}

/* All threads sort the range, or it is cut at its median. */
static void visit_range(struct tasks *w, struct dt_source src, uint32_t lo, uint32_t n,
                        unsigned skew)
{
    const struct dt_division *d = w->d;
    struct dt_level *level = take(w, 1, sizeof *level);
    if (!good(w))
        return;
    switch (dt_level_open(w->d, &w->arena, w->threads, src, lo, n, skew, level)) {
    case DT_LEVEL_OPEN:
        visit_cells(w, level, 0, level->order.bits);
        break;
    case DT_LEVEL_SKEWED: {
        unsigned axis;
        uint32_t half = dt_level_halve(w->d, src, lo, n, &axis), mid = lo + half;
        visit_range(w, (struct dt_source){d->p + lo, d->from + lo}, lo, half, 0);
        visit_range(w, (struct dt_source){d->p + mid, d->from + mid}, mid, n - half, 0);
        append(w, (struct node){.axis = axis});
        break;
    }
    case DT_LEVEL_FAILED:
        break;
    }
}

static void run_task(void *arg, unsigned i)
{
    struct tasks *w = arg;
    struct dt_arena arena = {.pages = w->d->pages};
    struct node *node = w->task[i];
    node->part = dt_divide_cells(w->d, &arena, node->level, node->key, node->s);
    dt_arena_clear(&arena);
}

static void run_tasks(struct tasks *w)
{
    uint32_t n = 0;
    w->task = take(w, w->n, sizeof(struct node *));
    for (struct node *node = w->first; w->task != NULL && node != NULL; node = node->next)
        if (node->level != NULL)
            w->task[n++] = node;
    if (good(w))
        w->d->opt->pool->run(w->d->opt->pool->ctx, n, run_task, w);
}

static void record_joins(struct tasks *w)
{
    struct node *last = NULL;
    for (struct node *node = w->first; node != NULL; node = node->next) {
        if (node->level == NULL) {
            struct node *left = last->below;
            node->part = dt_plan_join(&w->d->plan, left->part, last->part, node->axis);
            last = left->below;
        }
        node->below = last;
        last = node;
    }
}

void dt_divide_tasks(struct dt_division *d, struct dt_source in, unsigned threads)
{
    struct tasks w = {.d = d,
                      .threads = threads,
                      .limit = d->n / (threads * TASKS_PER_THREAD),
                      .arena = {.pages = d->pages},
                      .end = &w.first};
    visit_range(&w, in, 0, d->n, 0);
    if (good(&w))
        run_tasks(&w);
    if (good(&w))
        record_joins(&w);
    dt_arena_clear(&w.arena);
}
