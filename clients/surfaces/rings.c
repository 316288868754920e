/* rings.c - see rings.h.
 *
 * A hole is in the innermost outer ring around it. Rings touch at corners at most, so the middle of one of the hole's edges is on
 * no other ring. An outer ring is around the hole if the ray downwards from there crosses that ring an odd number of times. Outer
 * rings around one place are nested, so the innermost is the one with the smallest area. Edges are in strips by their x, so
 * that a ray meets few of them. */
#include "clients/surfaces/rings.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "clients/lib/array.h"
#include "clients/lib/words.h"

/* ---- rows ---- */

static bool fault(struct rings *r, const char *what)
{
    r->fault = what;
    return false;
}

static bool reserve(struct rings *r, size_t corners)
{
    size_t n = r->corners + corners, of_xy = r->corners_cap;
    return (array_reserve((void **)&r->ring, &r->cap, r->n + 1, sizeof r->ring[0]) &&
            array_reserve((void **)&r->xy, &of_xy, n, 2 * sizeof r->xy[0]) &&
            array_reserve((void **)&r->id, &r->corners_cap, n, sizeof r->id[0])) ||
           fault(r, "out of memory");
}

bool rings_take(struct rings *r, const char *row, size_t len)
{
    struct words w = {row, row + len};
    const char *word;
    size_t n = words_next(&w, &word);
    uint32_t corners;
    bool hole = n == 4 && memcmp(word, "hole", 4) == 0;
    if (!hole && (n != 5 || memcmp(word, "outer", 5) != 0))
        return fault(r, "a row of the reply is no loop");
    if (!words_next_u32(&w, &corners) || corners < 3 || corners > len)
        return fault(r, "a row of the reply is no loop");
    if (!reserve(r, corners))
        return false;
    for (size_t i = 0; i < corners; i++)
        if (!words_next_u32(&w, &r->id[r->corners + i]))
            return fault(r, "a row of the reply has too few points");
    r->ring[r->n] = (struct ring){.hole = hole, .first = r->corners, .n = corners, .outer = r->n};
    r->n++;
    r->corners += corners;
    return true;
}

void rings_free(struct rings *r)
{
    free(r->ring);
    free(r->id);
    free(r->xy);
    *r = (struct rings){0};
}

/* ---- which ring a hole is in ---- */

struct strips {
    const struct rings *r;
    double x0, wide; /* left edge; of a strip */
    size_t n;
    size_t *begin; /* owns n + 1: where a strip's edges begin */
    struct edge {
        size_t ring, corner;
    } * edge;     /* owns */
    double *area; /* owns: of each ring */
    bool *odd;    /* owns: of each ring, whether the ray has crossed it an odd number of times */
};

static const double *corner(const struct rings *r, size_t ring, size_t i)
{
    return r->xy + 2 * (r->ring[ring].first + i % r->ring[ring].n);
}

static size_t strip_of(const struct strips *s, double x)
{
    double at = s->wide > 0 ? (x - s->x0) / s->wide : 0;
    return at <= 0 ? 0 : at >= (double)s->n ? s->n - 1 : (size_t)at;
}

static double ring_area(const struct rings *r, size_t ring)
{
    const double *o = corner(r, ring, 0);
    double sum = 0;
    for (size_t i = 0; i < r->ring[ring].n; i++) {
        const double *p = corner(r, ring, i), *q = corner(r, ring, i + 1);
        sum += (p[0] - o[0]) * (q[1] - o[1]) - (q[0] - o[0]) * (p[1] - o[1]);
    }
    return fabs(sum);
}

/* For each strip that an edge of an outer ring meets: puts the edge into the strip, or only counts it. */
static void fill(struct strips *s, bool put)
{
    for (size_t k = 0; k < s->r->n; k++)
        for (size_t i = 0; !s->r->ring[k].hole && i < s->r->ring[k].n; i++) {
            double p = corner(s->r, k, i)[0], q = corner(s->r, k, i + 1)[0];
            size_t last = strip_of(s, fmax(p, q));
            for (size_t at = strip_of(s, fmin(p, q)); at <= last; at++)
                if (put)
                    s->edge[s->begin[at]++] = (struct edge){k, i};
                else
                    s->begin[at + 1]++;
        }
}

static bool strips_init(struct strips *s, const struct rings *r)
{
    double x1 = -HUGE_VAL;
    *s = (struct strips){.r = r, .x0 = HUGE_VAL};
    for (size_t i = 0; i < r->corners; i++) {
        s->x0 = fmin(s->x0, r->xy[2 * i]);
        x1 = fmax(x1, r->xy[2 * i]);
    }
    s->n = (size_t)(2 * sqrt((double)r->corners)) + 1;
    s->wide = (x1 - s->x0) / (double)s->n;
    s->begin = calloc(s->n + 2, sizeof s->begin[0]);
    s->area = malloc((r->n + 1) * sizeof s->area[0]);
    s->odd = calloc(r->n + 1, sizeof s->odd[0]);
    if (s->begin == NULL || s->area == NULL || s->odd == NULL)
        return false;
    for (size_t k = 0; k < r->n; k++)
        s->area[k] = ring_area(r, k);
    fill(s, false);
    for (size_t i = 0; i < s->n; i++)
        s->begin[i + 1] += s->begin[i];
    s->edge = malloc((s->begin[s->n] + 1) * sizeof s->edge[0]);
    if (s->edge == NULL)
        return false;
    fill(s, true); /* which moves each beginning to the next one */
    memmove(s->begin + 1, s->begin, s->n * sizeof s->begin[0]);
    s->begin[0] = 0;
    return true;
}

static void strips_free(struct strips *s)
{
    free(s->begin);
    free(s->edge);
    free(s->area);
    free(s->odd);
}

/* Whether the ray downwards from m crosses p-q. */
static bool is_crossed(const double *m, const double *p, const double *q)
{
    if ((p[0] <= m[0]) == (q[0] <= m[0]))
        return false;
    double left = (q[0] - p[0]) * (m[1] - p[1]) - (m[0] - p[0]) * (q[1] - p[1]);
    return q[0] > p[0] ? left > 0 : left < 0;
}

/* The middle of the hole's widest edge. */
static void choose_place(const struct rings *r, size_t hole, double *m)
{
    double widest = -1;
    for (size_t i = 0; i < r->ring[hole].n; i++) {
        const double *p = corner(r, hole, i), *q = corner(r, hole, i + 1);
        if (fabs(q[0] - p[0]) <= widest)
            continue;
        widest = fabs(q[0] - p[0]);
        m[0] = p[0] / 2 + q[0] / 2;
        m[1] = p[1] / 2 + q[1] / 2;
    }
}

static bool place_hole(struct strips *s, struct rings *r, size_t hole)
{
    double m[2] = {0, 0}, least = HUGE_VAL;
    choose_place(r, hole, m);
    size_t at = strip_of(s, m[0]), from = s->begin[at], to = s->begin[at + 1];
    for (size_t i = from; i < to; i++) {
        const struct edge *e = &s->edge[i];
        if (is_crossed(m, corner(r, e->ring, e->corner), corner(r, e->ring, e->corner + 1)))
            s->odd[e->ring] = !s->odd[e->ring];
    }
    for (size_t i = from; i < to; i++) {
        size_t k = s->edge[i].ring;
        if (s->odd[k] && s->area[k] < least) {
            least = s->area[k];
            r->ring[hole].outer = k;
        }
        s->odd[k] = false;
    }
    return least < HUGE_VAL || fault(r, "a hole of the shape is in none of its parts");
}

bool rings_place(struct rings *r)
{
    struct strips s;
    bool ok = strips_init(&s, r) || fault(r, "out of memory");
    for (size_t k = 0; ok && k < r->n; k++)
        ok = !r->ring[k].hole || place_hole(&s, r, k);
    for (size_t k = 0; k < r->n; k++)
        r->ring[k].next = r->n;
    for (size_t k = r->n; ok && k-- > 0;) {
        struct ring *hole = &r->ring[k], *outer = &r->ring[hole->outer];
        if (!hole->hole)
            continue;
        hole->next = outer->next;
        outer->next = k;
    }
    strips_free(&s);
    return ok;
}

bool rings_to_shapes(struct rings *r, double radius, struct shapes *s)
{
    bool ok = true;
    for (size_t outer = 0; outer < r->n; outer++)
        for (size_t k = outer; ok && !r->ring[outer].hole && k < r->n; k = r->ring[k].next) {
            const struct ring *ring = &r->ring[k];
            struct shape shape = {.key = radius, .closed = true, .hole = ring->hole, .n = ring->n};
            ok = shapes_add(s, &shape, r->xy + 2 * ring->first);
        }
    return ok || fault(r, "out of memory");
}
