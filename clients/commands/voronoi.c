/* voronoi.c - `delaunay voronoi SET FILE`: Voronoi cells as GeoJSON, WKT or a picture. */
#include <string.h>

#include "clients/cli/command.h"
#include "clients/cli/json.h"
#include "clients/cli/options.h"
#include "clients/commands/output.h"
#include "clients/pictures/surface_picture.h"
#include "proto/number.h"

struct work {
    const char *set, *path, *form, *field;
    bool force, has_box;
    double box[4];
    struct shapes cells; /* owns */
    struct model model;  /* owns */
};

static bool take_cell(void *ctx, const struct delaunay_part *part)
{
    if (part->kind == DELAUNAY_PART_COMMENT)
        return command_show_comment(NULL, part);
    return part->kind != DELAUNAY_PART_ROW || shapes_take(ctx, part->text, part->len);
}

static enum delaunay_result fetch(struct delaunay_client *c, struct work *w)
{
    char line[300];
    size_t n =
        (size_t)snprintf(line, sizeof line, "VORONOI %.100s%s", w->set, w->has_box ? " BOX" : "");
    for (int i = 0; w->has_box && i < 4; i++) {
        line[n++] = ' ';
        n += proto_write_double(line + n, w->box[i]);
    }
    enum delaunay_result r = delaunay_send(c, line, n);
    if (r == DELAUNAY_OK)
        r = delaunay_receive(c, take_cell, &w->cells);
    if (r == DELAUNAY_OK && strcmp(w->form, "svg") == 0)
        r = model_fetch(c, w->set, MODEL_FIELDS, &w->model);
    return r;
}

static int write_cells(void *ctx, FILE *out)
{
    struct work *w = ctx;
    char title[200];
    if (strcmp(w->form, "wkt") == 0) {
        shapes_write_wkt(out, &w->cells);
        return EXIT_DONE;
    }
    if (strcmp(w->form, "svg") != 0) {
        shapes_write_geojson(out, &w->cells);
        return EXIT_DONE;
    }
    int field = model_field(&w->model, w->field != NULL ? w->field : "z");
    if (field < 0 && w->field != NULL)
        return output_fault(w->field, "the set has no such field");
    snprintf(title, sizeof title, "%.100s: Voronoi cells of %zu points", w->set, w->cells.n);
    return surface_write_cells(out, title, &w->cells, &w->model, field)
               ? EXIT_DONE
               : output_fault("", "out of memory");
}

static int read_option(struct work *w, int option, char **argv)
{
    if (option == 'f')
        w->form = optarg;
    else if (option == 'F')
        w->force = true;
    else if (option == 'z')
        w->field = optarg;
    else if (option == 'v' && !options_read_box(optarg, w->box))
        return options_wrong(
            argv[0], "the viewport %s is not X0,Y0,X1,Y1 from lower left to upper right", optarg);
    else if (option == 'v')
        w->has_box = true;
    else
        return options_unknown(argv[0], argv, option);
    return EXIT_DONE;
}

static int read_arguments(struct work *w, int argc, char **argv)
{
    static const struct option options[] = {{"format", required_argument, NULL, 'f'},
                                            {"viewport", required_argument, NULL, 'v'},
                                            {"field", required_argument, NULL, 'z'},
                                            {"force", no_argument, NULL, 'F'},
                                            {NULL, 0, NULL, 0}};
    int option, status = EXIT_DONE;
    optind = 0;
    while (status == EXIT_DONE && (option = options_next(argc, argv, "f:", options)) != -1)
        status = read_option(w, option, argv);
    if (status == EXIT_DONE && argc - optind != 2)
        status = options_wrong(argv[0], "voronoi takes a set and a file");
    if (status != EXIT_DONE)
        return status;
    w->set = argv[optind];
    w->path = argv[optind + 1];
    w->form = output_form(w->form, w->path, "geojson");
    static const char *const forms[] = {"geojson", "json", "svg", "wkt"};
    for (int i = 0; i < 4; i++)
        if (strcmp(w->form, forms[i]) == 0)
            return output_check(w->path, w->force);
    return options_wrong(argv[0], "unknown format %s; there are geojson, svg and wkt", w->form);
}

static void report(const struct work *w)
{
    if (!json_chosen()) {
        printf("%s: %zu cells\n", w->path, w->cells.n);
        return;
    }
    json_begin(true);
    json_text("file", w->path);
    json_number("cells", w->cells.n);
    json_finish();
}

int command_voronoi(struct delaunay_client *c, int argc, char **argv)
{
    struct work w = {.cells = {.kind = SHAPE_CELL}};
    if (!options_name_file(argc, argv))
        return command_any(c, argc, argv);
    int status = read_arguments(&w, argc, argv);
    if (status != EXIT_DONE)
        return status;
    enum delaunay_result r = fetch(c, &w);
    if (r == DELAUNAY_STOPPED)
        status = output_fault("", w.cells.fault != NULL ? w.cells.fault : w.model.fault);
    else if (r != DELAUNAY_OK)
        status = command_outcome(c, r);
    else
        status = output_write(w.path, write_cells, &w, NULL);
    if (status == EXIT_DONE && !output_is_standard(w.path))
        report(&w);
    shapes_free(&w.cells);
    model_free(&w.model);
    return status;
}
