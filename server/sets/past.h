/* past.h - a private copy of the points and one field of a set, as of the moment of a view. It serves a reader that needs the
 * whole triangulation of that moment although the set has been edited since. The triangulation depends on the points
 * alone, so the copy has the triangulation that the set had. */
#ifndef SERVER_PAST_H
#define SERVER_PAST_H

#include "core/delaunay_fields.h"
#include "server/sets/dataset.h"

struct past {
    struct dt *dt; /* owns */
    const struct dt_field *field;
};

/* Copies the representatives, with their ids and the values of f, and triangulates them; DT_NOMEM also if `memory` has
 * no room. If `visits`, the caller is a visitor of the version, on return too; in between it leaves, after pieces of
 * less than a millisecond. opt: its flag is polled. `memory` then has the bytes of the copy. Cost: as
 * dt_triangulate. */
enum dt_status past_copy(struct version *v, const struct dt_view *view, const struct dt_field *f,
                         const struct dt_options *opt, bool visits, struct reservation *memory,
                         struct past *out);

#endif
