/* show.c - `delaunay show SET`: a drawing in the terminal. A braille character is a cell of 2 x 4
 * dots, which makes dots about square. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include "clients/cli/json.h"
#include "clients/cli/message.h"
#include "clients/cli/options.h"
#include "clients/cli/output.h"
#include "clients/cli/subcommand.h"
#include "clients/commands/show_relief.h"
#include "clients/meshes/bounds.h"
#include "clients/meshes/map_projection.h"
#include "clients/meshes/model.h"
#include "proto/number.h"

/* The later one wins within a cell. Regions have REGION_INKS colours, by their numbers. */
enum { REGION_INKS = 6 };
enum ink {
    INK_NONE,
    INK_OUTSIDE,
    INK_EDGE,
    INK_REGION,
    INK_POINT = INK_REGION + REGION_INKS,
    INK_HULL,
    INK_LINE,
    INK_BORDER
};

struct canvas {
    uint32_t columns, lines;
    bool plain, mesh, geographic;
    const char *field;         /* of heights; NULL: z if there is one */
    unsigned char *dots, *ink; /* own; a byte for each cell */
    double x0, y1, scale;      /* left, upper edge; dots per unit */
};

static void plot(struct canvas *v, long x, long y, enum ink ink)
{
    /* The bit of each dot of a cell, as Unicode numbers them. */
    static const unsigned char bit[4][2] = {{0x01, 0x08}, {0x02, 0x10}, {0x04, 0x20}, {0x40, 0x80}};
    if (x < 0 || y < 0 || x >= 2 * (long)v->columns || y >= 4 * (long)v->lines)
        return;
    size_t cell = (size_t)(y / 4) * v->columns + (size_t)(x / 2);
    v->dots[cell] |= bit[y % 4][x % 2];
    if (ink > v->ink[cell])
        v->ink[cell] = (unsigned char)ink;
}

static long dot_x(const struct canvas *v, const double *p)
{
    return lround((p[0] - v->x0) * v->scale);
}

static long dot_y(const struct canvas *v, const double *p)
{
    return lround((v->y1 - p[1]) * v->scale);
}

static void draw_line(struct canvas *v, const double *p, const double *q, enum ink ink)
{
    long x = dot_x(v, p), y = dot_y(v, p), dx = dot_x(v, q) - x, dy = dot_y(v, q) - y;
    long steps = labs(dx) > labs(dy) ? labs(dx) : labs(dy);
    for (long i = 0; i <= steps; i++)
        plot(v, x + lround((double)(dx * i) / (double)(steps > 0 ? steps : 1)),
             y + lround((double)(dy * i) / (double)(steps > 0 ? steps : 1)), ink);
}

/* Chooses the scale so that all points fit, and removes empty lines. */
static void fit(struct canvas *v, const struct model *m)
{
    double box[4] = {0};
    bounds_of(m->xy, m->n, box);
    double dots_x = 2.0 * v->columns - 1, dots_y = 4.0 * v->lines - 1, wide = box[2] - box[0],
           high = box[3] - box[1];
    v->scale = fmin(wide > 0 ? dots_x / wide : dots_x, high > 0 ? dots_y / high : dots_y);
    v->x0 = box[0];
    v->y1 = box[3];
    uint32_t lines = (uint32_t)lround(high * v->scale) / 4 + 1;
    if (lines < v->lines)
        v->lines = lines;
}

/* With more edges than this a cell would only be full. */
static bool is_readable(const struct canvas *v, size_t edges)
{
    return edges <= 3 * (size_t)v->columns * v->lines;
}

static void draw_edges(struct canvas *v, const struct model *m)
{
    for (size_t i = 0; i < m->edges; i++)
        draw_line(v, m->xy + 2 * (size_t)m->edge[2 * i], m->xy + 2 * (size_t)m->edge[2 * i + 1],
                  m->regions ? INK_OUTSIDE : INK_EDGE);
}

/* The sides of the triangles that borders enclose. */
static void draw_regions(struct canvas *v, const struct model *m)
{
    for (size_t i = 0; i < 3 * m->triangles; i++) {
        const uint32_t *corner = m->triangle + i - i % 3;
        int64_t region = m->region[i / 3];
        if (region != MODEL_OUTSIDE)
            draw_line(v, m->xy + 2 * (size_t)corner[i % 3], m->xy + 2 * (size_t)corner[(i + 1) % 3],
                      (enum ink)(INK_REGION + region % REGION_INKS));
    }
}

static void draw(struct canvas *v, const struct model *m)
{
    if (is_readable(v, m->edges))
        draw_edges(v, m);
    if (m->regions && is_readable(v, m->edges))
        draw_regions(v, m);
    for (size_t i = 0; i < m->n; i++)
        plot(v, dot_x(v, m->xy + 2 * i), dot_y(v, m->xy + 2 * i), INK_POINT);
    for (size_t i = 0; i < m->hull_n; i++) {
        size_t next = i + 1 < m->hull_n ? i + 1 : m->edges < m->hull_n ? i : 0;
        draw_line(v, m->xy + 2 * (size_t)m->hull[i], m->xy + 2 * (size_t)m->hull[next], INK_HULL);
    }
    for (size_t i = 0; i < m->constraints; i++)
        draw_line(v, m->xy + 2 * (size_t)m->constraint[3 * i],
                  m->xy + 2 * (size_t)m->constraint[3 * i + 1],
                  model_is_border(m, i) ? INK_BORDER : INK_LINE);
}

static void print_cell(unsigned char dots)
{
    if (dots == 0)
        putchar(' ');
    else /* U+2800 + dots */
        printf("\xE2%c%c", 0xA0 + (dots >> 6), 0x80 + (dots & 0x3F));
}

static void print(const struct canvas *v)
{
    static const char *const colour[] = {[INK_OUTSIDE] = "\033[2;37m",
                                         [INK_EDGE] = "\033[2;34m",
                                         [INK_REGION] = "\033[34m",
                                         "\033[32m",
                                         "\033[36m",
                                         "\033[33m",
                                         "\033[35m",
                                         "\033[31m",
                                         [INK_POINT] = "\033[1;33m",
                                         [INK_HULL] = "\033[31m",
                                         [INK_LINE] = "\033[1;36m",
                                         [INK_BORDER] = "\033[1;35m"};
    for (size_t y = 0; y < v->lines; y++) {
        unsigned char last = INK_NONE;
        for (size_t x = 0; x < v->columns; x++) {
            unsigned char ink = v->ink[y * v->columns + x];
            if (!v->plain && ink != last)
                printf("\033[0m%s", ink != INK_NONE ? colour[ink] : "");
            last = ink;
            print_cell(v->dots[y * v->columns + x]);
        }
        fputs(v->plain || last == INK_NONE ? "\n" : "\033[0m\n", stdout);
    }
}

static void print_json(const struct canvas *v)
{
    json_begin(true);
    json_key("lines");
    for (size_t y = 0; y < v->lines; y++) {
        fputs(y == 0 ? "[\"" : ",\"", stdout);
        for (size_t x = 0; x < v->columns; x++)
            print_cell(v->dots[y * v->columns + x]);
        putchar('"');
    }
    putchar(']');
    json_finish();
}

static bool read_size(const char *text, uint32_t *v)
{
    return proto_read_u32(text, strlen(text), v) && *v >= 1 && *v <= 2000;
}

static int read_option(void *ctx, const char *option, char **argv)
{
    struct canvas *v = ctx;
    if (options_is(option, "plain"))
        v->plain = true;
    else if (options_is(option, "mesh"))
        v->mesh = true;
    else if (options_is(option, "field"))
        v->field = optarg;
    else if (options_is(option, "geographic"))
        v->geographic = true;
    else if (!read_size(optarg, options_is(option, "width") ? &v->columns : &v->lines))
        return options_wrong(argv[0], "a width or height is from 1 to 2000, not %s", optarg);
    return EXIT_DONE;
}

static int read_arguments(struct canvas *v, int argc, char **argv)
{
    struct winsize size;
    if (ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0 && size.ws_row > 1) {
        v->columns = size.ws_col;
        v->lines = size.ws_row - 1u;
    }
    v->plain = output_is_plain();
    return options_read(argc, argv, read_option, v, 1, "a set");
}

static bool has_borders(const struct model *m)
{
    for (size_t i = 0; i < m->constraints; i++)
        if (model_is_border(m, i))
            return true;
    return false;
}

static enum delaunay_result draw_canvas(struct canvas *v, const struct model *m)
{
    enum delaunay_result r = DELAUNAY_NOMEM;
    fit(v, m);
    v->dots = calloc((size_t)v->columns * v->lines, 1);
    v->ink = calloc((size_t)v->columns * v->lines, 1);
    if (v->dots != NULL && v->ink != NULL) {
        draw(v, m);
        json_chosen() ? print_json(v) : print(v);
        r = DELAUNAY_OK;
    }
    free(v->dots);
    free(v->ink);
    return r;
}

static int show_mesh(struct delaunay_client *c, const char *set, struct canvas *v)
{
    struct model m = {0};
    int status = EXIT_REFUSED;
    enum delaunay_result r = model_fetch(c, set, MODEL_EDGES | MODEL_HULL | MODEL_CONSTRAINTS, &m);
    if (r == DELAUNAY_OK && has_borders(&m))
        r = model_fetch(c, set, MODEL_MESH | MODEL_CONSTRAINTS | MODEL_REGIONS, &m);
    struct map_projection d;
    if (r == DELAUNAY_OK && v->geographic && !map_projection_choose(&d, m.xy, m.n)) {
        status = output_fault("", "--geographic: there are latitudes beyond 90 degrees");
    } else {
        if (r == DELAUNAY_OK && v->geographic)
            map_projection_project(&d, m.xy, m.n);
        if (r == DELAUNAY_OK)
            r = draw_canvas(v, &m);
        if (r == DELAUNAY_STOPPED)
            message_print("%s", m.fault);
        else
            status = request_outcome(c, r);
    }
    model_free(&m);
    return status;
}

static bool find_heights(void *ctx, const struct delaunay_part *part)
{
    bool *found = ctx;
    *found |= part->kind == DELAUNAY_PART_ROW && part->len > 2 && memcmp(part->text, "z ", 2) == 0;
    return true;
}

static bool find_triangles(void *ctx, const struct delaunay_part *part)
{
    static const char none[] = " triangles=0 ";
    bool *found = ctx;
    *found |=
        part->kind == DELAUNAY_PART_OK && memmem(part->text, part->len, none, strlen(none)) == NULL;
    return true;
}

/* Whether `find` finds something in the reply. Faults of the set are reported later. */
static bool finds(struct delaunay_client *c, const char *command, const char *set,
                  delaunay_part_fn *find)
{
    char line[120];
    bool found = false;
    snprintf(line, sizeof line, "%s %.100s", command, set);
    return delaunay_request(c, line, find, &found) == DELAUNAY_OK && found;
}

int command_show(struct delaunay_client *c, int argc, char **argv)
{
    struct canvas v = {.columns = 80, .lines = 23};
    int status = read_arguments(&v, argc, argv);
    if (status != EXIT_DONE)
        return status;
    const char *set = argv[optind], *field = v.field;
    /* Points on a line, or fewer than three, have no surface that could be seen. */
    if (field == NULL && !v.mesh && finds(c, "FIELDS", set, find_heights) &&
        finds(c, "STAT", set, find_triangles))
        field = "z";
    return field != NULL ? show_relief(c, set, field, v.columns, v.lines, v.plain, v.geographic)
                         : show_mesh(c, set, &v);
}
