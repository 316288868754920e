/* regions_due.c - the regions of a set: found when a query is going to need them, and forgotten when borders change. */
#include "core/delaunay_surface.h"
#include "core/set/set.h"

bool dt_surveyed(const struct dt *t)
{
    return !dt_is_constrained(t) || t->constraints->regions.current;
}

bool dt_has_borders(const struct dt *t)
{
    return dt_is_constrained(t) && t->constraints->declared.borders > 0;
}

bool dt_view_has_regions(const struct dt *t, const struct dt_view *v)
{
    uint64_t now = t->constraints == NULL ? 0 : dt_history_now(&t->constraints->history);
    return v->constraints == now && dt_view_is_current(t, v);
}

enum dt_status dt_survey(struct dt *t, const struct dt_options *opt)
{
    struct dt_stop work = dt_stop_of(opt);
    if (!dt_is_live(t))
        return DT_UNTRIANGULATED;
    if (dt_surveyed(t))
        return DT_OK;
    if (!dt_work_allows(&work, t->mesh.tri_end))
        return DT_TOOLONG;
    work.left = UINT64_MAX;
    return dt_regions_survey(&t->constraints->regions, &t->mesh, &t->points,
                             &t->constraints->declared, &work);
}

/* Returns how many parts of constraints lie on edges, at most. */
static size_t count_parts(const struct dt_mesh *m)
{
    size_t parts = 0;
    for (uint32_t t = 0; m->fixed != NULL && t < m->tri_end; t++)
        parts += (size_t)__builtin_popcount(m->half[8 * t + 3] & 7);
    parts /= 2;
    for (uint32_t i = 0; m->fixed != NULL && i < m->fixed->cap; i++)
        parts += m->fixed->more[i].a != DT_NONE ? m->fixed->more[i].more : 0;
    return parts;
}

size_t dt_survey_memory(const struct dt *t)
{
    /* A row: two keys, twice, a region, and where its ranges begin. A part: its key, grown or sorted; where it is found; a door,
     * grown; a room, grown; a range, and its number; a bit. A triangle: on the stack, grown. */
    enum { ROW = 60, PART = 124, TRIANGLE = 8, SLACK = 16384 };
    if (!dt_is_live(t) || dt_surveyed(t))
        return 0;
    return t->constraints->declared.rows * (size_t)ROW + count_parts(&t->mesh) * PART +
           t->mesh.tri_end * (size_t)TRIANGLE + SLACK;
}
