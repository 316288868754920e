/* export.c - `delaunay export`: fetches a set and writes it in one of the formats, or as a picture. The file
 * gets its name when it is complete. */
#include "clients/commands/export.h"

#include <math.h>
#include <string.h>
#include <unistd.h>

#include "clients/cli/json.h"
#include "clients/cli/message.h"
#include "clients/cli/output.h"
#include "clients/cli/subcommand.h"
#include "clients/meshes/line_formats.h"
#include "clients/reading/program.h"
#include "clients/surfaces/grid_file.h"

struct export_work {
    struct export *e;
    const char *name;
    struct model *m;
    size_t left_out; /* points without a height */
};

static int write_model(void *ctx, FILE *out)
{
    struct export_work *w = ctx;
    bool written = w->e->format != NULL ? w->e->format->write(out, w->m)
                                        : picture_write(out, &w->e->picture, w->name, w->m);
    return written ? EXIT_DONE : output_fault("", "out of memory");
}

/* Turns a drawing into a PNG in its place, with librsvg's or Inkscape's program. */
static int make_png(const char *part, const char *path)
{
    char png[4200];
    snprintf(png, sizeof png, "%s.png", part);
    const char *rsvg[] = {"rsvg-convert", "-o", png, part, NULL};
    const char *inkscape[] = {"inkscape", "--export-type=png", "--export-filename", png, part,
                              NULL};
    int status = program_run(rsvg);
    if (status == PROGRAM_MISSING)
        status = program_run(inkscape);
    if (status == PROGRAM_MISSING)
        output_fault(path, "PNG needs rsvg-convert (Debian: librsvg2-bin) or inkscape");
    else if (status != 0)
        output_fault(path, "the drawing could not be converted");
    else if (rename(png, part) != 0)
        status = output_failed(path);
    if (status != 0)
        unlink(png);
    return status == 0 ? EXIT_DONE : EXIT_REFUSED;
}

/* With --geographic, the middle latitude of the map. */
static int choose_map(struct export_work *w)
{
    struct picture *p = &w->e->picture;
    if (!p->geographic || w->e->format != NULL)
        return EXIT_DONE;
    if (!map_projection_choose(&p->projection, w->m->xy, w->m->n))
        return output_fault("", "--geographic: there are latitudes beyond 90 degrees");
    fprintf(
        stderr,
        "delaunay: a map of degrees, true to scale at latitude %.4g (--planar: x and y alike)\n",
        p->projection.middle);
    return EXIT_DONE;
}

/* A world file in the units of the set. */
static int write_world(void *ctx, FILE *out)
{
    const struct picture *p = &((const struct export_work *)ctx)->e->picture;
    double x = p->geographic ? p->projection.x : 1, y = p->geographic ? p->projection.y : 1;
    world_write(out, p->pixel / x, p->pixel / y, p->left / x, p->top / y);
    return EXIT_DONE;
}

/* The picture or mesh; beside a PNG, where it lies. */
static int write_files(struct export_work *w)
{
    char beside[OUTPUT_PATH];
    const char *path = w->e->path;
    if (!w->e->png)
        return output_write(path, write_model, w, NULL);
    int status = output_check_beside(path, "pgw", w->e->force, beside);
    if (status == EXIT_DONE)
        status = output_write(path, write_model, w, make_png);
    return status == EXIT_DONE ? output_write(beside, write_world, w, NULL) : status;
}

static void report_labels(const struct picture *p)
{
    if (p->unlabelled > 0)
        fprintf(stderr, "delaunay: there is no room for %zu of %zu ids\n", p->unlabelled, p->shown);
}

static void report(const struct export_work *w)
{
    const struct export *e = w->e;
    const struct model *m = w->m;
    size_t shown = e->format == NULL ? e->picture.shown : m->n;
    if (json_chosen()) {
        json_begin(true);
        json_text("file", e->path);
        json_number("points", m->n);
        json_number("shown", shown);
        json_number("triangles", m->triangles);
        json_number("hull", m->hull_n);
        if (m->constraints > 0)
            json_number("constraints", m->constraints);
        if (w->left_out > 0)
            json_number("left_out", w->left_out);
        if (e->more != NULL)
            e->more(e->ctx);
        json_finish();
    } else if (e->format != NULL && (e->format->parts & MODEL_CONSTRAINTS) != 0) {
        printf("%s: %zu points, %zu constraints\n", e->path, m->n, m->constraints);
    } else if (shown < m->n) {
        printf("%s: %zu of %zu points\n", e->path, shown, m->n);
    } else {
        printf("%s: %zu point%s, %zu triangle%s, hull of %zu\n", e->path, m->n,
               m->n == 1 ? "" : "s", m->triangles, m->triangles == 1 ? "" : "s", m->hull_n);
    }
}

/* In a mesh in space a point has a height: those without are left out, with their triangles. */
static int leave_out_missing(struct export_work *w, size_t missing)
{
    struct model *m = w->m;
    bool ok;
    size_t before = m->triangles;
    w->left_out = model_drop_missing(m, &ok);
    if (!ok)
        return output_fault("", "out of memory");
    if (m->n == 0)
        return output_fault(m->field[m->z], "no point has a value of this field");
    if (before > 0 && m->triangles == 0)
        return output_fault(m->field[m->z], "no triangle has a height at each of its points");
    fprintf(
        stderr,
        "delaunay: %zu of %zu heights are missing: these points and their %zu triangles are left "
        "out\n",
        missing, missing + m->n, before - m->triangles);
    return EXIT_DONE;
}

/* Finds the field of heights; its name is wrong, or there is none though one is needed: says so. */
static int choose_heights(struct export_work *w)
{
    const struct export *e = w->e;
    struct model *m = w->m;
    size_t missing = 0;
    if (e->field != NULL)
        m->z = model_field(m, e->field);
    if (m->z < 0 && (e->field != NULL || (e->format == NULL && e->picture.colour == COLOUR_RELIEF)))
        return output_fault(e->field != NULL ? e->field : "z", "the set has no such field");
    for (size_t i = 0; m->z >= 0 && i < m->n; i++)
        missing += isnan(model_value(m, m->z, i)) != 0;
    if (missing > 0 && e->format != NULL && e->format->heights)
        return leave_out_missing(w, missing);
    if (missing > 0)
        fprintf(stderr, "delaunay: %zu of %zu heights are missing\n", missing, m->n);
    return EXIT_DONE;
}

/* After a refusal. A set of lines without borders has no inside. */
static int no_mesh(struct delaunay_client *c, enum delaunay_result r, const struct export *e)
{
    int status = request_outcome(c, r);
    if (r == DELAUNAY_REFUSED && e->inside != NULL && !json_chosen() &&
        strstr(delaunay_status(c)->text, "NOREGION the set has no borders") != NULL)
        message_print("--inside needs borders: load lines with --border, or leave --inside out");
    return status;
}

int export_set(struct delaunay_client *c, struct export *e, const char *set, const char *name)
{
    struct model m = {.inside = e->inside, .crs = &e->crs};
    struct export_work work = {e, name, &m, 0};
    int status;
    unsigned parts = MODEL_TRIANGLES | MODEL_HULL;
    parts |= e->format != NULL   ? e->format->parts
             : e->inside == NULL ? MODEL_CONSTRAINTS | MODEL_REGIONS
                                 : MODEL_CONSTRAINTS;
    if (e->picture.colour == COLOUR_RELIEF || e->field != NULL)
        parts |= MODEL_FIELDS;
    enum delaunay_result r = model_fetch(c, set, parts, &m);
    if (r == DELAUNAY_STOPPED)
        status = output_fault("", m.fault);
    else if (r != DELAUNAY_OK)
        status = no_mesh(c, r, e);
    else if (m.one_region && e->format != NULL)
        status = output_fault("", "there are too many borders for this format");
    else if ((status = choose_heights(&work)) == EXIT_DONE &&
             (status = choose_map(&work)) == EXIT_DONE)
        status = write_files(&work);
    if (status == EXIT_DONE)
        report_labels(&e->picture);
    if (status == EXIT_DONE && !output_is_standard(e->path))
        report(&work);
    model_free(&m);
    return status;
}

/* ---- arguments ---- */

static bool read_colour(const char *text, enum picture_colour *colour)
{
    static const char *const names[] = {[COLOUR_QUALITY] = "quality",
                                        [COLOUR_DEGREE] = "degree",
                                        [COLOUR_ANGLE] = "angle",
                                        [COLOUR_RELIEF] = "relief"};
    for (int i = COLOUR_QUALITY; i <= COLOUR_RELIEF; i++)
        if (strcmp(names[i], text) == 0) {
            *colour = (enum picture_colour)i;
            return true;
        }
    return false;
}

int export_option(void *export, const char *option, char **argv)
{
    struct export *e = export;
    if (options_is(option, "format"))
        e->form = optarg;
    else if (options_is(option, "numbers"))
        e->picture.numbers = true;
    else if (options_is(option, "force"))
        e->force = true;
    else if (options_is(option, "field"))
        e->field = optarg;
    else if (options_is(option, "geographic"))
        e->picture.geographic = true;
    else if (options_is(option, "planar"))
        e->planar = true;
    else if (options_is(option, "inside"))
        return options_inside(&e->inside, argv);
    else if (options_is(option, "lines"))
        e->lines = true;
    else if (options_is(option, "crs"))
        return options_crs(&e->crs, argv);
    else if (options_is(option, "colour") && !read_colour(optarg, &e->picture.colour))
        return options_wrong(
            argv[0], "unknown colour %s; there are angle, quality, degree and relief", optarg);
    else if (options_is(option, "viewport"))
        return options_viewport(e->picture.box, &e->picture.has_box, argv);
    return EXIT_DONE;
}

/* Whether the options suit what is written. */
static int check_options(const struct export *e, char **argv)
{
    const struct format *f = e->format;
    char have[80];
    if (f == NULL)
        return options_suit(argv, e->picture.colour == COLOUR_RELIEF ? "FILE MESH PICTURE HEIGHTS"
                                                                     : "FILE MESH PICTURE POINTS");
    snprintf(have, sizeof have, "FILE%s%s%s", (f->parts & MODEL_TRIANGLES) != 0 ? " MESH" : "",
             (f->parts & MODEL_FIELDS) != 0 ? " HEIGHTS" : "",
             strcmp(f->name, "geojson") == 0 ? " GEOJSON" : "");
    return options_suit(argv, have);
}

int export_prepare(struct export *e, char **argv)
{
    const char *name = output_form(e->form, e->path, "svg");
    char all[FORMATS_LIST];
    e->png = strcmp(name, "png") == 0;
    e->format = e->lines ? NULL : format_find(name);
    if (e->format == NULL)
        e->format = line_format_find(name);
    if (e->lines && e->format == NULL)
        return options_wrong(argv[0],
                             "--lines: the formats are poly, gmt, geojson, ndjson, wkt, obj; "
                             "not %s",
                             name);
    if (e->format == NULL && !e->png && strcmp(name, "svg") != 0) {
        formats_list(all, sizeof all, ", ");
        return options_wrong(argv[0], "unknown format %s; there are %s", name, all);
    }
    if (e->png && output_is_standard(e->path))
        return options_wrong(argv[0], "a PNG needs a file");
    int status = check_options(e, argv);
    return status == EXIT_DONE ? output_check(e->path, e->force) : status;
}

int command_export(struct delaunay_client *c, int argc, char **argv)
{
    struct export e = {0};
    int status = options_read(argc, argv, export_option, &e, 2, "a set and a file");
    if (status != EXIT_DONE)
        return status;
    const char *set = argv[optind];
    e.path = argv[optind + 1];
    status = export_prepare(&e, argv);
    return status == EXIT_DONE ? export_set(c, &e, set, set) : status;
}
