/* hull.c - finds the hull of a finished mesh and its canonical start. */
#include "core/mesh/hull.h"

#include "core/memory/memory.h"

/* Whether a loop should take its next step; polls every DT_POLL steps. */
static bool go_on(uint32_t step, struct dt_stop *stop)
{
    return step % DT_POLL != 0 || !dt_stopped(stop);
}

/* Like the grid, a large hull mostly runs through memory in one direction for a while. Processors do not predict its
 * strides, so records further on in that direction are prefetched. */
static void fetch_further_on(const struct dt_mesh *m, uint32_t g, uint32_t next)
{
    enum { AHEAD = 32 * 8, LINE = 16 }; /* numbers in 32 records, in a cache line */
    uint32_t h = next > g ? next + AHEAD : next - AHEAD;
    if (h >= 8 * m->tri_end - LINE)
        return;
    dt_fetch(&m->half[h]);
    dt_fetch(&m->half[h + LINE]);
}

uint32_t dt_hull_settle(struct dt_mesh *m, uint32_t ghost, struct dt_stop *stop)
{
    uint32_t g = m->hull = ghost, ghosts = 0;
    do {
        uint32_t next = dt_hull_step(m, g, false);
        fetch_further_on(m, g, next);
        m->leaving[dt_hull_vertex(m, g)] = g + 1;
        g = next;
    } while (go_on(++ghosts, stop) && g != m->hull);
    return ghosts;
}

/* ---- its canonical start ---- */

/* The end of a line with the smaller id, or the other end. */
static uint32_t first_on_line(const struct dt_mesh *m, const uint32_t *id, bool other)
{
    uint32_t best = DT_NONE, g = m->hull;
    do {
        uint32_t next = dt_hull_step(m, g, false);
        if (dt_hull_turns(m, g)) {
            bool smaller =
                best == DT_NONE || id[dt_hull_vertex(m, next)] < id[dt_hull_vertex(m, best)];
            if (best == DT_NONE || smaller != other)
                best = next;
        }
        g = next;
    } while (g != m->hull);
    return best;
}

uint32_t dt_hull_first(const struct dt_mesh *m, const uint32_t *id, bool cw)
{
    if (m->vertices < 2)
        return DT_NONE;
    if (dt_mesh_is_line(m))
        return first_on_line(m, id, cw);
    uint32_t best = m->hull, g = best;
    while ((g = dt_hull_step(m, g, false)) != m->hull)
        if (id[dt_hull_vertex(m, g)] < id[dt_hull_vertex(m, best)])
            best = g;
    return best;
}
