/* tour.c - see tour.h. */
#include "core/surface/tour.h"

#include "core/exact/predicates.h"

#include <stdlib.h>

void dt_tour_clear(struct dt_tour *tour)
{
    free(tour->step);
    free(tour->turn);
    *tour = (struct dt_tour){0};
}

/* Room for one more of size `size` in an array of n; NULL: out of memory, the array is as before. */
static void *grown(void *array, uint32_t n, uint32_t *cap, size_t size)
{
    if (n < *cap)
        return array;
    uint32_t more = *cap == 0 ? 64 : 2 * *cap;
    void *room = realloc(array, more * size);
    if (room != NULL)
        *cap = more;
    return room;
}

/* A step to be filled in; NULL: out of memory. */
static struct dt_tour_step *step_of(struct dt_tour *tour, enum dt_tour_kind kind, uint32_t id)
{
    void *room = grown(tour->step, tour->steps, &tour->step_cap, sizeof *tour->step);
    if (room == NULL)
        return NULL;
    tour->step = room;
    struct dt_tour_step *step = &tour->step[tour->steps++];
    step->kind = kind;
    step->id = id;
    return step;
}

static bool push(struct dt_tour *tour, struct dt_tour_turn turn)
{
    void *room = grown(tour->turn, tour->turns, &tour->turn_cap, sizeof turn);
    if (room == NULL)
        return false;
    tour->turn = room;
    tour->turn[tour->turns++] = turn;
    return true;
}

static bool enter(struct dt_tour *tour, const struct dt *t, uint32_t half)
{
    const struct dt_point *xy = t->points.xy;
    struct dt_tour_step *step = step_of(tour, DT_TOUR_ENTER, tour->triangles++);
    if (step == NULL)
        return false;
    step->p[0] = xy[dt_origin(&t->mesh, half)];
    step->p[1] = xy[dt_dest(&t->mesh, half)];
    step->p[2] = xy[dt_apex_of(&t->mesh, half)];
    return true;
}

static bool add_rim(struct dt_tour *tour, const struct dt *t, uint32_t half)
{
    uint32_t a = dt_origin(&t->mesh, half);
    struct dt_tour_step *step = step_of(tour, DT_TOUR_RIM, t->points.id[a]);
    if (step == NULL)
        return false;
    step->p[0] = t->points.xy[a];
    step->p[1] = t->points.xy[dt_dest(&t->mesh, half)];
    tour->rims++;
    return true;
}

static bool in_disc(const struct dt *t, uint32_t half, struct dt_point q)
{
    const struct dt_point *xy = t->points.xy;
    const uint32_t *v = t->mesh.half + dt_base(half);
    return v[2] != DT_NONE && dt_incircle(xy[v[0]], xy[v[1]], xy[v[2]], q) > 0;
}

/* Crosses a half edge into the disc, whose two other edges are next. */
static bool cross(struct dt_tour *tour, const struct dt *t, uint32_t beyond, uint32_t from)
{
    uint32_t here = tour->triangles;
    return enter(tour, t, beyond) && push(tour, (struct dt_tour_turn){DT_NONE, from}) &&
           push(tour, (struct dt_tour_turn){dt_prev(beyond), here}) &&
           push(tour, (struct dt_tour_turn){dt_next(beyond), here});
}

static bool take(struct dt_tour *tour, const struct dt *t, struct dt_point q,
                 struct dt_tour_turn turn)
{
    if (turn.half == DT_NONE)
        return step_of(tour, DT_TOUR_LEAVE, turn.triangle) != NULL;
    uint32_t beyond = dt_twin(&t->mesh, turn.half);
    return in_disc(t, beyond, q) ? cross(tour, t, beyond, turn.triangle)
                                 : add_rim(tour, t, turn.half);
}

enum dt_status dt_tour_make(const struct dt *t, struct dt_point q, uint32_t first,
                            struct dt_stop *work, struct dt_tour *tour)
{
    tour->steps = tour->turns = tour->rims = tour->triangles = 0;
    bool ok = enter(tour, t, first) && push(tour, (struct dt_tour_turn){dt_prev(first), 0}) &&
              push(tour, (struct dt_tour_turn){dt_next(first), 0}) &&
              push(tour, (struct dt_tour_turn){first, 0});
    while (ok && tour->turns > 0) {
        ok = take(tour, t, q, tour->turn[--tour->turns]);
        enum dt_status s = (tour->steps & DT_WORK_MASK) == 0 ? dt_work(work, DT_WORK_BLOCK) : DT_OK;
        if (s != DT_OK)
            return s;
    }
    return ok ? DT_OK : DT_NOMEM;
}
