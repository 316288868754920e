/* row.c - see row.h. */
#include "core/surface/row.h"

#include "core/query/locate.h"

enum { IMPATIENT = 15 /* cells that are looked up after one that was too far */ };

static double valid(double x)
{
    return fabs(x) < DT_COORDINATE_LEAST ? 0 : x;
}

double dt_raster_x(const struct dt_raster *r, uint32_t column)
{
    return valid(r->lo.x + (r->hi.x - r->lo.x) * (2.0 * column + 1) / (2.0 * r->columns));
}

double dt_raster_y(const struct dt_raster *r, uint32_t row)
{
    return valid(r->hi.y - (r->hi.y - r->lo.y) * (2.0 * row + 1) / (2.0 * r->rows));
}

enum dt_status dt_scan_look_up(struct dt_scan *k, struct dt_point q, uint32_t near,
                               enum dt_where *where, uint32_t *half, double *out)
{
    *where = dt_place_find(k->v.t, q, near, half);
    return dt_value_at(&k->v, q, *where, *half, out);
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
static enum dt_status jump(struct dt_scan *k, struct dt_row_end *e, struct dt_point q, double *out)
{
    enum dt_where where;
    uint32_t half;
    enum dt_status s = dt_scan_look_up(k, q, e->near, &where, &half, out);
    bool plane = where != DT_OUTSIDE && half != DT_NONE && !dt_is_ghost(&k->v.t->mesh, half);
    e->near = half;
    e->up = plane ? edge_up(k->v.t, half, q.y) : DT_NONE;
    return s;
}

enum step { FOUND, TO_LOOK_UP, LEFT_HULL };

/* Walks along the row to the triangle that q is in. TO_LOOK_UP: q may be on an edge, or is too far. */
static enum step walk(struct dt_scan *k, struct dt_row_end *e, struct dt_point q)
{
    const struct dt_mesh *m = &k->v.t->mesh;
    const struct dt_point *xy = k->v.t->points.xy;
    uint32_t up = e->up;
    for (uint32_t steps = 0; steps < DT_ROW_PATIENCE; steps++) {
        struct dt_point below = xy[dt_origin(m, up)], above = xy[dt_dest(m, up)];
        int side = dt_orient2d(below, above, q);
        if (side >= 0) {
            e->up = e->near = up;
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
    e->near = DT_NONE;
    e->lookups = IMPATIENT;
    return TO_LOOK_UP;
}

enum dt_status dt_row_cell(struct dt_scan *k, struct dt_row_end *e, struct dt_point q, double *out)
{
    enum step step = TO_LOOK_UP;
    if (e->lookups > 0)
        e->lookups--;
    else if (e->up != DT_NONE)
        step = walk(k, e, q);
    if (step == FOUND)
        return dt_value_at(&k->v, q, DT_INSIDE, e->up, out);
    e->beyond = step == LEFT_HULL;
    *out = (double)NAN;
    return e->beyond ? DT_OK : jump(k, e, q, out);
}

/* The cells of a row in n columns, whose centres are at x; adds those that are written to *done. */
static enum dt_status scan_columns(struct dt_scan *k, struct dt_row_end *e, double y,
                                   const double *x, uint32_t n, double *out, size_t *done)
{
    enum dt_status s = DT_OK;
    for (uint32_t i = 0; s == DT_OK && i < n; i++) {
        out[i] = (double)NAN;
        if (x[i] == e->x) /* it need not be to the right of the edge by which the row has come */
            e->up = DT_NONE;
        e->x = x[i];
        s = dt_work(&k->work, dt_scan_steps(k));
        if (s == DT_OK && !e->beyond)
            s = dt_row_cell(k, e, (struct dt_point){x[i], y}, &out[i]);
        *done += s == DT_OK;
    }
    return s;
}

enum dt_status dt_row_scan(struct dt_scan *k, uint32_t row, uint32_t from, size_t n, double *out,
                           size_t *done)
{
    struct dt_row_end e = dt_row_begin();
    double y = dt_raster_y(k->r, row);
    enum dt_status s = DT_OK;
    for (uint32_t i = from; s == DT_OK && i < k->r->columns && i - from < n; i++) {
        double x = dt_raster_x(k->r, i);
        s = scan_columns(k, &e, y, &x, 1, out + (i - from), done);
    }
    return s;
}

enum dt_status dt_tiles_scan(struct dt_scan *k, uint32_t row, uint32_t rows, double *out,
                             size_t *done)
{
    struct dt_row_end e[DT_TILE];
    double x[DT_TILE];
    uint32_t columns = k->r->columns;
    size_t first = 0, others = 0; /* cells written: of the first row, and of the others */
    enum dt_status s = DT_OK;
    for (uint32_t i = 0; i < rows; i++)
        e[i] = dt_row_begin();
    for (uint32_t c = 0, n; s == DT_OK && c < columns; c += n) {
        n = columns - c < DT_TILE ? columns - c : DT_TILE;
        for (uint32_t i = 0; i < n; i++)
            x[i] = dt_raster_x(k->r, c + i);
        for (uint32_t i = 0; s == DT_OK && i < rows; i++)
            s = scan_columns(k, &e[i], dt_raster_y(k->r, row + i), x, n,
                             out + (size_t)i * columns + c, i == 0 ? &first : &others);
    }
    *done += s == DT_OK ? first + others : first;
    return s;
}
