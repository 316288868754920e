/* families.c - the families of point sets.
 *
 * Sources of the hostile ones: exact circles are the lattice points of x^2 + y^2 = R^2 for an R with many prime factors
 * 4k + 1. These points are all products of Gaussian primes of norm R^2. Kuzmin's
 * disc is a model of a galaxy from astronomy. The others have broken other programs. */
#include "tests/oracle/families.h"

#include <math.h>
#include <string.h>

#define TAU 6.283185307179586

static uint64_t next_random(uint64_t *state) /* splitmix64 [Steele, Lea & Flood 2014] */
{
    uint64_t z = (*state += 0x9E3779B97F4A7C15u);
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9u;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBu;
    return z ^ (z >> 31);
}

static size_t below(uint64_t *r, size_t n)
{
    return (size_t)(next_random(r) % n);
}

static double unit(uint64_t *r) /* in [0, 1) */
{
    return (double)(next_random(r) >> 11) * 0x1p-53;
}

/* A pair of independent standard normals [Box & Muller 1958]. */
static struct dt_point normal_pair(uint64_t *r)
{
    double radius = sqrt(-2 * log(1 - unit(r))), angle = TAU * unit(r);
    return (struct dt_point){radius * cos(angle), radius * sin(angle)};
}

static void shuffle(struct dt_point *p, size_t n, uint64_t *r)
{
    for (size_t i = n; i > 1; i--) {
        size_t j = below(r, i);
        struct dt_point swap = p[i - 1];
        p[i - 1] = p[j];
        p[j] = swap;
    }
}

/* Columns of the squarest lattice of n points. */
static size_t side(size_t n)
{
    size_t s = (size_t)sqrt((double)n);
    return s * s < n ? s + 1 : s == 0 ? 1 : s;
}

static void scale_and_shift(struct dt_point *p, size_t n, double scale, double shift)
{
    for (size_t i = 0; i < n; i++)
        p[i] = (struct dt_point){p[i].x * scale + shift, p[i].y * scale + shift};
}

/* ---- easy ones ---- */

static void fill_uniform(struct dt_point *p, size_t n, uint64_t *r)
{
    for (size_t i = 0; i < n; i++) {
        p[i].x = unit(r);
        p[i].y = unit(r);
    }
}

static void fill_gaussian(struct dt_point *p, size_t n, uint64_t *r)
{
    for (size_t i = 0; i < n; i++)
        p[i] = normal_pair(r);
}

static void fill_clusters(struct dt_point *p, size_t n, uint64_t *r)
{
    struct dt_point centre[100];
    fill_uniform(centre, 100, r);
    for (size_t i = 0; i < n; i++) {
        struct dt_point c = centre[below(r, 100)], d = normal_pair(r);
        p[i] = (struct dt_point){c.x + 1e-3 * d.x, c.y + 1e-3 * d.y};
    }
}

static void fill_kuzmin(struct dt_point *p, size_t n, uint64_t *r)
{
    for (size_t i = 0; i < n; i++) {
        double q = 1 - unit(r), angle = TAU * unit(r), radius = sqrt(1 / (q * q) - 1);
        p[i] = (struct dt_point){radius * cos(angle), radius * sin(angle)};
    }
}

static void fill_spiral(struct dt_point *p, size_t n, uint64_t *r)
{
    double turn = unit(r);
    for (size_t i = 0; i < n; i++) {
        double radius = sqrt((double)i + 1), angle = TAU * turn + radius;
        p[i] = (struct dt_point){radius * cos(angle), radius * sin(angle)};
    }
}

/* ---- lattices: cocircular points everywhere ---- */

static void fill_lattice(struct dt_point *p, size_t n, uint64_t *r)
{
    size_t s = side(n);
    (void)r;
    for (size_t i = 0; i < n; i++)
        p[i] = (struct dt_point){(double)(i % s), (double)(i / s)};
}

static void fill_lattice_shuffled(struct dt_point *p, size_t n, uint64_t *r)
{
    fill_lattice(p, n, r);
    shuffle(p, n, r);
}

/* Rounded coordinates: nearly cocircular, nearly collinear. */
static void fill_lattice_rotated(struct dt_point *p, size_t n, uint64_t *r)
{
    double c = cos(0.5 + unit(r)), s = sqrt(1 - c * c);
    fill_lattice_shuffled(p, n, r);
    for (size_t i = 0; i < n; i++)
        p[i] = (struct dt_point){c * p[i].x - s * p[i].y, s * p[i].x + c * p[i].y};
}

/* 0.1, 0.2, 0.30000000000000004, ...: what people take for a lattice. */
static void fill_tenths(struct dt_point *p, size_t n, uint64_t *r)
{
    fill_lattice_shuffled(p, n, r);
    scale_and_shift(p, n, 0.1, 0);
}

/* Random lattice points, half as many places as points: ties, holes and duplicates. */
static void fill_small_lattice(struct dt_point *p, size_t n, uint64_t *r)
{
    size_t s = side(n / 2 + 1);
    for (size_t i = 0; i < n; i++) {
        p[i].x = (double)below(r, s);
        p[i].y = (double)below(r, s);
    }
}

static void fill_ulp_grid(struct dt_point *p, size_t n, uint64_t *r)
{
    size_t s = 2 * side(n);
    for (size_t i = 0; i < n; i++) {
        p[i].x = 1 + (double)below(r, s) * 0x1p-52;
        p[i].y = 1 + (double)below(r, s) * 0x1p-52;
    }
}

/* ---- circles ---- */

struct gaussian_integer {
    int64_t re, im;
};

static struct gaussian_integer multiply(struct gaussian_integer a, struct gaussian_integer b)
{
    return (struct gaussian_integer){a.re * b.re - a.im * b.im, a.re * b.im + a.im * b.re};
}

#define CIRCLE_POINTS (4u * 7 * 5 * 3 * 3 * 3 * 3 * 3 * 3)

/* The index-th of the lattice points on the circle of radius 5^3 13^2 17 29 37 41 53 61 (about 5e13). For each prime
 * p = a^2 + b^2 of exponent e, it chooses how many of the 2e factors are a + bi; the others are
 * a - bi. */
static struct dt_point on_exact_circle(unsigned index)
{
    static const struct {
        int8_t re, im, exponent;
    } prime[] = {{2, 1, 3}, {3, 2, 2}, {4, 1, 1}, {5, 2, 1},
                 {6, 1, 1}, {5, 4, 1}, {7, 2, 1}, {6, 5, 1}};
    static const struct gaussian_integer turn[] = {{1, 0}, {0, 1}, {-1, 0}, {0, -1}};
    struct gaussian_integer z = turn[index % 4];
    index /= 4;
    for (size_t i = 0; i < sizeof prime / sizeof prime[0]; i++) {
        unsigned factors = 2 * (unsigned)prime[i].exponent, plain = index % (factors + 1);
        index /= factors + 1;
        for (unsigned k = 0; k < factors; k++)
            z = multiply(
                z, (struct gaussian_integer){prime[i].re, k < plain ? prime[i].im : -prime[i].im});
    }
    return (struct dt_point){(double)z.re, (double)z.im};
}

/* Distinct points; when one circle is used up, the next has twice its radius. */
static void fill_circle_exact(struct dt_point *p, size_t n, uint64_t *r)
{
    const size_t stride = 30011; /* a prime that does not divide CIRCLE_POINTS */
    size_t start = below(r, CIRCLE_POINTS);
    for (size_t i = 0; i < n; i++) {
        struct dt_point q = on_exact_circle((unsigned)((start + i * stride) % CIRCLE_POINTS));
        int circle = (int)(i / CIRCLE_POINTS);
        p[i] = (struct dt_point){ldexp(q.x, circle), ldexp(q.y, circle)};
    }
}

static void fill_circle(struct dt_point *p, size_t n, uint64_t *r)
{
    for (size_t i = 0; i < n; i++) {
        double angle = TAU * unit(r);
        p[i] = (struct dt_point){cos(angle), sin(angle)};
    }
}

/* One point that is a neighbour of all others. */
static void fill_wheel(struct dt_point *p, size_t n, uint64_t *r)
{
    fill_circle_exact(p, n, r);
    if (n > 0)
        p[below(r, n)] = (struct dt_point){0, 0};
}

/* ---- lines and near-lines ---- */

static void fill_line_axis(struct dt_point *p, size_t n, uint64_t *r)
{
    for (size_t i = 0; i < n; i++)
        p[i] = (struct dt_point){unit(r), 0.25};
}

static void fill_line_diagonal(struct dt_point *p, size_t n, uint64_t *r)
{
    for (size_t i = 0; i < n; i++)
        p[i] = (struct dt_point){(double)i, 3 * (double)i - 5};
    shuffle(p, n, r);
}

/* On y = x up to one unit in the last place. */
static void fill_near_collinear(struct dt_point *p, size_t n, uint64_t *r)
{
    for (size_t i = 0; i < n; i++) {
        double x = 0.5 + unit(r) / 2;
        p[i] = (struct dt_point){x, x + ((double)below(r, 3) - 1) * 0x1p-53};
    }
}

/* On y = 0.3 x up to a billionth of its length. */
static void fill_thin_line(struct dt_point *p, size_t n, uint64_t *r)
{
    for (size_t i = 0; i < n; i++) {
        double x = unit(r);
        p[i] = (struct dt_point){x, 0.3 * x + 1e-9 * unit(r)};
    }
}

static void fill_two_lines(struct dt_point *p, size_t n, uint64_t *r)
{
    for (size_t i = 0; i < n; i++)
        p[i] = (struct dt_point){(double)(i / 2), (double)(i % 2)};
    shuffle(p, n, r);
}

static void fill_cross(struct dt_point *p, size_t n, uint64_t *r)
{
    for (size_t i = 0; i < n; i++) {
        double at = 2 * unit(r) - 1;
        p[i] = i % 2 == 0 ? (struct dt_point){at, 0} : (struct dt_point){0, at};
    }
}

/* Every point on the hull. */
static void fill_parabola(struct dt_point *p, size_t n, uint64_t *r)
{
    for (size_t i = 0; i < n; i++) {
        double x = (double)i - (double)(n / 2);
        p[i] = (struct dt_point){x, x * x};
    }
    shuffle(p, n, r);
}

/* ---- coincident points ---- */

static void fill_duplicates(struct dt_point *p, size_t n, uint64_t *r)
{
    size_t distinct = (n + 1) / 2;
    fill_uniform(p, distinct, r);
    for (size_t i = distinct; i < n; i++)
        p[i] = p[below(r, distinct)];
    shuffle(p, n, r);
}

static void fill_same_place(struct dt_point *p, size_t n, uint64_t *r)
{
    struct dt_point q = {unit(r), unit(r)};
    for (size_t i = 0; i < n; i++)
        p[i] = q;
}

/* ---- scales ---- */

static void fill_far_1e8(struct dt_point *p, size_t n, uint64_t *r)
{
    fill_uniform(p, n, r);
    scale_and_shift(p, n, 1, 1e8);
}

/* Units in the last place are 1/8 here: ties and coincident points. */
static void fill_far_1e15(struct dt_point *p, size_t n, uint64_t *r)
{
    fill_uniform(p, n, r);
    scale_and_shift(p, n, 10, 1e15);
}

static void fill_outlier(struct dt_point *p, size_t n, uint64_t *r)
{
    fill_uniform(p, n, r);
    if (n > 0)
        p[below(r, n)] = (struct dt_point){1e9, -3e8};
}

static void fill_outliers(struct dt_point *p, size_t n, uint64_t *r)
{
    fill_uniform(p, n, r);
    for (size_t i = 0; i < n; i += n / 7 + 1) {
        double angle = TAU * unit(r), radius = pow(10, 3 + 9 * unit(r));
        p[i] = (struct dt_point){radius * cos(angle), radius * sin(angle)};
    }
}

/* The same number of points at each distance from the origin, from 1 to 1e-12. */
static void fill_nested(struct dt_point *p, size_t n, uint64_t *r)
{
    for (size_t i = 0; i < n; i++) {
        double angle = TAU * unit(r), radius = pow(10, -12 * unit(r));
        p[i] = (struct dt_point){radius * cos(angle), radius * sin(angle)};
    }
}

/* The same around (1/3, 1/3), where doubles are too coarse for the smallest distances. */
static void fill_nested_shifted(struct dt_point *p, size_t n, uint64_t *r)
{
    fill_nested(p, n, r);
    scale_and_shift(p, n, 1, 1.0 / 3);
}

/* Half of the points are in one cell of any grid. */
static void fill_one_cell(struct dt_point *p, size_t n, uint64_t *r)
{
    fill_uniform(p, n, r);
    scale_and_shift(p, n / 2, 1e-9, 0.7);
    shuffle(p, n, r);
}

static void fill_wide(struct dt_point *p, size_t n, uint64_t *r)
{
    for (size_t i = 0; i < n; i++) {
        p[i].x = 1e6 * unit(r);
        p[i].y = 1e-6 * unit(r);
    }
}

static void fill_tall(struct dt_point *p, size_t n, uint64_t *r)
{
    for (size_t i = 0; i < n; i++) {
        p[i].x = 1e-6 * unit(r);
        p[i].y = 1e6 * unit(r);
    }
}

static double of_magnitude(uint64_t *r, int lowest, int highest)
{
    int exponent = lowest + (int)below(r, (size_t)(highest - lowest));
    double v = ldexp(1 + unit(r), exponent);
    return next_random(r) % 2 == 0 ? v : -v;
}

/* Magnitudes of all sizes that the predicates accept, 2^-142 to 2^201. */
static void fill_exponents(struct dt_point *p, size_t n, uint64_t *r)
{
    for (size_t i = 0; i < n; i++) {
        p[i].x = of_magnitude(r, -142, 201);
        p[i].y = of_magnitude(r, -142, 201);
    }
}

static void fill_tiny(struct dt_point *p, size_t n, uint64_t *r)
{
    for (size_t i = 0; i < n; i++) {
        p[i].x = of_magnitude(r, -142, -139);
        p[i].y = of_magnitude(r, -142, -139);
    }
}

static void fill_huge(struct dt_point *p, size_t n, uint64_t *r)
{
    for (size_t i = 0; i < n; i++) {
        p[i].x = of_magnitude(r, 198, 201);
        p[i].y = of_magnitude(r, 198, 201);
    }
}

const struct family families[] = {
    {"uniform", "in the unit square", false, fill_uniform},
    {"gaussian", "a normal distribution", false, fill_gaussian},
    {"clusters", "100 normal clusters, sigma 1e-3", false, fill_clusters},
    {"kuzmin", "Kuzmin's disc: dense centre, far outskirts", true, fill_kuzmin},
    {"spiral", "one long spiral", false, fill_spiral},
    {"lattice", "integer lattice, row by row", false, fill_lattice},
    {"lattice_shuffled", "integer lattice in random order", false, fill_lattice_shuffled},
    {"lattice_rotated", "lattice rotated and rounded", false, fill_lattice_rotated},
    {"tenths", "lattice of multiples of 0.1", false, fill_tenths},
    {"small_lattice", "random lattice points, many twice", false, fill_small_lattice},
    {"ulp_grid", "units in the last place around 1", false, fill_ulp_grid},
    {"circle_exact", "integer points exactly on one circle", true, fill_circle_exact},
    {"circle", "on a circle, rounded", true, fill_circle},
    {"wheel", "exactly on a circle, and its centre", true, fill_wheel},
    {"line_axis", "all on a horizontal line", true, fill_line_axis},
    {"line_diagonal", "all on a line of slope 3", true, fill_line_diagonal},
    {"near_collinear", "a line up to one unit in the last place", true, fill_near_collinear},
    {"thin_line", "a line of slope 0.3, 1e-9 thick", true, fill_thin_line},
    {"two_lines", "two parallel lines of lattice points", true, fill_two_lines},
    {"cross", "both axes", true, fill_cross},
    {"parabola", "on a parabola, all on the hull", true, fill_parabola},
    {"duplicates", "uniform, half of them coincident", false, fill_duplicates},
    {"same_place", "all coincident", false, fill_same_place},
    {"far_1e8", "unit square, 1e8 away from the origin", false, fill_far_1e8},
    {"far_1e15", "square of 10, 1e15 away from the origin", false, fill_far_1e15},
    {"outlier", "uniform, one point at 1e9", true, fill_outlier},
    {"outliers", "uniform, seven points at 1e3 to 1e12", true, fill_outliers},
    {"nested", "scales 1 to 1e-12 around the origin", true, fill_nested},
    {"nested_shifted", "scales 1 to 1e-12 around (1/3, 1/3)", true, fill_nested_shifted},
    {"one_cell", "uniform, half of them within 1e-9", true, fill_one_cell},
    {"wide", "1e6 wide and 1e-6 high", true, fill_wide},
    {"tall", "1e-6 wide and 1e6 high", true, fill_tall},
    {"exponents", "magnitudes 2^-142 to 2^201", true, fill_exponents},
    {"tiny", "magnitudes near 2^-142", false, fill_tiny},
    {"huge", "magnitudes near 2^201", false, fill_huge},
    {NULL, NULL, false, NULL},
};

const struct family *family_find(const char *name)
{
    for (const struct family *f = families; f->name != NULL; f++)
        if (strcmp(f->name, name) == 0)
            return f;
    return NULL;
}

void family_points(const struct family *f, struct dt_point *p, size_t n, uint64_t seed)
{
    uint64_t random = seed;
    f->fill(p, n, &random);
}
