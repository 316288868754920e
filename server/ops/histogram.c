/* histogram.c - see histogram.h. The first 64 buckets hold one value each; from there on every
 * power of two is cut into 32. */
#include "server/ops/histogram.h"

enum { SUB_BITS = 5, SUBS = 1 << SUB_BITS };

static size_t bucket_of(uint64_t v)
{
    if (v < SUBS)
        return (size_t)v;
    unsigned shift = 63 - (unsigned)__builtin_clzll(v) - SUB_BITS;
    size_t bucket = (size_t)shift * SUBS + (size_t)(v >> shift);
    return bucket < HISTOGRAM_BUCKETS ? bucket : HISTOGRAM_BUCKETS - 1;
}

/* The largest value of a bucket. */
static uint64_t top_of(size_t bucket)
{
    if (bucket < (size_t)2 * SUBS)
        return bucket;
    if (bucket == HISTOGRAM_BUCKETS - 1)
        return UINT64_MAX;
    unsigned shift = (unsigned)(bucket / SUBS) - 1;
    return ((uint64_t)(bucket % SUBS + SUBS + 1) << shift) - 1;
}

void histogram_add(struct histogram *h, uint64_t ns, uint64_t times)
{
    h->count[bucket_of(ns)] += times;
    h->total += times;
    if (ns > h->max)
        h->max = ns;
}

void histogram_join(struct histogram *h, const struct histogram *other)
{
    for (size_t i = 0; i < HISTOGRAM_BUCKETS; i++)
        h->count[i] += other->count[i];
    h->total += other->total;
    h->max = other->max > h->max ? other->max : h->max;
}

uint64_t histogram_quantile(const struct histogram *h, double q)
{
    double want = q * (double)h->total;
    uint64_t seen = 0;
    for (size_t i = 0; i < HISTOGRAM_BUCKETS && h->total > 0; i++) {
        seen += h->count[i];
        if (seen > 0 && (double)seen >= want)
            return top_of(i) < h->max ? top_of(i) : h->max;
    }
    return h->max;
}

uint64_t histogram_sum(const struct histogram *h)
{
    uint64_t sum = 0;
    for (size_t i = 0; i < HISTOGRAM_BUCKETS; i++)
        sum += h->count[i] * (top_of(i) < h->max ? top_of(i) : h->max);
    return sum;
}
