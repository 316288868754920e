/* regions_find_one.c - finds what a border encloses if there are no other constraints; see regions.h.
 *
 * The mesh knows which edges are its sides (flood.h), so neither sides nor rooms need lists as in regions_find.c. There are two faces,
 * outside and inside, which are any number of pieces of the plane. */
#include <stdlib.h>

#include "core/constraints/flood.h"
#include "core/constraints/regions.h"
#include "core/mesh/fixed.h"

enum { FACES = DT_FLOOD_INSIDE + 1 };

bool dt_is_one_border(const struct dt_declared *d)
{
    uint32_t what = DT_NONE;
    if (d->rows == 0 || d->borders != d->rows)
        return false;
    for (uint32_t i = 0; i < d->end; i++) {
        if (!dt_declared_is_live(d, i))
            continue;
        if (what != DT_NONE && d->row[i].what != what)
            return false;
        what = d->row[i].what;
    }
    return true;
}

/* Whether every vertex is the end of an even number of constraints. */
static enum dt_status find_closed(const struct dt_points *p, const struct dt_declared *d,
                                  bool *closed)
{
    uint64_t *odd = calloc(p->end / 64 + (size_t)1, sizeof *odd), any = 0;
    if (odd == NULL)
        return DT_NOMEM;
    for (uint32_t i = 0; i < d->end; i++)
        for (int k = 0; k < 2 && dt_declared_is_live(d, i); k++) {
            uint32_t v = dt_points_vertex(p, d->row[i].end[k]);
            odd[v / 64] ^= (uint64_t)1 << v % 64;
        }
    for (uint32_t i = 0; i <= p->end / 64; i++)
        any |= odd[i];
    free(odd);
    *closed = any == 0;
    return DT_OK;
}

/* The region and its range of faces, which an open border has not. */
static enum dt_status make_region(struct dt_regions *r, uint32_t number, bool closed)
{
    r->region = calloc(1, sizeof *r->region);
    r->range = calloc(1, sizeof *r->range);
    r->sorted = calloc(1, sizeof *r->sorted);
    r->start = calloc(3, sizeof *r->start);
    r->inside = calloc(FACES, sizeof *r->inside);
    if (r->region == NULL || r->range == NULL || r->sorted == NULL || r->start == NULL ||
        r->inside == NULL)
        return DT_NOMEM;
    r->region[0] = (struct dt_region){.number = number, .closed = closed};
    r->n = 1;
    r->ranges = closed;
    r->range[0] =
        (struct dt_region_range){DT_FLOOD_INSIDE, DT_FLOOD_INSIDE + 1, 0, DT_FLOOD_INSIDE + 1};
    r->start[1] = r->start[2] = closed;
    r->inside[DT_FLOOD_INSIDE] = closed;
    r->faces = FACES;
    return DT_OK;
}

enum dt_status dt_regions_survey_one(struct dt_regions *r, struct dt_mesh *m,
                                     const struct dt_points *p, const struct dt_declared *d,
                                     struct dt_stop *work)
{
    struct dt_sum twice = {0};
    uint32_t row = 0;
    bool closed;
    while (!dt_declared_is_live(d, row))
        row++;
    enum dt_status status = find_closed(p, d, &closed);
    if (status == DT_OK)
        status = make_region(r, d->row[row].what >> 1, closed);
    for (uint32_t t = 0; status == DT_OK && !closed && t < m->tri_end; t++)
        dt_face_set(m, 8 * t, 0);
    if (status == DT_OK && closed)
        dt_flood_begin(m);
    if (status == DT_OK && closed)
        status = dt_flood(m, p->xy, NULL, 0, work, &twice);
    if (status == DT_OK) {
        r->area = r->region[0].area = dt_sum_half(&twice);
        r->current = true;
    }
    return status;
}
