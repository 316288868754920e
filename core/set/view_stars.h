/* view_stars.h - the stars (star.h) that points had, one by one or many at once, now or at the moment of a view.
 *
 * A view of NULL means now. The view must be readable; passing it through dt_view_if_changed first makes
 * the function faster. */
#pragma once

#include "core/mesh/star.h"
#include "core/set/set.h"

enum { DT_STARS = 64, DT_STAR_MAX = 20 };

/* Stars of consecutive representatives. */
struct dt_stars {
    uint32_t n;
    uint32_t id[DT_STARS], vertex[DT_STARS]; /* vertex DT_NONE: the star was saved */
    uint32_t degree[DT_STARS]; /* DT_NONE: more than DT_STAR_MAX, the ring was not read */
    bool on_hull[DT_STARS];
    uint32_t ring[DT_STARS][DT_STAR_MAX];
};

/* Reads the stars of the first representatives whose ids are >= id and < end, at most max of them.
 * Far faster than one by one, because the cache misses of all of them run at once. */
void dt_stars_read(const struct dt *t, const struct dt_view *v, uint32_t id, uint32_t end,
                   uint32_t max, struct dt_stars *s);

/* The same, but the rings of stars that were not saved consist of vertices, whose places have been fetched. */
void dt_stars_walk(const struct dt *t, const struct dt_view *v, uint32_t id, uint32_t end,
                   uint32_t max, struct dt_stars *s);

/* The star that a representative had. */
struct dt_star {
    uint32_t vertex;       /* as it is now; DT_NONE: as it was saved */
    const uint32_t *saved; /* its ring; borrowed until the next edit */
    uint32_t saved_degree;
    bool on_hull;
};

/* The star of an id that was a representative. Cost: constant. */
struct dt_star dt_star_of(const struct dt *t, const struct dt_view *v, uint32_t id);

/* The number of its neighbours. */
static inline uint32_t dt_star_count(const struct dt *t, const struct dt_star *s)
{
    return s->saved != NULL ? s->saved_degree : dt_star_degree(&t->mesh, s->vertex, DT_NONE);
}

/* Its ring into ring[room]. Returns its degree, DT_NONE if it is larger than room. */
uint32_t dt_star_copy(const struct dt *t, const struct dt_star *s, uint32_t *ring, size_t room);

/* A star of any degree, copied. Start with {0}. */
struct dt_neighbours {
    uint32_t id;        /* whose star it is, if it has one */
    struct dt_ids ring; /* owns */
    bool on_hull;
};

/* Replaces the star by the star of an id that was a representative. Does nothing if it is that star already, read through the
 * same view and since the last edit. DT_NOMEM. Cost: its degree. */
enum dt_status dt_neighbours_read(const struct dt *t, const struct dt_view *v, uint32_t id,
                                  struct dt_neighbours *n);

/* Whether the id is in the ring; *beside: the next id counterclockwise or clockwise, DT_NONE if the outside of the
 * hull comes next. Cost: its degree. */
bool dt_neighbours_have(const struct dt_neighbours *n, uint32_t id, bool ccw, uint32_t *beside);
