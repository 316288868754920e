/* sort.c - by digits, from the last [Knuth, TAOCP 3, sec. 5.2.5]; other items by merging [sec. 5.2.4]; few of them by qsort,
 * which cannot poll. */
#include "core/memory/sort.h"

#include <stdlib.h>
#include <string.h>

#include "core/memory/memory.h"

enum { FEW = 1000, BITS = 11, DIGITS = 1 << BITS };

static int compare_ids(const void *a, const void *b)
{
    uint32_t x = *(const uint32_t *)a, y = *(const uint32_t *)b;
    return x < y ? -1 : x > y;
}

/* The next piece of n ids; false: it is over, or stopped. */
static bool next(struct dt_stop *stop, size_t n, size_t *from, size_t *to)
{
    *from = *to;
    *to = n - *from < DT_POLL ? n : *from + DT_POLL;
    return *from < n && !dt_stopped(stop);
}

static bool is_sorted(const uint32_t *ids, size_t n, struct dt_stop *stop)
{
    bool sorted = true;
    for (size_t a, b = 0; sorted && next(stop, n, &a, &b);)
        for (size_t i = a > 0 ? a : 1; i < b; i++)
            sorted = sorted && ids[i - 1] <= ids[i];
    return sorted;
}

/* Replaces the numbers of items with each digit by the places where these begin. */
static void to_places(size_t at[DIGITS])
{
    for (size_t d = 0, place = 0, here; d < DIGITS; d++, place += here) {
        here = at[d];
        at[d] = place;
    }
}

/* Sorts by the digit at `shift`, into `out`. */
static void by_digit(const uint32_t *ids, size_t n, unsigned shift, uint32_t *out,
                     struct dt_stop *stop)
{
    size_t at[DIGITS] = {0};
    for (size_t a, b = 0; next(stop, n, &a, &b);)
        for (size_t i = a; i < b; i++)
            at[ids[i] >> shift & (DIGITS - 1)]++;
    to_places(at);
    for (size_t a, b = 0; next(stop, n, &a, &b);)
        for (size_t i = a; i < b; i++)
            out[at[ids[i] >> shift & (DIGITS - 1)]++] = ids[i];
}

static void by_digits(uint32_t *ids, size_t n, uint32_t *other, struct dt_stop *stop)
{
    by_digit(ids, n, 0, other, stop);
    by_digit(other, n, BITS, ids, stop);
    by_digit(ids, n, 2 * BITS, other, stop);
    dt_copy(ids, other, n, sizeof *ids, stop);
}

void dt_sort_ids(uint32_t *ids, size_t n, struct dt_pages *pages, struct dt_stop *stop)
{
    if (n < 2 || is_sorted(ids, n, stop))
        return;
    uint32_t *other = n < FEW ? NULL : dt_array_new_in(pages, n, sizeof *other);
    if (other != NULL)
        by_digits(ids, n, other, stop);
    else
        qsort(ids, n, sizeof *ids, compare_ids);
    dt_array_free(other);
}

size_t dt_sort_unique(uint32_t *ids, size_t n, struct dt_pages *pages, struct dt_stop *stop)
{
    size_t kept = 0;
    dt_sort_ids(ids, n, pages, stop);
    for (size_t i = 0; i < n; i++)
        if (kept == 0 || ids[kept - 1] != ids[i])
            ids[kept++] = ids[i];
    return kept;
}

/* ---- keys ---- */

static int compare_keys(const void *a, const void *b)
{
    uint64_t x = *(const uint64_t *)a, y = *(const uint64_t *)b;
    return x < y ? -1 : x > y;
}

/* Sorts by the digit at `shift`, into `out`; false: all have the same one, nothing is done. */
static bool keys_by_digit(const uint64_t *key, size_t n, unsigned shift, uint64_t *out)
{
    size_t at[DIGITS] = {0};
    for (size_t i = 0; i < n; i++)
        at[key[i] >> shift & (DIGITS - 1)]++;
    if (at[key[0] >> shift & (DIGITS - 1)] == n)
        return false;
    to_places(at);
    for (size_t i = 0; i < n; i++)
        out[at[key[i] >> shift & (DIGITS - 1)]++] = key[i];
    return true;
}

void dt_sort_keys(uint64_t *key, size_t n)
{
    uint64_t *other = n < FEW ? NULL : dt_array_new(n, sizeof *other), *from = key, *to = other;
    if (other == NULL) {
        if (n > 1)
            qsort(key, n, sizeof *key, compare_keys);
        return;
    }
    for (unsigned shift = 0; shift < 64; shift += BITS)
        if (keys_by_digit(from, n, shift, to)) {
            uint64_t *swap = from;
            from = to;
            to = swap;
        }
    if (from != key)
        memcpy(key, from, n * sizeof *key);
    dt_array_free(other);
}

size_t dt_sort_unique_keys(uint64_t *key, size_t n)
{
    size_t kept = 0;
    dt_sort_keys(key, n);
    for (size_t i = 0; i < n; i++)
        if (kept == 0 || key[kept - 1] != key[i])
            key[kept++] = key[i];
    return kept;
}

/* ---- items ---- */

struct items {
    size_t size; /* of one */
    int (*compare)(const void *, const void *);
    struct dt_stop *stop;
};

/* Merges the runs a .. b and b .. end into `to`. */
static void merge_runs(const struct items *s, const char *a, const char *b, const char *end,
                       char *to)
{
    const char *middle = b;
    for (size_t i = 1; a < middle && b < end; i++, to += s->size) {
        const char **least = s->compare(b, a) < 0 ? &b : &a;
        memcpy(to, *least, s->size);
        *least += s->size;
        if (i % FEW == 0 && dt_stopped(s->stop))
            return;
    }
    memcpy(to, a, (size_t)(middle - a));
    memcpy(to + (middle - a), b, (size_t)(end - b));
}

static size_t lesser(size_t a, size_t b)
{
    return a < b ? a : b;
}

/* Doubles the runs of `run` bytes, into `to`. */
static void double_runs(const struct items *s, const char *from, size_t bytes, size_t run, char *to)
{
    for (size_t i = 0; i < bytes && !dt_stopped(s->stop); i += 2 * run)
        merge_runs(s, from + i, from + lesser(i + run, bytes), from + lesser(i + 2 * run, bytes),
                   to + i);
}

void dt_sort_items(void *items, size_t n, size_t size, int (*compare)(const void *, const void *),
                   struct dt_stop *stop)
{
    const struct items s = {size, compare, stop};
    if (dt_stopped(
            stop)) /* after another call that was stopped, items may not be fit to be compared */
        return;
    char *other = n < FEW ? NULL : dt_array_new(n, size), *from = items, *to = other;
    if (other == NULL) {
        if (n > 1)
            qsort(items, n, size, compare);
        return;
    }
    const size_t bytes = n * size;
    for (size_t i = 0; i < n && !dt_stopped(stop); i += FEW)
        qsort(from + i * size, lesser(FEW, n - i), size, compare);
    for (size_t run = FEW * size; run < bytes && !dt_stopped(stop); run *= 2) {
        double_runs(&s, from, bytes, run, to);
        char *swap = from;
        from = to;
        to = swap;
    }
    if (from != items)
        dt_copy(items, from, n, size, stop);
    dt_array_free(other);
}

/* ---- search ---- */

bool dt_sorted_have(const uint32_t *ids, size_t n, uint32_t id)
{
    return n > 0 && bsearch(&id, ids, n, sizeof *ids, compare_ids) != NULL;
}
