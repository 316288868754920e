/* places_test.c - the hash of places: how many vertices a look passes, on coordinates with structure. */
#include "core/points/places.h"

#include <math.h>
#include <stdlib.h>

#include "tests/test.h"

enum { N = 16384, WIDE = 128 };

/* Pairs of structured numbers: i below N. */
static struct dt_point on_axis(uint32_t i, double unit)
{
    return (struct dt_point){3, i * unit};
}

static struct dt_point on_lattice(uint32_t i, double x, double y)
{
    return (struct dt_point){i % WIDE * x, i / WIDE * y};
}

static struct dt_point place(unsigned structure, uint32_t i)
{
    const double last = 0x1p-52;
    switch (structure) {
    case 0:
        return on_axis(i, 1);
    case 1:
        return on_axis(i, 0x1p40);
    case 2:
        return on_axis(i, 0x1p-90);
    case 3:
        return (struct dt_point){i, 0};
    case 4:
        return (struct dt_point){i * 0x1p-30, -5};
    case 5:
        return (struct dt_point){i, i};
    case 6:
        return (struct dt_point){i, -(double)i};
    case 7:
        return on_lattice(i, 1, 1);
    case 8:
        return on_lattice(i, 0x1p100, 0x1p-100);
    case 9:
        return on_lattice(i, 0.1, 1e-3);
    case 10:
        return (struct dt_point){1 + i % WIDE * last, 1 + i / WIDE * last}; /* the last bits */
    case 11:
        return (struct dt_point){ldexp(1, (int)(i % WIDE)), ldexp(-1, (int)(i / WIDE))};
    case 12:
        return (struct dt_point){i % 2 ? 1 : -1, i / 2 * 0x1p-20};
    default:
        return (struct dt_point){cos(i), sin(i)};
    }
}

enum { STRUCTURES = 14 };

static uint32_t chain(const struct dt_places *p, uint32_t bucket)
{
    uint32_t n = 0;
    for (uint32_t v = p->bucket[bucket]; v != DT_NONE; v = p->next[v])
        n++;
    return n;
}

TEST(looking_up_a_place_passes_few_others_for_any_structure)
{
    struct dt_point *xy = malloc(N * sizeof *xy);
    uint32_t *id = malloc(N * sizeof *id);
    for (unsigned s = 0; s < STRUCTURES; s++) {
        for (unsigned tolerant = 0; tolerant < 2; tolerant++) {
            struct dt_places p = {0};
            uint64_t passed = 0;
            uint32_t longest = 0;
            for (uint32_t i = 0; i < N; i++) {
                xy[i] = place(s, i);
                id[i] = i;
            }
            CHECK(dt_places_reserve(&p, tolerant ? 0x1p-100 : 0, xy, id, N, N, NULL) == DT_OK);
            for (uint32_t b = 0; b <= p.mask; b++) {
                uint32_t n = chain(&p, b);
                passed += (uint64_t)n * (n + 1) / 2;
                longest = n > longest ? n : longest;
            }
            if (!tolerant || s < 10) /* elsewhere points share cells */
                CHECK_MSG(passed < 3 * N && longest < 16,
                          "structure %u: %.1f vertices a look, at most %u", s, (double)passed / N,
                          longest);
            for (uint32_t i = 0; i < N; i++)
                CHECK(dt_places_find(&p, xy, id, xy[i], DT_NONE) == i || tolerant);
            dt_places_clear(&p);
        }
    }
    free(xy);
    free(id);
}

TEST(table_of_places_has_room_for_every_vertex_that_it_was_asked_for)
{
    enum { VERTICES = 500 };
    struct dt_point xy[VERTICES];
    uint32_t id[VERTICES];
    struct dt_places p = {0};
    test_guard_alloc(true);
    for (uint32_t v = 0; v < VERTICES; v++) {
        xy[v] = place(13, v);
        id[v] = v;
        CHECK(dt_places_reserve(&p, 0, xy, id, v, v + 1, NULL) == DT_OK);
        dt_places_enter(&p, xy, v);
        CHECK(dt_places_find(&p, xy, id, xy[v], DT_NONE) == v);
    }
    dt_places_clear(&p);
}
