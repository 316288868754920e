/* coarse_test.c - what floats say about sectors and distances is what doubles and exact signs say, or in doubt. */
#include "core/exact/predicates.h"
#include "core/thinning/coarse.h"
#include "tests/test.h"

#include <math.h>
#include <string.h>

enum { EDGES = 9, POINTS = 61, ALL = 1 + EDGES + POINTS };

/* A star around point 0, whose edges lead to the next ones, and points in it. */
struct star {
    struct dt_point p[ALL];
    double z[ALL];
    struct dt_plane plane[EDGES];
    uint32_t sample[ALL]; /* number among the samples */
    struct dt_samples s;
};

static double between(double lo, double hi)
{
    return lo + (hi - lo) * (double)(test_random() >> 11) * 0x1p-53;
}

static void make_star(struct star *t, double size, struct dt_point at, double high)
{
    const double turn = 6.283185307179586 / EDGES;
    t->p[0] = at;
    for (uint32_t i = 1; i < ALL; i++) {
        const double far = size * (i <= EDGES ? between(0.4, 1) : between(0, 0.25));
        const double angle = i <= EDGES ? turn * (i + between(0, 0.8)) : between(0, 7);
        t->p[i] = (struct dt_point){at.x + far * cos(angle), at.y + far * sin(angle)};
    }
    for (uint32_t i = 0; i < ALL; i++)
        t->z[i] = high + between(-1, 1);
}

/* Once for the samples that they are, beside four that are far away. */
static void begin(struct star *t, double world)
{
    struct dt_point p[ALL + 4];
    double z[ALL + 4];
    struct dt_stop stop = dt_stop_of(NULL);
    const struct dt_thinning in = {.point = p, .value = z, .n = ALL + 4};
    memcpy(p, t->p, sizeof t->p);
    memcpy(z, t->z, sizeof t->z);
    for (int k = 0; k < 4; k++) {
        p[ALL + k] = (struct dt_point){k % 2 == 0 ? world : -world, k / 2 == 0 ? world : -world};
        z[ALL + k] = k;
    }
    CHECK(dt_samples_init(&t->s, &in, &stop) == DT_OK);
    for (uint32_t i = 0; i < ALL + 4; i++)
        if (t->s.v[i].index < ALL)
            t->sample[t->s.v[i].index] = i;
    for (uint32_t e = 0; e < EDGES; e++) {
        const uint32_t from = 1 + e, to = 1 + (e + 1) % EDGES;
        struct dt_corner c[] = {{t->p[0], t->z[0]}, {t->p[from], t->z[from]}, {t->p[to], t->z[to]}};
        t->plane[e] = dt_plane_of(&(struct dt_corners){c[0], c[1], c[2], false}, t->s.largest);
    }
}

/* Returns how many points were in doubt. */
static unsigned check(const struct star *t)
{
    struct dt_coarse c;
    struct dt_rounded point[POINTS + 3] = {{0}};
    _Alignas(16) uint32_t sector[POINTS + 3];
    _Alignas(16) float off[POINTS + 3];
    uint32_t half = EDGES;
    unsigned doubts = 0;
    dt_coarse_begin(&c, &t->s, t->sample[0]);
    for (uint32_t e = 0; e < EDGES; e++)
        dt_coarse_add(&c, &t->s,
                      (struct dt_point){t->p[1 + e].x - t->p[0].x, t->p[1 + e].y - t->p[0].y},
                      &t->plane[e]);
    for (uint32_t e = 1; e < half; e++)
        half = dt_orient2d(t->p[1], t->p[1 + e], t->p[0]) <= 0 ? e : half;
    dt_coarse_end(&c, half);
    for (uint32_t i = 1 + EDGES; i < ALL; i++)
        point[i - 1 - EDGES] = t->s.rounded[t->sample[i]];
    dt_coarse_find(&c, point, POINTS, sector, off);
    dt_coarse_tally(&c, POINTS, sector, off);
    float most[EDGES] = {0};
    uint32_t count[EDGES] = {0};
    for (uint32_t k = 0; k < POINTS; k++) {
        const struct dt_sample *q = &t->s.v[t->sample[1 + EDGES + k]];
        const uint32_t e = sector[k];
        doubts += e == DT_NONE;
        if (e == DT_NONE)
            continue;
        count[e]++;
        most[e] = fmaxf(most[e], off[k]);
        CHECK(e < EDGES && dt_orient2d(t->p[0], t->p[1 + e], q->at) > 0);
        CHECK(dt_orient2d(t->p[0], t->p[1 + (e + 1) % EDGES], q->at) < 0);
        const double far = dt_plane_off(&t->plane[e], q) * t->s.per_value;
        const double about = (double)off[k], error = (double)c.error[e];
        CHECK_MSG(!(fabs(far - about) > error), "%g, about %g, error %g", far, about, error);
    }
    for (uint32_t e = 0; e < EDGES; e++)
        CHECK(c.count[e] == count[e] && c.most[e] == most[e]);
    return doubts;
}

TEST(floats_find_the_sectors_and_distances_of_stars_of_every_size)
{
    enum { ROUNDS = 300 };
    for (int tiny = 0; tiny <= 60; tiny++) {
        unsigned doubts = 0;
        for (int i = 0; i < ROUNDS; i++) {
            struct star t;
            const double world = ldexp(1, (int)test_below(300) - 120),
                         size = ldexp(world, -tiny / 2);
            make_star(&t, size,
                      (struct dt_point){between(-world, world) / 2, between(-world, world) / 2},
                      i % 3 == 0 ? 1e9 : 0);
            begin(&t, world);
            doubts += check(&t);
            dt_samples_clear(&t.s);
        }
        CHECK_MSG(tiny > 20 || doubts < ROUNDS * POINTS / 20, "2^-%d: %u in doubt", tiny / 2,
                  doubts);
    }
}

/* Every point is in doubt on the line of an edge, opposite ones too. */
TEST(floats_leave_points_on_the_lines_of_edges_in_doubt)
{
    struct star t;
    make_star(&t, 1, (struct dt_point){0, 0}, 0);
    for (uint32_t i = 1 + EDGES; i < ALL; i++) {
        const struct dt_point to = t.p[1 + i % EDGES];
        const double part = ldexp(i % 2 == 0 ? 1 : -1, -(int)(i % 20) - 2);
        t.p[i] = (struct dt_point){part * to.x, part * to.y};
    }
    for (uint32_t i = 1 + EDGES; i < ALL; i++) /* different places */
        t.z[i] = i;
    begin(&t, 2);
    CHECK(check(&t) == POINTS);
    dt_samples_clear(&t.s);
}
