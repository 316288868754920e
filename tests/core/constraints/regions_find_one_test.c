/* regions_find_one_test.c - the regions of a set that has one border alone, against those of the same set with a line elsewhere. */
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

#include "core/delaunay_constraints.h"
#include "tests/test.h"

enum { SIDE = 8, FAR = 1000 };

/* The sets get the same points and borders; the second also has a line that no border meets. */
struct two {
    struct dt *one, *more;
};

static uint32_t add(struct two *s, double x, double y)
{
    struct dt_added added;
    CHECK(dt_add(s->one, &(struct dt_point){x, y}, 1, &added) == DT_OK);
    CHECK(dt_add(s->more, &(struct dt_point){x, y}, 1, &added) == DT_OK);
    return added.first;
}

/* One ring through random lattice points, or the rest of it if sides would cross. */
static void add_ring(struct two *s, unsigned corners, bool closed)
{
    uint32_t id[12], missing;
    size_t added;
    for (unsigned i = 0; i < corners; i++)
        id[i] = add(s, test_below(SIDE), test_below(SIDE));
    for (unsigned i = 0; i < corners - !closed; i++) {
        struct dt_constraint c = {id[i], id[(i + 1) % corners], true, 5};
        if (dt_constrain(s->one, &c, 1, NULL, &added, &missing) == DT_OK)
            CHECK(dt_constrain(s->more, &c, 1, NULL, &added, &missing) == DT_OK);
    }
}

static void draw(struct two *s)
{
    struct dt_constraint line = {0, 1, false, 5};
    size_t added;
    uint32_t missing;
    *s = (struct two){dt_new(0), dt_new(0)};
    CHECK(dt_triangulate(s->one, NULL) == DT_OK && dt_triangulate(s->more, NULL) == DT_OK);
    add(s, FAR, FAR);
    add(s, FAR + 1, FAR);
    CHECK(dt_constrain(s->more, &line, 1, NULL, &added, &missing) == DT_OK);
    for (unsigned i = 0; i < SIDE * SIDE && test_below(2) == 0; i++)
        add(s, test_below(SIDE), test_below(SIDE));
    unsigned rings = 1 + test_below(3);
    for (unsigned i = 0; i < rings; i++)
        add_ring(s, 3 + test_below(9), test_below(8) > 0);
}

static void check_regions(const struct two *s)
{
    struct dt_region *row[2], all[2];
    size_t n[2];
    CHECK(dt_regions(s->one, &row[0], &n[0], &all[0]) == DT_OK);
    CHECK(dt_regions(s->more, &row[1], &n[1], &all[1]) == DT_OK && n[0] == n[1]);
    for (size_t i = 0; i < n[0]; i++)
        CHECK(row[0][i].number == row[1][i].number && row[0][i].closed == row[1][i].closed &&
              row[0][i].triangles == row[1][i].triangles && row[0][i].area == row[1][i].area);
    CHECK(all[0].triangles == all[1].triangles && all[0].area == all[1].area);
    free(row[0]);
    free(row[1]);
}

static void check_rows(const struct two *s, enum dt_table table)
{
    struct dt_ids row[2] = {{0}, {0}};
    CHECK(dt_inside(s->one, DT_NONE, table, false, NULL, &row[0]) == DT_OK);
    CHECK(dt_inside(s->more, DT_NONE, table, false, NULL, &row[1]) == DT_OK);
    CHECK(row[0].n == row[1].n);
    CHECK(row[0].n == 0 || memcmp(row[0].v, row[1].v, row[0].n * sizeof *row[0].v) == 0);
    free(row[0].v);
    free(row[1].v);
}

static void check_place(const struct two *s, struct dt_point q)
{
    struct dt_ids in[2] = {{0}, {0}}, on[2] = {{0}, {0}};
    CHECK(dt_regions_at(s->one, q, NULL, &in[0], &on[0]) == DT_OK);
    CHECK(dt_regions_at(s->more, q, NULL, &in[1], &on[1]) == DT_OK);
    CHECK(in[0].n == in[1].n && on[0].n == on[1].n);
    for (int k = 0; k < 2; k++) {
        free(in[k].v);
        free(on[k].v);
    }
}

static void check_same(const struct two *s)
{
    CHECK(dt_survey(s->one, NULL) == DT_OK && dt_survey(s->more, NULL) == DT_OK);
    CHECK(dt_check(s->one, NULL, NULL) == DT_OK && dt_check(s->more, NULL, NULL) == DT_OK);
    check_regions(s);
    check_rows(s, DT_TRIANGLES);
    check_rows(s, DT_EDGES);
    for (int i = 0; i < 30; i++)
        check_place(s, (struct dt_point){test_below(2 * SIDE) / 2.0, test_below(2 * SIDE) / 2.0});
}

static void free_both(struct two *s)
{
    dt_free(s->one);
    dt_free(s->more);
}

TEST(the_region_of_one_border_alone_is_that_beside_other_constraints)
{
    for (int round = 0; round < 300; round++) {
        struct two s;
        draw(&s);
        check_same(&s);
        for (unsigned i = test_below(6); i > 0; i--) /* faces are carried along */
            add(&s, test_below(4 * SIDE) / 4.0, test_below(4 * SIDE) / 4.0);
        check_same(&s);
        uint32_t id = 2 + test_below(20), deleted, missing;
        if (dt_delete(s.one, &id, 1, &deleted, &missing) == DT_OK)
            CHECK(dt_delete(s.more, &id, 1, &deleted, &missing) == DT_OK);
        check_same(&s);
        free_both(&s);
    }
}

TEST(one_border_of_coincident_or_collinear_points_encloses_nothing)
{
    for (int collinear = 0; collinear < 2; collinear++) {
        struct two s = {dt_new(0), dt_new(0)};
        struct dt_constraint ring[] = {{0, 1, true, 0}, {1, 2, true, 0}, {2, 0, true, 0}};
        struct dt_region *row, all;
        size_t n;
        uint32_t missing;
        for (int i = 0; i < 3; i++)
            add(&s, collinear * i, 7);
        CHECK(dt_constrain(s.one, ring, 3, NULL, &n, &missing) == DT_OK && n == 3);
        CHECK(dt_triangulate(s.one, NULL) == DT_OK && dt_survey(s.one, NULL) == DT_OK);
        CHECK(dt_regions(s.one, &row, &n, &all) == DT_OK && n == 1 && row[0].closed);
        CHECK(all.triangles == 0 && all.area == 0 && dt_check(s.one, NULL, NULL) == DT_OK);
        free(row);
        free_both(&s);
    }
}

TEST(a_survey_of_one_border_can_be_cancelled_and_repeated)
{
    enum { N = 20000 };
    struct dt *t = dt_new(0);
    struct dt_constraint *c = calloc(N, sizeof *c);
    struct dt_point *p = calloc(N, sizeof *p);
    struct dt_region *row, all;
    struct dt_added added;
    size_t n;
    uint32_t missing;
    atomic_bool cancel = true;
    for (uint32_t i = 0; i < N; i++) { /* a comb and its back */
        p[i] = (struct dt_point){i, i + 2 < N ? i % 2 : 5};
        c[i] = (struct dt_constraint){i, (i + 1) % N, true, 3};
    }
    p[N - 2].x = N, p[N - 1].x = -1;
    CHECK(dt_add(t, p, N, &added) == DT_OK && dt_constrain(t, c, N, NULL, &n, &missing) == DT_OK);
    CHECK(dt_triangulate(t, NULL) == DT_OK);
    CHECK(dt_survey(t, &(struct dt_options){.cancel = &cancel}) == DT_CANCELLED);
    CHECK(!dt_surveyed(t) && dt_survey(t, NULL) == DT_OK);
    CHECK(dt_regions(t, &row, &n, &all) == DT_OK && n == 1 && row[0].triangles == N - 2);
    free(row);
    free(c);
    free(p);
    dt_free(t);
}
