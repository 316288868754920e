/* touched_test.c - the keys that edits have touched: ids that are not named still have the same ring. */
#include "core/delaunay.h"
#include "tests/test.h"

#include <stdlib.h>
#include <string.h>

enum { MOST = 400 };

/* The rings as they were when changes were taken last. */
struct known {
    struct dt *t;
    struct dt_ids ring[MOST];
    uint32_t ids;
    unsigned all; /* how often everything may have changed */
};

static void read_ring(const struct dt *t, uint32_t id, struct dt_ids *ring)
{
    uint32_t representative;
    bool boundary;
    ring->n = 0;
    if (dt_ring(t, id, false, ring, &representative, &boundary) == DT_OK && representative != id)
        ring->n = 0;
}

/* n points on a line. */
static struct known known_of(uint32_t n)
{
    struct known k = {.t = dt_new(0)};
    struct dt_added added;
    struct dt_point p[MOST];
    for (uint32_t i = 0; i < n; i++)
        p[i] = (struct dt_point){i * 2, 0};
    CHECK(dt_add(k.t, p, n, &added) == DT_OK && dt_triangulate(k.t, NULL) == DT_OK);
    dt_touched_begin(k.t, false);
    k.ids = n;
    for (uint32_t id = 0; id < n; id++)
        read_ring(k.t, id, &k.ring[id]);
    return k;
}

/* Reads the named keys again, and compares all. */
static void take(struct known *k)
{
    const uint64_t *key;
    size_t n;
    if (!dt_touched_take(k->t, &key, &n)) {
        k->all++;
        k->ids = 0;
    }
    for (size_t i = 0; i < n; i++)
        read_ring(k->t, (uint32_t)(key[i] >> 32), &k->ring[key[i] >> 32]);
    for (; k->ids < dt_next_id(k->t); k->ids++)
        read_ring(k->t, k->ids, &k->ring[k->ids]);
    struct dt_ids now = {.n = 0};
    for (uint32_t id = 0; id < k->ids; id++) {
        read_ring(k->t, id, &now);
        CHECK(now.n == k->ring[id].n);
        CHECK(now.n == 0 || memcmp(now.v, k->ring[id].v, now.n * sizeof *now.v) == 0);
    }
    free(now.v);
}

static void end(struct known *k)
{
    for (uint32_t id = 0; id < MOST; id++)
        free(k->ring[id].v);
    dt_free(k->t);
}

static void add(struct known *k, double x, double y)
{
    struct dt_added added;
    CHECK(dt_add(k->t, &(struct dt_point){x, y}, 1, &added) == DT_OK);
}

static void delete_id(struct known *k, uint32_t id)
{
    uint32_t deleted, missing;
    CHECK(dt_delete(k->t, &id, 1, &deleted, &missing) == DT_OK);
}

TEST(edits_on_a_line_touch_the_points_beside_them)
{
    struct known k = known_of(20);
    add(&k, 7, 0);
    take(&k);
    add(&k, 100, 0);
    take(&k);
    delete_id(&k, 9);
    take(&k);
    CHECK(dt_move(k.t, 5, (struct dt_point){11, 0}) == DT_OK);
    take(&k);
    CHECK(dt_move(k.t, 20, (struct dt_point){200, 0}) == DT_OK);
    take(&k);
    CHECK(k.all == 0);
    end(&k);
}

TEST(everything_changes_on_a_line_that_begins_at_its_other_end)
{
    struct known k = known_of(20);
    CHECK(dt_move(k.t, 0, (struct dt_point){100, 0}) == DT_OK);
    take(&k);
    CHECK(k.all == 1);
    add(&k, -5, 0);
    take(&k);
    CHECK(k.all == 1);
    end(&k);
}

TEST(everything_changes_when_points_leave_a_line_or_come_to_it)
{
    struct known k = known_of(20);
    add(&k, 5, 5);
    take(&k);
    CHECK(k.all == 1);
    add(&k, 6, 5);
    take(&k);
    CHECK(k.all == 1);
    delete_id(&k, 20);
    take(&k);
    CHECK(k.all == 1);
    delete_id(&k, 21);
    take(&k);
    CHECK(k.all == 2);
    add(&k, 5, 5);
    delete_id(&k, 22);
    take(&k);
    CHECK(k.all == 3);
    end(&k);
}

TEST(random_edits_on_a_line_and_beside_it_name_every_ring_that_changes)
{
    for (unsigned round = 0; round < 40; round++) {
        struct known k = known_of(2 + test_below(12));
        while (dt_next_id(k.t) < 60) {
            uint32_t id = test_below(dt_next_id(k.t)), deleted, missing;
            struct dt_point to = {(double)test_below(30), test_below(12) == 0 ? 1 : 0};
            switch (test_below(3)) {
            case 0:
                add(&k, to.x, to.y);
                break;
            case 1:
                dt_delete(k.t, &id, 1, &deleted, &missing);
                break;
            default:
                dt_move(k.t, id, to);
            }
            CHECK(dt_refresh(k.t, NULL) == DT_OK);
            if (test_below(3) > 0)
                take(&k);
        }
        take(&k);
        end(&k);
    }
}
