/* shapes_file.h - a file of cells, contour lines, bands or an alpha shape: what `delaunay voronoi`, `contour` and `alpha` have in
 * common. */
#pragma once

#include "clients/cli/output.h"
#include "clients/lib/delaunay_client.h"
#include "clients/meshes/model.h"
#include "clients/surfaces/shapes.h"

struct shapes_file {
    const char *path, *form; /* borrows from argv */
    bool force, has_box, geographic;
    double box[4];
    struct crs crs;       /* of the coordinates, for GeoJSON */
    struct shapes shapes; /* owns */
    struct model model;   /* owns; what the picture shows beside the shapes */
};

/* Takes --format, --force, --geographic, --crs and --viewport. `file`: a struct shapes_file. Returns the exit status. */
int shapes_file_option(void *file, const char *option, char **argv);

/* Sets the path, and the format unless an option named it; checks that the options suit them. Returns the
 * exit status. */
int shapes_file_choose(struct shapes_file *f, char **argv, const char *path);

/* For a picture with --geographic: changes the shapes, the box and the model to kilometres; returns false, having said why, if they are
 * not in degrees. */
bool shapes_file_project(struct shapes_file *f);

/* The unit of the scale of a picture. */
const char *shapes_file_unit(const struct shapes_file *f);

bool shapes_file_is_picture(const struct shapes_file *f);

/* Receives the reply to VORONOI or CONTOUR, and of the set what a picture needs. */
enum delaunay_result shapes_file_receive(struct delaunay_client *c, struct shapes_file *f,
                                         const char *set, unsigned parts);

/* Writes the file after fetching ended with r: a picture by draw, text by itself. Then prints how many shapes there are; of lines also how
 * many are closed, of an alpha shape how many holes it has. Frees what *f owns. Returns the exit status. */
int shapes_file_finish(struct delaunay_client *c, struct shapes_file *f, enum delaunay_result r,
                       output_write_fn *draw, void *ctx);
