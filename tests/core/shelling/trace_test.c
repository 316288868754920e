/* trace_test.c - the steps that dt_trace reports obey the paper's rules and yield the
 * triangulation.
 */
#include "core/delaunay.h"

#include <math.h>
#include <string.h>

#include "tests/oracle/families.h"
#include "tests/test.h"

enum { MOST = 2000, CIRCLES = 200 };

/* The state that an observer derives from the steps. */
struct replay {
    const struct dt *t;
    uint32_t next[MOST]; /* along the front, DT_NONE beside it */
    bool used[MOST];     /* a corner of some triangle */
    uint32_t a, b;       /* the edge whose apex was last looked for */
    struct circle {
        struct dt_point p;
        double size;
    } circle[CIRCLES]; /* in which it was */
    uint32_t circles;
    uint32_t leaves; /* the point that must leave the grid next; DT_NONE */
    uint32_t corner[6 * MOST], corners;
    uint32_t grids, removed, borders, caves, hull_first, hull_last, hull;
};

static void add_triangle(struct replay *r, const struct dt_event *e)
{
    uint32_t v[3] = {e->a, e->b, e->c};
    unsigned first = v[0] < v[1] && v[0] < v[2] ? 0 : v[1] < v[2] ? 1 : 2;
    for (unsigned k = 0; k < 3; k++) {
        r->corner[r->corners++] = v[(first + k) % 3];
        r->used[v[k]] = true;
    }
}

/* The apex lies in one of the circles that its search has scanned. */
static void check_found(const struct replay *r, const struct dt_event *e)
{
    struct dt_point c;
    bool found = false;
    CHECK(dt_get(r->t, e->c, &c) == DT_OK);
    for (uint32_t i = 0; i < r->circles; i++) {
        struct circle at = r->circle[i];
        double rounding = 0x1p-50 * (fabs(c.x) + fabs(c.y)) + 1e-9 * at.size;
        found |= at.size == HUGE_VAL || hypot(c.x - at.p.x, c.y - at.p.y) <= at.size + rounding;
    }
    CHECK(found);
}

static void see_search(struct replay *r, const struct dt_event *e)
{
    if (e->a != r->a || e->b != r->b)
        r->circles = 0;
    r->a = e->a;
    r->b = e->b;
    CHECK(r->circles < CIRCLES);
    r->circle[r->circles++] = (struct circle){e->p, e->size};
}

static void see_touch(struct replay *r, const struct dt_event *e)
{
    CHECK(r->next[e->a] == e->b);
    if (e->kind == DT_EVENT_POINT) {
        CHECK(!r->used[e->c] && e->a == r->a && e->b == r->b);
        check_found(r, e);
        r->next[e->a] = e->c;
        r->next[e->c] = e->b;
    } else if (e->kind == DT_EVENT_RIGHT) {
        CHECK(r->next[e->b] == e->c);
        r->next[e->a] = e->c;
        r->next[e->b] = DT_NONE;
        r->leaves = e->b;
    } else {
        CHECK(r->next[e->c] == e->a);
        r->next[e->c] = e->b;
        r->next[e->a] = DT_NONE;
        r->leaves = e->a;
    }
    add_triangle(r, e);
}

/* On a line, from its lower left end on. */
static void check_line(const struct replay *r, const struct dt_event *e)
{
    struct dt_point before, here;
    CHECK(dt_get(r->t, r->hull_last, &before) == DT_OK && dt_get(r->t, e->a, &here) == DT_OK);
    CHECK(before.x < here.x || (before.x == here.x && before.y < here.y));
}

static void see_hull(struct replay *r, const struct dt_event *e)
{
    if (r->hull > 0 && r->corners == 0)
        check_line(r, e);
    CHECK(r->hull == 0 || r->corners == 0 || r->next[r->hull_last] == e->a);
    r->hull_first = r->hull == 0 ? e->a : r->hull_first;
    r->hull_last = e->a;
    r->hull++;
}

static void see(void *ctx, const struct dt_event *e)
{
    struct replay *r = ctx;
    CHECK((e->kind == DT_EVENT_REMOVE) == (r->leaves != DT_NONE));
    switch (e->kind) {
    case DT_EVENT_GRID:
        CHECK(e->size > 0 && e->a > 0 && e->b > 0);
        r->grids++;
        break;
    case DT_EVENT_START:
        CHECK(e->a != e->b && r->corners == 0);
        break;
    case DT_EVENT_SEARCH:
        see_search(r, e);
        break;
    case DT_EVENT_FIRST:
        check_found(r, e);
        r->next[e->a] = e->c;
        r->next[e->c] = e->b;
        r->next[e->b] = e->a;
        add_triangle(r, e);
        break;
    case DT_EVENT_POINT:
    case DT_EVENT_RIGHT:
    case DT_EVENT_LEFT:
        see_touch(r, e);
        break;
    case DT_EVENT_CAVE:
        CHECK(r->next[e->a] == e->b && r->next[e->c] != DT_NONE);
        CHECK(r->next[e->b] != e->c && r->next[e->c] != e->a);
        r->caves++;
        break;
    case DT_EVENT_BORDER:
        CHECK(r->next[e->a] == e->b && e->c == DT_NONE);
        r->borders++;
        break;
    case DT_EVENT_REMOVE:
        CHECK(e->a == r->leaves);
        r->leaves = DT_NONE;
        r->removed++;
        break;
    case DT_EVENT_HULL:
        see_hull(r, e);
        break;
    }
}

static int compare_rows(const void *a, const void *b)
{
    const uint32_t *x = a, *y = b;
    for (int k = 0; k < 3; k++)
        if (x[k] != y[k])
            return x[k] < y[k] ? -1 : 1;
    return 0;
}

static struct replay *watch(const struct dt *t)
{
    struct dt_summary sum;
    struct replay *r = calloc(1, sizeof *r);
    CHECK(r != NULL);
    r->t = t;
    r->leaves = r->a = r->b = DT_NONE;
    memset(r->next, 0xff, sizeof r->next);
    CHECK(dt_trace(t, NULL, &(struct dt_observer){see, r}) == DT_OK);
    dt_summary(t, &sum);
    uint32_t vertices = sum.points - sum.coincident;
    CHECK(r->leaves == DT_NONE && r->grids >= (vertices >= 2) && r->removed + r->hull == vertices);
    CHECK(r->corners == 0 || (r->next[r->hull_last] == r->hull_first && r->borders == r->hull));
    return r;
}

/* The triangles that the steps made are those of the table. */
static void check_triangles(struct dt *t, struct replay *r)
{
    static uint32_t want[6 * MOST];
    struct dt_cursor c;
    size_t rows, words;
    CHECK(dt_triangulate(t, NULL) == DT_OK);
    CHECK(dt_table_begin(t, NULL, DT_TRIANGLES, false, &c) == DT_OK);
    CHECK(dt_table_read(t, &c, want, sizeof want / sizeof want[0], SIZE_MAX, &rows, &words) ==
          DT_OK);
    CHECK(words == r->corners && rows == r->corners / 3);
    qsort(r->corner, rows, 3 * sizeof r->corner[0], compare_rows);
    CHECK(memcmp(r->corner, want, words * sizeof want[0]) == 0);
}

static struct dt *set_of_family(const char *name, uint32_t n)
{
    static struct dt_point p[MOST];
    struct dt_added added;
    struct dt *t = dt_new(0);
    family_points(family_find(name), p, n, test_random());
    CHECK(t != NULL && dt_add(t, p, n, &added) == DT_OK);
    return t;
}

TEST(trace_reports_the_steps_of_every_family)
{
    uint32_t caves = 0;
    for (const struct family *f = families; f->name != NULL; f++)
        for (uint32_t n = 0; n <= 300; n += n < 6 ? 1 : 49) {
            struct dt *t = set_of_family(f->name, n);
            struct replay *r = watch(t);
            check_triangles(t, r);
            caves += r->caves;
            free(r);
            dt_free(t);
        }
    CHECK(caves > 0);
}

TEST(trace_speaks_of_ids_after_edits)
{
    uint32_t ids[50], deleted, missing;
    struct dt *t = set_of_family("uniform", 400);
    CHECK(dt_triangulate(t, NULL) == DT_OK);
    for (uint32_t i = 0; i < 50; i++)
        ids[i] = 7 * i;
    CHECK(dt_delete(t, ids, 50, &deleted, &missing) == DT_OK);
    struct replay *r = watch(t);
    CHECK(!r->used[0] && !r->used[7] && r->used[1] && r->used[399]);
    check_triangles(t, r);
    free(r);
    dt_free(t);
}

TEST(trace_of_points_on_a_line_walks_along_it)
{
    struct dt *t = set_of_family("line_diagonal", 40);
    struct replay *r = watch(t);
    CHECK(r->corners == 0 && r->hull == 40 && r->removed == 0);
    free(r);
    dt_free(t);
}

/* The FNV-1a hash of the kinds of steps and their points. */
static void hash_step(void *ctx, const struct dt_event *e)
{
    const uint32_t word[] = {e->kind, e->a, e->b, e->c};
    uint32_t *hash = ctx;
    for (unsigned i = 0; i < (e->kind == DT_EVENT_GRID ? 1 : 4); i++)
        for (unsigned shift = 0; shift < 32; shift += 8)
            *hash = (*hash ^ (word[i] >> shift & 255)) * 16777619;
}

static uint32_t hash_of_steps(const char *family, uint32_t n)
{
    static struct dt_point p[MOST];
    uint32_t hash = 2166136261;
    struct dt_added added;
    struct dt *t = dt_new(0);
    family_points(family_find(family), p, n, 1);
    CHECK(dt_add(t, p, n, &added) == DT_OK);
    CHECK(dt_trace(t, NULL, &(struct dt_observer){hash_step, &hash}) == DT_OK);
    dt_free(t);
    return hash;
}

/* Clients show them, and the documents print some. */
TEST(steps_of_the_trace_are_those_of_earlier_versions)
{
    static const struct {
        const char *family;
        uint32_t n, hash;
    } known[] = {{"uniform", 300, 0xb2c22991},
                 {"lattice_shuffled", 100, 0xcf4e5ce1},
                 {"two_lines", 60, 0xde02a701},
                 {"line_diagonal", 20, 0xa04d0286}};
    for (unsigned i = 0; i < sizeof known / sizeof *known; i++)
        CHECK_MSG(hash_of_steps(known[i].family, known[i].n) == known[i].hash, "%s",
                  known[i].family);
}

static void ignore(void *ctx, const struct dt_event *e)
{
    (void)ctx, (void)e;
}

TEST(trace_fails_cleanly_when_memory_runs_out_or_cancelled)
{
    atomic_bool cancel = true;
    struct dt_observer nobody = {ignore, NULL};
    struct dt *t = set_of_family("clusters", 500);
    CHECK(dt_trace(t, &(struct dt_options){.cancel = &cancel}, &nobody) == DT_CANCELLED);
    bool failed = true;
    for (long nth = 1; failed; nth++) {
        test_fail_alloc(nth);
        enum dt_status status = dt_trace(t, NULL, &nobody);
        failed = test_alloc_failed();
        test_fail_alloc(0);
        CHECK(status == (failed ? DT_NOMEM : DT_OK));
    }
    dt_free(t);
}
