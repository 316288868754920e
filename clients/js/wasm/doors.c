/* doors.c - the core as JavaScript calls it: what the public headers of the core do, in calls that take and return numbers.
 *
 * A function that has results writes them into out[]: an array as its address and its number of elements. The caller frees
 * arrays by free(). Functions that return an enum dt_status leave out[] as it was when that is not DT_OK. lib/core.js has the
 * other side. */
#include "core/cells/centre.h"
#include "core/delaunay_arrays.h"
#include "core/delaunay_constraints.h"

#include <stdlib.h>
#include <string.h>

#define DOOR(name) __attribute__((export_name(#name)))

/* The name of the field that has the values of a set. */
static const char values_name[] = "z";

enum { VALUES_LEN = sizeof values_name - 1 };

static uint32_t address(const void *p)
{
    return (uint32_t)(uintptr_t)p;
}

/* One byte more than nothing, so that NULL means that there is no memory. */
static void *room(size_t n, size_t size)
{
    return n >= SIZE_MAX / 2 / size ? NULL : malloc(n * size + 1);
}

static void give(uint32_t *out, const void *array, size_t n)
{
    out[0] = address(array);
    out[1] = (uint32_t)n;
}

/* Frees a and b unless they are the results. */
static enum dt_status end(enum dt_status s, void *a, void *b)
{
    if (s != DT_OK) {
        free(a);
        free(b);
    }
    return s;
}

/* ---- a set and its points ---- */

DOOR(set_new) struct dt *door_set_new(double tolerance)
{
    return dt_new(tolerance);
}

DOOR(set_free) void door_set_free(struct dt *t)
{
    dt_free(t);
}

/* out: the first id, how many of the points coincide with others. */
DOOR(set_add)
enum dt_status door_set_add(struct dt *t, const struct dt_point *p, uint32_t n, uint32_t *out)
{
    struct dt_added added;
    enum dt_status s = dt_add(t, p, n, &added);
    if (s == DT_OK) {
        out[0] = added.first;
        out[1] = added.coincident;
    }
    return s;
}

/* out: whether the points of a set from which none was deleted are these. */
DOOR(set_has)
enum dt_status door_set_has(const struct dt *t, const struct dt_point *p, uint32_t n, uint32_t *out)
{
    struct dt_point q;
    uint32_t i = 0;
    while (i < n && dt_get(t, i, &q) == DT_OK && q.x == p[i].x && q.y == p[i].y)
        i++;
    out[0] = i == n && dt_next_id(t) == n;
    return DT_OK;
}

/* out: how many ids are deleted; or, if it is DT_NOPOINT, which one is missing. */
DOOR(set_delete)
enum dt_status door_set_delete(struct dt *t, const uint32_t *ids, uint32_t n, uint32_t *out)
{
    uint32_t deleted = 0, missing = DT_NONE;
    enum dt_status s = dt_delete(t, ids, n, &deleted, &missing);
    out[0] = s == DT_NOPOINT ? missing : deleted;
    return s;
}

DOOR(set_move) enum dt_status door_set_move(struct dt *t, uint32_t id, double x, double y)
{
    return dt_move(t, id, (struct dt_point){x, y});
}

DOOR(set_get) enum dt_status door_set_get(const struct dt *t, uint32_t id, struct dt_point *out)
{
    return dt_get(t, id, out);
}

/* Triangulates it, or brings the triangulation up to date. */
DOOR(set_triangulate) enum dt_status door_set_triangulate(struct dt *t)
{
    enum dt_status s = dt_triangulate(t, NULL);
    return s == DT_OK ? dt_refresh(t, NULL) : s;
}

/* The same, and makes the grid for searches if that is due. DT_RANGE: one of the places is invalid. */
static enum dt_status ready(struct dt *t, const struct dt_point *place, size_t n)
{
    struct dt_renewal *grid = NULL;
    enum dt_status s = dt_coordinates_ok(&place->x, 2 * n) ? door_set_triangulate(t) : DT_RANGE;
    if (s == DT_OK)
        s = dt_prepare(t, NULL);
    if (s == DT_OK && dt_renew_due(t) && dt_renew(t, NULL, &grid) == DT_OK)
        dt_renewed(t, grid);
    return s;
}

/* out: points, coincident ones among them, the id that the next point will get. */
DOOR(set_counts) enum dt_status door_set_counts(const struct dt *t, uint32_t *out)
{
    struct dt_summary sum;
    dt_summary(t, &sum);
    out[0] = sum.points;
    out[1] = sum.coincident;
    out[2] = dt_next_id(t);
    return DT_OK;
}

/* ---- the triangulation as arrays ---- */

/* out: a table's words. */
DOOR(set_table)
enum dt_status door_set_table(const struct dt *t, enum dt_table table, bool cw, uint32_t *out)
{
    static const size_t width[] = {
        [DT_POINTS] = 1, [DT_COINCIDENT] = 2, [DT_EDGES] = 2, [DT_HULL] = 1};
    struct dt_cursor c;
    size_t rows, words = 0;
    enum dt_status s = dt_table_begin(t, NULL, table, cw, &c);
    if (s != DT_OK)
        return s;
    size_t n = width[table] * c.rows;
    uint32_t *all = room(n, sizeof *all);
    if (all == NULL)
        return DT_NOMEM;
    for (size_t at = 0; at < n && (s == DT_OK || s == DT_TOOLONG); at += words)
        s = dt_table_read(t, &c, all + at, n - at, c.rows, &rows, &words);
    if (s == DT_OK)
        give(out, all, n);
    return end(s, all, NULL);
}

/* out: triangles and half edges. */
DOOR(set_triangles)
enum dt_status door_set_triangles(const struct dt *t, bool cw, uint32_t *out)
{
    struct dt_summary sum;
    dt_summary(t, &sum);
    size_t n = (size_t)3 * sum.triangles;
    uint32_t *triangles = room(n, sizeof *triangles), *halfedges = room(n, sizeof *halfedges);
    enum dt_status s =
        triangles == NULL || halfedges == NULL ? DT_NOMEM : dt_flat(t, cw, triangles, halfedges);
    if (s == DT_OK) {
        give(out, triangles, n);
        give(out + 2, halfedges, n);
    }
    return end(s, triangles, halfedges);
}

/* out: the neighbours of a point in order. */
DOOR(set_ring)
enum dt_status door_set_ring(const struct dt *t, uint32_t id, bool cw, uint32_t *out)
{
    struct dt_ids ring = {0};
    uint32_t representative;
    bool boundary;
    enum dt_status s = dt_ring(t, id, cw, &ring, &representative, &boundary);
    if (s == DT_OK)
        give(out, ring.v, ring.n);
    return end(s, ring.v, NULL);
}

/* ---- questions about places ---- */

/* out: three ids for each place, k for each place. */
DOOR(set_locate)
enum dt_status door_set_locate(struct dt *t, const struct dt_point *p, uint32_t n, uint32_t *out)
{
    size_t done;
    uint32_t *ids = room(n, 3 * sizeof *ids);
    enum dt_status s = ids == NULL ? DT_NOMEM : ready(t, p, n);
    if (s == DT_OK)
        s = dt_locate_many(t, NULL, p, n, NULL, ids, &done);
    if (s == DT_OK)
        give(out, ids, (size_t)3 * n);
    return end(s, ids, NULL);
}

DOOR(set_nearest)
enum dt_status door_set_nearest(struct dt *t, const struct dt_point *p, uint32_t n, uint32_t k,
                                uint32_t *out)
{
    size_t done, bytes = (size_t)k * sizeof(uint32_t);
    uint32_t *ids = k > SIZE_MAX / 8 ? NULL : room(n, bytes);
    enum dt_status s = ids == NULL ? DT_NOMEM : ready(t, p, n);
    if (s == DT_OK)
        s = dt_nearest_many(t, NULL, p, n, k, NULL, ids, &done);
    if (s == DT_OK)
        give(out, ids, (size_t)k * n);
    return end(s, ids, NULL);
}

/* ---- values ---- */

/* Sets the values of the points with the ids from `first` on. out: an id that is missing. */
DOOR(set_values)
enum dt_status door_set_values(struct dt *t, const double *values, uint32_t n, uint32_t first,
                               uint32_t *out)
{
    return dt_field_set_run(t, values_name, VALUES_LEN, first, values, n, NULL, out);
}

static const struct dt_field *values_of(const struct dt *t)
{
    return dt_field_find(t, values_name, VALUES_LEN);
}

/* out: the values at n places. */
DOOR(set_interpolate)
enum dt_status door_set_interpolate(struct dt *t, const struct dt_point *p, uint32_t n,
                                    enum dt_interpolation how, double max_edge, uint32_t *out)
{
    struct dt_surface surface = {.how = how, .max_edge = max_edge};
    size_t done;
    if (values_of(t) == NULL)
        return DT_NOFIELD;
    double *value = room(n, sizeof *value);
    enum dt_status s = value == NULL ? DT_NOMEM : ready(t, p, n);
    if (s == DT_OK)
        s = dt_surface_begin(&surface, values_of(t), NULL);
    if (s == DT_OK) {
        s = dt_values(t, &surface, p, n, NULL, value, &done);
        dt_surface_end(&surface);
    }
    if (s == DT_OK)
        give(out, value, n);
    return end(s, value, NULL);
}

/* Copies lines into arrays. out: levels; offsets, in places; places; whether each is closed. */
static enum dt_status write_lines(const struct dt_contour_line *line, size_t lines, uint32_t *out)
{
    size_t places = 0;
    for (size_t i = 0; i < lines; i++)
        places += line[i].n;
    double *level = room(lines, sizeof *level);
    uint32_t *offset = room(lines + 1, sizeof *offset), *closed = room(lines, sizeof *closed);
    struct dt_point *place = room(places, sizeof *place);
    enum dt_status s =
        level == NULL || offset == NULL || closed == NULL || place == NULL ? DT_NOMEM : DT_OK;
    for (size_t i = 0, at = 0; s == DT_OK && i <= lines; i++) {
        offset[i] = (uint32_t)at;
        if (i == lines)
            break;
        level[i] = line[i].level;
        closed[i] = line[i].closed;
        memcpy(place + at, line[i].p, line[i].n * sizeof *place);
        at += line[i].n;
    }
    if (s == DT_OK) {
        give(out, level, lines);
        give(out + 2, offset, lines + 1);
        give(out + 4, place, 2 * places);
        give(out + 6, closed, lines);
    }
    return end(end(s, level, offset), closed, place);
}

/* The contour lines at ascending levels; out as above. */
DOOR(set_contours)
enum dt_status door_set_contours(const struct dt *t, const double *level, uint32_t n,
                                 double max_edge, uint32_t *out)
{
    struct dt_contour *c = NULL;
    const struct dt_contour_line *line;
    size_t lines;
    bool done = false;
    if (values_of(t) == NULL)
        return DT_NOFIELD;
    enum dt_status s = dt_contour_begin(t, NULL, values_of(t), level, n, max_edge, &c);
    while (s == DT_OK && !done)
        s = dt_contour_read(t, c, &done);
    if (s == DT_OK)
        s = dt_contour_end(c, NULL, &line, &lines);
    if (s == DT_OK)
        s = write_lines(line, lines, out);
    dt_contour_free(c);
    return s;
}

/* ---- constraints, as pairs of ids ---- */

/* The caller frees them. */
static struct dt_constraint *constraints_of(const uint32_t *pair, uint32_t n, bool border)
{
    struct dt_constraint *c = room(n, sizeof *c);
    for (uint32_t i = 0; c != NULL && i < n; i++)
        c[i] = (struct dt_constraint){pair[2 * i], pair[2 * i + 1], border, border};
    return c;
}

/* Lines, or parts of the border of one region. out: how many are new. If it is DT_CROSSES: the ends of one and of the
 * other. Otherwise the id that is wrong. */
DOOR(set_constrain)
enum dt_status door_set_constrain(struct dt *t, const uint32_t *pair, uint32_t n, bool border,
                                  uint32_t *out)
{
    size_t added;
    struct dt_constraint *c = constraints_of(pair, n, border);
    enum dt_status s = c == NULL ? DT_NOMEM : dt_constrain(t, c, n, NULL, &added, out);
    if (s == DT_OK)
        out[0] = (uint32_t)added;
    if (s == DT_CROSSES) {
        struct dt_crossed two;
        dt_crossed(t, &two);
        memcpy(out, (const uint32_t[]){two.one.a, two.one.b, two.other.a, two.other.b}, 16);
    }
    free(c);
    return s;
}

/* out: which one does not exist. */
DOOR(set_release)
enum dt_status door_set_release(struct dt *t, const uint32_t *pair, uint32_t n, bool border,
                                uint32_t *out)
{
    size_t released, missing = 0;
    struct dt_constraint *c = constraints_of(pair, n, border);
    enum dt_status s = c == NULL ? DT_NOMEM : dt_release(t, c, n, NULL, &released, &missing);
    out[0] = (uint32_t)missing;
    free(c);
    return s;
}

/* out: the pairs of the edges that are parts of constraints. */
DOOR(set_constrained) enum dt_status door_set_constrained(const struct dt *t, uint32_t *out)
{
    struct dt_ids edges = {0};
    enum dt_status s = dt_constrained_edges(t, &edges);
    if (s == DT_OK)
        give(out, edges.v, edges.n);
    return end(s, edges.v, NULL);
}

/* out: the triangles inside the border. */
DOOR(set_inside) enum dt_status door_set_inside(struct dt *t, bool cw, uint32_t *out)
{
    struct dt_ids rows = {0};
    enum dt_status s = dt_survey(t, NULL);
    if (s == DT_OK)
        s = dt_inside(t, DT_NONE, DT_TRIANGLES, cw, NULL, &rows);
    if (s == DT_OK)
        give(out, rows.v, rows.n);
    return end(s, rows.v, NULL);
}

/* The triangles of a polygon. number: the coordinates of n corners, and then where each ring ends. out: ids, how many sides were left
 * out. */
DOOR(polygon)
enum dt_status door_polygon(const double *number, uint32_t n, uint32_t rings, uint32_t *out)
{
    struct dt_ids triangles = {0};
    size_t left_out;
    uint32_t *ring_end = room(rings, sizeof *ring_end);
    enum dt_status s = ring_end == NULL ? DT_NOMEM : DT_OK;
    for (uint32_t i = 0; s == DT_OK && i < rings; i++)
        ring_end[i] = (uint32_t)number[2 * (size_t)n + i];
    if (s == DT_OK)
        s = dt_polygon((const struct dt_point *)number, n, ring_end, rings, NULL, &triangles,
                       &left_out);
    free(ring_end);
    if (s == DT_OK) {
        give(out, triangles.v, triangles.n);
        out[2] = (uint32_t)left_out;
    }
    return end(s, triangles.v, NULL);
}

/* ---- Voronoi cells ---- */

/* Cells as they are read. */
struct cells {
    uint32_t *offset;        /* owns one for each id, and one more */
    struct dt_point *corner; /* owns `cap` */
    size_t ids, corners, cap;
};

/* Makes room for `more` corners. */
static enum dt_status grow(struct cells *c, size_t more)
{
    if (more <= c->cap - c->corners)
        return DT_OK;
    size_t cap = c->cap + c->cap / 2 + more;
    struct dt_point *larger =
        cap > SIZE_MAX / sizeof *larger ? NULL : realloc(c->corner, cap * sizeof *larger);
    if (larger == NULL)
        return DT_NOMEM;
    c->corner = larger;
    c->cap = cap;
    return DT_OK;
}

/* Reads all cells of a cursor. */
static enum dt_status read_cells(const struct dt *t, struct dt_cells *from, struct cells *c)
{
    enum { ROOM = 256 };
    struct dt_cell cell[ROOM];
    size_t n = 1, corners, next = 0;
    enum dt_status s = DT_OK;
    while (s == DT_OK && n > 0) {
        s = grow(c, 1);
        if (s == DT_OK)
            s = dt_cells_read(t, from, cell, ROOM, c->corner + c->corners, c->cap - c->corners, &n,
                              &corners);
        if (s == DT_TOOSMALL) {
            s = grow(c, corners);
            n = 1;
            continue;
        }
        for (size_t i = 0; s == DT_OK && i < n; i++) {
            while (next <= cell[i].id)
                c->offset[next++] = (uint32_t)c->corners;
            c->corners += cell[i].corners;
        }
    }
    while (next <= c->ids)
        c->offset[next++] = (uint32_t)c->corners;
    return s;
}

/* Makes all of the cells first, which is faster, unless that is not for this set. */
static enum dt_status make_cells(const struct dt *t, struct dt_cells *from,
                                 struct dt_cells_made **made)
{
    bool done = false;
    enum dt_status s = dt_cells_make_begin(t, from, made);
    while (s == DT_OK && *made != NULL && !done)
        s = dt_cells_make(t, *made, NULL, 1 << 20, &done);
    if (s == DT_OK)
        from->made = *made;
    return s;
}

/* The cells in a box. out: offsets by id, in corners, the corners of id from number id up to number id + 1; corners,
 * counterclockwise. */
DOOR(set_cells)
enum dt_status door_set_cells(const struct dt *t, double x0, double y0, double x1, double y1,
                              uint32_t *out)
{
    struct cells c = {.ids = dt_next_id(t)};
    struct dt_cells from;
    struct dt_cells_made *made = NULL;
    enum dt_status s =
        dt_cells_begin(t, NULL, (struct dt_point){x0, y0}, (struct dt_point){x1, y1}, &from);
    if (s != DT_OK)
        return s;
    c.offset = room(c.ids + 1, sizeof *c.offset);
    s = c.offset == NULL ? DT_NOMEM : grow(&c, (size_t)6 * from.rows + 16);
    if (s == DT_OK)
        s = make_cells(t, &from, &made);
    if (s == DT_OK)
        s = read_cells(t, &from, &c);
    dt_cells_made_free(made);
    if (s == DT_OK) {
        give(out, c.offset, c.ids + 1);
        give(out + 2, c.corner, 2 * c.corners);
    }
    return end(s, c.offset, c.corner);
}

/* out: the circumcentres of the triangles in the order of set_triangles; each coordinate is rounded once. */
DOOR(set_centres) enum dt_status door_set_centres(const struct dt *t, bool cw, uint32_t *out)
{
    struct dt_summary sum;
    dt_summary(t, &sum);
    size_t n = sum.triangles;
    uint32_t *corner = room(3 * n, sizeof *corner);
    struct dt_point *centre = room(n, sizeof *centre), p[3];
    enum dt_status s = corner == NULL || centre == NULL ? DT_NOMEM : dt_flat(t, cw, corner, NULL);
    for (size_t i = 0; s == DT_OK && i < n; i++) {
        for (size_t k = 0; k < 3 && s == DT_OK; k++)
            s = dt_get(t, corner[3 * i + k], &p[k]);
        centre[i] = dt_centre(p[0], p[1], p[2]);
    }
    if (s != DT_OK)
        return end(s, corner, centre);
    free(corner);
    give(out, centre, 2 * n);
    return DT_OK;
}
