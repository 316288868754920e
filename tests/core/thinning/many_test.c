/* many_test.c - many points that are thinned out: the surface beside all of them, memory, and flags. */
#include "core/delaunay_thinning.h"
#include "tests/core/polls.h"
#include "tests/core/thinning/exactly.h"
#include "tests/oracle/families.h"
#include "tests/test.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- many points ---- */

/* A surface with waves of several lengths, on a lattice or at random places. */
static struct dt_thinning *waves(uint32_t n, bool lattice)
{
    struct dt_thinning *t = calloc(1, sizeof *t);
    struct dt_point *p = malloc(n * sizeof *p);
    double *z = malloc(n * sizeof *z);
    uint32_t side = (uint32_t)sqrt(n);
    CHECK(t != NULL && p != NULL && z != NULL);
    for (uint32_t i = 0; i < n; i++) {
        double x = lattice ? i % side : (double)(test_random() % (1u << 30)) / (1 << 20);
        double y = lattice ? i / side : (double)(test_random() % (1u << 30)) / (1 << 20);
        p[i] = (struct dt_point){x, y};
        z[i] = 100 * sin(x / 50) * cos(y / 70) + 5 * sin(x / 7) + (double)(test_random() % 8) / 8;
    }
    *t = (struct dt_thinning){p, z, n, NULL, 0, 1, UINT32_MAX, NULL, NULL, NULL};
    return t;
}

static void free_values(struct dt_thinning *t)
{
    void *p, *z;
    memcpy(&p, &t->point, sizeof p);
    memcpy(&z, &t->value, sizeof z);
    free(p);
    free(z);
}

static void free_waves(struct dt_thinning *t)
{
    free_values(t);
    free(t);
}

/* Every point beside the surface of those that are kept, with a set of its own. */
static void check_surface(const struct dt_thinning *in, const struct dt_thinned *out)
{
    struct dt *t = dt_new(0);
    struct dt_added added;
    struct dt_point *p = malloc(out->n * sizeof *p);
    double worst = 0;
    CHECK(t != NULL && p != NULL);
    for (uint32_t i = 0; i < out->n; i++)
        p[i] = in->point[out->kept[i]];
    CHECK(dt_add(t, p, out->n, &added) == DT_OK && dt_triangulate(t, NULL) == DT_OK);
    for (uint32_t i = 0; i < in->n; i++) {
        struct dt_location at;
        struct corner k[3];
        CHECK(dt_locate(t, in->point[i], &at) == DT_OK && at.where != DT_OUTSIDE);
        int n = at.where == DT_ON_VERTEX ? 1 : at.where == DT_ON_EDGE ? 2 : 3;
        for (int c = 0; c < n; c++)
            k[c] = (struct corner){p[at.id[c]], in->value[out->kept[at.id[c]]]};
        CHECK(n > 1 || k[0].z == in->value[i]);
        CHECK(n == 1 || exact_side(k, n, in->point[i], in->value[i], in->error) <= 0);
        if (n == 3)
            worst = fmax(worst, rounded_off(k, n, in->point[i], in->value[i]));
    }
    CHECK(worst <= out->error + 1e-9);
    dt_free(t);
    free(p);
}

TEST_TIMEOUT(no_point_of_many_is_off_by_more_than_the_error, 60)
{
    for (int lattice = 0; lattice < 2; lattice++) {
        struct dt_thinning *in = waves(20000, lattice == 1);
        struct dt_thinned out;
        for (in->error = 0.25; in->error < 100; in->error *= 8) {
            CHECK(dt_thin(in, NULL, &out) == DT_OK && out.n < in->n && out.error <= in->error);
            check_surface(in, &out);
            dt_pages_release(out.kept);
        }
        free_waves(in);
    }
}

/* A plane with places that have no value: these are in no list, although the points around them are decided exactly. */
TEST(places_without_a_value_are_left_out_of_blocks)
{
    struct dt_thinning *in = waves(128 * 128, true);
    struct dt_thinned out;
    double *z;
    memcpy(&z, &in->value, sizeof z);
    for (uint32_t i = 0; i < in->n; i++)
        z[i] = i % 37 == 5 ? (double)NAN : in->point[i].x + 2 * in->point[i].y;
    in->error = 0;
    CHECK(dt_thin(in, NULL, &out) == DT_OK && out.n == 4 && out.error == 0);
    dt_pages_release(out.kept);
    free_waves(in);
}

/* ---- points on a line ---- */

/* Points on a line, or on one that is parallel to an axis. */
static struct dt_thinning *profile(uint32_t n, double dx, double dy)
{
    struct dt_thinning *t = waves(n, true);
    struct dt_point *p = malloc(n * sizeof *p);
    double *z = malloc(n * sizeof *z);
    CHECK(p != NULL && z != NULL);
    for (uint32_t i = 0; i < n; i++) {
        p[i] = (struct dt_point){dx * i, dy * i};
        z[i] = 100 * sin(i / 500.0) + 10 * sin(i / 70.0);
    }
    free_values(t);
    t->point = p;
    t->value = z;
    return t;
}

/* Counted by polls: one for each 4,096 points. */
TEST(a_line_is_thinned_out_by_blocks)
{
    static const struct dt_point way[] = {{1, 0}, {0, 1}, {2, -3}};
    for (int i = 0; i < 3; i++) {
        struct dt_thinning *in = profile(100000, way[i].x, way[i].y);
        struct dt_thinned out;
        polls_begin();
        CHECK(dt_thin(in, NULL, &out) == DT_OK && out.n > 1000 && out.n < in->n / 10);
        polls_end();
        CHECK_MSG(polls_count() < 1000, "%u polls", (unsigned)polls_count());
        check_surface(in, &out);
        dt_pages_release(out.kept);
        free_waves(in);
    }
}

/* ---- where only exact arithmetic decides ---- */

/* Points within one unit in the last place of a line. Their values have magnitudes from 1e-200 to 1e303: the surface cuts off one point
 * after the other beside the largest ones. With `steps` they are 0 and 1e303, and many points are off by the same. */
static struct dt_thinning *flat_peaks(uint32_t n, bool steps)
{
    struct dt_thinning *t = waves(n, false);
    struct dt_point *p = malloc(n * sizeof *p);
    double *z = malloc(n * sizeof *z);
    CHECK(p != NULL && z != NULL);
    family_points(family_find("near_collinear"), p, n, 1);
    for (uint32_t i = 0; i < n; i++)
        z[i] = steps ? 1e303 * (double)(test_random() % 2)
                     : ldexp(0.5 + (double)(test_random() % 1000) / 2000,
                             (int)(test_random() % 1670) - 664);
    free_values(t);
    t->point = p;
    t->value = z;
    return t;
}

/* Rounded areas of some triangles are negative. The same values in each run: few of them show that. */
TEST(triangles_that_rounding_turns_over_are_measured_exactly)
{
    struct dt_thinning *in = waves(2000, false);
    struct dt_point *p = malloc(in->n * sizeof *p);
    double *z = malloc(in->n * sizeof *z);
    struct dt_thinned out;
    CHECK(p != NULL && z != NULL);
    family_points(family_find("lattice_rotated"), p, in->n, 7);
    free_values(in);
    in->point = p;
    in->value = z;
    for (int k = 0; k < 48; k++) {
        for (uint32_t i = 0; i < in->n; i++)
            z[i] =
                (((i + 1) * 2654435761u ^ (uint32_t)k * 40503u) * 2246822519u >> 8) % 1000 / 100.0;
        in->error = 0;
        in->most = 100 + 25 * (uint32_t)k;
        CHECK(dt_thin(in, NULL, &out) == DT_OK && out.n == in->most);
        in->error = out.error + 0x1p-11; /* rounded in thin triangles */
        check_surface(in, &out);
        dt_pages_release(out.kept);
    }
    free_waves(in);
}

TEST_TIMEOUT(peaks_on_a_flat_line_are_thinned_out_in_seconds, 120)
{
    for (int steps = 0; steps < 2; steps++) {
        struct dt_thinning *in = flat_peaks(steps ? 2000 : 7000, steps);
        struct dt_thinned out;
        for (int exact = 0; exact < 2; exact++) {
            in->error = exact ? 0 : 1e200;
            CHECK(dt_thin(in, NULL, &out) == DT_OK && out.n > 1000 && out.error <= in->error);
            check_surface(in, &out);
            dt_pages_release(out.kept);
        }
        free_waves(in);
    }
}

TEST(an_exact_choice_polls_its_flag)
{
    struct dt_thinning *in = flat_peaks(2000, true);
    struct dt_thinned out;
    dt_atomic_bool cancel;
    struct dt_options opt = {.cancel = &cancel};
    atomic_init(&cancel, false);
    in->error = 0;
    polls_begin();
    CHECK(dt_thin(in, &opt, &out) == DT_OK);
    polls_end();
    dt_pages_release(out.kept);
    uint64_t polls = polls_count();
    CHECK_MSG(polls > in->n, "%u polls", (unsigned)polls);
    for (uint64_t n = 1; n <= polls; n += polls / 9 + 1) {
        polls_cancel_at(n);
        CHECK(dt_thin(in, &opt, &out) == DT_CANCELLED && out.kept == NULL);
    }
    polls_cancel_at(0);
    free_waves(in);
}

/* ---- how it ends early ---- */

static size_t reserved, allowed;

static enum dt_status reserve(void *ctx, size_t bytes)
{
    (void)ctx;
    reserved = bytes > reserved ? bytes : reserved;
    return bytes > allowed ? DT_NOMEM : DT_OK;
}

TEST(thinning_reserves_what_it_takes_and_can_be_refused)
{
    struct dt_thinning *in = waves(20000, false);
    struct dt_thinned out;
    in->reserve = reserve;
    in->error = 0.25;
    allowed = SIZE_MAX;
    CHECK(dt_thin(in, NULL, &out) == DT_OK && out.n > 2000);
    CHECK(reserved > in->n * sizeof(struct dt_point) && reserved < in->n * 1000);
    dt_pages_release(out.kept);
    for (allowed = 0; allowed < reserved; allowed += reserved / 7 + 1)
        CHECK(dt_thin(in, NULL, &out) == DT_NOMEM && out.kept == NULL);
    free_waves(in);
}

TEST(thinning_polls_its_flag)
{
    struct dt_thinning *in = waves(100000, true);
    struct dt_thinned out;
    dt_atomic_bool cancel;
    struct dt_options opt = {.cancel = &cancel};
    atomic_init(&cancel, false);
    polls_begin();
    CHECK(dt_thin(in, &opt, &out) == DT_OK);
    polls_end();
    dt_pages_release(out.kept);
    uint64_t polls = polls_count();
    for (uint64_t n = 1; n <= polls; n += polls / 5 + 1) {
        polls_cancel_at(n);
        CHECK(dt_thin(in, &opt, &out) == DT_CANCELLED && out.kept == NULL);
    }
    polls_cancel_at(0);
    atomic_store(&cancel, true);
    CHECK(dt_thin(in, &opt, &out) == DT_CANCELLED);
    free_waves(in);
}
