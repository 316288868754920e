/* queue.h - the triangles that wait to be refined, the worst first: a bucket for each level, and the first of a bucket
 * first [Shewchuk, "Triangle", 1996, section 3.3]. Cost of each call: constant. */
#pragma once

#include "core/delaunay.h"

enum { DT_LEVELS = 4096 };

struct dt_waiting {
    uint32_t h;         /* the triangle, */
    uint32_t corner[3]; /* and its corners: other ones are there if it has been replaced */
    uint32_t next;
};

/* Start with dt_queue_init. */
struct dt_queue {
    struct dt_waiting *item; /* owns `cap` */
    uint32_t end, cap, free_list;
    uint32_t first[DT_LEVELS], last[DT_LEVELS];
    uint64_t filled[DT_LEVELS / 64]; /* which levels are not empty, */
    uint64_t any;                    /* and of which words of `filled` some bit is set */
    uint32_t n;
};

void dt_queue_init(struct dt_queue *q);
void dt_queue_clear(struct dt_queue *q);

/* Makes room for n more. */
enum dt_status dt_queue_reserve(struct dt_queue *q, uint32_t n);

/* Adds a triangle, for which there is room, to a level below DT_LEVELS. */
void dt_queue_push(struct dt_queue *q, uint32_t level, const struct dt_waiting *w);

/* Takes the first one of the highest level; false: it is empty. */
bool dt_queue_pop(struct dt_queue *q, struct dt_waiting *w);
