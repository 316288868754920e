/* divide_level.c - sorting one range of points by one grid; see divide_level.h. */
#include "core/divide/divide_level.h"

#include <math.h>
#include <string.h>

#include "core/divide/median.h"
#include "core/memory/sort.h"

#define WORTH_SAMPLES (1u << 12) /* points */
#define COUNTS_PER_POINT 2u      /* of all slices together: 8 bytes a point */
#define OUTSKIRTS 4 /* a grid leaves them out if they take this many times its own width */

/* ---- the sort, in slices of the source ---- */

struct slice {
    struct dt_box box;
    uint32_t *next; /* counts of each cell, then the places of its next point */
};

struct sort {
    struct dt_division *d;
    struct dt_source src;
    uint32_t n;
    unsigned slices;
    const struct dt_order *order;
    struct dt_named out;
    uint32_t *key;       /* n */
    struct slice *slice; /* in the arena */
};

/* Slices are worked on in pieces, so that a large sort can be stopped. */
static struct dt_piece points_of(const struct sort *s, unsigned slice)
{
    return dt_slice_pieces(s->n, slice, s->slices);
}

static void find_box(void *arg, unsigned i)
{
    struct sort *s = arg;
    s->slice[i].box = dt_box_of(s->src.p + dt_slice(s->n, i, s->slices), 1);
    for (struct dt_piece at = points_of(s, i); dt_next_piece(&s->d->stop, &at);)
        s->slice[i].box = dt_box_join(s->slice[i].box, dt_box_of(s->src.p + at.a, at.b - at.a));
}

static struct dt_box box_of_all(struct sort *s)
{
    dt_run(s->d->opt->pool, s->slices, find_box, s);
    struct dt_box all = s->slice[0].box;
    for (unsigned i = 1; i < s->slices; i++)
        all = dt_box_join(all, s->slice[i].box);
    return all;
}

static void count(void *arg, unsigned i)
{
    struct sort *s = arg;
    memset(s->slice[i].next, 0, ((size_t)1 << s->order->bits) * sizeof *s->slice[i].next);
    for (struct dt_piece at = points_of(s, i); dt_next_piece(&s->d->stop, &at);)
        dt_order_count(s->order, s->src.p + at.a, at.b - at.a, s->key + at.a, s->slice[i].next);
}

/* Polls often: the first points that reach a tile touch pages that are fresh, perhaps huge ones. */
static void scatter(void *arg, unsigned i)
{
    struct sort *s = arg;
    for (struct dt_piece at = points_of(s, i);
         dt_next_piece_of(&s->d->stop, DT_POLL_FAULTS, &at);) {
        uint32_t n = at.b - at.a, *key = s->key + at.a;
        const struct dt_point *p = s->src.p + at.a;
        const uint32_t *from = s->src.from == NULL ? NULL : s->src.from + at.a;
        dt_order_scatter(key, n, s->slice[i].next, p, from, at.a, s->out.p, s->out.from);
    }
}

static void sort_numbers(double *a, uint32_t n)
{
    for (uint32_t i = 1, j; i < n; i++) {
        double v = a[i];
        for (j = i; j > 0 && a[j - 1] > v; j--)
            a[j] = a[j - 1];
        a[j] = v;
    }
}

/* The interval [*lo, *hi] becomes the middle three quarters of the sample with a margin on either side, `margin` times
 * their width, if that is much less than the interval. */
static void leave_outskirts(double *sample, uint32_t n, double margin, double *lo, double *hi)
{
    sort_numbers(sample, n);
    double a = sample[n / 8], b = sample[n - 1 - n / 8], beside = margin * (b - a);
    if (2 * beside + (b - a) >= (*hi - *lo) / OUTSKIRTS)
        return;
    *lo = a - beside > *lo ? a - beside : *lo;
    *hi = b + beside < *hi ? b + beside : *hi;
}

/* If there are outliers, one grid cannot fit all points. It is made to fit most of them. */
static struct dt_box box_of_most(const struct sort *s, struct dt_box box, double cells)
{
    enum { SAMPLES = 32 };
    double x[SAMPLES], y[SAMPLES];
    uint64_t random = s->n;
    for (uint32_t i = 0; i < SAMPLES; i++) {
        struct dt_point p = s->src.p[dt_random_below(&random, s->n)];
        x[i] = p.x;
        y[i] = p.y;
    }
    double margin = sqrt(cells) / 32 > 1 ? sqrt(cells) / 32 : 1;
    leave_outskirts(x, SAMPLES, margin, &box.lo.x, &box.hi.x);
    leave_outskirts(y, SAMPLES, margin, &box.lo.y, &box.hi.y);
    return box;
}

/* Turns the counts of all slices into places; returns the largest number of points in one cell. */
static uint32_t counts_to_places(struct sort *s)
{
    uint32_t place = 0, most = 0;
    for (struct dt_piece at = dt_pieces(0, 1u << s->order->bits); dt_next_piece(&s->d->stop, &at);)
        for (uint32_t c = at.a; c < at.b; c++) {
            uint32_t before = place;
            for (unsigned k = 0; k < s->slices; k++) {
                uint32_t n = s->slice[k].next[c];
                s->slice[k].next[c] = place;
                place += n;
            }
            most = place - before > most ? place - before : most;
        }
    return most;
}

/* Plans a grid, of tiles for many points. */
static void plan_grid(const struct sort *s, struct dt_box box, struct dt_order *order)
{
    double cells = s->n > DT_TILED ? (double)s->n / DT_TILE : s->n / DT_POINTS_PER_CELL;
    if (s->n >= WORTH_SAMPLES)
        box = box_of_most(s, box, cells);
    dt_order_plan(order, box, cells, s->src.p, s->n);
}

/* Allocates the tables, the keys if they have no place yet, and the counts of each slice. The last slice counts in start[]:
 * after the scatter, its next place in cell c is the end of c, which is the start of c + 1. */
static bool take_scratch(struct sort *s, struct dt_arena *arena, struct dt_level *level)
{
    uint32_t cells = 1u << level->order.bits,
             most = (uint32_t)((uint64_t)COUNTS_PER_POINT * s->n / cells);
    s->slices = most < 1 ? 1 : most < s->slices ? most : s->slices;
    level->start[0] = 0;
    s->slice[s->slices - 1].next = level->start + 1;
    for (unsigned i = 0; i + 1 < s->slices; i++) {
        s->slice[i].next = dt_arena_take(arena, cells, sizeof *s->slice[i].next);
        if (s->slice[i].next == NULL)
            return false;
    }
    if (s->key == NULL)
        s->key = dt_arena_take(arena, s->n, sizeof *s->key);
    return s->key != NULL && dt_order_tables(&level->order, arena) == DT_OK;
}

/* ---- the median ---- */

void dt_level_bring(struct dt_division *d, struct dt_source src, uint32_t lo, uint32_t n)
{
    if (src.p == d->p + lo)
        return;
    for (struct dt_piece at = dt_pieces(0, n); dt_next_piece(&d->stop, &at);) {
        memcpy(d->p + lo + at.a, src.p + at.a, (at.b - at.a) * sizeof *src.p);
        for (uint32_t i = at.a; i < at.b; i++)
            d->from[lo + i] = src.from == NULL ? i : src.from[i];
    }
}

uint32_t dt_level_halve(struct dt_division *d, struct dt_source src, uint32_t lo, uint32_t n,
                        unsigned *axis)
{
    dt_level_bring(d, src, lo, n);
    struct dt_box box = dt_box_of(d->p + lo, 1);
    for (struct dt_piece at = dt_pieces(lo, lo + n); dt_next_piece(&d->stop, &at);)
        box = dt_box_join(box, dt_box_of(d->p + at.a, at.b - at.a));
    *axis = dt_box_axis(&box);
    struct dt_piece same = dt_median_part(d->p + lo, d->from + lo, n, *axis, &d->stop);
    return same.a > 0 ? same.a : same.b;
}

/* ---- opening ---- */

/* Chooses the target: the arrays that do not hold the source. If neither holds it, the other ones have room for keys. */
static void choose_arrays(struct sort *s, uint32_t lo, struct dt_level *level)
{
    struct dt_division *d = s->d;
    struct dt_named p = {d->p + lo, d->from + lo}, spare = {d->spare.p + lo, d->spare.from + lo};
    bool elsewhere = s->src.p != p.p && s->src.p != spare.p;
    level->spare = s->src.p == p.p || (elsewhere && s->n > DT_TILED);
    s->out = level->spare ? spare : p;
    s->key = !elsewhere ? NULL : level->spare ? p.from : spare.from;
}

enum dt_opening dt_level_open(struct dt_division *d, struct dt_arena *arena, unsigned threads,
                              struct dt_source src, uint32_t lo, uint32_t n, unsigned skew,
                              struct dt_level *level)
{
    struct sort s = {.d = d, .src = src, .n = n, .slices = threads, .order = &level->order};
    s.slice = dt_arena_take(arena, threads, sizeof *s.slice);
    if (s.slice == NULL) {
        dt_stop_because(&d->stop, DT_NOMEM);
        return DT_LEVEL_DONE;
    }
    struct dt_box box = box_of_all(&s);
    if (dt_stopped(&d->stop)) /* then the box may be too small */
        return DT_LEVEL_DONE;
    if (box.lo.x == box.hi.x && box.lo.y == box.hi.y) {
        dt_level_bring(d, src, lo, n);
        if (!dt_stopped(&d->stop)) /* then names may be missing */
            dt_plan_place(&d->plan, d->p, d->from, lo, n);
        return DT_LEVEL_DONE;
    }
    choose_arrays(&s, lo, level);
    plan_grid(&s, box, &level->order);
    level->lo = lo;
    level->start = dt_arena_take(arena, ((size_t)1 << level->order.bits) + 1, sizeof *level->start);
    struct dt_arena_mark scratch = dt_arena_mark(arena);
    if (level->start == NULL || !take_scratch(&s, arena, level))
        dt_stop_because(&d->stop, DT_NOMEM);
    if (dt_stopped(&d->stop))
        return DT_LEVEL_DONE;
    dt_run(d->opt->pool, s.slices, count, &s);
    level->skew = counts_to_places(&s) > n / 2 ? skew + 1 : 0;
    if (level->skew <= DT_ZOOMS && !dt_stopped(&d->stop))
        dt_run(d->opt->pool, s.slices, scatter, &s);
    dt_arena_return(arena, scratch);
    if (dt_stopped(&d->stop))
        return DT_LEVEL_DONE;
    return level->skew > DT_ZOOMS ? DT_LEVEL_SKEWED : DT_LEVEL_OPEN;
}
