/* points_file.c - see points_file.h. */
#include "clients/points/points_file.h"

#include <errno.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "clients/lib/array.h"
#include "clients/reading/row.h"
#include "proto/number.h"

enum { READ_AT_LEAST = 1 << 15 };

bool points_file_fault(struct points_file *f, const char *what)
{
    f->fault = what;
    return false;
}

__attribute__((format(printf, 2, 0))) static void describe(struct points_file *f,
                                                           const char *format, va_list values)
{
    vsnprintf(f->text, sizeof f->text, format, values);
    f->fault = f->text;
}

bool points_file_bad(struct points_file *f, const char *format, ...)
{
    va_list values;
    va_start(values, format);
    describe(f, format, values);
    va_end(values);
    return false;
}

bool points_file_stop(struct points_file *f, const char *format, ...)
{
    va_list values;
    va_start(values, format);
    describe(f, format, values);
    va_end(values);
    f->fatal = true;
    return false;
}

bool points_file_skip(struct points_file *f, const char *s, size_t len)
{
    if (!f->skip_bad || f->fatal)
        return false;
    if (f->skipped < SKIPPED_SHOWN) {
        f->skip[f->skipped].line = f->line;
        snprintf(f->skip[f->skipped].fault, sizeof f->skip[0].fault, "%.79s", f->fault);
        while (len > 0 && value_is_blank(s[len - 1]))
            len--;
        snprintf(f->skip[f->skipped].text, sizeof f->skip[0].text, "%.*s", len < 59 ? (int)len : 59,
                 s);
    }
    f->skipped++;
    return true;
}

static bool grow(struct points_file *f)
{
    size_t cap = f->cap == 0 ? 4096 : 2 * f->cap;
    double *xy = realloc(f->xy, cap * 2 * sizeof xy[0]);
    if (xy != NULL)
        f->xy = xy;
    double *value = f->fields > 0 ? realloc(f->value, cap * f->fields * sizeof value[0]) : NULL;
    if (value != NULL)
        f->value = value;
    if (xy == NULL || (value == NULL && f->fields > 0)) {
        f->line = 0;
        return points_file_stop(f, "out of memory");
    }
    f->cap = cap;
    return true;
}

bool points_file_append(struct points_file *f, double x, double y)
{
    if (!proto_is_coordinate(x) || !proto_is_coordinate(y)) /* the server would refuse it */
        return points_file_fault(f, "a coordinate must be 0 or from 2^-142 to 2^201 in magnitude");
    if (f->n == f->cap && !grow(f))
        return false;
    f->xy[2 * f->n] = x;
    f->xy[2 * f->n + 1] = y;
    for (size_t i = 0; i < f->fields; i++)
        f->value[f->fields * f->n + i] = f->row != NULL ? f->row[i] : (double)NAN;
    f->n++;
    return true;
}

bool points_file_add(struct points_file *f, const char *x, size_t x_len, const char *y,
                     size_t y_len)
{
    double v[2];
    if (!proto_read_double(x, x_len, &v[0]) || !proto_read_double(y, y_len, &v[1]))
        return points_file_fault(f, "not a number");
    return points_file_append(f, v[0], v[1]);
}

bool points_file_begin_path(struct points_file *f, bool border, uint32_t number, uint64_t feature)
{
    return paths_begin(&f->paths, border, number, f->line, feature) ||
           points_file_stop(f, "out of memory");
}

bool points_file_corner(struct points_file *f)
{
    return paths_corner(&f->paths, f->n - 1) || points_file_stop(f, "out of memory");
}

void points_file_end_path(struct points_file *f, bool polygon)
{
    struct paths *p = &f->paths;
    struct path *path = &p->path[p->n - 1];
    path->n = p->corners - path->first;
    path->closed = polygon;
    const double *from = path->n > 2 ? f->xy + 2 * (size_t)p->corner[path->first] : NULL;
    const double *to = path->n > 2 ? f->xy + 2 * (size_t)p->corner[p->corners - 1] : NULL;
    if (path->n > 2 && from[0] == to[0] && from[1] == to[1]) {
        path->closed = true;
        path->n--;
        p->corners--;
        f->n -= !p->given;
    } else {
        p->open_rings += polygon && path->n > 0;
    }
    if (path->n == 0)
        p->n--;
}

bool points_file_number(struct points_file *f, uint32_t *number)
{
    return paths_number(&f->paths, number) ||
           points_file_stop(f, "the number of a line or polygon is at most %d", PATHS_MOST_NUMBER);
}

bool points_file_read_all(struct points_file *f, int fd, char **text, size_t *n)
{
    size_t cap = 0;
    ssize_t got = 1;
    *n = 0;
    while (got != 0) {
        if (!array_reserve((void **)text, &cap, *n + READ_AT_LEAST, 1))
            return points_file_stop(f, "out of memory");
        got = read(fd, *text + *n, cap - *n);
        if (got < 0 && errno != EINTR)
            return points_file_stop(f, "%s", strerror(errno));
        if (got > 0)
            *n += (size_t)got;
    }
    return true;
}

void points_file_free(struct points_file *f)
{
    free(f->xy);
    free(f->value);
    paths_free(&f->paths);
    *f = (struct points_file){0};
}
