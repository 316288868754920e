/* outgoing.c - which own points other tiles need: the faces that meet their boxes (delaunay_tiles.h).
 *
 * The first call judges the faces in the order of memory. Most ghosts and large circles exist only because the tile does not
 * know the points around it yet; they meet the boxes of many tiles, near and far. So the first call postpones them, and sends the extreme
 * points of the tile everywhere. The next call judges those that the points of the other tiles have left.
 *
 * Later calls judge the faces that insertions have made since: they have a corner that was inserted. They are found around these
 * corners, each at its corner with the greatest local id. */
#include "core/tiles/tile.h"

#include <stdlib.h>
#include <string.h>

#include "core/arrays/workers.h"
#include "core/memory/memory.h"
#include "core/mesh/hull.h"
#include "core/tiles/boxes.h"
#include "core/tiles/disc.h"

struct judge {
    const struct dt_tile *tile;
    const struct dt_mesh *mesh;
    const struct dt_point *xy; /* by vertex */
    const uint32_t *id;        /* local ids by vertex */
    struct dt_boxes boxes;     /* of the other tiles */
    bool apart;                /* none of them meets the box of this tile */
    struct dt_pairs found;
    bool postpones; /* ghosts, and circles with a reach above `most` */
    double most;
    struct dt_ids postponed; /* half edges: triangles of faces */
    uint32_t own[3];         /* local ids: the own corners of the face that is judged */
    unsigned owns;
};

/* ---- what is sent ---- */

/* Selects the own ones of n corners; false: there are none. */
static bool select_own(struct judge *j, const uint32_t *corner, unsigned n)
{
    j->owns = 0;
    for (unsigned i = 0; i < n; i++) {
        uint32_t local = j->id[corner[i]];
        if (dt_is_own(j->tile, local))
            j->own[j->owns++] = local;
    }
    return j->owns > 0;
}

static enum dt_status send_to(void *ctx, uint32_t tile)
{
    struct judge *j = ctx;
    enum dt_status s = DT_OK;
    for (unsigned i = 0; i < j->owns && s == DT_OK; i++)
        s = dt_pairs_add(&j->found, dt_pair(tile, j->own[i]));
    return s;
}

static bool always(const void *shape, const struct dt_box *box)
{
    (void)shape, (void)box;
    return true;
}

/* To every tile, if it is an own point. */
static enum dt_status send_everywhere(struct judge *j, uint32_t v)
{
    return select_own(j, &v, 1)
               ? dt_boxes_visit(&j->boxes, &(struct dt_boxes_query){always, NULL, send_to, j})
               : DT_OK;
}

/* ---- faces ---- */

static bool disc_meets(const void *shape, const struct dt_box *box)
{
    return dt_reach_meets(shape, box);
}

static enum dt_status judge_triangle(struct judge *j, const uint32_t *corner)
{
    struct dt_point a = j->xy[corner[0]], b = j->xy[corner[1]], c = j->xy[corner[2]];
    if (j->apart && dt_disc_deep(a, b, c, &j->tile->box))
        return DT_OK;
    struct dt_disc disc;
    bool sure = dt_disc_of(a, b, c, &disc);
    if (sure && j->apart && dt_disc_inside(&disc, &j->tile->box))
        return DT_OK;
    if (!select_own(j, corner, 3))
        return DT_OK;
    struct dt_reach reach = dt_reach_of(&disc, sure, a, b, c);
    if (j->postpones && reach.reach > j->most)
        return dt_ids_append(&j->postponed, (uint32_t)(corner - j->mesh->half));
    return dt_boxes_visit(&j->boxes, &(struct dt_boxes_query){disc_meets, &reach, send_to, j});
}

static bool beyond_meets(const void *shape, const struct dt_box *box)
{
    return dt_beyond_meets(shape, box);
}

static enum dt_status judge_ghost(struct judge *j, uint32_t g)
{
    const uint32_t *corner = j->mesh->half + g;
    enum dt_status s = DT_OK;
    if (j->postpones)
        return dt_ids_append(&j->postponed, g);
    if (dt_mesh_is_line(j->mesh) && dt_hull_turns(j->mesh, g))
        s = send_everywhere(j, dt_hull_successor(j->mesh, g));
    if (s != DT_OK || !select_own(j, corner, 2))
        return s;
    struct dt_beyond beyond = {j->xy[corner[0]], j->xy[corner[1]], {{0, 0}, {0, 0}}};
    beyond.edge = dt_box_of((struct dt_point[]){beyond.a, beyond.b}, 2);
    return dt_boxes_visit(&j->boxes, &(struct dt_boxes_query){beyond_meets, &beyond, send_to, j});
}

static enum dt_status judge_face(struct judge *j, uint32_t t)
{
    const uint32_t *corner = j->mesh->half + t;
    return corner[2] == DT_NONE ? judge_ghost(j, t) : judge_triangle(j, corner);
}

/* The own points farthest to the lower left, the upper right, and the other two corners. */
static enum dt_status send_extremes(struct judge *j)
{
    uint32_t found[4];
    double most[4] = {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL, -HUGE_VAL};
    for (uint32_t v = 0; v < j->tile->t->points.end; v++) {
        struct dt_point p = j->xy[v];
        const double along[4] = {-p.x - p.y, p.x + p.y, p.x - p.y, p.y - p.x};
        for (unsigned k = 0; k < 4; k++)
            if (along[k] > most[k]) {
                most[k] = along[k];
                found[k] = v;
            }
    }
    enum dt_status s = DT_OK;
    for (unsigned k = 0; k < 4 && s == DT_OK; k++)
        s = send_everywhere(j, found[k]);
    return s;
}

static enum dt_status judge_all(struct judge *j)
{
    enum dt_status s = j->postpones ? send_extremes(j) : DT_OK;
    for (uint32_t i = 0; i < j->mesh->tri_end && s == DT_OK; i++)
        if (!dt_is_dead(j->mesh, 8 * i))
            s = judge_face(j, 8 * i);
    if (s == DT_OK && j->mesh->vertices == 1)
        s = send_everywhere(j, j->mesh->alone);
    return s;
}

/* Records of faces that have gone may have been used again, for faces that have yet to be judged or are judged twice. */
static enum dt_status judge_postponed(struct judge *j)
{
    const struct dt_ids *faces = &j->tile->postponed;
    enum dt_status s = DT_OK;
    for (size_t i = 0; i < faces->n && s == DT_OK; i++)
        if (!dt_is_dead(j->mesh, faces->v[i]))
            s = judge_face(j, faces->v[i]);
    return s;
}

/* Whether the face at t has the corner with this local id as its greatest. */
static bool is_greatest(const struct judge *j, uint32_t t, uint32_t local)
{
    const uint32_t *corner = j->mesh->half + t;
    bool greater = j->id[corner[0]] > local || j->id[corner[1]] > local;
    return !greater && (corner[2] == DT_NONE || j->id[corner[2]] <= local);
}

static enum dt_status judge_new(struct judge *j)
{
    enum dt_status s = judge_postponed(j);
    for (uint32_t local = j->tile->judged; local < j->tile->points && s == DT_OK; local++) {
        uint32_t first = j->mesh->leaving[dt_points_vertex(&j->tile->t->points, local)], h = first;
        if (first == DT_NONE)
            continue;
        do {
            if (is_greatest(j, dt_base(h), local))
                s = judge_face(j, dt_base(h));
            h = dt_turn_ccw(j->mesh, h);
        } while (h != first && s == DT_OK);
    }
    return s;
}

/* ---- a call ---- */

static bool box_overlaps(const void *shape, const struct dt_box *box)
{
    return dt_box_overlaps(shape, box);
}

static enum dt_status note(void *ctx, uint32_t tile)
{
    *(bool *)ctx = false;
    return DT_OK;
}

static bool is_apart(const struct dt_tile *tile, const struct dt_boxes *b)
{
    bool apart = true;
    dt_boxes_visit(b, &(struct dt_boxes_query){box_overlaps, &tile->box, note, &apart});
    return apart;
}

/* The pairs, by tile, as offsets and vertices. */
static enum dt_status write_pairs(const struct dt_pairs *p, size_t tiles, int64_t *offset,
                                  struct dt_ids *vertex)
{
    vertex->n = 0;
    if (p->n > 0 && dt_ids_reserve(vertex, p->n) != DT_OK)
        return DT_NOMEM;
    for (size_t k = 0, i = 0; k <= tiles; k++) {
        while (i < p->n && p->v[i] >> 32 < k)
            i++;
        offset[k] = (int64_t)i;
    }
    for (size_t i = 0; i < p->n; i++)
        vertex->v[vertex->n++] = (uint32_t)p->v[i];
    return DT_OK;
}

/* Few tiles need no second look, and of points on one line all faces are needed. */
static void plan(struct judge *j)
{
    enum { FEW = 3 };
    const struct dt_box *box = &j->tile->box;
    j->apart = is_apart(j->tile, &j->boxes);
    j->postpones = !j->tile->opened && j->boxes.n > FEW && !dt_mesh_is_line(j->mesh);
    j->most = (dt_box_width(box) + dt_box_height(box)) / 16;
}

/* The pairs count as returned, and the postponed faces wait for the next call. */
static void settle(struct dt_tile *tile, struct judge *j)
{
    free(tile->postponed.v);
    tile->postponed = j->postponed;
    j->postponed = (struct dt_ids){0};
    tile->judged = tile->points;
    tile->opened = true;
}

static enum dt_status open_tile(struct dt_tile *tile, struct judge *j, size_t tiles,
                                int64_t *offset, struct dt_ids *vertex)
{
    plan(j);
    enum dt_status s = tile->judged == 0 ? judge_all(j) : judge_new(j);
    if (s != DT_OK)
        return s;
    dt_pairs_sort(&j->found);
    dt_pairs_subtract(&j->found, &tile->sent);
    s = write_pairs(&j->found, tiles, offset, vertex);
    if (s == DT_OK)
        s = dt_pairs_merge(&tile->sent, &j->found);
    if (s == DT_OK)
        settle(tile, j);
    return s;
}

enum dt_status dt_tile_open(struct dt_tile *tile, const double *box, size_t tiles, size_t me,
                            int64_t *offset, struct dt_ids *vertex)
{
    if (tiles >= DT_NONE || me >= tiles)
        return DT_RANGE;
    fenv_t caller = dt_call_begin();
    struct judge j = {
        .tile = tile, .mesh = &tile->t->mesh, .xy = tile->t->points.xy, .id = tile->t->points.id};
    enum dt_status s = dt_boxes_new(box, (uint32_t)tiles, (uint32_t)me, &j.boxes);
    if (s == DT_OK)
        s = dt_tile_refresh(tile);
    if (s == DT_OK)
        s = open_tile(tile, &j, tiles, offset, vertex);
    dt_pairs_clear(&j.found);
    free(j.postponed.v);
    dt_boxes_clear(&j.boxes);
    dt_call_end(&caller);
    return s;
}
