/* bounds.h - the box around places. */
#pragma once

#include <math.h>
#include <stdbool.h>
#include <stddef.h>

/* The box x0, y0, x1, y1 around the places xy[2n]; false if there are none, and then box is as before. */
static inline bool bounds_of(const double *xy, size_t n, double box[4])
{
    for (size_t i = 0; i < 2 * n; i++) {
        double *low = &box[i % 2], *high = &box[2 + i % 2];
        *low = i < 2 ? xy[i] : fmin(*low, xy[i]);
        *high = i < 2 ? xy[i] : fmax(*high, xy[i]);
    }
    return n > 0;
}
