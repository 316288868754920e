/* brute.c - see brute.h. */
#include "tests/oracle/brute.h"

#include <stdlib.h>
#include <string.h>

#include "core/exact/predicates.h"

#define UNKNOWN (DT_NONE - 1)

static void append(struct dt_ids *out, uint32_t id)
{
    if (out->n == out->cap) {
        out->cap = 2 * out->cap + 64;
        out->v = realloc(out->v, out->cap * sizeof *out->v);
    }
    out->v[out->n++] = id;
}

static void reverse(uint32_t *v, size_t from, size_t end)
{
    for (; from + 1 < end; from++, end--) {
        uint32_t swap = v[from];
        v[from] = v[end - 1];
        v[end - 1] = swap;
    }
}

static bool is_point(const struct brute *b, uint32_t id)
{
    return b->rep[id] == id;
}

static uint32_t *apex(const struct brute *b, uint32_t from, uint32_t to)
{
    return &b->apex[(size_t)from * b->n + to];
}

static void find_representatives(struct brute *b, const bool *live)
{
    for (uint32_t i = 0; i < b->n; i++) {
        b->rep[i] = DT_NONE;
        for (uint32_t j = 0; j <= i && b->rep[i] == DT_NONE && (live == NULL || live[i]); j++)
            if ((live == NULL || live[j]) && dt_compare_xy(b->p[i], b->p[j]) == 0)
                b->rep[i] = j;
        b->points += is_point(b, i);
    }
}

/* Scans for the third point of the edge from u to v. */
static uint32_t find_apex(const struct brute *b, uint32_t u, uint32_t v)
{
    uint32_t best = DT_NONE;
    for (uint32_t w = 0; w < b->n; w++)
        if (is_point(b, w) && dt_orient2d(b->p[u], b->p[v], b->p[w]) > 0)
            if (best == DT_NONE || dt_incircle_perturbed(b->p[u], b->p[v], b->p[best], b->p[w]) > 0)
                best = w;
    return best;
}

/* Completes the triangulation from one Delaunay edge. */
static void wrap(const struct brute *b, uint32_t from, uint32_t to)
{
    struct dt_ids todo = {0};
    append(&todo, from);
    append(&todo, to);
    while (todo.n > 0) {
        uint32_t v = todo.v[--todo.n], u = todo.v[--todo.n];
        if (*apex(b, u, v) != UNKNOWN)
            continue;
        uint32_t w = *apex(b, u, v) = find_apex(b, u, v);
        if (w != DT_NONE) {
            *apex(b, v, w) = u;
            *apex(b, w, u) = v;
            append(&todo, w);
            append(&todo, v);
            append(&todo, u);
            append(&todo, w);
        }
        append(&todo, v);
        append(&todo, u);
    }
    free(todo.v);
}

/* A hull edge: from the leftmost point, with all others on its left; where two points are on its line, it
 * ends at the nearer one. */
static void first_edge(const struct brute *b, uint32_t *from, uint32_t *to)
{
    *from = *to = DT_NONE;
    for (uint32_t i = 0; i < b->n; i++)
        if (is_point(b, i) && (*from == DT_NONE || dt_compare_xy(b->p[i], b->p[*from]) < 0))
            *from = i;
    for (uint32_t i = 0; i < b->n; i++) {
        if (!is_point(b, i) || i == *from)
            continue;
        int turn = *to == DT_NONE ? -1 : dt_orient2d(b->p[*from], b->p[*to], b->p[i]);
        if (turn < 0 || (turn == 0 && dt_compare_xy(b->p[i], b->p[*to]) < 0))
            *to = i;
    }
}

/* Insertion sort along the line, from the end with the smaller id. */
static void sort_line(struct brute *b)
{
    uint32_t n = 0;
    b->line = malloc((b->points + 1) * sizeof *b->line);
    for (uint32_t i = 0; i < b->n; i++) {
        if (!is_point(b, i))
            continue;
        uint32_t at = n++;
        for (; at > 0 && dt_compare_xy(b->p[b->line[at - 1]], b->p[i]) > 0; at--)
            b->line[at] = b->line[at - 1];
        b->line[at] = i;
    }
    if (n > 0 && b->line[0] > b->line[n - 1])
        reverse(b->line, 0, n);
}

struct brute *brute_new(const struct dt_point *p, const bool *live, uint32_t n)
{
    struct brute *b = calloc(1, sizeof *b);
    b->n = n;
    b->p = malloc((n + 1) * sizeof *b->p);
    b->rep = malloc((n + 1) * sizeof *b->rep);
    b->apex = malloc(((size_t)n * n + 1) * sizeof *b->apex);
    for (uint32_t i = 0; i < n; i++)
        b->p[i] = p[i];
    for (size_t i = 0; i < (size_t)n * n; i++)
        b->apex[i] = UNKNOWN;
    find_representatives(b, live);
    uint32_t from = DT_NONE, to = DT_NONE;
    if (b->points > 1) {
        first_edge(b, &from, &to);
        wrap(b, from, to);
    }
    if (b->points < 2 || *apex(b, from, to) == DT_NONE)
        sort_line(b);
    return b;
}

void brute_free(struct brute *b)
{
    free(b->p);
    free(b->rep);
    free(b->apex);
    free(b->line);
    free(b);
}

static bool is_triangle_edge(const struct brute *b, uint32_t u, uint32_t v)
{
    return u != v && is_point(b, u) && is_point(b, v) && *apex(b, u, v) < UNKNOWN;
}

/* The successor of id on the counterclockwise hull, DT_NONE if it is an interior point. */
static uint32_t successor(const struct brute *b, uint32_t id)
{
    for (uint32_t v = 0; v < b->n; v++)
        if (is_triangle_edge(b, id, v) && *apex(b, v, id) == DT_NONE)
            return v;
    return DT_NONE;
}

bool brute_on_hull(const struct brute *b, uint32_t id)
{
    return b->line != NULL || successor(b, id) != DT_NONE;
}

static void ring_on_line(const struct brute *b, uint32_t id, bool cw, struct dt_ids *out)
{
    uint32_t i = 0;
    while (b->line[i] != id)
        i++;
    size_t n = out->n;
    if (i + 1 < b->points)
        append(out, b->line[i + 1]);
    if (i > 0)
        append(out, b->line[i - 1]);
    if (cw)
        reverse(out->v, n, out->n);
}

void brute_ring(const struct brute *b, uint32_t id, bool cw, struct dt_ids *out)
{
    size_t n = out->n;
    if (b->line != NULL) {
        ring_on_line(b, id, cw, out);
        return;
    }
    uint32_t first = successor(b, id);
    bool on_hull = first != DT_NONE;
    for (uint32_t v = 0; v < b->n && first == DT_NONE; v++)
        if (is_triangle_edge(b, id, v))
            first = v;
    uint32_t v = first;
    do {
        append(out, v);
        v = *apex(b, id, v);
    } while (v != DT_NONE && v != first);
    if (cw)
        reverse(out->v, n + !on_hull, out->n);
}

static void append_hull(const struct brute *b, bool cw, struct dt_ids *out)
{
    size_t n = out->n;
    if (b->line != NULL) {
        for (uint32_t i = 0; i < b->points; i++)
            append(out, b->line[i]);
        if (cw)
            reverse(out->v, n, out->n);
        return;
    }
    uint32_t first = 0;
    while (!is_point(b, first) || !brute_on_hull(b, first))
        first++;
    uint32_t v = first;
    do
        append(out, v);
    while ((v = successor(b, v)) != first);
    if (cw)
        reverse(out->v, n + 1, out->n);
}

static void append_list(const struct brute *b, uint32_t id, bool cw, struct dt_ids *out)
{
    append(out, id);
    size_t at = out->n;
    append(out, 0);
    brute_ring(b, id, cw, out);
    out->v[at] = (uint32_t)(out->n - at - 1);
}

static void append_lists(const struct brute *b, bool cw, struct dt_ids *out)
{
    struct dt_ids hull = {0};
    for (uint32_t i = 0; i < b->n; i++)
        if (is_point(b, i) && !brute_on_hull(b, i))
            append_list(b, i, cw, out);
    append_hull(b, cw, &hull);
    for (size_t i = 0; i < hull.n; i++)
        append_list(b, hull.v[i], cw, out);
    free(hull.v);
}

static void append_triangles(const struct brute *b, bool cw, struct dt_ids *out)
{
    for (uint32_t a = 0; a < b->n; a++) {
        for (uint32_t v = a + 1; v < b->n; v++) {
            bool edge = cw ? is_triangle_edge(b, v, a) : is_triangle_edge(b, a, v);
            uint32_t w = !edge ? DT_NONE : cw ? *apex(b, v, a) : *apex(b, a, v);
            if (!edge || w < a)
                continue;
            append(out, a);
            append(out, v);
            append(out, w);
        }
    }
}

static void append_edges(const struct brute *b, struct dt_ids *out)
{
    for (uint32_t a = 0; a < b->n; a++) {
        for (uint32_t v = a + 1; v < b->n; v++) {
            bool edge = is_triangle_edge(b, a, v) || is_triangle_edge(b, v, a);
            for (uint32_t i = 0; b->line != NULL && i + 1 < b->points; i++)
                edge = edge || (b->line[i] == a && b->line[i + 1] == v) ||
                       (b->line[i] == v && b->line[i + 1] == a);
            if (!edge)
                continue;
            append(out, a);
            append(out, v);
        }
    }
}

void brute_table(const struct brute *b, enum dt_table table, bool cw, struct dt_ids *out)
{
    if (table == DT_POINTS || table == DT_COINCIDENT) {
        for (uint32_t i = 0; i < b->n; i++) {
            if (b->rep[i] == DT_NONE || (table == DT_COINCIDENT && b->rep[i] == i))
                continue;
            append(out, i);
            if (table == DT_COINCIDENT)
                append(out, b->rep[i]);
        }
    }
    if (table == DT_LISTS)
        append_lists(b, cw, out);
    if (table == DT_TRIANGLES && b->line == NULL)
        append_triangles(b, cw, out);
    if (table == DT_EDGES)
        append_edges(b, out);
    if (table == DT_HULL)
        append_hull(b, cw, out);
}

void brute_nearest(const struct brute *b, struct dt_point q, uint32_t k, struct dt_ids *out)
{
    size_t n = out->n; /* insertion sort; equal distances stay in the order of ids */
    for (uint32_t i = 0; i < b->n; i++) {
        if (!is_point(b, i))
            continue;
        append(out, i);
        for (size_t at = out->n - 1;
             at > n && dt_compare_distance(q, b->p[out->v[at - 1]], b->p[i]) > 0; at--) {
            out->v[at] = out->v[at - 1];
            out->v[at - 1] = i;
        }
    }
    if (out->n - n > k)
        out->n = n + k;
}

void brute_within_box(const struct brute *b, struct dt_point lo, struct dt_point hi,
                      struct dt_ids *out)
{
    for (uint32_t i = 0; i < b->n; i++)
        if (is_point(b, i) && lo.x <= b->p[i].x && b->p[i].x <= hi.x && lo.y <= b->p[i].y &&
            b->p[i].y <= hi.y)
            append(out, i);
}

void brute_within_disc(const struct brute *b, struct dt_point centre, double r, struct dt_ids *out)
{
    for (uint32_t i = 0; i < b->n; i++)
        if (is_point(b, i) && dt_compare_radius(b->p[i], centre, r) <= 0)
            append(out, i);
}

static bool on_segment(struct dt_point q, struct dt_point a, struct dt_point c)
{
    return dt_orient2d(a, c, q) == 0 && dt_compare_xy(a, q) * dt_compare_xy(q, c) > 0;
}

struct dt_location brute_locate(const struct brute *b, struct dt_point q)
{
    struct dt_location at = {DT_OUTSIDE, {DT_NONE, DT_NONE, DT_NONE}};
    struct dt_ids rows = {0};
    for (uint32_t i = 0; i < b->n; i++)
        if (is_point(b, i) && dt_compare_xy(b->p[i], q) == 0)
            at = (struct dt_location){DT_ON_VERTEX, {i, DT_NONE, DT_NONE}};
    brute_table(b, DT_EDGES, false, &rows);
    for (size_t i = 0; i < rows.n; i += 2)
        if (on_segment(q, b->p[rows.v[i]], b->p[rows.v[i + 1]]))
            at = (struct dt_location){DT_ON_EDGE, {rows.v[i], rows.v[i + 1], DT_NONE}};
    rows.n = 0;
    brute_table(b, DT_TRIANGLES, false, &rows);
    for (size_t i = 0; i < rows.n; i += 3) {
        const uint32_t *v = rows.v + i;
        if (dt_orient2d(b->p[v[0]], b->p[v[1]], q) > 0 &&
            dt_orient2d(b->p[v[1]], b->p[v[2]], q) > 0 &&
            dt_orient2d(b->p[v[2]], b->p[v[0]], q) > 0)
            at = (struct dt_location){DT_INSIDE, {v[0], v[1], v[2]}};
    }
    free(rows.v);
    return at;
}
