/* raster.c - `delaunay raster SET FIELD FILE`: the surface as a raster of square cells, as a grid for other programs or as a
 * picture of shaded relief. */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "clients/cli/json.h"
#include "clients/cli/options.h"
#include "clients/cli/output.h"
#include "clients/cli/part_file.h"
#include "clients/cli/subcommand.h"
#include "clients/pictures/png_file.h"
#include "clients/pictures/relief.h"
#include "clients/reading/program.h"
#include "clients/surfaces/grid_file.h"
#include "clients/surfaces/raster_fetch.h"
#include "proto/number.h"

enum raster_form { RASTER_ASC, RASTER_BIL, RASTER_PNG, RASTER_TIFF };

struct work {
    const char *set, *field, *path, *named;
    enum raster_form form;
    enum relief_style style;
    struct raster_request request;
    struct crs crs; /* of the coordinates */
    bool force;
    struct grid grid; /* owns its values */
};

/* ---- writing ---- */

static int write_png(const struct grid *g, enum relief_style style, FILE *out)
{
    struct relief r = {.style = style};
    unsigned char *rgba = malloc(4 * (size_t)g->columns * g->rows);
    if (rgba == NULL)
        return output_fault("", "out of memory");
    relief_fit(&r, g);
    relief_paint(&r, g, rgba);
    const char *fault = png_write(out, rgba, g->columns, g->rows);
    free(rgba);
    return fault == NULL ? EXIT_DONE : output_fault("", fault);
}

static int write_grid(void *ctx, FILE *out)
{
    struct work *w = ctx;
    if (w->form == RASTER_PNG)
        return write_png(&w->grid, w->style, out);
    if (w->form == RASTER_ASC)
        grid_write_asc(out, &w->grid);
    else
        grid_write_bil(out, &w->grid);
    return EXIT_DONE;
}

/* Floats have values up to FLT_MAX. */
static bool fits_floats(const struct grid *g)
{
    double least, most;
    return !grid_range(g, &least, &most) || (isfinite((float)least) && isfinite((float)most));
}

static int write_header(void *ctx, FILE *out)
{
    const struct work *w = ctx;
    grid_write_hdr(out, &w->grid);
    return EXIT_DONE;
}

static int write_world(void *ctx, FILE *out)
{
    const struct work *w = ctx;
    const struct grid *g = &w->grid;
    world_write(out, g->cell, g->cell, g->x0, grid_top(g));
    return EXIT_DONE;
}

/* The name that GDAL knows. */
static void name_system(const struct work *w, char *name, size_t room)
{
    snprintf(name, room, "%s:%s", w->crs.authority, w->crs.code);
}

/* The reference system in the dialect of WKT that .prj files have, by GDAL. */
static int write_system(void *ctx, FILE *out)
{
    const struct work *w = ctx;
    char name[2 * CRS_PART + 2], text[4096];
    const char *word[] = {"gdalsrsinfo", "--single-line", "-o", "wkt_esri", name, NULL};
    ssize_t got;
    size_t n = 0;
    pid_t pid;
    int from;
    name_system(w, name, sizeof name);
    if (program_start(&pid, word, -1, &from, false) != 0)
        return output_fault(w->path, "--crs needs gdalsrsinfo (Debian: gdal-bin)");
    while (n < sizeof text && (got = read(from, text + n, sizeof text - n)) > 0)
        n += (size_t)got;
    close(from);
    if (program_end(pid) != 0 || n == 0 || n == sizeof text)
        return output_fault(name, "gdalsrsinfo knows no such reference system");
    fwrite(text, 1, n, out);
    return EXIT_DONE;
}

/* GDAL and QGIS read the reference system of a picture there [gdal.org/user/raster_data_model.html, PAM]. */
static int write_pam(void *ctx, FILE *out)
{
    const struct work *w = ctx;
    fprintf(out, "<PAMDataset>\n  <SRS>%s:%s</SRS>\n</PAMDataset>\n", w->crs.authority,
            w->crs.code);
    return EXIT_DONE;
}

/* A file beside the raster: PATH with this ending in place of its own. */
static int write_beside(struct work *w, const char *ending, output_write_fn *write)
{
    char beside[OUTPUT_PATH];
    int status = output_check_beside(w->path, ending, w->force, beside);
    return status == EXIT_DONE ? output_write(beside, write, w, NULL) : status;
}

/* The raster, and when it is complete what belongs beside it: a header, or where a picture lies; and the reference system. */
static int write_files(void *ctx, FILE *out)
{
    struct work *w = ctx;
    int status = write_grid(w, out);
    bool picture = w->form == RASTER_PNG;
    if (status == EXIT_DONE && (fflush(out) != 0 || ferror(out)))
        status = output_failed(w->path);
    if (status == EXIT_DONE && crs_is_given(&w->crs))
        status = picture ? write_beside(w, "png.aux.xml", write_pam)
                         : write_beside(w, "prj", write_system);
    if (status == EXIT_DONE && w->form == RASTER_BIL)
        status = write_beside(w, "hdr", write_header);
    if (status == EXIT_DONE && picture)
        status = write_beside(w, "pgw", write_world);
    return status;
}

/* A GeoTIFF, by GDAL, from a .bil beside it. */
static int write_tiff(struct work *w)
{
    char bil[4096], header[4096], part[4096];
    char name[2 * CRS_PART + 2];
    const char *words[] = {"gdal_translate",
                           "-q",
                           "-of",
                           "GTiff",
                           bil,
                           part,
                           crs_is_given(&w->crs) ? "-a_srs" : NULL,
                           name,
                           NULL};
    name_system(w, name, sizeof name);
    if ((size_t)snprintf(bil, sizeof bil, "%s.part.bil", w->path) >= sizeof bil ||
        !output_beside(bil, "hdr", header, sizeof header))
        return output_fault(w->path, "the name is too long");
    snprintf(part, sizeof part, "%.*s.tif", (int)strlen(bil) - 4, bil);
    int status = output_write(header, write_header, w, NULL);
    if (status == EXIT_DONE)
        status = output_write(bil, write_grid, w, NULL);
    int ended = status == EXIT_DONE ? program_run(words) : 0;
    if (ended == PROGRAM_MISSING)
        status = output_fault(w->path, "GeoTIFF needs gdal_translate (Debian: gdal-bin)");
    else if (ended != 0)
        status = output_fault(w->path, "gdal_translate failed");
    if (status == EXIT_DONE && !part_file_adopt(part, w->path))
        status = output_failed(w->path);
    unlink(bil);
    unlink(header);
    unlink(part);
    return status;
}

static void report(const struct work *w)
{
    const struct grid *g = &w->grid;
    double least, most;
    bool any = grid_range(g, &least, &most);
    if (json_chosen()) {
        json_begin(true);
        json_text("file", w->path);
        json_number("columns", g->columns);
        json_number("rows", g->rows);
        json_key("cell");
        printf("%.17g", g->cell);
        json_finish();
    } else if (any) {
        printf("%s: %u x %u cells of %.6g, values from %.6g to %.6g\n", w->path, g->columns,
               g->rows, g->cell, least, most);
    } else {
        printf("%s: %u x %u cells of %.6g, without values\n", w->path, g->columns, g->rows,
               g->cell);
    }
}

/* ---- arguments ---- */

static bool read_positive(const char *text, double *v)
{
    return proto_read_double(text, strlen(text), v) && *v > 0 && isfinite(*v);
}

static int read_option(void *ctx, const char *option, char **argv)
{
    struct work *w = ctx;
    struct raster_request *r = &w->request;
    double width;
    if (options_is(option, "format"))
        w->named = optarg;
    else if (options_is(option, "force"))
        w->force = true;
    else if (options_is(option, "method"))
        r->method = optarg;
    else if (options_is(option, "colour") && !relief_read_style(optarg, &w->style))
        return options_wrong(argv[0], "unknown colour %s; there are relief, light and height",
                             optarg);
    else if (options_is(option, "inside"))
        return options_inside(&r->inside, argv);
    else if (options_is(option, "outside"))
        r->outside = optarg;
    else if (options_is(option, "missing"))
        r->missing = optarg;
    else if (options_is(option, "clip"))
        r->clip = optarg;
    else if (options_is(option, "as"))
        r->quantity = optarg;
    else if (options_is(option, "max-edge") && !read_positive(optarg, &r->max_edge))
        return options_wrong(argv[0], "the longest edge is a length, not %s", optarg);
    else if (options_is(option, "cell") && !read_positive(optarg, &r->cell))
        return options_wrong(argv[0], "the side of a cell is a length, not %s", optarg);
    else if (options_is(option, "width") && (!read_positive(optarg, &width) ||
                                             width != floor(width) || width > RASTER_MOST_COLUMNS))
        return options_wrong(argv[0], "the width is a number of cells, not %s", optarg);
    else if (options_is(option, "width"))
        r->columns = (uint32_t)width;
    else if (options_is(option, "crs"))
        return options_crs(&w->crs, argv);
    else if (options_is(option, "viewport"))
        return options_viewport(r->box, &r->has_box, argv);
    return EXIT_DONE;
}

static int choose_form(struct work *w, char **argv)
{
    static const char *const names[] = {"asc", "bil", "png", "tif", "tiff"};
    const char *name = output_form(w->named, w->path, "asc");
    int i = 0;
    while (i < 5 && strcmp(names[i], name) != 0)
        i++;
    if (i == 5)
        return options_wrong(argv[0], "unknown format %s; there are asc, bil, png and tif", name);
    w->form = i < 4 ? (enum raster_form)i : RASTER_TIFF;
    if (output_is_standard(w->path) && w->form > RASTER_ASC)
        return options_wrong(argv[0], "%s needs a file", name);
    int status = options_suit(argv, w->form == RASTER_PNG         ? "FILE PICTURE"
                                    : output_is_standard(w->path) ? ""
                                                                  : "FILE");
    return status == EXIT_DONE ? output_check(w->path, w->force) : status;
}

static int read_arguments(struct work *w, int argc, char **argv)
{
    int status = options_read(argc, argv, read_option, w, 3, "a set, a field and a file");
    if (status != EXIT_DONE)
        return status;
    w->set = argv[optind];
    w->field = argv[optind + 1];
    w->path = argv[optind + 2];
    return choose_form(w, argv);
}

int command_raster(struct delaunay_client *c, int argc, char **argv)
{
    struct work w = {.form = RASTER_ASC};
    if (!options_name_file(argc, argv))
        return request_send_words(c, argc, argv);
    int status = read_arguments(&w, argc, argv);
    if (status != EXIT_DONE)
        return status;
    const char *fault = NULL;
    enum delaunay_result r = raster_fetch(c, w.set, w.field, &w.request, &w.grid, &fault);
    if (r != DELAUNAY_OK)
        return r == DELAUNAY_STOPPED ? output_fault("", fault) : request_outcome(c, r);
    if ((w.form == RASTER_BIL || w.form == RASTER_TIFF) && !fits_floats(&w.grid))
        status =
            output_fault(w.path, "there are values beyond those of 32-bit floats; asc has all");
    else
        status =
            w.form == RASTER_TIFF ? write_tiff(&w) : output_write(w.path, write_files, &w, NULL);
    if (status == EXIT_DONE && !output_is_standard(w.path))
        report(&w);
    raster_free(&w.grid);
    return status;
}
