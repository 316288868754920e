/* query_test.c - triangles at points, edges and triangles; location. */
#include <stdlib.h>
#include <string.h>

#include "tests/core/sets.h"
#include "tests/test.h"

static void append_triple(struct dt_ids *out, bool cw, uint32_t a, uint32_t b, uint32_t c)
{
    uint32_t v[3] = {a, b, c};
    int least = a < b ? (a < c ? 0 : 2) : (b < c ? 1 : 2);
    uint32_t second = v[(least + 1) % 3], third = v[(least + 2) % 3];
    out->v = realloc(out->v, (out->n + 3) * sizeof *out->v);
    out->v[out->n++] = v[least];
    out->v[out->n++] = cw ? third : second;
    out->v[out->n++] = cw ? second : third;
}

/* The triangle left of the edge from a to b, if there is one. */
static uint32_t left_of(const struct brute *b, uint32_t from, uint32_t to)
{
    uint32_t c = b->line != NULL || from == to ? DT_NONE : b->apex[(size_t)from * b->n + to];
    return c < b->n ? c : DT_NONE;
}

static void check_at_points(const struct pair *pair)
{
    for (uint32_t id = 0; id < pair->b->n; id++) {
        uint32_t rep = pair->b->rep[id];
        for (int cw = 0; rep != DT_NONE && cw < 2; cw++) {
            struct dt_ids ring = {0}, got = {0}, want = {0};
            brute_ring(pair->b, rep, cw, &ring);
            size_t n = pair->b->line != NULL         ? 0
                       : brute_on_hull(pair->b, rep) ? ring.n - 1
                                                     : ring.n;
            for (size_t i = 0; i < n; i++) {
                uint32_t u = ring.v[i], v = ring.v[(i + 1) % ring.n];
                append_triple(&want, cw, rep, cw ? v : u, cw ? u : v);
            }
            CHECK(dt_triangles_at_point(pair->t, id, cw, &got) == DT_OK);
            check_equal_ids("triangles at a point", &got, &want);
            free(ring.v);
            free(got.v);
            free(want.v);
        }
    }
}

TEST(triangles_at_points_equal_brute_force)
{
    for_each_pair(check_at_points);
}

static bool neighbours_on_line(const struct brute *b, uint32_t u, uint32_t v)
{
    for (uint32_t i = 0; b->line != NULL && i + 1 < b->points; i++)
        if ((b->line[i] == u && b->line[i + 1] == v) || (b->line[i] == v && b->line[i + 1] == u))
            return true;
    return false;
}

static void check_at_edges(const struct pair *pair)
{
    const struct brute *b = pair->b;
    for (int i = 0; b->n > 0 && i < 300; i++) {
        uint32_t u = test_below(b->n), v = test_below(b->n), ru = b->rep[u], rv = b->rep[v];
        struct dt_ids got = {0}, want = {0};
        bool cw = i % 2 == 1;
        enum dt_status s = dt_triangles_at_edge(pair->t, u, v, cw, &got);
        if (ru == DT_NONE || rv == DT_NONE) {
            CHECK(s == DT_NOPOINT);
            continue;
        }
        uint32_t left = left_of(b, ru, rv), right = left_of(b, rv, ru);
        if (left != DT_NONE)
            append_triple(&want, cw, ru, rv, left);
        if (right != DT_NONE)
            append_triple(&want, cw, rv, ru, right);
        CHECK(s == (want.n > 0 || neighbours_on_line(b, ru, rv) ? DT_OK : DT_NOEDGE));
        check_equal_ids("triangles at an edge", &got, &want);
        free(got.v);
        free(want.v);
    }
}

TEST(triangles_at_edges_equal_brute_force)
{
    for_each_pair(check_at_edges);
}

static void check_at_triangles(const struct pair *pair)
{
    const struct brute *b = pair->b;
    struct dt_ids rows = {0};
    brute_table(b, DT_TRIANGLES, false, &rows);
    for (size_t i = 0; i < rows.n; i += 3) {
        uint32_t v[3], turn = test_below(3);
        bool back = test_below(2) == 1, cw = test_below(2) == 1;
        struct dt_ids got = {0}, want = {0};
        for (uint32_t k = 0; k < 3; k++) /* the corners from any one on, in either direction */
            v[k] = rows.v[i + (turn + (back ? 3 - k : k)) % 3];
        for (uint32_t k = 0; k < 3; k++) {
            uint32_t x = v[back ? (k + 1) % 3 : k], y = v[back ? k : (k + 1) % 3],
                     w = left_of(b, y, x);
            if (w != DT_NONE)
                append_triple(&want, cw, y, x, w);
        }
        CHECK(dt_triangles_at_triangle(pair->t, v[0], v[1], v[2], cw, &got) == DT_OK);
        check_equal_ids("triangles at a triangle", &got, &want);
        free(got.v);
        free(want.v);
    }
    for (int i = 0; b->n > 0 && i < 50; i++) {
        uint32_t u = test_below(b->n), v = test_below(b->n), w = test_below(b->n);
        struct dt_ids got = {0};
        enum dt_status s = dt_triangles_at_triangle(pair->t, u, v, w, false, &got);
        bool live = b->rep[u] != DT_NONE && b->rep[v] != DT_NONE && b->rep[w] != DT_NONE;
        bool triangle = live && (left_of(b, b->rep[u], b->rep[v]) == b->rep[w] ||
                                 left_of(b, b->rep[v], b->rep[u]) == b->rep[w]);
        CHECK(s == (triangle ? DT_OK : live ? DT_NOTRIANGLE : DT_NOPOINT));
        free(got.v);
    }
    free(rows.v);
}

TEST(triangles_at_triangles_equal_brute_force)
{
    for_each_pair(check_at_triangles);
}

static void check_locate(const struct pair *pair)
{
    for (int i = 0; i < 60; i++) {
        struct dt_point q = random_place(pair->b);
        struct dt_location got, want = brute_locate(pair->b, q);
        CHECK(dt_locate(pair->t, q, &got) == DT_OK);
        CHECK_MSG(got.where == want.where && memcmp(got.id, want.id, sizeof got.id) == 0,
                  "%a %a: got %d %u %u %u, want %d %u %u %u", q.x, q.y, got.where, got.id[0],
                  got.id[1], got.id[2], want.where, want.id[0], want.id[1], want.id[2]);
    }
}

TEST_TIMEOUT(location_equals_brute_force_on_every_family, 60)
{
    for_each_pair(check_locate);
}

TEST(queries_need_a_triangulation)
{
    struct dt *t = dt_new(0);
    struct dt_ids out = {0};
    struct dt_location at;
    struct dt_point q = {1, 2};
    uint32_t id = 0, rep;
    size_t kept, interior;
    bool boundary;
    CHECK(dt_ring(t, 0, false, &out, &rep, &boundary) == DT_UNTRIANGULATED);
    CHECK(dt_lists_order(t, false, &id, 1, NULL, &kept, &interior) == DT_UNTRIANGULATED);
    CHECK(dt_triangles_at_point(t, 0, false, &out) == DT_UNTRIANGULATED);
    CHECK(dt_triangles_at_edge(t, 0, 1, false, &out) == DT_UNTRIANGULATED);
    CHECK(dt_triangles_at_triangle(t, 0, 1, 2, false, &out) == DT_UNTRIANGULATED);
    CHECK(dt_locate(t, q, &at) == DT_UNTRIANGULATED);
    CHECK(dt_nearest(t, q, 1, &out) == DT_UNTRIANGULATED);
    CHECK(dt_within_box(t, q, q, NULL, &out) == DT_UNTRIANGULATED);
    CHECK(dt_within_disc(t, q, 1, NULL, &out) == DT_UNTRIANGULATED);
    CHECK(dt_check(t, NULL, NULL) == DT_UNTRIANGULATED);
    CHECK(out.n == 0);
    dt_free(t);
}
