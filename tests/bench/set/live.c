/* live.c - the cost of edits and queries of a live set, compared with CGAL's Triangulation_hierarchy_2.
 *
 *     live N K [PEER]       K operations of each kind on N uniform points; PEER: the program built from cgal_live.cpp
 *
 * Both programs draw the same points and the same operations from the same seeds (live_plan.h). Runs alternate between
 * them, and the least of ROUNDS runs counts. The set uses memory that has been used before, as a daemon's does. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/delaunay.h"
#include "tests/bench/measure.h"
#include "tests/bench/set/live_plan.h"

enum { ROUNDS = 5 };

struct live {
    struct dt_pages *pages;
    struct dt *set;
    struct live_plan plan;
    double ns[LIVE_KINDS];
};

static void must(bool ok)
{
    if (ok)
        return;
    fprintf(stderr, "live: out of memory, or an edit was refused\n");
    exit(1);
}

static void add_singly(struct live *l, enum live_kind kind, const struct dt_point *p)
{
    struct dt_added added;
    double start = measure_cpu();
    for (size_t i = 0; i < l->plan.k; i++)
        must(dt_add(l->set, &p[i], 1, &added) == DT_OK);
    l->ns[kind] = live_ns(start, l->plan.k);
}

static void add_batch(struct live *l)
{
    struct dt_added added;
    double start = measure_cpu();
    must(dt_add(l->set, l->plan.batch, l->plan.k, &added) == DT_OK &&
         dt_refresh(l->set, NULL) == DT_OK);
    l->ns[LIVE_BATCH] = live_ns(start, l->plan.k);
}

static void delete_randomly(struct live *l)
{
    double start = measure_cpu();
    for (size_t i = 0; i < l->plan.k; i++) {
        uint32_t deleted, missing;
        must(dt_delete(l->set, &l->plan.victim[i], 1, &deleted, &missing) == DT_OK);
    }
    l->ns[LIVE_DELETE] = live_ns(start, l->plan.k);
}

static void move_slightly(struct live *l)
{
    double start = measure_cpu();
    for (size_t i = 0; i < l->plan.k; i++)
        must(dt_move(l->set, l->plan.mover[i], l->plan.moved[i]) == DT_OK);
    l->ns[LIVE_MOVE] = live_ns(start, l->plan.k);
}

static void locate(struct live *l)
{
    uint32_t sum = 0;
    double start = measure_cpu();
    for (size_t i = 0; i < l->plan.k; i++) {
        struct dt_location where;
        must(dt_locate(l->set, l->plan.query[i], &where) == DT_OK);
        sum += where.id[0];
    }
    l->ns[LIVE_LOCATE] = live_ns(start, l->plan.k);
    live_keep(sum);
}

static void nearest(struct live *l)
{
    struct dt_ids ids = {0};
    uint32_t sum = 0;
    double start = measure_cpu();
    for (size_t i = 0; i < l->plan.k; i++) {
        ids.n = 0;
        must(dt_nearest(l->set, l->plan.query[i], 1, &ids) == DT_OK);
        sum += ids.v[0];
    }
    l->ns[LIVE_NEAREST] = live_ns(start, l->plan.k);
    live_keep(sum);
    free(ids.v);
}

static void measure_live(struct live *l)
{
    struct dt_added added;
    l->set = dt_new_in(0, l->pages);
    must(l->set != NULL && dt_add(l->set, l->plan.start, l->plan.n, &added) == DT_OK);
    must(dt_triangulate(l->set, NULL) == DT_OK && dt_prepare(l->set, NULL) == DT_OK);
    locate(l);
    nearest(l);
    move_slightly(l);
    add_singly(l, LIVE_INSERT, l->plan.query);
    add_batch(l);
    delete_randomly(l);
    dt_free(l->set);
}

/* The peer prints one number per kind. */
static void measure_peer(const char *peer, size_t n, size_t k, double *ns)
{
    char command[512];
    FILE *f = NULL;
    if (peer != NULL) {
        snprintf(command, sizeof command, "%s %zu %zu", peer, n, k);
        f = popen(command, "r");
    }
    for (unsigned i = 0; i < LIVE_KINDS; i++)
        if (f == NULL || fscanf(f, "%lf", &ns[i]) != 1)
            ns[i] = 0;
    if (f != NULL)
        pclose(f);
}

static void keep_least(double *least, const double *ns, int round)
{
    for (unsigned i = 0; i < LIVE_KINDS; i++)
        least[i] = round == 0 || ns[i] < least[i] ? ns[i] : least[i];
}

int main(int argc, char **argv)
{
    if (argc < 3)
        return 2;
    struct live l = {.plan = live_plan_new(strtoul(argv[1], NULL, 10), strtoul(argv[2], NULL, 10))};
    double least[LIVE_KINDS], peer[LIVE_KINDS], once[LIVE_KINDS];
    l.pages = dt_pages_new(SIZE_MAX);
    must(l.pages != NULL);
    measure_live(&l); /* uses the memory for the first time */
    for (int round = 0; round < ROUNDS; round++) {
        measure_live(&l);
        keep_least(least, l.ns, round);
        measure_peer(argc > 3 ? argv[3] : NULL, l.plan.n, l.plan.k, once);
        keep_least(peer, once, round);
    }
    printf("Live edits and queries, %zu uniform points, %zu of each, ns each, one thread.\n\n",
           l.plan.n, l.plan.k);
    printf("| operation | delaunayd | CGAL hierarchy | ratio |\n|---|---|---|---|\n");
    for (unsigned i = 0; i < LIVE_KINDS; i++) {
        printf("| %s | %.0f |", live_names[i], least[i]);
        if (peer[i] > 0)
            printf(" %.0f | %.3f |\n", peer[i], least[i] / peer[i]);
        else
            printf(" - | - |\n");
    }
    printf("\n");
    dt_pages_free(l.pages);
    live_plan_free(&l.plan);
    return 0;
}
