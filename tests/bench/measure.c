/* measure.c - the child builds, the parent reads the costs from a pipe. */
#include "tests/bench/measure.h"

#include "tests/bench/pool.h"

#include <limits.h>
#include <malloc.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

static double seconds(clockid_t clock)
{
    struct timespec t;
    clock_gettime(clock, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

double measure_cpu(void)
{
    return seconds(CLOCK_THREAD_CPUTIME_ID);
}

size_t measure_sets(size_t n)
{
    return n >= 1000000 ? 1 : n >= 1000 ? 1000000 / n : 1000;
}

static double peak_now(void)
{
    struct rusage u;
    getrusage(RUSAGE_SELF, &u);
    return (double)u.ru_maxrss * 1024;
}

static void must(bool ok)
{
    if (!ok)
        _exit(1);
}

/* Builds one set from scratch; adds to the sums in *cost. */
static void build_once(const struct build *b, const struct dt_pool *pool, struct dt_pages *pages,
                       const struct dt_point *p, struct cost *cost)
{
    struct dt_options opt = {.method = b->method, .pool = pool};
    struct dt_added added;
    struct dt_summary summary;
    struct dt *t = dt_new_in(0, pages);
    must(t != NULL);
    /* Several threads are timed by the wall clock, a single one by its CPU clock. */
    clockid_t clock = b->threads > 1 ? CLOCK_MONOTONIC : CLOCK_THREAD_CPUTIME_ID;
    double start = seconds(clock);
    must(dt_add(t, p, b->n, &added) == DT_OK);
    double between = seconds(clock);
    must(dt_triangulate(t, &opt) == DT_OK);
    double built = seconds(clock);
    cost->build_ns += built - between;
    cost->add_ns += between - start;
    must(dt_prepare(t, &opt) == DT_OK);
    cost->grid_ns += seconds(clock) - built;
    dt_summary(t, &summary);
    cost->held_bytes += (double)summary.memory;
    dt_free(t);
}

static void build_all(const struct build *b, struct cost *cost)
{
    size_t sets = measure_sets(b->n);
    struct pool *pool = pool_new(b->threads);
    struct dt_point *p = malloc(b->n * sizeof *p);
    must(pool != NULL && p != NULL);
    struct dt_pool face = pool_face(pool);
    struct dt_pages *pages = b->warm ? dt_pages_new(SIZE_MAX) : NULL;
    if (b->warm) {
        struct cost ignored = {0};
        mallopt(M_MMAP_MAX, 0);
        mallopt(M_TRIM_THRESHOLD, INT_MAX);
        mallopt(M_ARENA_MAX, 1);
        family_points(b->family, p, b->n, 1);
        build_once(b, b->threads > 1 ? &face : NULL, pages, p, &ignored);
    }
    family_points(b->family, p, b->n, 2);
    double before = peak_now();
    for (size_t i = 0; i < sets; i++) {
        family_points(b->family, p, b->n, 2 + i);
        build_once(b, b->threads > 1 ? &face : NULL, pages, p, cost);
    }
    double points = (double)(sets * b->n);
    cost->add_ns *= 1e9 / points;
    cost->build_ns *= 1e9 / points;
    cost->grid_ns *= 1e9 / points;
    cost->held_bytes /= points;
    cost->peak_bytes = (peak_now() - before) / (double)b->n;
}

static bool run_child(const struct build *b, struct cost *cost)
{
    int ends[2], status;
    if (pipe(ends) != 0)
        return false;
    fflush(stdout);
    pid_t pid = fork();
    if (pid == 0) {
        *cost = (struct cost){0};
        build_all(b, cost);
        _exit(write(ends[1], cost, sizeof *cost) == (ssize_t)sizeof *cost ? 0 : 1);
    }
    close(ends[1]);
    bool ok = pid > 0 && read(ends[0], cost, sizeof *cost) == (ssize_t)sizeof *cost;
    close(ends[0]);
    if (pid > 0)
        waitpid(pid, &status, 0);
    return ok;
}

static bool run_cgal(const struct contender *c, struct cost *cost)
{
    char command[512];
    const struct build *b = &c->build;
    if (access(c->cgal, X_OK) != 0)
        return false;
    snprintf(command, sizeof command, "%s %s %zu %zu %s %s", c->cgal, b->family->name, b->n,
             measure_sets(b->n), b->warm ? "warm" : "fresh", c->list ? "list" : "bare");
    FILE *in = popen(command, "r");
    if (in == NULL)
        return false;
    *cost = (struct cost){0};
    bool ok = fscanf(in, "%lf %lf", &cost->build_ns, &cost->peak_bytes) == 2;
    return pclose(in) == 0 && ok;
}

/* Disturbances only ever add time, so the least time counts; of memory, the most. */
static void take_best(struct cost *best, const struct cost *c)
{
    best->add_ns = fmin(best->add_ns, c->add_ns);
    best->build_ns = fmin(best->build_ns, c->build_ns);
    best->grid_ns = fmin(best->grid_ns, c->grid_ns);
    best->peak_bytes = fmax(best->peak_bytes, c->peak_bytes);
    best->held_bytes = fmax(best->held_bytes, c->held_bytes);
}

static void run_once(struct contender *c)
{
    struct cost cost;
    if (!(c->cgal != NULL ? run_cgal(c, &cost) : run_child(&c->build, &cost)))
        return;
    if (c->best.build_ns > 0)
        take_best(&c->best, &cost);
    else
        c->best = cost;
}

/* A contender with fewer rounds than others skips some, evenly distributed. */
static bool takes_part(const struct contender *c, unsigned round, unsigned rounds)
{
    return (round + 1) * c->rounds / rounds > round * c->rounds / rounds;
}

void measure_alternately(struct contender *c, size_t n)
{
    unsigned rounds = 0;
    for (size_t i = 0; i < n; i++) {
        c[i].best = (struct cost){0};
        rounds = c[i].rounds > rounds ? c[i].rounds : rounds;
    }
    for (unsigned round = 0; round < rounds; round++)
        for (size_t i = 0; i < n; i++)
            if (takes_part(&c[i], round, rounds))
                run_once(&c[i]);
}
