/* shapes.c - see shapes.h. */
#include "clients/surfaces/shapes.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "clients/lib/array.h"
#include "clients/lib/words.h"
#include "clients/meshes/formats.h"

/* ---- rows ---- */

static bool fault(struct shapes *s, const char *what)
{
    s->fault = what;
    return false;
}

static bool reserve(struct shapes *s, size_t corners)
{
    return (array_reserve((void **)&s->shape, &s->cap, s->n + 1, sizeof s->shape[0]) &&
            array_reserve((void **)&s->xy, &s->corners_cap, s->corners + corners,
                          2 * sizeof s->xy[0])) ||
           fault(s, "out of memory");
}

/* Takes one of two words; *first: it is the first. */
static bool next_kind(struct words *c, const char *first, const char *second, bool *is_first)
{
    const char *word;
    size_t len = words_next(c, &word);
    *is_first = len == strlen(first) && memcmp(word, first, len) == 0;
    return *is_first || (len == strlen(second) && memcmp(word, second, len) == 0);
}

/* A level, which may be infinite. */
static bool next_level(struct words *c, double *v)
{
    struct words before = *c;
    bool below;
    if (words_next_double(c, v))
        return true;
    *c = before;
    if (!next_kind(c, "-inf", "inf", &below))
        return false;
    *v = below ? -HUGE_VAL : HUGE_VAL;
    return true;
}

/* The words of a band from the second one on; a hole follows a ring of the same number, which is known by its levels. */
static bool read_band(const struct shapes *s, struct words *c, struct shape *shape)
{
    double number;
    return next_level(c, &shape->high) && words_next_double(c, &number) &&
           next_kind(c, "hole", "outer", &shape->hole) &&
           (!shape->hole || (s->n > 0 && s->shape[s->n - 1].key == shape->key));
}

static bool read_head(const struct shapes *s, struct words *c, struct shape *shape, uint32_t *n)
{
    *shape = (struct shape){.closed = true, .first = s->corners};
    if (!(s->kind == SHAPE_BAND ? next_level : words_next_double)(c, &shape->key))
        return false;
    if (s->kind == SHAPE_CONTOUR && !next_kind(c, "closed", "open", &shape->closed))
        return false;
    if (s->kind == SHAPE_BAND && !read_band(s, c, shape))
        return false;
    /* a corner takes four characters at least */
    return words_next_u32(c, n) && *n <= (size_t)(c->end - c->s);
}

bool shapes_take(struct shapes *s, const char *row, size_t len)
{
    struct words c = {row, row + len};
    struct shape shape;
    uint32_t n;
    const char *word;
    if (!read_head(s, &c, &shape, &n))
        return fault(s, "a row of the reply is no cell, contour or band");
    if (!reserve(s, n))
        return false;
    for (size_t i = 0; i < 2 * (size_t)n; i++)
        if (!words_next_double(&c, &s->xy[2 * s->corners + i]))
            return fault(s, "a row of the reply has too few coordinates");
    if (words_next(&c, &word) != 0)
        return fault(s, "a row of the reply has too many coordinates");
    if (n == 0)
        return true;
    shape.n = n;
    s->shape[s->n++] = shape;
    s->corners += n;
    return true;
}

bool shapes_add(struct shapes *s, const struct shape *shape, const uint32_t *corner,
                const double *xy)
{
    if (!reserve(s, shape->n))
        return false;
    for (size_t i = 0; i < shape->n; i++)
        memcpy(s->xy + 2 * (s->corners + i), xy + 2 * (size_t)corner[i], 2 * sizeof xy[0]);
    s->shape[s->n] = *shape;
    s->shape[s->n++].first = s->corners;
    s->corners += shape->n;
    return true;
}

void shapes_free(struct shapes *s)
{
    free(s->shape);
    free(s->xy);
    *s = (struct shapes){.kind = s->kind};
}

/* ---- writing ---- */

/* The corners, for a closed shape the first one again in the end. */
static void put_corners(FILE *out, const struct shapes *s, const struct shape *shape,
                        const char *before, char between, const char *after)
{
    for (size_t i = 0; i < shape->n + shape->closed; i++) {
        const double *p = s->xy + 2 * (shape->first + i % shape->n);
        fputs(i > 0 ? "," : "", out);
        fputs(before, out);
        formats_put_number(out, p[0]);
        putc(between, out);
        formats_put_number(out, p[1]);
        fputs(after, out);
    }
}

/* An infinite level is not a number of JSON. */
static void put_level(FILE *out, double level, const char *infinite)
{
    if (isinf(level))
        fputs(infinite, out);
    else
        formats_put_number(out, level);
}

/* Of a polygon of n rings, or a line. */
static void put_properties(FILE *out, const struct shapes *s, const struct shape *shape, size_t n)
{
    static const char *const first[] = {[SHAPE_CELL] = "{\"id\":",
                                        [SHAPE_CONTOUR] = "{\"level\":",
                                        [SHAPE_BAND] = "{\"low\":",
                                        [SHAPE_RING] = "{\"radius\":"};
    fputs(first[s->kind], out);
    put_level(out, shape->key, "null");
    if (s->kind == SHAPE_CONTOUR)
        fputs(shape->closed ? ",\"closed\":true" : ",\"closed\":false", out);
    if (s->kind == SHAPE_BAND) {
        fputs(",\"high\":", out);
        put_level(out, shape->high, "null");
    }
    if (s->kind == SHAPE_RING)
        fprintf(out, ",\"holes\":%zu", n - 1);
    putc('}', out);
}

size_t shapes_rings(const struct shapes *s, size_t i)
{
    size_t n = 1;
    while (i + n < s->n && s->shape[i + n].hole)
        n++;
    return n;
}

size_t shapes_count(const struct shapes *s)
{
    size_t n = 0;
    for (size_t i = 0; i < s->n; i++)
        n += !s->shape[i].hole;
    return n;
}

void shapes_write_geojson(FILE *out, const struct shapes *s)
{
    bool line = s->kind == SHAPE_CONTOUR;
    crs_begin_geojson(out, s->crs);
    for (size_t i = 0, n; i < s->n; i += n) {
        n = shapes_rings(s, i);
        fputs("{\"type\":\"Feature\",\"properties\":", out);
        put_properties(out, s, &s->shape[i], n);
        fputs(line ? ",\"geometry\":{\"type\":\"LineString\",\"coordinates\":["
                   : ",\"geometry\":{\"type\":\"Polygon\",\"coordinates\":[[",
              out);
        for (size_t k = 0; k < n; k++) {
            fputs(k > 0 ? "],[" : "", out);
            put_corners(out, s, &s->shape[i + k], "[", ',', "]");
        }
        fputs(line ? "]}}" : "]]}}", out);
        fputs(i + n < s->n ? ",\n" : "\n", out);
    }
    fputs("]}\n", out);
}

/* A table; geometries have commas and are quoted. */
void shapes_write_wkt(FILE *out, const struct shapes *s)
{
    static const char *const head[] = {[SHAPE_CELL] = "WKT,id\n",
                                       [SHAPE_CONTOUR] = "WKT,level,closed\n",
                                       [SHAPE_BAND] = "WKT,low,high\n",
                                       [SHAPE_RING] = "WKT,radius,holes\n"};
    bool line = s->kind == SHAPE_CONTOUR;
    fputs(head[s->kind], out);
    for (size_t i = 0, n; i < s->n; i += n) {
        const struct shape *shape = &s->shape[i];
        n = shapes_rings(s, i);
        fputs(line ? "\"LINESTRING (" : "\"POLYGON ((", out);
        for (size_t k = 0; k < n; k++) {
            fputs(k > 0 ? "),(" : "", out);
            put_corners(out, s, shape + k, "", ' ', "");
        }
        fputs(line ? ")\"," : "))\",", out);
        put_level(out, shape->key, "-inf");
        if (s->kind == SHAPE_BAND) {
            putc(',', out);
            put_level(out, shape->high, "inf");
        }
        if (s->kind == SHAPE_RING)
            fprintf(out, ",%zu", n - 1);
        fputs(!line ? "\n" : shape->closed ? ",true\n" : ",false\n", out);
    }
}
