/* wkt_lines.c - see wkt_lines.h. */
#include "clients/lines/wkt_lines.h"

#include <math.h>

#include "clients/reading/report.h"
#include "clients/reading/wkt.h"
#include "proto/number.h"

enum { DEEPEST = 32 };

struct wkt {
    struct points_file *f;
    const struct wkt_name *name;
    struct value rest; /* what has not been read, without blanks in front */
    double *z;
    bool flat; /* a third value is no height: M */
    bool in_path;
};

static bool bad(struct wkt *w)
{
    char text[40];
    const char *curved = wkt_curved_kind(w->rest);
    if (curved != NULL)
        return points_file_bad(w->f,
                               "%s has curves, and only straight lines are read; ogr2ogr -nlt "
                               "CONVERT_TO_LINEAR makes straight lines of curves",
                               curved);
    return points_file_bad(
        w->f, "no points, lines or polygons in well-known text, at \"%s\"",
        report_clean(text, sizeof text, w->rest.text, w->rest.len < 30 ? w->rest.len : 30));
}

static void pass(struct wkt *w, size_t n)
{
    w->rest = value_trim(w->rest.text + n, w->rest.text + w->rest.len);
}

static bool take(struct wkt *w, char c)
{
    if (w->rest.len == 0 || w->rest.text[0] != c)
        return false;
    pass(w, 1);
    return true;
}

static bool read_number(struct wkt *w, double *v)
{
    size_t n = proto_read_leading_double(w->rest.text, w->rest.len, v);
    pass(w, n);
    return n > 0;
}

/* `x y`, and perhaps z and m. */
static bool read_position(struct wkt *w)
{
    double v[4];
    size_t n = 0;
    while (n < 4 && w->rest.len > 0 && w->rest.text[0] != ',' && w->rest.text[0] != ')')
        if (!read_number(w, &v[n++]))
            return bad(w);
    if (n < 2)
        return bad(w);
    if (w->z != NULL)
        *w->z = n > 2 && !w->flat && isfinite(v[2]) ? v[2] : (double)NAN;
    return points_file_append(w->f, v[0], v[1]) && (!w->in_path || points_file_corner(w->f));
}

typedef bool read_fn(struct wkt *w, uint32_t number, bool border);

/* `(part, part, ...)`, or EMPTY. */
static bool read_list(struct wkt *w, read_fn *part, uint32_t number, bool border)
{
    if (wkt_take_word(&w->rest, "EMPTY"))
        return true;
    if (!take(w, '('))
        return bad(w);
    do {
        if (!part(w, number, border))
            return false;
    } while (take(w, ','));
    return take(w, ')') || bad(w);
}

/* A position of a MultiPoint, with or without brackets of its own. */
static bool read_point(struct wkt *w, uint32_t number, bool border)
{
    if (wkt_take_word(&w->rest, "EMPTY"))
        return true;
    bool brackets = take(w, '(');
    return read_position(w) && (!brackets || take(w, ')') || bad(w));
}

static bool read_corner(struct wkt *w, uint32_t number, bool border)
{
    return read_position(w);
}

static bool read_path(struct wkt *w, uint32_t number, bool border, bool ring)
{
    if (!points_file_begin_path(w->f, border, number, 0))
        return false;
    w->in_path = true;
    bool ok = read_list(w, read_corner, number, border);
    w->in_path = false;
    if (ok)
        points_file_end_path(w->f, ring);
    return ok;
}

static bool read_ring(struct wkt *w, uint32_t number, bool border)
{
    return read_path(w, number, border, true);
}

static bool choose_number(struct wkt *w, uint32_t *number)
{
    *number = w->name->number;
    return w->name->named || points_file_number(w->f, number);
}

static bool read_line(struct wkt *w, uint32_t number, bool border)
{
    return wkt_take_word(&w->rest, "EMPTY") ||
           (choose_number(w, &number) && read_path(w, number, border, false));
}

static bool read_polygon(struct wkt *w, uint32_t number, bool border)
{
    return wkt_take_word(&w->rest, "EMPTY") ||
           (choose_number(w, &number) && read_list(w, read_ring, number, true));
}

static bool read_geometry(struct wkt *w, int depth)
{
    static const struct {
        const char *word;
        read_fn *part, *whole;
    } kinds[] = {{"POINT", read_point, NULL},     {"MULTIPOINT", read_point, NULL},
                 {"LINESTRING", NULL, read_line}, {"MULTILINESTRING", read_line, NULL},
                 {"POLYGON", NULL, read_polygon}, {"MULTIPOLYGON", read_polygon, NULL}};
    const bool border = w->name->named && w->name->border;
    for (size_t i = 0; i < sizeof kinds / sizeof kinds[0]; i++) {
        if (!wkt_take_kind(&w->rest, kinds[i].word, &w->flat))
            continue;
        return kinds[i].whole != NULL ? kinds[i].whole(w, 0, border)
                                      : read_list(w, kinds[i].part, 0, border);
    }
    if (depth == DEEPEST || !wkt_take_kind(&w->rest, "GEOMETRYCOLLECTION", &w->flat))
        return bad(w);
    if (wkt_take_word(&w->rest, "EMPTY"))
        return true;
    if (!take(w, '('))
        return bad(w);
    do {
        if (!read_geometry(w, depth + 1))
            return false;
    } while (take(w, ','));
    return take(w, ')') || bad(w);
}

bool wkt_lines_read(struct points_file *f, struct value v, const struct wkt_name *name, double *z)
{
    struct wkt w = {.f = f, .name = name, .rest = wkt_without_srid(v), .z = z};
    const size_t n = f->n, paths = f->paths.n, corners = f->paths.corners;
    const uint32_t number = f->paths.number;
    bool ok = read_geometry(&w, 0) && (w.rest.len == 0 || bad(&w));
    if (!ok) {
        f->n = n;
        f->paths.n = paths;
        f->paths.corners = corners;
        f->paths.number = number;
    }
    return ok;
}
