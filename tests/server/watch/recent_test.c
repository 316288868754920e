/* recent_test.c - what is remembered of a set's last changes, and when each id changed last. */
#include "server/watch/recent.h"
#include "server/watch/stamps.h"
#include "tests/test.h"

/* One key a version: version i + 1 has key i. */
static void put_versions(struct recent *r, uint64_t n)
{
    recent_restart(r, 0, 7, 0);
    for (uint64_t i = 0; i < n; i++) {
        recent_put(r, &i, 1);
        recent_mark(r, i + 1, 7, 0);
    }
}

static void check_since(const struct recent *r, uint64_t version)
{
    const struct recent_mark *m = recent_at(r, recent_find(r, version));
    CHECK(m != NULL && m->version == version && m->at == version && m->ids == 7);
    for (uint64_t at = m->at; at < r->key_end; at++)
        CHECK(recent_key(r, at) == at);
}

TEST(keys_since_a_version_are_found)
{
    struct recent r = {.keys = 0};
    CHECK(recent_find(&r, 5) == 0);
    put_versions(&r, 1000);
    for (uint64_t v = 0; v <= 1000; v += 100)
        check_since(&r, v);
    recent_restart(&r, 2000, 9, 0);
    CHECK(recent_find(&r, 1999) == 0 && recent_find(&r, 2000) == 1002);
    recent_clear(&r);
}

TEST(version_between_two_marks_has_the_keys_of_the_earlier_one)
{
    struct recent r = {.keys = 0};
    uint64_t key = 1;
    recent_restart(&r, 10, 0, 0);
    recent_put(&r, &key, 1);
    recent_mark(&r, 20, 0, 0);
    CHECK(recent_find(&r, 15) == 1 && recent_at(&r, 1)->at == 0);
    CHECK(recent_find(&r, 25) == 2 && recent_at(&r, 2)->at == 1);
    CHECK(recent_find(&r, 9) == 0 && recent_at(&r, 0) == NULL && recent_at(&r, 3) == NULL);
    recent_clear(&r);
}

TEST(oldest_versions_are_forgotten_within_bounded_memory)
{
    struct recent r = {.keys = 0};
    put_versions(&r, 5 * RECENT_MARKS);
    CHECK(r.marks == RECENT_MARKS && r.keys <= RECENT_KEYS);
    CHECK(recent_find(&r, 0) == 0);
    check_since(&r, 5 * RECENT_MARKS - 100);
    for (uint64_t i = 0; i < 3 * RECENT_KEYS; i++)
        recent_put(&r, &i, 1);
    CHECK(r.keys == RECENT_KEYS && recent_find(&r, UINT64_MAX) == 0);
    recent_clear(&r);
}

TEST(version_is_forgotten_with_the_first_key_that_is_overwritten)
{
    struct recent r = {.keys = 0};
    recent_restart(&r, 1, 0, 0);
    for (uint64_t i = 0; i < RECENT_KEYS; i++)
        recent_put(&r, &i, 1);
    CHECK(recent_find(&r, 1) == 1 && recent_at(&r, 1)->at == 0 && recent_key(&r, 0) == 0);
    recent_put(&r, (const uint64_t[]){7}, 1);
    CHECK(recent_find(&r, 1) == 0 && recent_at(&r, 1) == NULL);
    recent_clear(&r);
}

TEST(ids_have_changed_after_each_tick_before_that_of_their_last_change)
{
    struct stamps s = {.blocks = 0};
    CHECK(!stamps_after(&s, 7, 0) && stamps_memory(&s) == 0);
    CHECK(stamps_put(&s, 7, 1) && stamps_put(&s, 100000, 2) && stamps_put(&s, 7, 5));
    CHECK(stamps_after(&s, 7, 0) && stamps_after(&s, 7, 4) && !stamps_after(&s, 7, 5));
    CHECK(stamps_after(&s, 100000, 1) && !stamps_after(&s, 100000, 2));
    CHECK(!stamps_after(&s, 8, 0) && !stamps_after(&s, 50000, 0) && !stamps_after(&s, 200000, 0));
    CHECK(stamps_memory(&s) < 8 * 1024);
    stamps_clear(&s);
}

TEST(stamps_of_ticks_that_are_far_apart_are_removed)
{
    const uint64_t far = UINT64_C(1) << 32;
    struct stamps s = {.blocks = 0};
    CHECK(stamps_put(&s, 7, far - 1) && stamps_after(&s, 7, far - 2));
    CHECK(!stamps_put(&s, 8, far) && !stamps_after(&s, 7, 0) && stamps_memory(&s) == 0);
    CHECK(stamps_put(&s, 8, far) && stamps_after(&s, 8, far - 1) && !stamps_after(&s, 8, far));
    CHECK(stamps_put(&s, 9, 2 * far - 2) && stamps_after(&s, 9, 2 * far - 3));
    stamps_clear(&s);
}
