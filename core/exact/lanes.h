/* lanes.h - two doubles or four floats side by side, in one register where the machine has vector registers. The types are vectors
 * of gcc and clang; functions add the few instructions that these cannot express. All vectors of core/ are of these types. */
#pragma once

#include <stdint.h>

typedef double dt_lanes __attribute__((vector_size(16)));
typedef int64_t dt_lanes_holds __attribute__((vector_size(16))); /* -1 where it does */

/* The two doubles at p, which need not be aligned to 16. */
static inline dt_lanes dt_lanes_load(const double *p)
{
    typedef double unaligned __attribute__((vector_size(16), aligned(8), may_alias));
    return *(const unaligned *)p;
}

static inline void dt_lanes_store(double *p, dt_lanes v)
{
    typedef double unaligned __attribute__((vector_size(16), aligned(8), may_alias));
    *(unaligned *)p = v;
}

/* The same value in both lanes. */
static inline dt_lanes dt_lanes_both(double v)
{
    return (dt_lanes){v, v};
}

/* The first lanes of a and b, and the second ones. */
static inline dt_lanes dt_lanes_first(dt_lanes a, dt_lanes b)
{
    return (dt_lanes){a[0], b[0]};
}

static inline dt_lanes dt_lanes_second(dt_lanes a, dt_lanes b)
{
    return (dt_lanes){a[1], b[1]};
}

static inline dt_lanes dt_lanes_swap(dt_lanes a)
{
    return (dt_lanes){a[1], a[0]};
}

/* Magnitudes. */
static inline dt_lanes dt_lanes_abs(dt_lanes a)
{
    const dt_lanes_holds magnitude = {INT64_MAX, INT64_MAX};
    return (dt_lanes)((dt_lanes_holds)a & magnitude);
}

/* The lesser and the greater ones; b where a is a NaN. */
static inline dt_lanes dt_lanes_least(dt_lanes a, dt_lanes b)
{
#ifdef __SSE2__
    return __builtin_ia32_minpd(a, b);
#elif defined(__wasm_simd128__)
    return __builtin_wasm_pmin_f64x2(b, a);
#else
    return (dt_lanes){a[0] < b[0] ? a[0] : b[0], a[1] < b[1] ? a[1] : b[1]};
#endif
}

static inline dt_lanes dt_lanes_most(dt_lanes a, dt_lanes b)
{
#ifdef __SSE2__
    return __builtin_ia32_maxpd(a, b);
#elif defined(__wasm_simd128__)
    return __builtin_wasm_pmax_f64x2(b, a);
#else
    return (dt_lanes){a[0] > b[0] ? a[0] : b[0], a[1] > b[1] ? a[1] : b[1]};
#endif
}

/* a in the lanes where the comparison holds, b in the others. */
static inline dt_lanes dt_lanes_choose(dt_lanes_holds holds, dt_lanes a, dt_lanes b)
{
    return (dt_lanes)((holds & (dt_lanes_holds)a) | (~holds & (dt_lanes_holds)b));
}

/* Returns the lanes in which a is not nan. */
static inline dt_lanes_holds dt_lanes_known(dt_lanes a)
{
    dt_lanes same = a;
    return a == same;
}

/* Bit i is the sign bit of lane i: set where a comparison, such as a > b, holds, and in the lanes of doubles taken as
 * integers where these are negative. */
static inline int dt_lanes_bits(dt_lanes_holds holds)
{
#ifdef __SSE2__
    return __builtin_ia32_movmskpd((dt_lanes)holds);
#elif defined(__wasm_simd128__)
    return (int)__builtin_wasm_bitmask_i64x2(holds);
#else
    return (holds[0] < 0 ? 1 : 0) | (holds[1] < 0 ? 2 : 0);
#endif
}

/* ---- four floats ---- */

typedef float dt_floats __attribute__((vector_size(16)));
typedef int32_t dt_floats_holds __attribute__((vector_size(16))); /* -1 where it does */

static inline dt_floats dt_floats_all(float v)
{
    return (dt_floats){v, v, v, v};
}

static inline dt_floats dt_floats_abs(dt_floats a)
{
    const dt_floats_holds magnitude = {INT32_MAX, INT32_MAX, INT32_MAX, INT32_MAX};
    return (dt_floats)((dt_floats_holds)a & magnitude);
}

static inline void dt_floats_store(float *p, dt_floats v)
{
    typedef float aligned __attribute__((vector_size(16), may_alias));
    *(aligned *)p = v;
}
