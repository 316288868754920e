/* paths.c - see paths.h. */
#include "server/changes/paths.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "server/changes/constraint.h"

struct taking {
    struct change *c;
    const double *rows; /* borrows */
    size_t n, width;
    uint32_t first;
};

static bool begins(const double *row, size_t width)
{
    return row[width - 1] < 0;
}

size_t paths_count(const double *rows, size_t n, size_t width)
{
    size_t paths = 0;
    for (size_t i = 0; i < n; i++)
        paths += begins(rows + i * width, width);
    return paths;
}

/* The end of the path that begins at row i; *points: how many of its rows are points. */
static size_t path_end(const struct taking *t, size_t i, size_t *points)
{
    size_t end = i + 1;
    while (end < t->n && !begins(t->rows + end * t->width, t->width))
        end++;
    const double *a = t->rows + i * t->width, *b = t->rows + (end - 1) * t->width;
    bool ring = end - i > 1 && a[0] == b[0] && a[1] == b[1];
    *points = end - i - ring;
    return end;
}

static void add_point(const struct taking *t, size_t row)
{
    struct change *c = t->c;
    const double *v = t->rows + row * t->width;
    c->points[c->n] = (struct dt_point){v[0], v[1]};
    for (size_t k = 0; c->columns != NULL && k < c->columns->count; k++)
        c->columns->v[k * c->columns->n + c->n] = v[2 + k];
    c->n++;
}

/* Between two new points, of which the second one is on the line of the row. */
static void add_constraint(const struct taking *t, uint32_t a, uint32_t b, uint32_t what,
                           size_t row)
{
    struct pslg *d = t->c->pslg;
    uint32_t i = d->lists.n_added++;
    d->lists.added[i] = (struct record_constraint){t->first + a, t->first + b, what};
    d->line[i] = (uint64_t)fabs(t->rows[(row + 1) * t->width - 1]);
}

static void add_path(const struct taking *t, size_t row, size_t end, size_t points, uint32_t what)
{
    uint32_t a = t->c->n;
    for (size_t i = 0; i < points; i++) {
        add_point(t, row + i);
        if (i > 0)
            add_constraint(t, t->c->n - 2, t->c->n - 1, what, row + i);
    }
    if (points > 2 && row + points < end)
        add_constraint(t, t->c->n - 1, a, what, end - 1);
}

/* Room for these numbers of points, with their values, and of constraints. */
static bool make_room(struct change *c, size_t points, size_t constraints)
{
    struct pslg *d = c->pslg;
    c->points = dt_pages_grow(c->pages, NULL, 0, (points + 1) * sizeof *c->points);
    d->lists.added = dt_pages_grow(c->pages, NULL, 0, (constraints + 1) * sizeof *d->lists.added);
    d->line = malloc((constraints + 1) * sizeof *d->line);
    if (c->columns != NULL) {
        size_t values = points * c->columns->count;
        c->columns->n = (uint32_t)points;
        c->columns->v = dt_pages_grow(c->pages, NULL, 0, (values + 1) * sizeof(double));
    }
    return c->points != NULL && d->lists.added != NULL && d->line != NULL &&
           (c->columns == NULL || c->columns->v != NULL);
}

static size_t count_points(const struct taking *t)
{
    size_t points = 0;
    for (size_t i = 0, k; i < t->n; points += k)
        i = path_end(t, i, &k);
    return points;
}

bool paths_take(struct change *c, double *rows, size_t n, uint32_t first, uint32_t what)
{
    size_t values = c->columns == NULL ? 0 : c->columns->count;
    struct taking t = {.c = c, .rows = rows, .n = n, .width = 3 + values, .first = first};
    bool room = make_room(c, count_points(&t), n);
    c->n = 0;
    c->pslg->lists.n_added = 0;
    for (size_t i = 0, end, points; room && i < n; i = end, what += 2) {
        end = path_end(&t, i, &points);
        add_path(&t, i, end, points, what);
    }
    dt_pages_release(rows);
    return room;
}

struct paths_record paths_record_at(const double *rows, size_t n, size_t width, size_t i)
{
    struct paths_record r;
    memcpy(&r, rows + (n + i) * width, sizeof r);
    return r;
}

bool paths_take_records(struct change *c, double *rows, size_t n, size_t records, uint32_t first)
{
    size_t values = c->columns == NULL ? 0 : c->columns->count;
    struct taking t = {.c = c, .rows = rows, .n = n, .width = 2 + values, .first = first};
    struct pslg *d = c->pslg;
    bool room = make_room(c, n, records);
    c->n = 0;
    d->lists.n_added = 0;
    for (size_t i = 0; room && i < n; i++)
        add_point(&t, i);
    for (size_t i = 0; room && i < records; i++) {
        struct paths_record r = paths_record_at(rows, n, t.width, i);
        d->lists.added[i] = (struct record_constraint){first + r.a, first + r.b,
                                                       constraint_what(r.border != 0, r.number)};
        d->line[i] = ++d->lists.n_added;
    }
    dt_pages_release(rows);
    return room;
}
