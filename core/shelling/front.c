/* front.c - the circular edge list and the three ways in which a triangle changes it.
 *
 * Source: the paper, "Putting triangles together" and fig. 19. Deviations: the open side is the
 * left. A right touch is one at the right end of the edge as seen from the disc, looking out, as in
 * the paper's mirror image. The paper moves an edge without a touch to the end of its queue and searches
 * it again; here it sleeps, with its apex, until a neighbour on the front changes.
 *
 * The case of no touch: the apex c of edge a is on the front already, but not next to a or b. The
 * triangle a b c would close the mouth of a cave (dotted) and leave a hole in the disc. So the other edges of
 * the cave come first, until c follows b directly and edge a wakes up.
 *
 *                 c <--- o
 *               . .      ^
 *             .   . cave |
 *           .     .      |
 *      --> a ---> b ---> o
 */
#include "core/shelling/front.h"

#include <string.h>

#include "core/memory/memory.h"

enum dt_status dt_front_init(struct dt_front *f, uint32_t n, struct dt_stop *stop)
{
    f->current = DT_NONE;
    f->node = dt_array_new(n, sizeof *f->node);
    if (f->node == NULL)
        return DT_NOMEM;
    for (struct dt_piece at = dt_pieces(0, n); dt_next_piece(stop, &at);)
        memset(f->node + at.a, 0xff, (at.b - at.a) * sizeof *f->node); /* DT_NONE everywhere */
    return stop == NULL ? DT_OK : dt_stop_status(stop);
}

void dt_front_clear(struct dt_front *f)
{
    dt_array_free(f->node);
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

/* The edge from a is new; half edge h is its other side. */
static void renew(struct dt_front *f, uint32_t a, uint32_t h)
{
    f->node[a].apex = DT_UNSEARCHED;
    f->node[a].outer = h;
}

/* Edge a, from a to b, is awake and has changed. A neighbour that sleeps over a cave may find its
 * apex next to it now, and wakes up for a right touch (edge p) or a left touch (edge b).
 *
 *      --> p ---> a ---> b -->
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
    if (f->node[b].next == c)
        return DT_RIGHT_TOUCH;
    return f->node[a].previous == c ? DT_LEFT_TOUCH : DT_NO_TOUCH;
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

/* A new point; dotted edges lie inside the disc from now on. The search continues around b.
 *
 *                                         c
 *                                       ^   \
 *                                 h+2 /       \ h+1
 *                                   /     h     v
 *      --> a ---------> b -->   --> a . . . . . b -->
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

/* A right touch: b is enclosed, as all triangles around it are known.
 *
 *                       c -->                   c -->
 *                       ^                     ^ .
 *                       |             h+2  /    . h+1
 *                       |               /   h   .
 *      --> a ---------> b       --> a . . . . . (b)
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

/* A left touch: a is enclosed.
 *
 *      --> c                    --> c
 *          |                        . \
 *          |                    h+2 .    \  h+1
 *          v                        .   h   v
 *          a ---------> b -->      (a). . . . . b -->
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
