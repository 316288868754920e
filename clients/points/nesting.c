/* nesting.c - see nesting.h.
 *
 * Rings touch at corners at most, so the middle of one of a ring's edges is on no other ring. Another ring is around it if the ray
 * downwards from there crosses the other ring an odd number of times. Rings around one place are nested, so the innermost is the one with
 * the smallest area. Edges are in strips by their x, so that a ray meets few of them. */
#include "clients/points/nesting.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

struct ring {
    struct path path;
    double area;
    size_t outer; /* of a hole: the ring that it is in; otherwise the ring itself */
    size_t place; /* among the paths */
    bool odd;     /* the ray has crossed it an odd number of times */
};

struct strips {
    const uint32_t *corner; /* borrows: of the paths */
    const double *xy;
    struct ring *ring; /* owns n */
    size_t n;
    bool known;
    double x0, wide; /* left edge; of a strip */
    size_t strips;
    size_t *begin; /* owns strips + 1: where a strip's edges begin */
    struct edge {
        size_t ring, corner;
    } * edge; /* owns */
};

static const double *corner(const struct strips *s, size_t ring, size_t i)
{
    const struct path *p = &s->ring[ring].path;
    return s->xy + 2 * (size_t)s->corner[p->first + i % p->n];
}

static size_t strip_of(const struct strips *s, double x)
{
    double at = s->wide > 0 ? (x - s->x0) / s->wide : 0;
    return at <= 0 ? 0 : at >= (double)s->strips ? s->strips - 1 : (size_t)at;
}

static double ring_area(const struct strips *s, size_t ring)
{
    const double *o = corner(s, ring, 0);
    double sum = 0;
    for (size_t i = 0; i < s->ring[ring].path.n; i++) {
        const double *p = corner(s, ring, i), *q = corner(s, ring, i + 1);
        sum += (p[0] - o[0]) * (q[1] - o[1]) - (q[0] - o[0]) * (p[1] - o[1]);
    }
    return fabs(sum);
}

/* Whether the path may have holes. */
static bool is_outer(const struct strips *s, const struct path *p)
{
    return p->closed && !(s->known && p->hole);
}

/* For each strip that an edge of an outer ring meets: puts the edge into the strip, or only counts it. */
static void fill(struct strips *s, bool put)
{
    for (size_t k = 0; k < s->n; k++)
        for (size_t i = 0; is_outer(s, &s->ring[k].path) && i < s->ring[k].path.n; i++) {
            double p = corner(s, k, i)[0], q = corner(s, k, i + 1)[0];
            size_t last = strip_of(s, fmax(p, q));
            for (size_t at = strip_of(s, fmin(p, q)); at <= last; at++)
                if (put)
                    s->edge[s->begin[at]++] = (struct edge){k, i};
                else
                    s->begin[at + 1]++;
        }
}

/* Takes the paths, and sorts their edges into strips; false when out of memory. */
static bool strips_init(struct strips *s, const struct path *path)
{
    double x1 = -HUGE_VAL;
    size_t corners = 0;
    s->ring = malloc((s->n + 1) * sizeof s->ring[0]);
    if (s->ring == NULL)
        return false;
    for (size_t k = 0; k < s->n; k++) {
        s->ring[k] = (struct ring){.path = path[k], .outer = k, .place = k};
        s->ring[k].area = ring_area(s, k);
        for (size_t i = 0; i < path[k].n; i++, corners++) {
            s->x0 = fmin(s->x0, corner(s, k, i)[0]);
            x1 = fmax(x1, corner(s, k, i)[0]);
        }
    }
    s->strips = (size_t)(2 * sqrt((double)corners)) + 1;
    s->wide = (x1 - s->x0) / (double)s->strips;
    s->begin = calloc(s->strips + 2, sizeof s->begin[0]);
    if (s->begin == NULL)
        return false;
    fill(s, false);
    for (size_t i = 0; i < s->strips; i++)
        s->begin[i + 1] += s->begin[i];
    s->edge = malloc((s->begin[s->strips] + 1) * sizeof s->edge[0]);
    if (s->edge == NULL)
        return false;
    fill(s, true); /* which moves each beginning to the next one */
    memmove(s->begin + 1, s->begin, s->strips * sizeof s->begin[0]);
    s->begin[0] = 0;
    return true;
}

/* Whether the ray downwards from m crosses p-q. */
static bool is_crossed(const double *m, const double *p, const double *q)
{
    if ((p[0] <= m[0]) == (q[0] <= m[0]))
        return false;
    double left = (q[0] - p[0]) * (m[1] - p[1]) - (m[0] - p[0]) * (q[1] - p[1]);
    return q[0] > p[0] ? left > 0 : left < 0;
}

/* The middle of the ring's widest edge. */
static void choose_place(const struct strips *s, size_t ring, double *m)
{
    double widest = -1;
    for (size_t i = 0; i < s->ring[ring].path.n; i++) {
        const double *p = corner(s, ring, i), *q = corner(s, ring, i + 1);
        if (fabs(q[0] - p[0]) <= widest)
            continue;
        widest = fabs(q[0] - p[0]);
        m[0] = p[0] / 2 + q[0] / 2;
        m[1] = p[1] / 2 + q[1] / 2;
    }
}

/* Finds the rings around one. False: it is a known hole, and there are none. */
static bool place_ring(struct strips *s, size_t ring)
{
    struct ring *r = &s->ring[ring];
    double m[2] = {0, 0}, least = HUGE_VAL;
    size_t smallest = ring;
    bool hole = false;
    choose_place(s, ring, m);
    const size_t at = strip_of(s, m[0]);
    const struct edge *from = s->edge + s->begin[at], *to = s->edge + s->begin[at + 1];
    for (const struct edge *e = from; e < to; e++)
        if (e->ring != ring &&
            is_crossed(m, corner(s, e->ring, e->corner), corner(s, e->ring, e->corner + 1)))
            s->ring[e->ring].odd = !s->ring[e->ring].odd;
    for (const struct edge *e = from; e < to; e++) {
        struct ring *around = &s->ring[e->ring];
        const bool larger = around->odd && (s->known || around->area > r->area);
        hole ^= larger;
        if (larger && around->area < least) {
            least = around->area;
            smallest = e->ring;
        }
        around->odd = false;
    }
    if (!s->known)
        r->path.hole = hole;
    r->outer = r->path.hole ? smallest : ring;
    return !r->path.hole || smallest != ring;
}

static int compare_rings(const void *a, const void *b)
{
    const struct ring *r = a, *s = b;
    if (r->outer != s->outer)
        return r->outer < s->outer ? -1 : 1;
    if (r->path.hole != s->path.hole)
        return r->path.hole ? 1 : -1;
    return r->place < s->place ? -1 : r->place > s->place;
}

enum nesting paths_nest(struct paths *p, size_t from, bool known, const double *xy)
{
    struct strips s = {
        .corner = p->corner, .xy = xy, .n = p->n - from, .known = known, .x0 = HUGE_VAL};
    if (s.n == 0)
        return NESTING_DONE;
    enum nesting done = strips_init(&s, p->path + from) ? NESTING_DONE : NESTING_NOMEM;
    for (size_t k = 0; done == NESTING_DONE && k < s.n; k++)
        if (s.ring[k].path.closed && (!known || s.ring[k].path.hole) && !place_ring(&s, k))
            done = NESTING_LONE;
    if (done == NESTING_DONE)
        qsort(s.ring, s.n, sizeof s.ring[0], compare_rings);
    for (size_t k = 0; done == NESTING_DONE && k < s.n; k++)
        p->path[from + k] = s.ring[k].path;
    free(s.ring);
    free(s.begin);
    free(s.edge);
    return done;
}
