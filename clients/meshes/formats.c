/* formats.c - see formats.h. One function for each format; a row is formatted in a buffer and written at once. */
#include "clients/meshes/formats.h"

#include "proto/number.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- rows ---- */

struct row {
    char text[3 * MODEL_MOST_FIELDS * (MODEL_NAME + 6 + PROTO_NUMBER_MAX) +
              1024]; /* the longest feature fits */
    size_t n;
};

static void put(struct row *r, const char *text)
{
    size_t n = strlen(text);
    memcpy(r->text + r->n, text, n);
    r->n += n;
}

void formats_put_number(FILE *out, double v)
{
    char text[PROTO_NUMBER_MAX];
    size_t n = proto_write_double(text, v);
    fwrite(text, 1, n, out);
}

static void put_id(struct row *r, size_t v, char after)
{
    r->n += proto_write_u32(r->text + r->n, (uint32_t)v);
    r->text[r->n++] = after;
}

static void put_double(struct row *r, double v, char after)
{
    r->n += proto_write_double(r->text + r->n, v);
    r->text[r->n++] = after;
}

static void put_xy(struct row *r, const double *xy, char between, char after)
{
    put_double(r, xy[0], between);
    put_double(r, xy[1], after);
}

static void end(struct row *r, FILE *out)
{
    r->text[r->n - 1] = '\n';
    fwrite(r->text, 1, r->n, out);
    r->n = 0;
}

/* The height of a point, 0 in a flat set. */
static double height(const struct model *m, size_t i)
{
    return m->z >= 0 ? model_value(m, m->z, i) : 0;
}

/* A value of a field, in the format's word where it is missing. */
static void put_value(struct row *r, const struct model *m, size_t field, size_t i,
                      const char *missing, char after)
{
    double v = model_value(m, (int)field, i);
    if (!isnan(v)) {
        put_double(r, v, after);
        return;
    }
    put(r, missing);
    r->text[r->n++] = after;
}

/* Rows `PREFIX x y z`. */
static void write_points_3d(FILE *out, const struct model *m, const char *prefix)
{
    struct row r = {.n = 0};
    for (size_t i = 0; i < m->n; i++) {
        put(&r, prefix);
        put_xy(&r, m->xy + 2 * i, ' ', ' ');
        put_double(&r, height(m, i), ' ');
        end(&r, out);
    }
}

/* Rows `PREFIX a b c`, numbers counted from `base`. */
static void write_faces(FILE *out, const struct model *m, const char *prefix, size_t base)
{
    struct row r = {.n = 0};
    for (size_t t = 0; t < m->triangles; t++) {
        put(&r, prefix);
        for (size_t k = 0; k < 3; k++)
            put_id(&r, m->triangle[3 * t + k] + base, ' ');
        end(&r, out);
    }
}

/* ---- meshes ---- */

static bool write_obj(FILE *out, const struct model *m)
{
    fputs("# Delaunay triangulation\n", out);
    write_points_3d(out, m, "v ");
    write_faces(out, m, "f ", 1);
    return true;
}

static bool write_ply(FILE *out, const struct model *m)
{
    fprintf(out,
            "ply\nformat ascii 1.0\nelement vertex %zu\nproperty double x\nproperty double y\n"
            "property double z\nelement face %zu\nproperty list uchar uint vertex_indices\n"
            "end_header\n",
            m->n, m->triangles);
    write_points_3d(out, m, "");
    write_faces(out, m, "3 ", 0);
    return true;
}

static bool write_off(FILE *out, const struct model *m)
{
    fprintf(out, "OFF\n%zu %zu 0\n", m->n, m->triangles);
    write_points_3d(out, m, "");
    write_faces(out, m, "3 ", 0);
    return true;
}

/* SMS 2DM: elements `E3T number a b c material`, then nodes `ND number x y z`. */
static bool write_2dm(FILE *out, const struct model *m)
{
    struct row r = {.n = 0};
    fputs("MESH2D\n", out);
    for (size_t t = 0; t < m->triangles; t++) {
        put(&r, "E3T ");
        put_id(&r, t + 1, ' ');
        for (size_t k = 0; k < 3; k++)
            put_id(&r, m->triangle[3 * t + k] + (size_t)1, ' ');
        put_id(&r, 1, ' ');
        end(&r, out);
    }
    for (size_t i = 0; i < m->n; i++) {
        put(&r, "ND ");
        put_id(&r, i + 1, ' ');
        put_xy(&r, m->xy + 2 * i, ' ', ' ');
        put_double(&r, height(m, i), ' ');
        end(&r, out);
    }
    return true;
}

/* ---- the files of Shewchuk's Triangle ---- */

bool formats_write_node(FILE *out, const struct model *m)
{
    struct row r = {.n = 0};
    char *boundary = calloc(m->n + 1, 1);
    if (boundary == NULL)
        return false;
    for (size_t i = 0; i < m->hull_n; i++)
        boundary[m->hull[i]] = 1;
    fprintf(out, "%zu 2 %zu 1\n", m->n, m->fields);
    for (size_t i = 0; i < m->n; i++) {
        put_id(&r, i, ' ');
        put_xy(&r, m->xy + 2 * i, ' ', ' ');
        for (size_t k = 0; k < m->fields; k++)
            put_value(&r, m, k, i, "nan", ' ');
        put_id(&r, (size_t)boundary[i], ' ');
        end(&r, out);
    }
    free(boundary);
    return true;
}

static bool write_ele(FILE *out, const struct model *m)
{
    struct row r = {.n = 0};
    fprintf(out, "%zu 3 0\n", m->triangles);
    for (size_t t = 0; t < m->triangles; t++) {
        put_id(&r, t, ' ');
        for (size_t k = 0; k < 3; k++)
            put_id(&r, m->triangle[3 * t + k], ' ');
        end(&r, out);
    }
    return true;
}

/* The k-th neighbour lies opposite the k-th corner; -1: none. */
static bool write_neigh(FILE *out, const struct model *m)
{
    struct row r = {.n = 0};
    struct sides sides;
    if (!sides_init(&sides, m))
        return false;
    fprintf(out, "%zu 3\n", m->triangles);
    for (size_t t = 0; t < m->triangles; t++) {
        const uint32_t *v = m->triangle + 3 * t;
        put_id(&r, t, ' ');
        for (size_t k = 0; k < 3; k++) {
            int64_t next = sides_find(&sides, v[(k + 2) % 3], v[(k + 1) % 3]);
            if (next == NO_TRIANGLE)
                put(&r, "-1 ");
            else
                put_id(&r, (size_t)next, ' ');
        }
        end(&r, out);
    }
    sides_free(&sides);
    return true;
}

static bool write_edge(FILE *out, const struct model *m)
{
    struct row r = {.n = 0};
    struct sides sides;
    if (!sides_init(&sides, m))
        return false;
    fprintf(out, "%zu 1\n", m->edges);
    for (size_t i = 0; i < m->edges; i++) {
        uint32_t a = m->edge[2 * i], b = m->edge[2 * i + 1];
        put_id(&r, i, ' ');
        put_id(&r, a, ' ');
        put_id(&r, b, ' ');
        put_id(&r,
               sides_find(&sides, a, b) == NO_TRIANGLE || sides_find(&sides, b, a) == NO_TRIANGLE,
               ' ');
        end(&r, out);
    }
    sides_free(&sides);
    return true;
}

/* ---- a line for each triangle ---- */

static const double *corner(const struct model *m, size_t t, size_t k)
{
    return m->xy + 2 * (size_t)m->triangle[3 * t + k % 3];
}

/* A table with the heading WKT, as OGR's CSV driver and QGIS read it; the geometry has commas and is quoted. */
static bool write_wkt(FILE *out, const struct model *m)
{
    struct row r = {.n = 0};
    fputs("WKT,a,b,c\n", out);
    for (size_t t = 0; t < m->triangles; t++) {
        put(&r, "\"POLYGON ((");
        for (size_t k = 0; k < 4; k++) {
            put_xy(&r, corner(m, t, k), ' ', k < 3 ? ',' : ')');
            put(&r, k < 3 ? " " : ")\",");
        }
        for (size_t k = 0; k < 3; k++)
            put_id(&r, m->id[m->triangle[3 * t + k]], ',');
        end(&r, out);
    }
    return true;
}

static bool write_csv(FILE *out, const struct model *m)
{
    struct row r = {.n = 0};
    fputs("a,b,c,ax,ay,bx,by,cx,cy", out);
    for (size_t i = 0; i < m->fields; i++)
        fprintf(out, ",a%s,b%s,c%s", m->field[i], m->field[i], m->field[i]);
    putc('\n', out);
    for (size_t t = 0; t < m->triangles; t++) {
        for (size_t k = 0; k < 3; k++)
            put_id(&r, m->id[m->triangle[3 * t + k]], ',');
        for (size_t k = 0; k < 3; k++)
            put_xy(&r, corner(m, t, k), ',', ',');
        for (size_t i = 0; i < m->fields; i++)
            for (size_t k = 0; k < 3; k++)
                put_value(&r, m, i, m->triangle[3 * t + k], "", ',');
        end(&r, out);
    }
    return true;
}

/* `"aNAME":`, where a is the corner's letter. */
static void put_key(struct row *r, size_t corner, const char *name)
{
    const char letter[] = {'"', (char)('a' + corner), '\0'};
    put(r, letter);
    put(r, name);
    put(r, "\":");
}

/* A GeoJSON feature and `after`. Properties are single values, as in the CSV: many formats have no lists. */
static void write_feature(FILE *out, const struct model *m, size_t t, const char *after)
{
    struct row r = {.n = 0};
    put(&r, "{\"type\":\"Feature\",\"properties\":{");
    for (size_t k = 0; k < 3; k++) {
        put_key(&r, k, "");
        put_id(&r, m->id[m->triangle[3 * t + k]], ',');
    }
    for (size_t i = 0; i < m->fields; i++)
        for (size_t k = 0; k < 3; k++) {
            put_key(&r, k, m->field[i]);
            put_value(&r, m, i, m->triangle[3 * t + k], "null", ',');
        }
    r.n--; /* the last comma */
    put(&r, "},\"geometry\":{\"type\":\"Polygon\",\"coordinates\":[[");
    for (size_t k = 0; k < 4; k++) {
        put(&r, "[");
        put_xy(&r, corner(m, t, k), ',', ']');
        put(&r, k < 3 ? "," : "]]}}");
    }
    put(&r, after);
    end(&r, out);
}

static bool write_geojson(FILE *out, const struct model *m)
{
    crs_begin_geojson(out, m->crs);
    for (size_t t = 0; t < m->triangles; t++)
        write_feature(out, m, t, t + 1 < m->triangles ? ",\n" : "\n");
    fputs("]}\n", out);
    return true;
}

static bool write_ndjson(FILE *out, const struct model *m)
{
    for (size_t t = 0; t < m->triangles; t++)
        write_feature(out, m, t, "\n");
    return true;
}

/* ---- the table ---- */

const struct format formats[] = {
    {"obj", MODEL_TRIANGLES | MODEL_FIELDS, write_obj, "Wavefront OBJ", true},
    {"ply", MODEL_TRIANGLES | MODEL_FIELDS, write_ply, "Stanford PLY, as text", true},
    {"off", MODEL_TRIANGLES | MODEL_FIELDS, write_off, "Object File Format", true},
    {"2dm", MODEL_TRIANGLES | MODEL_FIELDS, write_2dm, "SMS 2DM mesh", true},
    {"node", MODEL_HULL | MODEL_FIELDS, formats_write_node, "Triangle's points", false},
    {"ele", MODEL_TRIANGLES, write_ele, "Triangle's triangles", false},
    {"neigh", MODEL_TRIANGLES, write_neigh, "Triangle's neighbours of triangles", false},
    {"edge", MODEL_TRIANGLES | MODEL_EDGES, write_edge, "Triangle's edges", false},
    {"wkt", MODEL_TRIANGLES, write_wkt, "a table of triangles with a column WKT", false},
    {"csv", MODEL_TRIANGLES | MODEL_FIELDS, write_csv, "ids and coordinates, a line per triangle",
     false},
    {"geojson", MODEL_TRIANGLES | MODEL_FIELDS, write_geojson, "a FeatureCollection of triangles",
     false},
    {"ndjson", MODEL_TRIANGLES | MODEL_FIELDS, write_ndjson,
     "a GeoJSON feature per triangle and line", false},
};

const size_t format_count = sizeof formats / sizeof formats[0];

const struct format *format_find(const char *name)
{
    for (size_t i = 0; i < format_count; i++)
        if (strcmp(formats[i].name, name) == 0)
            return &formats[i];
    return NULL;
}
