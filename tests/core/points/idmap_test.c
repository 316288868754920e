/* idmap_test.c - the map of ids: pages and blocks of them come and go with the ids that live. */
#include <stdlib.h>
#include <string.h>

#include "core/points/idmap.h"
#include "tests/test.h"

enum { BLOCK = (int)(DT_ID_BLOCK * DT_ID_PAGE), IDS = 3 * BLOCK };

static uint32_t value_of(uint32_t id)
{
    return id * 2654435761u >> 1;
}

/* Sets or unsets first .. last - 1. */
static void put(struct dt_idmap *m, uint32_t first, uint32_t last, bool live)
{
    for (uint32_t id = first; id < last; id++) {
        if (live)
            dt_idmap_set(m, id, value_of(id));
        else
            dt_idmap_unset(m, id);
    }
}

/* Sets first .. last - 1, which are reserved and have no values, and counts them together. */
static void put_run(struct dt_idmap *m, uint32_t first, uint32_t last)
{
    for (uint32_t id = first; id < last; id++)
        *dt_idmap_at(m, id) = value_of(id);
    dt_idmap_count(m, first, last - first);
}

static void check_live(const struct dt_idmap *m, uint32_t first, uint32_t last)
{
    CHECK(first == 0 || dt_idmap_get(m, first - 1) == DT_NONE);
    CHECK(dt_idmap_get(m, last) == DT_NONE && dt_idmap_next(m, last) == DT_NONE);
    for (uint32_t id = first; id < last; id += 977)
        CHECK(dt_idmap_get(m, id) == value_of(id) && dt_idmap_next(m, id) == id);
    CHECK(dt_idmap_next(m, 0) == first && dt_idmap_get(m, last - 1) == value_of(last - 1));
}

static size_t bytes(const struct dt_idmap *m)
{
    return dt_idmap_memory(m) - m->cap * sizeof *m->page;
}

TEST(ids_that_come_at_once_live_in_blocks_that_go_when_the_last_one_dies)
{
    struct dt_idmap m = {0}, copy;
    CHECK(dt_idmap_reserve(&m, 0, 100) == DT_OK); /* so the first block's place is taken */
    put(&m, 0, 100, true);
    CHECK(dt_idmap_reserve(&m, 100, IDS - 100) == DT_OK);
    put_run(&m, 100, IDS);
    check_live(&m, 0, IDS);
    CHECK(bytes(&m) == (size_t)IDS * 4 && !m.page[0].in_block && m.page[DT_ID_BLOCK].in_block);
    put(&m, 0, 2 * BLOCK - 1, false); /* one is left in the second block */
    dt_idmap_trim(&m);
    CHECK(bytes(&m) == (size_t)2 * BLOCK * 4);
    check_live(&m, 2 * BLOCK - 1, IDS);
    CHECK(dt_idmap_copy(&m, &copy, NULL) == DT_OK && bytes(&copy) == bytes(&m));
    put(&m, 2 * BLOCK - 1, 2 * BLOCK, false);
    dt_idmap_trim(&m);
    CHECK(bytes(&m) == (size_t)BLOCK * 4);
    check_live(&m, 2 * BLOCK, IDS);
    check_live(&copy, 2 * BLOCK - 1, IDS);
    dt_idmap_clear(&m);
    CHECK(dt_idmap_memory(&m) == 0 && dt_idmap_get(&m, 5) == DT_NONE);
    put(&copy, 2 * BLOCK - 1, IDS, false);
    dt_idmap_trim(&copy);
    CHECK(bytes(&copy) == 0 && dt_idmap_next(&copy, 0) == DT_NONE);
    dt_idmap_clear(&copy);
}

TEST(a_block_that_is_reserved_for_most_of_its_ids_serves_the_rest)
{
    struct dt_idmap m = {0};
    CHECK(dt_idmap_reserve(&m, 0, BLOCK - 10000) == DT_OK);
    put_run(&m, 0, 10);
    put_run(&m, 10, BLOCK - 10000);
    CHECK(bytes(&m) == (size_t)BLOCK * 4);
    check_live(&m, 0, BLOCK - 10000);
    CHECK(dt_idmap_reserve(&m, BLOCK - 10000, 20000) == DT_OK);
    put_run(&m, BLOCK - 10000, BLOCK + 10000);
    CHECK(bytes(&m) == (size_t)(BLOCK + 10 * DT_ID_PAGE) * 4);
    check_live(&m, 0, BLOCK + 10000);
    CHECK(dt_idmap_after(&m, 0, BLOCK / 2) == BLOCK / 2);
    dt_idmap_clear(&m);
}

TEST(pages_come_and_go_with_any_edits)
{
    static uint32_t live[IDS]; /* the model */
    struct dt_idmap m = {0};
    memset(live, 0xff, sizeof live);
    for (int round = 0; round < 30; round++) {
        bool add = test_below(2) == 0;
        uint32_t n = test_below(4) == 0 ? BLOCK + test_below(BLOCK) : 1 + test_below(20000);
        uint32_t first = test_below(IDS - n);
        dt_idmap_trim(&m);
        CHECK(!add || dt_idmap_reserve(&m, first, n) == DT_OK);
        for (uint32_t id = first; id < first + n; id++) {
            if (add)
                dt_idmap_set(&m, id, live[id] = id + (uint32_t)round);
            else if (live[id] != DT_NONE)
                dt_idmap_unset(&m, id);
            live[id] = add ? live[id] : DT_NONE;
        }
        for (uint32_t id = 0; id < IDS; id += 1 + test_below(50))
            CHECK(dt_idmap_get(&m, id) == live[id]);
    }
    for (uint32_t id = 0; id < IDS; id++)
        if (live[id] != DT_NONE)
            dt_idmap_unset(&m, id);
    dt_idmap_trim(&m);
    CHECK(bytes(&m) < 32 * DT_ID_PAGE * 4);
    dt_idmap_clear(&m);
}

TEST(without_memory_the_map_stays_as_it_was)
{
    struct dt_idmap m = {0}, copy;
    enum dt_status status = DT_NOMEM;
    for (long n = 1; status == DT_NOMEM; n++) {
        test_fail_alloc(n);
        status = dt_idmap_reserve(&m, 0, 2 * BLOCK + DT_ID_PAGE);
        CHECK(test_alloc_failed() == (status == DT_NOMEM) && dt_idmap_get(&m, 1) == DT_NONE);
        if (status == DT_NOMEM)
            dt_idmap_clear(&m);
    }
    test_fail_alloc(0);
    put(&m, 0, 2 * BLOCK + 1, true);
    status = DT_NOMEM;
    for (long n = 1; status == DT_NOMEM; n++) {
        test_fail_alloc(n);
        status = dt_idmap_copy(&m, &copy, NULL);
        CHECK(test_alloc_failed() == (status == DT_NOMEM));
    }
    test_fail_alloc(0);
    check_live(&copy, 0, 2 * BLOCK + 1);
    dt_idmap_clear(&m);
    dt_idmap_clear(&copy);
}

TEST(map_lists_its_ids_in_order_and_counts_about_so_many_ahead)
{
    enum { FAR = 5 * (int)DT_ID_PAGE, EVERY = 4 };
    struct dt_idmap m = {0};
    CHECK(dt_idmap_next(&m, 0) == DT_NONE && dt_idmap_after(&m, 0, 1) == DT_NONE);
    for (uint32_t id = 0; id < FAR; id += EVERY) {
        CHECK(dt_idmap_reserve(&m, id, 1) == DT_OK);
        dt_idmap_set(&m, id, id);
    }
    for (uint32_t id = 0; id <= FAR - EVERY; id++)
        CHECK(dt_idmap_next(&m, id) == (id + EVERY - 1) / EVERY * EVERY);
    CHECK(dt_idmap_after(&m, 0, FAR) == DT_NONE);
    for (uint32_t from = 0; from + EVERY * 2000 < FAR; from += 1 + test_below(500)) {
        uint32_t to = dt_idmap_after(&m, from, 1000);
        CHECK(to > from + EVERY * 990 && to < from + EVERY * 1010);
    }
    dt_idmap_clear(&m);
}

TEST(map_without_blocks_drops_its_largest_ids_page_by_page)
{
    enum { PAGES = 6, FAR = PAGES * (int)DT_ID_PAGE };
    struct dt_idmap m = {0};
    for (uint32_t id = 0; id < FAR; id += DT_ID_PAGE / 2) {
        CHECK(dt_idmap_reserve(&m, id, 1) == DT_OK);
        dt_idmap_set(&m, id, value_of(id));
    }
    dt_idmap_unset(&m, FAR - DT_ID_PAGE);
    dt_idmap_unset(&m, FAR - DT_ID_PAGE / 2); /* an empty page is one of them */
    CHECK(dt_idmap_drop(&m, 2) && m.held == PAGES - 2);
    CHECK(dt_idmap_next(&m, FAR - 2 * DT_ID_PAGE) == DT_NONE);
    CHECK(dt_idmap_get(&m, FAR - 3 * DT_ID_PAGE) == value_of(FAR - 3 * DT_ID_PAGE));
    CHECK(dt_idmap_drop(&m, PAGES) && m.held == 0 && !dt_idmap_drop(&m, 1));
    dt_idmap_clear(&m);
}
