/* divide_level.c - sorting one range of points by one grid; see divide_level.h. */
#include "core/divide/divide_level.h"

#include <math.h>
#include <string.h>

#include "core/divide/median.h"
#include "core/memory/sort.h"

#define MANY_CELLS (1u << 14)    /* are worth several threads */
#define WORTH_SAMPLES (1u << 12) /* points */
#define COUNTS_PER_POINT 2u      /* of all slices together: 8 bytes a point */
#define OUTSKIRTS 4 /* a grid leaves them out if they take this many times its own width */

/* ---- the sort, in slices of the source ---- */

struct sort {
    struct dt_division *d;
    struct dt_source src;
    uint32_t n;
    unsigned threads;
    unsigned slices; /* as many as threads, or fewer, as each has counts of all cells */
    struct dt_box box[DT_MAX_THREADS];
    const struct dt_order *order;
    struct dt_arena *arena;         /* borrows */
    struct dt_arena_mark scratch;   /* what is above it is not needed after the scatter */
    uint32_t *key;                  /* n */
    uint32_t *next[DT_MAX_THREADS]; /* per slice: counts of each cell, then the places of its next
                                       point */
    struct dt_point *out;
    uint32_t *out_from;
    uint32_t cells;
    unsigned shares;                    /* slices of the cells */
    uint32_t first[DT_MAX_THREADS + 1]; /* place of the first point of each slice of the cells */
    uint32_t most[DT_MAX_THREADS];      /* points in one cell */
};

/* Slices are worked on in pieces, so that a large sort can be stopped. */
static struct dt_piece points_of(const struct sort *s, unsigned slice)
{
    return dt_slice_pieces(s->n, slice, s->slices);
}

static void find_box(void *arg, unsigned i)
{
    struct sort *s = arg;
    s->box[i] = dt_box_of(s->src.p + dt_slice(s->n, i, s->slices), 1);
    for (struct dt_piece at = points_of(s, i); dt_next_piece(&s->d->stop, &at);)
        s->box[i] = dt_box_join(s->box[i], dt_box_of(s->src.p + at.a, at.b - at.a));
}

static struct dt_box box_of_all(struct sort *s)
{
    s->slices = s->threads;
    dt_run(s->d->opt->pool, s->slices, find_box, s);
    struct dt_box all = s->box[0];
    for (unsigned i = 1; i < s->slices; i++)
        all = dt_box_join(all, s->box[i]);
    return all;
}

static void count(void *arg, unsigned i)
{
    struct sort *s = arg;
    memset(s->next[i], 0, ((size_t)1 << s->order->bits) * sizeof *s->next[i]);
    for (struct dt_piece at = points_of(s, i); dt_next_piece(&s->d->stop, &at);)
        dt_order_count(s->order, s->src.p + at.a, at.b - at.a, s->key + at.a, s->next[i]);
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
        dt_order_scatter(key, n, s->next[i], p, from, at.a, s->out, s->out_from);
    }
}

static void copy(void *arg, unsigned i)
{
    struct sort *s = arg;
    for (struct dt_piece at = points_of(s, i); dt_next_piece(&s->d->stop, &at);) {
        memcpy(s->out + at.a, s->src.p + at.a, (at.b - at.a) * sizeof *s->out);
        memcpy(s->out_from + at.a, s->src.from + at.a, (at.b - at.a) * sizeof *s->out_from);
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

/* The interval [*lo, *hi] becomes the middle three quarters of the sample, and `margin` times as much on
 * either side, if that is much less. */
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

static struct dt_piece cells_of(const struct sort *s, unsigned share)
{
    return dt_slice_pieces(s->cells, share, s->shares);
}

/* Slice i of the cells: how many points it has. */
static void sum_cells(void *arg, unsigned i)
{
    struct sort *s = arg;
    uint32_t n = 0;
    for (struct dt_piece at = cells_of(s, i); dt_next_piece(&s->d->stop, &at);)
        for (unsigned k = 0; k < s->slices; k++)
            for (uint32_t c = at.a; c < at.b; c++)
                n += s->next[k][c];
    s->first[i + 1] = n;
}

/* Slice i of the cells: the counts of all slices of points become places. */
static void place_cells(void *arg, unsigned i)
{
    struct sort *s = arg;
    uint32_t place = s->first[i], most = 0;
    for (struct dt_piece at = cells_of(s, i); dt_next_piece(&s->d->stop, &at);)
        for (uint32_t c = at.a; c < at.b; c++) {
            uint32_t before = place;
            for (unsigned k = 0; k < s->slices; k++) {
                uint32_t n = s->next[k][c];
                s->next[k][c] = place;
                place += n;
            }
            most = place - before > most ? place - before : most;
        }
    s->most[i] = most;
}

/* Turns the counts of all slices into places; returns the largest number of points in one cell. */
static uint32_t counts_to_places(struct sort *s)
{
    const struct dt_pool *pool = s->d->opt->pool;
    s->shares = s->cells < MANY_CELLS ? 1 : s->threads;
    s->first[0] = 0;
    if (s->shares > 1)
        dt_run(pool, s->shares, sum_cells, s);
    for (unsigned i = 1; i < s->shares; i++)
        s->first[i] += s->first[i - 1];
    dt_run(pool, s->shares, place_cells, s);
    uint32_t most = 0;
    for (unsigned i = 0; i < s->shares; i++)
        most = s->most[i] > most ? s->most[i] : most;
    return most;
}

/* Plans a grid of tiles or a fine one. */
static bool plan_cells(struct sort *s, struct dt_box box, bool tiles, struct dt_level *level)
{
    double cells = tiles ? (double)s->n / DT_TILE : s->n / DT_POINTS_PER_CELL;
    level->tiles = tiles;
    if (!tiles && s->n >= WORTH_SAMPLES)
        box = box_of_most(s, box, cells);
    dt_order_plan(&level->order, box, cells, s->src.p, s->n);
    s->order = &level->order;
    s->cells = 1u << level->order.bits;
    level->start = dt_arena_take(s->arena, (size_t)s->cells + 1, sizeof *level->start);
    return level->start != NULL;
}

/* Tables; keys, which go to `key`, or if it is NULL into the arena; and counts for each slice. After the scatter, the
 * next place of the last slice in cell c is the end of c, which is the start of c + 1: so its counts are
 * in start[] from the beginning. */
static bool take_scratch(struct sort *s, uint32_t *key, struct dt_level *level)
{
    uint32_t most = (uint32_t)((uint64_t)COUNTS_PER_POINT * s->n / s->cells);
    s->slices = most < 1 ? 1 : most < s->threads ? most : s->threads;
    s->scratch = dt_arena_mark(s->arena);
    level->start[0] = 0;
    s->next[s->slices - 1] = level->start + 1;
    for (unsigned i = 0; i + 1 < s->slices; i++) {
        s->next[i] = dt_arena_take(s->arena, s->cells, sizeof *s->next[i]);
        if (s->next[i] == NULL)
            return false;
    }
    s->key = key != NULL ? key : dt_arena_take(s->arena, s->n, sizeof *s->key);
    return s->key != NULL && dt_order_tables(&level->order, s->arena) == DT_OK;
}

/* Counts by a grid of tiles or by a fine one. Returns the largest number of points in one cell; 0: the build
 * has to stop. */
static uint32_t count_by(struct sort *s, struct dt_box box, bool tiles, uint32_t *key,
                         struct dt_level *level)
{
    if (!plan_cells(s, box, tiles, level) || !take_scratch(s, key, level))
        dt_stop_because(&s->d->stop, DT_NOMEM);
    if (dt_stopped(&s->d->stop))
        return 0;
    dt_run(s->d->opt->pool, s->slices, count, s);
    return counts_to_places(s);
}

/* Copies the source away, because it occupies the destination. */
static void move_source(struct sort *s, struct dt_named to)
{
    s->out = to.p;
    s->out_from = to.from;
    dt_run(s->d->opt->pool, s->slices, copy, s);
    s->src = (struct dt_source){to.p, to.from};
}

/* Puts the points, which are counted, where they belong: tiles into the spare arrays. */
static void scatter_all(struct sort *s, uint32_t lo, bool tiles)
{
    struct dt_division *d = s->d;
    struct dt_named spare = {d->spare.p + lo, d->spare.from + lo}, p = {d->p + lo, d->from + lo};
    struct dt_named to = tiles ? spare : p, other = tiles ? p : spare;
    if (s->src.p == to.p)
        move_source(s, other);
    s->out = to.p;
    s->out_from = to.from;
    if (!dt_stopped(&d->stop))
        dt_run(d->opt->pool, s->slices, scatter, s);
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

enum dt_opening dt_level_open(struct dt_division *d, struct dt_arena *arena, unsigned threads,
                              struct dt_source src, uint32_t lo, uint32_t n, unsigned skew,
                              struct dt_level *level)
{
    bool elsewhere = src.p != d->p + lo && src.p != d->spare.p + lo;
    struct sort s = {.d = d, .src = src, .n = n, .threads = threads, .arena = arena};
    struct dt_arena_mark before = dt_arena_mark(arena);
    struct dt_box box = box_of_all(&s);
    uint32_t most = n;
    *level = (struct dt_level){.lo = lo};
    if (dt_stopped(&d->stop))
        return DT_LEVEL_DONE;
    if (box.lo.x == box.hi.x && box.lo.y == box.hi.y) {
        dt_level_bring(d, src, lo, n);
        dt_plan_place(&d->plan, d->p, d->from, lo, n);
        return DT_LEVEL_DONE;
    }
    if (n > DT_TILED)
        most = count_by(&s, box, true, elsewhere ? d->from + lo : NULL, level);
    if (most > n / 2) { /* too few points for tiles, or tiles do not part them */
        dt_arena_return(arena, before);
        most = count_by(&s, box, false, NULL, level);
    }
    if (dt_stopped(&d->stop))
        return DT_LEVEL_DONE;
    level->skew = most > n / 2 ? skew + 1 : 0;
    if (level->skew > DT_ZOOMS) {
        dt_arena_return(arena, before);
        return DT_LEVEL_SKEWED;
    }
    scatter_all(&s, lo, level->tiles);
    dt_arena_return(arena, s.scratch);
    return dt_stopped(&d->stop) ? DT_LEVEL_DONE : DT_LEVEL_OPEN;
}
