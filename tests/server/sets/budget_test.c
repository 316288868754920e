/* budget_test.c - the memory budget: nothing is reserved twice, and replies have a share of their own. */
#include "server/sets/budget.h"

#include "core/memory/pages.h"
#include "tests/test.h"

#include <pthread.h>
#include <stdint.h>

static struct budget budget;

static struct reservation begin(enum budget_kind kind, size_t bytes)
{
    budget_init(&budget, bytes, NULL);
    return (struct reservation){.budget = &budget, .kind = kind};
}

static size_t sum(void)
{
    size_t all = 0;
    for (enum budget_kind k = BUDGET_SETS; k < BUDGET_KINDS; k++)
        all += budget_of(&budget, k);
    return all;
}

TEST(reservation_that_does_not_fit_changes_nothing)
{
    struct reservation build = begin(BUDGET_BUILDS, 1600), load = build;
    load.kind = BUDGET_LOADS;
    CHECK(reservation_resize(&build, 1000) && build.bytes == 1000);
    CHECK(!reservation_resize(&load, 600) && load.bytes == 0 && sum() == 1000);
    CHECK(reservation_resize(&load, 500) && sum() == 1500 && budget_used(&budget) == 1500);
    CHECK(!reservation_resize(&load, 501) && load.bytes == 500);
    CHECK(reservation_resize(&load, 100) && reservation_resize(&build, 1400));
    reservation_set(&build, 0);
    reservation_set(&load, 0);
    CHECK(sum() == 0 && budget_used(&budget) == 0 && budget.peak == 1500);
}

TEST(a_sixteenth_of_the_budget_is_for_replies_and_clients_only)
{
    struct reservation sets = begin(BUDGET_SETS, 1600), reply = sets, edit = sets;
    reply.kind = BUDGET_REPLIES;
    edit.kind = BUDGET_EDITS;
    reservation_set(&sets, 1400);
    CHECK(reservation_resize(&edit, 100) && !reservation_resize(&edit, 101));
    reservation_set(&sets, 5000); /* measured: more than there is */
    CHECK(!budget_fits(&budget, BUDGET_EDITS, 0) && !budget_fits(&budget, BUDGET_LOADS, 1));
    CHECK(reservation_resize(&reply, 100) && !reservation_resize(&reply, 101));
    reservation_set(&sets, 0); /* whatever is free is for replies, too */
    CHECK(reservation_resize(&reply, 1500) && !reservation_resize(&reply, 1501));
}

TEST(sizes_that_never_fit_differ_from_sizes_that_may_fit_later)
{
    struct reservation sets = begin(BUDGET_SETS, 1600), build = sets;
    build.kind = BUDGET_BUILDS;
    reservation_set(&sets, 1000);
    CHECK(reservation_resize(&build, 500));
    CHECK(budget_could_fit(&budget, 500) && !budget_could_fit(&budget, 501));
    reservation_set(&sets, 2000);
    CHECK(!budget_could_fit(&budget, 0));
}

TEST(sums_do_not_overflow)
{
    struct reservation sets = begin(BUDGET_SETS, SIZE_MAX), load = sets;
    load.kind = BUDGET_LOADS;
    reservation_set(&sets, SIZE_MAX / 2);
    CHECK(!budget_fits(&budget, BUDGET_LOADS, SIZE_MAX) && !reservation_resize(&load, SIZE_MAX));
    CHECK(!budget_could_fit(&budget, SIZE_MAX) && !budget_fits(&budget, BUDGET_CLIENTS, SIZE_MAX));
    CHECK(budget_fits(&budget, BUDGET_LOADS, SIZE_MAX / 4) && load.bytes == 0);
    budget.limit = 0;
    CHECK(!budget_fits(&budget, BUDGET_LOADS, 1) && !budget_fits(&budget, BUDGET_REPLIES, 1));
    CHECK(!budget_could_fit(&budget, 1));
}

TEST(bytes_that_move_are_counted_once)
{
    struct reservation load = begin(BUDGET_LOADS, 1600), edit = load, apart = {0};
    edit.kind = BUDGET_EDITS;
    CHECK(reservation_resize(&load, 800) && reservation_resize(&edit, 400));
    reservation_move(&edit, &load);
    CHECK(load.bytes == 0 && edit.bytes == 1200 && sum() == 1200);
    CHECK(budget_of(&budget, BUDGET_EDITS) == 1200 && budget.peak == 1200);
    CHECK(reservation_resize(&apart, SIZE_MAX) && apart.bytes == SIZE_MAX); /* part of no budget */
}

enum { THREADS = 4, ROUNDS = 20000 };

static void *reserve_and_release(void *arg)
{
    struct reservation r = {.budget = &budget, .kind = *(const enum budget_kind *)arg};
    for (int i = 0; i < ROUNDS; i++) {
        (void)reservation_resize(&r, r.bytes + 100);
        CHECK(budget_used(&budget) <= budget.limit);
        if (r.bytes > 400 || i % 3 == 0)
            reservation_set(&r, 0);
    }
    reservation_set(&r, 0);
    return NULL;
}

TEST(threads_together_reserve_no_more_than_the_limit)
{
    static const enum budget_kind kind[THREADS] = {BUDGET_SETS, BUDGET_BUILDS, BUDGET_EDITS,
                                                   BUDGET_LOADS};
    pthread_t thread[THREADS];
    (void)begin(BUDGET_SETS, 1000);
    for (int i = 0; i < THREADS; i++)
        CHECK(pthread_create(&thread[i], NULL, reserve_and_release, (void *)(uintptr_t)&kind[i]) ==
              0);
    for (int i = 0; i < THREADS; i++)
        pthread_join(thread[i], NULL);
    CHECK(sum() == 0 && budget_used(&budget) == 0 && budget.peak <= 1000 - 1000 / 16 &&
          budget.peak >= 200);
}

static size_t kept_in(const struct dt_pages *pages)
{
    struct dt_pages_summary now;
    dt_pages_summary(pages, &now);
    return now.kept;
}

TEST(a_reservation_returns_the_kept_pages_whose_room_it_takes_and_no_more)
{
    enum { MIB = 1 << 20 };
    struct reservation reply = begin(BUDGET_REPLIES, (size_t)64 * MIB), set = reply;
    struct dt_pages *pages = dt_pages_new(SIZE_MAX);
    void *region = dt_region_take(pages, (size_t)40 * MIB);
    CHECK(region != NULL);
    budget.pages = pages;
    set.kind = BUDGET_SETS;
    reservation_set(&set, (size_t)40 * MIB); /* as long as it is in use */
    reservation_set(&set, 0);
    dt_region_give(pages, region, (size_t)40 * MIB);
    CHECK(kept_in(pages) == (size_t)40 * MIB);
    CHECK(reservation_resize(&reply, (size_t)24 * MIB) && kept_in(pages) == (size_t)40 * MIB);
    CHECK(reservation_resize(&reply, (size_t)30 * MIB) && kept_in(pages) == (size_t)34 * MIB);
    reservation_set(&set, (size_t)10 * MIB); /* what is measured counts, too */
    CHECK(kept_in(pages) == (size_t)24 * MIB);
    CHECK(reservation_resize(&reply, (size_t)54 * MIB) && kept_in(pages) == 0);
    CHECK(!reservation_resize(&reply, (size_t)54 * MIB + 1));
    reservation_set(&reply, 0);
    reservation_set(&set, 0);
    dt_pages_free(pages);
}
