/* lookup_then.c - see lookup_then.h. Both searches end for the reasons given in locate.c and nearest.h,
 * which hold for any Delaunay triangulation. */
#include "core/query/lookup_then.h"

#include "core/exact/predicates.h"
#include "core/query/visited.h"
#include "core/set/reader.h"
#include "core/set/view_rows.h"
#include "core/set/view_stars.h"

#include <stdlib.h>

/* The vertex whose ring was read last. */
struct reader {
    const struct dt *t;
    const struct dt_view *v;
    struct dt_work *work;
    uint32_t id; /* DT_NONE: none was read */
    bool on_hull;
    struct dt_ids ring; /* owns */
};

static enum dt_status read_ring(struct reader *r, uint32_t id)
{
    if (r->id == id)
        return DT_OK;
    struct dt_star star = dt_star_of(r->t, r->v, id);
    uint32_t degree = dt_star_count(r->t, &star);
    r->ring.n = 0;
    enum dt_status st = dt_ids_reserve(&r->ring, degree + 1);
    if (st != DT_OK)
        return st;
    r->ring.n = dt_star_copy(r->t, &star, r->ring.v, degree);
    r->on_hull = star.on_hull;
    r->id = id;
    return dt_work(r->work, degree);
}

static struct dt_point place_of(const struct reader *r, uint32_t id)
{
    struct dt_row row = {0};
    dt_view_row(r->t, r->v, id, &row);
    return row.at;
}

/* ---- the triangle ---- */

/* The corner right of the edge from the vertex that was read to its neighbour b; DT_NONE: that is an edge
 * of the hull. */
static uint32_t right_of(const struct reader *r, uint32_t b)
{
    size_t n = r->ring.n, i = 0;
    while (i < n && r->ring.v[i] != b)
        i++;
    if (i == n || (i == 0 && r->on_hull))
        return DT_NONE;
    return r->ring.v[i == 0 ? n - 1 : i - 1];
}

/* Of the triangles at the vertex id, the first one. */
static enum dt_status first_at_vertex(struct reader *r, uint32_t id, uint32_t out[3])
{
    enum dt_status st = read_ring(r, id);
    for (size_t i = 0; st == DT_OK && i < r->ring.n; i++)
        if (i + 1 < r->ring.n || !r->on_hull)
            dt_first_triangle(out, id, r->ring.v[i], r->ring.v[(i + 1) % r->ring.n]);
    return st;
}

/* The same for that with these corners, in which the place is, and for those on its other side if it is on
 * an edge or a corner. */
static enum dt_status arrive(struct reader *r, const uint32_t id[3], const int side[3],
                             uint32_t out[3])
{
    enum dt_status st = DT_OK;
    dt_first_triangle(out, id[0], id[1], id[2]);
    for (unsigned k = 0; k < 3 && st == DT_OK; k++) {
        uint32_t a = id[k], b = id[(k + 1) % 3];
        if (side[k] != 0)
            continue;
        if (side[(k + 2) % 3] == 0)
            return first_at_vertex(r, a, out);
        st = read_ring(r, a);
        uint32_t c = st == DT_OK ? right_of(r, b) : DT_NONE;
        if (c != DT_NONE)
            dt_first_triangle(out, a, c, b);
    }
    return st;
}

/* One step of the walk from the triangle id[3]. *done: it has ended. */
static enum dt_status step(struct reader *r, struct dt_point q, uint32_t id[3], uint32_t out[3],
                           bool *done)
{
    struct dt_point p[3] = {place_of(r, id[0]), place_of(r, id[1]), place_of(r, id[2])};
    int side[3];
    for (unsigned k = 0; k < 3; k++) {
        side[k] = dt_orient2d(p[k], p[(k + 1) % 3], q);
        if (side[k] >= 0)
            continue;
        uint32_t a = id[k], b = id[(k + 1) % 3];
        enum dt_status st = read_ring(r, a);
        uint32_t c = st == DT_OK ? right_of(r, b) : DT_NONE;
        *done = c == DT_NONE;
        id[0] = a;
        id[1] = c;
        id[2] = b;
        return st;
    }
    *done = true;
    return arrive(r, id, side, out);
}

enum dt_status dt_locate_then(const struct dt *t, const struct dt_view *v, struct dt_point q,
                              uint32_t from, struct dt_work *work, uint32_t out[3])
{
    if (v->line || from == DT_NONE)
        return DT_OK;
    struct reader r = {t, v, work, DT_NONE, false, {0}};
    enum dt_status st = read_ring(&r, from);
    bool done = false;
    if (st == DT_OK) {
        uint32_t id[3] = {from, r.ring.v[0], r.ring.v[1]};
        while (st == DT_OK && !done)
            st = step(&r, q, id, out, &done);
    }
    free(r.ring.v);
    return st;
}

/* ---- the nearest ---- */

struct seen {
    double d; /* the rounded square of the distance */
    uint32_t id;
    struct dt_point at;
};

/* The nearest `most` of the vertices seen, nearest first, ties by id. */
struct search {
    struct reader r;
    struct dt_point q;
    struct dt_visited visited;
    struct seen *list; /* owns: room for `most` */
    uint32_t n, most;
};

static struct seen look_at(const struct search *s, uint32_t id)
{
    struct dt_point at = place_of(&s->r, id);
    return (struct seen){dt_square_distance(at, s->q), id, at};
}

/* < 0 if a is nearer than b. */
static int compare(const struct search *s, const struct seen *a, const struct seen *b)
{
    if (dt_squares_decide(a->d, b->d))
        return a->d < b->d ? -1 : 1;
    return dt_compare_distance(s->q, a->at, b->at);
}

static bool before(const struct search *s, const struct seen *a, const struct seen *b)
{
    int sign = compare(s, a, b);
    return sign != 0 ? sign < 0 : a->id < b->id;
}

static void keep(struct search *s, struct seen c)
{
    uint32_t i = s->n;
    if (i == s->most && !before(s, &c, &s->list[i - 1]))
        return;
    if (i == s->most)
        i--;
    else
        s->n++;
    for (; i > 0 && before(s, &c, &s->list[i - 1]); i--)
        s->list[i] = s->list[i - 1];
    s->list[i] = c;
}

/* *best becomes a vertex of which none is nearer. */
static enum dt_status descend(struct search *s, struct seen *best)
{
    enum dt_status st = DT_OK;
    uint32_t at = DT_NONE;
    while (st == DT_OK && at != best->id) {
        at = best->id;
        st = read_ring(&s->r, at);
        for (size_t i = 0; st == DT_OK && i < s->r.ring.n; i++) {
            struct seen c = look_at(s, s->r.ring.v[i]);
            if (compare(s, &c, best) < 0)
                *best = c;
        }
    }
    return st;
}

/* Takes those neighbours of the vertex id that have not been seen yet; with `ties` only those as near as
 * the vertex, which are appended to it. */
static enum dt_status take_neighbours(struct search *s, uint32_t id, struct dt_ids *ties)
{
    struct seen centre = look_at(s, id);
    enum dt_status st = read_ring(&s->r, id);
    for (size_t i = 0; st == DT_OK && i < s->r.ring.n; i++) {
        struct seen c = look_at(s, s->r.ring.v[i]);
        bool fresh = false;
        if (ties != NULL && compare(s, &c, &centre) != 0)
            continue;
        st = dt_visited_add(&s->visited, c.id, &fresh);
        if (st == DT_OK && fresh)
            keep(s, c);
        if (st == DT_OK && fresh && ties != NULL)
            st = dt_ids_append(ties, c.id);
    }
    return st;
}

/* Takes the vertex id, a nearest one, and all that are as near: they are joined to each other. */
static enum dt_status take_ties(struct search *s, struct seen nearest)
{
    struct dt_ids ties = {0};
    bool fresh;
    enum dt_status st = dt_visited_add(&s->visited, nearest.id, &fresh);
    keep(s, nearest);
    if (st == DT_OK)
        st = dt_ids_append(&ties, nearest.id);
    for (size_t i = 0; st == DT_OK && i < ties.n; i++)
        st = take_neighbours(s, ties.v[i], &ties);
    free(ties.v);
    return st;
}

static enum dt_status search(struct search *s, uint32_t from, uint32_t *out)
{
    struct seen best = look_at(s, from);
    enum dt_status st = descend(s, &best);
    if (st == DT_OK)
        st = take_ties(s, best);
    for (uint32_t i = 0; st == DT_OK && i < s->n; i++) {
        out[i] = s->list[i].id;
        if (i + 1 < s->most)
            st = take_neighbours(s, out[i], NULL);
    }
    return st;
}

enum dt_status dt_nearest_then(const struct dt *t, const struct dt_view *v, struct dt_point q,
                               uint32_t from, uint32_t k, struct dt_work *work, uint32_t *out)
{
    if (k == 0 || from == DT_NONE)
        return DT_OK;
    struct search s = {.r = {t, v, work, DT_NONE, false, {0}}, .q = q, .most = k};
    s.list = malloc(k * sizeof *s.list);
    if (s.list == NULL)
        return DT_NOMEM;
    dt_visited_init(&s.visited);
    enum dt_status st = search(&s, from, out);
    dt_visited_clear(&s.visited);
    free(s.list);
    free(s.r.ring.v);
    return st;
}
