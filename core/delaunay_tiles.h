/* delaunay_tiles.h - a part of the core's public header: triangulations of more points than one machine or one set
 * holds, computed tile by tile, for programs in any language. As in delaunay_arrays.h, every function computes with the
 * floating-point environment in which programs start.
 *
 * The points are divided into tiles. A tile has its own points and, later, foreign points: own points of other tiles. Every point has
 * a global id. The caller repeats rounds. In the first round every tile, later every tile that has received something, is asked for its own
 * points that other tiles need (dt_tile_open), and these are inserted there (dt_tile_insert). When no tile has anything to send, each tile
 * outputs the triangles whose smallest global id is its own. Together these are the triangles of all points, each of them once. The method
 * is that of L. Caraffa, M. Bredif, B. Vallet, "Tile & Merge: Distributed Delaunay Triangulations for Cloud Computing", 2019.
 *
 * Terms. The box of a tile is the bounding box of its own points. A face is a triangle or a ghost: a ghost stands for the outside of
 * a hull edge. A face is judged if one of its corners is the tile's own. A face meets a box if a point of the box might conflict
 * with the face: the closed disc of a triangle contains a point of the box; a point of the box is strictly beyond the hull edge
 * of a ghost, or is on that edge. Among points on one line each edge has two ghosts, and an end of the line meets every box, as does
 * a single point. Tests of faces and boxes may report too much, never too little.
 *
 * The rule. If a judged face of tile I meets the box of tile J, then the own corners of that face are sent to J, once.
 *
 * Why the result is right when nothing is left to be sent:
 *
 * 1. Let S(I) be the points of tile I, own and foreign, and DT(X) the triangulation of the set X. Ties are broken by coordinates alone,
 *    so DT(X) depends on X alone, and an edge of DT(all) whose ends are in X is an edge of DT(X).
 * 2. Claim: if v is an own point of I, and the edge vu is in DT(all), then u is in S(I).
 * 3. Suppose that u is not in S(I). Then u is an own point of another tile J.
 * 4. The edge vu is in DT(S(I) + u), by step 1. So u conflicts with a face of DT(S(I)) that has the corner v, or S(I) is v alone. Or all
 *    of S(I) is on one line with u, and v is its end next to u. In each case a judged face at v meets the box of J, which contains u.
 * 5. So v has been sent to J: v is in S(J). By step 1 the edge vu is in DT(S(J)).
 * 6. A face at the edge vu in DT(S(J)) is judged, because u is J's own. It meets the box of I, which contains v: v is a
 *    corner. So u has been sent to I. That contradicts step 3, and proves the claim.
 * 7. So S(I) contains v and all its neighbours in DT(all). The star of v in DT(S(I)) is then its star in DT(all).
 * 8. A triangle of DT(all) is in the star of its corner with the smallest id. The owner of this corner, and no other tile, outputs it.
 *
 * Faces without own corners need not be judged, and foreign corners need not be sent: steps 4 to 6 do not use them.
 *
 * Coincident points must be in one tile; the one with the smallest id represents them. Boxes need not be disjoint. If they are, most
 * triangles are recognised at once: their circles are inside the tile's own box. */
#pragma once

#include "core/delaunay.h"

#ifdef __cplusplus
extern "C" {
#endif

struct dt_tile;

/* A tile of n own points p[n] with the global ids id[n], strictly ascending; n may be 0. pages, a keeper, may be NULL. workers: as in
 * delaunay_arrays.h. A local id is the row of an own point. DT_RANGE: a coordinate or the order of ids; DT_TOOBIG, DT_NOMEM. The
 * caller owns *out. Cost: that of dt_triangulate. Memory: about 110 bytes a point. */
enum dt_status dt_tile_new(const struct dt_point *p, const uint64_t *id, size_t n,
                           struct dt_pages *pages, unsigned workers, struct dt_tile **out);
void dt_tile_free(struct dt_tile *tile); /* NULL: nothing */

/* The figures of a tile.
 *
 *   own         own points, coincident ones included
 *   foreign     points inserted
 *   coincident  own points that another own point represents
 *   triangles   of own and foreign points together: an upper limit of the rows of dt_tile_triangles
 *   postponed   faces that the next dt_tile_open will judge */
struct dt_tile_counts {
    uint64_t own, foreign, coincident, triangles, postponed;
};
void dt_tile_counts(const struct dt_tile *tile, struct dt_tile_counts *out); /* cost: constant */

/* Inserts n foreign points p[n] with the global ids id[n], in any order. Points that the tile has already are ignored. DT_RANGE: a
 * coordinate; or a point coincides with a point of another id, or an own id arrives from outside. DT_TOOBIG, DT_NOMEM. An error
 * changes nothing. Cost: that of dt_add_many. */
enum dt_status dt_tile_insert(struct dt_tile *tile, const struct dt_point *p, const uint64_t *id,
                              size_t n);

/* Returns what other tiles need of this one and has not been returned before. Tile k needs the local ids vertex->v[offset[k]] to
 * vertex->v[offset[k + 1] - 1], which ascend.
 *
 *   box[4 tiles]  the boxes of all tiles: x0, y0, x1, y1, nan for a tile without own points; the same in every call
 *   me            the number of this tile, below `tiles`
 *   offset        has room for tiles + 1
 *   *vertex       starts with {0}; the caller releases vertex->v by free or dt_arrays_release
 *
 * Later calls look at the faces that insertions have made since. The first call may postpone faces; then it sends points to all other
 * tiles. So a tile that postpones receives something, if all tiles are opened before anything is inserted. Other callers open a tile
 * again until it has nothing postponed. DT_RANGE: a box or `me`. DT_NOMEM: nothing counts as returned. Cost: linear in the triangles at the
 * first call, in the points inserted at later ones; O(log tiles) for each face near the border and each pair. */
enum dt_status dt_tile_open(struct dt_tile *tile, const double *box, size_t tiles, size_t me,
                            int64_t *offset, struct dt_ids *vertex);

/* The triangles that this tile outputs: global ids, counterclockwise from the smallest one, rows ascending. Numbers are uint64_t if `wide`,
 * otherwise uint32_t. triangle has room for 3 of them for each of dt_tile_counts.triangles rows. *rows: how many were written;
 * numbers behind them are undefined. DT_RANGE: an id does not fit. DT_NOMEM. Cost: linear; 20 bytes for each point, meanwhile. */
enum dt_status dt_tile_triangles(const struct dt_tile *tile, bool wide, void *triangle,
                                 size_t *rows);

#ifdef __cplusplus
}
#endif
