/* draw.c - `delaunay draw FILE OUT` and `delaunay run FILE OUT`: from a file of points to a picture or a mesh,
 * by a private daemon. */
#include <ctype.h>
#include <float.h>
#include <inttypes.h>
#include <stdio.h>
#include <string.h>

#include "clients/cli/json.h"
#include "clients/cli/message.h"
#include "clients/cli/private_daemon.h"
#include "clients/cli/sending.h"
#include "clients/cli/subcommand.h"
#include "clients/commands/export.h"
#include "clients/lib/words.h"
#include "proto/number.h"

static const char all_points[] = "points", few_points[] = "light";

/* ---- limits: points may be left out, and then the mesh may be refined ---- */

/* Start with {0}. The texts are borrowed from the arguments; NULL: not given. */
struct limits {
    const char *error, *most;                  /* of simplifying */
    const char *angle, *area, *length, *limit; /* of refining */
    bool keep;
    double reached; /* by how much the worst point is off; after simplify */
};

/* Takes an option of limits. *known: it is one. */
static int limits_option(struct limits *l, const char *option, char **argv, bool *known)
{
    const struct {
        const char *name, **to;
        double least;
        bool whole;
        const char *says;
    } rows[] = {{"error", &l->error, 0, false, "--error is a height from 0 on"},
                {"most", &l->most, 1, true, "--most is a number of points"},
                {"angle", &l->angle, DBL_TRUE_MIN, false, "a limit is a number above 0"},
                {"area", &l->area, DBL_TRUE_MIN, false, "a limit is a number above 0"},
                {"length", &l->length, DBL_TRUE_MIN, false, "a limit is a number above 0"},
                {"limit", &l->limit, 0, true, "--limit is a number of points"}};
    double v;
    uint32_t whole;
    *known = options_is(option, "keep");
    l->keep |= *known;
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        if (!options_is(option, rows[i].name))
            continue;
        *known = true;
        *rows[i].to = optarg;
        if (!proto_read_double(optarg, strlen(optarg), &v) || v < rows[i].least ||
            (rows[i].whole && !proto_read_u32(optarg, strlen(optarg), &whole)))
            return options_wrong(argv[0], "%s, not %s", rows[i].says, optarg);
    }
    return EXIT_DONE;
}

static bool refines(const struct limits *l)
{
    return l->angle != NULL || l->area != NULL || l->length != NULL;
}

static bool simplifies(const struct limits *l)
{
    return l->error != NULL || l->most != NULL;
}

/* ---- refining ---- */

static void report_refining(const struct delaunay_part *status)
{
    const char *angle;
    size_t len;
    uint64_t added = 0, unrefined = 0, hull = 0;
    delaunay_key_number(status, "added", &added);
    delaunay_key_number(status, "unrefined", &unrefined);
    delaunay_key_number(status, "hull", &hull);
    if (hull > 0)
        fprintf(stderr, "delaunay: there is no border, so the hull is one\n");
    if (delaunay_key(status, "angle", &angle, &len))
        fprintf(stderr, "delaunay: %" PRIu64 " points added; the least angle is %.*s degrees\n",
                added, (int)(len > 6 ? 6 : len), angle);
    if (unrefined > 0)
        fprintf(stderr,
                "delaunay: triangles that are not as wanted: %" PRIu64
                "; sharp corners stay, and at most --limit points are added\n",
                unrefined);
}

/* Refines the triangulated set inside the border (`any`; NULL: the same), and says what is left. Returns the exit status. */
static int refine(struct delaunay_client *c, const char *set, const struct limits *r,
                  const char *inside)
{
    char line[400];
    int begin = snprintf(line, sizeof line, "REFINE %s%s", set, r->keep ? " KEEP" : "");
    size_t n = words_put(line, (size_t)begin, sizeof line, "ANGLE", r->angle);
    n = words_put(line, n, sizeof line, "AREA", r->area);
    n = words_put(line, n, sizeof line, "LENGTH", r->length);
    n = words_put(line, n, sizeof line, "LIMIT", r->limit);
    if (inside != NULL && strcmp(inside, "any") != 0)
        n = words_put(line, n, sizeof line, "INSIDE", inside);
    if (n >= sizeof line)
        return options_wrong("", "a limit has too many digits");
    enum delaunay_result result = delaunay_request(c, line, request_show_comment, NULL);
    if (result != DELAUNAY_OK)
        return request_outcome(c, result);
    report_refining(delaunay_status(c));
    return EXIT_DONE;
}

/* ---- simplifying ---- */

static bool has_field(const struct table_fields *t, const char *field)
{
    for (size_t i = 0; i < t->n; i++)
        if (strcmp(t->name[i], field) == 0)
            return true;
    return false;
}

/* Makes the set of few points of the set of all, which the file had, and says how many are left. Returns the exit status. */
static int simplify(struct delaunay_client *c, struct limits *s, const struct file_options *from,
                    const char *field)
{
    char line[400];
    const char *text;
    size_t len;
    uint64_t kept = 0;
    if (!has_field(&from->from.table.fields, field)) {
        message_print("--error and --most need heights, a field %s of the points: choose it with "
                      "--columns X,Y,Z, or with --fields --field F",
                      field);
        return EXIT_REFUSED;
    }
    int begin = snprintf(line, sizeof line, "SIMPLIFY %s %.100s", all_points, field);
    size_t n =
        words_put(line, (size_t)begin, sizeof line, "ERROR", s->error != NULL ? s->error : "0");
    n = words_put(line, n, sizeof line, "POINTS", s->most);
    n = words_put(line, n, sizeof line, "INTO", few_points);
    if (n >= sizeof line)
        return options_wrong("", "a limit has too many digits");
    enum delaunay_result result = delaunay_request(c, line, request_show_comment, NULL);
    if (result != DELAUNAY_OK)
        return request_outcome(c, result);
    delaunay_key_number(delaunay_status(c), "points", &kept);
    if (delaunay_key(delaunay_status(c), "error", &text, &len))
        proto_read_double(text, len, &s->reached);
    fprintf(stderr,
            "delaunay: %" PRIu64
            " of %zu points are kept; the worst of the others is off by %.6g\n",
            kept, from->file.n, s->reached);
    return EXIT_DONE;
}

/* ---- from the file to the mesh ---- */

struct drawing {
    struct file_options input;
    struct export to;
    struct limits limits;
    bool on_terminal;
    char name[100]; /* the file's, as a title */
};

/* --format is that of the picture or mesh, --input-format that of the file. */
static int read_option(void *ctx, const char *option, char **argv)
{
    struct drawing *d = ctx;
    bool known = false;
    int status = EXIT_DONE;
    if (options_is(option, "input-format"))
        return file_options_take(&d->input, "format", argv, &known);
    if (!options_is(option, "format"))
        status = file_options_take(&d->input, option, argv, &known);
    if (!known)
        status = limits_option(&d->limits, option, argv, &known);
    return known ? status : export_option(&d->to, option, argv);
}

/* The last part of the path, without characters of markup. */
static void choose_name(struct drawing *d)
{
    const char *slash = strrchr(d->input.from.path, '/');
    snprintf(d->name, sizeof d->name, "%s", slash != NULL ? slash + 1 : d->input.from.path);
    for (char *p = d->name; *p != '\0'; p++)
        if (strchr("<>&", *p) != NULL || iscntrl((unsigned char)*p))
            *p = '_';
}

/* Writes the part of the report in JSON about the file, and about what has been left out. */
static void put_more(const void *ctx)
{
    const struct drawing *d = ctx;
    file_options_json(&d->input);
    if (simplifies(&d->limits)) {
        json_key("error");
        printf("%.17g", d->limits.reached);
    }
}

static int read_arguments(struct drawing *d, int argc, char **argv)
{
    bool draws = strcmp(argv[0], "draw") == 0;
    int status = options_read(argc, argv, read_option, d, -1, NULL);
    if (status != EXIT_DONE)
        return status;
    d->on_terminal = argc - optind == 1 && (draws || d->input.dry_run);
    if (argc - optind != 2 && !d->on_terminal)
        return options_wrong(argv[0], draws ? "draw takes a file of points and that of the picture"
                                            : "run takes a file of points and that of the mesh");
    d->input.from.path = argv[optind];
    choose_name(d);
    if (d->on_terminal)
        return d->input.dry_run ? EXIT_DONE : options_suit(argv, "HEIGHTS");
    d->to.path = argv[optind + 1];
    d->to.more = put_more;
    d->to.ctx = d;
    status = export_prepare(&d->to, argv);
    if (status == EXIT_DONE && draws && d->to.format != NULL)
        return options_wrong(argv[0],
                             "a picture is SVG or PNG; for other formats use delaunay run");
    return status;
}

/* Lines are declared in a triangulation, so a set with lines has one; the set of few points has none. */
static int triangulate(struct delaunay_client *c, const struct drawing *d, const char *set)
{
    char line[40];
    if (d->input.file.paths.n > 0 && set == all_points)
        return EXIT_DONE;
    snprintf(line, sizeof line, "TRIANGULATE %s", set);
    enum delaunay_result r = delaunay_request(c, line, request_show_comment, NULL);
    return r == DELAUNAY_OK ? EXIT_DONE : request_outcome(c, r);
}

/* In the terminal. */
static int show_set(struct delaunay_client *c, const char *set, const struct drawing *d)
{
    char show[] = "show", name[20], map[] = "--geographic", field[100], *words[5] = {show, name};
    int n = 2;
    snprintf(name, sizeof name, "%s", set);
    if (d->to.picture.geographic)
        words[n++] = map;
    if (d->to.field != NULL) {
        snprintf(field, sizeof field, "--field=%s", d->to.field);
        words[n++] = field;
    }
    return command_show(c, n, words);
}

static int write_result(struct delaunay_client *c, struct drawing *d)
{
    const char *set = simplifies(&d->limits) ? few_points : all_points;
    const char *field = d->to.field != NULL ? d->to.field : "z";
    int status = EXIT_DONE;
    if (set == few_points)
        status = simplify(c, &d->limits, &d->input, field);
    if (status == EXIT_DONE)
        status = triangulate(c, d, set);
    if (status == EXIT_DONE && refines(&d->limits))
        status = refine(c, set, &d->limits, d->to.inside);
    if (status != EXIT_DONE)
        return status;
    return d->on_terminal ? show_set(c, set, d) : export_set(c, &d->to, set, d->name);
}

static int carry_out(struct drawing *d)
{
    char why[300], line[SENDING_STATUS];
    bool go_on;
    struct private_daemon own;
    int status = file_options_read(&d->input, &go_on);
    if (!go_on)
        return status;
    if (d->input.file.n == 0)
        return EXIT_REFUSED; /* the report says so */
    if (!private_daemon_start(&own, why, sizeof why)) {
        message_print("%s", why);
        return EXIT_NO_CONNECTION;
    }
    d->to.picture.geographic |=
        !d->to.planar && source_is_geographic(&d->input.from, &d->input.file);
    status = sending_send(&d->input, own.client, all_points, line);
    if (status == EXIT_DONE)
        status = write_result(own.client, d);
    private_daemon_end(&own);
    return status;
}

int command_draw(struct delaunay_client *c, int argc, char **argv)
{
    struct drawing d = {.input = {.from = {.form = SOURCE_GUESS}}};
    int status = read_arguments(&d, argc, argv);
    if (status == EXIT_DONE)
        status = carry_out(&d);
    file_options_free(&d.input);
    return status;
}
