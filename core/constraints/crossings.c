/* crossings.c - see crossings.h. Boxes are cut in two as long as that makes fewer pairs to look at; a segment is in both parts
 * if it meets both. The cut is near the median of the segments, so that it helps also where most of them are in a small part of the
 * box, as in maps. The pairs that are found do not depend on the cuts. */
#include "core/constraints/crossings.h"

#include <math.h>
#include <stdlib.h>

#include "core/delaunay_constraints.h"
#include "core/exact/box.h"
#include "core/exact/predicates.h"
#include "core/exact/vectors.h"
#include "core/memory/memory.h"
#include "core/memory/sort.h"

/* ---- two segments ---- */

static bool separates(const struct dt_segment *a, const struct dt_segment *b)
{
    return dt_orient2d(a->p, a->q, b->p) * dt_orient2d(a->p, a->q, b->q) < 0;
}

static struct dt_box box_of(const struct dt_segment *s)
{
    return dt_box_of((const struct dt_point[]){s->p, s->q}, 2);
}

bool dt_segments_cross(const struct dt_segment *a, const struct dt_segment *b)
{
    struct dt_box one = box_of(a), other = box_of(b);
    return dt_box_overlaps(&one, &other) && separates(a, b) && separates(b, a);
}

/* from + (to - from) num / den, rounded. A polynomial of degree three over one of degree two: numbers of 2,560 bits have
 * room, and tell the quotient from the middle of two doubles. */
static double round_place(double from, double to, struct dt_big num, struct dt_big den)
{
    const double least = 0x1p-142;
    struct dt_big part = dt_big_multiply(dt_big_difference(to, from), num);
    double v = dt_big_quotient(dt_big_add(part, dt_big_multiply(dt_big_of(from), den)), den);
    if (fabs(v) < least)
        v = fabs(v) > least / 2 ? copysign(least, v) : 0;
    return v;
}

struct dt_point dt_crossing_place(const struct dt_segment *a, const struct dt_segment *b)
{
    struct dt_big_vector one = dt_big_vector_of(a->p, a->q), other = dt_big_vector_of(b->p, b->q),
                         between = dt_big_vector_of(a->p, b->p);
    struct dt_big den = dt_big_cross(&one, &other), num = dt_big_cross(&between, &other);
    return (struct dt_point){round_place(a->p.x, a->q.x, num, den),
                             round_place(a->p.y, a->q.y, num, den)};
}

/* ---- all ---- */

enum { FEW = 8 };

struct search {
    const struct dt_segment *s;
    struct dt_stop *work;
    struct dt_pairs *out;
    uint32_t *list; /* owns: stack of the segments in the boxes around this one */
    size_t n, cap;
};

static enum dt_status add_pair(struct dt_pairs *out, uint32_t a, uint32_t b)
{
    uint64_t pair = a < b ? (uint64_t)a << 32 | b : (uint64_t)b << 32 | a;
    if (out->n >= out->most)
        return DT_NOMEM;
    return dt_items_append(&out->v, &out->n, &out->cap, &pair, sizeof pair);
}

/* Every pair of the last n in the list. */
static enum dt_status look_at_all(struct search *f, size_t n)
{
    const uint32_t *v = f->list + f->n - n;
    enum dt_status status = DT_OK;
    for (size_t i = 0; i < n && status == DT_OK; i++) {
        for (size_t k = i + 1; k < n && status == DT_OK; k++) {
            const struct dt_segment *a = &f->s[v[i]], *b = &f->s[v[k]];
            if ((a->fresh || b->fresh) && dt_segments_cross(a, b))
                status = add_pair(f->out, v[i], v[k]);
        }
        if (status == DT_OK)
            status = dt_work(f->work, n - i);
    }
    return status;
}

/* Appends those of n from `from` on that meet the box. */
static enum dt_status choose(struct search *f, size_t from, size_t n, const struct dt_box *b)
{
    if (dt_items_reserve(&f->list, f->n + n, &f->cap, sizeof *f->list) != DT_OK)
        return DT_NOMEM;
    for (size_t i = from; i < from + n; i++) {
        const struct dt_segment *s = &f->s[f->list[i]];
        if (dt_segment_meets_box(s->p, s->q, b->lo, b->hi))
            f->list[f->n++] = f->list[i];
    }
    return dt_work(f->work, n);
}

/* The pairs of the n segments from `from` on with one that is fresh, at most. */
static double count_pairs(const struct search *f, size_t from, size_t n)
{
    size_t fresh = 0;
    for (size_t i = from; i < from + n; i++)
        fresh += f->s[f->list[i]].fresh;
    return (double)fresh * (double)n;
}

/* A place between, in the range of the predicates. */
static double middle(double lo, double hi)
{
    double mid = lo / 2 + hi / 2;
    return fabs(mid) < 0x1p-140 ? 0 : mid;
}

/* About the median of the middles of the last n segments along the axis, within the box. */
static double median(const struct search *f, const struct dt_box *b, unsigned axis, size_t n)
{
    enum { SAMPLE = 31 };
    double v[SAMPLE] = {0}, lo = axis == 0 ? b->lo.x : b->lo.y, hi = axis == 0 ? b->hi.x : b->hi.y;
    size_t k = 0;
    for (; k < SAMPLE && k < n; k++) {
        const struct dt_segment *s = &f->s[f->list[f->n - n + k * n / (n < SAMPLE ? n : SAMPLE)]];
        double at = axis == 0 ? middle(s->p.x, s->q.x) : middle(s->p.y, s->q.y);
        size_t i = k;
        for (; i > 0 && v[i - 1] > at; i--)
            v[i] = v[i - 1];
        v[i] = at;
    }
    return v[k / 2] > lo && v[k / 2] < hi ? v[k / 2] : middle(lo, hi);
}

static void cut_box(const struct dt_box *b, unsigned axis, double at, struct dt_box half[2])
{
    half[0] = half[1] = *b;
    if (axis == 0)
        half[0].hi.x = half[1].lo.x = at;
    else
        half[0].hi.y = half[1].lo.y = at;
}

static enum dt_status search(struct search *f, const struct dt_box *box, size_t n);

/* Halves the box of the last n segments, unless that does not help. */
static enum dt_status search_halves(struct search *f, const struct dt_box *box, unsigned axis,
                                    size_t n, bool *helps)
{
    size_t from = f->n - n;
    struct dt_box half[2];
    cut_box(box, axis, median(f, box, axis, n), half);
    enum dt_status status = choose(f, from, n, &half[0]);
    size_t first = f->n - from - n;
    if (status == DT_OK)
        status = choose(f, from, n, &half[1]);
    size_t second = f->n - from - n - first;
    double pairs = count_pairs(f, from, n),
           left = count_pairs(f, from + n, first) + count_pairs(f, from + n + first, second);
    *helps = left < 0.9 * pairs;
    if (status == DT_OK && *helps)
        status = search(f, &half[1], second);
    f->n = from + n + first;
    if (status == DT_OK && *helps)
        status = search(f, &half[0], first);
    f->n = from + n;
    return status;
}

/* The pairs of the last n segments of the list, which are in the box. */
static enum dt_status search(struct search *f, const struct dt_box *box, size_t n)
{
    bool helps = false;
    unsigned axis = dt_box_axis(box);
    enum dt_status status = DT_OK;
    if (n < 2 || count_pairs(f, f->n - n, n) == 0)
        return DT_OK;
    for (unsigned k = 0; k < 2 && n > FEW && status == DT_OK && !helps; k++)
        status = search_halves(f, box, k == 0 ? axis : 1 - axis, n, &helps);
    return status == DT_OK && !helps ? look_at_all(f, n) : status;
}

/* All that overlap the box of those that are fresh. */
static enum dt_status begin(struct search *f, size_t n, struct dt_box *box)
{
    size_t fresh = 0;
    enum dt_status status = dt_items_reserve(&f->list, n + 1, &f->cap, sizeof *f->list);
    for (size_t i = 0; i < n; i++)
        if (f->s[i].fresh) {
            struct dt_box around = box_of(&f->s[i]);
            *box = fresh++ == 0 ? around : dt_box_join(*box, around);
        }
    for (size_t i = 0; i < n && fresh > 0 && status == DT_OK; i++) {
        struct dt_box around = box_of(&f->s[i]);
        if (dt_box_overlaps(&around, box))
            f->list[f->n++] = (uint32_t)i;
    }
    return status == DT_OK ? dt_work(f->work, n) : status;
}

enum dt_status dt_crossings(const struct dt_segment *s, size_t n, struct dt_stop *work,
                            struct dt_pairs *out)
{
    struct search f = {.s = s, .work = work, .out = out};
    struct dt_box box = {{0, 0}, {0, 0}};
    out->n = 0;
    enum dt_status status = begin(&f, n, &box);
    if (status == DT_OK)
        status = search(&f, &box, f.n);
    free(f.list);
    out->n = dt_sort_unique_keys(out->v, out->n);
    return status;
}
