/* constrained.c - see constrained.h. */
#include "tests/oracle/constrained.h"

#include <stdlib.h>
#include <string.h>

#include "tests/oracle/exact.h"

/* A table of t, and the places of its ids. */
struct picture {
    const struct dt *t;
    uint32_t ids;        /* 0 .. ids - 1 */
    struct dt_point *xy; /* by id */
    bool *vertex;        /* whether the id is a representative */
    uint32_t (*tri)[3];  /* triangles */
    uint32_t *fixed;     /* bit b of word a * words: a-b, a < b, is covered */
    uint32_t triangles, words, vertices;
    struct dt_constraint *c;
    size_t constraints;
};

static void *take(size_t n, size_t size)
{
    void *p = calloc(n + 1, size);
    if (p == NULL)
        abort();
    return p;
}

static void read_triangles(struct picture *g)
{
    struct dt_cursor c;
    uint32_t row[8];
    size_t rows, words;
    if (dt_table_begin(g->t, NULL, DT_TRIANGLES, false, &c) != DT_OK)
        abort();
    g->tri = take(c.rows, sizeof *g->tri);
    while (dt_table_read(g->t, &c, row, 3, 1, &rows, &words) == DT_OK && rows == 1)
        memcpy(g->tri[g->triangles++], row, sizeof *g->tri);
}

static void picture_begin(struct picture *g, const struct dt *t)
{
    *g = (struct picture){.t = t, .ids = dt_next_id(t)};
    g->words = g->ids / 32 + 1;
    g->xy = take(g->ids, sizeof *g->xy);
    g->vertex = take(g->ids, sizeof *g->vertex);
    g->fixed = take((size_t)g->ids * g->words, sizeof *g->fixed);
    for (uint32_t id = 0; id < g->ids; id++) {
        uint32_t rep;
        if (dt_representative(t, id, &rep) != DT_OK)
            continue;
        (void)dt_get(t, rep, &g->xy[id]);
        g->vertex[id] = rep == id;
        g->vertices += rep == id;
    }
    read_triangles(g);
    if (dt_constraints(t, NULL, DT_NONE, &g->c, &g->constraints) != DT_OK)
        abort();
}

static void picture_end(struct picture *g)
{
    free(g->xy);
    free(g->vertex);
    free(g->tri);
    free(g->fixed);
    free(g->c);
}

static int side(const struct picture *g, uint32_t a, uint32_t b, uint32_t c)
{
    return exact_orient2d(g->xy[a], g->xy[b], g->xy[c]);
}

/* Whether v lies strictly between a and b on their line. */
static bool lies_on(const struct picture *g, uint32_t v, uint32_t a, uint32_t b)
{
    struct dt_point p = g->xy[a], q = g->xy[b], r = g->xy[v];
    if (side(g, a, b, v) != 0 || (r.x == p.x && r.y == p.y) || (r.x == q.x && r.y == q.y))
        return false;
    return (r.x - p.x) * (q.x - r.x) >= 0 && (r.y - p.y) * (q.y - r.y) >= 0;
}

static uint32_t *fixed_word(const struct picture *g, uint32_t a, uint32_t b)
{
    uint32_t lo = a < b ? a : b, hi = a < b ? b : a;
    return &g->fixed[(size_t)lo * g->words + hi / 32];
}

static bool is_fixed(const struct picture *g, uint32_t a, uint32_t b)
{
    return (*fixed_word(g, a, b) >> (a < b ? b : a) % 32 & 1) != 0;
}

/* Covers the parts of the constraint between neighbouring vertices on it. */
static void cover(const struct picture *g, uint32_t a, uint32_t b)
{
    for (uint32_t p = 0; p < g->ids; p++) {
        if (!g->vertex[p] || (p != a && p != b && !lies_on(g, p, a, b)))
            continue;
        for (uint32_t q = p + 1; q < g->ids; q++) {
            if (!g->vertex[q] || (q != a && q != b && !lies_on(g, q, a, b)))
                continue;
            bool neighbours = true;
            for (uint32_t v = 0; v < g->ids && neighbours; v++)
                neighbours = !g->vertex[v] || !lies_on(g, v, p, q);
            if (neighbours)
                *fixed_word(g, p, q) |= 1u << q % 32;
        }
    }
}

/* The triangle on the left of a->b: its third corner, DT_NONE if there is none. */
static uint32_t left_of(const struct picture *g, uint32_t a, uint32_t b)
{
    for (uint32_t i = 0; i < g->triangles; i++)
        for (int k = 0; k < 3; k++)
            if (g->tri[i][k] == a && g->tri[i][(k + 1) % 3] == b)
                return g->tri[i][(k + 2) % 3];
    return DT_NONE;
}

/* Whether t has the edge; also for points on one line. */
static bool has_edge(const struct picture *g, uint32_t a, uint32_t b)
{
    struct dt_ids out = {0};
    bool there = dt_triangles_at_edge(g->t, a, b, false, &out) == DT_OK;
    free(out.v);
    return there;
}

static const char *edge_fault(const struct picture *g, uint32_t a, uint32_t b, uint32_t c,
                              uint32_t *hull)
{
    uint32_t d = left_of(g, b, a);
    if (d == DT_NONE) {
        ++*hull;
        for (uint32_t v = 0; v < g->ids; v++)
            if (g->vertex[v] && side(g, a, b, v) < 0)
                return "the hull is not convex";
        return NULL;
    }
    if (!is_fixed(g, a, b) && exact_incircle_perturbed(g->xy[a], g->xy[b], g->xy[c], g->xy[d]) >= 0)
        return "an edge is not locally Delaunay";
    return NULL;
}

static const char *triangles_fault(const struct picture *g)
{
    uint32_t hull = 0;
    for (uint32_t i = 0; i < g->triangles; i++) {
        const uint32_t *v = g->tri[i];
        if (side(g, v[0], v[1], v[2]) <= 0)
            return "a triangle does not turn left";
        for (int k = 0; k < 3; k++) {
            const char *fault = edge_fault(g, v[k], v[(k + 1) % 3], v[(k + 2) % 3], &hull);
            if (fault != NULL)
                return fault;
        }
    }
    if (g->triangles > 0 && g->triangles != 2 * g->vertices - 2 - hull)
        return "the triangles do not tile the hull";
    return NULL;
}

static const char *constraints_fault(const struct picture *g)
{
    struct dt_ids edges = {0};
    size_t covered = 0;
    if (dt_constrained_edges(g->t, &edges) != DT_OK)
        abort();
    const char *fault = NULL;
    for (uint32_t a = 0; a < g->ids; a++)
        for (uint32_t b = a + 1; b < g->ids; b++) {
            if (!is_fixed(g, a, b))
                continue;
            if (!has_edge(g, a, b))
                fault = "a constraint is not in the triangulation";
            else if (covered + 2 > edges.n || edges.v[covered] != a || edges.v[covered + 1] != b)
                fault = "the constrained edges are not those of the constraints";
            covered += 2;
        }
    if (fault == NULL && covered != edges.n)
        fault = "too many edges are constrained";
    free(edges.v);
    return fault;
}

const char *constrained_fault(const struct dt *t)
{
    struct picture g;
    picture_begin(&g, t);
    for (size_t i = 0; i < g.constraints; i++) {
        uint32_t a = DT_NONE, b = DT_NONE;
        (void)dt_representative(t, g.c[i].a, &a);
        (void)dt_representative(t, g.c[i].b, &b);
        if (a != b)
            cover(&g, a, b);
    }
    const char *fault = constraints_fault(&g);
    if (fault == NULL)
        fault = triangles_fault(&g);
    picture_end(&g);
    return fault;
}

bool constraints_cross(const struct dt *t, uint32_t a, uint32_t b, uint32_t c, uint32_t d)
{
    struct dt_point p[4];
    const uint32_t id[4] = {a, b, c, d};
    for (int i = 0; i < 4; i++) {
        uint32_t rep = DT_NONE;
        (void)dt_representative(t, id[i], &rep);
        (void)dt_get(t, rep, &p[i]);
    }
    if (exact_orient2d(p[0], p[1], p[2]) * exact_orient2d(p[0], p[1], p[3]) >= 0 ||
        exact_orient2d(p[2], p[3], p[0]) * exact_orient2d(p[2], p[3], p[1]) >= 0)
        return false;
    for (uint32_t v = 0; v < dt_next_id(t); v++) {
        uint32_t rep;
        struct dt_point at;
        if (dt_representative(t, v, &rep) != DT_OK || rep != v || dt_get(t, v, &at) != DT_OK)
            continue;
        if (exact_orient2d(p[0], p[1], at) == 0 && exact_orient2d(p[2], p[3], at) == 0)
            return false;
    }
    return true;
}
