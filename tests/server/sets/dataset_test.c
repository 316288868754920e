/* dataset_test.c - the registry: which sets exist, for whom, and which versions are to be tidied. */
#include "server/sets/dataset.h"
#include "tests/test.h"

#include <stdio.h>
#include <string.h>

static struct registry sets;

static struct dataset *create(const char *name)
{
    struct dataset *set = registry_create(&sets, &(struct word){name, strlen(name)}, 0);
    CHECK(set != NULL);
    return set;
}

/* Each name is a prefix of the next one; there are so many that some share a bucket. */
TEST(names_that_begin_alike_are_different_sets)
{
    enum { MANY = 64 };
    char name[MANY + 1];
    struct dataset *set[MANY + 1];
    memset(name, 'a', sizeof name);
    registry_init(&sets);
    for (size_t n = 1; n <= MANY; n++) {
        set[n] = registry_create(&sets, &(struct word){name, n}, 0);
        CHECK(set[n] != NULL);
    }
    for (size_t n = 1; n <= MANY; n++)
        CHECK(registry_find(&sets, &(struct word){name, n}) == set[n]);
    registry_clear(&sets);
}

/* Sets without a time are not looked at. */
TEST(sets_that_expire_are_looked_at_in_turn)
{
    enum { MANY = 300 };
    struct dataset *set[MANY];
    char name[20];
    registry_init(&sets);
    for (int i = 0; i < MANY; i++) {
        sprintf(name, "s%d", i);
        set[i] = create(name);
    }
    CHECK(registry_next_expiring(&sets) == NULL);
    for (int i = 0; i < 5; i++)
        registry_expire(&sets, set[50 * i], 1 + i);
    for (int i = 0; i < 12; i++)
        CHECK(registry_next_expiring(&sets) == set[50 * (i % 5)]);
    registry_expire(&sets, set[150], 0);
    registry_drop(&sets, set[200]);
    registry_expire(&sets, set[0], 7);
    static const int turn[] = {100, 50, 0}; /* 100 is next, and 0 was set again */
    for (int i = 0; i < 9; i++) {
        CHECK(registry_next_expiring(&sets) == set[turn[i % 3]]);
        CHECK(sets.expiring == 3);
    }
    registry_clear(&sets);
    CHECK(sets.expiring == 0);
}

static void count(struct dataset *set, void *ctx)
{
    (void)set;
    ++*(unsigned *)ctx;
}

static unsigned scanned(void)
{
    unsigned n = 0;
    size_t cursor = 0;
    do
        cursor = registry_scan(&sets, cursor, count, &n);
    while (cursor != 0);
    return n;
}

TEST(set_that_is_about_to_be_created_is_not_listed)
{
    unsigned n = 0;
    registry_init(&sets);
    struct dataset *set = create("t");
    create("u")->born = true;
    registry_each(&sets, count, &n);
    CHECK(n == 1 && scanned() == 1);
    set->born = true;
    registry_each(&sets, count, &n);
    CHECK(n == 3 && scanned() == 2);
    registry_clear(&sets);
}

TEST(set_that_was_never_triangulated_is_not_out_of_date)
{
    struct dt_added added;
    registry_init(&sets);
    struct dataset *set = create("t");
    CHECK(!version_is_stale(set->current));
    CHECK(dt_add(set->current->dt, (struct dt_point[]){{0, 0}, {1, 0}, {0, 1}}, 3, &added) ==
          DT_OK);
    version_update(&sets, set->current);
    CHECK(!version_is_stale(set->current));
    registry_clear(&sets);
}

/* Readers finished during an edit; one call tidies a bounded number of sets. */
TEST(versions_that_keep_what_was_saved_are_tidied_a_few_at_a_time)
{
    enum { MANY = 25, A_CALL = 10 };
    registry_init(&sets);
    for (unsigned i = 0; i < MANY; i++) {
        char name[8];
        snprintf(name, sizeof name, "t%u", i);
        struct version *v = create(name)->current;
        struct dt_view *view = dt_view_begin(v->dt, false);
        CHECK(view != NULL);
        gate_close(&v->gate);
        version_end_view(&sets, v, view);
        CHECK(list_holds(&v->untidy));
        gate_open(&v->gate);
    }
    for (unsigned left = MANY; left > 0; left -= left < A_CALL ? left : A_CALL) {
        unsigned n = 0;
        for (struct version *v = list_first(&sets.untidy); v != NULL;
             v = list_next(&sets.untidy, v))
            n++;
        CHECK(n == left);
        registry_tidy(&sets);
    }
    CHECK(list_is_empty(&sets.untidy));
    registry_clear(&sets);
}

TEST(version_that_is_freed_is_no_longer_to_be_tidied)
{
    registry_init(&sets);
    struct dataset *set = create("t");
    struct version *v = version_pin(set->current);
    struct dt_view *view = dt_view_begin(v->dt, false);
    gate_close(&v->gate);
    version_end_view(&sets, v, view);
    gate_open(&v->gate);
    registry_drop(&sets, set);
    CHECK(list_first(&sets.untidy) == v);
    version_unpin(&sets, v);
    CHECK(list_is_empty(&sets.untidy));
    registry_clear(&sets);
}

/* A set of another registry, which is to replace that one: with that many points. */
static struct registry others;

static struct dataset *create_other(const char *name, uint64_t version, unsigned points)
{
    struct dataset *set = registry_create(&others, &(struct word){name, strlen(name)}, 0);
    CHECK(set != NULL);
    set->version = version;
    set->born = true;
    for (unsigned i = 0; i < points; i++) {
        struct dt_added added;
        struct dt_point at = {i, i * i};
        CHECK(dt_add(set->current->dt, &at, 1, &added) == DT_OK);
    }
    version_update(&others, set->current);
    return set;
}

static void add_memory(struct dataset *set, void *ctx)
{
    *(size_t *)ctx += set->current->sum.memory;
}

TEST(sets_that_are_replaced_stay_the_same_sets_and_count_their_memory)
{
    for (int same = 0; same < 2; same++) {
        struct budget budget;
        budget_init(&budget, SIZE_MAX, NULL);
        registry_init(&sets);
        registry_init(&others);
        sets.budget = &budget;
        struct dataset *a = create("a"), *b = create("b"), *gone = create("gone");
        struct version *before = version_pin(a->current);
        a->born = b->born = gone->born = true;
        a->version = b->version = 4;
        registry_expire(&sets, b, 100);
        create_other("b", 6, 1000);
        registry_expire(&others, create_other("new", 8, 10), 200);
        const struct dataset *other = create_other("a", 4, 2);
        others.life = 77;
        CHECK(registry_replace(&sets, &others, same));
        CHECK(sets.sets == 3 && sets.life == 77 && others.sets == 0);
        CHECK(registry_find(&sets, &(struct word){"b", 1}) == b && b->version == 6);
        CHECK(b->current->sum.points == 1000 && b->expires_ms == 0);
        CHECK(sets.expiring == 1 && strcmp(registry_next_expiring(&sets)->name, "new") == 0);
        CHECK(registry_find(&sets, &(struct word){"gone", 4}) == NULL);
        const struct dataset *now = registry_find(&sets, &(struct word){"a", 1});
        CHECK(same ? now == a && a->current == before : now == other);
        version_unpin(&sets, before);
        size_t memory = 0;
        registry_each(&sets, add_memory, &memory);
        CHECK(memory == budget_used(&budget));
        registry_clear(&sets);
        CHECK(budget_used(&budget) == 0);
    }
}

TEST(temporary_set_is_replaced_by_one_of_its_name_only)
{
    struct list mine = {0};
    registry_init(&sets);
    registry_init(&others);
    struct dataset *t = create("t"), *u = create("u");
    t->temporary = u->temporary = true;
    list_append(&mine, &t->fellow);
    list_append(&mine, &u->fellow);
    create_other("u", 2, 3);
    CHECK(registry_replace(&sets, &others, true));
    CHECK(registry_find(&sets, &(struct word){"t", 1}) == t && sets.sets == 2);
    CHECK(!registry_find(&sets, &(struct word){"u", 1})->temporary);
    CHECK(list_first(&mine) == &t->fellow && list_last(&mine) == &t->fellow);
    registry_clear(&sets);
    CHECK(list_is_empty(&mine));
}

/* All begin in the same second or two, as if the clock stood still or were set back. */
TEST(lives_in_memory_have_no_version_in_common_whatever_the_clock)
{
    enum { LIVES = 200, CHANGES = 100000 };
    static uint64_t first[LIVES];
    for (int i = 0; i < LIVES; i++) {
        struct registry r;
        registry_init(&r);
        registry_begin_life_in_memory(&r);
        uint64_t before = first[i] = registry_version(&r, 0);
        for (int k = 1; k < CHANGES; k++) {
            uint64_t now = registry_version(&r, 0);
            CHECK(now > before && now < UINT64_C(1) << 53);
            before = now;
        }
        for (int k = 0; k < i; k++)
            CHECK(first[k] > before || first[k] + 2 * CHANGES < first[i]);
        registry_clear(&r);
    }
}
