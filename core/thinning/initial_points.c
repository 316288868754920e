/* initial_points.c - see initial_points.h. */
#include "core/thinning/initial_points.h"

#include "core/exact/predicates.h"
#include "core/memory/memory.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

struct first {
    const struct dt_samples *s;
    const struct dt_thinning *in;
    const struct dt_options *opt;
    bool *stays;            /* owns n, by sample */
    uint32_t *number;       /* owns n: the sample of an index; NULL without constraints */
    uint32_t *sample;       /* owns n: the samples of the set that is made, by id */
    uint32_t n;             /* of them */
    struct dt_point *point; /* owns n: their places */
};

static void clear(struct first *f)
{
    dt_array_free(f->stays);
    dt_array_free(f->number);
    dt_array_free(f->sample);
    dt_array_free(f->point);
}

static enum dt_status begin(struct first *f)
{
    size_t n = f->s->n;
    f->stays = dt_array_new(n, sizeof *f->stays);
    if (f->in->constraints > 0)
        f->number = dt_array_new(n, sizeof *f->number);
    f->sample = dt_array_new(n, sizeof *f->sample);
    f->point = dt_array_new(n, sizeof *f->point);
    if (f->stays == NULL || f->sample == NULL || f->point == NULL ||
        (f->number == NULL && f->in->constraints > 0))
        return DT_NOMEM;
    if (n > 0)
        memset(f->stays, 0, n * sizeof *f->stays);
    for (uint32_t i = 0; f->number != NULL && i < n; i++)
        f->number[f->s->v[i].index] = i;
    for (size_t i = 0; i < f->in->constraints; i++) {
        f->stays[f->number[f->in->constraint[i].a]] = true;
        f->stays[f->number[f->in->constraint[i].b]] = true;
    }
    return DT_OK;
}

static void choose(struct first *f, uint32_t i)
{
    f->sample[f->n] = i;
    f->point[f->n++] = f->s->v[i].at;
}

/* ---- the hull ---- */

enum { SIDES = 8 };

/* The extreme points in eight directions, counterclockwise. */
struct octagon {
    struct dt_point corner[SIDES];
    double far[SIDES];
};

/* Returns whether p is farther out than all before. */
static bool stretch(struct octagon *o, struct dt_point p)
{
    bool farther = false;
    const double far[SIDES] = {-p.x, -p.x - p.y, -p.y, p.x - p.y, p.x, p.x + p.y, p.y, p.y - p.x};
    for (int k = 0; k < SIDES; k++)
        if (far[k] > o->far[k]) {
            o->far[k] = far[k];
            o->corner[k] = p;
            farther = true;
        }
    return farther;
}

/* Whether p is strictly left of all sides that have a length. Then these turn around p, so that p is in the interior of the
 * hull of the corners, also where rounding has chosen corners that are not extreme. */
static bool has_inside(const struct octagon *o, struct dt_point p)
{
    bool in = true;
    for (int k = 0; k < SIDES && in; k++) {
        struct dt_point a = o->corner[k], b = o->corner[(k + 1) % SIDES];
        in = dt_compare_xy(a, b) == 0 || dt_orient2d(a, b, p) > 0;
    }
    return in && dt_compare_xy(o->corner[0], o->corner[4]) != 0;
}

static bool counts(const struct first *f, uint32_t i)
{
    return f->stays[i] || !isnan(f->s->v[i].z);
}

struct outer {
    struct first *f;
    struct dt_stop *stop;
    struct octagon o;
    bool known; /* the octagon is; until then it is stretched */
};

/* Whether no point of the block can be a corner of the hull, or of the octagon: its box has no such corner. */
static bool is_block_inside(const struct outer *w, const struct dt_bunch *b)
{
    const double x[] = {b->at.x - b->width, b->at.x + b->width};
    const double y[] = {b->at.y - b->height, b->at.y + b->height};
    bool inside = true;
    for (int k = 0; k < 4 && inside; k++) {
        const struct dt_point corner = {x[k / 2], y[k % 2]};
        struct octagon other = w->o;
        inside = w->known ? has_inside(&w->o, corner) : !stretch(&other, corner);
    }
    return inside;
}

static void visit(struct outer *w, uint32_t i)
{
    const struct dt_point p = w->f->s->v[i].at;
    if (!counts(w->f, i))
        return;
    if (!w->known)
        (void)stretch(&w->o, p);
    else if (!has_inside(&w->o, p))
        choose(w->f, i);
}

/* Visits the points of an item, except those of blocks that are inside. */
static void walk_outer(struct outer *w, uint32_t item)
{
    enum { POLLED = 5 }; /* blocks of this level have DT_POLL_MISSES points */
    uint32_t part = 0, n = 0;
    if (dt_item_level(item) == POLLED && dt_stopped(w->stop))
        return;
    if (dt_item_level(item) == 0)
        visit(w, item);
    else if (!is_block_inside(w, dt_item_block(w->f->s, item)))
        n = dt_item_parts(w->f->s, item, &part);
    for (uint32_t end = part + n; part < end; part++)
        walk_outer(w, part);
}

/* Chooses what can be a corner of the hull. */
static enum dt_status choose_outer(struct first *f, struct dt_stop *stop)
{
    const uint32_t level = f->s->levels, blocks = f->s->count[level];
    struct outer w = {.f = f, .stop = stop};
    for (int k = 0; k < SIDES; k++)
        w.o.far[k] = -HUGE_VAL;
    for (int pass = 0; pass < 2; pass++) {
        w.known = pass == 1;
        for (uint32_t i = 0; i < blocks && !dt_stopped(stop); i++)
            walk_outer(&w, dt_item_of(level, i));
    }
    return dt_stop_status(stop);
}

/* The strict corners of the hull, in its order, stay; the ends of a line, too. */
static void mark_corners(struct first *f, const uint32_t *hull, size_t n)
{
    for (size_t i = 0; i < n; i++) {
        struct dt_point before = f->point[hull[i == 0 ? n - 1 : i - 1]], at = f->point[hull[i]];
        struct dt_point after = f->point[hull[i + 1 < n ? i + 1 : 0]];
        int on = dt_compare_xy(before, at);
        bool inner = n > 2 && dt_orient2d(before, at, after) == 0 && on == dt_compare_xy(at, after);
        f->stays[f->sample[hull[i]]] |= !inner;
    }
}

/* Triangulates the points that have been chosen, with their constraints if they have them all. */
static enum dt_status make_set(const struct first *f, bool constrained, struct dt **set)
{
    struct dt_added added;
    size_t declared;
    uint32_t missing;
    struct dt *t = *set = dt_new(0);
    enum dt_status status = t == NULL ? DT_NOMEM : dt_add_many(t, f->point, f->n, f->opt, &added);
    const size_t n = f->in->constraints;
    struct dt_constraint *c = NULL;
    if (status == DT_OK && constrained && n > 0) {
        c = malloc(n * sizeof *c);
        status = c == NULL ? DT_NOMEM : DT_OK;
    }
    if (c != NULL) {
        for (size_t i = 0; i < n; i++)
            c[i] = (struct dt_constraint){f->number[f->in->constraint[i].a],
                                          f->number[f->in->constraint[i].b], false, 0};
        status = dt_constrain(t, c, n, f->opt, &declared, &missing);
    }
    free(c);
    if (status == DT_OK)
        status = dt_triangulate(t, f->opt);
    if (status != DT_OK) {
        dt_free(t);
        *set = NULL;
    }
    return status;
}

static enum dt_status read_hull(struct first *f, struct dt *t)
{
    struct dt_cursor c;
    size_t rows, words;
    enum dt_status status = dt_table_begin(t, NULL, DT_HULL, false, &c);
    uint32_t *hull = dt_array_new((size_t)f->n + 8, sizeof *hull);
    if (hull == NULL)
        status = DT_NOMEM;
    size_t n = 0;
    for (rows = 1; status == DT_OK && rows > 0; n += rows)
        status = dt_table_read(t, &c, hull + n, f->n + 8 - n, f->n, &rows, &words);
    if (status == DT_OK)
        mark_corners(f, hull, n);
    dt_array_free(hull);
    return status;
}

static enum dt_status find_corners(struct first *f, struct dt_stop *stop)
{
    struct dt *t;
    enum dt_status status = choose_outer(f, stop);
    if (status == DT_OK)
        status = make_set(f, false, &t);
    if (status != DT_OK)
        return status;
    status = read_hull(f, t);
    dt_free(t);
    return status;
}

/* ---- places at which constraints cross ---- */

static int compare_places(const void *a, const void *b)
{
    return dt_compare_xy(*(const struct dt_point *)a, *(const struct dt_point *)b);
}

/* Where constraints cross there must be points, which stay. */
static enum dt_status mark_crossings(struct first *f, struct dt_point *place, size_t n,
                                     struct dt_stop *stop)
{
    size_t found = 0;
    qsort(place, n, sizeof *place, compare_places);
    for (struct dt_piece at = dt_pieces(0, f->s->n); dt_next_piece(stop, &at);)
        for (uint32_t i = at.a; i < at.b; i++)
            if (bsearch(&f->s->v[i].at, place, n, sizeof *place, compare_places) != NULL) {
                f->stays[i] = true;
                found++;
            }
    if (dt_stop_status(stop) != DT_OK)
        return dt_stop_status(stop);
    return found == n && n > 0 ? DT_OK : DT_CROSSES;
}

static enum dt_status find_crossings(struct first *f, struct dt_stop *stop)
{
    const size_t n = f->in->constraints;
    struct dt_split split = {0};
    struct dt_added added;
    uint32_t missing;
    struct dt *t = dt_new(0);
    struct dt_constraint *c = malloc(n * sizeof *c);
    enum dt_status status = t == NULL || c == NULL ? DT_NOMEM : DT_OK;
    for (size_t i = 0; status == DT_OK && i < n; i++)
        c[i] = (struct dt_constraint){f->number[f->in->constraint[i].a],
                                      f->number[f->in->constraint[i].b], false, 0};
    if (status == DT_OK)
        status = dt_add_many(t, f->point, f->n, f->opt, &added);
    if (status == DT_OK)
        status = dt_plan_split(t, c, n, UINT32_MAX, f->opt, &split, &missing);
    if (status == DT_OK)
        status = mark_crossings(f, split.point, split.n_points, stop);
    dt_split_clear(&split);
    free(c);
    dt_free(t);
    return status;
}

/* ---- all of them ---- */

/* Chooses all that stay; their numbers are those of the set then. */
static void choose_all(struct first *f)
{
    f->n = 0;
    for (uint32_t i = 0; i < f->s->n; i++)
        if (f->stays[i]) {
            if (f->number != NULL)
                f->number[f->s->v[i].index] = f->n;
            choose(f, i);
        }
}

enum dt_status dt_initial_points(const struct dt_samples *s, const struct dt_thinning *in,
                                 const struct dt_options *opt, struct dt **set, uint32_t **sample)
{
    struct first f = {.s = s, .in = in, .opt = opt};
    struct dt_stop stop = dt_stop_of(opt);
    enum dt_status status = begin(&f);
    *set = NULL;
    *sample = NULL;
    if (status == DT_OK)
        status = find_corners(&f, &stop);
    if (status == DT_OK) {
        choose_all(&f);
        status = make_set(&f, true, set);
    }
    if (status == DT_CROSSES) {
        status = find_crossings(&f, &stop);
        if (status == DT_OK) {
            choose_all(&f);
            status = make_set(&f, true, set);
        }
    }
    if (status == DT_OK) {
        *sample = f.sample;
        f.sample = NULL;
    }
    clear(&f);
    return status;
}
