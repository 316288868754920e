/* export.c - `delaunay export`: fetches a set and writes it in one of the formats, or as a picture.
 * The file appears under its name when it is complete. */
#include "clients/commands/export.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include "clients/cli/command.h"
#include "clients/cli/json.h"
#include "clients/files/part_file.h"
#include "proto/number.h"

static int say_fault(const char *about, const char *what)
{
    fprintf(stderr, "delaunay: %s%s%s\n", about, about[0] != '\0' ? ": " : "", what);
    return EXIT_REFUSED;
}

static int file_failed(const char *path)
{
    return say_fault(path, strerror(errno));
}

static int write_to(FILE *out, struct export *e, const char *name, struct model *m)
{
    bool written =
        e->format != NULL ? e->format->write(out, m) : picture_write(out, &e->picture, name, m);
    return written ? EXIT_DONE : say_fault("", "out of memory");
}

/* Turns the drawing f->part into a PNG in its place, with librsvg's or Inkscape's program. */
static bool make_png(struct part_file *f)
{
    char png[sizeof f->part + 4];
    int status = -1;
    snprintf(png, sizeof png, "%s.png", f->part);
    pid_t child = fork();
    if (child == 0) {
        execlp("rsvg-convert", "rsvg-convert", "-o", png, f->part, (char *)NULL);
        execlp("inkscape", "inkscape", "--export-type=png", "--export-filename", png, f->part,
               (char *)NULL);
        _exit(127);
    }
    if (child < 0 || waitpid(child, &status, 0) != child)
        return false;
    if (WIFEXITED(status) && WEXITSTATUS(status) == 127)
        say_fault(f->path, "PNG needs rsvg-convert (Debian: librsvg2-bin) or inkscape");
    else if (status != 0)
        say_fault(f->path, "the drawing could not be converted");
    else if (rename(png, f->part) != 0)
        status = file_failed(f->path);
    if (status != 0)
        unlink(png);
    return status == 0;
}

static void report(const struct export *e, size_t points, const struct model *m)
{
    size_t shown = e->format == NULL ? e->picture.shown : points;
    if (json_chosen()) {
        json_begin(true);
        json_text("file", e->path);
        json_number("points", points);
        json_number("shown", shown);
        json_number("triangles", m->triangles);
        json_number("hull", m->hull_n);
        json_finish();
    } else if (shown < points) {
        printf("%s: %zu of %zu points\n", e->path, shown, points);
    } else {
        printf("%s: %zu points, %zu triangles, hull of %zu\n", e->path, points, m->triangles,
               m->hull_n);
    }
}

static int write_file(struct export *e, const char *name, struct model *m)
{
    struct part_file f;
    const char *fault = part_file_open(&f, e->path);
    if (fault != NULL)
        return file_failed(fault);
    setvbuf(f.out, NULL, _IOFBF, 1 << 18);
    size_t points = m->n;
    int status = write_to(f.out, e, name, m);
    bool written = part_file_close(&f);
    if (status == EXIT_DONE && !written)
        status = file_failed(e->path);
    if (status == EXIT_DONE && e->png && !make_png(&f))
        status = EXIT_REFUSED;
    if (status == EXIT_DONE && !part_file_keep(&f))
        status = file_failed(e->path);
    if (status != EXIT_DONE)
        part_file_drop(&f);
    else
        report(e, points, m);
    return status;
}

static int write_standard_output(struct export *e, const char *name, struct model *m)
{
    int status = write_to(stdout, e, name, m);
    return status == EXIT_DONE && fflush(stdout) != 0 ? file_failed("standard output") : status;
}

int export_set(struct delaunay_client *c, struct export *e, const char *set, const char *name)
{
    struct model m = {0};
    int status;
    unsigned parts = MODEL_TRIANGLES | MODEL_HULL | (e->format != NULL ? e->format->parts : 0);
    enum delaunay_result r = model_fetch(c, set, parts, &m);
    if (r == DELAUNAY_STOPPED)
        status = say_fault("", m.fault);
    else if (r != DELAUNAY_OK)
        status = command_outcome(c, r);
    else
        status = strcmp(e->path, "-") == 0 ? write_standard_output(e, name, &m)
                                           : write_file(e, name, &m);
    model_free(&m);
    return status;
}

/* ---- arguments ---- */

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

static bool read_colour(const char *text, enum picture_colour *colour)
{
    *colour = strcmp(text, "quality") == 0 ? COLOUR_QUALITY : COLOUR_DEGREE;
    return *colour == COLOUR_QUALITY || strcmp(text, "degree") == 0;
}

int export_option(struct export *e, int option, char **argv)
{
    if (option == 'f')
        e->form = optarg;
    else if (option == 'n')
        e->picture.numbers = true;
    else if (option == 'F')
        e->force = true;
    else if (option == 'o' && !read_colour(optarg, &e->picture.colour))
        return options_wrong(argv[0], "unknown colour %s; there are quality and degree", optarg);
    else if (option == 'v' && !read_box(optarg, e->picture.box))
        return options_wrong(
            argv[0], "the viewport %s is no X0,Y0,X1,Y1 from lower left to upper right", optarg);
    else if (option == 'v')
        e->picture.has_box = true;
    else if (option != 'o')
        return options_unknown(argv[0], argv, option);
    return EXIT_DONE;
}

int export_prepare(struct export *e, char **argv)
{
    const char *dot = strrchr(e->path, '.'), *name = e->form;
    bool standard = strcmp(e->path, "-") == 0;
    if (name == NULL)
        name = standard || dot == NULL || strchr(dot, '/') != NULL ? "svg" : dot + 1;
    e->png = strcmp(name, "png") == 0;
    e->format = format_find(name);
    if (e->format == NULL && !e->png && strcmp(name, "svg") != 0)
        return options_wrong(argv[0], "unknown format %s", name);
    if (e->png && standard)
        return options_wrong(argv[0], "a PNG needs a file");
    if (standard || e->force || !part_file_is_foreign(e->path))
        return EXIT_DONE;
    part_file_refuse(e->path);
    return EXIT_REFUSED;
}

int command_export(struct delaunay_client *c, int argc, char **argv)
{
    static const struct option options[] = {
        {"format", required_argument, NULL, 'f'}, EXPORT_OPTIONS, {NULL, 0, NULL, 0}};
    struct export e = {0};
    int option, status = EXIT_DONE;
    optind = 0;
    while (status == EXIT_DONE && (option = options_next(argc, argv, "f:", options)) != -1)
        status = export_option(&e, option, argv);
    if (status == EXIT_DONE && argc - optind != 2)
        status = options_wrong(argv[0], "export takes a set and a file");
    if (status != EXIT_DONE)
        return status;
    const char *set = argv[optind];
    e.path = argv[optind + 1];
    status = export_prepare(&e, argv);
    return status == EXIT_DONE ? export_set(c, &e, set, set) : status;
}
