/* pages_test.c - pages that are used again: kept pages, requests to the system, ownership. */
#include <pthread.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory/memory.h"
#include "core/memory/pages.h"
#include "tests/core/memory/mremap_shim.h"
#include "tests/core/sets.h"
#include "tests/core/threads.h"
#include "tests/oracle/families.h"
#include "tests/test.h"

#define MIB ((size_t)1 << 20)

static struct dt_pages_summary facts(const struct dt_pages *p)
{
    struct dt_pages_summary f;
    dt_pages_summary(p, &f);
    return f;
}

static void check_facts(const struct dt_pages *p, size_t held, size_t kept, size_t fresh)
{
    struct dt_pages_summary f = facts(p);
    CHECK_MSG(f.held == held * MIB && f.kept == kept * MIB && f.fresh == fresh * MIB,
              "held %zu kept %zu fresh %zu", f.held / MIB, f.kept / MIB, (size_t)f.fresh / MIB);
}

/* Writes at both ends of each page, which also shows that the page exists. */
static void mark(char *region, size_t bytes, char with)
{
    for (size_t at = 0; at < bytes; at += DT_HUGE_PAGE)
        region[at] = region[at + DT_HUGE_PAGE - 1] = with;
}

static bool is_marked(const char *region, size_t bytes, char with)
{
    for (size_t at = 0; at < bytes; at += DT_HUGE_PAGE)
        if (region[at] != with || region[at + DT_HUGE_PAGE - 1] != with)
            return false;
    return true;
}

static char *take(struct dt_pages *p, size_t mib, char with)
{
    char *region = dt_region_take(p, mib * MIB);
    CHECK(region != NULL && ((uintptr_t)region & (DT_HUGE_PAGE - 1)) == 0);
    mark(region, mib * MIB, with);
    return region;
}

TEST(what_is_given_back_is_cut_for_others_and_joined_again)
{
    struct dt_pages *p = dt_pages_new(SIZE_MAX);
    char *a = take(p, 20, 1);
    check_facts(p, 20, 0, 20);
    dt_region_give(p, a, 20 * MIB);
    check_facts(p, 20, 20, 20);
    char *b = take(p, 4, 2), *c = take(p, 6, 3), *d = take(p, 2, 4);
    check_facts(p, 20, 8, 20);
    CHECK(b >= a && c >= a && d >= a && b < a + 20 * MIB && c < a + 20 * MIB && d < a + 20 * MIB);
    CHECK(is_marked(b, 4 * MIB, 2) && is_marked(c, 6 * MIB, 3) && is_marked(d, 2 * MIB, 4));
    dt_region_give(p, b, 4 * MIB);
    dt_region_give(p, d, 2 * MIB);
    dt_region_give(p, c, 6 * MIB);
    CHECK(take(p, 20, 5) == a); /* in one piece */
    check_facts(p, 20, 0, 20);
    dt_region_give(p, a, 20 * MIB);
    dt_pages_free(p);
}

TEST(the_smallest_region_that_is_large_enough_is_cut)
{
    static const size_t at[] = {0, 32, 42}, size[] = {30, 8, 18}; /* with gaps */
    for (unsigned order = 0; order < 6; order++) {                /* in which they are given */
        unsigned first = order % 3, second = (first + 1 + order / 3) % 3;
        unsigned turn[] = {first, second, 3 - first - second};
        struct dt_pages *p = dt_pages_new(SIZE_MAX);
        char *all = take(p, 60, 1);
        for (unsigned k = 0; k < 3; k++)
            dt_region_give(p, all + at[turn[k]] * MIB, size[turn[k]] * MIB);
        CHECK(take(p, 10, 2) == all + 42 * MIB);
        char *a = take(p, 8, 3), *b = take(p, 8, 4); /* 8 are left there, too */
        CHECK((a < b ? a : b) == all + 32 * MIB && (a < b ? b : a) == all + 52 * MIB);
        CHECK(take(p, 30, 5) == all);
        check_facts(p, 60, 0, 60);
        dt_region_give(p, all, 60 * MIB);
        dt_pages_free(p);
    }
}

TEST(a_large_region_consists_of_small_ones_and_fresh_pages)
{
    struct dt_pages *p = dt_pages_new(SIZE_MAX);
    char *a = take(p, 40, 1);
    for (size_t i = 0; i < 5; i++) /* every other piece of 4 MiB */
        dt_region_give(p, a + 8 * MIB * i, 4 * MIB);
    char *b = take(p, 16, 2);
    check_facts(p, 40, 4, 40);
    CHECK(is_marked(b, 16 * MIB, 2));
    char *c = take(p, 10, 3);
    check_facts(p, 46, 0, 46);
    CHECK(is_marked(b, 16 * MIB, 2) && is_marked(c, 10 * MIB, 3));
    for (size_t i = 0; i < 5; i++)
        CHECK(is_marked(a + 8 * MIB * i + 4 * MIB, 4 * MIB, 1));
    dt_region_give(p, b, 16 * MIB); /* what was put together is taken apart, and moved as a whole */
    char *d = take(p, 6, 4), *e = dt_region_grow(p, d, 6 * MIB, 16 * MIB);
    CHECK(e != NULL && is_marked(e, 6 * MIB, 4));
    mark(e, 16 * MIB, 5);
    check_facts(p, 46, 0, 46);
    CHECK(is_marked(c, 10 * MIB, 3));
    dt_region_give(p, e, 16 * MIB);
    dt_region_give(p, c, 10 * MIB);
    for (size_t i = 0; i < 5; i++)
        dt_region_give(p, a + 8 * MIB * i + 4 * MIB, 4 * MIB);
    check_facts(p, 46, 46, 46);
    dt_pages_free(p);
}

TEST(kept_and_used_pages_do_not_exceed_the_limit)
{
    struct dt_pages *p = dt_pages_new(20 * MIB);
    char *a = take(p, 16, 1), *b = take(p, 12, 2);
    check_facts(p, 28, 0, 28); /* what is wanted is given */
    dt_region_give(p, b, 12 * MIB);
    check_facts(p, 20, 4, 28);
    char *c = take(p, 10, 3); /* 4 are moved to it; the rest is fresh, and more than the limit */
    check_facts(p, 26, 0, 34);
    dt_pages_limit(p, 25 * MIB); /* a part of a huge page counts as all of it */
    dt_region_give(p, c, 10 * MIB);
    check_facts(p, 24, 8, 34);
    dt_pages_limit(p, 10 * MIB);
    dt_region_give(p, a, 16 * MIB);
    check_facts(p, 10, 10, 34);
    b = dt_region_take(p, 12 * MIB);
    check_facts(p, 12, 0, 36);
    dt_region_give(p, b, 12 * MIB);
    dt_pages_limit(p, 0);
    b = dt_region_take(p, 2 * MIB);
    dt_region_give(p, b, 2 * MIB);
    check_facts(p, 8, 8, 36);
    CHECK(dt_pages_trim(p, SIZE_MAX) == 8 * MIB);
    dt_pages_free(p);
}

TEST(fresh_regions_replace_kept_ones_beyond_the_limit)
{
    struct dt_pages *p = dt_pages_new(30 * MIB);
    char *a = take(p, 12, 1), *b = take(p, 14, 2);
    dt_region_give(p, a, 12 * MIB);
    dt_pages_limit(p, 14 * MIB); /* kept beyond it until something moves */
    check_facts(p, 26, 12, 26);
    a = dt_region_grow(p, b, 14 * MIB, 28 * MIB);
    check_facts(p, 28, 0, 28);
    CHECK(a != NULL && is_marked(a, 14 * MIB, 2));
    dt_region_give(p, a, 28 * MIB);
    check_facts(p, 14, 14, 28);
    dt_pages_free(p);
}

TEST(kept_regions_are_returned_a_piece_at_a_time)
{
    struct dt_pages *p = dt_pages_new(SIZE_MAX);
    char *a = take(p, 16, 1), *b = take(p, 4, 2);
    CHECK(dt_pages_trim(p, SIZE_MAX) == 0);
    dt_region_give(p, a, 16 * MIB);
    CHECK(dt_pages_trim(p, 3 * MIB) == 4 * MIB && dt_pages_trim(p, 0) == 0);
    check_facts(p, 16, 12, 20);
    CHECK(is_marked(b, 4 * MIB, 2));
    CHECK(dt_pages_trim(p, 100 * MIB) == 12 * MIB && dt_pages_trim(p, 1) == 0);
    check_facts(p, 4, 0, 20);
    dt_region_give(p, b, 4 * MIB);
    uint64_t uses = facts(p).uses;
    CHECK(dt_pages_trim(p, SIZE_MAX) == 4 * MIB && facts(p).uses == uses);
    dt_pages_free(p);
    dt_pages_free(NULL);
}

TEST(pages_are_made_ready_as_far_as_the_limit_lets_them)
{
    struct dt_pages *p = dt_pages_new(14 * MIB);
    CHECK(dt_pages_prepare(p, 5 * MIB) == 6 * MIB);
    check_facts(p, 6, 6, 6);
    char *a = take(p, 8, 1);
    check_facts(p, 8, 0, 8);
    test_fail_alloc(1);
    CHECK(dt_pages_prepare(p, 2 * MIB) == 0 && dt_pages_prepare(p, 0) == 0);
    test_fail_alloc(0);
    CHECK(dt_pages_prepare(p, 20 * MIB) == 6 * MIB && dt_pages_prepare(p, MIB) == 0);
    check_facts(p, 14, 6, 14);
    dt_region_give(p, a, 8 * MIB);
    dt_pages_free(p);
}

TEST(more_regions_than_there_are_slots_go_back_to_the_system)
{
    enum { PIECES = 300 };
    struct dt_pages *p = dt_pages_new(SIZE_MAX);
    char *all = dt_region_take(p, 2 * PIECES * DT_HUGE_PAGE);
    CHECK(all != NULL);
    for (size_t i = 0; i < PIECES; i++)
        dt_region_give(p, all + 2 * i * DT_HUGE_PAGE, DT_HUGE_PAGE);
    struct dt_pages_summary f = facts(p);
    CHECK(f.held == (PIECES + 256) * DT_HUGE_PAGE && f.kept == 256 * DT_HUGE_PAGE);
    for (size_t i = 0; i < PIECES; i++)
        dt_region_give(p, all + (2 * i + 1) * DT_HUGE_PAGE, DT_HUGE_PAGE);
    f = facts(p);
    CHECK(f.held == f.kept && f.kept == (PIECES + 256) * DT_HUGE_PAGE);
    CHECK(dt_pages_trim(p, SIZE_MAX) == f.kept && facts(p).held == 0);
    dt_pages_free(p);
}

TEST(without_addresses_nothing_changes)
{
    struct dt_pages *p = dt_pages_new(SIZE_MAX);
    test_fail_alloc(1);
    CHECK(dt_region_take(NULL, 4 * MIB) == NULL && test_alloc_failed());
    test_fail_alloc(1);
    CHECK(dt_region_take(p, 4 * MIB) == NULL && test_alloc_failed());
    check_facts(p, 0, 0, 0);
    char *a = take(p, 4, 1), *b = take(p, 8, 2);
    test_fail_alloc(1);
    CHECK(dt_region_grow(p, a, 4 * MIB, 8 * MIB) == NULL && is_marked(a, 4 * MIB, 1));
    dt_region_give(p, b, 8 * MIB);
    test_fail_alloc(1);
    CHECK(dt_region_take(p, 10 * MIB) == NULL);
    check_facts(p, 12, 8, 12);
    test_fail_alloc(1);
    CHECK(take(p, 8, 3) == b && !test_alloc_failed()); /* what is kept needs none */
    test_fail_alloc(0);
    dt_region_give(p, a, 4 * MIB);
    dt_region_give(p, b, 8 * MIB);
    dt_pages_free(p);
    test_fail_alloc(1);
    CHECK(dt_pages_new(0) == NULL);
}

/* ---- moving pages where the system does not like to ---- */

/* Every other 2 MiB of a region that is kept, so that one of twice that must be put together. */
static char *scatter(struct dt_pages *p, size_t pieces)
{
    char *all = take(p, 4 * pieces, 1);
    for (size_t i = 0; i < pieces; i++)
        dt_region_give(p, all + 4 * i * MIB, 2 * MIB);
    return all;
}

static void gather(struct dt_pages *p, char *all, size_t pieces)
{
    for (size_t i = 0; i < pieces; i++) {
        CHECK(is_marked(all + (4 * i + 2) * MIB, 2 * MIB, 1));
        dt_region_give(p, all + (4 * i + 2) * MIB, 2 * MIB);
    }
}

/* Different bytes on all pages. */
static void write_down(char *region, size_t mib)
{
    for (size_t i = 0; i < mib * 256; i++)
        region[i * 4096] = (char)(i * 7 + i / 256);
}

static bool is_as_written(const char *region, size_t mib)
{
    for (size_t i = 0; i < mib * 256; i++)
        if (region[i * 4096] != (char)(i * 7 + i / 256))
            return false;
    return true;
}

/* A region of many mappings, and it has to move. */
TEST(a_region_of_several_mappings_moves_where_the_system_moves_one_at_a_time)
{
    struct dt_pages *p = dt_pages_new(SIZE_MAX);
    char *all = scatter(p, 8);
    remap_one_mapping_only();
    char *a = take(p, 20, 2); /* of eight pieces and a rest */
    write_down(a, 20);
    char *b = dt_region_grow(p, a, 20 * MIB, 30 * MIB);
    CHECK(b != NULL && is_as_written(b, 20));
    mark(b, 30 * MIB, 3);
    dt_region_give(p, b, 30 * MIB);
    gather(p, all, 8);
    char *c = take(p, 46, 4);
    check_facts(p, 46, 0, 46);
    CHECK(is_marked(c, 46 * MIB, 4));
    dt_region_give(p, c, 46 * MIB);
    dt_pages_free(p);
    CHECK_MSG(remap_end() == 0, "a move has hit what another thread has mapped");
}

TEST(regions_are_put_together_or_fresh_and_grow_or_stay_whichever_move_is_refused)
{
    for (long nth = 1;; nth++) {
        struct dt_pages *p = dt_pages_new(SIZE_MAX);
        char *all = scatter(p, 6);
        remap_refuse(nth);
        char *a = take(p, 10, 2);
        write_down(a, 10);
        char *b = dt_region_grow(p, a, 10 * MIB, 24 * MIB);
        CHECK(b != NULL && is_as_written(b, 10));
        mark(b, 24 * MIB, 3);
        CHECK(is_marked(b, 24 * MIB, 3));
        int failed = remap_end();
        CHECK_MSG(failed >= 0, "move %ld has hit what another thread has mapped", nth);
        gather(p, all, 6);
        dt_region_give(p, b, 24 * MIB);
        struct dt_pages_summary f = facts(p);
        CHECK(f.held == f.kept && dt_pages_trim(p, SIZE_MAX) == f.held && facts(p).held == 0);
        dt_pages_free(p);
        if (failed == 0)
            return;
    }
}

TEST(a_region_is_as_before_if_it_can_neither_move_nor_be_copied)
{
    for (long at = 1; at <= 4; at++) {
        struct dt_pages *p = dt_pages_new(SIZE_MAX);
        char *all = scatter(p, 4), *a = take(p, 8, 2);
        write_down(a, 8);
        remap_one_mapping_only();
        remap_refuse(at); /* one of the pages it consists of */
        test_fail_alloc(2);
        CHECK(dt_region_grow(p, a, 8 * MIB, 12 * MIB) == NULL && test_alloc_failed());
        CHECK(remap_end() == 1 && is_as_written(a, 8));
        mark(a, 8 * MIB, 5);
        char *b = dt_region_grow(p, a, 8 * MIB, 12 * MIB);
        CHECK(b != NULL && is_marked(b, 8 * MIB, 5));
        dt_region_give(p, b, 12 * MIB);
        gather(p, all, 4);
        CHECK(facts(p).held == facts(p).kept);
        dt_pages_free(p);
    }
}

TEST(a_region_is_copied_where_the_system_cannot_move_it_and_keep_its_mapping)
{
    struct dt_pages *p = dt_pages_new(SIZE_MAX);
    char *a = take(p, 6, 1);
    write_down(a, 6);
    remap_without_dontunmap();
    char *b = dt_region_grow(p, a, 6 * MIB, 10 * MIB);
    CHECK(b != NULL && is_as_written(b, 6));
    check_facts(p, 10, 0, 10);
    char *c = dt_region_grow(NULL, dt_region_take(NULL, 2 * MIB), 2 * MIB, 4 * MIB);
    CHECK(c != NULL);
    dt_region_give(NULL, c, 4 * MIB);
    dt_region_give(p, b, 10 * MIB);
    dt_pages_free(p);
    CHECK(remap_end() == 0);
}

/* ---- arrays ---- */

TEST(arrays_of_a_cache_grow_shrink_and_return_there)
{
    struct dt_pages *p = dt_pages_new(SIZE_MAX);
    uint32_t *a = dt_array_new_in(p, 1000, sizeof *a), n = 1000;
    for (uint32_t i = 0; i < n; i++)
        a[i] = 3 * i;
    check_facts(p, 0, 0, 0); /* small ones are malloc's */
    for (; n < 4u << 20; n *= 4) {
        a = dt_array_grow_in(p, a, n, 4 * (size_t)n, sizeof *a);
        CHECK(a != NULL);
        for (uint32_t i = n; i < 4 * n; i++)
            a[i] = 3 * i;
    }
    for (uint32_t i = 0; i < n; i += 501)
        CHECK(a[i] == 3 * i);
    CHECK(facts(p).held == dt_huge_pages(n * sizeof *a + 64) && facts(p).kept == 0);
    a = dt_array_grow_in(p, a, 2 << 20, 2 << 20, sizeof *a);
    check_facts(p, 64, 54, 64);
    for (uint32_t i = 0; i < 2u << 20; i += 501)
        CHECK(a[i] == 3 * i);
    dt_array_free(a);
    check_facts(p, 64, 64, 64);
    void *own = dt_pages_grow(p, NULL, 0, 10);
    CHECK((own = dt_pages_grow(p, own, 10, 12 * MIB)) != NULL);
    check_facts(p, 64, 50, 64);
    dt_pages_release(own);
    dt_pages_release(NULL);
    dt_pages_free(p);
}

/* ---- many threads ---- */

enum { THREADS = 4, HANDS = 3, ROUNDS = 100 };

struct player {
    struct dt_pages *pages;
    uint64_t random;
    char name;
    bool cheated;
};

static uint32_t draw(struct player *q, uint32_t n)
{
    q->random = q->random * 6364136223846793005u + 1442695040888963407u;
    return (uint32_t)((q->random >> 33) % n);
}

/* Each has a few regions at a time, gives, takes and grows them, and finds its mark on all. */
static void *play(void *arg)
{
    struct player *q = arg;
    char *hand[HANDS] = {NULL};
    size_t size[HANDS];
    for (int round = 0; round < ROUNDS; round++) {
        uint32_t i = draw(q, HANDS);
        size_t more = (1 + draw(q, 3)) * DT_HUGE_PAGE;
        q->cheated |= hand[i] != NULL && !is_marked(hand[i], size[i], q->name);
        if (hand[i] == NULL) {
            hand[i] = dt_region_take(q->pages, size[i] = more);
        } else if (draw(q, 4) == 0) {
            hand[i] = dt_region_grow(q->pages, hand[i], size[i], size[i] + more);
            q->cheated |= !is_marked(hand[i], size[i], q->name);
            size[i] += more;
        } else {
            memset(hand[i], 0, 64); /* nobody else may see it */
            dt_region_give(q->pages, hand[i], size[i]);
            hand[i] = NULL;
        }
        if (hand[i] != NULL)
            mark(hand[i], size[i], q->name);
        if (draw(q, 32) == 0)
            (void)dt_pages_trim(q->pages, DT_HUGE_PAGE);
    }
    for (int i = 0; i < HANDS; i++)
        if (hand[i] != NULL)
            dt_region_give(q->pages, hand[i], size[i]);
    return NULL;
}

TEST_TIMEOUT(threads_that_take_and_give_at_once_never_share_a_page, 60)
{
    struct player q[THREADS];
    pthread_t thread[THREADS];
    struct dt_pages *p = dt_pages_new(24 * MIB);
    for (int i = 0; i < THREADS; i++) {
        q[i] = (struct player){p, test_random(), (char)('a' + i), false};
        CHECK(pthread_create(&thread[i], NULL, play, &q[i]) == 0);
    }
    for (int i = 0; i < THREADS; i++) {
        pthread_join(thread[i], NULL);
        CHECK(!q[i].cheated);
    }
    struct dt_pages_summary f = facts(p);
    CHECK(f.held == f.kept && f.held <= 24 * MIB);
    CHECK(dt_pages_trim(p, SIZE_MAX) == f.held && facts(p).held == 0 && facts(p).kept == 0);
    dt_pages_free(p);
}

/* ---- sets ---- */

enum { LARGE = 265000, SMALLER = 66000 };

/* A number that depends on all triangles of the set. */
static uint64_t digest(const struct dt *t)
{
    uint32_t word[3 * 1024];
    uint64_t sum = 0;
    struct dt_cursor c;
    size_t rows, words;
    CHECK(dt_table_begin(t, NULL, DT_TRIANGLES, false, &c) == DT_OK);
    do {
        CHECK(dt_table_read(t, &c, word, 3 * 1024, 1024, &rows, &words) == DT_OK);
        for (size_t i = 0; i < words; i++)
            sum = (sum ^ word[i]) * 0x100000001b3u;
    } while (rows > 0);
    return sum;
}

static uint64_t build(struct dt_pages *pages, const struct dt_point *q, uint32_t n,
                      const struct dt_pool *pool)
{
    struct dt_options opt = {.pool = pool};
    struct dt_added added;
    struct dt *t = dt_new_in(0, pages), *copy;
    CHECK(t != NULL && dt_add_many(t, q, n, &(struct dt_options){.pool = pool}, &added) == DT_OK);
    CHECK(dt_clone(t, &copy) == DT_OK);
    CHECK(dt_triangulate(copy, &opt) == DT_OK && dt_prepare(copy, &opt) == DT_OK);
    uint64_t sum = digest(copy);
    dt_free(t);
    dt_free(copy);
    return sum;
}

TEST_TIMEOUT(a_set_built_again_is_the_same_and_needs_no_fresh_pages, 60)
{
    struct dt_point *q = malloc(LARGE * sizeof *q);
    struct dt_pages *p = dt_pages_new(SIZE_MAX);
    struct dt_pool pool = threads_pool(2);
    family_points(family_find("uniform"), q, LARGE, test_random());
    uint64_t want = build(NULL, q, LARGE, NULL);
    CHECK(build(p, q, LARGE, NULL) == want);
    struct dt_pages_summary first = facts(p);
    CHECK(first.kept == first.held && first.held >= LARGE * (size_t)100);
    CHECK(first.fresh == first.held); /* nothing went back to the system in between */
    CHECK(build(p, q, LARGE, &pool) == want);
    struct dt_pages_summary last = facts(p);
    CHECK_MSG(last.fresh == first.fresh, "%zu and %zu MiB", (size_t)first.fresh / MIB,
              (size_t)last.fresh / MIB);
    CHECK(last.kept == last.held);
    dt_pages_free(p);
    free(q);
}

TEST_TIMEOUT(large_sets_survive_any_one_failed_allocation, 60)
{
    struct dt_point *q = malloc(LARGE * sizeof *q);
    struct dt_pages *p = dt_pages_new(SIZE_MAX);
    struct dt_added added;
    family_points(family_find("uniform"), q, SMALLER, test_random());
    struct dt *t = dt_new_in(0, p);
    CHECK(t != NULL && dt_add(t, q, SMALLER, &added) == DT_OK);
    enum dt_status status = DT_NOMEM;
    long n = 1;
    for (; status == DT_NOMEM; n++) {
        test_fail_alloc(n);
        status = dt_triangulate(t, NULL);
        CHECK(status == (test_alloc_failed() ? DT_NOMEM : DT_OK));
        test_fail_alloc(0);
        (void)dt_pages_trim(p, SIZE_MAX); /* so that all must come from the system again */
    }
    CHECK(n >= 2 + 2 && dt_check(t, NULL, NULL) == DT_OK); /* the two arrays of the mesh failed */
    dt_free(t);
    CHECK(facts(p).kept == facts(p).held);
    dt_pages_free(p);
    free(q);
}
