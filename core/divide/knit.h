/* knit.h - what merge.c and block.c share: the arrays of one merge, and the basic operations on them. */
#ifndef DT_KNIT_H
#define DT_KNIT_H

#include "core/divide/part.h"
#include "core/exact/bounds.h"

#define INLINE static inline __attribute__((always_inline))

/* One merge's view of the arrays, in registers. */
struct knitting {
    const struct dt_point *p;
    uint32_t *half, *leaving;
    struct dt_wide_bounds bound; /* below these, signs are uncertain */
    struct dt_stop *stop;
};

/* `side` is the longer side of the box of all points concerned. */
INLINE struct knitting knitting_of(const struct dt_merging *w, double side)
{
    return (struct knitting){w->p, w->mesh->half, w->mesh->leaving, dt_wide_bounds_of(side),
                             w->stop};
}

/* Half edges are size_t in here, although they have 32 bits: h + 4 is then part of an address, and
 * no sum has to be cut to 32 bits first. */

INLINE void knit_link(const struct knitting *w, size_t h, size_t twin)
{
    w->half[h + 4] = (uint32_t)twin;
    w->half[twin + 4] = (uint32_t)h;
}

INLINE size_t knit_twin(const struct knitting *w, size_t h)
{
    return w->half[h + 4];
}

INLINE void knit_triangle(const struct knitting *w, size_t t, uint32_t a, uint32_t b, uint32_t c)
{
    w->half[t] = a;
    w->half[t + 1] = b;
    w->half[t + 2] = c;
}

/* Makes the record at t the ghost beyond the hull edge b->a. */
INLINE void knit_ghost(const struct knitting *w, size_t t, uint32_t a, uint32_t b)
{
    knit_triangle(w, t, a, b, DT_NONE);
    w->leaving[a] = (uint32_t)t;
}

#endif
