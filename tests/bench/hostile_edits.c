/* hostile_edits.c - the promise: no edit costs more than 10 times the same edit of uniform points. There are two
 * exceptions: edits that change or examine a triangle for each neighbour of a vertex; the first edit of a large
 * set, which builds an index.
 *
 * Three kinds of sets: a hundred thousand coincident points, with a tolerance and without; a hub, with all
 * other points on a circle around it; coordinates most of whose bits are zeros. Each round builds both sets
 * again, the hostile one and a set of the same number of uniform points, and the best round counts. */
#include "tests/bench/hostile_edits.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "core/delaunay.h"
#include "tests/bench/measure.h"

enum { ROUNDS = 3, GROUP = 400000, RIM = 200000, UNITED = 40000, LARGE = 1000000 };

static const double turn = 6.283185307179586;

static uint64_t state;

static double uniform(void)
{
    state = state * 6364136223846793005u + 1442695040888963407u;
    return (double)(state >> 11) * 0x1p-53;
}

static struct dt_point anywhere(void)
{
    double x = uniform();
    return (struct dt_point){x, uniform()};
}

static void must(bool ok)
{
    if (ok)
        return;
    fprintf(stderr, "hostile_edits: out of memory, or an edit was refused\n");
    exit(1);
}

/* ---- operations, done k times at places or to ids; each function returns nanoseconds per operation ---- */

enum { MANY = 20000 };

static struct dt_point to[MANY];
static uint32_t who[MANY];

static double ns_since(double start, uint32_t k)
{
    return (measure_cpu() - start) / k * 1e9;
}

static double add(struct dt *t, uint32_t k)
{
    struct dt_added added;
    double start = measure_cpu();
    for (uint32_t i = 0; i < k; i++)
        must(dt_add(t, &to[i], 1, &added) == DT_OK);
    return ns_since(start, k);
}

static double delete (struct dt *t, uint32_t k)
{
    uint32_t deleted, missing;
    double start = measure_cpu();
    for (uint32_t i = 0; i < k; i++)
        must(dt_delete(t, &who[i], 1, &deleted, &missing) == DT_OK);
    return ns_since(start, k);
}

static double move(struct dt *t, uint32_t k)
{
    double start = measure_cpu();
    for (uint32_t i = 0; i < k; i++)
        must(dt_move(t, who[i], to[i]) == DT_OK);
    return ns_since(start, k);
}

static double nearest(const struct dt *t, uint32_t k, uint32_t points)
{
    struct dt_ids ids = {0};
    double start = measure_cpu();
    for (uint32_t i = 0; i < k; i++) {
        ids.n = 0;
        must(dt_nearest(t, to[i], points, &ids) == DT_OK);
    }
    free(ids.v);
    return ns_since(start, k);
}

static double locate(const struct dt *t, uint32_t k)
{
    struct dt_location at;
    double start = measure_cpu();
    for (uint32_t i = 0; i < k; i++)
        must(dt_locate(t, to[i], &at) == DT_OK);
    return ns_since(start, k);
}

/* ---- sets ---- */

struct points {
    struct dt_point *p; /* owns */
    uint32_t n;
};

static struct points new_points(uint32_t n)
{
    struct points s = {malloc(n * sizeof *s.p), n};
    must(s.p != NULL);
    return s;
}

/* Takes ownership of the points. */
static struct dt *new_set(struct points s, double tol, bool live)
{
    struct dt *t = dt_new(tol);
    struct dt_added added;
    must(t != NULL && dt_add(t, s.p, s.n, &added) == DT_OK);
    must(!live || (dt_triangulate(t, NULL) == DT_OK && dt_prepare(t, NULL) == DT_OK));
    free(s.p);
    return t;
}

static struct dt *uniform_set(uint32_t n, double tol, bool live)
{
    struct points s = new_points(n);
    for (uint32_t i = 0; i < n; i++)
        s.p[i] = anywhere();
    return new_set(s, tol, live);
}

/* Half of them coincide in the middle; they come first. */
static struct dt *crowded_set(double tol)
{
    struct points s = new_points(2 * GROUP);
    for (uint32_t i = 0; i < s.n; i++)
        s.p[i] = i < GROUP ? (struct dt_point){0.5, 0.5} : anywhere();
    return new_set(s, tol, true);
}

static struct dt_point on_rim(double angle, double radius)
{
    double x = radius * cos(angle), y = radius * sin(angle);
    return (struct dt_point){x, y};
}

/* The hub is point 0. */
static struct dt *wheel_set(void)
{
    struct points s = new_points(RIM + 1);
    s.p[0] = (struct dt_point){0, 0};
    for (uint32_t i = 1; i <= RIM; i++)
        s.p[i] = on_rim(turn * i / RIM, 1);
    return new_set(s, 0, true);
}

/* ---- rows: the cost of an operation on a hostile set or on a uniform one ---- */

/* Frees the set. */
static double done(struct dt *t, double ns)
{
    dt_free(t);
    return ns;
}

static void go_anywhere(void)
{
    for (uint32_t i = 0; i < MANY; i++)
        to[i] = anywhere();
}

static void go_to_group(bool hostile)
{
    go_anywhere();
    for (uint32_t i = 0; hostile && i < MANY; i++)
        to[i] = (struct dt_point){0.5, 0.5};
}

/* Distinct ids from `first` on, a stride apart. */
static void choose(uint32_t first, uint32_t stride, uint32_t n)
{
    for (uint32_t i = 0; i < MANY; i++)
        who[i] = first + (uint32_t)((uint64_t)i * stride % n);
}

static struct dt *crowd_or_not(bool hostile, double tol)
{
    return hostile ? crowded_set(tol) : uniform_set(2 * GROUP, tol, true);
}

static double add_to_group(bool hostile)
{
    struct dt *t = crowd_or_not(hostile, 0);
    go_to_group(hostile);
    return done(t, add(t, MANY));
}

/* The lowest id represents its group, so each of these has a successor. */
static double delete_representatives(bool hostile)
{
    struct dt *t = crowd_or_not(hostile, 0);
    choose(0, 1, GROUP);
    return done(t, delete (t, MANY));
}

static double delete_tolerant(bool hostile)
{
    struct dt *t = crowd_or_not(hostile, 1e-12);
    choose(0, 1, GROUP);
    return done(t, delete (t, MANY));
}

static double delete_anyone(bool hostile)
{
    struct dt *t = crowd_or_not(hostile, 1e-12);
    choose(0, 7919, GROUP);
    return done(t, delete (t, MANY));
}

static double move_into_group(bool hostile)
{
    struct dt *t = crowd_or_not(hostile, 0);
    choose(GROUP, 7919, GROUP);
    go_to_group(hostile);
    return done(t, move(t, MANY));
}

static double move_out_of_group(bool hostile)
{
    struct dt *t = crowd_or_not(hostile, 0);
    choose(0, 7919, GROUP);
    go_anywhere();
    return done(t, move(t, MANY));
}

/* Places that are less than the tolerance apart. The first b is an alias of c, the first a of r; when c is
 * deleted, b represents; when r is deleted, its successor is at the place of b.
 *
 *      r <--0.9--> a, b <--0.95--> c
 */
static double unite_groups(bool hostile)
{
    if (!hostile)
        return delete_tolerant(false);
    struct points s = new_points(2 * UNITED + 2);
    s.p[0] = (struct dt_point){1.85, 0};
    for (uint32_t i = 1; i < s.n; i++)
        s.p[i] = (struct dt_point){i == UNITED + 1 ? 0 : 0.9, 0};
    struct dt *t = new_set(s, 1, true);
    who[0] = 0;
    (void)delete (t, 1);
    who[0] = UNITED + 1;
    return done(t, delete (t, 1));
}

static struct dt *wheel_or_not(bool hostile)
{
    return hostile ? wheel_set() : uniform_set(RIM + 1, 0, true);
}

/* Places inside the wheel, every other one close to the hub. */
static void go_inside(bool hostile)
{
    go_anywhere();
    for (uint32_t i = 0; hostile && i < MANY; i++)
        to[i] = on_rim(turn * uniform(), i % 2 == 0 ? uniform() : 1e-3);
}

static void go_to_rim(bool hostile)
{
    go_anywhere();
    for (uint32_t i = 0; hostile && i < MANY; i++)
        to[i] = on_rim(turn * uniform(), 1);
}

static double nearest_one(bool hostile)
{
    struct dt *t = wheel_or_not(hostile);
    go_inside(hostile);
    return done(t, nearest(t, 2000, 1));
}

static double nearest_two(bool hostile)
{
    struct dt *t = wheel_or_not(hostile);
    go_inside(hostile);
    return done(t, nearest(t, hostile ? 50 : 2000, 2));
}

static double locate_in_wheel(bool hostile)
{
    struct dt *t = wheel_or_not(hostile);
    go_inside(hostile);
    return done(t, locate(t, 2000));
}

static double add_on_rim(bool hostile)
{
    struct dt *t = wheel_or_not(hostile);
    go_to_rim(hostile);
    return done(t, add(t, MANY));
}

static double delete_of_rim(bool hostile)
{
    struct dt *t = wheel_or_not(hostile);
    choose(1, 7919, RIM);
    return done(t, delete (t, MANY));
}

static double move_on_rim(bool hostile)
{
    struct dt *t = wheel_or_not(hostile);
    choose(1, 7919, RIM);
    go_to_rim(hostile);
    return done(t, move(t, MANY));
}

static double add_beside_hub(bool hostile)
{
    enum { K = 10 };
    struct dt *t = wheel_or_not(hostile);
    double ns = 0;
    go_inside(hostile);
    if (!hostile)
        return done(t, add(t, MANY));
    for (uint32_t i = 0; i < K; i++) {
        to[0] = to[i];
        ns += add(t, 1) / K;
        who[0] = dt_next_id(t) - 1;
        (void)delete (t, 1);
    }
    return done(t, ns);
}

static double delete_hub(bool hostile)
{
    struct dt *t = wheel_or_not(hostile);
    choose(0, 1, RIM);
    return done(t, delete (t, hostile ? 1 : MANY));
}

/* Adds to a set that is not triangulated and has no points yet. */
static double add_with(bool hostile, struct dt_point (*place)(uint32_t i))
{
    struct dt *t = dt_new(0);
    must(t != NULL);
    go_anywhere();
    for (uint32_t i = 0; hostile && i < MANY; i++)
        to[i] = place(i);
    return done(t, add(t, MANY));
}

static struct dt_point on_axis(uint32_t i)
{
    return (struct dt_point){3, i * 0x1p40};
}

static struct dt_point on_lattice(uint32_t i)
{
    return (struct dt_point){i % 128 * 0x1p100, i / 128 * 0x1p-100};
}

static double add_on_axis(bool hostile)
{
    return add_with(hostile, on_axis);
}

static double add_on_lattice(bool hostile)
{
    return add_with(hostile, on_lattice);
}

/* Adds to a large set that is not triangulated: the index of places is built. */
static double add_first(bool hostile)
{
    struct dt *t = uniform_set(LARGE, 0, false);
    go_anywhere();
    double first = add(t, 1);
    return done(t, hostile ? first : add(t, MANY));
}

struct row {
    const char *name;
    double (*ns)(bool hostile);
    const char *reason; /* why it costs more */
};

static const struct row rows[] = {
    {"ADD to 400,000 points at one place", add_to_group, ""},
    {"DEL of their representative, 20,000 times", delete_representatives, ""},
    {"the same with TOL", delete_tolerant, ""},
    {"DEL of any of them, with TOL", delete_anyone, ""},
    {"MOVE to where they are", move_into_group, ""},
    {"MOVE away", move_out_of_group, ""},
    {"DEL that makes two groups of 40,000 one", unite_groups, ""},
    {"NEAREST in a wheel of 200,000", nearest_one, "the root of the number of triangles"},
    {"NEAREST 2", nearest_two, "all neighbours may be as near"},
    {"LOCATE", locate_in_wheel, "the root of the number of triangles"},
    {"ADD on the rim", add_on_rim, ""},
    {"DEL on the rim", delete_of_rim, ""},
    {"MOVE along the rim", move_on_rim, ""},
    {"ADD inside", add_beside_hub, "replaces as many triangles as it gets neighbours"},
    {"DEL of the hub", delete_hub, "replaces as many triangles as it had neighbours"},
    {"ADD with x = 3, y = m 2^40", add_on_axis, ""},
    {"ADD with x = k 2^100, y = m 2^-100", add_on_lattice, ""},
    {"the first ADD to 1,000,000 points, not triangulated", add_first, "indexes all places"},
};

void hostile_edits_table(void)
{
    printf("Edits and searches where they are hardest, one thread, ns each; beside the same on as "
           "many uniform points. What\ncosts more than 10 times as much says why.\n\n"
           "| request | ns | uniform | ratio | |\n|---|---|---|---|---|\n");
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        double hostile = HUGE_VAL, plain = HUGE_VAL;
        for (unsigned round = 0; round < ROUNDS; round++) {
            state = round;
            hostile = fmin(hostile, rows[i].ns(true));
            plain = fmin(plain, rows[i].ns(false));
        }
        double ratio = hostile / plain;
        printf("| %s | %.0f | %.0f | %.2f | %s |\n", rows[i].name, hostile, plain, ratio,
               ratio > 10 ? rows[i].reason : "");
        fflush(stdout);
    }
    printf("\n");
}
