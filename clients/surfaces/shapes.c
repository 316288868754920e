/* shapes.c - see shapes.h. */
#include "clients/surfaces/shapes.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "clients/surfaces/words.h"
#include "proto/number.h"

/* ---- rows ---- */

static bool next_number(struct words *c, double *v)
{
    const char *word;
    size_t len = words_next(c, &word);
    return proto_read_double(word, len, v);
}

static bool fault(struct shapes *s, const char *what)
{
    s->fault = what;
    return false;
}

static bool reserve(struct shapes *s, size_t corners)
{
    if (s->n == s->cap) {
        size_t cap = s->cap == 0 ? 256 : 2 * s->cap;
        struct shape *shape = realloc(s->shape, cap * sizeof shape[0]);
        if (shape == NULL)
            return fault(s, "out of memory");
        s->shape = shape;
        s->cap = cap;
    }
    if (corners > s->corners_cap - s->corners) {
        size_t cap = 2 * (s->corners + corners) + 1024;
        double *xy = realloc(s->xy, cap * 2 * sizeof xy[0]);
        if (xy == NULL)
            return fault(s, "out of memory");
        s->xy = xy;
        s->corners_cap = cap;
    }
    return true;
}

static bool read_head(const struct shapes *s, struct words *c, struct shape *shape, uint32_t *n)
{
    const char *word;
    size_t len;
    *shape = (struct shape){.closed = true, .first = s->corners};
    if (!next_number(c, &shape->key))
        return false;
    if (s->kind == SHAPE_CONTOUR) {
        len = words_next(c, &word);
        shape->closed = len == 6 && memcmp(word, "closed", 6) == 0;
        if (!shape->closed && (len != 4 || memcmp(word, "open", 4) != 0))
            return false;
    }
    len = words_next(c, &word);
    /* a corner takes four characters at least */
    return proto_read_u32(word, len, n) && *n <= (size_t)(c->end - c->s);
}

bool shapes_take(struct shapes *s, const char *row, size_t len)
{
    struct words c = {row, row + len};
    struct shape shape;
    uint32_t n;
    const char *word;
    if (!read_head(s, &c, &shape, &n))
        return fault(s, "a row of the reply is neither a cell nor a contour");
    if (!reserve(s, n))
        return false;
    for (size_t i = 0; i < 2 * (size_t)n; i++)
        if (!next_number(&c, &s->xy[2 * s->corners + i]))
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

void shapes_free(struct shapes *s)
{
    free(s->shape);
    free(s->xy);
    *s = (struct shapes){.kind = s->kind};
}

bool shapes_bounds(const struct shapes *s, double *box)
{
    for (size_t i = 0; i < s->corners; i++)
        for (int k = 0; k < 2; k++) {
            double v = s->xy[2 * i + (size_t)k];
            box[k] = i == 0 ? v : fmin(box[k], v);
            box[k + 2] = i == 0 ? v : fmax(box[k + 2], v);
        }
    return s->corners > 0;
}

/* ---- writing ---- */

static void put_number(FILE *out, double v)
{
    char text[PROTO_NUMBER_MAX];
    size_t n = proto_write_double(text, v);
    fwrite(text, 1, n, out);
}

/* The corners, for a closed shape the first one again in the end. */
static void put_corners(FILE *out, const struct shapes *s, const struct shape *shape,
                        const char *before, char between, const char *after)
{
    for (size_t i = 0; i < shape->n + shape->closed; i++) {
        const double *p = s->xy + 2 * (shape->first + i % shape->n);
        fputs(i > 0 ? "," : "", out);
        fputs(before, out);
        put_number(out, p[0]);
        putc(between, out);
        put_number(out, p[1]);
        fputs(after, out);
    }
}

static void put_properties(FILE *out, const struct shapes *s, const struct shape *shape)
{
    fputs(s->kind == SHAPE_CELL ? "{\"id\":" : "{\"level\":", out);
    put_number(out, shape->key);
    if (s->kind == SHAPE_CONTOUR)
        fputs(shape->closed ? ",\"closed\":true" : ",\"closed\":false", out);
    putc('}', out);
}

void shapes_write_geojson(FILE *out, const struct shapes *s)
{
    bool cells = s->kind == SHAPE_CELL;
    fputs("{\"type\":\"FeatureCollection\",\"features\":[\n", out);
    for (size_t i = 0; i < s->n; i++) {
        fputs("{\"type\":\"Feature\",\"properties\":", out);
        put_properties(out, s, &s->shape[i]);
        fputs(cells ? ",\"geometry\":{\"type\":\"Polygon\",\"coordinates\":[["
                    : ",\"geometry\":{\"type\":\"LineString\",\"coordinates\":[",
              out);
        put_corners(out, s, &s->shape[i], "[", ',', "]");
        fputs(cells ? "]]}}" : "]}}", out);
        fputs(i + 1 < s->n ? ",\n" : "\n", out);
    }
    fputs("]}\n", out);
}

/* A table; geometries have commas and are quoted. */
void shapes_write_wkt(FILE *out, const struct shapes *s)
{
    bool cells = s->kind == SHAPE_CELL;
    fputs(cells ? "WKT,id\n" : "WKT,level,closed\n", out);
    for (size_t i = 0; i < s->n; i++) {
        fputs(cells ? "\"POLYGON ((" : "\"LINESTRING (", out);
        put_corners(out, s, &s->shape[i], "", ' ', "");
        fputs(cells ? "))\"," : ")\",", out);
        put_number(out, s->shape[i].key);
        fputs(cells ? "\n" : s->shape[i].closed ? ",true\n" : ",false\n", out);
    }
}
