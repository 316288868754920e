/* query.h - queries whose result is a list of points, found at once or, if they may take long, by a
 * worker. */
#ifndef SERVER_QUERY_H
#define SERVER_QUERY_H

#include "server/dataset.h"
#include "server/server.h"

enum query_kind { QUERY_LISTS, QUERY_NEAREST, QUERY_BOX, QUERY_DISC };

struct query {
    enum query_kind kind;
    struct dt_place place; /* that is asked for; QUERY_BOX: one corner, */
    struct dt_point hi;    /* and the other */
    double radius;         /* QUERY_DISC */
    uint32_t k;            /* QUERY_NEAREST */
    bool cw;               /* QUERY_LISTS */
    struct dt_ids ids;     /* owns; QUERY_LISTS starts from these, the others begin with none */
    size_t interior;       /* QUERY_LISTS, when done: how many ids are interior points */
};

/* Answers the query of the set; takes over q->ids. */
void query_answer(struct server *s, struct answer *a, struct dataset *set, struct query *q,
                  bool heavy);

#endif
