/* voronoi.c - `delaunay voronoi SET FILE`: Voronoi cells as GeoJSON, WKT or a picture. */
#include <math.h>

#include "clients/cli/options.h"
#include "clients/cli/subcommand.h"
#include "clients/commands/shapes_file.h"
#include "clients/pictures/surface_picture.h"
#include "clients/surfaces/raster_fetch.h"
#include "proto/number.h"

struct work {
    const char *set, *field;
    struct shapes_file file; /* owns */
};

/* A picture shows little more than the points: their box, grown by a twentieth of its longer side. */
static enum delaunay_result choose_box(struct delaunay_client *c, struct shapes_file *f,
                                       const char *set)
{
    double *box = f->box;
    if (f->has_box || !shapes_file_is_picture(f))
        return DELAUNAY_OK;
    enum delaunay_result r = raster_bounds(c, set, box, &f->shapes.fault);
    double more = fmax(box[2] - box[0], box[3] - box[1]) / 20;
    for (int i = 0; r == DELAUNAY_OK && i < 4; i++)
        box[i] += i < 2 ? -more : more;
    f->has_box = r == DELAUNAY_OK && box[2] > box[0] && box[3] > box[1];
    return r;
}

static enum delaunay_result fetch(struct delaunay_client *c, struct work *w)
{
    char line[300];
    enum delaunay_result r = choose_box(c, &w->file, w->set);
    if (r != DELAUNAY_OK)
        return r;
    size_t n = (size_t)snprintf(line, sizeof line, "VORONOI %.100s%s", w->set,
                                w->file.has_box ? " BOX" : "");
    for (int i = 0; w->file.has_box && i < 4; i++) {
        line[n++] = ' ';
        n += proto_write_double(line + n, w->file.box[i]);
    }
    r = delaunay_send(c, line, n);
    return r == DELAUNAY_OK ? shapes_file_receive(c, &w->file, w->set, MODEL_FIELDS) : r;
}

static int draw_cells(void *ctx, FILE *out)
{
    struct work *w = ctx;
    char title[200];
    int field = model_field(&w->file.model, w->field != NULL ? w->field : "z");
    if (field < 0 && w->field != NULL)
        return output_fault(w->field, "the set has no such field");
    if (!shapes_file_project(&w->file))
        return EXIT_REFUSED;
    snprintf(title, sizeof title, "%.100s: Voronoi cells of %zu points", w->set, w->file.shapes.n);
    return surface_write_cells(out, title, &w->file.shapes, &w->file.model, field,
                               shapes_file_unit(&w->file))
               ? EXIT_DONE
               : output_fault("", "out of memory");
}

static int read_option(void *ctx, const char *option, char **argv)
{
    struct work *w = ctx;
    if (!options_is(option, "field"))
        return shapes_file_option(&w->file, option, argv);
    w->field = optarg;
    return EXIT_DONE;
}

static int read_arguments(struct work *w, int argc, char **argv)
{
    int status = options_read(argc, argv, read_option, w, 2, "a set and a file");
    if (status != EXIT_DONE)
        return status;
    w->set = argv[optind];
    return shapes_file_choose(&w->file, argv, argv[optind + 1]);
}

int command_voronoi(struct delaunay_client *c, int argc, char **argv)
{
    struct work w = {.file = {.shapes = {.kind = SHAPE_CELL}}};
    if (!options_name_file(argc, argv))
        return request_send_words(c, argc, argv);
    int status = read_arguments(&w, argc, argv);
    if (status != EXIT_DONE)
        return status;
    return shapes_file_finish(c, &w.file, fetch(c, &w), draw_cells, &w);
}
