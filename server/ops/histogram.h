/* histogram.h - counts of durations in buckets whose width is a 32nd of their value, so that every
 * quantile is accurate to 3 per cent, in constant memory (after G. Tene's HdrHistogram). */
#pragma once

#include <stddef.h>
#include <stdint.h>

enum { HISTOGRAM_BUCKETS = 38 * 32 }; /* values beyond 2^42 ns, 73 minutes, share one bucket */

/* All zero: empty. */
struct histogram {
    uint64_t count[HISTOGRAM_BUCKETS];
    uint64_t total, max;
};

/* Counts `times` durations of ns each. Cost: O(1). */
void histogram_add(struct histogram *h, uint64_t ns, uint64_t times);

/* Adds the counts of another one. Cost: O(HISTOGRAM_BUCKETS). */
void histogram_join(struct histogram *h, const struct histogram *other);

/* The value in ns that the share q (0 to 1) of all counts does not exceed; 0 if there are none.
 * Cost: O(HISTOGRAM_BUCKETS). */
uint64_t histogram_quantile(const struct histogram *h, double q);

/* The sum of all durations in ns, accurate to 3 per cent. Cost: O(HISTOGRAM_BUCKETS). */
uint64_t histogram_sum(const struct histogram *h);
