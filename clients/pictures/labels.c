/* labels.c - see labels.h. Greedy: earlier labels have the better places. A box is entered in each cell that it meets. */
#include "clients/pictures/labels.h"

#include <math.h>
#include <stdint.h>
#include <stdlib.h>

#include "clients/lib/array.h"

bool labels_init(struct labels *l, double width, double height, double size, size_t n)
{
    *l = (struct labels){.width = width, .height = height, .cell = size, .cells = 16};
    while (l->cells < 2 * n)
        l->cells *= 2;
    l->first = calloc(l->cells, sizeof l->first[0]);
    return l->first != NULL;
}

void labels_free(struct labels *l)
{
    free(l->first);
    free(l->entry);
    *l = (struct labels){.cell = 0};
}

static size_t slot(const struct labels *l, int64_t column, int64_t row)
{
    uint64_t key = (uint64_t)column * 0x9E3779B97F4A7C15u ^ (uint64_t)row * 0xC2B2AE3D27D4EB4Fu;
    return (size_t)(key >> 20) & (l->cells - 1);
}

static bool meet(const struct label_box *a, const struct label_box *b)
{
    return a->x0 < b->x1 && b->x0 < a->x1 && a->y0 < b->y1 && b->y0 < a->y1;
}

static int64_t cell_of(const struct labels *l, double v)
{
    return (int64_t)floor(v / l->cell);
}

static bool is_free(const struct labels *l, const struct label_box *b)
{
    if (b->x0 < 0 || b->y0 < 0 || b->x1 > l->width || b->y1 > l->height)
        return false;
    for (int64_t i = cell_of(l, b->x0); i <= cell_of(l, b->x1); i++)
        for (int64_t k = cell_of(l, b->y0); k <= cell_of(l, b->y1); k++)
            for (size_t e = l->first[slot(l, i, k)]; e != 0; e = l->entry[e - 1].next)
                if (meet(&l->entry[e - 1].box, b))
                    return false;
    return true;
}

/* False when out of memory. */
static bool enter(struct labels *l, const struct label_box *b)
{
    for (int64_t i = cell_of(l, b->x0); i <= cell_of(l, b->x1); i++)
        for (int64_t k = cell_of(l, b->y0); k <= cell_of(l, b->y1); k++) {
            if (!array_reserve((void **)&l->entry, &l->room, l->entries + 1, sizeof l->entry[0]))
                return false;
            size_t *first = &l->first[slot(l, i, k)];
            l->entry[l->entries] = (struct label_entry){*b, *first};
            *first = ++l->entries;
        }
    return true;
}

bool labels_take(struct labels *l, const struct label_box *box, size_t n)
{
    for (size_t i = 0; i < n; i++)
        if (!is_free(l, &box[i]))
            return false;
    for (size_t i = 0; i < n; i++)
        if (!enter(l, &box[i]))
            return false;
    return true;
}

bool labels_place(struct labels *l, double x, double y, double away, double wide, double high,
                  struct label_box *box)
{
    /* left edge and upper edge, from the point */
    const double near = 0.7 * away;
    const double place[][2] = {{near, -near - high},
                               {-near - wide, -near - high},
                               {near, near},
                               {-near - wide, near},
                               {away, -high / 2},
                               {-away - wide, -high / 2},
                               {-wide / 2, -away - high},
                               {-wide / 2, away}};
    for (size_t i = 0; i < sizeof place / sizeof place[0]; i++) {
        *box = (struct label_box){x + place[i][0], y + place[i][1], x + place[i][0] + wide,
                                  y + place[i][1] + high};
        if (is_free(l, box))
            return enter(l, box);
    }
    return false;
}
