/* live_plan.c - see live_plan.h. */
#include "tests/bench/set/live_plan.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "tests/bench/measure.h"

const char *const live_names[LIVE_KINDS] = {
    "insert, random", "insert, a batch (per point)",
    "delete, random", "move by a tenth of the point distance (peer: remove and insert)",
    "locate, random", "nearest, random"};

static struct dt_point *uniform(size_t n, uint64_t seed)
{
    struct dt_point *p = malloc((n + 1) * sizeof *p);
    if (p == NULL)
        abort();
    family_points(family_find("uniform"), p, n, seed);
    return p;
}

/* k different ids below n, at random: the start of a shuffle. */
static uint32_t *some_ids(size_t n, size_t k, uint64_t seed)
{
    uint32_t *id = malloc((n + 1) * sizeof *id);
    if (id == NULL)
        abort();
    for (uint32_t i = 0; i < n; i++)
        id[i] = i;
    for (size_t i = 0; i < k && i < n; i++) {
        seed = seed * 6364136223846793005u + 1442695040888963407u;
        size_t j = i + (size_t)(seed >> 20) % (n - i);
        uint32_t t = id[i];
        id[i] = id[j];
        id[j] = t;
    }
    return id;
}

struct live_plan live_plan_new(size_t n, size_t k)
{
    struct live_plan p = {.n = n, .k = k < n ? k : n};
    p.start = uniform(n, 1);
    p.query = uniform(k, 2);
    p.batch = uniform(k, 3);
    p.moved = uniform(k, 4);
    p.victim = some_ids(n, k, 5);
    p.mover = some_ids(n, k, 6);
    double step = 0.1 / sqrt((double)n);
    for (size_t i = 0; i < p.k; i++) {
        double angle = p.moved[i].x * 6.283185307179586;
        p.moved[i].x = p.start[p.mover[i]].x + step * cos(angle);
        p.moved[i].y = p.start[p.mover[i]].y + step * sin(angle);
    }
    return p;
}

void live_plan_free(struct live_plan *p)
{
    free(p->start);
    free(p->query);
    free(p->batch);
    free(p->moved);
    free(p->victim);
    free(p->mover);
}

double live_ns(double start, size_t k)
{
    return (measure_cpu() - start) * 1e9 / (double)k;
}

void live_keep(uint32_t value)
{
    static volatile uint32_t kept;
    kept = value;
    (void)kept;
}
