/* tiles.c - processor time of a triangulation in tiles beside that of the same points in one set, in nanoseconds a point.
 *
 *     tiles FAMILY POINTS TILES RUNS
 *
 * The tiles are those of a k-d tree, in one process and on one thread. The stages: `build`; `first`, the first dt_tile_open; `rounds`,
 * all that follows until nothing is sent; `rows`, the triangles. Halo: points sent, per point. Each figure is the least of the runs,
 * which use pages of earlier ones again. */
#include "core/delaunay_arrays.h"
#include "core/delaunay_tiles.h"
#include "tests/bench/measure.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void must(enum dt_status s)
{
    if (s != DT_OK) {
        fprintf(stderr, "tiles: %s\n", dt_status_text(s));
        exit(1);
    }
}

static void *room(size_t n, size_t size)
{
    void *p = malloc((n + 1) * size);
    if (p == NULL)
        must(DT_NOMEM);
    return p;
}

/* In huge pages, as NumPy has large arrays. */
static uint32_t *array(struct dt_pages *pages, size_t n)
{
    uint32_t *v = dt_pages_grow(pages, NULL, 0, (n + 1) * sizeof *v);
    if (v == NULL)
        must(DT_NOMEM);
    return v;
}

/* ---- the division ---- */

struct input {
    const struct dt_point *p;
    size_t n, tiles;
    uint64_t *id;  /* by tile, ascending in each */
    size_t *begin; /* tiles + 1 */
    struct dt_pages *pages;
};

static double along(const struct dt_point *p, bool by_x)
{
    return by_x ? p->x : p->y;
}

/* Moves the ids of the n / 2 least coordinates to the front [Hoare 1961]. */
static void halve(const struct dt_point *p, uint64_t *id, size_t n, bool by_x)
{
    for (size_t lo = 0, hi = n - 1, k = n / 2; lo < hi;) {
        double at = along(&p[id[(lo + hi) / 2]], by_x);
        size_t i = lo, j = hi;
        for (;;) {
            while (along(&p[id[i]], by_x) < at)
                i++;
            while (along(&p[id[j]], by_x) > at)
                j--;
            if (i >= j)
                break;
            uint64_t kept = id[i];
            id[i++] = id[j];
            id[j--] = kept;
            if (j < i)
                break;
        }
        if (k <= j)
            hi = j;
        else
            lo = i > lo ? i : lo + 1;
    }
}

static int compare_ids(const void *a, const void *b)
{
    uint64_t x = *(const uint64_t *)a, y = *(const uint64_t *)b;
    return x < y ? -1 : x > y;
}

static void divide(struct input *in, size_t from, size_t n, size_t first, size_t tiles, bool by_x)
{
    in->begin[first] = from;
    if (tiles == 1) {
        qsort(in->id + from, n, sizeof *in->id, compare_ids);
        return;
    }
    halve(in->p, in->id + from, n, by_x);
    divide(in, from, n / 2, first, tiles / 2, !by_x);
    divide(in, from + n / 2, n - n / 2, first + tiles / 2, tiles - tiles / 2, !by_x);
}

/* ---- the stages ---- */

struct figures {
    double build, first, rounds, rows, one;
    size_t sent, times, triangles;
};

struct run {
    const struct input *in;
    struct dt_tile **tile;
    double *box;
    struct figures *f;
};

static void build(struct run *r)
{
    const struct input *in = r->in;
    for (size_t k = 0; k < in->tiles; k++) {
        size_t from = in->begin[k], n = in->begin[k + 1] - from;
        struct dt_point *p = room(n, sizeof *p);
        double *box = r->box + 4 * k;
        for (unsigned i = 0; i < 4; i++)
            box[i] = (double)NAN;
        for (size_t i = 0; i < n; i++) {
            p[i] = in->p[in->id[from + i]];
            box[0] = fmin(box[0], p[i].x);
            box[1] = fmin(box[1], p[i].y);
            box[2] = fmax(box[2], p[i].x);
            box[3] = fmax(box[3], p[i].y);
        }
        double start = measure_cpu();
        must(dt_tile_new(p, in->id + from, n, in->pages, 1, &r->tile[k]));
        r->f->build += measure_cpu() - start;
        free(p);
    }
}

static void deliver(struct run *r, size_t from, size_t to, const uint32_t *vertex, size_t n)
{
    struct dt_point *p = room(n, sizeof *p);
    uint64_t *id = room(n, sizeof *id);
    for (size_t i = 0; i < n; i++) {
        id[i] = r->in->id[r->in->begin[from] + vertex[i]];
        p[i] = r->in->p[id[i]];
    }
    must(dt_tile_insert(r->tile[to], p, id, n));
    free(p);
    free(id);
}

/* Opens all tiles, then delivers. Returns how many points were sent. */
static size_t round_of(struct run *r, double *open, double *insert)
{
    size_t tiles = r->in->tiles, sent = 0;
    int64_t *offset = room((tiles + 1) * tiles, sizeof *offset);
    struct dt_ids *vertex = calloc(tiles, sizeof *vertex);
    double start = measure_cpu();
    for (size_t k = 0; k < tiles; k++) {
        must(dt_tile_open(r->tile[k], r->box, tiles, k, offset + k * (tiles + 1), &vertex[k]));
        sent += vertex[k].n;
    }
    *open += measure_cpu() - start;
    start = measure_cpu();
    for (size_t k = 0; k < tiles; k++)
        for (size_t to = 0; to < tiles; to++) {
            const int64_t *at = offset + k * (tiles + 1) + to;
            deliver(r, k, to, vertex[k].v + at[0], (size_t)(at[1] - at[0]));
        }
    *insert += measure_cpu() - start;
    for (size_t k = 0; k < tiles; k++)
        free(vertex[k].v);
    free(vertex);
    free(offset);
    return sent;
}

static void read_rows(struct run *r)
{
    for (size_t k = 0; k < r->in->tiles; k++) {
        struct dt_tile_counts c;
        size_t rows;
        dt_tile_counts(r->tile[k], &c);
        uint32_t *v = array(r->in->pages, 3 * c.triangles);
        double start = measure_cpu();
        must(dt_tile_triangles(r->tile[k], false, v, &rows));
        r->f->rows += measure_cpu() - start;
        r->f->triangles += rows;
        dt_pages_release(v);
        dt_tile_free(r->tile[k]);
    }
}

static void in_tiles(const struct input *in, struct figures *f)
{
    struct run r = {in, room(in->tiles, sizeof *r.tile), room(4 * in->tiles, sizeof *r.box), f};
    size_t sent;
    build(&r);
    f->sent = round_of(&r, &f->first, &f->rounds);
    f->times = 1;
    do {
        sent = round_of(&r, &f->rounds, &f->rounds);
        f->sent += sent;
        f->times++;
    } while (sent > 0);
    read_rows(&r);
    free(r.tile);
    free(r.box);
}

/* Returns the number of triangles. */
static size_t in_one(const struct input *in, struct figures *f)
{
    struct dt *t = dt_new_in(0, in->pages);
    struct dt_added added;
    struct dt_summary sum;
    uint32_t *v = array(in->pages, 6 * in->n);
    double start = measure_cpu();
    must(t == NULL ? DT_NOMEM : dt_add(t, in->p, in->n, &added));
    must(dt_triangulate(t, NULL));
    must(dt_flat(t, false, v, NULL));
    f->one = measure_cpu() - start;
    dt_summary(t, &sum);
    dt_free(t);
    dt_pages_release(v);
    return sum.triangles;
}

int main(int argc, char **argv)
{
    const struct family *family = argc == 5 ? family_find(argv[1]) : NULL;
    struct input in = {.n = family == NULL ? 0 : (size_t)atof(argv[2])};
    struct figures best = {HUGE_VAL, HUGE_VAL, HUGE_VAL, HUGE_VAL, HUGE_VAL, 0, 0, 0};
    in.tiles = in.n < 2 ? 0 : (size_t)atof(argv[3]);
    if (in.tiles == 0)
        return 2;
    struct dt_point *p = room(in.n, sizeof *p);
    family_points(family, p, in.n, 1);
    in.p = p;
    in.id = room(in.n, sizeof *in.id);
    in.pages = dt_pages_new((size_t)1 << 40);
    in.begin = room(in.tiles + 1, sizeof *in.begin);
    for (size_t i = 0; i < in.n; i++)
        in.id[i] = i;
    divide(&in, 0, in.n, 0, in.tiles, true);
    in.begin[in.tiles] = in.n;
    for (int run = 0; run < atoi(argv[4]); run++) {
        struct figures f = {0};
        in_tiles(&in, &f);
        if (in_one(&in, &f) != f.triangles)
            must(DT_CORRUPT);
        best = (struct figures){fmin(best.build, f.build),
                                fmin(best.first, f.first),
                                fmin(best.rounds, f.rounds),
                                fmin(best.rows, f.rows),
                                fmin(best.one, f.one),
                                f.sent,
                                f.times,
                                f.triangles};
    }
    double ns = 1e9 / (double)in.n, all = best.build + best.first + best.rounds + best.rows;
    printf("%s of %zu points in %zu tiles: build %.1f + first %.1f + rounds %.1f + rows %.1f = "
           "%.1f ns a point, in one set %.1f "
           "(ratio %.2f); %zu rounds, halo %.3f %%, first open %.1f ns a triangle\n",
           family->name, in.n, in.tiles, best.build * ns, best.first * ns, best.rounds * ns,
           best.rows * ns, all * ns, best.one * ns, all / best.one, best.times,
           100 * (double)best.sent / (double)in.n, 1e9 * best.first / (double)best.triangles);
    dt_pages_free(in.pages);
    free(p);
    free(in.id);
    free(in.begin);
    return 0;
}
