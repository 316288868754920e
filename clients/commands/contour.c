/* contour.c - `delaunay contour SET FIELD FILE`: contour lines as GeoJSON, WKT or a picture on shaded relief. */
#include <math.h>
#include <string.h>

#include "clients/cli/command.h"
#include "clients/cli/json.h"
#include "clients/cli/options.h"
#include "clients/commands/output.h"
#include "clients/pictures/surface_picture.h"
#include "proto/number.h"

enum { USUAL_LEVELS = 10, MOST_LEVELS = 1000 };

struct work {
    const char *set, *field, *path, *form, *every, *base, *levels, *max_edge;
    bool force, has_box;
    double box[4];
    struct shapes lines; /* owns */
    struct model model;  /* owns */
};

static bool take_line(void *ctx, const struct delaunay_part *part)
{
    if (part->kind == DELAUNAY_PART_COMMENT)
        return command_show_comment(NULL, part);
    return part->kind != DELAUNAY_PART_ROW || shapes_take(ctx, part->text, part->len);
}

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
    double power = pow(10, floor(log10(rough))), times = rough / power;
    return times < 1.5 ? power : times < 3.5 ? 2 * power : times < 7.5 ? 5 * power : 10 * power;
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
        n += (size_t)snprintf(line + n, sizeof line - n, " EVERY ");
        if (w->every != NULL)
            n += (size_t)snprintf(line + n, sizeof line - n, "%s", w->every);
        else
            n += proto_write_double(line + n, step);
        if (w->base != NULL)
            n += (size_t)snprintf(line + n, sizeof line - n, " BASE %s", w->base);
    }
    if (w->max_edge != NULL)
        n += (size_t)snprintf(line + n, sizeof line - n, " MAXEDGE %s", w->max_edge);
    return delaunay_send(c, line, n);
}

static enum delaunay_result fetch(struct delaunay_client *c, struct work *w)
{
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
        r = delaunay_receive(c, take_line, &w->lines);
    if (r == DELAUNAY_OK && strcmp(w->form, "svg") == 0)
        r = model_fetch(c, w->set, MODEL_TRIANGLES | MODEL_FIELDS, &w->model);
    return r;
}

/* ---- writing ---- */

static int write_lines(void *ctx, FILE *out)
{
    struct work *w = ctx;
    char title[300];
    if (strcmp(w->form, "wkt") == 0) {
        shapes_write_wkt(out, &w->lines);
        return EXIT_DONE;
    }
    if (strcmp(w->form, "svg") != 0) {
        shapes_write_geojson(out, &w->lines);
        return EXIT_DONE;
    }
    int field = model_field(&w->model, w->field);
    if (field < 0)
        return output_fault(w->field, "the set has no such field");
    snprintf(title, sizeof title, "%.100s: contour lines of %.100s", w->set, w->field);
    return surface_write_contours(out, title, &w->lines, &w->model, field,
                                  w->has_box ? w->box : NULL)
               ? EXIT_DONE
               : output_fault("", "out of memory");
}

static void report(const struct work *w)
{
    size_t closed = 0;
    for (size_t i = 0; i < w->lines.n; i++)
        closed += w->lines.shape[i].closed;
    if (!json_chosen()) {
        printf("%s: %zu lines, %zu of them closed\n", w->path, w->lines.n, closed);
        return;
    }
    json_begin(true);
    json_text("file", w->path);
    json_number("lines", w->lines.n);
    json_number("closed", closed);
    json_finish();
}

/* ---- arguments ---- */

static bool is_number(const char *text, size_t len)
{
    double v;
    return proto_read_double(text, len, &v);
}

static bool are_numbers(const char *text)
{
    size_t n = 0;
    for (;; text++, n++) {
        size_t len = strcspn(text, ",");
        if (!is_number(text, len) || n == MOST_LEVELS || len > PROTO_NUMBER_MAX)
            return false;
        text += len;
        if (*text == '\0')
            return true;
    }
}

static int read_option(struct work *w, int option, char **argv)
{
    if (option == 'f')
        w->form = optarg;
    else if (option == 'F')
        w->force = true;
    else if (option == 'l' && strlen(optarg) < 7000 && are_numbers(optarg))
        w->levels = optarg;
    else if (option == 'l')
        return options_wrong(argv[0], "the levels are numbers between commas, not %.100s", optarg);
    else if (option == 'v' && options_read_box(optarg, w->box))
        w->has_box = true;
    else if (option == 'v')
        return options_wrong(
            argv[0], "the viewport %s is not X0,Y0,X1,Y1 from lower left to upper right", optarg);
    else if (option != 'e' && option != 'b' && option != 'm')
        return options_unknown(argv[0], argv, option);
    else if (!is_number(optarg, strlen(optarg)) || strlen(optarg) > 40)
        return options_wrong(argv[0], "%s is no number", optarg);
    else
        *(option == 'e' ? &w->every : option == 'b' ? &w->base : &w->max_edge) = optarg;
    return EXIT_DONE;
}

static int read_arguments(struct work *w, int argc, char **argv)
{
    static const struct option options[] = {
        {"format", required_argument, NULL, 'f'},   {"every", required_argument, NULL, 'e'},
        {"base", required_argument, NULL, 'b'},     {"levels", required_argument, NULL, 'l'},
        {"max-edge", required_argument, NULL, 'm'}, {"viewport", required_argument, NULL, 'v'},
        {"force", no_argument, NULL, 'F'},          {NULL, 0, NULL, 0}};
    static const char *const forms[] = {"geojson", "json", "svg", "wkt"};
    int option, status = EXIT_DONE;
    optind = 0;
    while (status == EXIT_DONE && (option = options_next(argc, argv, "f:", options)) != -1)
        status = read_option(w, option, argv);
    if (status == EXIT_DONE && argc - optind != 3)
        status = options_wrong(argv[0], "contour takes a set, a field and a file");
    if (status == EXIT_DONE && w->levels != NULL && (w->every != NULL || w->base != NULL))
        status = options_wrong(argv[0], "--levels, or --every and --base");
    if (status != EXIT_DONE)
        return status;
    w->set = argv[optind];
    w->field = argv[optind + 1];
    w->path = argv[optind + 2];
    w->form = output_form(w->form, w->path, "geojson");
    for (int i = 0; i < 4; i++)
        if (strcmp(w->form, forms[i]) == 0)
            return output_check(w->path, w->force);
    return options_wrong(argv[0], "unknown format %s; there are geojson, svg and wkt", w->form);
}

int command_contour(struct delaunay_client *c, int argc, char **argv)
{
    struct work w = {.lines = {.kind = SHAPE_CONTOUR}};
    if (!options_name_file(argc, argv))
        return command_any(c, argc, argv);
    int status = read_arguments(&w, argc, argv);
    if (status != EXIT_DONE)
        return status;
    enum delaunay_result r = fetch(c, &w);
    if (r == DELAUNAY_STOPPED)
        status = output_fault("", w.lines.fault != NULL ? w.lines.fault : w.model.fault);
    else if (r != DELAUNAY_OK)
        status = command_outcome(c, r);
    else
        status = output_write(w.path, write_lines, &w, NULL);
    if (status == EXIT_DONE && !output_is_standard(w.path))
        report(&w);
    shapes_free(&w.lines);
    model_free(&w.model);
    return status;
}
