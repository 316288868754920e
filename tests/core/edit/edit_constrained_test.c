/* edit_constrained_test.c - moves of the ends of constraints, by flips or otherwise: compared with sets that are made from the places
 * to which they lead. */
#include "core/delaunay_constraints.h"

#include <stdlib.h>
#include <string.h>

#include "tests/test.h"

enum { POINTS = 60, SIDE = 64 };

static uint32_t below(uint32_t n)
{
    return (uint32_t)(test_random() % n);
}

/* The same points and constraints in a new set, one point at another place; *status: of its triangulation. */
static struct dt *made(const struct dt *t, uint32_t id, struct dt_point to, enum dt_status *status)
{
    struct dt *fresh = dt_new(0);
    struct dt_constraint *c;
    struct dt_added added;
    size_t n, declared;
    uint32_t missing;
    for (uint32_t i = 0; i < POINTS; i++) {
        struct dt_point p;
        CHECK(dt_get(t, i, &p) == DT_OK);
        CHECK(dt_add(fresh, i == id ? &to : &p, 1, &added) == DT_OK);
    }
    CHECK(dt_constraints(t, NULL, DT_NONE, &c, &n) == DT_OK);
    CHECK(dt_constrain(fresh, c, n, NULL, &declared, &missing) == DT_OK);
    free(c);
    *status = dt_triangulate(fresh, NULL);
    return fresh;
}

static struct dt_ids triangles(const struct dt *t)
{
    struct dt_cursor c;
    struct dt_ids out = {0};
    size_t rows;
    CHECK(dt_table_begin(t, NULL, DT_TRIANGLES, false, &c) == DT_OK);
    size_t cap = 3 * (size_t)c.rows + 8;
    out.v = malloc(cap * sizeof *out.v);
    CHECK(dt_table_read(t, &c, out.v, cap, cap, &rows, &out.n) == DT_OK);
    return out;
}

static void compare(const struct dt *t, const struct dt *fresh)
{
    const char *fault = NULL;
    struct dt_ids a = triangles(t), b = triangles(fresh);
    CHECK(a.n == b.n && memcmp(a.v, b.v, a.n * sizeof *a.v) == 0);
    if (dt_check(t, NULL, &fault) != DT_OK)
        CHECK_MSG(false, "%s", fault);
    free(a.v);
    free(b.v);
}

static bool are_same(const struct dt_constraint *a, const struct dt_constraint *b)
{
    return a->a == b->a && a->b == b->b && a->border == b->border && a->number == b->number;
}

/* The move succeeds as the set made with it does, or both name the same constraints. */
static void move(struct dt *t, uint32_t id, struct dt_point to)
{
    struct dt_crossed one, other;
    enum dt_status expected;
    struct dt *fresh = made(t, id, to, &expected), *before;
    CHECK(dt_clone(t, &before) == DT_OK);
    CHECK(dt_move(t, id, to) == expected);
    if (expected == DT_CROSSES) {
        dt_crossed(t, &one);
        dt_crossed(fresh, &other);
        CHECK(are_same(&one.one, &other.one) && are_same(&one.other, &other.other));
    }
    compare(t, expected == DT_OK ? fresh : before);
    dt_free(fresh);
    dt_free(before);
}

/* Of a lattice, or of places in general. */
static struct dt_point place(uint32_t parts)
{
    return (struct dt_point){(double)below(SIDE * parts) / parts,
                             (double)below(SIDE * parts) / parts};
}

static struct dt *random_set(uint32_t parts, size_t constraints)
{
    struct dt *t = dt_new(0);
    struct dt_added added;
    for (uint32_t i = 0; i < POINTS; i++) {
        struct dt_point p = place(parts);
        CHECK(dt_add(t, &p, 1, &added) == DT_OK);
    }
    CHECK(dt_triangulate(t, NULL) == DT_OK);
    for (size_t i = 0; i < constraints; i++) {
        struct dt_constraint c = {below(POINTS), below(POINTS), below(4) == 0, below(2)};
        uint32_t missing;
        size_t n;
        (void)dt_constrain(t, &c, 1, NULL, &n, &missing);
    }
    return t;
}

TEST(ends_that_move_a_little_or_far_lead_to_the_set_made_from_their_places)
{
    static const uint32_t parts[] = {1, 16, 1 << 20};
    for (int round = 0; round < 30; round++) {
        uint32_t fine = parts[round % 3];
        struct dt *t = random_set(fine, 30);
        for (int i = 0; i < 20; i++) {
            uint32_t id = below(POINTS);
            struct dt_point p, to = place(fine);
            CHECK(dt_get(t, id, &p) == DT_OK);
            double part = below(8) == 0 ? 1 : 1.0 / 16; /* of the way */
            if (fine > 1)
                to = (struct dt_point){p.x + (to.x - p.x) * part, p.y + (to.y - p.y) * part};
            move(t, id, to);
        }
        dt_free(t);
    }
}

TEST(the_end_of_a_border_takes_its_region_along)
{
    struct dt *t = dt_new(0);
    struct dt_added added;
    struct dt_region *row, all;
    size_t n;
    uint32_t missing;
    struct dt_constraint c[] = {{0, 1, true, 1}, {1, 2, true, 1}, {2, 0, true, 1}};
    CHECK(dt_add(t, (struct dt_point[]){{0, 0}, {4, 0}, {0, 4}, {-9, -9}, {9, -9}, {0, 9}}, 6,
                 &added) == DT_OK);
    CHECK(dt_triangulate(t, NULL) == DT_OK && dt_constrain(t, c, 3, NULL, &n, &missing) == DT_OK);
    CHECK(dt_survey(t, NULL) == DT_OK);
    CHECK(dt_move(t, 0, (struct dt_point){-0.5, 0}) == DT_OK && !dt_surveyed(t));
    CHECK(dt_survey(t, NULL) == DT_OK && dt_regions(t, &row, &n, &all) == DT_OK &&
          row[0].area == 9);
    free(row);
    dt_free(t);
}
