/* boxes.h - the boxes of tiles in an implicit tree, so that few of them are compared with a face.
 *
 * Every node has the box around a range of tiles. The range is split in the middle, by the centres along the longer side of that box: node
 * k has the halves 2 k and 2 k + 1, node 1 has all. */
#pragma once

#include "core/exact/box.h"

struct dt_boxes {
    struct dt_box *node; /* owns */
    uint32_t *tile;      /* owns n, in the order of the ranges */
    uint32_t n;
};

/* Of box[4 tiles], as dt_tile_open has them, without tile `me` and without empty ones. DT_RANGE, DT_NOMEM: nothing to free. Cost:
 * O(n log^2 n). */
enum dt_status dt_boxes_new(const double *box, uint32_t tiles, uint32_t me, struct dt_boxes *out);
void dt_boxes_clear(struct dt_boxes *b);

/* Calls hit(ctx, tile) for every tile whose box meets(shape, box) and whose nodes' boxes do; the first failure ends it. */
struct dt_boxes_query {
    bool (*meets)(const void *shape, const struct dt_box *box);
    const void *shape;
    enum dt_status (*hit)(void *ctx, uint32_t tile);
    void *ctx;
};
enum dt_status dt_boxes_visit(const struct dt_boxes *b, const struct dt_boxes_query *q);
