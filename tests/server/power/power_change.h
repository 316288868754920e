/* power_change.h - changes of sets, as requests, and applied to a model. The model is the core itself:
 * a power cut may affect which changes survive, not what they do. */
#pragma once

#include "core/delaunay.h"
#include "proto/buf.h"

enum request_kind {
    REQUEST_ADD,
    REQUEST_LOAD,        /* LOAD set n */
    REQUEST_LOAD_TO_DOT, /* LOAD set */
    REQUEST_LOADB,
    REQUEST_DELETE,
    REQUEST_MOVE,
    REQUEST_CREATE,
    REQUEST_DROP,
    REQUEST_TRIANGULATE,
    REQUEST_FSET,
    REQUEST_FSETB, /* of the ids from id[0] on */
    REQUEST_FDROP,
    REQUEST_CONSTRAIN, /* the path of the ids, of the number `field` */
    REQUEST_RELEASE,   /* the same, two of them; or all, if n is 0 */
    REQUEST_CASCADE,
    REQUEST_MOVES,
    REQUEST_SPLIT /* as REQUEST_CONSTRAIN */
};

enum { CHANGE_IDS = 8, CHANGE_FIELDS = 2, REPLY_BYTES = 128 };

struct request_change {
    enum request_kind kind;
    uint32_t n;              /* points, ids, or values */
    struct dt_point *points; /* owns; x is the value of FSET and FSETB */
    uint32_t id[CHANGE_IDS];
    double tolerance;
    uint32_t fields; /* how many an addition has values for; these follow from its points */
    uint32_t field;  /* of FSET, FSETB, FDROP; of CONSTRAIN, RELEASE */
};

void request_change_clear(struct request_change *c);

/* Appends the request. Ids are written as `ids` says, NULL: as they are. */
void request_change_write(struct buf *to, const char *set, const struct request_change *c,
                          const uint32_t *ids);

struct model {
    struct dt *dt; /* owns; NULL: there is no such set */
    bool triangulated;
};

void model_clear(struct model *m);

/* Applies the change. `reply` gets what the reply must begin with, up to the figures of a triangulation. */
void model_apply(struct model *m, const struct request_change *c, char reply[REPLY_BYTES]);

/* Like digest_set; 0 if there is no set. */
uint64_t model_digest(const struct model *m);
