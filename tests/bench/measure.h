/* measure.h - each measurement is a process of its own, so that its memory can be measured and no caches are
 * warm from earlier ones. */
#pragma once

#include "tests/oracle/families.h"

/* A build: its points, its engine and its threads. */
struct build {
    const struct family *family;
    size_t n;
    enum dt_method method;
    unsigned threads;
    /* pages are used again from set to set, of large arrays and of small ones; else every one is fresh */
    bool warm;
};

struct cost {
    double add_ns, build_ns; /* per input point: dt_add, and dt_triangulate */
    double grid_ns;          /* and dt_prepare */
    double peak_bytes;       /* per input point, of the whole process less the points themselves */
    double held_bytes;       /* per input point, memory of the triangulated set */
};

/* A program in a comparison: an engine of ours or CGAL. */
struct contender {
    struct build build;
    /* NULL: ours; else the program (cgal_speed.cpp), of build's family, n, warm */
    const char *cgal;
    bool list; /* CGAL with ids and the list of triangles, as ours always has; else bare */
    unsigned rounds;
    struct cost best; /* of CGAL build_ns and peak_bytes; all 0: it could not be measured */
};

/* Runs the n contenders alternately, each as many times as it has rounds, and keeps the best of each. The
 * speed of a machine varies by a tenth or more within minutes, so programs that are compared must not be
 * measured one after the other. A turn is a process that builds different sets of build.n points, enough of
 * them to measure. */
void measure_alternately(struct contender *c, size_t n);

/* Returns how many sets of n points make a measurement. */
size_t measure_sets(size_t n);

/* CPU seconds of the calling thread: other programs do not count. */
double measure_cpu(void);
