/* recent_test.c - what is remembered of a set's last changes, and sets of ids. */
#include "server/watch/idset.h"
#include "server/watch/recent.h"
#include "tests/test.h"

/* One key a version: version i + 1 has key i. */
static void put_versions(struct recent *r, uint64_t n)
{
    recent_restart(r, 0, 7);
    for (uint64_t i = 0; i < n; i++) {
        recent_put(r, &i, 1);
        recent_mark(r, i + 1, 7);
    }
}

static void check_since(const struct recent *r, uint64_t version)
{
    const struct recent_mark *m = recent_find(r, version);
    CHECK(m != NULL && m->version == version && m->at == version && m->ids == 7);
    for (uint64_t at = m->at; at < r->key_end; at++)
        CHECK(recent_key(r, at) == at);
}

TEST(keys_since_a_version_are_found)
{
    struct recent r = {.keys = 0};
    CHECK(recent_find(&r, 5) == NULL);
    put_versions(&r, 1000);
    for (uint64_t v = 0; v <= 1000; v += 100)
        check_since(&r, v);
    recent_restart(&r, 2000, 9);
    CHECK(recent_find(&r, 1999) == NULL && recent_find(&r, 2000) != NULL);
    recent_clear(&r);
}

TEST(version_between_two_marks_has_the_keys_of_the_earlier_one)
{
    struct recent r = {.keys = 0};
    uint64_t key = 1;
    recent_restart(&r, 10, 0);
    recent_put(&r, &key, 1);
    recent_mark(&r, 20, 0);
    CHECK(recent_find(&r, 15)->at == 0);
    CHECK(recent_find(&r, 25)->at == 1);
    CHECK(recent_find(&r, 9) == NULL);
    recent_clear(&r);
}

TEST(oldest_versions_are_forgotten_within_bounded_memory)
{
    struct recent r = {.keys = 0};
    put_versions(&r, 5 * RECENT_MARKS);
    CHECK(r.marks == RECENT_MARKS && r.keys <= RECENT_KEYS);
    CHECK(recent_find(&r, 0) == NULL);
    check_since(&r, 5 * RECENT_MARKS - 100);
    for (uint64_t i = 0; i < 3 * RECENT_KEYS; i++)
        recent_put(&r, &i, 1);
    CHECK(r.keys == RECENT_KEYS && recent_find(&r, UINT64_MAX) == NULL);
    recent_clear(&r);
}

TEST(version_is_forgotten_with_the_first_key_that_is_overwritten)
{
    struct recent r = {.keys = 0};
    recent_restart(&r, 1, 0);
    for (uint64_t i = 0; i < RECENT_KEYS; i++)
        recent_put(&r, &i, 1);
    CHECK(recent_find(&r, 1)->at == 0 && recent_key(&r, 0) == 0);
    recent_put(&r, (const uint64_t[]){7}, 1);
    CHECK(recent_find(&r, 1) == NULL);
    recent_clear(&r);
}

TEST(ids_are_taken_once_and_in_order_from_where_the_last_was)
{
    struct idset s = {.count = 0}, copy = {.count = 0};
    CHECK(idset_add(&s, 500, 501) && idset_add(&s, 3, 501) && idset_add(&s, 3, 501));
    CHECK(s.count == 2 && idset_has(&s, 3) && !idset_has(&s, 4) && !idset_has(&s, 100000));
    CHECK(idset_copy(&copy, &s));
    CHECK(idset_take(&s) == 3 && idset_add(&s, 3, 501) && idset_add(&s, 64, 501));
    CHECK(idset_take(&s) == 3 && idset_take(&s) == 64 && idset_take(&s) == 500 && s.count == 0);
    CHECK(idset_remove(&copy, 500) && !idset_remove(&copy, 500) && copy.count == 1);
    CHECK(idset_fill(&copy, 129) && copy.count == 129 && idset_has(&copy, 128));
    CHECK(!idset_has(&copy, 129));
    idset_clear(&s);
    idset_clear(&copy);
}
