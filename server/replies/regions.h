/* regions.h - what borders enclose, as replies. */
#pragma once

#include "server/jobs/server.h"
#include "server/rows/rows.h"

enum regions_kind {
    REGIONS_ALL,
    REGIONS_AT,       /* which borders enclose each of the places */
    REGIONS_LOCATION, /* where a place is: in the triangulation, and whether borders enclose it */
    REGIONS_TABLE     /* the rows of a table that are inside */
};

struct regions_query {
    enum regions_kind kind;
    enum dt_table table; /* DT_TRIANGLES or DT_EDGES */
    struct inside inside;
    bool cw, binary;       /* as in replies with the table */
    struct places places;  /* owns, from dt_pages_grow */
    struct dt_point place; /* REGIONS_LOCATION */
    struct dt_location at;
};

/* Whether the regions of the set, which has a triangulation, are known, and the border of INSIDE is there and closed. If not, the
 * request waits for them, or the ERR line has been written. */
bool regions_ready(struct server *s, struct answer *a, struct dataset *set, struct inside inside);
/* The same for regions that are known. */
bool regions_check(struct answer *a, const struct dt *t, struct inside inside);

/* Answers; what q owns moves here. Edits of the set wait while a worker finds the answer. */
void regions_answer(struct server *s, struct answer *a, struct dataset *set,
                    struct regions_query *q);

/* LOCATE, which says of a set with borders whether they enclose the place. */
void regions_locate(struct server *s, struct answer *a, struct dataset *set,
                    const struct dt_place *place);
