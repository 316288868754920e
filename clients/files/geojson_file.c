/* geojson_file.c - the points of a GeoJSON file [RFC 7946]: one value, or several after one another
 * (newline-delimited features). The parser is a recursive descent; it remembers the place of a geometry's
 * coordinates and reads them once the type is known, since keys may be in any order. */
#include "clients/files/points_file.h"

#include "proto/number.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { DEPTH_LIMIT = 64 };

struct json {
    struct points_file *f;
    const char *p, *end;
    int depth;
};

static bool bad(struct json *j)
{
    return points_file_stop(j->f, "not GeoJSON");
}

/* The next non-blank character, 0 at the end. */
static char peek(struct json *j)
{
    for (; j->p < j->end; j->p++) {
        if (*j->p == '\n')
            j->f->line++;
        else if (*j->p != ' ' && *j->p != '\t' && *j->p != '\r')
            return *j->p;
    }
    return 0;
}

static bool take(struct json *j, char c)
{
    if (peek(j) != c)
        return false;
    j->p++;
    return true;
}

/* A string, as it is written. */
static bool read_string(struct json *j, const char **text, size_t *len)
{
    if (!take(j, '"'))
        return bad(j);
    *text = j->p;
    for (; j->p < j->end && *j->p != '"'; j->p++)
        if (*j->p == '\\')
            j->p++;
    if (j->p >= j->end)
        return bad(j);
    *len = (size_t)(j->p - *text);
    j->p++;
    return true;
}

static bool is_text(const char *text, size_t len, const char *want)
{
    return len == strlen(want) && memcmp(text, want, len) == 0;
}

/* A number, true, false or null. */
static bool read_word(struct json *j, const char **text, size_t *len)
{
    peek(j);
    *text = j->p;
    while (j->p < j->end && strchr("+-.0123456789eEtrufalsn", *j->p) != NULL)
        j->p++;
    *len = (size_t)(j->p - *text);
    return *len > 0 || bad(j);
}

/* ---- coordinates ---- */

/* `x, y, ...]`, the bracket before it read. */
static bool read_position(struct json *j)
{
    const char *x, *y, *more;
    size_t x_len, y_len, more_len;
    double z = (double)NAN;
    if (!read_word(j, &x, &x_len) || !take(j, ','))
        return bad(j);
    if (!read_word(j, &y, &y_len))
        return false;
    for (bool third = true; take(j, ','); third = false) {
        if (!read_word(j, &more, &more_len))
            return false;
        if (third && (!proto_read_double(more, more_len, &z) || !isfinite(z)))
            z = (double)NAN;
    }
    if (!take(j, ']'))
        return bad(j);
    j->f->row = &z;
    return points_file_add(j->f, x, x_len, y, y_len) ||
           points_file_skip(j->f, x, (size_t)(j->p - x) - 1);
}

static bool read_coordinates(struct json *j, bool many)
{
    if (!take(j, '['))
        return bad(j);
    if (!many)
        return read_position(j);
    if (take(j, ']'))
        return true;
    do {
        if (!take(j, '['))
            return bad(j);
        if (!read_position(j))
            return false;
    } while (take(j, ','));
    return take(j, ']') || bad(j);
}

/* ---- values ---- */

static bool read_value(struct json *j);

static bool read_array(struct json *j)
{
    if (take(j, ']'))
        return true;
    do {
        if (!read_value(j))
            return false;
    } while (take(j, ','));
    return take(j, ']') || bad(j);
}

/* A geometry whose end has been reached: goes back for its coordinates. */
static bool read_geometry(struct json *j, const char *type, size_t len, const struct json *at)
{
    static const char *const others[] = {"LineString", "MultiLineString", "Polygon",
                                         "MultiPolygon"};
    bool many = is_text(type, len, "MultiPoint");
    for (size_t i = 0; i < sizeof others / sizeof others[0]; i++)
        if (is_text(type, len, others[i])) {
            points_file_fault(j->f, "a geometry that is neither Point nor MultiPoint");
            return points_file_skip(j->f, type, len);
        }
    if (!many && !is_text(type, len, "Point"))
        return true;
    struct json back = *at;
    uint64_t line = j->f->line;
    bool ok = read_coordinates(&back, many);
    if (ok)
        j->f->line = line;
    return ok;
}

static bool read_object(struct json *j)
{
    const char *key, *type = "";
    size_t key_len, type_len = 0;
    struct json coordinates = {.p = NULL};
    if (take(j, '}'))
        return true;
    do {
        if (!read_string(j, &key, &key_len))
            return false;
        if (!take(j, ':'))
            return bad(j);
        if (is_text(key, key_len, "type") && peek(j) == '"') {
            if (!read_string(j, &type, &type_len))
                return false;
            continue;
        }
        if (is_text(key, key_len, "coordinates"))
            coordinates = *j;
        if (!read_value(j))
            return false;
    } while (take(j, ','));
    if (!take(j, '}'))
        return bad(j);
    return coordinates.p == NULL || read_geometry(j, type, type_len, &coordinates);
}

static bool read_value(struct json *j)
{
    const char *text;
    size_t len;
    char c = peek(j);
    if (c == '"')
        return read_string(j, &text, &len);
    if (c != '{' && c != '[')
        return read_word(j, &text, &len);
    if (++j->depth > DEPTH_LIMIT)
        return bad(j);
    j->p++;
    bool ok = c == '{' ? read_object(j) : read_array(j);
    j->depth--;
    return ok;
}

/* ---- the file ---- */

static bool read_all(struct points_file *f, int fd, char **text, size_t *n)
{
    size_t cap = 0;
    ssize_t got = 1;
    *n = 0;
    while (got != 0) {
        if (*n == cap) {
            cap = cap == 0 ? 1 << 16 : 2 * cap;
            char *more = realloc(*text, cap);
            if (more == NULL)
                return points_file_stop(f, "out of memory");
            *text = more;
        }
        got = read(fd, *text + *n, cap - *n);
        if (got < 0 && errno != EINTR)
            return points_file_stop(f, "%s", strerror(errno));
        if (got > 0)
            *n += (size_t)got;
    }
    return true;
}

bool points_file_read_geojson(struct points_file *f, int fd)
{
    char *text = NULL;
    size_t n;
    bool ok = read_all(f, fd, &text, &n);
    f->fields = 1; /* the third coordinates */
    if (ok) {
        struct json j = {.f = f, .p = text, .end = text + n};
        f->line = 1;
        if (n >= 3 && memcmp(text, "\xEF\xBB\xBF", 3) == 0)
            j.p += 3; /* the byte order mark of UTF-8 */
        while (ok && peek(&j) != 0) {
            take(&j, 0x1E); /* RFC 8142 puts one before each value */
            ok = read_value(&j);
        }
    }
    free(text);
    f->row = NULL;
    for (size_t i = 0; i < f->n; i++)
        if (!isnan(f->value[i]))
            return ok;
    f->fields = 0;
    return ok;
}
