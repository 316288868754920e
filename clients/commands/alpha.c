/* alpha.c - `delaunay alpha SET RADIUS FILE`: the alpha shape as polygons, in GeoJSON, WKT or a picture. */
#include <string.h>
#include <strings.h>

#include "clients/cli/options.h"
#include "clients/cli/subcommand.h"
#include "clients/commands/shapes_file.h"
#include "clients/pictures/surface_picture.h"
#include "clients/surfaces/rings.h"
#include "proto/number.h"

enum { MOST_TRIES = 10 };

struct work {
    const char *set, *wish; /* the radius, or auto */
    char radius[PROTO_NUMBER_MAX + 1];
    struct shapes_file file; /* owns */
    struct paths rings;      /* owns; fetched: their corners are places of the model */
};

/* ---- fetching ---- */

/* The radius is that of the request, or the one that the reply has. */
static void take_radius(struct work *w, const struct delaunay_part *status)
{
    const char *text = w->wish;
    size_t n = strlen(text);
    (void)delaunay_key(status, "radius", &text, &n);
    n = n < sizeof w->radius ? n : sizeof w->radius - 1;
    memcpy(w->radius, text, n);
    w->radius[n] = '\0';
}

static bool take_row(void *ctx, const struct delaunay_part *part)
{
    struct work *w = ctx;
    if (part->kind == DELAUNAY_PART_COMMENT)
        return request_show_comment(NULL, part);
    if (part->kind == DELAUNAY_PART_OK)
        take_radius(w, part);
    return part->kind != DELAUNAY_PART_ROW ||
           rings_take(&w->rings, part->text, part->len, &w->file.shapes.fault);
}

/* Replaces the ids of the corners by places. *torn: a corner is not among the points, so the set was edited meanwhile. */
static void find_corners(struct work *w, bool *torn)
{
    *torn = false;
    for (size_t i = 0; i < w->rings.corners; i++)
        *torn |= !model_find(&w->file.model, w->rings.corner[i], &w->rings.corner[i]);
}

/* The loops and the points; *torn: not of one state of the set. */
static enum delaunay_result fetch_once(struct delaunay_client *c, struct work *w, bool *torn)
{
    uint64_t before = 0, after = 0;
    char line[300];
    paths_free(&w->rings);
    model_free(&w->file.model);
    snprintf(line, sizeof line, "ALPHA %.100s %.100s", w->set, w->wish);
    enum delaunay_result r = model_fetch_version(c, w->set, &before);
    if (r == DELAUNAY_OK)
        r = delaunay_request(c, line, take_row, w);
    if (r == DELAUNAY_OK)
        r = model_fetch(c, w->set, 0, &w->file.model);
    if (r == DELAUNAY_OK)
        r = model_fetch_version(c, w->set, &after);
    if (r == DELAUNAY_OK)
        find_corners(w, torn);
    *torn |= before != after;
    return r;
}

static enum delaunay_result fetch(struct delaunay_client *c, struct work *w)
{
    enum delaunay_result r = DELAUNAY_OK;
    double radius = 0;
    bool torn = true;
    for (int i = 0; i < MOST_TRIES && torn && r == DELAUNAY_OK; i++)
        r = fetch_once(c, w, &torn);
    if (r == DELAUNAY_OK && torn)
        w->file.shapes.fault = "the set is edited while it is read; try again";
    (void)proto_read_double(w->radius, strlen(w->radius), &radius);
    if (r == DELAUNAY_OK &&
        (torn || !rings_to_shapes(&w->rings, w->file.model.xy, radius, &w->file.shapes)))
        r = DELAUNAY_STOPPED;
    return r;
}

static int draw(void *ctx, FILE *out)
{
    struct work *w = ctx;
    struct shapes_file *f = &w->file;
    char title[300];
    if (!shapes_file_project(f))
        return EXIT_REFUSED;
    snprintf(title, sizeof title, "%.100s: alpha shape of radius %.100s", w->set, w->radius);
    return surface_write_rings(out, title, &f->shapes, &f->model, f->has_box ? f->box : NULL,
                               shapes_file_unit(f))
               ? EXIT_DONE
               : output_fault("", "out of memory");
}

/* ---- arguments ---- */

static int read_arguments(struct work *w, int argc, char **argv)
{
    double radius;
    int status =
        options_read(argc, argv, shapes_file_option, &w->file, 3, "a set, a radius and a file");
    if (status != EXIT_DONE)
        return status;
    w->set = argv[optind];
    w->wish = argv[optind + 1];
    size_t n = strlen(w->wish);
    bool automatic = strcasecmp(w->wish, "auto") == 0;
    if (!automatic &&
        (n > PROTO_NUMBER_MAX || !proto_read_double(w->wish, n, &radius) || !(radius >= 0)))
        return options_wrong(argv[0], "the radius is a number of at least 0, or auto, not %.100s",
                             w->wish);
    return shapes_file_choose(&w->file, argv, argv[optind + 2]);
}

int command_alpha(struct delaunay_client *c, int argc, char **argv)
{
    struct work w = {.file = {.shapes = {.kind = SHAPE_RING}}};
    if (!options_name_file(argc, argv))
        return request_send_words(c, argc, argv);
    int status = read_arguments(&w, argc, argv);
    if (status != EXIT_DONE)
        return status;
    status = shapes_file_finish(c, &w.file, fetch(c, &w), draw, &w);
    paths_free(&w.rings);
    return status;
}
