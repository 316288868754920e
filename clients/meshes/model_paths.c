/* model_paths.c - see model_paths.h. A graph of the constraints of one kind and number is walked so that each is passed once. */
#include "clients/meshes/model_paths.h"

#include <stdlib.h>
#include <string.h>

#include "clients/points/nesting.h"

/* A constraint as seen from one of its ends. */
struct arc {
    uint32_t from, to;
    uint32_t twin; /* the place of the same one from the other end */
    bool used;
};

struct walk {
    const struct model *m;
    struct paths *p;
    struct arc *arc; /* owns `arcs`, sorted by their ends */
    size_t arcs;
    size_t *next; /* owns: of each point of the model, where its arcs begin that may be unused */
    uint32_t *stack,
        *depth; /* own: the walk; of each point of the model its place in it + 1, 0: none */
    size_t n;
    bool ok;
};

static int compare_arcs(const void *a, const void *b)
{
    const struct arc *r = a, *s = b;
    if (r->from != s->from)
        return r->from < s->from ? -1 : 1;
    return r->to < s->to ? -1 : r->to > s->to;
}

/* The place of an arc that the walk has. */
static size_t find_arc(const struct walk *w, uint32_t from, uint32_t to)
{
    const struct arc key = {.from = from, .to = to};
    size_t lo = 0, hi = w->arcs;
    while (lo < hi) {
        size_t mid = lo + (hi - lo) / 2;
        if (compare_arcs(&w->arc[mid], &key) < 0)
            lo = mid + 1;
        else
            hi = mid;
    }
    return lo;
}

/* Returns how many constraints meet at the point of arc i, which is its first. */
static size_t degree(const struct walk *w, size_t i)
{
    size_t n = 1;
    while (i + n < w->arcs && w->arc[i + n].from == w->arc[i].from)
        n++;
    return n;
}

/* The first arc from a point that has not been used. */
static struct arc *next_arc(struct walk *w, uint32_t from)
{
    size_t *i = &w->next[from];
    while (*i < w->arcs && w->arc[*i].from == from && w->arc[*i].used)
        ++*i;
    return *i < w->arcs && w->arc[*i].from == from ? &w->arc[*i] : NULL;
}

/* Adds the walk from place `from` on as a path. */
static void put_path(struct walk *w, size_t from, bool closed, bool border, uint32_t number)
{
    w->ok = w->ok && paths_begin(w->p, border, number, 0, 0);
    for (size_t i = from; w->ok && i < w->n; i++)
        w->ok = paths_corner(w->p, w->stack[i]);
    if (!w->ok)
        return;
    struct path *path = &w->p->path[w->p->n - 1];
    path->n = w->n - from;
    path->closed = closed;
}

static void push(struct walk *w, uint32_t point)
{
    w->stack[w->n++] = point;
    w->depth[point] = (uint32_t)w->n;
}

static void pop_to(struct walk *w, size_t n)
{
    while (w->n > n)
        w->depth[w->stack[--w->n]] = 0;
}

/* Goes on from the last point of the walk to the end. A point that the walk has been at ends a ring, which leaves the walk; rings are paths
 * of their own, lines only if nothing else is left of them. */
static void go_on(struct walk *w, bool border, uint32_t number)
{
    struct arc *a;
    while ((a = next_arc(w, w->stack[w->n - 1])) != NULL) {
        a->used = w->arc[a->twin].used = true;
        if (w->depth[a->to] == 0) {
            push(w, a->to);
            continue;
        }
        size_t from = w->depth[a->to] - 1;
        put_path(w, from, true, border, number);
        pop_to(w, from + 1);
    }
    if (w->n > 1)
        put_path(w, 0, false, border, number);
    pop_to(w, 0);
}

/* First from points with an odd number of constraints, which are ends; then the rest, which is rings. */
static void walk_all(struct walk *w, bool border, uint32_t number)
{
    for (int pass = 0; pass < 2; pass++)
        for (size_t i = 0, n; i < w->arcs; i += n) {
            n = degree(w, i);
            while ((pass == 1 || n % 2 == 1) && w->ok && next_arc(w, w->arc[i].from) != NULL) {
                push(w, w->arc[i].from);
                go_on(w, border, number);
                if (pass == 0)
                    break;
            }
        }
}

/* ---- groups ---- */

static bool walk_group(struct walk *w, const uint32_t *row, size_t n)
{
    size_t before = w->p->n;
    bool border = (row[2] & 1) != 0;
    w->arcs = 2 * n;
    for (size_t i = 0; i < n; i++) {
        w->arc[2 * i] = (struct arc){row[3 * i], row[3 * i + 1], 0, false};
        w->arc[2 * i + 1] = (struct arc){row[3 * i + 1], row[3 * i], 0, false};
    }
    qsort(w->arc, w->arcs, sizeof w->arc[0], compare_arcs);
    for (size_t i = w->arcs; i-- > 0;)
        w->next[w->arc[i].from] = i;
    for (size_t i = 0; i < w->arcs; i++)
        w->arc[i].twin = (uint32_t)find_arc(w, w->arc[i].to, w->arc[i].from);
    walk_all(w, border, row[2] / 2);
    return w->ok && (!border || paths_nest(w->p, before, false, w->m->xy) == NESTING_DONE);
}

/* By kind and number, then as CONSTRAINTS sorts them. */
static int compare_rows(const void *a, const void *b)
{
    const uint32_t *r = a, *s = b;
    if (r[2] != s[2])
        return r[2] < s[2] ? -1 : 1;
    if (r[0] != s[0])
        return r[0] < s[0] ? -1 : 1;
    return r[1] < s[1] ? -1 : r[1] > s[1];
}

/* The constraints of one kind and number. */
struct group {
    const uint32_t *row;
    size_t n;
};

/* That with the smallest id first, as in the file that they came from; the first row of each has its smallest id. */
static int compare_groups(const void *a, const void *b)
{
    const struct group *r = a, *s = b;
    if (r->row[0] != s->row[0])
        return r->row[0] < s->row[0] ? -1 : 1;
    return r->row[2] < s->row[2] ? -1 : r->row[2] > s->row[2];
}

static size_t find_groups(const uint32_t *row, size_t n, struct group *group)
{
    size_t groups = 0;
    for (size_t i = 0, same; i < n; i += same) {
        for (same = 1; i + same < n && row[3 * (i + same) + 2] == row[3 * i + 2];)
            same++;
        group[groups++] = (struct group){row + 3 * i, same};
    }
    qsort(group, groups, sizeof group[0], compare_groups);
    return groups;
}

bool model_paths(const struct model *m, struct paths *p)
{
    size_t n = m->constraints;
    uint32_t *row = malloc((3 * n + 1) * sizeof row[0]);
    struct group *group = malloc((n + 1) * sizeof group[0]);
    struct walk w = {.m = m, .p = p, .ok = true};
    w.arc = malloc((2 * n + 1) * sizeof w.arc[0]);
    w.stack = malloc((m->n + 1) * sizeof w.stack[0]);
    w.depth = calloc(m->n + 1, sizeof w.depth[0]);
    w.next = malloc((m->n + 1) * sizeof w.next[0]);
    bool ok = row != NULL && group != NULL && w.arc != NULL && w.stack != NULL && w.depth != NULL &&
              w.next != NULL;
    if (ok && n > 0) {
        memcpy(row, m->constraint, 3 * n * sizeof row[0]);
        qsort(row, n, 3 * sizeof row[0], compare_rows);
    }
    size_t groups = ok && n > 0 ? find_groups(row, n, group) : 0;
    for (size_t i = 0; ok && i < groups; i++)
        ok = walk_group(&w, group[i].row, group[i].n);
    free(row);
    free(group);
    free(w.arc);
    free(w.stack);
    free(w.depth);
    free(w.next);
    return ok;
}
