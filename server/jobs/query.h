/* query.h - queries whose result is a list, found at once or, if that takes long, by a worker.
 *
 * A query is tried on the I/O thread with a limit on its work (struct dt_options). What exceeds it
 * goes to a worker, whose search holds the set's lock for a few milliseconds at most: a result that
 * takes longer is found by a sweep over one moment of the set, piece by piece (core/sweep), so
 * that edits go on in between. So are the places and the discs and boxes of a set that has no
 * triangulation. */
#ifndef SERVER_QUERY_H
#define SERVER_QUERY_H

#include "server/jobs/server.h"
#include "server/sets/dataset.h"

enum query_kind { QUERY_LISTS, QUERY_TRIANGLES, QUERY_EDGES, QUERY_NEAREST, QUERY_BOX, QUERY_DISC };

struct query {
    enum query_kind kind;
    struct dt_place place; /* that is asked for; QUERY_BOX: one corner, */
    struct dt_point hi;    /* and the other */
    double radius;         /* QUERY_DISC */
    uint32_t k;            /* QUERY_NEAREST */
    uint32_t corner[3];    /* QUERY_TRIANGLES and QUERY_EDGES: ids, the first `corners` of them */
    unsigned corners;
    bool cw;           /* QUERY_LISTS, QUERY_TRIANGLES */
    struct dt_ids ids; /* owns: the result; QUERY_LISTS starts from the ids that are asked for */
    size_t interior;   /* QUERY_LISTS, when done: how many ids are interior points */
};

/* Answers the query of the set; takes over q->ids. */
void query_answer(struct server *s, struct answer *a, struct dataset *set, struct query *q);

#endif
