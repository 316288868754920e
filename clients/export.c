/* export.c - `delaunay export`: fetches a set and writes it in one of the formats, or as a drawing.
 * The file appears under its name when it is complete. */
#include <errno.h>
#include <getopt.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include "clients/command.h"
#include "clients/formats.h"
#include "clients/part_file.h"
#include "clients/svg.h"
#include "proto/number.h"

enum colour { COLOUR_NONE, COLOUR_QUALITY, COLOUR_DEGREE };

struct export
{
    const char *set, *path;
    const struct format *format; /* NULL: a drawing */
    bool png;
    enum colour colour;
    bool numbers, has_box;
    double box[4];
    struct model m;
};

static int say_fault(const char *about, const char *what)
{
    fprintf(stderr, "delaunay: %s%s%s\n", about, about[0] != '\0' ? ": " : "", what);
    return EXIT_REFUSED;
}

/* ---- the drawing ---- */

static const double *point(const struct model *m, size_t place)
{
    return m->xy + 2 * place;
}

/* Twice the inscribed by the circumscribed circle's radius: 1 for an equilateral triangle, near 0
 * for a flat one. */
static double quality(const double *p, const double *q, const double *r)
{
    double a = hypot(p[0] - q[0], p[1] - q[1]), b = hypot(q[0] - r[0], q[1] - r[1]),
           c = hypot(r[0] - p[0], r[1] - p[1]);
    double product = a * b * c;
    return product > 0 ? (b + c - a) * (c + a - b) * (a + b - c) / product : 0;
}

/* The shade of every triangle, from 0; NULL when out of memory. */
static unsigned char *shades(const struct model *m, enum colour colour)
{
    unsigned char *shade = malloc(m->triangles + 1);
    uint32_t *degree = calloc(m->n + 1, sizeof *degree);
    for (size_t i = 0; degree != NULL && i < 3 * m->triangles; i++)
        degree[m->triangle[i]]++;
    for (size_t t = 0; shade != NULL && degree != NULL && t < m->triangles; t++) {
        const uint32_t *v = m->triangle + 3 * t;
        double s = colour == COLOUR_QUALITY
                       ? SVG_SHADES * quality(point(m, v[0]), point(m, v[1]), point(m, v[2]))
                       : (degree[v[0]] + degree[v[1]] + degree[v[2]]) / 3.0 - 1;
        shade[t] = (unsigned char)(s < 0 ? 0 : s >= SVG_SHADES ? SVG_SHADES - 1 : s);
    }
    free(degree);
    return degree != NULL ? shade : NULL;
}

/* Whether some part of the triangle may be seen. */
static bool in_view(const struct export *e, const uint32_t *v)
{
    bool out[4] = {true, true, true, true};
    for (int k = 0; k < 3; k++) {
        const double *p = point(&e->m, v[k]);
        out[0] &= p[0] < e->box[0];
        out[1] &= p[1] < e->box[1];
        out[2] &= p[0] > e->box[2];
        out[3] &= p[1] > e->box[3];
    }
    return !e->has_box || !(out[0] || out[1] || out[2] || out[3]);
}

static bool draw_triangles(struct svg *s, const struct export *e)
{
    const struct model *m = &e->m;
    unsigned char *shade = e->colour != COLOUR_NONE ? shades(m, e->colour) : NULL;
    if (e->colour != COLOUR_NONE && shade == NULL)
        return false;
    for (unsigned pass = 0; pass < (shade != NULL ? SVG_SHADES : 1); pass++) {
        for (size_t t = 0; t < m->triangles; t++) {
            const uint32_t *v = m->triangle + 3 * t;
            if (!in_view(e, v) || (shade != NULL && shade[t] != pass))
                continue;
            if (shade != NULL)
                svg_shaded_triangle(s, pass, point(m, v[0]), point(m, v[1]), point(m, v[2]));
            else
                svg_triangle(s, point(m, v[0]), point(m, v[1]), point(m, v[2]));
        }
    }
    free(shade);
    return true;
}

/* Moves the points that are seen to the front; returns their number. */
static size_t cut_points(struct export *e)
{
    size_t n = 0;
    struct model *m = &e->m;
    for (size_t i = 0; i < m->n; i++) {
        const double *p = point(m, i);
        if (e->has_box &&
            (p[0] < e->box[0] || p[1] < e->box[1] || p[0] > e->box[2] || p[1] > e->box[3]))
            continue;
        m->xy[2 * n] = p[0];
        m->xy[2 * n + 1] = p[1];
        m->id[n++] = m->id[i];
    }
    return n;
}

static bool draw(FILE *out, struct export *e)
{
    char title[160];
    struct svg s;
    struct model *m = &e->m;
    snprintf(title, sizeof title, "%.100s: Delaunay triangulation of %zu points", e->set, m->n);
    if (e->has_box)
        svg_begin_box(&s, out, title, e->box, m->n);
    else
        svg_begin(&s, out, title, m->xy, m->n);
    s.numbers = e->numbers;
    if (!draw_triangles(&s, e))
        return false;
    svg_hull_begin(&s);
    for (size_t i = 0; i < m->hull_n; i++)
        svg_hull_point(&s, point(m, m->hull[i]));
    svg_hull_end(&s);
    svg_points(&s, m->xy, m->id, cut_points(e));
    svg_end(&s);
    return true;
}

/* ---- files ---- */

static int write_to(FILE *out, struct export *e)
{
    bool written = e->format != NULL ? e->format->write(out, &e->m) : draw(out, e);
    return written ? EXIT_DONE : say_fault("", "out of memory");
}

/* Turns the drawing `part` into a PNG in its place, with librsvg's or Inkscape's program. */
static bool make_png(const char *part, const char *png)
{
    int status = -1;
    pid_t child = fork();
    if (child == 0) {
        execlp("rsvg-convert", "rsvg-convert", "-o", png, part, (char *)NULL);
        execlp("inkscape", "inkscape", "--export-type=png", "--export-filename", png, part,
               (char *)NULL);
        _exit(127);
    }
    if (child < 0 || waitpid(child, &status, 0) != child)
        return false;
    if (WIFEXITED(status) && WEXITSTATUS(status) == 127)
        say_fault(png, "PNG needs rsvg-convert (Debian: librsvg2-bin) or inkscape");
    else if (status != 0)
        say_fault(png, "the drawing could not be converted");
    return status == 0;
}

static int file_failed(const char *path)
{
    return say_fault(path, strerror(errno));
}

static int write_file(struct export *e)
{
    struct part_file f;
    const char *fault = part_file_open(&f, e->path);
    if (fault != NULL)
        return file_failed(fault);
    setvbuf(f.out, NULL, _IOFBF, 1 << 18);
    size_t points = e->m.n;
    int status = write_to(f.out, e);
    bool written = part_file_close(&f);
    if (status == EXIT_DONE && !written)
        status = file_failed(e->path);
    if (status == EXIT_DONE && e->png)
        status = make_png(f.part, e->path) ? EXIT_DONE : EXIT_REFUSED;
    else if (status == EXIT_DONE && !part_file_keep(&f))
        status = file_failed(e->path);
    if (status != EXIT_DONE || e->png)
        part_file_drop(&f);
    if (status == EXIT_DONE)
        printf("%s: %zu points, %zu triangles, hull of %zu\n", e->path, points, e->m.triangles,
               e->m.hull_n);
    return status;
}

static int write_standard_output(struct export *e)
{
    int status = write_to(stdout, e);
    return status == EXIT_DONE && fflush(stdout) != 0 ? file_failed("standard output") : status;
}

/* ---- the command ---- */

static bool read_box(const char *text, double *box)
{
    for (int i = 0; i < 4; i++) {
        size_t len = strcspn(text, ",");
        if (!proto_read_double(text, len, &box[i]) || (text[len] == ',') != (i < 3))
            return false;
        text += len + 1;
    }
    return box[0] < box[2] && box[1] < box[3];
}

static bool choose_format(struct export *e, const char *name)
{
    const char *dot = strrchr(e->path, '.');
    if (name == NULL)
        name =
            strcmp(e->path, "-") == 0 || dot == NULL || strchr(dot, '/') != NULL ? "svg" : dot + 1;
    e->png = strcmp(name, "png") == 0;
    e->format = format_find(name);
    return e->format != NULL || e->png || strcmp(name, "svg") == 0;
}

static int wrong(const char *what)
{
    fprintf(stderr, "delaunay: %s\nTry 'delaunay export --help'.\n", what);
    return EXIT_USAGE;
}

/* Reads the arguments; a usage error's status, or EXIT_DONE. */
static int read_arguments(struct export *e, int argc, char **argv)
{
    static const struct option options[] = {{"format", required_argument, NULL, 'f'},
                                            {"numbers", no_argument, NULL, 'n'},
                                            {"colour", required_argument, NULL, 'c'},
                                            {"viewport", required_argument, NULL, 'v'},
                                            {NULL, 0, NULL, 0}};
    const char *name = NULL;
    int option;
    optind = 0;
    while ((option = getopt_long(argc, argv, "f:", options, NULL)) != -1) {
        if (option == 'f')
            name = optarg;
        else if (option == 'n')
            e->numbers = true;
        else if (option == 'c' && strcmp(optarg, "quality") == 0)
            e->colour = COLOUR_QUALITY;
        else if (option == 'c' && strcmp(optarg, "degree") == 0)
            e->colour = COLOUR_DEGREE;
        else if (option == 'v' && read_box(optarg, e->box))
            e->has_box = true;
        else
            return wrong("unknown option, colour or viewport");
    }
    if (argc - optind != 2)
        return wrong("export takes a set and a file");
    e->set = argv[optind];
    e->path = argv[optind + 1];
    if (!choose_format(e, name))
        return wrong("unknown format");
    return e->png && strcmp(e->path, "-") == 0 ? wrong("a PNG needs a file") : EXIT_DONE;
}

int command_export(struct delaunay_client *c, int argc, char **argv)
{
    struct export e = {0};
    int status = read_arguments(&e, argc, argv);
    if (status != EXIT_DONE)
        return status;
    unsigned parts = MODEL_TRIANGLES | MODEL_HULL | (e.format != NULL ? e.format->parts : 0);
    enum delaunay_result r = model_fetch(c, e.set, parts, &e.m);
    if (r == DELAUNAY_STOPPED)
        status = say_fault("", e.m.fault);
    else if (r != DELAUNAY_OK)
        status = command_outcome(c, r);
    else
        status = strcmp(e.path, "-") == 0 ? write_standard_output(&e) : write_file(&e);
    model_free(&e.m);
    return status;
}
