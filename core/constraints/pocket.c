/* pocket.c - see pocket.h. */
#include "core/constraints/pocket.h"

#include <stdlib.h>

#include "core/exact/predicates.h"
#include "core/memory/memory.h"
#include "core/mesh/fixed.h"
#include "core/mesh/hull.h"

void dt_pocket_clear(struct dt_pocket *p)
{
    free(p->side);
    *p = (struct dt_pocket){0};
}

enum dt_status dt_pocket_reserve(struct dt_pocket *p, size_t n)
{
    return n > UINT32_MAX ? DT_NOMEM : dt_items_reserve(&p->side, n, &p->cap, sizeof *p->side);
}

/* A filling under way. */
struct fill {
    struct dt_side *side;
    struct dt_mesh *m;
    const struct dt_point *xy;
    uint32_t first, last, left; /* corners */
    uint32_t face;
};

static struct dt_point place(const struct fill *f, uint32_t i)
{
    return f->xy[f->side[i].origin];
}

static bool is_ear(const struct fill *f, uint32_t i)
{
    return i != f->first && i != f->last &&
           dt_orient2d(place(f, f->side[i].prev), place(f, i), place(f, f->side[i].next)) > 0;
}

/* Joins half edge h, new, with what is beyond the side. */
static void join(struct fill *f, uint32_t h, const struct dt_side *s)
{
    bool inner = (s->half & DT_SIDE_INNER) != 0;
    uint32_t own = s->half & ~DT_SIDE_INNER, beyond = inner ? dt_twin(f->m, own) : own;
    dt_link(f->m, h, beyond);
    dt_fixed_mark(f->m, h, dt_is_fixed(f->m, beyond));
    dt_hull_keep(f->m, s->origin, h);
}

/* The ear i becomes the triangle t. Its third half edge is what is beyond the side that replaces two. */
static void cut(struct fill *f, uint32_t i, uint32_t t)
{
    struct dt_side *a = &f->side[f->side[i].prev], *b = &f->side[i];
    dt_set_corners(f->m, t, a->origin, b->origin, f->side[b->next].origin);
    dt_face_begin(f->m, t, f->face);
    join(f, t, a);
    join(f, t + 1, b);
    a->half = t + 2;
    a->next = b->next;
    f->side[b->next].prev = b->prev;
    f->left--;
}

static void link_ring(struct dt_pocket *p)
{
    for (uint32_t i = 0; i < p->n; i++) {
        p->side[i].prev = i > 0 ? i - 1 : p->n - 1;
        p->side[i].next = i + 1 < p->n ? i + 1 : 0;
    }
}

uint32_t dt_pocket_fill(struct dt_pocket *p, struct dt_mesh *m, const struct dt_point *xy,
                        const uint32_t *spare, uint32_t *spares, struct dt_suspects *suspects)
{
    struct fill f = {p->side, m, xy, 0, p->n - 1, p->n, p->face};
    link_ring(p);
    if (p->n == 2) {
        uint32_t half = p->side[0].half;
        return (half & DT_SIDE_INNER) != 0 ? dt_twin(m, half & ~DT_SIDE_INNER) : half;
    }
    uint32_t i = 1, t = 0;
    while (f.left > 2) {
        if (!is_ear(&f, i)) {
            i = p->side[i].next;
            continue;
        }
        t = spare[--*spares];
        cut(&f, i, t);
        dt_suspect(suspects, t + 2);
        i = p->side[i].prev;
    }
    suspects->half.n -= suspects->half.n > 0; /* the closing edge is the caller's */
    dt_hull_keep(m, p->side[f.last].origin, t + 2);
    return t + 2;
}
