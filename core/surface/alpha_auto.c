/* alpha_auto.c - the least radius whose alpha shape is one piece with all points in it or on it.
 *
 * Triangles come into the shape in the order of their radii: the least doubles that are not less than their circumradii,
 * so that doubles compare as the sets of triangles do. All triangles of one radius come together. Then the shape is as
 * wanted if every point is a corner of a triangle that has come, and the triangles are connected through edges, which a
 * forest of disjoint sets counts [Tarjan 1975]. Connected shapes can fall apart as the radius grows, because a triangle may come
 * before those beside it; so no search by halves would do.
 *
 * Most radii need not be known: their order is clear from rounded ones. Where that leaves it open, and all points are
 * may be covered, their radii are found by exact comparisons. */
#include "core/control/stop.h"
#include "core/delaunay_surface.h"
#include "core/exact/predicates.h"
#include "core/memory/memory.h"
#include "core/set/view_rows.h"
#include "core/triangle/pass.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define ROUGH 0x1p-30        /* error of a rounded radius */
#define RADIUS_MOST 0x1p1020 /* more than any circumradius, which is below 2^997 */

/* A triangle in the order in which it comes. */
struct entry {
    double radius; /* rounded, or as it counts once that is known */
    double error;  /* of a rounded one, of itself; 0: it is the radius that counts */
    uint32_t triangle;
};

struct dt_alpha_auto {
    struct dt_pass pass;    /* of the table alone */
    uint32_t ids;           /* those that were given out */
    uint32_t points;        /* representatives */
    uint32_t triangles, n;  /* of the set; read so far */
    uint32_t *corner;       /* owns 3 for each triangle: ids */
    struct dt_point *place; /* owns `ids` */
};

void dt_alpha_auto_free(struct dt_alpha_auto *a)
{
    if (a == NULL)
        return;
    dt_array_free(a->corner);
    dt_array_free(a->place);
    free(a);
}

enum dt_status dt_alpha_auto_begin(const struct dt *t, const struct dt_view *v,
                                   struct dt_alpha_auto **out)
{
    enum dt_status s = dt_view_readable_delaunay(t, v);
    struct dt_summary sum;
    struct dt_alpha_auto *a = s == DT_OK ? calloc(1, sizeof *a) : NULL;
    *out = NULL;
    if (a == NULL)
        return s == DT_OK ? DT_NOMEM : s;
    if (v == NULL)
        dt_summary(t, &sum);
    else
        dt_view_summary(v, &sum);
    a->ids = v == NULL ? t->points.next_id : dt_view_next_id(v);
    a->points = sum.points - sum.coincident;
    a->triangles = sum.triangles;
    a->corner = dt_array_new(3 * (size_t)a->triangles, sizeof *a->corner);
    a->place = dt_array_new(a->ids, sizeof *a->place);
    if (a->corner == NULL || a->place == NULL)
        s = DT_NOMEM;
    else
        s = dt_pass_begin(&a->pass, t, v);
    if (s == DT_OK)
        *out = a;
    else
        dt_alpha_auto_free(a);
    return s;
}

enum dt_status dt_alpha_auto_read(const struct dt *t, struct dt_alpha_auto *a, bool *done)
{
    enum dt_status s = dt_pass_read(&a->pass, t, done);
    for (const uint32_t *row; s == DT_OK && (row = dt_pass_row(&a->pass)) != NULL; a->n++)
        for (size_t k = 0; k < 3; k++) {
            a->corner[3 * (size_t)a->n + k] = row[k];
            a->place[row[k]] = dt_view_place(t, a->pass.view, row[k]);
        }
    return s;
}

size_t dt_alpha_auto_memory(const struct dt_alpha_auto *a)
{
    size_t of_triangle = 3 * sizeof(uint32_t) + sizeof(struct entry) + /* corners, order */
                         6 * sizeof(uint32_t) + 3 * sizeof(uint32_t) + /* edges, neighbours */
                         sizeof(uint32_t);                             /* forest */
    return a->triangles * of_triangle + a->ids * (sizeof(struct dt_point) + sizeof(double) + 5);
}

/* ---- radii ---- */

struct shape {
    const struct dt_alpha_auto *a;
    struct entry *entry;   /* owns one for each triangle */
    uint32_t *beside;      /* owns 3 for each triangle: its neighbours; DT_NONE: none */
    uint32_t *parent;      /* owns one for each triangle: the forest; DT_NONE: it has not come */
    bool *covered;         /* owns one for each id */
    uint32_t pieces, open; /* open: points that are not covered */
    double last; /* the radius found last, with which the search for the next one begins */
    struct dt_stop stop;
};

static int compare_with(const struct shape *s, uint32_t triangle, double radius)
{
    const uint32_t *v = s->a->corner + 3 * (size_t)triangle;
    const struct dt_point *p = s->a->place;
    return dt_compare_circumradius(p[v[0]], p[v[1]], p[v[2]], radius);
}

/* The rounded radius: the sides' product errs by 10 u of itself, the area by 4 u of its size. */
static struct entry rounded_radius(const struct shape *s, uint32_t triangle)
{
    const uint32_t *v = s->a->corner + 3 * (size_t)triangle;
    struct dt_point a = s->a->place[v[0]], b = s->a->place[v[1]], c = s->a->place[v[2]];
    double size, area = dt_orient2d_rounded(a, b, c, &size);
    double sides =
        sqrt(dt_square_distance(a, b) * dt_square_distance(b, c)) * sqrt(dt_square_distance(c, a));
    double error = 0x1p-48 + 0x1p-50 * size / area;
    if (!(area > 0 && error < 0.25)) /* then it may be anything */
        return (struct entry){RADIUS_MOST, HUGE_VAL, triangle};
    return (struct entry){sides / (2 * area), error, triangle};
}

static double least_of(const struct entry *e)
{
    return e->error == HUGE_VAL ? 0 : e->radius * (1 - e->error);
}

static double most_of(const struct entry *e)
{
    return e->error == HUGE_VAL ? RADIUS_MOST : e->radius * (1 + e->error);
}

/* The double halfway between two, as their bits are counted. */
static double between(double lo, double hi)
{
    uint64_t a, b;
    double middle;
    memcpy(&a, &lo, sizeof a);
    memcpy(&b, &hi, sizeof b);
    a += (b - a) / 2;
    memcpy(&middle, &a, sizeof middle);
    return middle;
}

/* The least double that is not less than the circumradius. */
static double find_radius(struct shape *s, const struct entry *e)
{
    double lo = least_of(e), hi = most_of(e);
    if (lo < s->last && s->last <= hi) {
        if (compare_with(s, e->triangle, s->last) > 0)
            lo = s->last;
        else if (compare_with(s, e->triangle, nextafter(s->last, 0)) > 0)
            return s->last;
        else
            hi = nextafter(s->last, 0);
    }
    while (nextafter(lo, HUGE_VAL) < hi) { /* lo is less than the circumradius, hi is not */
        double middle = between(lo, hi);
        if (compare_with(s, e->triangle, middle) > 0)
            lo = middle;
        else
            hi = middle;
    }
    s->last = hi;
    return hi;
}

static enum dt_status settle_radius(struct shape *s, struct entry *e)
{
    if (e->error > 0)
        *e = (struct entry){find_radius(s, e), 0, e->triangle};
    return dt_work(&s->stop, 1);
}

/* ---- neighbours ---- */

/* An edge of a triangle, in the bucket of its lesser end. */
struct side {
    uint32_t to;   /* the greater end */
    uint32_t half; /* 3 triangle + its number there */
};

static int compare_sides(const void *p, const void *q)
{
    const struct side *a = p, *b = q;
    return (a->to > b->to) - (a->to < b->to);
}

/* Joins the two sides of each edge in a bucket. Many are sorted, so that both sides are beside each other. */
static void join_sides(struct shape *s, struct side *side, uint32_t n)
{
    enum { FEW = 16 };
    if (n > FEW)
        qsort(side, n, sizeof *side, compare_sides);
    for (uint32_t i = 0; i < n; i++)
        for (uint32_t k = i + 1; k < n; k++)
            if (side[k].to == side[i].to) {
                s->beside[side[i].half] = side[k].half / 3;
                s->beside[side[k].half] = side[i].half / 3;
                side[k] = side[i + 1];
                i++;
                break;
            }
}

static enum dt_status find_neighbours(struct shape *s)
{
    const struct dt_alpha_auto *a = s->a;
    const size_t sides = 3 * (size_t)a->n;
    uint32_t *start = dt_array_new((size_t)a->ids + 1, sizeof *start);
    struct side *side = dt_array_new(sides, sizeof *side);
    enum dt_status status = start == NULL || side == NULL ? DT_NOMEM : DT_OK;
    if (status == DT_OK)
        memset(start, 0, ((size_t)a->ids + 1) * sizeof *start);
    for (size_t h = 0; status == DT_OK && h < sides; h++) {
        uint32_t u = a->corner[h], v = a->corner[h % 3 == 2 ? h - 2 : h + 1];
        s->beside[h] = DT_NONE;
        start[(u < v ? u : v) + 1]++;
    }
    for (uint32_t i = 0; status == DT_OK && i < a->ids; i++)
        start[i + 1] += start[i];
    for (size_t h = sides; status == DT_OK && h-- > 0;) {
        uint32_t u = a->corner[h], v = a->corner[h % 3 == 2 ? h - 2 : h + 1];
        side[--start[(u < v ? u : v) + 1]] = (struct side){u < v ? v : u, (uint32_t)h};
    }
    for (uint32_t i = 0; status == DT_OK && i < a->ids; i++) {
        uint32_t end = i + 1 < a->ids ? start[i + 2] : (uint32_t)sides;
        join_sides(s, side + start[i + 1], end - start[i + 1]);
        status = i % DT_POLL == 0 && dt_stopped(&s->stop) ? dt_stop_status(&s->stop) : DT_OK;
    }
    dt_array_free(start);
    dt_array_free(side);
    return status;
}

/* ---- the shape as it grows ---- */

static uint32_t root_of(const struct shape *s, uint32_t i)
{
    while (s->parent[i] != i) {
        s->parent[i] = s->parent[s->parent[i]];
        i = s->parent[i];
    }
    return i;
}

static void add_triangle(struct shape *s, uint32_t triangle)
{
    s->parent[triangle] = triangle;
    s->pieces++;
    for (size_t h = 3 * (size_t)triangle; h < 3 * (size_t)triangle + 3; h++) {
        uint32_t id = s->a->corner[h], other = s->beside[h];
        s->open -= !s->covered[id];
        s->covered[id] = true;
        if (other == DT_NONE || s->parent[other] == DT_NONE)
            continue;
        uint32_t root = root_of(s, other), mine = root_of(s, triangle);
        s->pieces -= root != mine;
        s->parent[mine] = root;
    }
}

static bool is_wanted(const struct shape *s)
{
    return s->pieces == 1 && s->open == 0;
}

/* ---- all triangles in order ---- */

/* By the least radius that is possible. */
static int compare_entries(const void *p, const void *q)
{
    double a = least_of(p), b = least_of(q);
    return (a > b) - (a < b);
}

/* Returns a radius at which some point is not covered, unless it is 0: at some point all circumradii are at least that. */
static double uncovered_radius(const struct shape *s, double *least)
{
    double most = 0;
    for (uint32_t i = 0; i < s->a->ids; i++)
        least[i] = HUGE_VAL;
    for (uint32_t i = 0; i < s->a->n; i++)
        for (uint32_t k = 0; k < 3; k++) {
            double *at = &least[s->a->corner[3 * (size_t)s->entry[i].triangle + k]];
            double radius = least_of(&s->entry[i]);
            *at = radius < *at ? radius : *at;
        }
    for (uint32_t i = 0; i < s->a->ids; i++)
        most = least[i] != HUGE_VAL && least[i] > most ? least[i] : most;
    return most;
}

/* The end of the run of triangles from `from` on whose order rounded radii leave open. */
static uint32_t run_end(const struct shape *s, uint32_t from, double *most)
{
    uint32_t i = from + 1;
    *most = most_of(&s->entry[from]);
    for (; i < s->a->n && least_of(&s->entry[i]) <= *most; i++)
        *most = fmax(*most, most_of(&s->entry[i]));
    return i;
}

/* Adds a run; *found: the shape is as wanted with the first triangles of it, which have this radius. exactly: it can be found. */
static enum dt_status add_run(struct shape *s, uint32_t from, uint32_t end, bool exactly,
                              double *radius, bool *found)
{
    enum dt_status status = DT_OK;
    struct entry *e = s->entry;
    const bool many = exactly && end - from > 1;
    for (uint32_t i = from; many && i < end && status == DT_OK; i++)
        status = settle_radius(s, &e[i]);
    if (many && status == DT_OK)
        qsort(e + from, end - from, sizeof *e, compare_entries);
    for (uint32_t i = from; status == DT_OK && i < end && !*found; i++) {
        add_triangle(s, e[i].triangle);
        *found = exactly && is_wanted(s) && (i + 1 == end || e[i + 1].radius > e[i].radius);
        if (*found)
            status = settle_radius(s, &e[i]);
        *radius = e[i].radius;
    }
    return status;
}

static enum dt_status search(struct shape *s, double uncovered, double *radius)
{
    enum dt_status status = DT_OK;
    bool found = false;
    *radius = 0;
    for (uint32_t from = 0, end; status == DT_OK && from < s->a->n && !found; from = end) {
        double most;
        end = run_end(s, from, &most);
        status = add_run(s, from, end, most >= uncovered, radius, &found);
        if (status == DT_OK && from % DT_POLL == 0 && dt_stopped(&s->stop))
            status = dt_stop_status(&s->stop);
    }
    return status;
}

/* Of which `least` is for each id a double of scratch memory. */
static enum dt_status find_shape(struct shape *s, double *least, double *radius)
{
    enum dt_status status = find_neighbours(s);
    if (status != DT_OK)
        return status;
    memset(s->parent, 0xff, s->a->n * sizeof *s->parent);
    memset(s->covered, 0, s->a->ids * sizeof *s->covered);
    for (uint32_t i = 0; i < s->a->n && status == DT_OK; i++) {
        s->entry[i] = rounded_radius(s, i);
        if (s->entry[i].error > ROUGH) /* of few triangles, or their runs would be long */
            status = settle_radius(s, &s->entry[i]);
    }
    if (status != DT_OK)
        return status;
    double uncovered = uncovered_radius(s, least);
    qsort(s->entry, s->a->n, sizeof *s->entry, compare_entries);
    return search(s, uncovered, radius);
}

enum dt_status dt_alpha_auto_end(struct dt_alpha_auto *a, const struct dt_options *opt,
                                 double *radius)
{
    struct shape s = {.a = a, .open = a->points, .stop = dt_stop_of(opt)};
    double *least = dt_array_new(a->ids, sizeof *least);
    s.entry = dt_array_new(a->n, sizeof *s.entry);
    s.beside = dt_array_new(3 * (size_t)a->n, sizeof *s.beside);
    s.parent = dt_array_new(a->n, sizeof *s.parent);
    s.covered = dt_array_new(a->ids, sizeof *s.covered);
    enum dt_status status = DT_NOMEM;
    *radius = 0;
    if (least != NULL && s.entry != NULL && s.beside != NULL && s.parent != NULL &&
        s.covered != NULL)
        status = a->n == 0 ? DT_OK : find_shape(&s, least, radius);
    dt_array_free(least);
    dt_array_free(s.entry);
    dt_array_free(s.beside);
    dt_array_free(s.parent);
    dt_array_free(s.covered);
    return status;
}
