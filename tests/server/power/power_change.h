/* power_change.h - changes of sets, as requests, and applied to a model. The model is the core itself:
 * a power cut may affect which changes survive, not what they do. */
#ifndef TESTS_SERVER_POWER_CHANGE_H
#define TESTS_SERVER_POWER_CHANGE_H

#include "core/delaunay.h"
#include "proto/buf.h"

enum change_kind {
    CHANGE_ADD,
    CHANGE_LOAD,        /* LOAD set n */
    CHANGE_LOAD_TO_DOT, /* LOAD set */
    CHANGE_LOADB,
    CHANGE_DELETE,
    CHANGE_MOVE,
    CHANGE_CREATE,
    CHANGE_DROP,
    CHANGE_TRIANGULATE,
    CHANGE_FSET,
    CHANGE_FSETB, /* of the ids from id[0] on */
    CHANGE_FDROP
};

enum { CHANGE_IDS = 8, CHANGE_FIELDS = 2, REPLY_BYTES = 128 };

struct change {
    enum change_kind kind;
    uint32_t n;              /* points, ids, or values */
    struct dt_point *points; /* owns; x is the value of FSET and FSETB */
    uint32_t id[CHANGE_IDS];
    double tolerance;
    uint32_t fields; /* how many an addition has values for; these follow from its points */
    uint32_t field;  /* of FSET, FSETB, FDROP */
};

void change_clear(struct change *c);

/* Appends the request. Ids are written as `ids` says, NULL: as they are. */
void change_write(struct buf *to, const char *set, const struct change *c, const uint32_t *ids);

struct model {
    struct dt *dt; /* owns; NULL: there is no such set */
    bool triangulated;
};

void model_clear(struct model *m);

/* Applies the change. `reply` gets what the reply must begin with, up to the figures of a triangulation. */
void model_apply(struct model *m, const struct change *c, char reply[REPLY_BYTES]);

/* Like digest_set; 0 if there is no set. */
uint64_t model_digest(const struct model *m);

#endif
