/* export.h - writes a triangulated set as a picture or in another program's format: shared by `export`, `draw`
 * and `run`. */
#pragma once

#include "clients/cli/options.h"
#include "clients/lib/delaunay_client.h"
#include "clients/meshes/formats.h"
#include "clients/pictures/picture.h"

struct export
{
    const char *field;           /* of heights; NULL: z if there is one */
    const char *path, *form;     /* "-": the standard output; form NULL: the ending decides */
    const struct format *format; /* NULL: a picture */
    bool png, force;
    const char *inside;            /* only the triangles inside this border, or `any`; NULL: all */
    bool lines;                    /* the lines and polygons of the set instead of its triangles */
    void (*more)(const void *ctx); /* writes more keys of the report in JSON; may be NULL */
    const void *ctx;
    struct crs crs; /* of the coordinates, for GeoJSON */
    bool planar;    /* the picture is not a map, whatever the file says */
    struct picture picture;
};

/* Takes an option of a struct export; a usage error's status, or EXIT_DONE. */
int export_option(void *export, const char *option, char **argv);

/* When all options have been read and e->path is known: chooses the format, and refuses to replace a file that
 * another program wrote. Returns the exit status. */
int export_prepare(struct export *e, char **argv);

/* Fetches the set and writes it; returns the exit status. `name` is the picture's title. */
int export_set(struct delaunay_client *c, struct export *e, const char *set, const char *name);
