/* array.h - arrays that grow. */
#pragma once

#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>

/* Makes room for n elements of `size` bytes in *array, which has room for *cap. False when out of memory; then it is as before. */
static inline bool array_reserve(void **array, size_t *cap, size_t n, size_t size)
{
    if (n <= *cap)
        return true;
    size_t want = n < 8 ? 16 : 2 * n;
    void *larger =
        n <= SIZE_MAX / 2 && want < SIZE_MAX / size ? realloc(*array, want * size) : NULL;
    if (larger == NULL)
        return false;
    *array = larger;
    *cap = want;
    return true;
}
