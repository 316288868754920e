/* abreast.c - several rows of a raster side by side, for values that cost little.
 *
 * A row waits for one load after the other: the edge, the triangle beyond, its corner. No processor predicts which
 * way it goes on, or in how many triangles the next cell is found. So rows take turns, each by one edge at a time,
 * and without branches: a turn computes what follows if the cell is found and what follows if it is not, and keeps
 * one of them. Cells that are found wait in a queue, so that the values of many are computed together.
 *
 * What a turn cannot decide, dt_row_cell does. */
#include "core/exact/lanes.h"
#include "core/surface/row.h"

enum {
    ROWS = 8,      /* side by side */
    COLUMNS = 256, /* by which they go on together */
    QUEUE = 64     /* cells */
};

enum { BELOW, ABOVE, NEITHER };

/* A row, in the columns of a chunk. */
struct lane {
    dt_lanes end[3]; /* places of the ends of up; the third one is written to, but not read */
    double y;
    uint32_t up, at, after; /* the edge, the next column, and that after the last one */
    uint32_t before;        /* the column when patience began */
    bool by_turns;          /* goes on by turns; otherwise up and its ends are out of date */
    struct dt_row_end row;
    double *out; /* of column 0 of the chunk */
};

struct abreast {
    struct dt_scan *k;
    const uint32_t *half; /* of the mesh */
    const struct dt_point *xy;
    uint32_t queued;
    struct lane lane[ROWS];
    struct dt_found queue[QUEUE];
    double x[COLUMNS];
};

/* All bits if v is less than 0, none otherwise. */
static inline uint32_t sign(double v)
{
    union {
        double v;
        uint64_t bits;
    } u = {v};
    return -(uint32_t)(u.bits >> 63);
}

/* Takes the row across its edge, or to the next cell if this one is in front of it. False: that is not certain, or
 * there is none. */
static inline bool turn(struct abreast *a, struct lane *l)
{
    static const uint32_t way[8] = {2, -1u, -1u, 0,
                                    1, 1,   -2u, 0}; /* to the edges before and after */
    double x = a->x[l->at], y = l->y;
    dt_lanes q = {x, y}, from = l->end[BELOW] - q, to = l->end[ABOVE] - q;
    dt_lanes product = from * (dt_lanes){to[1], to[0]}, size = dt_lanes_abs(product);
    double side = product[0] - product[1];
    uint32_t twin = a->half[l->up + 4];
    uint32_t apex = a->half[twin + way[twin & 3]];
    if (__builtin_expect(!(fabs(side) > DT_ORIENT_BOUND * (size[0] + size[1])), 0))
        return false;
    if (__builtin_expect(apex == DT_NONE, 0))
        return false;
    dt_vicinity_enter(&a->k->v.vicinity, a->k->v.t, twin);
    dt_lanes p = dt_lanes_load(&a->xy[apex].x);
    uint32_t crosses = sign(side), below = sign(p[1] - y);
    uint32_t beyond = twin + way[4 + 4 * below + (twin & 3)];
    a->queue[a->queued] = (struct dt_found){{x, y}, l->out + l->at, l->up};
    a->queued += 1 + crosses;
    l->end[NEITHER + (crosses & (below - 1))] = p;
    l->up ^= (l->up ^ beyond) & crosses;
    l->at += 1 + crosses;
    return l->at < l->after;
}

/* Goes on by single cells until turns are possible. */
static enum dt_status go_on(struct abreast *a, struct lane *l)
{
    const struct dt_mesh *m = &a->k->v.t->mesh;
    enum dt_status s = DT_OK;
    if (l->by_turns)
        l->row.up = l->row.near = l->up;
    l->by_turns = false;
    while (s == DT_OK && l->at < l->after && !l->by_turns) {
        double *out = l->out + l->at;
        *out = (double)NAN;
        if (!l->row.beyond)
            s = dt_row_cell(a->k, &l->row, (struct dt_point){a->x[l->at], l->y}, out);
        l->at++;
        l->by_turns = l->row.up != DT_NONE && l->row.lookups == 0 && !l->row.beyond;
    }
    if (!l->by_turns)
        return s;
    l->up = l->row.up;
    l->end[BELOW] = dt_lanes_load(&a->xy[dt_origin(m, l->up)].x);
    l->end[ABOVE] = dt_lanes_load(&a->xy[dt_dest(m, l->up)].x);
    return s;
}

static enum dt_status empty_queue(struct abreast *a)
{
    enum dt_status s = dt_values_found(&a->k->v, a->queue, a->queued);
    a->queued = 0;
    return s;
}

/* Whether the row has come to another cell since it was asked last. */
static bool advances(struct lane *l)
{
    bool advances = l->at != l->before;
    l->before = l->at;
    return advances;
}

/* A turn of each of *n rows, or, instead, a check that they advance. Leaves those in active[] that are not at their end. */
static inline enum dt_status pass(struct abreast *a, struct lane **active, uint32_t *n, bool check)
{
    enum dt_status s = DT_OK;
    uint32_t left = 0;
    for (uint32_t i = 0; s == DT_OK && i < *n; i++) {
        struct lane *l = active[i];
        bool goes = check ? advances(l) : turn(a, l);
        if (!goes && l->at < l->after)
            s = go_on(a, l);
        active[left] = l;
        left += l->at < l->after;
    }
    *n = left;
    return s;
}

/* All rows, to the ends of their columns. */
static enum dt_status scan_chunk(struct abreast *a, uint32_t rows)
{
    struct lane *active[ROWS];
    uint32_t n = 0;
    enum dt_status s = DT_OK;
    for (uint32_t i = 0; s == DT_OK && i < rows; i++) {
        struct lane *l = &a->lane[i];
        if (!l->by_turns)
            s = go_on(a, l);
        active[n] = l;
        n += l->at < l->after;
    }
    for (uint32_t turns = 0; s == DT_OK && n > 0; turns++) {
        s = turns % DT_ROW_PATIENCE == 0 ? pass(a, active, &n, true) : pass(a, active, &n, false);
        if (s == DT_OK && (a->queued > QUEUE - ROWS || n == 0))
            s = empty_queue(a);
    }
    return s;
}

static uint32_t least(uint32_t a, uint32_t b)
{
    return a < b ? a : b;
}

/* The columns from c to end of the rows from `row` on; out: of the first cell. */
static enum dt_status scan_block(struct abreast *a, uint32_t row, uint32_t rows, uint32_t c,
                                 uint32_t end, double *out)
{
    const struct dt_raster *r = a->k->r;
    enum dt_status s = DT_OK;
    for (uint32_t i = 0; i < rows; i++)
        a->lane[i] = (struct lane){.y = dt_raster_y(r, row + i),
                                   .row = dt_row_begin(),
                                   .out = out + (size_t)i * r->columns};
    while (s == DT_OK && c < end) {
        uint32_t n = least(COLUMNS, end - c);
        for (uint32_t i = 0; i < n; i++)
            a->x[i] = dt_raster_x(r, c + i);
        for (uint32_t i = 0; i < rows; i++) {
            a->lane[i].at = 0;
            a->lane[i].after = n;
            a->lane[i].before = DT_NONE;
        }
        s = dt_work(&a->k->work, (uint64_t)rows * n);
        if (s == DT_OK)
            s = scan_chunk(a, rows);
        for (uint32_t i = 0; i < rows; i++)
            a->lane[i].out += n;
        c += n;
    }
    return s;
}

enum dt_status dt_rows_scan(struct dt_scan *k, uint64_t from, size_t n, double *out, size_t *done)
{
    uint32_t columns = k->r->columns;
    enum dt_status s = DT_OK;
    struct abreast a = {.k = k, .half = k->v.t->mesh.half, .xy = k->v.t->points.xy};
    while (s == DT_OK && *done < n) {
        uint32_t row = (uint32_t)((from + *done) / columns),
                 c = (uint32_t)((from + *done) % columns);
        size_t left = n - *done < k->work.left ? n - *done : k->work.left;
        size_t rows = c > 0 ? 0 : left / columns;
        rows = rows < 1 ? 1 : rows > ROWS ? ROWS : rows;
        uint32_t end = left < columns - c ? c + (uint32_t)left : columns;
        if (left == 0)
            return DT_TOOLONG;
        s = scan_block(&a, row, (uint32_t)rows, c, end, out + *done);
        *done += s == DT_OK ? rows * (end - c) : 0;
    }
    return s;
}
