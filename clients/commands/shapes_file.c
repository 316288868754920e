/* shapes_file.c - see shapes_file.h. */
#include "clients/commands/shapes_file.h"

#include <string.h>

#include "clients/cli/json.h"
#include "clients/cli/options.h"
#include "clients/cli/request.h"
#include "clients/meshes/map_projection.h"
#include "clients/reading/word_list.h"

int shapes_file_option(void *file, const char *option, char **argv)
{
    struct shapes_file *f = file;
    if (options_is(option, "format"))
        f->form = optarg;
    else if (options_is(option, "force"))
        f->force = true;
    else if (options_is(option, "geographic"))
        f->geographic = true;
    else if (options_is(option, "crs"))
        return options_crs(&f->crs, argv);
    else
        return options_viewport(f->box, &f->has_box, argv);
    return EXIT_DONE;
}

int shapes_file_choose(struct shapes_file *f, char **argv, const char *path)
{
    f->path = path;
    f->form = output_form(f->form, path, "geojson");
    if (!word_list_has("geojson json svg wkt", f->form, strlen(f->form)))
        return options_wrong(argv[0], "unknown format %s; there are geojson, svg and wkt", f->form);
    int status = options_suit(argv, strstr(f->form, "json") != NULL ? "FILE GEOJSON"
                                    : shapes_file_is_picture(f)     ? "FILE PICTURE"
                                                                    : "FILE");
    return status == EXIT_DONE ? output_check(path, f->force) : status;
}

bool shapes_file_project(struct shapes_file *f)
{
    struct map_projection d;
    if (!f->geographic || f->model.n == 0)
        return true;
    if (!map_projection_choose(&d, f->model.xy, f->model.n)) {
        output_fault("", "--geographic: there are latitudes beyond 90 degrees");
        return false;
    }
    map_projection_project(&d, f->shapes.xy, f->shapes.corners);
    map_projection_project(&d, f->box, 2);
    map_projection_project(&d, f->model.xy, f->model.n);
    return true;
}

const char *shapes_file_unit(const struct shapes_file *f)
{
    return f->geographic ? "km" : "";
}

bool shapes_file_is_picture(const struct shapes_file *f)
{
    return strcmp(f->form, "svg") == 0;
}

static bool take_row(void *ctx, const struct delaunay_part *part)
{
    if (part->kind == DELAUNAY_PART_COMMENT)
        return request_show_comment(NULL, part);
    return part->kind != DELAUNAY_PART_ROW || shapes_take(ctx, part->text, part->len);
}

enum delaunay_result shapes_file_receive(struct delaunay_client *c, struct shapes_file *f,
                                         const char *set, unsigned parts)
{
    enum delaunay_result r = delaunay_receive(c, take_row, &f->shapes);
    if (r == DELAUNAY_OK && shapes_file_is_picture(f))
        r = model_fetch(c, set, parts, &f->model);
    return r;
}

static int write_text(void *ctx, FILE *out)
{
    struct shapes_file *f = ctx;
    f->shapes.crs = &f->crs;
    if (strcmp(f->form, "wkt") == 0)
        shapes_write_wkt(out, &f->shapes);
    else
        shapes_write_geojson(out, &f->shapes);
    return EXIT_DONE;
}

static void report(const struct shapes_file *f)
{
    static const char *const names[] = {[SHAPE_CELL] = "cells",
                                        [SHAPE_CONTOUR] = "lines",
                                        [SHAPE_BAND] = "polygons",
                                        [SHAPE_RING] = "polygons"};
    const struct shapes *s = &f->shapes;
    bool lines = s->kind == SHAPE_CONTOUR, rings = s->kind == SHAPE_RING;
    size_t n = shapes_count(s), closed = 0;
    for (size_t i = 0; i < s->n; i++)
        closed += s->shape[i].closed;
    if (!json_chosen()) {
        printf("%s: %zu %s", f->path, n, names[s->kind]);
        if (lines)
            printf(", %zu of them closed", closed);
        if (rings)
            printf(", %zu holes", s->n - n);
        putchar('\n');
        return;
    }
    json_begin(true);
    json_text("file", f->path);
    json_number(names[s->kind], n);
    if (lines)
        json_number("closed", closed);
    if (rings)
        json_number("holes", s->n - n);
    json_finish();
}

int shapes_file_finish(struct delaunay_client *c, struct shapes_file *f, enum delaunay_result r,
                       output_write_fn *draw, void *ctx)
{
    int status;
    if (r == DELAUNAY_STOPPED)
        status = output_fault("", f->shapes.fault != NULL ? f->shapes.fault : f->model.fault);
    else if (r != DELAUNAY_OK)
        status = request_outcome(c, r);
    else if (shapes_file_is_picture(f))
        status = output_write(f->path, draw, ctx, NULL);
    else
        status = output_write(f->path, write_text, f, NULL);
    if (status == EXIT_DONE && !output_is_standard(f->path))
        report(f);
    shapes_free(&f->shapes);
    model_free(&f->model);
    return status;
}
