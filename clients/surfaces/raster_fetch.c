/* raster_fetch.c - see raster_fetch.h. */
#include "clients/surfaces/raster_fetch.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "clients/lib/bytes.h"
#include "clients/lib/words.h"
#include "proto/number.h"

struct bounds {
    double box[4];
    size_t n;
};

/* A row `id x y` of HULL. */
static bool take_corner(void *ctx, const struct delaunay_part *part)
{
    struct bounds *b = ctx;
    if (part->kind != DELAUNAY_PART_ROW)
        return true;
    const char *end = part->text + part->len, *s = memchr(part->text, ' ', part->len);
    for (int i = 0; i < 2; i++) {
        double v;
        size_t len =
            s != NULL && s < end ? proto_read_leading_double(s + 1, (size_t)(end - s) - 1, &v) : 0;
        if (len == 0)
            return false;
        b->box[i] = b->n == 0 ? v : fmin(b->box[i], v);
        b->box[i + 2] = b->n == 0 ? v : fmax(b->box[i + 2], v);
        s += 1 + len;
    }
    b->n++;
    return true;
}

bool raster_plan(const struct raster_request *r, const double *box, struct grid *g)
{
    double wide = (box[2] - box[0]) * (r->squeeze > 0 ? r->squeeze : 1);
    double high = box[3] - box[1], cell = r->cell;
    if (cell <= 0)
        cell = r->columns > 0 ? wide / r->columns : fmax(wide, high) / RASTER_USUAL_COLUMNS;
    if (r->most_rows > 0)
        cell = fmax(cell, high / r->most_rows);
    /* A column that rounding alone would add is left out. */
    double columns = fmax(ceil(wide / cell - 1e-9), 1), rows = fmax(ceil(high / cell - 1e-9), 1);
    if (!(cell > 0) || !isfinite(cell) || columns > RASTER_MOST_COLUMNS ||
        rows > RASTER_MOST_COLUMNS || columns * rows > 0x1p31)
        return false;
    *g = (struct grid){.x0 = box[0], .y0 = box[1], .cell = cell};
    g->columns = (uint32_t)columns;
    g->rows = (uint32_t)rows;
    return true;
}

/* Whether the box is as wide, or as wide or high, as its cells are to be chosen from it. */
static bool has_extent(const struct raster_request *r, const double *box)
{
    return r->cell > 0 || box[2] > box[0] || (r->columns == 0 && box[3] > box[1]);
}

static size_t put(char *line, size_t n, double v)
{
    line[n++] = ' ';
    return n + proto_write_double(line + n, v);
}

static enum delaunay_result send_request(struct delaunay_client *c, const char *set,
                                         const char *field, const struct raster_request *r,
                                         const struct grid *g)
{
    char line[600];
    size_t n = (size_t)snprintf(line, sizeof line, "RASTER %.100s %.100s", set, field);
    double right = r->squeeze > 0 ? g->x0 + (grid_right(g) - g->x0) / r->squeeze : grid_right(g);
    const double box[4] = {g->x0, g->y0, right, grid_top(g)};
    for (int i = 0; i < 4; i++)
        n = put(line, n, box[i]);
    n += (size_t)snprintf(line + n, sizeof line - n, " %u %u", g->columns, g->rows);
    n = words_put(line, n, sizeof line, "METHOD", r->method);
    if (r->max_edge > 0) {
        n += (size_t)snprintf(line + n, sizeof line - n, " MAXEDGE");
        n = put(line, n, r->max_edge);
    }
    n = words_put(line, n, sizeof line, "INSIDE", words_inside(r->inside));
    n = words_put(line, n, sizeof line, "MISSING", r->missing);
    n = words_put(line, n, sizeof line, "OUTSIDE", r->outside);
    n = words_put(line, n, sizeof line, "CLIP", r->clip);
    n = words_put(line, n, sizeof line, "AS", r->quantity);
    n = words_put(line, n, sizeof line, "BINARY", "");
    return n < sizeof line ? delaunay_send(c, line, n) : DELAUNAY_BADREQUEST;
}

static enum delaunay_result stop(const char **fault, const char *what)
{
    *fault = what;
    return DELAUNAY_STOPPED;
}

enum delaunay_result raster_bounds(struct delaunay_client *c, const char *set, double *box,
                                   const char **fault)
{
    struct bounds b = {.n = 0};
    char line[120];
    snprintf(line, sizeof line, "HULL %.100s", set);
    enum delaunay_result r = delaunay_request(c, line, take_corner, &b);
    if (r == DELAUNAY_STOPPED)
        return stop(fault, "a row of HULL is not a point");
    if (r == DELAUNAY_OK && b.n == 0)
        return stop(fault, "the set is empty");
    memcpy(box, b.box, sizeof b.box);
    return r;
}

enum delaunay_result raster_fetch(struct delaunay_client *c, const char *set, const char *field,
                                  const struct raster_request *request, struct grid *g,
                                  const char **fault)
{
    enum delaunay_result r = DELAUNAY_OK;
    double box[4];
    void *bytes;
    size_t n;
    if (strchr(field, ',') != NULL)
        return stop(fault, "a raster has one field");
    memcpy(box, request->box, sizeof box);
    if (!request->has_box)
        r = raster_bounds(c, set, box, fault);
    if (r != DELAUNAY_OK)
        return r;
    if (!raster_plan(request, box, g))
        return stop(fault, has_extent(request, box)
                               ? "there would be too many cells"
                               : "the points have no such extent; --cell sets the side of a cell");
    r = send_request(c, set, field, request, g);
    if (r == DELAUNAY_OK)
        r = delaunay_receive_bytes(c, &bytes, &n);
    if (r != DELAUNAY_OK)
        return r;
    if (n != 8 * (size_t)g->columns * g->rows) {
        free(bytes);
        return stop(fault, "a raster of another size");
    }
    g->value = bytes;
    for (size_t i = 0; i < n / 8; i++)
        g->value[i] = bytes_double(&g->value[i]);
    return DELAUNAY_OK;
}

void raster_free(struct grid *g)
{
    free(g->value);
    *g = (struct grid){0};
}
