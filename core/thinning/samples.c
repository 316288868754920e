/* samples.c - see samples.h. */
#include "core/thinning/samples.h"

#include "core/exact/box.h"
#include "core/memory/memory.h"
#include "core/memory/sort.h"

#include <math.h>

enum { CELL_BITS = 16 }; /* of a column's number, and of a row's */

/* Puts a zero between any two bits. */
static uint64_t spread(uint64_t v)
{
    v = (v | v << 8) & 0x00ff00ff;
    v = (v | v << 4) & 0x0f0f0f0f;
    v = (v | v << 2) & 0x33333333;
    return (v | v << 1) & 0x55555555;
}

/* The number of the column of x in a box from lo on, or that of a row. */
static uint64_t cell_of(double x, double lo, double per)
{
    double cell = (x - lo) * per;
    return cell < (1 << CELL_BITS) - 1 ? (uint64_t)cell : (1 << CELL_BITS) - 1;
}

static double per_unit(double length)
{
    return length > 0 ? (1 << CELL_BITS) / length : 0;
}

static void make_keys(const struct dt_thinning *in, uint64_t *key, struct dt_stop *stop)
{
    const struct dt_box box = dt_box_of(in->point, in->n);
    const double side = fmax(dt_box_width(&box), dt_box_height(&box)), per = per_unit(side);
    for (struct dt_piece at = dt_pieces(0, in->n); dt_next_piece(stop, &at);)
        for (uint32_t i = at.a; i < at.b; i++) {
            uint64_t column = cell_of(in->point[i].x, box.lo.x, per);
            uint64_t row = cell_of(in->point[i].y, box.lo.y, per);
            key[i] = (spread(column) | spread(row) << 1) << 32 | i;
        }
}

static void copy(struct dt_samples *s, const struct dt_thinning *in, const uint64_t *key,
                 struct dt_stop *stop)
{
    for (struct dt_piece at = dt_pieces(0, in->n); dt_next_piece(stop, &at);)
        for (uint32_t i = at.a; i < at.b; i++) {
            uint32_t k = (uint32_t)key[i];
            double z = in->value[k];
            s->v[i] = (struct dt_sample){in->point[k], z, k};
            s->largest = fabs(z) > s->largest ? fabs(z) : s->largest;
        }
}

/* ---- in floats ---- */

/* The power of two by which a magnitude is multiplied to be below 1, and at least a half unless that is tiny. */
static double unit_of(double most)
{
    enum { TINY = -1000 };
    int exponent;
    (void)frexp(most, &exponent);
    return ldexp(1, most > 0 ? -(exponent > TINY ? exponent : TINY) : 0);
}

static void choose_units(struct dt_samples *s, const struct dt_thinning *in)
{
    const struct dt_box box = dt_box_of(in->point, in->n);
    double least = HUGE_VAL, most = -HUGE_VAL;
    for (uint32_t i = 0; i < in->n; i++) {
        least = in->value[i] < least ? in->value[i] : least;
        most = in->value[i] > most ? in->value[i] : most;
    }
    s->middle = (struct dt_point){box.lo.x / 2 + box.hi.x / 2, box.lo.y / 2 + box.hi.y / 2};
    s->per_length = unit_of(fmax(dt_box_width(&box), dt_box_height(&box)) / 2);
    s->middle_value = least <= most ? least / 2 + most / 2 : 0;
    s->per_value = unit_of(least <= most ? most / 2 - least / 2 : 0);
}

static void round_all(struct dt_samples *s, struct dt_stop *stop)
{
    for (struct dt_piece at = dt_pieces(0, s->n); dt_next_piece(stop, &at);)
        for (uint32_t i = at.a; i < at.b; i++) {
            const struct dt_sample *v = &s->v[i];
            s->rounded[i] =
                (struct dt_rounded){(float)((v->at.x - s->middle.x) * s->per_length),
                                    (float)((v->at.y - s->middle.y) * s->per_length),
                                    (float)((v->z - s->middle_value) * s->per_value), i};
        }
}

/* ---- blocks ---- */

/* Of the box from lo to hi; sides are rounded up. */
static void set_box(struct dt_bunch *b, struct dt_box box)
{
    b->at.x = box.lo.x / 2 + box.hi.x / 2;
    b->at.y = box.lo.y / 2 + box.hi.y / 2;
    b->width = fmax(box.hi.x - b->at.x, b->at.x - box.lo.x) * (1 + 0x1p-50);
    b->height = fmax(box.hi.y - b->at.y, b->at.y - box.lo.y) * (1 + 0x1p-50);
}

/* nan remains. */
static void add_range(struct dt_bunch *b, double least, double most)
{
    b->least = least < b->least || isnan(least) ? least : b->least;
    b->most = most > b->most || isnan(most) ? most : b->most;
}

/* The block of parts that are points, or blocks. */
static struct dt_bunch block_of(const struct dt_samples *s, uint32_t item)
{
    uint32_t part, n = dt_item_parts(s, item, &part);
    struct dt_bunch b = {.least = HUGE_VAL, .most = -HUGE_VAL};
    struct dt_box box = {{HUGE_VAL, HUGE_VAL}, {-HUGE_VAL, -HUGE_VAL}};
    for (uint32_t end = part + n; part < end; part++) {
        if (dt_item_level(part) == 0) {
            dt_box_add(&box, s->v[part].at);
            add_range(&b, s->v[part].z, s->v[part].z);
            continue;
        }
        const struct dt_bunch *p = dt_item_block(s, part);
        dt_box_add(&box, (struct dt_point){p->at.x - p->width, p->at.y - p->height});
        dt_box_add(&box, (struct dt_point){p->at.x + p->width, p->at.y + p->height});
        add_range(&b, p->least, p->most);
    }
    set_box(&b, box);
    return b;
}

/* Counts the blocks of all levels; returns how many there are. */
static uint32_t plan_blocks(struct dt_samples *s)
{
    uint32_t all = 0;
    s->count[0] = s->n;
    for (s->levels = 0; s->count[s->levels] > 1 && s->levels < DT_BLOCK_LEVELS; s->levels++) {
        const uint32_t parts = s->levels == 0 ? DT_BLOCK_POINTS : DT_BLOCK_PARTS;
        s->start[s->levels + 1] = all;
        s->count[s->levels + 1] = (s->count[s->levels] + parts - 1) / parts;
        all += s->count[s->levels + 1];
    }
    return all;
}

static enum dt_status make_blocks(struct dt_samples *s, struct dt_pages *pages,
                                  struct dt_stop *stop)
{
    s->block = dt_array_new_in(pages, plan_blocks(s), sizeof *s->block);
    if (s->block == NULL)
        return DT_NOMEM;
    for (uint32_t level = 1; level <= s->levels; level++)
        for (struct dt_piece at = dt_pieces(0, s->count[level]); dt_next_piece(stop, &at);)
            for (uint32_t i = at.a; i < at.b; i++)
                s->block[s->start[level] + i] = block_of(s, dt_item_of(level, i));
    return dt_stop_status(stop);
}

enum dt_status dt_samples_init(struct dt_samples *s, const struct dt_thinning *in,
                               struct dt_stop *stop)
{
    uint64_t *key = dt_array_new_in(in->pages, in->n, sizeof *key);
    *s = (struct dt_samples){.v = dt_array_new_in(in->pages, in->n, sizeof *s->v),
                             .rounded = dt_array_new_in(in->pages, in->n, sizeof *s->rounded),
                             .n = in->n};
    if (key == NULL || s->v == NULL || s->rounded == NULL) {
        dt_array_free(key);
        return DT_NOMEM;
    }
    if (in->n > 0) {
        make_keys(in, key, stop);
        dt_sort_keys(key, in->n);
        copy(s, in, key, stop);
        choose_units(s, in);
        round_all(s, stop);
    }
    dt_array_free(key);
    return dt_stop_status(stop) == DT_OK ? make_blocks(s, in->pages, stop) : dt_stop_status(stop);
}

void dt_samples_clear(struct dt_samples *s)
{
    dt_array_free(s->v);
    dt_array_free(s->rounded);
    dt_array_free(s->block);
    s->v = NULL;
    s->rounded = NULL;
    s->block = NULL;
}

size_t dt_samples_memory(uint32_t n)
{
    return dt_array_bytes(n, sizeof(struct dt_sample)) +
           dt_array_bytes(n, sizeof(struct dt_rounded)) + 2 * dt_array_bytes(n, sizeof(uint64_t)) +
           dt_array_bytes((size_t)n / 8 + DT_BLOCK_LEVELS, sizeof(struct dt_bunch));
}
