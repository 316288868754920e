/* labels.h - finds places for texts beside points, so that none covers another. */
#pragma once

#include <stdbool.h>
#include <stddef.h>

struct label_box {
    double x0, y0, x1, y1;
};

struct labels {
    double width, height; /* of the frame, in which labels are */
    double cell;          /* side of a cell of the grid in which boxes are looked up */
    size_t cells;         /* a power of two */
    size_t *first;        /* owns: of the boxes that meet a cell, by hash; entries + 1; 0: none */
    struct label_entry {
        struct label_box box;
        size_t next;
    } * entry; /* owns */
    size_t entries, room;
};

/* For about n labels of at most this size. False when out of memory. */
bool labels_init(struct labels *l, double width, double height, double size, size_t n);
void labels_free(struct labels *l);

/* Takes all of these places, or none if one of them is taken or not in the frame; they may overlap each other. */
bool labels_take(struct labels *l, const struct label_box *box, size_t n);

/* Finds a free place for a text that is wide x high beside the point x, y, as far away as `away`; on the upper right if that is
 * free. False if there is none. The place is taken. */
bool labels_place(struct labels *l, double x, double y, double away, double wide, double high,
                  struct label_box *box);
