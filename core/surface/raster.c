/* raster.c - values of a surface at many places, and at the cells of a raster, row by row.
 *
 * A row of cells is a line from west to east. It crosses the triangles one after the other, each from an edge that
 * goes down, as seen from the triangle, to one that goes up:
 *
 *              above                    A corner on the line counts as above it, so the line passes between
 *             /  |  \                   corners, and where it goes on from a triangle follows from one comparison
 *       -----/---|---\-------- y        of a y. Which triangle a cell is in is decided by the side of the edge up
 *           /    |    \                 on which it is: exactly.
 *       below----+-----below
 *
 * A cell on an edge or at a corner is looked up by itself, and so is the first cell of a row, one after many
 * triangles without any, and those outside the hull. */
#include "core/control/parallel.h"
#include "core/query/locate.h"
#include "core/set/reader.h"
#include "core/surface/value.h"

enum {
    PATIENCE = 32,    /* triangles to the next cell; then it is looked up, */
    IMPATIENT = 15,   /* and so are the next ones */
    CIRCLES = 1 << 13 /* kept for large rasters: half a megabyte */
};

struct scan {
    struct dt_valuer v;
    struct dt_work work;
    uint32_t near;    /* a half edge near the last place, DT_NONE: none */
    uint32_t up;      /* the edge by which the row leaves the triangle; DT_NONE: not known */
    uint32_t lookups; /* cells that are looked up without walking first */
    bool beyond;      /* the row has left the hull */
};

static enum dt_status begin(struct scan *k, const struct dt *t, const struct dt_surface *s,
                            size_t n, const struct dt_options *opt)
{
    uint32_t circles = 64;
    enum dt_status status = dt_readable(t);
    *k = (struct scan){.work = dt_work_of(opt), .near = DT_NONE, .up = DT_NONE};
    if (status != DT_OK)
        return status;
    while (circles < CIRCLES && circles < n)
        circles *= 2;
    return dt_valuer_init(&k->v, t, s, &k->work, circles);
}

/* What the value at a place usually takes, in steps. */
static uint32_t steps_of(const struct scan *k)
{
    return k->v.s->how == DT_LINEAR ? 1 : 8;
}

static enum dt_status look_up(struct scan *k, struct dt_point q, enum dt_where *where,
                              uint32_t *half, double *out)
{
    *where = dt_place_find(k->v.t, q, k->near, half);
    k->near = *half;
    return dt_value_at(&k->v, q, *where, *half, out);
}

enum dt_status dt_values(const struct dt *t, const struct dt_surface *s, const struct dt_point *q,
                         size_t n, const struct dt_options *opt, double *out, size_t *done)
{
    struct scan k;
    enum dt_where where;
    uint32_t half;
    *done = 0;
    enum dt_status status = begin(&k, t, s, n, opt);
    while (status == DT_OK && *done < n) {
        k.near = DT_NONE;
        status = dt_work(&k.work, 8 + steps_of(&k));
        if (status == DT_OK)
            status = look_up(&k, q[*done], &where, &half, &out[*done]);
        *done += status == DT_OK;
    }
    dt_valuer_clear(&k.v);
    return status;
}

/* ---- cells ---- */

static double valid(double x)
{
    return fabs(x) < DT_COORDINATE_LEAST ? 0 : x;
}

static double column_x(const struct dt_raster *r, uint32_t i)
{
    return valid(r->lo.x + (r->hi.x - r->lo.x) * (2.0 * i + 1) / (2.0 * r->columns));
}

static double row_y(const struct dt_raster *r, uint32_t j)
{
    return valid(r->hi.y - (r->hi.y - r->lo.y) * (2.0 * j + 1) / (2.0 * r->rows));
}

struct dt_point dt_raster_centre(const struct dt_raster *r, uint64_t cell)
{
    return (struct dt_point){column_x(r, (uint32_t)(cell % r->columns)),
                             row_y(r, (uint32_t)(cell / r->columns))};
}

/* The edge by which the line at y leaves the triangle of `half`; DT_NONE: it does not cross it. */
static uint32_t edge_up(const struct dt *t, uint32_t half, double y)
{
    const uint32_t *v = t->mesh.half + dt_base(half);
    const struct dt_point *xy = t->points.xy;
    bool above[3] = {xy[v[0]].y >= y, xy[v[1]].y >= y, xy[v[2]].y >= y};
    for (uint32_t i = 0; i < 3; i++)
        if (!above[i] && above[(i + 1) % 3])
            return dt_base(half) + i;
    return DT_NONE;
}

/* Looks up the cell at q. */
static enum dt_status jump(struct scan *k, struct dt_point q, double *out)
{
    enum dt_where where;
    uint32_t half;
    enum dt_status s = look_up(k, q, &where, &half, out);
    bool plane = where != DT_OUTSIDE && half != DT_NONE && !dt_is_ghost(&k->v.t->mesh, half);
    k->up = plane ? edge_up(k->v.t, half, q.y) : DT_NONE;
    return s;
}

enum step { FOUND, TO_LOOK_UP, LEFT_HULL };

/* Walks along the row to the triangle that q is in. TO_LOOK_UP: q may be on an edge, or is too far. */
static enum step walk(struct scan *k, struct dt_point q)
{
    const struct dt_mesh *m = &k->v.t->mesh;
    const struct dt_point *xy = k->v.t->points.xy;
    uint32_t up = k->up;
    for (uint32_t steps = 0; steps < PATIENCE; steps++) {
        struct dt_point below = xy[dt_origin(m, up)], above = xy[dt_dest(m, up)];
        int side = dt_orient2d(below, above, q);
        if (side >= 0) {
            k->up = k->near = up;
            /* The third corner is on the other side of the row, unless it and the one above are on it. */
            return side > 0 && !(above.y == q.y && xy[dt_apex_of(m, up)].y == q.y) ? FOUND
                                                                                   : TO_LOOK_UP;
        }
        up = dt_twin(m, up);
        if (dt_is_ghost(m, up))
            return LEFT_HULL;
        dt_vicinity_enter(&k->v.vicinity, k->v.t, up);
        up = xy[dt_apex_of(m, up)].y >= q.y ? dt_next(up) : dt_prev(up);
    }
    k->near = DT_NONE;
    k->lookups = IMPATIENT;
    return TO_LOOK_UP;
}

/* The value of the next cell of the row. */
static inline enum dt_status scan_cell(struct scan *k, struct dt_point q, double *out)
{
    enum step step = TO_LOOK_UP;
    if (k->lookups > 0)
        k->lookups--;
    else if (k->up != DT_NONE)
        step = walk(k, q);
    if (step == FOUND)
        return dt_value_at(&k->v, q, DT_INSIDE, k->up, out);
    k->beyond = step == LEFT_HULL;
    *out = (double)NAN;
    return k->beyond ? DT_OK : jump(k, q, out);
}

/* The cells of a row from the column `from` on, n of them or up to its end. */
static enum dt_status scan_row(struct scan *k, const struct dt_raster *r, uint32_t row,
                               uint32_t from, size_t n, double *out, size_t *done)
{
    struct dt_point q = {0, row_y(r, row)};
    enum dt_status s = DT_OK;
    k->up = DT_NONE;
    k->beyond = false;
    for (uint32_t i = from; s == DT_OK && i < r->columns && i - from < n; i++) {
        double before = q.x;
        q.x = column_x(r, i);
        if (q.x == before) /* it need not be to the right of the edge by which the row has come */
            k->up = DT_NONE;
        s = dt_work(&k->work, steps_of(k));
        if (s == DT_OK && !k->beyond)
            s = scan_cell(k, q, out + (i - from));
        else
            out[i - from] = (double)NAN;
        *done += s == DT_OK;
    }
    return s;
}

/* n cells from the cell `from` on, on this thread. */
static enum dt_status scan_cells(const struct dt *t, const struct dt_surface *s,
                                 const struct dt_raster *r, uint64_t from, size_t n,
                                 const struct dt_options *opt, double *out, size_t *done)
{
    struct scan k;
    *done = 0;
    enum dt_status status = begin(&k, t, s, n, opt);
    if (status == DT_OK && n >= 1000)
        status = dt_vicinity_init(&k.v.vicinity, s);
    while (status == DT_OK && *done < n) {
        uint64_t at = from + *done;
        status = scan_row(&k, r, (uint32_t)(at / r->columns), (uint32_t)(at % r->columns),
                          n - *done, out + *done, done);
    }
    dt_valuer_clear(&k.v);
    return status;
}

/* ---- on several threads ---- */

struct slices {
    const struct dt *t;
    const struct dt_surface *s;
    const struct dt_raster *r;
    uint64_t from;
    size_t n;
    double *out;
    unsigned slices;
    struct dt_stop stop;
};

static void scan_slice(void *arg, unsigned i)
{
    struct slices *k = arg;
    struct dt_options opt = {.cancel = k->stop.cancel};
    size_t a = (size_t)((uint64_t)k->n * i / k->slices),
           b = (size_t)((uint64_t)k->n * (i + 1) / k->slices), done;
    enum dt_status status =
        scan_cells(k->t, k->s, k->r, k->from + a, b - a, &opt, k->out + a, &done);
    if (status != DT_OK)
        dt_stop_because(&k->stop, status);
}

enum dt_status dt_raster_values(const struct dt *t, const struct dt_surface *s,
                                const struct dt_raster *r, uint64_t from, size_t n,
                                const struct dt_options *opt, double *out, size_t *done)
{
    enum { SLICES = 4 }; /* for each thread */
    bool limited = opt != NULL && opt->steps > 0;
    unsigned threads = opt == NULL || limited
                           ? 1
                           : dt_threads_for(opt->pool, n < UINT32_MAX ? (uint32_t)n : UINT32_MAX);
    if (threads == 1)
        return scan_cells(t, s, r, from, n, opt, out, done);
    struct slices k = {t, s, r, from, n, out, SLICES * threads, dt_stop_of(opt)};
    dt_run(opt->pool, k.slices, scan_slice, &k);
    *done = dt_stop_status(&k.stop) == DT_OK ? n : 0;
    return dt_stop_status(&k.stop);
}
