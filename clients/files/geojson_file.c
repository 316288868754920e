/* geojson_file.c - see geojson_file.h. An object's members may be in any order, so its type is known only after all of them. The
 * first pass bookmarks the members; then the type decides which of them are read. */
#include "clients/files/geojson_file.h"

#include "clients/reading/headings.h"
#include "clients/reading/json_scan.h"
#include "proto/number.h"
#include "proto/text.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_PROPERTIES = 256, NO_FIELD = -1 };

struct property {
    struct json_part name;
    uint64_t numbers, others; /* null is neither */
    int field;                /* its column in a row, or NO_FIELD */
};

struct geojson {
    struct points_file *f;
    struct json_scan j;
    struct table_fields *fields;
    struct geojson_notes *notes;
    bool survey; /* the first time: points are not taken yet */
    bool in_path;
    bool named; /* features have names of our files */
    struct property property[MOST_PROPERTIES];
    size_t properties;
    double row[FIELDS_MOST]; /* the values of the feature that is being read */
    uint64_t feature;        /* its place in the file, from 1 */
    struct json_part kind,
        number; /* its properties of these names; without them the text is NULL */
};

static bool bad(struct geojson *g)
{
    g->f->line = g->j.line;
    return points_file_stop(g->f, "not GeoJSON");
}

/* Leaves out a geometry or position, which begins at `at`, and says why. */
static bool leave_out(struct geojson *g, const struct json_scan *at, const char *what)
{
    const char *lf = memchr(at->p, '\n', (size_t)(at->end - at->p));
    if (g->survey)
        return true;
    g->f->line = at->line;
    points_file_fault(g->f, what);
    return points_file_skip(g->f, at->p, (size_t)((lf != NULL ? lf : at->end) - at->p));
}

/* ---- coordinates ---- */

static bool read_finite(struct json_part word, double *v)
{
    return proto_read_double(word.text, word.len, v) && isfinite(*v);
}

static bool add_point(struct geojson *g, const struct json_scan *at, const struct json_part *word)
{
    g->f->line = at->line;
    g->f->row = g->row;
    if (points_file_add(g->f, word[0].text, word[0].len, word[1].text, word[1].len)) {
        if (g->in_path && !points_file_corner(g->f))
            return false;
        for (size_t i = 0; i < g->f->fields; i++)
            g->fields->missing[i] += isnan(g->row[i]) != 0;
        return true;
    }
    const char *end = word[1].text + word[1].len;
    return points_file_skip(g->f, word[0].text, (size_t)(end - word[0].text));
}

/* An array of numbers. */
static bool read_position(struct geojson *g)
{
    struct json_scan at = g->j;
    struct json_part word[3], rest;
    size_t n = 0;
    double z = (double)NAN;
    if (!json_take(&g->j, '['))
        return json_take_value(&g->j, &rest) ? leave_out(g, &at, "a position is not an array")
                                             : bad(g);
    for (bool more = !json_take(&g->j, ']'); more; n++) {
        if (!json_take_value(&g->j, n < 3 ? &word[n] : &rest))
            return bad(g);
        more = json_take(&g->j, ',');
        if (!more && !json_take(&g->j, ']'))
            return bad(g);
    }
    if (n < 2)
        return leave_out(g, &at, "a position needs x and y");
    if (n > 2 && !read_finite(word[2], &z))
        z = (double)NAN;
    if (g->survey) { /* a number that is too large is a height, too, though a missing one */
        g->notes->heights |= n > 2 && proto_is_number(word[2].text, word[2].len);
        g->notes->more += n > 3;
        return true;
    }
    if (g->notes->heights) {
        g->row[0] = z;
        if (n > 2 && isnan(z))
            table_fields_note_odd(g->fields, 0, g->j.line, word[2].text, word[2].len);
    }
    return add_point(g, &at, word);
}

static bool read_positions(struct geojson *g)
{
    if (!json_take(&g->j, '['))
        return bad(g);
    if (json_take(&g->j, ']'))
        return true;
    do {
        if (!read_position(g))
            return false;
    } while (json_take(&g->j, ','));
    return json_take(&g->j, ']') || bad(g);
}

/* ---- lines and polygons ---- */

/* The kind and number that our own files have as properties. */
static bool read_name(const struct geojson *g, bool *border, uint32_t *number)
{
    if (g->kind.text == NULL || g->number.text == NULL)
        return false;
    *border = json_is(g->kind, "\"border\"");
    return (*border || json_is(g->kind, "\"line\"")) &&
           proto_read_u32(g->number.text, g->number.len, number) && *number <= PATHS_MOST_NUMBER;
}

/* The positions of a line, or of a ring. */
static bool read_path(struct geojson *g, bool ring, bool border, uint32_t number)
{
    json_peek(&g->j);
    g->f->line = g->j.line;
    if (g->survey)
        return read_positions(g);
    if (!points_file_begin_path(g->f, border, number, g->feature))
        return false;
    g->in_path = true;
    bool ok = read_positions(g);
    g->in_path = false;
    if (ok)
        points_file_end_path(g->f, ring);
    return ok;
}

/* Arrays within arrays, `depth` of them, down to the positions. All rings of a polygon, whose depth is 2, have the same number. */
static bool read_paths(struct geojson *g, bool polygon, int depth, bool border, uint32_t number)
{
    bool named = false, own;
    uint32_t given = number;
    struct json_scan at = g->j;
    struct json_part rest;
    if (json_peek(&g->j) != '[')
        return json_take_value(&g->j, &rest) ? leave_out(g, &at, "the coordinates are not an array")
                                             : bad(g);
    if (depth == (polygon ? 2 : 1) && !g->survey) {
        named = read_name(g, &own, &given);
        border = polygon || (named && own);
        if (!named && !points_file_number(g->f, &given))
            return false;
    }
    if (depth == 1)
        return read_path(g, polygon, border, given);
    json_take(&g->j, '[');
    if (json_take(&g->j, ']'))
        return true;
    do {
        if (!read_paths(g, polygon, depth - 1, border, given))
            return false;
    } while (json_take(&g->j, ','));
    return json_take(&g->j, ']') || bad(g);
}

/* null and [] are no place. */
static bool is_nowhere(struct json_scan at)
{
    return json_peek(&at) == 'n' || (json_take(&at, '[') && json_take(&at, ']'));
}

/* depth: of the arrays around positions. */
static bool read_coordinates(struct geojson *g, const struct json_scan *at, bool lines,
                             bool polygon, int depth)
{
    g->j = *at;
    if (at->p == NULL || is_nowhere(*at)) {
        g->notes->nowhere += g->survey;
        return true;
    }
    if (lines)
        return read_paths(g, polygon, depth, polygon, 0);
    if (depth == 0)
        return read_position(g);
    return json_peek(&g->j) == '[' ? read_positions(g)
                                   : leave_out(g, at, "the coordinates are not an array");
}

/* ---- properties ---- */

/* Features mostly have the same properties in the same order, so the place of the last one's successor is tried first. */
static struct property *find_property(struct geojson *g, struct json_part name, size_t *next)
{
    size_t i = *next;
    if (i >= g->properties || g->property[i].name.len != name.len ||
        memcmp(g->property[i].name.text, name.text, name.len) != 0)
        for (i = 0; i < g->properties; i++)
            if (g->property[i].name.len == name.len &&
                memcmp(g->property[i].name.text, name.text, name.len) == 0)
                break;
    if (i == MOST_PROPERTIES)
        return NULL;
    if (i == g->properties)
        g->property[g->properties++] = (struct property){.name = name, .field = NO_FIELD};
    *next = i + 1;
    return &g->property[i];
}

static void take_property(struct geojson *g, struct property *p, struct json_part value)
{
    double v;
    bool number = read_finite(value, &v);
    if (json_is(p->name, "kind"))
        g->kind = value;
    else if (json_is(p->name, "number"))
        g->number = value;
    if (g->survey) {
        p->numbers += number;
        p->others += !number && !json_is(value, "null");
    } else if (p->field != NO_FIELD) {
        g->row[p->field] = number ? v : (double)NAN;
        size_t quote = value.text[0] == '"';
        if (!number)
            table_fields_note_odd(g->fields, (size_t)p->field, g->j.line, value.text + quote,
                                  value.len - 2 * quote);
    }
}

static bool read_properties(struct geojson *g, const struct json_scan *at)
{
    struct json_part name, value;
    size_t next = 0;
    if (at->p == NULL)
        return true;
    g->j = *at;
    if (!json_take(&g->j, '{') || json_take(&g->j, '}'))
        return true;
    do {
        if (!json_take_string(&g->j, &name) || !json_take(&g->j, ':') ||
            !json_take_value(&g->j, &value))
            return bad(g);
        struct property *p = find_property(g, name, &next);
        if (p != NULL)
            take_property(g, p, value);
    } while (json_take(&g->j, ','));
    return true;
}

/* ---- objects ---- */

enum member { TYPE, COORDINATES, GEOMETRY, GEOMETRIES, FEATURES, PROPERTIES, MEMBERS };

struct object {
    struct json_scan at[MEMBERS]; /* where the value of a member begins; p is NULL without it */
    struct json_part type;
    bool geometry; /* only a geometry may be here */
    bool done;     /* the features of a collection have been read */
};

static bool read_object(struct geojson *g, bool geometry);

static bool note_member(struct geojson *g, struct object *o, struct json_part key)
{
    static const struct json_part name[MEMBERS] = {
        [TYPE] = {"type", 4},         [COORDINATES] = {"coordinates", 11},
        [GEOMETRY] = {"geometry", 8}, [GEOMETRIES] = {"geometries", 10},
        [FEATURES] = {"features", 8}, [PROPERTIES] = {"properties", 10},
    };
    for (size_t i = 0; i < MEMBERS; i++) {
        if (key.len != name[i].len || memcmp(key.text, name[i].text, key.len) != 0)
            continue;
        if (o->at[i].p != NULL) {
            g->f->line = g->j.line;
            return points_file_stop(g->f, "an object has the member %s twice", name[i].text);
        }
        o->at[i] = g->j;
    }
    return true;
}

/* An array of objects. */
static bool read_objects(struct geojson *g, const struct json_scan *at, bool geometry)
{
    if (at->p == NULL)
        return true;
    g->j = *at;
    if (!json_take(&g->j, '['))
        return bad(g);
    if (json_take(&g->j, ']')) {
        g->notes->nowhere += geometry && g->survey;
        return true;
    }
    do {
        if (!read_object(g, geometry))
            return false;
    } while (json_take(&g->j, ','));
    return json_take(&g->j, ']') || bad(g);
}

/* Whether the value of a member crs [GeoJSON, 2008, section 3] names longitudes and latitudes, or nothing. */
static bool is_degrees(struct json_part value)
{
    static const char *const names[] = {":CRS84\"", ":CRS83\"", ":CRS27\"", ":4326\"",
                                        ":4258\"",  ":4269\"",  ":4979\""};
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++)
        if (memmem(value.text, value.len, names[i], strlen(names[i])) != NULL)
            return true;
    return json_is(value, "null");
}

/* Reads the features of a collection at once where its type comes first, as it does in most files. */
static bool pass_value(struct geojson *g, struct object *o, struct json_part key)
{
    struct json_part value;
    if (!o->geometry && json_is(key, "features") && json_is(o->type, "FeatureCollection")) {
        o->done = true;
        return read_objects(g, &o->at[FEATURES], false);
    }
    if (!json_take_value(&g->j, &value))
        return bad(g);
    if (json_is(key, "crs") && !o->geometry)
        g->notes->projected |= !is_degrees(value);
    if (json_is(key, "type") && value.len >= 2 && value.text[0] == '"')
        o->type = (struct json_part){value.text + 1, value.len - 2};
    return true;
}

/* Bookmarks the members of the object that begins here. */
static bool find_members(struct geojson *g, struct object *o)
{
    struct json_part key;
    if (!json_take(&g->j, '{'))
        return bad(g);
    if (json_take(&g->j, '}'))
        return true;
    do {
        if (!json_take_string(&g->j, &key) || !json_take(&g->j, ':'))
            return bad(g);
        json_peek(&g->j);
        if (!note_member(g, o, key) || !pass_value(g, o, key))
            return false;
    } while (json_take(&g->j, ','));
    return json_take(&g->j, '}') || bad(g);
}

static bool read_feature(struct geojson *g, const struct object *o)
{
    for (size_t i = 0; i < FIELDS_MOST; i++)
        g->row[i] = (double)NAN;
    g->feature++;
    g->kind = g->number = (struct json_part){NULL, 0};
    if (!read_properties(g, &o->at[PROPERTIES]))
        return false;
    g->named |= read_name(g, &(bool){false}, &(uint32_t){0});
    if (o->at[GEOMETRY].p == NULL || *o->at[GEOMETRY].p == 'n') {
        g->notes->nowhere += g->survey;
        return true;
    }
    g->j = o->at[GEOMETRY];
    return read_object(g, true);
}

/* Files of some programs lack types of features and collections, but never those of geometries. */
static bool is_a(const struct object *o, const char *type, enum member member)
{
    return o->type.len > 0 ? json_is(o->type, type) : o->at[member].p != NULL;
}

/* Reads what the members say, wherever that leaves g->j. */
static bool read_members(struct geojson *g, const struct json_scan *at, const struct object *o)
{
    static const struct {
        const char *type;
        bool lines, polygon;
        int depth;
    } geometries[] = {{"Point", false, false, 0},          {"MultiPoint", false, false, 1},
                      {"LineString", true, false, 1},      {"Polygon", true, true, 2},
                      {"MultiLineString", true, false, 2}, {"MultiPolygon", true, true, 3}};
    for (size_t i = 0; i < sizeof geometries / sizeof geometries[0]; i++)
        if (json_is(o->type, geometries[i].type))
            return read_coordinates(g, &o->at[COORDINATES], geometries[i].lines,
                                    geometries[i].polygon, geometries[i].depth);
    if (is_a(o, "GeometryCollection", GEOMETRIES))
        return read_objects(g, &o->at[GEOMETRIES], true);
    if (!o->geometry && is_a(o, "FeatureCollection", FEATURES))
        return o->done || read_objects(g, &o->at[FEATURES], false);
    if (!o->geometry && is_a(o, "Feature", GEOMETRY))
        return read_feature(g, o);
    return leave_out(g, at,
                     o->type.len == 0 ? "an object without a type that GeoJSON has"
                     : o->geometry    ? "a geometry of a type that GeoJSON does not have"
                                      : "an object of a type that GeoJSON does not have");
}

/* A feature, a collection or a geometry, and passes it; geometry: nothing else may be here. */
static bool read_object(struct geojson *g, bool geometry)
{
    struct object o = {.type = {"", 0}, .geometry = geometry};
    struct json_part value;
    json_peek(&g->j);
    struct json_scan at = g->j;
    if (json_peek(&g->j) != '{')
        return json_take_value(&g->j, &value)
                   ? leave_out(g, &at, "a value where GeoJSON has an object")
                   : bad(g);
    if (g->j.depth == JSON_DEPTH)
        return bad(g);
    g->j.depth++;
    if (!find_members(g, &o))
        return false;
    struct json_scan end = g->j;
    bool ok = read_members(g, &at, &o);
    end.depth--;
    g->j = end;
    return ok;
}

/* ---- the text ---- */

/* All values. */
static bool read_text(struct geojson *g, const char *text, size_t n)
{
    g->feature = 0;
    g->kind = g->number = (struct json_part){NULL, 0};
    g->j = (struct json_scan){.p = text + text_mark_length(text, n), .end = text + n, .line = 1};
    for (json_peek(&g->j); g->j.p < g->j.end; json_peek(&g->j)) {
        json_take(&g->j, 0x1E); /* RFC 8142 puts one before each value */
        for (size_t i = 0; i < FIELDS_MOST; i++)
            g->row[i] = (double)NAN;
        if (json_peek(&g->j) == '['
                ? !read_objects(g, &(struct json_scan){g->j.p, g->j.end, g->j.line, 0}, false)
                : !read_object(g, false))
            return false;
    }
    return true;
}

static bool is_height(const struct property *p)
{
    return p->numbers > p->others && heading_is_height(p->name.text, p->name.len);
}

/* After the survey: chooses the fields, and lists the properties that are not used. */
static void choose_fields(struct geojson *g)
{
    struct table_fields *t = g->fields;
    size_t at = 0;
    bool height = g->notes->heights;
    if (height)
        table_fields_add(t, 0, "z", 1);
    for (size_t i = 0; i < g->properties; i++) {
        struct property *p = &g->property[i];
        bool is_z = !height && is_height(p), taken = false;
        if (is_z)
            taken = table_fields_add_height(t, t->n, p->name.text, p->name.len);
        else if (t->all && p->numbers > p->others)
            taken = table_fields_add(t, t->n, p->name.text, p->name.len);
        if (taken && is_z)
            snprintf(g->notes->property, sizeof g->notes->property, "%s", t->height);
        height |= is_z;
        if (taken)
            p->field = (int)t->n - 1;
        else if (g->named && (json_is(p->name, "kind") || json_is(p->name, "number")))
            continue;
        else if (at + 80 < sizeof g->notes->unused)
            at += (size_t)snprintf(g->notes->unused + at, sizeof g->notes->unused - at, "%s%.*s",
                                   at > 0 ? ", " : "", (int)(p->name.len < 40 ? p->name.len : 40),
                                   p->name.text);
        else if (g->notes->unused[at - 1] != '.')
            at += (size_t)snprintf(g->notes->unused + at, sizeof g->notes->unused - at, ", ...");
    }
    g->f->fields = t->n;
}

bool geojson_text_read(struct points_file *f, const char *text, size_t n, struct table_fields *t,
                       struct geojson_notes *notes)
{
    struct geojson *g = calloc(1, sizeof *g);
    *notes = (struct geojson_notes){.heights = false};
    if (g == NULL)
        return points_file_stop(f, "out of memory");
    g->f = f;
    g->fields = t;
    g->notes = notes;
    g->survey = true;
    bool ok = read_text(g, text, n);
    g->survey = false;
    choose_fields(g);
    ok = ok && read_text(g, text, n);
    f->row = NULL;
    free(g);
    return ok;
}
