/* contour.c - `delaunay contour SET FIELD FILE`: contour lines as GeoJSON, WKT or a picture on shaded relief; or the bands
 * between levels as polygons or a filled picture. */
#include <string.h>

#include "clients/cli/options.h"
#include "clients/cli/subcommand.h"
#include "clients/commands/shapes_file.h"
#include "clients/lib/words.h"
#include "clients/pictures/legend.h"
#include "clients/pictures/surface_picture.h"
#include "proto/number.h"

enum { USUAL_LEVELS = 10, MOST_LEVELS = 1000 };

struct work {
    const char *set, *field, *every, *base, *levels, *max_edge, *inside, *missing;
    bool bands, unlabelled;
    struct shapes_file file; /* owns */
};

/* ---- levels ---- */

/* A row `name count least most` of FIELDS. */
struct span {
    const char *field;
    double least, most;
    bool found;
};

static bool take_span(void *ctx, const struct delaunay_part *part)
{
    struct span *s = ctx;
    size_t n = strlen(s->field);
    char text[200];
    double least, most;
    if (part->kind != DELAUNAY_PART_ROW || part->len >= sizeof text || part->len <= n ||
        memcmp(part->text, s->field, n) != 0 || part->text[n] != ' ')
        return true;
    memcpy(text, part->text, part->len);
    text[part->len] = '\0';
    s->found = sscanf(text + n, "%*s %lf %lf", &least, &most) == 2 && least <= most;
    s->least = least;
    s->most = most;
    return true;
}

/* A round step, 1, 2 or 5 times a power of ten, that makes about USUAL_LEVELS levels of the field's span. 0: it has none. */
static double choose_step(const struct span *s)
{
    double rough = s->found ? s->most / USUAL_LEVELS - s->least / USUAL_LEVELS : 0;
    if (!(rough > 0))
        return 0;
    return round_step_times(round_step_of(rough), 1);
}

/* Appends the levels, which stand between commas. */
static size_t put_levels(char *line, size_t n, size_t room, const char *levels)
{
    size_t from = n;
    n += (size_t)snprintf(line + n, room - n, " %s", levels);
    for (size_t i = from; i < n; i++)
        if (line[i] == ',')
            line[i] = ' ';
    return n;
}

static enum delaunay_result send_request(struct delaunay_client *c, const struct work *w,
                                         double step)
{
    char line[8000];
    size_t n = (size_t)snprintf(line, sizeof line, "CONTOUR %.100s %.100s", w->set, w->field);
    if (w->levels != NULL) {
        n = put_levels(line, n, sizeof line, w->levels);
    } else {
        char every[PROTO_NUMBER_MAX + 1];
        every[proto_write_double(every, step)] = '\0';
        n = words_put(line, n, sizeof line, "EVERY", w->every != NULL ? w->every : every);
        n = words_put(line, n, sizeof line, "BASE", w->base);
    }
    n = words_put(line, n, sizeof line, "BANDS", w->bands ? "" : NULL);
    n = words_put(line, n, sizeof line, "MAXEDGE", w->max_edge);
    n = words_put(line, n, sizeof line, "INSIDE", words_inside(w->inside));
    n = words_put(line, n, sizeof line, "MISSING", w->missing);
    return n < sizeof line ? delaunay_send(c, line, n) : DELAUNAY_BADREQUEST;
}

static enum delaunay_result fetch(struct delaunay_client *c, struct work *w)
{
    enum { PARTS = MODEL_TRIANGLES | MODEL_FIELDS | MODEL_CONSTRAINTS | MODEL_REGIONS };
    struct span span = {.field = w->field};
    char line[120];
    enum delaunay_result r = DELAUNAY_OK;
    if (w->levels == NULL && w->every == NULL) {
        snprintf(line, sizeof line, "FIELDS %.100s", w->set);
        r = delaunay_request(c, line, take_span, &span);
    }
    double step = choose_step(&span);
    if (r == DELAUNAY_OK)
        r = send_request(c, w, step > 0 ? step : 1);
    if (r == DELAUNAY_OK)
        r = shapes_file_receive(c, &w->file, w->set, PARTS);
    return r;
}

static bool write_picture(struct work *w, FILE *out, int field)
{
    char title[300];
    const struct shapes_file *f = &w->file;
    const double *box = f->has_box ? f->box : NULL;
    snprintf(title, sizeof title, "%.100s: %s of %.100s", w->set,
             w->bands ? "bands" : "contour lines", w->field);
    return w->bands
               ? surface_write_bands(out, title, &f->shapes, &f->model, box, shapes_file_unit(f))
               : surface_write_contours(out, title, &f->shapes, &f->model, field, box,
                                        shapes_file_unit(f), !w->unlabelled);
}

static int draw(void *ctx, FILE *out)
{
    struct work *w = ctx;
    int field = model_field(&w->file.model, w->field);
    if (field < 0)
        return output_fault(w->field, "the set has no such field");
    if (!shapes_file_project(&w->file))
        return EXIT_REFUSED;
    return write_picture(w, out, field) ? EXIT_DONE : output_fault("", "out of memory");
}

/* ---- arguments ---- */

static bool is_level(const char *text, size_t len)
{
    bool infinite = (len == 3 && memcmp(text, "inf", 3) == 0) ||
                    (len == 4 && memcmp(text, "-inf", 4) == 0); /* of bands; the server says so */
    return infinite || (proto_is_number(text, len) && len <= PROTO_NUMBER_MAX);
}

static bool are_levels(const char *text)
{
    size_t n = 0;
    for (;; text++, n++) {
        size_t len = strcspn(text, ",");
        if (!is_level(text, len) || n == MOST_LEVELS)
            return false;
        text += len;
        if (*text == '\0')
            return true;
    }
}

static int read_option(void *ctx, const char *option, char **argv)
{
    struct work *w = ctx;
    if (options_is(option, "bands")) {
        w->bands = true;
        w->file.shapes.kind = SHAPE_BAND;
    } else if (options_is(option, "no-labels")) {
        w->unlabelled = true;
    } else if (options_is(option, "levels") && strlen(optarg) < 7000 && are_levels(optarg))
        w->levels = optarg;
    else if (options_is(option, "levels"))
        return options_wrong(argv[0], "the levels are numbers between commas, not %.100s", optarg);
    else if (options_is(option, "inside"))
        return options_inside(&w->inside, argv);
    else if (options_is(option, "missing"))
        w->missing = optarg;
    else if (!options_is(option, "every") && !options_is(option, "base") &&
             !options_is(option, "max-edge"))
        return shapes_file_option(&w->file, option, argv);
    else if (!proto_is_number(optarg, strlen(optarg)) || strlen(optarg) > 40)
        return options_wrong(argv[0], "%s is not a number", optarg);
    else
        *(options_is(option, "every")  ? &w->every
          : options_is(option, "base") ? &w->base
                                       : &w->max_edge) = optarg;
    return EXIT_DONE;
}

static int read_arguments(struct work *w, int argc, char **argv)
{
    int status = options_read(argc, argv, read_option, w, 3, "a set, a field and a file");
    if (status != EXIT_DONE)
        return status;
    w->set = argv[optind];
    w->field = argv[optind + 1];
    return shapes_file_choose(&w->file, argv, argv[optind + 2]);
}

int command_contour(struct delaunay_client *c, int argc, char **argv)
{
    struct work w = {.file = {.shapes = {.kind = SHAPE_CONTOUR}}};
    if (!options_name_file(argc, argv))
        return request_send_words(c, argc, argv);
    int status = read_arguments(&w, argc, argv);
    if (status != EXIT_DONE)
        return status;
    return shapes_file_finish(c, &w.file, fetch(c, &w), draw, &w);
}
