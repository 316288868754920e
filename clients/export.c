/* export.c - `delaunay export SET FILE.svg`: asks for points, triangles and hull in turn and draws
 * them as they come. Only the coordinates are kept. The file appears under its name when it is
 * complete. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "clients/command.h"
#include "clients/svg.h"
#include "proto/number.h"

struct export
{
    uint32_t *id; /* owns n, ascending */
    double *xy;   /* owns 2n */
    size_t n, cap;
    struct svg svg;
    const char *fault; /* what went wrong here: a static sentence */
};

static bool fault(struct export *e, const char *what)
{
    e->fault = what;
    return false;
}

/* Splits a row at its blanks into exactly n words. */
static bool split(const struct reply_part *row, const char **word, size_t *len, size_t n)
{
    const char *p = row->text, *end = p + row->len;
    for (size_t i = 0; i < n; i++) {
        const char *space = memchr(p, ' ', (size_t)(end - p));
        const char *stop = i + 1 < n ? space : end;
        if (stop == NULL || (i + 1 == n && space != NULL))
            return false;
        word[i] = p;
        len[i] = (size_t)(stop - p);
        p = stop + 1;
    }
    return true;
}

/* `id x y` */
static bool read_point_row(const struct reply_part *row, uint32_t *id, double *xy)
{
    const char *word[3];
    size_t len[3];
    return split(row, word, len, 3) && proto_read_u32(word[0], len[0], id) &&
           proto_read_double(word[1], len[1], &xy[0]) && proto_read_double(word[2], len[2], &xy[1]);
}

static bool reserve(struct export *e, uint64_t n)
{
    if (n > SIZE_MAX / (2 * sizeof(double)) || n == 0)
        return fault(e, n == 0 ? "the set is empty" : "too many points");
    e->id = malloc(n * sizeof e->id[0]);
    e->xy = malloc(2 * n * sizeof e->xy[0]);
    e->cap = n;
    return (e->id != NULL && e->xy != NULL) || fault(e, "out of memory");
}

/* POINTS: one reply is one consistent state of the set, its size announced. */
static bool keep_point(void *ctx, const struct reply_part *part)
{
    struct export *e = ctx;
    if (part->kind == REPLY_OK)
        return reserve(e, reply_rows(part));
    if (part->kind != REPLY_ROW)
        return command_show_comment(ctx, part);
    if (e->n == e->cap || !read_point_row(part, &e->id[e->n], &e->xy[2 * e->n]))
        return fault(e, "a row is no point");
    e->n++;
    return true;
}

/* The coordinates of id; NULL if it is not there. Ids are mostly 0 .. n - 1, so look there first.
 */
static const double *find_point(const struct export *e, uint32_t id)
{
    if (id < e->n && e->id[id] == id)
        return &e->xy[2 * (size_t)id];
    size_t lo = 0, hi = e->n;
    while (lo < hi) {
        size_t mid = lo + (hi - lo) / 2;
        if (e->id[mid] < id)
            lo = mid + 1;
        else
            hi = mid;
    }
    return lo < e->n && e->id[lo] == id ? &e->xy[2 * lo] : NULL;
}

/* TRIANGLES; the drawing begins with the reply, so that a refusal leaves no file. */
static bool draw_triangle(void *ctx, const struct reply_part *part)
{
    struct export *e = ctx;
    const char *word[3];
    size_t len[3];
    const double *p[3];
    if (part->kind != REPLY_ROW)
        return command_show_comment(ctx, part);
    if (!split(part, word, len, 3))
        return fault(e, "a row is no triangle");
    for (int i = 0; i < 3; i++) {
        uint32_t id;
        if (!proto_read_u32(word[i], len[i], &id))
            return fault(e, "a row is no triangle");
        if ((p[i] = find_point(e, id)) == NULL)
            return fault(e, "the set was edited meanwhile; try again");
    }
    svg_triangle(&e->svg, p[0], p[1], p[2]);
    return !ferror(e->svg.out);
}

/* HULL */
static bool draw_hull_point(void *ctx, const struct reply_part *part)
{
    struct export *e = ctx;
    uint32_t id;
    double p[2];
    if (part->kind != REPLY_ROW)
        return command_show_comment(ctx, part);
    if (!read_point_row(part, &id, p))
        return fault(e, "a row is no point");
    svg_hull_point(&e->svg, p);
    return !ferror(e->svg.out);
}

static enum delaunay_result ask(struct delaunay_client *c, const char *command, const char *set,
                                delaunay_part_fn *part, struct export *e)
{
    char line[128];
    snprintf(line, sizeof line, "%s %.100s", command, set);
    return delaunay_request(c, line, part, e);
}

static enum delaunay_result draw(struct delaunay_client *c, const char *set, FILE *out,
                                 struct export *e)
{
    char title[160];
    snprintf(title, sizeof title, "%.100s: Delaunay triangulation of %zu points", set, e->n);
    svg_begin(&e->svg, out, title, e->xy, e->n);
    enum delaunay_result r = ask(c, "TRIANGLES", set, draw_triangle, e);
    if (r != DELAUNAY_OK)
        return r;
    svg_hull_begin(&e->svg);
    r = ask(c, "HULL", set, draw_hull_point, e);
    if (r != DELAUNAY_OK)
        return r;
    svg_hull_end(&e->svg);
    svg_points(&e->svg, e->xy, e->id, e->n);
    svg_end(&e->svg);
    return DELAUNAY_OK;
}

static int export_outcome(const struct delaunay_client *c, enum delaunay_result r,
                          const struct export *e)
{
    if (r != DELAUNAY_STOPPED)
        return command_outcome(c, r);
    fprintf(stderr, "delaunay: %s\n", e->fault != NULL ? e->fault : strerror(errno));
    return EXIT_REFUSED;
}

static int file_failed(const char *path)
{
    fprintf(stderr, "delaunay: %s: %s\n", path, strerror(errno));
    return EXIT_REFUSED;
}

/* Draws into path.part and renames that: nobody sees half a drawing. */
static int draw_file(struct delaunay_client *c, const char *set, const char *path, struct export *e)
{
    char part[4096 + 8];
    if ((size_t)snprintf(part, sizeof part, "%s.part", path) >= sizeof part) {
        errno = ENAMETOOLONG;
        return file_failed(path);
    }
    FILE *out = fopen(part, "w");
    if (out == NULL)
        return file_failed(part);
    int status = export_outcome(c, draw(c, set, out, e), e);
    bool written = !ferror(out);
    written = fclose(out) == 0 && written;
    if (status == EXIT_DONE && (!written || rename(part, path) != 0))
        status = file_failed(path);
    if (status != EXIT_DONE)
        unlink(part);
    else
        printf("%s: %zu points, %zu triangles, hull of %ju\n", path, e->n, e->svg.triangles,
               (uintmax_t)e->svg.hull);
    return status;
}

static int draw_standard_output(struct delaunay_client *c, const char *set, struct export *e)
{
    int status = export_outcome(c, draw(c, set, stdout, e), e);
    return status == EXIT_DONE && fflush(stdout) != 0 ? file_failed("standard output") : status;
}

int command_export(struct delaunay_client *c, const char *set, const char *path)
{
    struct export e = {0};
    int status = export_outcome(c, ask(c, "POINTS", set, keep_point, &e), &e);
    if (status == EXIT_DONE)
        status =
            strcmp(path, "-") == 0 ? draw_standard_output(c, set, &e) : draw_file(c, set, path, &e);
    free(e.id);
    free(e.xy);
    return status;
}
