/* memory_test.c - arrays small and large. */
#include <stdint.h>
#include <string.h>

#include "core/memory.h"
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

TEST(freed_arrays_serve_the_next_ones)
{
    size_t mib = (size_t)1 << 20, before = dt_memory_spare();
    char *a = dt_array_new(64 * mib, 1);
    CHECK(a != NULL);
    memset(a, 1, 64 * mib);
    size_t taken = dt_memory_spare(); /* less than before, if a found room among spare ranges */
    CHECK(taken <= before);
    dt_array_free(a);
    CHECK(dt_memory_spare() >= taken + 64 * mib);
    char *b = dt_array_new(20 * mib, 1), *c = dt_array_new(20 * mib, 1);
    CHECK(b != NULL && c != NULL && (b + 20 * mib <= c || c + 20 * mib <= b));
    memset(b, 2, 20 * mib);
    memset(c, 3, 20 * mib);
    CHECK(b[0] == 2 && b[20 * mib - 1] == 2 && c[0] == 3 && c[20 * mib - 1] == 3);
    CHECK(dt_memory_spare() <= taken + 24 * mib);
    dt_array_free(b);
    dt_array_free(c);
}

TEST(spare_memory_has_a_limit)
{
    size_t mib = (size_t)1 << 20;
    char *a[100];
    for (size_t round = 0; round < 2; round++) {
        for (size_t i = 0; i < 100; i++) {
            a[i] = dt_array_new((4 + 3 * (i % 7)) * mib, 1);
            CHECK(a[i] != NULL);
            a[i][0] = 'x';
        }
        for (size_t i = 0; i < 100; i++)
            dt_array_free(a[i]);
        CHECK(dt_memory_spare() > 64 * mib && dt_memory_spare() <= 512 * mib);
    }
    char *huge = dt_array_new(600 * mib, 1);
    CHECK(huge != NULL);
    huge[0] = 'x';
    size_t spare = dt_memory_spare();
    dt_array_free(huge); /* too large to be kept */
    CHECK(dt_memory_spare() == spare);
}
