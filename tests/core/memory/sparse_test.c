/* sparse_test.c - the ordered map of a few ids among many, beside a plain array. */
#include <string.h>

#include "core/memory/sparse.h"
#include "tests/test.h"

enum { IDS = 5 * (int)DT_SPARSE_PAGE, GONE = 0 };

struct twin {
    struct dt_sparse m;
    uint32_t value[IDS]; /* GONE: not in the map */
    uint32_t n;
};

static void put(struct twin *w, uint32_t id, uint32_t value)
{
    CHECK(dt_sparse_set(&w->m, id, value) == DT_OK);
    w->n += w->value[id] == GONE;
    w->value[id] = value;
}

static void take(struct twin *w, uint32_t id)
{
    if (w->value[id] == GONE)
        return;
    dt_sparse_unset(&w->m, id);
    w->value[id] = GONE;
    w->n--;
}

static void check(const struct twin *w)
{
    uint32_t next = DT_NONE, value;
    CHECK(w->m.n == w->n);
    for (uint32_t id = IDS; id-- > 0;) {
        bool there = w->value[id] != GONE;
        CHECK(dt_sparse_get(&w->m, id, &value) == there);
        CHECK(!there || value == w->value[id]);
        next = there ? id : next;
        CHECK(dt_sparse_next(&w->m, id) == next);
    }
    CHECK(!dt_sparse_get(&w->m, DT_NONE, &value) && dt_sparse_next(&w->m, DT_NONE) == DT_NONE);
}

TEST(sparse_map_lists_the_present_entries_in_order)
{
    static struct twin w;
    for (unsigned round = 0; round < 12; round++) {
        uint32_t range = round % 3 == 0 ? IDS : 1 + test_below(IDS);
        for (uint32_t i = 0; i < 4000; i++) {
            if (test_below(12) > round)
                put(&w, test_below(range), 1 + test_below(1000000));
            else
                take(&w, test_below(range));
        }
        check(&w);
    }
    for (uint32_t id = 0; id < IDS; id++)
        take(&w, id);
    check(&w);
    CHECK(w.m.memory == 0);
    for (uint32_t id = 0; id < IDS; id++)
        put(&w, id, id + 1);
    check(&w);
    CHECK(dt_sparse_drop(&w.m, 2) == 2);
    for (uint32_t id = IDS - 2 * DT_SPARSE_PAGE; id < IDS; id++)
        w.value[id] = GONE;
    w.n -= 2 * DT_SPARSE_PAGE;
    check(&w);
    put(&w, IDS - 1, 7);
    check(&w);
    CHECK(dt_sparse_drop(&w.m, 9) == 4 && w.m.n == 0 && w.m.memory == 0);
    dt_sparse_clear(&w.m);
    CHECK(dt_sparse_memory(&w.m) == 0);
}

TEST(sparse_map_counts_about_so_many_ids_ahead)
{
    struct dt_sparse m = {0};
    CHECK(dt_sparse_after(&m, 0, 1) == DT_NONE);
    for (uint32_t id = 0; id < IDS; id += 4)
        CHECK(dt_sparse_set(&m, id, id) == DT_OK);
    CHECK(dt_sparse_after(&m, 0, IDS) == DT_NONE);
    for (uint32_t from = 0; from + 4 * 2000 < IDS; from += 1 + test_below(500)) {
        uint32_t to = dt_sparse_after(&m, from, 1000);
        CHECK(to > from + 4 * 990 && to < from + 4 * 1010);
    }
    dt_sparse_clear(&m);
}

TEST(sparse_map_is_as_before_when_memory_runs_out)
{
    struct dt_sparse m = {0};
    uint32_t value, n = 0;
    bool failed = false;
    for (long k = 1; n < 40; k = failed ? k + 1 : 1) {
        uint32_t id = n * (DT_SPARSE_PAGE / 4 + 1);
        test_fail_alloc(k);
        enum dt_status status = dt_sparse_set(&m, id, n);
        failed = test_alloc_failed();
        test_fail_alloc(0);
        CHECK((status == DT_OK) == dt_sparse_get(&m, id, &value) && (failed || status == DT_OK));
        n += status == DT_OK;
        CHECK(m.n == n);
    }
    for (uint32_t i = 0; i < n; i++)
        CHECK(dt_sparse_get(&m, i * (DT_SPARSE_PAGE / 4 + 1), &value) && value == i);
    dt_sparse_clear(&m);
}
