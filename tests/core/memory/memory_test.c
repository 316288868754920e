/* memory_test.c - arrays small and large. */
#include <stdint.h>
#include <string.h>

#include "core/memory/arena.h"
#include "core/memory/memory.h"
#include "core/memory/sort.h"
#include "tests/core/polls.h"
#include "tests/test.h"

TEST(arrays_keep_their_items_while_they_grow_from_small_to_large)
{
    size_t n = 1000;
    uint32_t *a = dt_array_new(n, sizeof *a);
    for (uint32_t i = 0; i < n; i++)
        a[i] = i * 7;
    while (n < 20u << 20) {
        size_t larger = n * 3 / 2;
        a = dt_array_grow(a, n, larger, sizeof *a);
        CHECK(a != NULL && ((uintptr_t)a & 15) == 0);
        for (uint32_t i = (uint32_t)n; i < larger; i++)
            a[i] = i * 7;
        n = larger;
        for (uint32_t i = 0; i < n; i += 997)
            CHECK(a[i] == i * 7);
    }
    dt_array_free(a);
}

TEST(arrays_too_large_for_the_address_space_are_refused)
{
    CHECK(dt_array_new(SIZE_MAX / 4, 16) == NULL);
    CHECK(dt_array_new((size_t)1 << 60, 1) == NULL);
    char *a = dt_array_new((size_t)8 << 20, 1);
    CHECK(a != NULL);
    memset(a, 5, (size_t)8 << 20);
    CHECK(dt_array_grow(a, (size_t)8 << 20, (size_t)1 << 60, 1) == NULL);
    CHECK(a[(8 << 20) - 1] == 5);
    dt_array_free(a);
    dt_array_free(NULL);
}

TEST(room_grows_by_half_and_stops_at_the_limit)
{
    CHECK(dt_array_room(100, 101, 1000) == 150 && dt_array_room(100, 400, 1000) == 400);
    CHECK(dt_array_room(0, 1, 1000) == 16 && dt_array_room(900, 901, 1000) == 1000);
}

/* ---- sorting ---- */

/* Sorted by the key alone. */
struct item {
    uint32_t key, number;
    char more[3];
};

static int compare_items(const void *a, const void *b)
{
    uint32_t x = ((const struct item *)a)->key, y = ((const struct item *)b)->key;
    return (x > y) - (x < y);
}

static void fill_items(struct item *v, size_t n, uint32_t keys)
{
    for (size_t i = 0; i < n; i++)
        v[i] = (struct item){test_below(keys), (uint32_t)i, {1, 2, (char)i}};
}

TEST(sorted_items_are_in_order_and_all_there)
{
    static const size_t sizes[] = {0, 1, 2, 999, 1000, 1001, 2000, 2001, 3999, 16001, 100000};
    static struct item v[100000];
    for (size_t k = 0; k < 2 * sizeof sizes / sizeof *sizes; k++) {
        size_t n = sizes[k / 2];
        fill_items(v, n, k % 2 == 0 ? 7 : UINT32_MAX);
        uint64_t sum = 0, squares = 0;
        dt_sort_items(v, n, sizeof *v, compare_items, NULL);
        for (size_t i = 0; i < n; i++) {
            CHECK(i == 0 || v[i - 1].key <= v[i].key);
            CHECK(v[i].more[0] == 1 && v[i].more[1] == 2 && v[i].more[2] == (char)v[i].number);
            sum += v[i].number;
            squares += (uint64_t)v[i].number * v[i].number;
        }
        CHECK(n == 0 || (sum == (uint64_t)n * (n - 1) / 2 &&
                         squares == (uint64_t)n * (n - 1) * (2 * n - 1) / 6));
    }
}

TEST(sorting_of_many_items_polls_its_flag)
{
    enum { N = 300000 };
    static struct item v[N];
    atomic_bool cancel = false;
    struct dt_stop stop = {.cancel = &cancel, .left = UINT64_MAX};
    fill_items(v, N, UINT32_MAX);
    polls_begin();
    dt_sort_items(v, N, sizeof *v, compare_items, &stop);
    polls_end();
    CHECK_MSG(polls_longest_ms() < 20, "%g ms", polls_longest_ms());
    uint64_t polls = polls_count();
    CHECK(polls > N / 1000);
    for (uint64_t n = 1; n <= polls; n += polls / 7 + 1) {
        fill_items(v, N, UINT32_MAX);
        stop = (struct dt_stop){.cancel = &cancel, .left = UINT64_MAX};
        polls_cancel_at(n);
        dt_sort_items(v, N, sizeof *v, compare_items, &stop);
        CHECK(dt_stop_status(&stop) == DT_CANCELLED);
    }
    polls_cancel_at(0);
}

/* ---- arenas ---- */

/* Takes arrays of random sizes, writes to all of their bytes and gives them back in stack order. */
static void use_arena(struct dt_arena *a, unsigned depth)
{
    struct dt_arena_mark mark = dt_arena_mark(a);
    for (unsigned i = 0; i < 6; i++) {
        size_t n = test_below(3) == 0 ? test_below(40000) : test_below(300);
        unsigned char *p = dt_arena_take(a, n, 1), *q = dt_arena_take(a, 1, 16);
        CHECK(p != NULL && q != NULL && (uintptr_t)p % 16 == 0 && (uintptr_t)q % 16 == 0);
        memset(p, (int)depth + 1, n);
        memset(q, 0xff, 16);
        if (depth < 4)
            use_arena(a, depth + 1);
        for (size_t k = 0; k < n; k++)
            CHECK(p[k] == depth + 1);
    }
    dt_arena_return(a, mark);
}

TEST(arena_allocates_only_its_own_free_memory)
{
    struct dt_arena a = {0};
    test_guard_alloc(true);
    use_arena(&a, 0);
    for (size_t taken = 0; taken < 300000; taken += 16) /* to the last byte of its chunks */
        memset(dt_arena_take(&a, 1, 16), 7, 16);
    CHECK(dt_arena_take(&a, SIZE_MAX / 4, 16) == NULL);
    dt_arena_clear(&a);
}

TEST(keys_are_sorted_by_all_of_their_bits)
{
    static const size_t sizes[] = {0, 1, 2, 999, 1000, 5000};
    for (size_t k = 0; k < sizeof sizes / sizeof *sizes; k++)
        for (unsigned shift = 0; shift < 64; shift += 9) {
            uint64_t key[5000], sum = 0;
            for (size_t i = 0; i < sizes[k]; i++)
                sum += key[i] = test_random() >> shift;
            dt_sort_keys(key, sizes[k]);
            for (size_t i = 0; i < sizes[k]; i++)
                sum -= key[i];
            for (size_t i = 1; i < sizes[k]; i++)
                CHECK(key[i - 1] <= key[i]);
            CHECK(sum == 0);
        }
}
