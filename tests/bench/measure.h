/* measure.h - one measurement is one process: its memory is its own, and nothing is warm from the
 * one before. */
#ifndef BENCH_MEASURE_H
#define BENCH_MEASURE_H

#include "tests/oracle/families.h"

/* What is built, of what, how. */
struct build {
    const struct family *family;
    size_t n;
    enum dt_method method;
    unsigned threads;
    bool warm; /* the allocator hands out pages that have been used before; else every page is fresh
                */
};

struct cost {
    double add_ns, build_ns; /* per input point: dt_add, and dt_triangulate */
    double grid_ns;          /* and dt_prepare */
    double peak_bytes;       /* per input point, of the whole process above the points themselves */
    double held_bytes;       /* per input point, what the triangulated set holds */
};

/* Builds sets of b->n points, enough of them to measure, no two alike. false: the child failed, or
 * the machine has not enough memory. */
bool measure(const struct build *b, struct cost *cost);

/* The cost of the same by CGAL, from a program of its own (cgal_speed.cpp): bare, or with ids and
 * the list of triangles. false: there is no such program. */
struct peer_cost {
    double build_ns, peak_bytes;
};
bool measure_cgal(const char *program, const struct build *b, bool list, struct peer_cost *cost);

/* How many sets of n points make a measurement. */
size_t measure_sets(size_t n);

/* Seconds that the calling thread has computed: what other programs do in between does not
 * count. */
double measure_cpu(void);

#endif
