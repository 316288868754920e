/* edit_test.c - insertion and removal on a bare mesh: after every step it is the canonical
 * triangulation. */
#include <math.h>
#include <string.h>

#include "core/edit/insert.h"
#include "core/edit/remove.h"
#include "core/exact/predicates.h"
#include "core/hints/hints.h"
#include "core/query/locate.h"
#include "tests/core/mesh_check.h"
#include "tests/oracle/families.h"
#include "tests/test.h"

enum { MAX = 3000 };

struct edited {
    struct dt_mesh mesh;
    struct dt_cavity scratch;
    struct dt_point xy[MAX];
    bool in[MAX];
    uint32_t n;
};

static void edited_init(struct edited *e)
{
    memset(e, 0, sizeof *e);
    dt_mesh_clear(&e->mesh);
}

static void edited_clear(struct edited *e)
{
    dt_mesh_clear(&e->mesh);
    dt_cavity_clear(&e->scratch);
}

static uint32_t any_vertex(const struct edited *e)
{
    for (uint32_t v = 0; v < MAX; v++)
        if (e->in[v])
            return v;
    return DT_NONE;
}

/* Inserts a point as the first free vertex unless its place is taken. DT_NOMEM if that is so. */
static enum dt_status insert(struct edited *e, struct dt_point q)
{
    uint32_t v = 0, half = any_vertex(e);
    enum dt_where where = DT_OUTSIDE;
    for (uint32_t u = 0; u < MAX; u++)
        if (e->in[u] && dt_compare_xy(e->xy[u], q) == 0)
            return DT_OK;
    while (e->in[v])
        v++;
    e->xy[v] = q;
    if (e->n > 1)
        where = dt_walk(&e->mesh, e->xy, e->mesh.leaving[half], q, &half);
    enum dt_status status = dt_insert(&e->mesh, e->xy, v, where, half, &e->scratch);
    if (status == DT_OK) {
        e->in[v] = true;
        e->n++;
    }
    return status;
}

static enum dt_status delete (struct edited *e, uint32_t v) {
    enum dt_status status = dt_remove(&e->mesh, e->xy, v, &e->scratch);
    if (status == DT_OK){e->in[v] = false; e->n--;}
return status;
}

static void delete_random(struct edited *e, uint32_t below)
{
    uint32_t v = test_below(below);
    if (e->in[v])
        CHECK(delete (e, v) == DT_OK);
}

TEST(edits_on_small_lattices_keep_the_mesh_canonical)
{
    static struct edited e;
    for (unsigned round = 0; round < 60; round++) {
        uint32_t side = 2 + test_below(5), height = 1 + test_below(side), growing = test_below(2);
        edited_init(&e);
        for (unsigned i = 0; i < 400; i++) {
            growing = test_below(30) == 0 ? !growing : growing;
            struct dt_point q = {test_below(side), test_below(height)};
            if (test_below(4) < 1 + 2 * growing)
                CHECK(insert(&e, q) == DT_OK);
            else
                delete_random(&e, side * height);
            mesh_check(&e.mesh, e.xy);
        }
        edited_clear(&e);
    }
}

TEST(edits_on_every_family_keep_the_mesh_canonical)
{
    static struct edited e;
    static struct dt_point p[120];
    for (const struct family *f = families; f->name != NULL; f++) {
        family_points(f, p, 120, test_random());
        edited_init(&e);
        for (unsigned i = 0; i < 120; i++) {
            CHECK(insert(&e, p[i]) == DT_OK);
            mesh_check(&e.mesh, e.xy);
        }
        while (e.n > 0) {
            delete_random(&e, 120);
            mesh_check(&e.mesh, e.xy);
        }
        edited_clear(&e);
    }
}

TEST(removing_the_hub_of_a_large_wheel_fills_its_hole)
{
    static struct edited e;
    static struct dt_point p[MAX];
    const char *names[] = {"wheel", "circle", "parabola", "line_axis"};
    for (unsigned k = 0; k < 4; k++) {
        family_points(family_find(names[k]), p, 900, 1);
        edited_init(&e);
        for (unsigned i = 0; i < 900; i++)
            CHECK(insert(&e, p[i]) == DT_OK);
        struct dt_point hubs[] = {{0.001, 0.002}, {1e7, 2e7}, {-3, 1e9}, {0, -1e12}};
        for (unsigned i = 0; i < 4; i++) {
            uint32_t before = e.n;
            CHECK(insert(&e, hubs[i]) == DT_OK);
            mesh_check(&e.mesh, e.xy);
            for (uint32_t v = 0; v < MAX && e.n > before; v++)
                if (e.in[v] && dt_compare_xy(e.xy[v], hubs[i]) == 0)
                    CHECK(delete (&e, v) == DT_OK);
            mesh_check(&e.mesh, e.xy);
        }
        edited_clear(&e);
    }
}

TEST(a_hole_of_any_size_has_room_for_its_star)
{
    enum { LARGEST = 400 };
    static struct edited e;
    const struct dt_point hub = {0.001, 0.002};
    edited_init(&e);
    for (unsigned i = 0; i < LARGEST; i++) {
        double a = 6.28 * i / LARGEST;
        CHECK(insert(&e, (struct dt_point){cos(a), sin(a)}) == DT_OK);
        if (dt_mesh_is_line(&e.mesh))
            continue;
        struct dt_cavity hole = {0};
        uint32_t half;
        dt_walk(&e.mesh, e.xy, e.mesh.leaving[0], hub, &half);
        CHECK(dt_find_cavity(&e.mesh, e.xy, dt_base(half), hub, &hole) == DT_OK);
        CHECK(hole.rims == hole.records + 2 && hole.rims <= hole.room);
        dt_cavity_clear(&hole);
    }
    edited_clear(&e);
}

TEST(edits_out_of_memory_leave_the_mesh_as_it_was)
{
    static struct edited e;
    for (unsigned round = 0; round < 200; round++) {
        edited_init(&e);
        for (unsigned i = 0; i < 60; i++) {
            struct dt_point q = {test_below(9), test_below(9)};
            test_fail_alloc(1 + (long)test_below(2));
            insert(&e, q);
            test_fail_alloc(0);
            mesh_check(&e.mesh, e.xy);
        }
        edited_clear(&e);
    }
}

TEST(removing_a_large_star_out_of_memory_leaves_the_mesh_as_it_was)
{
    static struct edited e;
    static struct dt_point p[100];
    family_points(family_find("wheel"), p, 100, 1);
    edited_init(&e);
    uint32_t hub = 0;
    for (unsigned i = 0; i < 100; i++)
        CHECK(insert(&e, p[i]) == DT_OK);
    for (uint32_t v = 0; v < MAX; v++)
        if (e.in[v] && dt_compare_xy(e.xy[v], (struct dt_point){0, 0}) == 0)
            hub = v;
    for (long nth = 1;; nth++) {
        test_fail_alloc(nth);
        enum dt_status status = delete (&e, hub);
        test_fail_alloc(0);
        mesh_check(&e.mesh, e.xy);
        if (status == DT_OK)
            break;
    }
    edited_clear(&e);
}
