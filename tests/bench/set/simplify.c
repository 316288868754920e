/* simplify.c - seconds to thin out a raster, or random points of its surface, to an error: a line `points error seconds` for each.
 *
 *     simplify SIDE ERROR RUNS [random]
 *
 * The surface is a sum of nine octaves of value noise, each with 0.47 of the last one's amplitude, as beside_delatin.mjs has it.
 * The least of the runs counts; of processor time. */
#include "core/delaunay_thinning.h"
#include "tests/bench/measure.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static double hash(int32_t x, int32_t y)
{
    uint32_t h = (uint32_t)x * 374761393u + (uint32_t)y * 668265263u;
    h = (h ^ h >> 13) * 1274126177u;
    return (h ^ h >> 16) / 4294967296.0;
}

static double smooth(double t)
{
    return t * t * t * (t * (6 * t - 15) + 10);
}

static double noise(double x, double y)
{
    int32_t i = (int32_t)floor(x), j = (int32_t)floor(y);
    double u = smooth(x - i), v = smooth(y - j);
    double a = hash(i, j), b = hash(i + 1, j), c = hash(i, j + 1), d = hash(i + 1, j + 1);
    return a + (b - a) * u + (c - a) * v + (a - b - c + d) * u * v;
}

static double height(double x, double y, double side)
{
    double sum = 0, amplitude = 500, frequency = 4 / side;
    for (int octave = 0; octave < 9; octave++) {
        sum += amplitude * noise(x * frequency + octave * 17, y * frequency + octave * 31);
        amplitude *= 0.47;
        frequency *= 2;
    }
    return sum;
}

static double random_below(double most)
{
    return most * (double)rand() / RAND_MAX;
}

int main(int argc, char **argv)
{
    const uint32_t side = argc > 3 ? (uint32_t)atoi(argv[1]) : 0, n = side * side;
    struct dt_point *p = malloc((n + 1) * sizeof *p);
    double *z = malloc((n + 1) * sizeof *z), least = HUGE_VAL;
    struct dt_thinned out = {0};
    if (side < 2 || p == NULL || z == NULL)
        return 2;
    for (uint32_t i = 0; i < n; i++) {
        bool random = argc > 4;
        p[i].x = random ? random_below(side - 1) : i % side;
        p[i].y = random ? random_below(side - 1) : i / side;
        z[i] = height(p[i].x, p[i].y, side);
    }
    struct dt_pages *pages = dt_pages_new(SIZE_MAX);
    const struct dt_thinning in = {
        .point = p, .value = z, .n = n, .error = atof(argv[2]), .most = UINT32_MAX, .pages = pages};
    for (int run = 0; run < atoi(argv[3]); run++) {
        double start = measure_cpu();
        if (dt_thin(&in, NULL, &out) != DT_OK)
            return 1;
        least = fmin(least, measure_cpu() - start);
        dt_pages_release(out.kept);
    }
    printf("%u %.17g %.3f\n", out.n, out.error, least);
    dt_pages_free(pages);
    free(p);
    free(z);
    return 0;
}
