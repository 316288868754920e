/* front.h - the paper's circular edge list: the border of the part that is triangulated so far.
 *
 * The triangulated part is a disc, and its border passes through each of its vertices once. So the start
 * vertex identifies an edge of the front, and the list is the paper's pair of pointers, next and previous,
 * at every point. The front runs clockwise around the disc: every edge
 * has the open part of the plane on its left.
 *
 *                        open
 *            a ---------> b ---------> c          next[a] = b, next[b] = c, previous[b] = a
 *          triangle      triangle                 the edge a->b is "edge a"
 *
 * The apex of an edge, once searched, is remembered with it. An edge is awake if it can make progress: its apex
 * has not been searched yet, or makes a triangle that touches the disc properly. The awake edges form a second
 * circular list, in the order of the front; it replaces the paper's queue. */
#pragma once

#include "core/control/stop.h"

#define DT_UNSEARCHED (UINT32_MAX - 1) /* an apex not known yet; DT_NONE is a boundary edge's */

/* One point of the plane, known by its place in the grid. */
struct dt_front_node {
    uint32_t next, previous;             /* along the front; DT_NONE while the point is not on it */
    uint32_t awake_next, awake_previous; /* DT_NONE while edge asleep or not on the front */
    uint32_t apex;
    uint32_t outer; /* the half edge of the triangle behind the edge, which runs the other way */
};

struct dt_front {
    struct dt_front_node *node; /* owns */
    uint32_t current;           /* the awake edge to be looked at; DT_NONE when all sleep */
};

/* The change that the triangle of edge a, from a to b, and its apex c makes to the front; seen from the
 * disc, looking out. */
enum dt_touch {
    DT_NEW_POINT,   /* c was not used yet */
    DT_RIGHT_TOUCH, /* c follows b on the front: b becomes an inner point */
    DT_LEFT_TOUCH,  /* c precedes a: a becomes an inner point */
    DT_NO_TOUCH,    /* c is elsewhere on the front: the triangle would enclose a cave */
    DT_BOUNDARY     /* there is no apex: a hull edge */
};

/* A front of no edges for n points. *f must be zeroed or cleared; stop may be NULL. */
enum dt_status dt_front_init(struct dt_front *f, uint32_t n, struct dt_stop *stop);
void dt_front_clear(struct dt_front *f);

/* Starts the front with the counterclockwise triangle a b c, whose half edges a->b, b->c, c->a are
 * h, h+1, h+2. */
void dt_front_open(struct dt_front *f, uint32_t a, uint32_t b, uint32_t c, uint32_t h);

/* The case that edge a is; its apex has been searched. */
enum dt_touch dt_front_touch(const struct dt_front *f, uint32_t a);

/* Each adds the triangle of edge a = a->b and its apex c to the disc, in the case that its name says; h
 * is as above. The edge with which the search should continue becomes current. */
void dt_front_new_point(struct dt_front *f, uint32_t a, uint32_t h);
void dt_front_right_touch(struct dt_front *f, uint32_t a, uint32_t h);
void dt_front_left_touch(struct dt_front *f, uint32_t a, uint32_t h);

/* Puts edge a to sleep, in the two other cases. */
void dt_front_sleep(struct dt_front *f, uint32_t a);
