/* model.h - a triangulated set as arrays, fetched from a daemon with binary replies. */
#pragma once

#include "clients/lib/delaunay_client.h"
#include "clients/meshes/crs.h"

#include <stdint.h>

enum { MODEL_NAME = 65, MODEL_MOST_FIELDS = 64 };

struct model {
    /* the caller's: fetch only the triangles and edges inside a border of this number, or `any`; NULL: all */
    const char *inside;
    const struct crs *crs; /* the caller's: of the coordinates; may be NULL */
    uint32_t *id;          /* owns n, ascending */
    double *xy;            /* owns 2n */
    size_t n;
    char (*field)[MODEL_NAME]; /* owns: the names of its `fields` fields */
    double *value;             /* owns n * fields; nan: missing */
    size_t fields;
    int z;              /* the field of heights; -1: none. model_fetch chooses the one called z */
    uint32_t *triangle; /* owns 3 * triangles: places in id and xy, counterclockwise */
    size_t triangles;
    uint32_t *edge; /* owns 2 * edges: places */
    size_t edges;
    uint32_t *hull; /* owns hull_n places, counterclockwise */
    size_t hull_n;
    /* owns 3 * constraints: the places of both ends, and 2 k for a line of number k, 2 k + 1 for a border; sorted as CONSTRAINTS sorts
     * them */
    uint32_t *constraint;
    size_t constraints;
    /* owns 2 * fixed_n: the edges that are parts of constraints; places, the smaller first, sorted */
    uint32_t *fixed;
    size_t fixed_n;
    uint64_t version; /* of the set */
    /* owns: of each triangle the number of the smallest closed border around it; MODEL_OUTSIDE */
    int64_t *region;
    bool regions;      /* there are borders, and the server says what is inside them */
    bool one_region;   /* there are so many that all are number 0 */
    bool torn;         /* while it is fetched: its parts are of several states of the set */
    const char *fault; /* why a call returned DELAUNAY_STOPPED: a static sentence */
};

enum { MODEL_OUTSIDE = -1 };

enum model_parts {
    MODEL_TRIANGLES = 1,
    MODEL_EDGES = 2,
    MODEL_HULL = 4,
    MODEL_MESH = MODEL_TRIANGLES | MODEL_EDGES | MODEL_HULL,
    MODEL_FIELDS = 8,
    MODEL_CONSTRAINTS = 16,
    MODEL_FIXED = 32,
    MODEL_REGIONS = 64
};

/* Fetches the points of the set and, of its triangulation, the parts asked for; *m must be zeroed.
 * The requests are pipelined. All parts belong to one state of the set: points and values come in one reply. The
 * set's version before and after parts of the mesh must be the same; otherwise all is fetched again, ten times at most.
 * DELAUNAY_STOPPED: see m->fault. The caller frees *m in any case. */
enum delaunay_result model_fetch(struct delaunay_client *c, const char *set, unsigned parts,
                                 struct model *m);
/* The version of the set now; 0 from a server that has none. */
enum delaunay_result model_fetch_version(struct delaunay_client *c, const char *set,
                                         uint64_t *version);

void model_free(struct model *m); /* keeps m->inside and m->crs */

/* The column of a field of that name; -1 if there is none. */
int model_field(const struct model *m, const char *name);

static inline bool model_is_border(const struct model *m, size_t constraint)
{
    return (m->constraint[3 * constraint + 2] & 1) != 0;
}

/* Whether a triangle is outside of all borders; false if there are none. */
static inline bool model_is_outside(const struct model *m, size_t triangle)
{
    return m->regions && m->region[triangle] == MODEL_OUTSIDE;
}

/* The value of a field at a place. */
static inline double model_value(const struct model *m, int field, size_t place)
{
    return m->value[place * m->fields + (size_t)field];
}

/* Removes the points whose height (m->z) is missing, and what they are corners of. Returns the number of points removed. False
 * in *ok when out of memory; then *m is as it was. */
size_t model_drop_missing(struct model *m, bool *ok);

/* The place of an id; false if there is no such id. */
bool model_find(const struct model *m, uint32_t id, uint32_t *place);

/* A directed edge's triangle, for all triangles of a model. */
struct sides {
    uint64_t *key; /* owns cap */
    uint32_t *triangle;
    size_t cap;
};

enum { NO_TRIANGLE = -1 };

/* False when out of memory. Cost: O(triangles). */
bool sides_init(struct sides *s, const struct model *m);
void sides_free(struct sides *s);

/* The triangle on the left of a->b (places), or NO_TRIANGLE. */
int64_t sides_find(const struct sides *s, uint32_t a, uint32_t b);
