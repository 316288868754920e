/* points_test.c - ids, aliases and coincidence against a trivial model. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/exact/predicates.h"
#include "core/memory/memory.h"
#include "core/set/set.h"
#include "tests/test.h"

enum { MAX_IDS = 400 };

/* The model: representative[id] is DT_NONE for a dead id. */
struct model {
    uint32_t ids;
    uint32_t representative[MAX_IDS];
    struct dt_point xy[MAX_IDS];
    double tol;
};

static bool is_representative(const struct model *m, uint32_t id)
{
    return m->representative[id] == id;
}

/* The representative that a point at q coincides with, DT_NONE if none. */
static uint32_t model_find(const struct model *m, struct dt_point q)
{
    uint32_t best = DT_NONE;
    for (uint32_t id = 0; id < m->ids; id++) {
        if (!is_representative(m, id) || dt_compare_radius(m->xy[id], q, m->tol) > 0)
            continue;
        if (best == DT_NONE || dt_compare_distance(q, m->xy[id], m->xy[best]) < 0)
            best = id;
    }
    return best;
}

/* A representative that stands exactly where the representative id does; DT_NONE if there is none.
 */
static uint32_t twin_of(const struct model *m, uint32_t id)
{
    for (uint32_t i = 0; i < m->ids; i++)
        if (i != id && is_representative(m, i) && dt_compare_xy(m->xy[i], m->xy[id]) == 0)
            return i;
    return DT_NONE;
}

static void model_leave(struct model *m, uint32_t id)
{
    uint32_t heir = DT_NONE;
    if (is_representative(m, id))
        for (uint32_t i = 0; i < m->ids; i++)
            if (i != id && m->representative[i] == id) {
                heir = heir == DT_NONE ? i : heir;
                m->representative[i] = heir;
            }
    m->representative[id] = DT_NONE;
    uint32_t twin = heir == DT_NONE ? DT_NONE : twin_of(m, heir);
    uint32_t smaller = heir < twin ? heir : twin;
    for (uint32_t i = 0; twin != DT_NONE && i < m->ids; i++)
        if (m->representative[i] == heir || m->representative[i] == twin)
            m->representative[i] = smaller;
}

static void model_arrive(struct model *m, uint32_t id, struct dt_point q)
{
    uint32_t there = model_find(m, q);
    m->xy[id] = q;
    m->representative[id] = there == DT_NONE ? id : there;
    if (there == DT_NONE || id > there || dt_compare_xy(m->xy[there], q) != 0)
        return;
    for (uint32_t i = 0; i < m->ids; i++) /* the smallest of equal points represents them */
        if (m->representative[i] == there)
            m->representative[i] = id;
    m->representative[id] = id;
}

static void check_same(const struct dt_points *p, const struct model *m)
{
    uint32_t live = 0, vertices = 0, scan = dt_points_next_live(p, 0);
    for (uint32_t id = 0; id < m->ids; id++) {
        uint32_t v = dt_points_vertex(p, id);
        if (m->representative[id] == DT_NONE) {
            CHECK(v == DT_NONE);
            continue;
        }
        CHECK(scan == id);
        scan = dt_points_next_live(p, id + 1);
        CHECK_MSG(p->id[v] == m->representative[id], "id %u: %u, want %u", id, p->id[v],
                  m->representative[id]);
        CHECK(dt_points_is_alias(p, id) == !is_representative(m, id));
        struct dt_point xy = dt_points_xy(p, id);
        CHECK(xy.x == m->xy[id].x && xy.y == m->xy[id].y);
        live++;
        vertices += is_representative(m, id);
    }
    CHECK(scan == DT_NONE && dt_points_live(p) == live && dt_points_vertices(p) == vertices);
}

static struct dt_point random_place(double spacing)
{
    return (struct dt_point){test_below(6) * spacing, test_below(6) * spacing};
}

static uint32_t random_live(const struct model *m)
{
    for (unsigned tries = 0; tries < 1000; tries++) {
        uint32_t id = test_below(m->ids);
        if (m->representative[id] != DT_NONE)
            return id;
    }
    return DT_NONE;
}

/* One random edit of both; false if the points ran out of memory. */
static bool edit(struct dt *t, struct model *m, double spacing)
{
    uint32_t what = test_below(10), id = m->ids == 0 ? DT_NONE : random_live(m);
    struct dt_point q = random_place(spacing);
    if (what < 4 || id == DT_NONE) {
        struct dt_added added;
        if (m->ids == MAX_IDS)
            return true;
        if (dt_add(t, &q, 1, &added) != DT_OK)
            return false;
        CHECK(added.first == m->ids && added.added == 1);
        model_arrive(m, m->ids, q);
        CHECK(added.coincident == !is_representative(m, m->ids));
        m->ids++;
    } else if (what < 7) {
        uint32_t deleted, missing;
        if (dt_delete(t, &id, 1, &deleted, &missing) != DT_OK)
            return false;
        model_leave(m, id);
    } else {
        if (dt_move(t, id, q) != DT_OK)
            return false;
        if (dt_compare_xy(m->xy[id], q) == 0)
            return true; /* it did not move */
        model_leave(m, id);
        model_arrive(m, id, q);
    }
    return true;
}

static void run_script(double tol, double spacing)
{
    struct model m = {.tol = tol};
    struct dt *t = dt_new(tol);
    struct dt_points *p = &t->points;
    for (unsigned i = 0; i < 700; i++) {
        CHECK(edit(t, &m, spacing));
        check_same(p, &m);
    }
    dt_free(t);
}

TEST(points_agree_with_the_model_when_equal_places_coincide)
{
    for (unsigned i = 0; i < 30; i++)
        run_script(0, 1);
}

TEST(points_agree_with_the_model_under_a_tolerance)
{
    for (unsigned i = 0; i < 30; i++)
        run_script(0.25 * (1 + test_below(6)), i % 2 ? 1 : 0.3);
}

TEST(points_are_unchanged_when_an_edit_runs_out_of_memory)
{
    for (unsigned round = 0; round < 60; round++) {
        struct model m = {.tol = round % 2 ? 0.5 : 0};
        struct dt *t = dt_new(m.tol);
        for (unsigned i = 0; i < 300; i++) {
            test_fail_alloc(1 + (long)test_below(3));
            edit(t, &m, 0.4);
            test_fail_alloc(0);
            check_same(&t->points, &m);
        }
        dt_free(t);
    }
}

TEST(a_successor_whose_place_is_occupied_joins_the_point_there)
{
    struct dt_added added;
    struct dt_point q[] = {{0, 0}, {1.2, 0}, {2, 0}, {1.2, 0}};
    uint32_t ids[] = {0, 2};
    struct dt *t = dt_new(1.5);
    struct dt_points *p = &t->points;
    CHECK(dt_add(t, q, 4, &added) == DT_OK && added.coincident == 2);
    CHECK(dt_points_delete_ready(p, ids, 2, NULL) == DT_OK);
    dt_points_delete(p, 0);
    dt_points_delete(p, 2);
    CHECK(dt_points_vertices(p) == 1 && dt_points_live(p) == 2);
    CHECK(dt_points_vertex(p, 1) == dt_points_vertex(p, 3) && dt_points_is_alias(p, 3));
    dt_free(t);
}

TEST(points_coincide_across_the_border_of_cells)
{
    struct dt_added added;
    /* Cells are two tolerances wide: the border at 2 lies between the two. */
    struct dt_point q[] = {{1.75, 0}, {2.25, 0}, {2.75, 0}};
    struct dt *t = dt_new(1);
    CHECK(dt_add(t, q, 3, &added) == DT_OK && added.coincident == 2);
    dt_free(t);
}

TEST(points_far_out_coincide_although_cells_are_finer_than_doubles_there)
{
    struct dt_added added;
    struct dt_point q[] = {{1e30, -1e30},
                           {1e30, -1e30},
                           {nextafter(1e30, 2e30), -1e30},
                           {0x1p201, 0x1p-142},
                           {0x1p201, 0}};
    struct dt *t = dt_new(0x1p-100);
    CHECK(dt_add(t, q, 5, &added) == DT_OK);
    CHECK(added.coincident == 2); /* the second of the first, the last of the one before */
    dt_free(t);
}

TEST(points_take_minus_zero_for_zero)
{
    struct dt_added added;
    struct dt_point q[] = {{0.0, 1}, {-0.0, 1}};
    struct dt *t = dt_new(0);
    struct dt_points *p = &t->points;
    CHECK(dt_add(t, q, 2, &added) == DT_OK && added.coincident == 1);
    CHECK(!signbit(dt_points_xy(p, 1).x));
    dt_free(t);
}

TEST(points_free_the_memory_of_deleted_ids)
{
    struct dt_added added;
    struct dt *t = dt_new(0);
    struct dt_points *p = &t->points;
    size_t most = 0;
    for (uint32_t i = 0; i < 300000; i++) {
        struct dt_point q = {i, 0};
        CHECK(dt_add(t, &q, 1, &added) == DT_OK);
        if (i >= 100) {
            uint32_t id = i - 100;
            CHECK(dt_points_delete_ready(p, &id, 1, NULL) == DT_OK);
            dt_points_delete(p, id);
        }
        most = dt_points_memory(p) > most ? dt_points_memory(p) : most;
    }
    CHECK_MSG(most < 400000, "%zu bytes", most);
    dt_free(t);
}

TEST(points_in_one_batch_are_all_added_or_none)
{
    struct dt_point q[50];
    struct dt_added added;
    for (unsigned i = 0; i < 50; i++)
        q[i] = (struct dt_point){i % 7, i % 5};
    for (long nth = 1; nth < 20; nth++) {
        struct dt *t = dt_new(0);
        const struct dt_points *p = &t->points;
        test_fail_alloc(nth);
        enum dt_status status = dt_add(t, q, 50, &added);
        bool failed = test_alloc_failed();
        test_fail_alloc(0);
        CHECK(status == (failed ? DT_NOMEM : DT_OK));
        CHECK(dt_points_live(p) == (failed ? 0 : 50) && p->next_id == (failed ? 0 : 50));
        CHECK(dt_points_next_live(p, 0) == (failed ? DT_NONE : 0));
        dt_free(t);
    }
}

TEST(points_keep_their_ids_when_vertices_are_renumbered)
{
    struct dt_added added;
    struct dt_point q[] = {{5, 5}, {1, 1}, {5, 5}, {3, 3}};
    struct dt *t = dt_new(0);
    struct dt_points *p = &t->points;
    CHECK(dt_add(t, q, 4, &added) == DT_OK);
    uint32_t *id = dt_array_new(3, sizeof *id);
    struct dt_point *xy = dt_array_new(3, sizeof *xy);
    memcpy(id, (uint32_t[]){1, 3, 0}, 3 * sizeof *id);
    memcpy(xy, (struct dt_point[]){{1, 1}, {3, 3}, {5, 5}}, 3 * sizeof *xy);
    CHECK(dt_points_renumber(p, &xy, &id, 3, NULL) == DT_OK);
    dt_array_free(xy);
    dt_array_free(id);
    CHECK(dt_points_vertex(p, 0) == 2 && dt_points_vertex(p, 2) == 2 &&
          dt_points_vertex(p, 3) == 1);
    CHECK(dt_points_xy(p, 2).x == 5 && dt_points_is_alias(p, 2));
    CHECK(dt_add(t, &q[3], 1, &added) == DT_OK && added.coincident == 1);
    dt_free(t);
}
