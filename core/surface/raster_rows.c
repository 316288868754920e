/* raster_rows.c - see raster_rows.h.
 *
 * Where a row crosses an edge decides which columns are to the west of it:
 *
 *                    above
 *       |        |    /   |        |         c: the first column whose centre is to the east of the edge. From c on
 *     --+--------+---/----+--------+--- y       cells are in the triangle beyond, up to the next edge that the row
 *                   /     c                     crosses.
 *               below
 *
 * So an edge takes a few operations without branches, but each waits for the loads before it: the edge, the triangle
 * beyond, its corner. That is why rows take turns, each by one edge at a time. When all rows are at the end of a
 * chunk of columns, the values of its cells are computed.
 *
 * The place of a crossing is rounded. If a centre is so near that c is not certain, the exact side of the edge
 * decides, and a cell on the edge is looked up. */
#include "core/surface/raster_rows.h"
#include "core/exact/lanes.h"
#include "core/exact/predicates.h"

#include <string.h>

enum {
    ABREAST = 8, /* rows that take turns */
    ROWS = 32,   /* of a block */
    COLUMNS = 64,
    PATIENCE = 32, /* triangles to the next cell; then it is looked up, */
    IMPATIENT = 16 /* and this many in all */
};

enum { BELOW = 0, ABOVE = 1 };

/* Beside half edges, where the triangles of cells are noted: */
#define AS_BEFORE DT_NONE     /* that of the cell before */
#define DONE (DT_NONE - 1)    /* the cell has its value */
#define OUTSIDE (DT_NONE - 2) /* of the hull */

#define FAR 0x1p30 /* columns; the ends of edges that turns cross are not as far away */

/* A row, in the columns of a chunk. */
struct lane {
    dt_lanes end[2]; /* of up: x in columns from the raster's side, y from that of the row */
    double y;
    uint32_t up, twin; /* the next edge that the row crosses, and its twin */
    uint32_t at;       /* the first column that may be beyond it */
    uint32_t before;   /* the column when patience began */
    uint32_t near;     /* a half edge near the cell that was looked up last, DT_NONE: none */
    bool by_turns;     /* goes on by turns; otherwise up and its ends are out of date */
    bool outside;      /* has left the hull */
    uint32_t ghost;    /* then, one near the last cell, if the surface goes on beyond the hull */
    double *out;       /* of the first column of the chunk */
    uint32_t crossed;  /* edges that are not noted yet: */
    uint32_t beyond[PATIENCE], column[PATIENCE]; /* the triangles beyond, and c */
    uint32_t half[COLUMNS];                      /* triangles of cells */
};

struct abreast {
    struct dt_valuer *v;
    const struct dt_raster *r;
    const uint32_t *half; /* of the mesh */
    const struct dt_point *xy;
    dt_lanes origin, scale; /* of columns; 0 and 1 for y */
    double sure;            /* half a column, less the error of a crossing */
    double west;            /* the chunk's side */
    uint32_t from, end;     /* the columns of the chunk */
    struct lane lane[ROWS];
    double x[COLUMNS];
};

/* ---- centres ---- */

static double valid(double x)
{
    return fabs(x) < DT_COORDINATE_LEAST ? 0 : x;
}

static double column_x(const struct dt_raster *r, uint32_t column)
{
    return valid(r->lo.x + (r->hi.x - r->lo.x) * (2.0 * column + 1) / (2.0 * r->columns));
}

static double row_y(const struct dt_raster *r, uint32_t row)
{
    return valid(r->hi.y - (r->hi.y - r->lo.y) * (2.0 * row + 1) / (2.0 * r->rows));
}

struct dt_point dt_raster_centre(const struct dt_raster *r, uint64_t cell)
{
    return (struct dt_point){column_x(r, (uint32_t)(cell % r->columns)),
                             row_y(r, (uint32_t)(cell / r->columns))};
}

/* ---- by single cells ---- */

static bool set_end(const struct abreast *a, struct lane *l, int which, uint32_t vertex)
{
    dt_lanes origin = {a->origin[0], l->y};
    l->end[which] = (dt_lanes_load(&a->xy[vertex].x) - origin) * a->scale;
    return fabs(l->end[which][0]) < FAR;
}

/* Makes the row cross next the edge by which it leaves the triangle of near. False: it must not cross that edge together with the other
 * rows. */
static bool leave_triangle(const struct abreast *a, struct lane *l)
{
    if (l->near == DT_NONE || dt_is_ghost(&a->v->t->mesh, l->near))
        return false;
    uint32_t base = dt_base(l->near);
    const uint32_t *v = a->half + base;
    bool above[3] = {a->xy[v[0]].y >= l->y, a->xy[v[1]].y >= l->y, a->xy[v[2]].y >= l->y};
    for (uint32_t i = 0, next = 1; i < 3; i++, next = next == 2 ? 0 : next + 1)
        if (!above[i] && above[next]) {
            l->up = base + i;
            l->twin = a->half[l->up + 4];
            return set_end(a, l, BELOW, v[i]) && set_end(a, l, ABOVE, v[next]);
        }
    return false;
}

/* Notes the triangles beyond the edges that the row has crossed. */
static void note(const struct abreast *a, struct lane *l)
{
    for (uint32_t i = 0; i < l->crossed; i++)
        l->half[l->column[i] - a->from] = l->beyond[i];
    l->crossed = 0;
}

/* Looks up n cells, and more until turns are possible. */
static enum dt_status look_up(struct abreast *a, struct lane *l, uint32_t n)
{
    enum dt_status s = DT_OK;
    if (l->by_turns)
        l->near = l->up;
    l->by_turns = false;
    note(a, l);
    while (s == DT_OK && l->at < a->end && !l->by_turns) {
        uint32_t i = l->at++ - a->from;
        l->half[i] = DONE;
        if (n > 1) /* they are far apart */
            l->near = DT_NONE;
        s = dt_value_find(a->v, (struct dt_point){a->x[i], l->y}, &l->near,
                          &l->out[i * (size_t)a->v->numbers]);
        n -= n > 0;
        l->by_turns = n == 0 && leave_triangle(a, l);
    }
    if (l->at < a->end)
        l->half[l->at - a->from] = l->up;
    return s;
}

/* The row's cells from here on are outside. */
static void leave_hull(struct abreast *a, struct lane *l)
{
    note(a, l);
    if (l->at < a->end)
        l->half[l->at - a->from] = OUTSIDE;
    l->at = a->end;
}

/* ---- by turns ---- */

/* The first column of the chunk to the east of the edge, which the row crosses near the centre of a column. */
static enum dt_status decide(struct abreast *a, struct lane *l, double at, uint32_t *c)
{
    const struct dt_mesh *m = &a->v->t->mesh;
    uint32_t near = (uint32_t)at, half = l->up;
    *c = near < l->at ? l->at : near;
    if (near < l->at || near >= a->end)
        return DT_OK;
    struct dt_point q = {a->x[near - a->from], l->y};
    int side = dt_orient2d(a->xy[dt_origin(m, l->up)], a->xy[dt_dest(m, l->up)], q);
    *c += side >= 0;
    if (side != 0)
        return DT_OK;
    note(a, l);
    l->half[near - a->from] = DONE;
    return dt_value_find(a->v, q, &half, &l->out[(near - a->from) * (size_t)a->v->numbers]);
}

struct nearest {
    double value;
    uint32_t c; /* the same */
};

/* The integer next to v, which is from 0 to 2^31: the last bit of the sum is 1. */
static inline struct nearest nearest_to(double v)
{
    union {
        double v;
        uint64_t bits;
    } sum = {v + 0x1.8p52};
    return (struct nearest){sum.v - 0x1.8p52, (uint32_t)sum.bits};
}

/* Takes the row across its edge, unless that is beyond the chunk. False: it is, or turns cannot go on. */
static inline bool turn(struct abreast *a, struct lane *l, enum dt_status *s)
{
    static const uint32_t way[8] = {2, -1u, -1u, 0,
                                    1, 1,   -2u, 0}; /* to the edges before and after */
    dt_lanes below = l->end[BELOW], above = l->end[ABOVE];
    dt_lanes product = below * (dt_lanes){above[1], above[0]};
    /* Every store here goes to a known address, so that the loads of the next turns need not wait. */
    double at = (product[0] - product[1]) / (above[1] - below[1]);
    at = at > a->west ? at : a->west;
    struct nearest nearest = nearest_to(at);
    uint32_t twin = l->twin, c = nearest.c;
    uint32_t apex = a->half[twin + way[twin & 3]];
    if (__builtin_expect(fabs(at - nearest.value) > a->sure, 0))
        *s = decide(a, l, at, &c);
    l->at = c;
    if (c >= a->end)
        return false;
    l->column[l->crossed] = c;
    l->beyond[l->crossed] = twin;
    l->crossed++;
    if (__builtin_expect(apex == DT_NONE, 0)) {
        l->outside = true;
        l->ghost = twin;
        return false;
    }
    dt_fetch_at_vertex(a->v, apex);
    dt_lanes p = dt_lanes_load(&a->xy[apex].x);
    dt_lanes place = (p - (dt_lanes){a->origin[0], l->y}) * a->scale;
    dt_lanes_holds is_below = (dt_lanes){place[1], place[1]} < dt_lanes_both(0);
    l->end[BELOW] = dt_lanes_choose(is_below, place, below);
    l->end[ABOVE] = dt_lanes_choose(is_below, above, place);
    l->up = twin + way[4 + 4 * (uint32_t)is_below[0] + (twin & 3)];
    l->twin = a->half[l->up + 4];
    dt_fetch(&a->half[l->twin]);
    dt_fetch_at_triangle(a->v, l->twin);
    return fabs(place[0]) < FAR;
}

static enum dt_status begin(struct abreast *a, struct lane *l)
{
    enum dt_status s = DT_OK;
    memset(l->half, 0xff, sizeof l->half);
    l->at = a->from;
    l->crossed = 0;
    if (l->outside)
        leave_hull(a, l);
    else if (l->by_turns)
        l->half[0] = l->up;
    else
        s = look_up(a, l, 1);
    l->before = l->at;
    return s;
}

static inline enum dt_status take_turn(struct abreast *a, struct lane *l)
{
    enum dt_status s = DT_OK;
    if (turn(a, l, &s) || s != DT_OK || l->at >= a->end)
        return s;
    if (!l->outside)
        return look_up(a, l, 1);
    leave_hull(a, l);
    return DT_OK;
}

/* Instead of a turn: looks up a row that has not come to another cell since this was done last. */
static enum dt_status lose_patience(struct abreast *a, struct lane *l)
{
    bool advances = l->at != l->before;
    note(a, l);
    l->before = l->at;
    return advances ? DT_OK : look_up(a, l, IMPATIENT);
}

/* Finds the triangles of a chunk's cells. */
static enum dt_status find_chunk(struct abreast *a, struct lane *lane, uint32_t rows)
{
    struct lane *active[ABREAST]; /* those that are not at their end */
    enum dt_status s = DT_OK;
    for (uint32_t i = 0; i < rows; i++)
        active[i] = &lane[i];
    for (uint32_t turns = 0, n = rows, left; s == DT_OK && n > 0; turns++, n = left) {
        left = 0;
        for (uint32_t i = 0; s == DT_OK && i < n; i++) {
            struct lane *l = active[i];
            s = turns == 0              ? begin(a, l)
                : turns % PATIENCE == 0 ? lose_patience(a, l)
                                        : take_turn(a, l);
            active[left] = l;
            left += l->at < a->end;
        }
    }
    return s;
}

static enum dt_status value_outside(struct abreast *a, struct lane *l, uint32_t i)
{
    uint32_t numbers = a->v->numbers;
    double *out = &l->out[i * (size_t)numbers];
    for (uint32_t k = 0; k < numbers; k++)
        out[k] = (double)NAN;
    if (!a->v->s->beyond)
        return DT_OK;
    return dt_value_find(a->v, (struct dt_point){a->x[i], l->y}, &l->ghost, out);
}

static enum dt_status values_between(struct abreast *a, struct lane *l, uint32_t from, uint32_t to)
{
    return dt_values_in_row(a->v, l->half + from, a->x + from, l->y, to - from,
                            l->out + from * (size_t)a->v->numbers);
}

/* The values of the row's cells in the chunk. */
static enum dt_status values(struct abreast *a, struct lane *l)
{
    uint32_t n = a->end - a->from, last = OUTSIDE, from = 0;
    enum dt_status s = DT_OK;
    note(a, l);
    for (uint32_t i = 0; i < n; i++) {
        uint32_t half = l->half[i] == AS_BEFORE ? last : l->half[i];
        l->half[i] = half;
        last = half == DONE ? last : half;
        if (__builtin_expect(half >= OUTSIDE, 0)) {
            if (half == OUTSIDE && s == DT_OK)
                s = value_outside(a, l, i);
            if (s == DT_OK && from < i)
                s = values_between(a, l, from, i);
            from = i + 1;
        }
    }
    return s == DT_OK && from < n ? values_between(a, l, from, n) : s;
}

static uint32_t least(uint32_t a, uint32_t b)
{
    return a < b ? a : b;
}

/* The chunk's cells of at most ABREAST rows. */
static enum dt_status scan_chunk(struct abreast *a, struct lane *lane, uint32_t rows)
{
    enum dt_status s = find_chunk(a, lane, rows);
    for (uint32_t i = 0; s == DT_OK && i < rows; i++)
        s = values(a, &lane[i]);
    for (uint32_t i = 0; i < rows; i++)
        lane[i].out += (a->end - a->from) * (size_t)a->v->numbers;
    return s;
}

/* The columns from c to end of the rows from `row` on; out: of the first cell. */
static enum dt_status scan_block(struct abreast *a, uint32_t row, uint32_t rows, uint32_t c,
                                 uint32_t end, double *out)
{
    const struct dt_raster *r = a->r;
    enum dt_status s = DT_OK;
    for (uint32_t i = 0; i < rows; i++) {
        a->lane[i].y = row_y(r, row + i);
        a->lane[i].near = DT_NONE;
        a->lane[i].by_turns = a->lane[i].outside = false;
        a->lane[i].out = out + (size_t)i * r->columns * a->v->numbers;
    }
    while (s == DT_OK && c < end) {
        uint32_t n = least(COLUMNS, end - c);
        for (uint32_t i = 0; i < n; i++)
            a->x[i] = column_x(r, c + i);
        a->from = c;
        a->end = c + n;
        a->west = c;
        s = dt_work(&a->v->work, (uint64_t)rows * n * dt_value_steps(a->v));
        for (uint32_t i = 0; s == DT_OK && i < rows; i += ABREAST)
            s = scan_chunk(a, &a->lane[i], least(rows - i, ABREAST));
        c += n;
    }
    return s;
}

/* ---- rasters ---- */

/* By how many columns a crossing may be off from a centre. Let u = 2^-53.
 * 1. Centres are rounded by 4.1 u of |lo.x| + |hi.x|.
 * 2. The end of an edge, in columns, errs by 4 u of itself. A crossing, a mean of two ends, errs by 8 u of the larger end
 *    more: by 12 u FAR at most. */
static double crossing_error(const struct dt_raster *r, double per_x)
{
    return 16 * DT_U * (FAR + (fabs(r->lo.x) + fabs(r->hi.x)) * per_x);
}

static double columns_per_unit(const struct dt_raster *r)
{
    return r->columns / (r->hi.x - r->lo.x);
}

bool dt_rows_suit(const struct dt_raster *r)
{
    double per_x = columns_per_unit(r);
    return crossing_error(r, per_x) < 0x1p-4 && per_x * DT_COORDINATE_LEAST < 0x1p-30;
}

enum dt_status dt_rows_scan(struct dt_valuer *v, const struct dt_raster *r, uint64_t from, size_t n,
                            double *out, size_t *done)
{
    uint32_t columns = r->columns;
    double per_x = columns_per_unit(r);
    enum dt_status s = DT_OK;
    struct abreast a;
    a.v = v;
    a.r = r;
    a.half = v->t->mesh.half;
    a.xy = v->t->points.xy;
    a.origin = (dt_lanes){r->lo.x, 0};
    a.scale = (dt_lanes){per_x, 1};
    a.sure = 0.5 - crossing_error(r, per_x);
    while (s == DT_OK && *done < n) {
        uint32_t row = (uint32_t)((from + *done) / columns),
                 c = (uint32_t)((from + *done) % columns);
        uint64_t steps = v->work.left, most = steps / dt_value_steps(v);
        size_t left = n - *done < most ? n - *done : (size_t)most;
        size_t rows = c > 0 ? 0 : left / columns;
        rows = rows < 1 ? 1 : rows > ROWS ? ROWS : rows;
        uint32_t end = left < columns - c ? c + (uint32_t)left : columns;
        if (left == 0)
            return DT_TOOLONG;
        s = scan_block(&a, row, (uint32_t)rows, c, end, out + *done * v->numbers);
        *done += s == DT_OK ? rows * (end - c) : 0;
        if (s == DT_TOOLONG) /* what it took does not count, since its cells are computed again */
            v->work.left = steps;
    }
    return s;
}
