/* reader.h - what all readers of a finished triangulation share. */
#ifndef DT_READER_H
#define DT_READER_H

#include "core/set/set.h"

/* DT_OK if the triangulation of the set can be read. */
static inline enum dt_status dt_readable(const struct dt *t)
{
    return t->triangulated && t->current ? DT_OK : DT_UNTRIANGULATED;
}

/* DT_OK if in addition id names a point; *v is the vertex of its representative then. */
static inline enum dt_status dt_read_vertex(const struct dt *t, uint32_t id, uint32_t *v)
{
    enum dt_status s = dt_readable(t);
    if (s != DT_OK)
        return s;
    *v = dt_points_vertex(&t->points, id);
    return *v == DT_NONE ? DT_NOPOINT : DT_OK;
}

/* Makes room for `more` ids after the existing ones; DT_NOMEM leaves *ids unchanged. */
enum dt_status dt_ids_reserve(struct dt_ids *ids, size_t more);

/* Appends one; DT_NOMEM leaves *ids unchanged. Cost: constant, amortised. */
static inline enum dt_status dt_ids_append(struct dt_ids *ids, uint32_t value)
{
    enum dt_status s = dt_ids_reserve(ids, 1);
    if (s == DT_OK)
        ids->v[ids->n++] = value;
    return s;
}

#endif
