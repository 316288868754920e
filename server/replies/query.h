/* query.h - queries whose result is a list, found at once or, if that takes long, by a worker.
 *
 * A query is tried on a reactor with a limit on its steps (struct dt_options). If it exceeds the limit,
 * it goes to a worker, whose search visits the set for a few milliseconds at most. A search that
 * takes longer is replaced by a sweep over the set at one moment, piece by piece (core/sweep), so that
 * edits go on in between. NEAREST and WITHIN of a set without a triangulation are sweeps, too. */
#pragma once

#include "core/delaunay_surface.h"
#include "server/jobs/server.h"
#include "server/sets/dataset.h"

enum query_kind {
    QUERY_LISTS,
    QUERY_TRIANGLES,
    QUERY_EDGES,
    QUERY_NEAREST,
    QUERY_BOX,
    QUERY_DISC,
    QUERY_WEIGHTS,
    QUERY_CONSTRAINTS,
    QUERY_CONSTRAINED /* the edges that are parts of constraints */
};

struct query {
    enum query_kind kind;
    struct dt_place place; /* QUERY_NEAREST, QUERY_DISC; QUERY_BOX: its lower left corner */
    struct dt_point hi;    /* QUERY_BOX: its upper right corner */
    double radius;         /* QUERY_DISC */
    uint32_t k;            /* QUERY_NEAREST; QUERY_CONSTRAINTS: the number, if it is `numbered` */
    bool numbered, ended;  /* QUERY_CONSTRAINTS: those of a number, or those that end at the ids */
    uint32_t corner[3];    /* QUERY_TRIANGLES and QUERY_EDGES: ids, the first `corners` of them */
    unsigned corners;
    bool cw; /* QUERY_LISTS, QUERY_TRIANGLES */
    /* QUERY_LISTS: the points in the box from place.at to hi; QUERY_TRIANGLES: those that meet it */
    bool within;
    bool binary;               /* with `within` only */
    enum dt_interpolation how; /* QUERY_WEIGHTS */
    /* owns: the result; of QUERY_LISTS and QUERY_CONSTRAINTS first the ids of the request; of QUERY_WEIGHTS the words of ROW_VALUE */
    struct dt_ids ids;
    size_t interior; /* QUERY_LISTS: the number of interior points in the result */
    uint64_t words;  /* of the rows in binary */
};

/* Answers the query; q->ids moves here. */
void query_answer(struct server *s, struct answer *a, struct dataset *set, struct query *q);
