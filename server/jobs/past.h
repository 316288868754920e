/* past.h - a private copy of the points and some fields of a set, as of the moment of a view. It serves a reader that needs the
 * whole triangulation of that moment although the set has been edited since. The triangulation depends on the points and
 * constraints alone, so the copy has the triangulation that the set had. Or it has the triangulation that the set would have had
 * without the points that lack a value. */
#pragma once

#include "core/delaunay_constraints.h"
#include "server/jobs/job.h"

struct past {
    struct dt *dt;                               /* owns */
    const struct dt_field *field[DT_MAX_FIELDS]; /* as many as were copied */
    struct dt_crossed crossed;                   /* of DT_CROSSES */
};

/* Copies the points of the version that the job reads, with their ids and the values of n fields, and the constraints, and triangulates
 * them; DT_NOMEM also if the job has no room. With `skip`, points without a value in the first one are deleted first, and constraints that
 * end at one are released; DT_CROSSES: two of the others now cross. The set is visited in pieces of less than a millisecond. The
 * memory of the job is then that of the copy. Cost: as dt_triangulate. */
enum dt_status past_copy(struct job *j, const struct dt_view *view,
                         const struct dt_field *const *field, size_t n, bool skip,
                         struct past *out);

/* The memory that it takes while it copies n fields, at most. */
size_t past_memory(const struct version *v, size_t n, const struct dt_options *opt);
