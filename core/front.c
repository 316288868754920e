/* front.c - the circular edge list and the three ways in which a triangle changes it.
 *
 * Source: the paper, "Putting triangles together" and fig. 19. Deviations: the paper has the open
 * side on the right, so its right is our right seen from the disc, but its lists run the other way;
 * its "no touch" moves an edge on in the queue, to be searched again when its turn comes, where
 * here the edge sleeps, with its apex, until a neighbour on the front changes. */
#include "core/front.h"

#include <stdlib.h>
#include <string.h>

#include "core/memory.h"

enum dt_status dt_front_init(struct dt_front *f, uint32_t n)
{
    f->current = DT_NONE;
    f->node = dt_array_new(n, sizeof *f->node);
    if (f->node == NULL)
        return DT_NOMEM;
    memset(f->node, 0xff, n * sizeof *f->node); /* DT_NONE everywhere */
    return DT_OK;
}

void dt_front_clear(struct dt_front *f)
{
    free(f->node);
    *f = (struct dt_front){.node = NULL};
}

/* ---- the two lists ---- */

static void join(struct dt_front *f, uint32_t a, uint32_t b)
{
    f->node[a].next = b;
    f->node[b].previous = a;
}

static void leave(struct dt_front *f, uint32_t a)
{
    f->node[a].next = f->node[a].previous = DT_NONE;
}

static bool is_awake(const struct dt_front *f, uint32_t a)
{
    return f->node[a].awake_next != DT_NONE;
}

static void join_awake(struct dt_front *f, uint32_t a, uint32_t b)
{
    f->node[a].awake_next = b;
    f->node[b].awake_previous = a;
}

/* Wakes edge a, which comes after the awake edge `after`, before the next awake one. */
static void wake_after(struct dt_front *f, uint32_t after, uint32_t a)
{
    uint32_t before = f->node[after].awake_next;
    join_awake(f, after, a);
    join_awake(f, a, before);
}

void dt_front_sleep(struct dt_front *f, uint32_t a)
{
    struct dt_front_node *n = &f->node[a];
    bool alone = n->awake_next == a;
    join_awake(f, n->awake_previous, n->awake_next);
    if (f->current == a)
        f->current = alone ? DT_NONE : n->awake_next;
    n->awake_next = n->awake_previous = DT_NONE;
}

/* The edge from a is a new one, the other side of which is half edge h. */
static void renew(struct dt_front *f, uint32_t a, uint32_t h)
{
    f->node[a].apex = DT_UNSEARCHED;
    f->node[a].outer = h;
}

/* Edge a, awake, has changed. Its neighbours, if they sleep over a cave that this has closed, wake
 * up:
 *
 *         apex of p             the apex of edge p has become the next but one point: a right touch
 *        /         \
 *       p ---> a ---> next
 */
static void wake_neighbours(struct dt_front *f, uint32_t a)
{
    uint32_t p = f->node[a].previous, b = f->node[a].next;
    if (!is_awake(f, p) && f->node[p].apex == b)
        wake_after(f, f->node[a].awake_previous, p);
    if (!is_awake(f, b) && f->node[b].apex == a)
        wake_after(f, a, b);
}

/* ---- the cases ---- */

enum dt_touch dt_front_touch(const struct dt_front *f, uint32_t a)
{
    uint32_t c = f->node[a].apex, b = f->node[a].next;
    if (c == DT_NONE)
        return DT_BOUNDARY;
    if (f->node[c].next == DT_NONE)
        return DT_NEW_POINT;
    return c == f->node[b].next       ? DT_RIGHT_TOUCH
           : c == f->node[a].previous ? DT_LEFT_TOUCH
                                      : DT_NO_TOUCH;
}

void dt_front_open(struct dt_front *f, uint32_t a, uint32_t b, uint32_t c, uint32_t h)
{
    join(f, a, c);
    join(f, c, b);
    join(f, b, a);
    join_awake(f, a, c);
    join_awake(f, c, b);
    join_awake(f, b, a);
    renew(f, b, h);
    renew(f, c, h + 1);
    renew(f, a, h + 2);
    f->current = a;
}

/*            c                          c
 *                                     ^   \
 *                         =>         / h+2 \           two new edges; the search goes on around b
 *                                   /  h+1  v
 *     --> a ---> b -->          --> a       b -->
 */
void dt_front_new_point(struct dt_front *f, uint32_t a, uint32_t h)
{
    uint32_t b = f->node[a].next, c = f->node[a].apex;
    join(f, a, c);
    join(f, c, b);
    wake_after(f, a, c);
    renew(f, a, h + 2);
    renew(f, c, h + 1);
    f->current = c;
}

/*              c -->                    c -->
 *              ^                       ^
 *              |         =>           / h+2            b is enclosed: its edges all have both
 * triangles |                     /
 *     --> a -> b                --> a   (b)
 */
void dt_front_right_touch(struct dt_front *f, uint32_t a, uint32_t h)
{
    uint32_t b = f->node[a].next, c = f->node[a].apex;
    if (is_awake(f, b))
        dt_front_sleep(f, b);
    leave(f, b);
    join(f, a, c);
    renew(f, a, h + 2);
    wake_neighbours(f, a);
    f->current = a;
}

/*     --> c                     --> c
 *         |                          \
 *         |              =>       h+1 \                a is enclosed
 *         v                            v
 *         a -> b -->            (a)    b -->
 */
void dt_front_left_touch(struct dt_front *f, uint32_t a, uint32_t h)
{
    uint32_t b = f->node[a].next, c = f->node[a].apex;
    if (!is_awake(f, c))
        wake_after(f, f->node[a].awake_previous, c);
    dt_front_sleep(f, a);
    leave(f, a);
    join(f, c, b);
    renew(f, c, h + 1);
    wake_neighbours(f, c);
    f->current = c;
}
