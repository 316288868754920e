/* line_formats.c - see line_formats.h. */
#include "clients/meshes/line_formats.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "clients/meshes/faces.h"
#include "clients/meshes/model_paths.h"

struct lines {
    FILE *out;
    const struct model *m;
    struct paths paths; /* owns */
    bool *used;         /* owns: of each point, whether it is the corner of a path */
};

static bool lines_init(struct lines *l, FILE *out, const struct model *m)
{
    *l = (struct lines){.out = out, .m = m};
    l->used = calloc(m->n + 1, sizeof l->used[0]);
    bool ok = l->used != NULL && model_paths(m, &l->paths);
    for (size_t i = 0; ok && i < l->paths.corners; i++)
        l->used[l->paths.corner[i]] = true;
    return ok;
}

static void lines_free(struct lines *l)
{
    paths_free(&l->paths);
    free(l->used);
}

static bool has_height(const struct lines *l, size_t place)
{
    return l->m->z >= 0 && !isnan(model_value(l->m, l->m->z, place));
}

static void put_place(const struct lines *l, size_t place, char between, bool height)
{
    formats_put_number(l->out, l->m->xy[2 * place]);
    putc(between, l->out);
    formats_put_number(l->out, l->m->xy[2 * place + 1]);
    if (!height)
        return;
    putc(between, l->out);
    formats_put_number(l->out, model_value(l->m, l->m->z, place));
}

/* The place of a corner; that after the last one is the first again. */
static size_t corner(const struct lines *l, const struct path *path, size_t i)
{
    return l->paths.corner[path->first + i % path->n];
}

static size_t corners(const struct path *path)
{
    return path->n + path->closed;
}

static bool is_polygon(const struct path *path)
{
    return path->border && path->closed;
}

/* The number of paths that are one polygon: a ring and its holes; 1 for a line. */
static size_t group(const struct lines *l, size_t i)
{
    size_t n = 1;
    while (i + n < l->paths.n && l->paths.path[i + n].hole)
        n++;
    return n;
}

static const char *kind(const struct path *path)
{
    return path->border ? "border" : "line";
}

/* ---- GeoJSON ---- */

static void put_positions(const struct lines *l, const struct path *path)
{
    putc('[', l->out);
    for (size_t i = 0; i < corners(path); i++) {
        size_t place = corner(l, path, i);
        fputs(i > 0 ? ",[" : "[", l->out);
        put_place(l, place, ',', has_height(l, place));
        putc(']', l->out);
    }
    putc(']', l->out);
}

static void put_feature(const struct lines *l, size_t first, size_t n)
{
    const struct path *path = &l->paths.path[first];
    bool polygon = is_polygon(path);
    fprintf(l->out,
            "{\"type\":\"Feature\",\"properties\":{\"kind\":\"%s\",\"number\":%u},"
            "\"geometry\":{\"type\":\"%s\",\"coordinates\":%s",
            kind(path), (unsigned)path->number, polygon ? "Polygon" : "LineString",
            polygon ? "[" : "");
    for (size_t i = 0; i < n; i++) {
        fputs(i > 0 ? "," : "", l->out);
        put_positions(l, path + i);
    }
    fputs(polygon ? "]}}" : "}}", l->out);
}

static bool write_features(FILE *out, const struct model *m, const char *between)
{
    struct lines l;
    bool ok = lines_init(&l, out, m), any = false;
    for (size_t i = 0, n; ok && i < l.paths.n; i += n) {
        n = group(&l, i);
        fputs(any ? between : "", out);
        put_feature(&l, i, n);
        any = true;
    }
    for (size_t i = 0; ok && i < m->n; i++) {
        if (l.used[i])
            continue;
        fprintf(out,
                "%s{\"type\":\"Feature\",\"properties\":{},"
                "\"geometry\":{\"type\":\"Point\",\"coordinates\":[",
                any ? between : "");
        put_place(&l, i, ',', has_height(&l, i));
        fputs("]}}", out);
        any = true;
    }
    lines_free(&l);
    return ok;
}

static bool write_geojson(FILE *out, const struct model *m)
{
    crs_begin_geojson(out, m->crs);
    bool ok = write_features(out, m, ",\n");
    fputs("\n]}\n", out);
    return ok;
}

static bool write_ndjson(FILE *out, const struct model *m)
{
    bool ok = write_features(out, m, "\n");
    putc('\n', out);
    return ok;
}

/* ---- WKT ---- */

/* Whether all places of these paths have a height, as one geometry needs it. */
static bool have_heights(const struct lines *l, const struct path *path, size_t n)
{
    for (size_t i = 0; i < n; i++)
        for (size_t k = 0; k < path[i].n; k++)
            if (!has_height(l, corner(l, &path[i], k)))
                return false;
    return true;
}

static void put_list(const struct lines *l, const struct path *path, bool heights)
{
    putc('(', l->out);
    for (size_t i = 0; i < corners(path); i++) {
        fputs(i > 0 ? ", " : "", l->out);
        put_place(l, corner(l, path, i), ' ', heights);
    }
    putc(')', l->out);
}

static bool write_wkt(FILE *out, const struct model *m)
{
    struct lines l;
    bool ok = lines_init(&l, out, m);
    fputs("WKT,kind,number\n", out);
    for (size_t i = 0, n; ok && i < l.paths.n; i += n) {
        const struct path *path = &l.paths.path[i];
        n = group(&l, i);
        bool heights = have_heights(&l, path, n), polygon = is_polygon(path);
        fprintf(out, "\"%s%s", polygon ? "POLYGON " : "LINESTRING ", heights ? "Z " : "");
        fputs(polygon ? "(" : "", out);
        for (size_t k = 0; k < n; k++) {
            fputs(k > 0 ? ", " : "", out);
            put_list(&l, path + k, heights);
        }
        fprintf(out, "%s\",%s,%u\n", polygon ? ")" : "", kind(path), (unsigned)path->number);
    }
    for (size_t i = 0; ok && i < m->n; i++) {
        if (l.used[i])
            continue;
        fputs(has_height(&l, i) ? "POINT Z (" : "POINT (", out);
        put_place(&l, i, ' ', has_height(&l, i));
        fputs("),,\n", out);
    }
    lines_free(&l);
    return ok;
}

/* ---- GMT ---- */

/* Values between blanks; a row has a value for each column, nan where it is missing. */
static void put_row(const struct lines *l, size_t place)
{
    put_place(l, place, ' ', false);
    if (has_height(l, place)) {
        putc(' ', l->out);
        formats_put_number(l->out, model_value(l->m, l->m->z, place));
    } else if (l->m->z >= 0) {
        fputs(" nan", l->out);
    }
    putc('\n', l->out);
}

/* A point that no line has as a corner is a line of its own, since every row after > belongs to one. */
static bool write_gmt(FILE *out, const struct model *m)
{
    struct lines l;
    bool ok = lines_init(&l, out, m);
    for (size_t i = 0; ok && i < l.paths.n; i++) {
        const struct path *path = &l.paths.path[i];
        fprintf(out, "> %s %u\n", kind(path), (unsigned)path->number);
        for (size_t k = 0; k < corners(path); k++)
            put_row(&l, corner(&l, path, k));
    }
    for (size_t i = 0; ok && i < m->n; i++)
        if (!l.used[i]) {
            fputs("> point\n", out);
            put_row(&l, i);
        }
    lines_free(&l);
    return ok;
}

/* ---- OBJ ---- */

static bool write_obj(FILE *out, const struct model *m)
{
    struct lines l;
    bool ok = lines_init(&l, out, m);
    for (size_t i = 0; ok && i < m->n; i++) {
        fputs("v ", out);
        put_place(&l, i, ' ', false);
        putc(' ', out);
        formats_put_number(out, has_height(&l, i) ? model_value(m, m->z, i) : 0);
        putc('\n', out);
    }
    for (size_t i = 0; ok && i < l.paths.n; i++) {
        const struct path *path = &l.paths.path[i];
        if (i == 0 || path[-1].border != path->border || path[-1].number != path->number)
            fprintf(out, "g %s_%u\n", kind(path), (unsigned)path->number);
        putc('l', out);
        for (size_t k = 0; k < corners(path); k++)
            fprintf(out, " %zu", corner(&l, path, k) + 1);
        putc('\n', out);
    }
    lines_free(&l);
    return ok;
}

/* ---- the .poly files of Shewchuk's Triangle ---- */

/* The number of a segment with these ends: the number of the first line between them, or else of the first border. Returns how
 * many constraints have these ends. */
static size_t next_segment(const struct model *m, size_t i)
{
    size_t n = 1;
    while (i + n < m->constraints && m->constraint[3 * (i + n)] == m->constraint[3 * i] &&
           m->constraint[3 * (i + n) + 1] == m->constraint[3 * i + 1])
        n++;
    return n;
}

static void put_segments(FILE *out, const struct model *m)
{
    size_t count = 0;
    for (size_t i = 0; i < m->constraints; i += next_segment(m, i))
        count++;
    fprintf(out, "%zu 1\n", count);
    count = 0;
    for (size_t i = 0; i < m->constraints; i += next_segment(m, i))
        fprintf(out, "%zu %u %u %u\n", count++, (unsigned)m->constraint[3 * i],
                (unsigned)m->constraint[3 * i + 1], (unsigned)m->constraint[3 * i + 2] / 2);
}

/* The middle of the triangle, of each face that is chosen: of its largest triangle, where rounding does not leave the face. */
static void put_seed(FILE *out, const struct model *m, size_t number, size_t triangle,
                     int64_t attribute)
{
    double at[2] = {0, 0};
    for (size_t k = 0; k < 3; k++)
        for (size_t i = 0; i < 2; i++)
            at[i] += m->xy[2 * (size_t)m->triangle[3 * triangle + k] + i] / 3;
    fprintf(out, "%zu ", number);
    formats_put_number(out, at[0]);
    putc(' ', out);
    formats_put_number(out, at[1]);
    if (attribute >= 0)
        fprintf(out, " %jd", (intmax_t)attribute);
    putc('\n', out);
}

static double area_of(const struct model *m, size_t t)
{
    const double *a = m->xy + 2 * (size_t)m->triangle[3 * t],
                 *b = m->xy + 2 * (size_t)m->triangle[3 * t + 1],
                 *c = m->xy + 2 * (size_t)m->triangle[3 * t + 2];
    return fabs((b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1]));
}

/* The largest triangle of each face; the caller frees it. NULL when out of memory. */
static size_t *largest(const struct model *m, const struct faces *f)
{
    size_t *best = malloc((f->n + 1) * sizeof best[0]);
    for (size_t i = 0; best != NULL && i < f->n; i++)
        best[i] = SIZE_MAX;
    for (size_t t = 0; best != NULL && t < m->triangles; t++) {
        size_t *b = &best[f->face[t]];
        if (*b == SIZE_MAX || area_of(m, t) > area_of(m, *b))
            *b = t;
    }
    return best;
}

/* Whether the face with this triangle needs a seed: holes are the faces that lines enclose, but no border; regions those inside of borders
 * of other numbers than 0. Without borders there are neither. */
static bool needs_seed(const struct model *m, bool enclosed, size_t triangle, bool hole)
{
    int64_t region = m->regions ? m->region[triangle] : 0;
    return hole ? enclosed && region == MODEL_OUTSIDE : region > 0;
}

/* The number of holes or regions and a seed for each; without regions nothing. */
static void put_seeds(FILE *out, const struct model *m, const struct faces *f, const size_t *best,
                      bool holes)
{
    size_t count = 0, n = 0;
    for (size_t i = 0; i < f->n; i++)
        count += needs_seed(m, f->enclosed[i], best[i], holes);
    if (holes || count > 0)
        fprintf(out, "%zu\n", count);
    for (size_t i = 0; i < f->n; i++)
        if (needs_seed(m, f->enclosed[i], best[i], holes))
            put_seed(out, m, n++, best[i], holes ? -1 : m->region[best[i]]);
}

static bool put_holes_and_regions(FILE *out, const struct model *m)
{
    struct sides sides;
    struct faces f = {0};
    bool ok = sides_init(&sides, m) && faces_init(&f, m, &sides);
    size_t *best = ok ? largest(m, &f) : NULL;
    ok = best != NULL;
    if (ok) {
        put_seeds(out, m, &f, best, true);
        put_seeds(out, m, &f, best, false);
    }
    free(best);
    faces_free(&f);
    sides_free(&sides);
    return ok;
}

static bool write_poly(FILE *out, const struct model *m)
{
    bool ok = formats_write_node(out, m);
    put_segments(out, m);
    return ok && put_holes_and_regions(out, m);
}

/* ---- the table ---- */

#define LINES (MODEL_CONSTRAINTS | MODEL_FIELDS)

const struct format line_formats[] = {
    {"poly", LINES | MODEL_TRIANGLES | MODEL_HULL | MODEL_FIXED | MODEL_REGIONS, write_poly,
     "Triangle's points, segments, holes and regions", false},
    {"gmt", LINES, write_gmt, "GMT's multi-segment file", false},
    {"geojson", LINES, write_geojson, "a FeatureCollection of lines and polygons", false},
    {"ndjson", LINES, write_ndjson, "a GeoJSON feature per line, polygon or point", false},
    {"wkt", LINES, write_wkt, "a table with the columns WKT, kind and number", false},
    {"obj", LINES, write_obj, "Wavefront OBJ, points and lines", false},
};

const size_t line_format_count = sizeof line_formats / sizeof line_formats[0];

void formats_list(char *to, size_t room, const char *between)
{
    size_t n = (size_t)snprintf(to, room, "svg%spng", between);
    for (size_t i = 0; i < format_count && n < room; i++)
        n += (size_t)snprintf(to + n, room - n, "%s%s", between, formats[i].name);
    for (size_t i = 0; i < line_format_count && n < room; i++)
        if (format_find(line_formats[i].name) == NULL)
            n += (size_t)snprintf(to + n, room - n, "%s%s", between, line_formats[i].name);
}

const struct format *line_format_find(const char *name)
{
    for (size_t i = 0; i < line_format_count; i++)
        if (strcmp(line_formats[i].name, name) == 0)
            return &line_formats[i];
    return NULL;
}
