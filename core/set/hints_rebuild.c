/* hints_rebuild.c - the grid of hints is made when it is first needed, and rebuilt when it has degraded.
 *
 * A triangulation is complete without the grid, and many sets are never searched. So a build
 * makes no grid; the first search (dt_prepare) or edit makes it.
 *
 * Edits degrade the grid: there are more vertices than it was made for, or its half edges have moved, and walks
 * from them grow longer. Then it is rebuilt.
 *
 * A rebuild takes linear time, all at once. In a small set, the edit that finds the grid too old rebuilds it.
 * In a large set, the caller should rebuild it (dt_renew_due, dt_renew). If the caller does not, a later edit
 * does. */
#include "core/set/set.h"

#include <stdlib.h>

#include "core/control/stop.h"

#define AT_ONCE 4000 /* vertices of a set whose grid an edit rebuilds: a quarter of a millisecond */
#define OVERDUE 4    /* times too old */

struct dt_renewal {
    struct dt_hints hints;
};

/* Whether the grid is too old by that factor: the set has outgrown it, or walks have cost as much as
 * a new one. */
static bool is_old(const struct dt *t, uint32_t factor)
{
    uint64_t n = t->mesh.vertices, hinted = t->hinted;
    return n >= 2 * factor * hinted || n * 4 * factor < hinted || t->steps >= factor * (n + 1000);
}

static void take(struct dt *t, struct dt_hints *fresh)
{
    dt_hints_clear(&t->hints);
    t->hints = *fresh;
    t->mesh.recycled = false;
}

/* From now on the grid counts as new, even if there was no memory for a new one. Then the old grid, or none,
 * serves for the same period again. */
static void reset_counts(struct dt *t)
{
    t->hinted = t->mesh.vertices;
    t->steps = 0;
}

void dt_tend(struct dt *t, const struct dt_stop *work)
{
    if (!t->current || (!dt_lacks_grid(t) && !is_old(t, t->mesh.vertices > AT_ONCE ? OVERDUE : 1)))
        return;
    if (!dt_work_allows(work, t->mesh.vertices))
        return;
    struct dt_hints fresh = {0};
    struct dt_options opt = {.cancel = work == NULL ? NULL : work->cancel};
    enum dt_status status = dt_hints_build(&fresh, &t->mesh, t->points.xy, &opt);
    if (status == DT_CANCELLED)
        return;
    reset_counts(t);
    if (status == DT_OK)
        take(t, &fresh);
}

enum dt_status dt_prepare(struct dt *t, const struct dt_options *opt)
{
    struct dt_renewal *r;
    if (!dt_is_live(t) || !dt_lacks_grid(t))
        return DT_OK;
    enum dt_status status = dt_renew(t, opt, &r);
    if (status != DT_CANCELLED)
        dt_renewed(t, r);
    return status;
}

bool dt_renew_due(const struct dt *t)
{
    return t->triangulated && t->current && t->hints.grids > 0 && t->mesh.vertices > AT_ONCE &&
           is_old(t, 1);
}

enum dt_status dt_renew(const struct dt *t, const struct dt_options *opt, struct dt_renewal **out)
{
    struct dt_renewal *r = calloc(1, sizeof *r);
    enum dt_status status = DT_NOMEM;
    if (r != NULL)
        status = dt_hints_build(&r->hints, &t->mesh, t->points.xy, opt);
    if (status != DT_OK) {
        free(r);
        r = NULL;
    }
    *out = r;
    return status;
}

void dt_renewed(struct dt *t, struct dt_renewal *r)
{
    reset_counts(t);
    if (r != NULL)
        take(t, &r->hints);
    free(r);
}

void dt_renewal_free(struct dt_renewal *r)
{
    if (r != NULL)
        dt_hints_clear(&r->hints);
    free(r);
}
