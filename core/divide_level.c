/* divide_level.c - sorting one range of points by one grid; see divide_level.h. */
#include "core/divide_level.h"

#include <math.h>
#include <string.h>

#include "core/median.h"

#define MANY_CELLS (1u << 14)    /* are worth several threads */
#define WORTH_SAMPLES (1u << 12) /* points */
#define OUTSKIRTS 4 /* a grid leaves them out if they take this many times its own width */

/* ---- the sort, in slices of the source ---- */

struct sort {
    struct dt_division *d;
    struct dt_source src;
    uint32_t n;
    unsigned slices;
    struct dt_box box[DT_MAX_THREADS];
    const struct dt_order *order;
    uint32_t *key;                  /* n */
    uint32_t *next[DT_MAX_THREADS]; /* per slice: counts of each cell, then the places of its next
                                       point */
    struct dt_point *out;
    uint32_t *out_from;
    struct dt_shift *shift; /* of each cell, if it is a tile; NULL: none */
    uint32_t cells;
    unsigned shares;                    /* slices of the cells */
    uint32_t first[DT_MAX_THREADS + 1]; /* place of the first point of each slice of the cells */
    uint32_t most[DT_MAX_THREADS];      /* points in one cell */
};

static void find_box(void *arg, unsigned i)
{
    struct sort *s = arg;
    uint32_t a = dt_slice(s->n, i, s->slices), b = dt_slice(s->n, i + 1, s->slices);
    s->box[i] = dt_box_of(s->src.p + a, b - a);
}

/* Slices are worked on in pieces, so that a large sort can be stopped. */
static struct dt_piece before_slice(const struct sort *s, unsigned i)
{
    return dt_before_first(dt_slice(s->n, i, s->slices));
}

static bool next_piece(const struct sort *s, unsigned i, struct dt_piece *at)
{
    return dt_next_piece(&s->d->stop, dt_slice(s->n, i + 1, s->slices), at);
}

static void count(void *arg, unsigned i)
{
    struct sort *s = arg;
    memset(s->next[i], 0, ((size_t)1 << s->order->bits) * sizeof *s->next[i]);
    for (struct dt_piece at = before_slice(s, i); next_piece(s, i, &at);)
        dt_order_count(s->order, s->src.p + at.a, at.b - at.a, s->key + at.a, s->next[i]);
}

static void scatter(void *arg, unsigned i)
{
    struct sort *s = arg;
    for (struct dt_piece at = before_slice(s, i); next_piece(s, i, &at);) {
        uint32_t n = at.b - at.a, *key = s->key + at.a;
        const struct dt_point *p = s->src.p + at.a;
        const uint32_t *from = s->src.from == NULL ? NULL : s->src.from + at.a;
        if (s->shift == NULL)
            dt_order_scatter(key, n, s->next[i], p, from, at.a, s->out, s->out_from);
        else
            dt_order_scatter_apart(key, n, s->next[i], s->shift, p, from, at.a, s->out,
                                   s->out_from);
    }
}

static void copy(void *arg, unsigned i)
{
    struct sort *s = arg;
    for (struct dt_piece at = before_slice(s, i); next_piece(s, i, &at);) {
        memcpy(s->out + at.a, s->src.p + at.a, (at.b - at.a) * sizeof *s->out);
        memcpy(s->out_from + at.a, s->src.from + at.a, (at.b - at.a) * sizeof *s->out_from);
    }
}

static struct dt_box join_boxes(const struct sort *s)
{
    struct dt_box all = s->box[0];
    for (unsigned i = 1; i < s->slices; i++) {
        const struct dt_box *b = &s->box[i];
        all.x0 = b->x0 < all.x0 ? b->x0 : all.x0;
        all.x1 = b->x1 > all.x1 ? b->x1 : all.x1;
        all.y0 = b->y0 < all.y0 ? b->y0 : all.y0;
        all.y1 = b->y1 > all.y1 ? b->y1 : all.y1;
    }
    return all;
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

/* Where a few points lie far out, one grid cannot suit all. It is made to suit most of them. */
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
    leave_outskirts(x, SAMPLES, margin, &box.x0, &box.x1);
    leave_outskirts(y, SAMPLES, margin, &box.y0, &box.y1);
    return box;
}

/* Slice i of the cells: how many points it has. */
static void sum_cells(void *arg, unsigned i)
{
    struct sort *s = arg;
    uint32_t a = dt_slice(s->cells, i, s->shares), b = dt_slice(s->cells, i + 1, s->shares), n = 0;
    for (unsigned k = 0; k < s->slices; k++)
        for (uint32_t c = a; c < b; c++)
            n += s->next[k][c];
    s->first[i + 1] = n;
}

/* Slice i of the cells: the counts of all slices of points become places. */
static void place_cells(void *arg, unsigned i)
{
    struct sort *s = arg;
    uint32_t b = dt_slice(s->cells, i + 1, s->shares), place = s->first[i], most = 0;
    for (uint32_t c = dt_slice(s->cells, i, s->shares); c < b; c++) {
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
static uint32_t counts_to_places(const struct dt_pool *pool, struct sort *s)
{
    s->cells = 1u << s->order->bits;
    s->shares = s->cells < MANY_CELLS ? 1 : s->slices;
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

/* Plans the grid and counts its cells. Sets level->start. */
static bool count_cells(struct dt_division *d, struct dt_arena *arena, struct sort *s,
                        struct dt_box box, struct dt_level *level)
{
    double cells = level->tiles ? (double)s->n / DT_TILE : s->n / DT_POINTS_PER_CELL;
    if (!level->tiles && s->n >= WORTH_SAMPLES)
        box = box_of_most(s, box, cells);
    if (dt_order_plan(&level->order, arena, box, cells, s->src.p, s->n) != DT_OK)
        return false;
    s->order = &level->order;
    size_t n = (size_t)1 << level->order.bits;
    for (unsigned i = 0; i < s->slices; i++) {
        uint32_t *starts = dt_arena_take(arena, n + 1, sizeof *starts);
        if (starts == NULL)
            return false;
        /* After the scatter, the next place of the last slice in cell c is the end of c, which is
         * the start of c + 1. */
        starts[0] = 0;
        s->next[i] = starts + 1;
        level->start = starts;
    }
    dt_run(d->opt->pool, s->slices, count, s);
    return true;
}

/* Places become those aside: dt_aside(d, lo + place of its first point, points) for each tile. */
static bool shift_tiles(struct dt_division *d, struct dt_arena *arena, struct sort *s, uint32_t lo)
{
    size_t cells = (size_t)1 << s->order->bits;
    const uint32_t *start = s->next[0];
    s->shift = dt_arena_take(arena, cells, sizeof *s->shift);
    if (s->shift == NULL)
        return false;
    for (size_t c = 0; c < cells; c++) {
        uint32_t end = c + 1 < cells ? start[c + 1] : s->n;
        s->shift[c] = (struct dt_shift){3 * start[c], 15 * end};
    }
    uint32_t *half = d->merging.mesh->half + 16 * (size_t)lo;
    s->out = (void *)half;
    s->out_from = half;
    return true;
}

/* Copies the source, which is among the vertices or aside, to where it is not in the way. */
static void move_source(struct dt_division *d, struct sort *s, struct dt_point *p, uint32_t *from)
{
    s->out = p;
    s->out_from = from;
    dt_run(d->opt->pool, s->slices, copy, s);
    s->src = (struct dt_source){p, from};
}

/* Counts by a grid of tiles or by a fine one; the keys go to `key`, or if it is NULL into the arena.
 * Returns the largest number of points in one cell; 0: the build has to stop. */
static uint32_t count_by(struct sort *s, struct dt_arena *arena, struct dt_box box, bool tiles,
                         uint32_t *key, struct dt_level *level)
{
    level->tiles = tiles;
    s->key = key != NULL ? key : dt_arena_take(arena, s->n, sizeof *s->key);
    if (s->key == NULL || !count_cells(s->d, arena, s, box, level))
        dt_stop_because(&s->d->stop, DT_NOMEM);
    return dt_stopped(&s->d->stop) ? 0 : counts_to_places(s->d->opt->pool, s);
}

enum dt_opening dt_level_open(struct dt_division *d, struct dt_arena *arena, unsigned slices,
                              struct dt_source src, uint32_t lo, uint32_t n, unsigned skew,
                              struct dt_level *level)
{
    struct dt_aside aside = dt_aside(d, lo, n);
    bool in_place = src.p == d->p + lo, is_aside = src.p == aside.p;
    uint32_t *key = in_place || is_aside ? NULL : d->from + lo, most = n;
    struct sort s = {.d = d, .src = src, .n = n, .slices = slices};
    *level = (struct dt_level){.lo = lo};
    dt_run(d->opt->pool, slices, find_box, &s);
    struct dt_box box = join_boxes(&s);
    if (n > DT_TILED)
        most = count_by(&s, arena, box, true, key, level);
    if (most > n / 2) /* too few points for tiles, or tiles do not part them */
        most = count_by(&s, arena, box, false, NULL, level);
    if (dt_stopped(&d->stop))
        return DT_LEVEL_FAILED;
    level->skew = most > n / 2 ? skew + 1 : 0;
    if (level->skew > DT_ZOOMS)
        return DT_LEVEL_SKEWED;
    if (level->tiles && is_aside)
        move_source(d, &s, d->p + lo, d->from + lo);
    else if (!level->tiles && in_place)
        move_source(d, &s, aside.p, aside.from);
    s.out = d->p + lo;
    s.out_from = d->from + lo;
    if (level->tiles && !shift_tiles(d, arena, &s, lo))
        dt_stop_because(&d->stop, DT_NOMEM);
    dt_run(d->opt->pool, slices, scatter, &s);
    return dt_stopped(&d->stop) ? DT_LEVEL_FAILED : DT_LEVEL_OPEN;
}

/* ---- the median ---- */

static void bring(struct dt_division *d, struct dt_source src, uint32_t lo, uint32_t n)
{
    for (struct dt_piece at = dt_before_first(0); dt_next_piece(&d->stop, n, &at);) {
        memcpy(d->p + lo + at.a, src.p + at.a, (at.b - at.a) * sizeof *src.p);
        for (uint32_t i = at.a; i < at.b; i++)
            d->from[lo + i] = src.from == NULL ? i : src.from[i];
    }
}

uint32_t dt_level_median(struct dt_division *d, struct dt_source src, uint32_t lo, uint32_t n,
                         unsigned *axis)
{
    if (src.p != d->p + lo)
        bring(d, src, lo, n);
    struct dt_box box = dt_box_of(d->p + lo, n);
    *axis = box.x1 - box.x0 >= box.y1 - box.y0 ? 0 : 1;
    dt_median_part(d->p + lo, d->from + lo, n, *axis, &d->stop);
    return n / 2;
}
