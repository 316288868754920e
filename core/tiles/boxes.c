/* boxes.c - see boxes.h. */
#include "core/tiles/boxes.h"

#include <math.h>
#include <stdlib.h>

#include "core/memory/memory.h"

/* A tile while the tree is made. */
struct item {
    struct dt_box box;
    double key; /* twice the centre along the axis of the split */
    uint32_t tile;
};

static int compare(const void *a, const void *b)
{
    const struct item *x = a, *y = b;
    return x->key != y->key ? (x->key < y->key ? -1 : 1) : (x->tile < y->tile ? -1 : 1);
}

/* Makes node k, of the n > 0 items from the one of rank `first` on. */
static void split(struct dt_boxes *b, uint32_t k, struct item *item, uint32_t first, uint32_t n)
{
    struct dt_box all = item[0].box;
    for (uint32_t i = 1; i < n; i++)
        all = dt_box_join(all, item[i].box);
    b->node[k] = all;
    if (n == 1) {
        b->tile[first] = item[0].tile;
        return;
    }
    bool by_x = dt_box_axis(&all) == 0;
    for (uint32_t i = 0; i < n; i++)
        item[i].key =
            by_x ? item[i].box.lo.x + item[i].box.hi.x : item[i].box.lo.y + item[i].box.hi.y;
    qsort(item, n, sizeof *item, compare);
    split(b, 2 * k, item, first, n / 2);
    split(b, 2 * k + 1, item + n / 2, first + n / 2, n - n / 2);
}

/* DT_RANGE: it is neither a box nor empty. */
static enum dt_status read_box(const double *v, struct dt_box *box, bool *empty)
{
    *empty = isnan(v[0]) && isnan(v[1]) && isnan(v[2]) && isnan(v[3]);
    *box = (struct dt_box){{v[0], v[1]}, {v[2], v[3]}};
    bool ok = dt_coordinates_ok(v, 4) && v[0] <= v[2] && v[1] <= v[3];
    return *empty || ok ? DT_OK : DT_RANGE;
}

static enum dt_status read_items(const double *box, uint32_t tiles, uint32_t me, struct item *item,
                                 uint32_t *n)
{
    enum dt_status s = DT_OK;
    *n = 0;
    for (uint32_t k = 0; k < tiles && s == DT_OK; k++) {
        bool empty;
        s = read_box(box + 4 * (size_t)k, &item[*n].box, &empty);
        item[*n].tile = k;
        *n += k != me && !empty;
    }
    return s;
}

/* The last level of the tree has fewer than 2 n nodes, all levels fewer than 4 n. */
enum dt_status dt_boxes_new(const double *box, uint32_t tiles, uint32_t me, struct dt_boxes *out)
{
    struct item *item = dt_array_new((size_t)tiles + 1, sizeof *item);
    *out = (struct dt_boxes){0};
    enum dt_status s = item == NULL ? DT_NOMEM : read_items(box, tiles, me, item, &out->n);
    if (s == DT_OK) {
        out->node = dt_array_new(4 * (size_t)out->n + 1, sizeof *out->node);
        out->tile = dt_array_new((size_t)out->n + 1, sizeof *out->tile);
        s = out->node == NULL || out->tile == NULL ? DT_NOMEM : DT_OK;
    }
    if (s == DT_OK && out->n > 0)
        split(out, 1, item, 0, out->n);
    if (s != DT_OK)
        dt_boxes_clear(out);
    dt_array_free(item);
    return s;
}

void dt_boxes_clear(struct dt_boxes *b)
{
    dt_array_free(b->node);
    dt_array_free(b->tile);
    *b = (struct dt_boxes){0};
}

static enum dt_status visit(const struct dt_boxes *b, const struct dt_boxes_query *q, uint32_t k,
                            uint32_t first, uint32_t n)
{
    if (!q->meets(q->shape, &b->node[k]))
        return DT_OK;
    if (n == 1)
        return q->hit(q->ctx, b->tile[first]);
    enum dt_status s = visit(b, q, 2 * k, first, n / 2);
    return s == DT_OK ? visit(b, q, 2 * k + 1, first + n / 2, n - n / 2) : s;
}

enum dt_status dt_boxes_visit(const struct dt_boxes *b, const struct dt_boxes_query *q)
{
    return b->n == 0 ? DT_OK : visit(b, q, 1, 0, b->n);
}
