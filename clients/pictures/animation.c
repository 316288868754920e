/* animation.c - the plan of an animation: when every step happens, and what it changes. See animation.h. */
#include "clients/pictures/animation.h"

#include <stdlib.h>

#define BEAT 0.28 /* seconds */

/* ---- when each step happens ---- */

static double length_of(enum step_kind kind)
{
    switch (kind) {
    case STEP_GRID:
    case STEP_REMOVE:
        return 0;
    case STEP_START:
        return 3;
    case STEP_HULL:
        return 0.7;
    default:
        return kind == STEP_SEARCH ? 1 : 1.6;
    }
}

static void make_schedule(struct animation *f, double seconds)
{
    double at = 2;
    for (size_t i = 0; i < f->t->n; i++) {
        enum step_kind kind = f->t->step[i].kind;
        /* A point leaves the grid while its last triangle is shown. */
        f->start[i] = kind == STEP_REMOVE && i > 0 ? f->start[i - 1] : at;
        at += length_of(kind);
        f->end[i] = at;
    }
    f->beats = at + 10;
    f->seconds = seconds > 0 ? seconds : f->beats * BEAT;
}

/* ---- what changes ---- */

static void change(struct animation *f, size_t item, double at, enum ink ink)
{
    f->change[f->changes++] = (struct change){(uint32_t)item, ink, at};
}

/* The item of the edge, which is new unless it came up before. */
static size_t edge_item(struct animation *f, uint32_t a, uint32_t b)
{
    uint32_t low = a < b ? a : b, high = a < b ? b : a;
    size_t e = f->edges;
    while (e > 0 && (f->edge[2 * e - 2] != low || f->edge[2 * e - 1] != high))
        e--; /* most are recent ones */
    if (e == 0) {
        e = ++f->edges;
        f->edge[2 * e - 2] = low;
        f->edge[2 * e - 1] = high;
    }
    return animation_edge(f, e - 1);
}

static void add_triangle(struct animation *f, size_t i, enum ink flash)
{
    size_t item = animation_triangle(f, f->triangles);
    f->triangle[f->triangles++] = (uint32_t)i;
    change(f, item, f->start[i], flash);
    change(f, item, f->end[i], INK_TRIANGLE);
}

static void see_triangle(struct animation *f, size_t i)
{
    const struct step *s = &f->t->step[i];
    uint32_t a = s->v[0], b = s->v[1], c = s->v[2];
    double at = f->start[i];
    enum ink ab = s->kind == STEP_FIRST ? INK_FRONT : INK_INSIDE;
    change(f, edge_item(f, a, b), at, ab);
    change(f, edge_item(f, b, c), at, s->kind == STEP_RIGHT ? INK_INSIDE : INK_FRONT);
    change(f, edge_item(f, c, a), at, s->kind == STEP_LEFT ? INK_INSIDE : INK_FRONT);
    add_triangle(f, i,
                 s->kind == STEP_RIGHT  ? INK_RIGHT
                 : s->kind == STEP_LEFT ? INK_LEFT
                                        : INK_POINT);
}

static void see_hull(struct animation *f, size_t i)
{
    const struct step *s = &f->t->step[i];
    bool more = i + 1 < f->t->n;
    size_t first = i;
    while (first > 0 && s[-(ptrdiff_t)(i - first) - 1].kind == STEP_HULL)
        first--;
    if (more)
        change(f, edge_item(f, s->v[0], s[1].v[0]), f->start[i], INK_HULL);
    else if (f->triangles > 0)
        change(f, edge_item(f, s->v[0], f->t->step[first].v[0]), f->start[i], INK_HULL);
}

static void see_step(struct animation *f, size_t i)
{
    const struct step *s = &f->t->step[i];
    switch (s->kind) {
    case STEP_GRID:
    case STEP_SEARCH:
        break;
    case STEP_START:
        change(f, edge_item(f, s->v[0], s->v[1]), f->start[i], INK_FRONT);
        break;
    case STEP_FIRST:
    case STEP_POINT:
    case STEP_RIGHT:
    case STEP_LEFT:
        see_triangle(f, i);
        break;
    case STEP_CAVE:
        change(f, edge_item(f, s->v[0], s->v[1]), f->end[i], INK_WAITS);
        break;
    case STEP_BORDER:
        change(f, edge_item(f, s->v[0], s->v[1]), f->end[i], INK_BORDER);
        break;
    case STEP_REMOVE:
        change(f, s->v[0], f->start[i], INK_LEAVES);
        change(f, s->v[0], f->end[i], INK_GONE);
        break;
    case STEP_HULL:
        see_hull(f, i);
        break;
    }
    if (f->end[i] > f->start[i] && s->kind != STEP_REMOVE) {
        change(f, animation_legend(f, s->kind), f->start[i], INK_LIT);
        change(f, animation_legend(f, s->kind), f->end[i], INK_DIM);
    }
}

static int compare_changes(const void *a, const void *b)
{
    const struct change *x = a, *y = b;
    if (x->item != y->item)
        return x->item < y->item ? -1 : 1;
    if (x->at != y->at)
        return x->at < y->at ? -1 : 1;
    return x->ink < y->ink ? -1
                           : x->ink > y->ink; /* an element is hidden before it is shown again */
}

const struct change *animation_changes(const struct animation *f, size_t item, size_t *n)
{
    size_t lo = 0, hi = f->changes, end;
    while (lo < hi) {
        size_t mid = lo + (hi - lo) / 2;
        if (f->change[mid].item < item)
            lo = mid + 1;
        else
            hi = mid;
    }
    for (end = lo; end < f->changes && f->change[end].item == item;)
        end++;
    *n = end - lo;
    return f->change + lo;
}

bool animation_write(FILE *out, const struct steps *t, const char *title,
                     const struct animation_options *options)
{
    struct animation f = {.out = out, .t = t, .m = t->m};
    f.start = malloc((t->n + 1) * sizeof *f.start);
    f.end = malloc((t->n + 1) * sizeof *f.end);
    f.change = malloc((7 * t->n + 1) * sizeof *f.change);
    f.edge = malloc((3 * t->n + 1) * 2 * sizeof *f.edge);
    f.triangle = malloc((t->n + 1) * sizeof *f.triangle);
    bool room = f.start != NULL && f.end != NULL && f.change != NULL && f.edge != NULL &&
                f.triangle != NULL;
    if (room) {
        make_schedule(&f, options->seconds);
        for (size_t i = 0; i < t->n; i++)
            see_step(&f, i);
        qsort(f.change, f.changes, sizeof f.change[0], compare_changes);
        animation_draw(&f, title, options->numbers);
    }
    free(f.start);
    free(f.end);
    free(f.change);
    free(f.edge);
    free(f.triangle);
    return room;
}
