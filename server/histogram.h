/* histogram.h - counts of latencies in buckets whose width is a 32nd of their value, so that every
 * quantile is right to 3 per cent, whatever its size. */
#ifndef TESTS_LOAD_HISTOGRAM_H
#define TESTS_LOAD_HISTOGRAM_H

#include <stddef.h>
#include <stdint.h>

enum { HISTOGRAM_BUCKETS = 60 * 32 };

/* Zero it to start. */
struct histogram {
    uint64_t count[HISTOGRAM_BUCKETS];
    uint64_t total, max;
};

void histogram_add(struct histogram *h, uint64_t ns);

/* The value in ns that the share q (0 to 1) of all counts does not exceed; 0 if there are none. */
uint64_t histogram_quantile(const struct histogram *h, double q);

#endif
