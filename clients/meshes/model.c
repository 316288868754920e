/* model.c - see model.h. */
#include "clients/meshes/model.h"

#include "clients/lib/bytes.h"
#include "clients/lib/words.h"
#include "proto/number.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_TRIES = 10 };
#define MOST_ROWS ((size_t)1 << 30) /* triangles that the server looks at for regions */

/* ---- replies ---- */

static bool fault(struct model *m, const char *what)
{
    m->fault = what;
    return false;
}

/* Receives a binary reply whose rows have `size` bytes. The caller frees *bytes if DELAUNAY_OK is returned. */
static enum delaunay_result receive_rows(struct delaunay_client *c, struct model *m, size_t size,
                                         char **bytes, size_t *rows)
{
    void *got;
    size_t n;
    enum delaunay_result r = delaunay_receive_bytes(c, &got, &n);
    if (r != DELAUNAY_OK)
        return r;
    if (got == NULL || n % size != 0) {
        fault(m, got == NULL ? "the server sends no binary replies" : "a row of another size");
        free(got);
        return DELAUNAY_STOPPED;
    }
    *bytes = got;
    *rows = n / size;
    return DELAUNAY_OK;
}

/* Rows of POINTS: id, x, y and a value of each field. */
static bool take_points(struct model *m, const char *bytes)
{
    size_t width = 20 + 8 * m->fields;
    m->id = malloc((m->n + 1) * sizeof m->id[0]);
    m->xy = malloc((m->n + 1) * 2 * sizeof m->xy[0]);
    m->value = malloc((m->n * m->fields + 1) * sizeof m->value[0]);
    if (m->id == NULL || m->xy == NULL || m->value == NULL)
        return false;
    for (size_t i = 0; i < m->n; i++) {
        const char *row = bytes + width * i;
        m->id[i] = bytes_u32(row);
        m->xy[2 * i] = bytes_double(row + 4);
        m->xy[2 * i + 1] = bytes_double(row + 12);
        for (size_t k = 0; k < m->fields; k++)
            m->value[m->fields * i + k] = bytes_double(row + 20 + 8 * k);
    }
    return true;
}

int model_field(const struct model *m, const char *name)
{
    for (size_t i = 0; i < m->fields; i++)
        if (strcmp(m->field[i], name) == 0)
            return (int)i;
    return -1;
}

/* A row `name count least most` of FIELDS. */
static bool take_field(void *ctx, const struct delaunay_part *part)
{
    struct model *m = ctx;
    if (part->kind == DELAUNAY_PART_OK && delaunay_rows(part) > 0) {
        m->field = malloc(MODEL_MOST_FIELDS * sizeof m->field[0]);
        return m->field != NULL || fault(m, "out of memory");
    }
    if (part->kind != DELAUNAY_PART_ROW)
        return true;
    const char *space = memchr(part->text, ' ', part->len);
    size_t len = space != NULL ? (size_t)(space - part->text) : part->len;
    if (len == 0 || len >= MODEL_NAME || m->fields == MODEL_MOST_FIELDS)
        return fault(m, "a row is not a field");
    memcpy(m->field[m->fields], part->text, len);
    m->field[m->fields++][len] = '\0';
    return true;
}

/* Ids are mostly 0 .. n - 1, so that place is tried first. */
bool model_find(const struct model *m, uint32_t id, uint32_t *place)
{
    size_t lo = 0, hi = m->n;
    if (id < m->n && m->id[id] == id) {
        *place = id;
        return true;
    }
    while (lo < hi) {
        size_t mid = lo + (hi - lo) / 2;
        if (m->id[mid] < id)
            lo = mid + 1;
        else
            hi = mid;
    }
    *place = (uint32_t)lo;
    return lo < m->n && m->id[lo] == id;
}

static bool take_hull_point(void *ctx, const struct delaunay_part *part)
{
    struct model *m = ctx;
    uint32_t id;
    if (part->kind == DELAUNAY_PART_OK) {
        m->hull = malloc((size_t)(delaunay_rows(part) + 1) * sizeof m->hull[0]);
        return m->hull != NULL || fault(m, "out of memory");
    }
    if (part->kind != DELAUNAY_PART_ROW)
        return true;
    const char *space = memchr(part->text, ' ', part->len);
    if (space == NULL || !proto_read_u32(part->text, (size_t)(space - part->text), &id))
        return fault(m, "a row is not a point");
    if (!model_find(m, id, &m->hull[m->hull_n++]))
        m->torn = true;
    return true;
}

/* The version in STAT's reply; 0 from a server that has none. */
static bool take_version(void *ctx, const struct delaunay_part *part)
{
    if (part->kind == DELAUNAY_PART_OK)
        delaunay_key_number(part, "version", ctx);
    return true;
}

enum delaunay_result model_fetch_version(struct delaunay_client *c, const char *set,
                                         uint64_t *version)
{
    char line[120];
    *version = 0;
    snprintf(line, sizeof line, "STAT %.100s", set);
    return delaunay_request(c, line, take_version, version);
}

/* ---- regions ---- */

struct closed {
    uint32_t number;
    double area;
};

struct borders {
    struct closed *closed; /* owns n */
    size_t n, cap;
    bool failed;
};

/* A row `number closed triangles area` of REGIONS. */
static bool take_border(void *ctx, const struct delaunay_part *part)
{
    struct borders *b = ctx;
    char row[120];
    unsigned number;
    double area;
    if (part->kind == DELAUNAY_PART_OK) {
        b->cap = (size_t)delaunay_rows(part);
        b->closed = malloc((b->cap + 1) * sizeof b->closed[0]);
        b->failed = b->closed == NULL;
        return !b->failed;
    }
    if (part->kind != DELAUNAY_PART_ROW)
        return true;
    snprintf(row, sizeof row, "%.*s", (int)part->len, part->text);
    if (b->n < b->cap && sscanf(row, "%u closed %*u %lf", &number, &area) == 2)
        b->closed[b->n++] = (struct closed){number, area};
    return true;
}

/* The largest first, so that a smaller one within it is seen. */
static int compare_closed(const void *a, const void *b)
{
    const struct closed *r = a, *s = b;
    if (r->area != s->area)
        return r->area > s->area ? -1 : 1;
    return r->number < s->number ? -1 : r->number > s->number;
}

/* Gives the number to these triangles, which come in the order of the model's. */
static void paint(struct model *m, const char *rows, size_t n, uint32_t number)
{
    size_t t = 0;
    for (size_t i = 0; i < n && !m->torn; i++) {
        uint32_t v[3];
        for (size_t k = 0; k < 3; k++)
            m->torn |= !model_find(m, bytes_u32(rows + 12 * i + 4 * k), &v[k]);
        while (!m->torn && t < m->triangles && memcmp(m->triangle + 3 * t, v, sizeof v) != 0)
            t++;
        m->torn |= t == m->triangles;
        if (!m->torn)
            m->region[t++] = number;
    }
}

static enum delaunay_result paint_region(struct delaunay_client *c, const char *set,
                                         const char *which, uint32_t number, struct model *m)
{
    char line[160];
    void *bytes;
    size_t n;
    int len = snprintf(line, sizeof line, "TRIANGLES %.100s INSIDE%s BINARY", set, which);
    enum delaunay_result r = delaunay_send(c, line, (size_t)len);
    if (r == DELAUNAY_OK)
        r = delaunay_receive_bytes(c, &bytes, &n);
    if (r == DELAUNAY_REFUSED) /* the borders have changed since */
        m->torn = true;
    if (r != DELAUNAY_OK)
        return r == DELAUNAY_REFUSED ? DELAUNAY_OK : r;
    paint(m, bytes, n / 12, number);
    free(bytes);
    return DELAUNAY_OK;
}

/* The triangles have been fetched; the set must still have the version `before` at the end. */
static enum delaunay_result fetch_regions(struct delaunay_client *c, const char *set,
                                          uint64_t before, struct model *m)
{
    struct borders b = {.n = 0};
    char line[120];
    uint64_t after = 0;
    snprintf(line, sizeof line, "REGIONS %.100s", set);
    enum delaunay_result r = delaunay_request(c, line, take_border, &b);
    m->regions = r == DELAUNAY_OK;
    m->one_region = b.n > 1 && b.n > MOST_ROWS / (m->triangles + 1);
    m->region = malloc((m->triangles + 1) * sizeof m->region[0]);
    if (b.failed || m->region == NULL)
        r = DELAUNAY_NOMEM;
    for (size_t t = 0; m->region != NULL && t < m->triangles; t++)
        m->region[t] = MODEL_OUTSIDE;
    if (r == DELAUNAY_OK && b.n > 0)
        qsort(b.closed, b.n, sizeof b.closed[0], compare_closed);
    if (r == DELAUNAY_OK && m->one_region)
        r = paint_region(c, set, "", 0, m);
    for (size_t i = 0; r == DELAUNAY_OK && !m->one_region && i < b.n; i++) {
        char which[16];
        snprintf(which, sizeof which, " %u", (unsigned)b.closed[i].number);
        r = paint_region(c, set, which, b.closed[i].number, m);
    }
    free(b.closed);
    if (r == DELAUNAY_REFUSED) /* no borders, or a server that knows none */
        return DELAUNAY_OK;
    if (r == DELAUNAY_OK)
        r = model_fetch_version(c, set, &after);
    m->torn |= before != after;
    return r;
}

/* ---- requests ---- */

static enum delaunay_result send_table(struct delaunay_client *c, const char *command,
                                       const char *set, const char *form)
{
    char line[MODEL_MOST_FIELDS * (MODEL_NAME + 1) + 200];
    int n = snprintf(line, sizeof line, "%s %.100s%s", command, set, form);
    return delaunay_send(c, line, (size_t)n);
}

/* A server that knows no fields has none. */
static enum delaunay_result fetch_fields(struct delaunay_client *c, const char *set,
                                         struct model *m)
{
    enum delaunay_result r = send_table(c, "FIELDS", set, "");
    if (r == DELAUNAY_OK)
        r = delaunay_receive(c, take_field, m);
    return r == DELAUNAY_REFUSED ? DELAUNAY_OK : r;
}

/* Points and their values in one request, so they are of one state of the set. */
static enum delaunay_result send_points(struct delaunay_client *c, const char *set,
                                        const struct model *m)
{
    char form[MODEL_MOST_FIELDS * (MODEL_NAME + 1) + 20];
    size_t n = 0;
    for (size_t k = 0; k < m->fields; k++)
        n += (size_t)snprintf(form + n, sizeof form - n, "%s%s", k == 0 ? " FIELDS " : ",",
                              m->field[k]);
    snprintf(form + n, sizeof form - n, " BINARY");
    return send_table(c, "POINTS", set, form);
}

static enum delaunay_result receive_points(struct delaunay_client *c, struct model *m)
{
    char *bytes;
    enum delaunay_result r = receive_rows(c, m, 20 + 8 * m->fields, &bytes, &m->n);
    if (r != DELAUNAY_OK)
        return r;
    bool ok = take_points(m, bytes);
    free(bytes);
    return ok ? DELAUNAY_OK : DELAUNAY_NOMEM;
}

/* Rows of `width` words, of which the first `ids` are ids and become places. */
static enum delaunay_result receive_words(struct delaunay_client *c, struct model *m, size_t width,
                                          size_t ids, uint32_t **v, size_t *n)
{
    char *bytes;
    enum delaunay_result r = receive_rows(c, m, 4 * width, &bytes, n);
    if (r != DELAUNAY_OK)
        return r;
    *v = malloc((*n * width + 1) * sizeof **v);
    for (size_t i = 0; *v != NULL && i < *n * width; i++) {
        (*v)[i] = bytes_u32(bytes + 4 * i);
        if (i % width < ids && !model_find(m, (*v)[i], &(*v)[i]))
            m->torn = true;
    }
    free(bytes);
    return *v != NULL ? DELAUNAY_OK : DELAUNAY_NOMEM;
}

/* A server that knows no constraints has none. */
static enum delaunay_result receive_constraints(struct delaunay_client *c, struct model *m)
{
    enum delaunay_result r = receive_words(c, m, 3, 2, &m->constraint, &m->constraints);
    return r == DELAUNAY_REFUSED ? DELAUNAY_OK : r;
}

/* Whether the version before and after must be the same: the parts have the ids of points. */
static bool is_compared(unsigned parts)
{
    return (parts & (MODEL_MESH | MODEL_CONSTRAINTS)) != 0;
}

static enum delaunay_result send_parts(struct delaunay_client *c, const char *set, unsigned parts,
                                       const struct model *m)
{
    char form[40];
    size_t n = words_put(form, 0, sizeof form, "INSIDE", words_inside(m->inside));
    words_put(form, n, sizeof form, "BINARY", "");
    enum delaunay_result r = is_compared(parts) ? send_table(c, "STAT", set, "") : DELAUNAY_OK;
    if (r == DELAUNAY_OK)
        r = send_points(c, set, m);
    if (r == DELAUNAY_OK && (parts & MODEL_TRIANGLES) != 0)
        r = send_table(c, "TRIANGLES", set, form);
    if (r == DELAUNAY_OK && (parts & MODEL_EDGES) != 0)
        r = send_table(c, "EDGES", set, form);
    if (r == DELAUNAY_OK && (parts & MODEL_HULL) != 0)
        r = send_table(c, "HULL", set, "");
    if (r == DELAUNAY_OK && (parts & MODEL_CONSTRAINTS) != 0)
        r = send_table(c, "CONSTRAINTS", set, " BINARY");
    if (r == DELAUNAY_OK && (parts & MODEL_FIXED) != 0)
        r = send_table(c, "EDGES", set, " CONSTRAINED BINARY");
    if (r == DELAUNAY_OK && is_compared(parts))
        r = send_table(c, "STAT", set, "");
    return r;
}

static enum delaunay_result receive_parts(struct delaunay_client *c, unsigned parts,
                                          struct model *m)
{
    uint64_t before = 0, after = 0;
    enum delaunay_result r =
        is_compared(parts) ? delaunay_receive(c, take_version, &before) : DELAUNAY_OK;
    if (r == DELAUNAY_OK)
        r = receive_points(c, m);
    if (r == DELAUNAY_OK && m->n == 0 && (parts & MODEL_MESH) != 0) {
        fault(m, "the set is empty");
        r = DELAUNAY_STOPPED;
    }
    if (r == DELAUNAY_OK && (parts & MODEL_TRIANGLES) != 0)
        r = receive_words(c, m, 3, 3, &m->triangle, &m->triangles);
    if (r == DELAUNAY_OK && (parts & MODEL_EDGES) != 0)
        r = receive_words(c, m, 2, 2, &m->edge, &m->edges);
    if (r == DELAUNAY_OK && (parts & MODEL_HULL) != 0)
        r = delaunay_receive(c, take_hull_point, m);
    if (r == DELAUNAY_OK && (parts & MODEL_CONSTRAINTS) != 0)
        r = receive_constraints(c, m);
    if (r == DELAUNAY_OK && (parts & MODEL_FIXED) != 0)
        r = receive_words(c, m, 2, 2, &m->fixed, &m->fixed_n);
    if (r == DELAUNAY_OK && is_compared(parts))
        r = delaunay_receive(c, take_version, &after);
    if (before != after)
        m->torn = true;
    m->version = after;
    return r;
}

enum delaunay_result model_fetch(struct delaunay_client *c, const char *set, unsigned parts,
                                 struct model *m)
{
    for (int i = 0; i < MOST_TRIES; i++) {
        model_free(m);
        enum delaunay_result r =
            (parts & MODEL_FIELDS) != 0 ? fetch_fields(c, set, m) : DELAUNAY_OK;
        m->z = model_field(m, "z");
        if (r == DELAUNAY_OK)
            r = send_parts(c, set, parts, m);
        if (r == DELAUNAY_OK)
            r = receive_parts(c, parts, m);
        if (r == DELAUNAY_OK && !m->torn && (parts & MODEL_REGIONS) != 0)
            r = fetch_regions(c, set, m->version, m);
        if (r != DELAUNAY_OK || !m->torn)
            return r;
    }
    fault(m, "the set is edited while it is read; try again");
    return DELAUNAY_STOPPED;
}

void model_free(struct model *m)
{
    free(m->id);
    free(m->xy);
    free(m->field);
    free(m->value);
    free(m->triangle);
    free(m->edge);
    free(m->hull);
    free(m->constraint);
    free(m->fixed);
    free(m->region);
    *m = (struct model){.inside = m->inside, .crs = m->crs};
}

/* ---- missing heights ---- */

enum { DROPPED = UINT32_MAX };

/* Keeps the rows of `width` words whose first `places` are places that have a new place each; returns the number of these rows. */
static size_t renumber(uint32_t *row, size_t n, size_t width, size_t places, const uint32_t *next)
{
    size_t kept = 0;
    for (size_t i = 0; i < n; i++) {
        bool whole = true;
        for (size_t k = 0; k < places; k++)
            whole &= next[row[width * i + k]] != DROPPED;
        for (size_t k = 0; whole && k < width; k++)
            row[width * kept + k] = k < places ? next[row[width * i + k]] : row[width * i + k];
        kept += whole;
    }
    return kept;
}

size_t model_drop_missing(struct model *m, bool *ok)
{
    uint32_t *next = malloc((m->n + 1) * sizeof next[0]);
    size_t n = 0, before = m->n;
    *ok = next != NULL;
    if (next == NULL)
        return 0;
    for (size_t i = 0; i < m->n; i++) {
        next[i] = DROPPED;
        if (isnan(model_value(m, m->z, i)))
            continue;
        m->id[n] = m->id[i];
        memmove(m->xy + 2 * n, m->xy + 2 * i, 2 * sizeof m->xy[0]);
        memmove(m->value + m->fields * n, m->value + m->fields * i, m->fields * sizeof m->value[0]);
        next[i] = (uint32_t)n++;
    }
    m->n = n;
    m->triangles = renumber(m->triangle, m->triangles, 3, 3, next);
    m->edges = renumber(m->edge, m->edges, 2, 2, next);
    m->hull_n = renumber(m->hull, m->hull_n, 1, 1, next);
    m->fixed_n = renumber(m->fixed, m->fixed_n, 2, 2, next);
    m->constraints = renumber(m->constraint, m->constraints, 3, 2, next);
    free(next);
    return before - n;
}

/* ---- sides: a hash table with linear probing, from a directed edge to its triangle ---- */

#define NO_KEY UINT64_MAX /* no edge joins a point with itself */

static size_t home(const struct sides *s, uint64_t key)
{
    return (size_t)((key * 0x9E3779B97F4A7C15u) >> 20) & (s->cap - 1);
}

static size_t slot(const struct sides *s, uint64_t key)
{
    size_t at = home(s, key);
    while (s->key[at] != NO_KEY && s->key[at] != key)
        at = (at + 1) & (s->cap - 1);
    return at;
}

bool sides_init(struct sides *s, const struct model *m)
{
    *s = (struct sides){.cap = 16};
    while (s->cap < 5 * m->triangles)
        s->cap *= 2;
    s->key = malloc(s->cap * sizeof s->key[0]);
    s->triangle = malloc(s->cap * sizeof s->triangle[0]);
    if (s->key == NULL || s->triangle == NULL) {
        sides_free(s);
        return false;
    }
    memset(s->key, 0xFF, s->cap * sizeof s->key[0]);
    for (size_t i = 0; i < 3 * m->triangles; i++) {
        uint32_t a = m->triangle[i], b = m->triangle[i % 3 == 2 ? i - 2 : i + 1];
        size_t at = slot(s, (uint64_t)a << 32 | b);
        s->key[at] = (uint64_t)a << 32 | b;
        s->triangle[at] = (uint32_t)(i / 3);
    }
    return true;
}

void sides_free(struct sides *s)
{
    free(s->key);
    free(s->triangle);
    *s = (struct sides){0};
}

int64_t sides_find(const struct sides *s, uint32_t a, uint32_t b)
{
    uint64_t key = (uint64_t)a << 32 | b;
    size_t at = slot(s, key);
    return s->key[at] == key ? (int64_t)s->triangle[at] : NO_TRIANGLE;
}
