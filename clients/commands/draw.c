/* draw.c - `delaunay draw FILE OUT` and `delaunay run FILE OUT`: from a file of points to a picture or a mesh,
 * by a private daemon. */
#include <ctype.h>
#include <inttypes.h>
#include <stdio.h>
#include <string.h>

#include "clients/cli/command.h"
#include "clients/cli/message.h"
#include "clients/cli/private_daemon.h"
#include "clients/cli/sending.h"
#include "clients/commands/export.h"
#include "proto/number.h"

static const char set[] = "points";

/* ---- the mesh may be refined before it is written ---- */

enum { REFINING_ANGLE = 400, REFINING_AREA, REFINING_LENGTH, REFINING_KEEP, REFINING_LIMIT };

#define REFINING_OPTIONS                                                                           \
    {"angle", required_argument, NULL, REFINING_ANGLE},                                            \
        {"area", required_argument, NULL, REFINING_AREA},                                          \
        {"length", required_argument, NULL, REFINING_LENGTH},                                      \
        {"keep", no_argument, NULL, REFINING_KEEP},                                                \
    {                                                                                              \
        "limit", required_argument, NULL, REFINING_LIMIT                                           \
    }

/* Start with {0}. The texts are borrowed from the arguments; NULL: not given. */
struct refining {
    const char *angle, *area, *length, *limit;
    bool keep;
};

/* Takes an option of refining. *known: it is one. */
static int refining_option(struct refining *r, int option, char **argv, bool *known)
{
    const char **to = option == REFINING_ANGLE    ? &r->angle
                      : option == REFINING_AREA   ? &r->area
                      : option == REFINING_LENGTH ? &r->length
                                                  : &r->limit;
    double v;
    *known = option >= REFINING_ANGLE && option <= REFINING_LIMIT;
    if (option == REFINING_KEEP) {
        r->keep = true;
        return EXIT_DONE;
    }
    if (!*known)
        return EXIT_DONE;
    if (!proto_read_double(optarg, strlen(optarg), &v) || !(v > 0 || option == REFINING_LIMIT))
        return options_wrong(argv[0], "a limit is a number above 0, not %s", optarg);
    *to = optarg;
    return EXIT_DONE;
}

static bool refining_asked(const struct refining *r)
{
    return r->angle != NULL || r->area != NULL || r->length != NULL;
}

/* Appends the word and its value, unless that is NULL, to line[n], which has room for `room`; returns the new n. */
static size_t put(char *line, size_t n, size_t room, const char *word, const char *value)
{
    if (value == NULL || n >= room)
        return n;
    int more = snprintf(line + n, room - n, " %s %s", word, value);
    return n + (more > 0 ? (size_t)more : 0);
}

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
static int refining_refine(struct delaunay_client *c, const struct refining *r, const char *inside)
{
    char line[400];
    int begin = snprintf(line, sizeof line, "REFINE %s%s", set, r->keep ? " KEEP" : "");
    size_t n = put(line, (size_t)begin, sizeof line, "ANGLE", r->angle);
    n = put(line, n, sizeof line, "AREA", r->area);
    n = put(line, n, sizeof line, "LENGTH", r->length);
    n = put(line, n, sizeof line, "LIMIT", r->limit);
    if (inside != NULL && strcmp(inside, "any") != 0)
        n = put(line, n, sizeof line, "INSIDE", inside);
    if (n >= sizeof line)
        return options_wrong("", "a limit has too many digits");
    enum delaunay_result result = delaunay_request(c, line, command_show_comment, NULL);
    if (result != DELAUNAY_OK)
        return command_outcome(c, result);
    report_refining(delaunay_status(c));
    return EXIT_DONE;
}

/* ---- from the file to the mesh ---- */

struct drawing {
    struct reading reading;
    struct export to;
    struct refining refining;
    bool on_terminal;
    char name[100]; /* the file's, as a title */
};

static int read_option(struct drawing *d, int option, char **argv)
{
    bool known;
    int status =
        reading_option(&d->reading, option == 'c' ? READING_COLUMNS : option, argv, &known);
    if (!known)
        status = refining_option(&d->refining, option, argv, &known);
    return known ? status : export_option(&d->to, option, argv);
}

/* The last part of the path, without characters of markup. */
static void choose_name(struct drawing *d)
{
    const char *slash = strrchr(d->reading.from.path, '/');
    snprintf(d->name, sizeof d->name, "%s", slash != NULL ? slash + 1 : d->reading.from.path);
    for (char *p = d->name; *p != '\0'; p++)
        if (strchr("<>&", *p) != NULL || iscntrl((unsigned char)*p))
            *p = '_';
}

static void put_reading(const void *ctx)
{
    reading_json(ctx);
}

static int read_arguments(struct drawing *d, int argc, char **argv)
{
    static const struct option options[] = {
        {"format", required_argument, NULL, 'f'},
        {"input-format", required_argument, NULL, READING_FORMAT},
        READING_OPTIONS,
        REFINING_OPTIONS,
        EXPORT_OPTIONS,
        {NULL, 0, NULL, 0}};
    bool draws = strcmp(argv[0], "draw") == 0;
    int option, status = EXIT_DONE;
    optind = 0;
    while (status == EXIT_DONE && (option = options_next(argc, argv, "f:c:", options)) != -1)
        status = read_option(d, option, argv);
    if (status != EXIT_DONE)
        return status;
    d->on_terminal = argc - optind == 1 && (draws || d->reading.dry_run);
    if (argc - optind != 2 && !d->on_terminal)
        return options_wrong(argv[0], draws ? "draw takes a file of points and that of the picture"
                                            : "run takes a file of points and that of the mesh");
    d->reading.from.path = argv[optind];
    choose_name(d);
    if (d->on_terminal)
        return EXIT_DONE;
    d->to.path = argv[optind + 1];
    d->to.more = put_reading;
    d->to.ctx = &d->reading;
    status = export_prepare(&d->to, argv);
    if (status == EXIT_DONE && draws && d->to.format != NULL)
        return options_wrong(argv[0],
                             "a picture is SVG or PNG; for other formats use delaunay run");
    return status;
}

static int write_result(struct delaunay_client *c, struct drawing *d)
{
    char line[40];
    char show[] = "show", name[] = "points", map[] = "--geographic",
         *words[] = {show, name, d->to.picture.geographic ? map : NULL, NULL};
    snprintf(line, sizeof line, "TRIANGULATE %s", set);
    bool done = d->reading.file.paths.n > 0; /* lines are declared in a triangulation */
    enum delaunay_result r =
        done ? DELAUNAY_OK : delaunay_request(c, line, command_show_comment, NULL);
    if (r != DELAUNAY_OK)
        return command_outcome(c, r);
    int status =
        refining_asked(&d->refining) ? refining_refine(c, &d->refining, d->to.inside) : EXIT_DONE;
    if (status != EXIT_DONE)
        return status;
    return d->on_terminal ? command_show(c, words[2] != NULL ? 3 : 2, words)
                          : export_set(c, &d->to, set, d->name);
}

static int carry_out(struct drawing *d)
{
    char why[300], line[SENDING_STATUS];
    bool go_on;
    struct private_daemon own;
    int status = reading_read(&d->reading, &go_on);
    if (!go_on)
        return status;
    if (d->reading.file.n == 0)
        return EXIT_REFUSED; /* the report says so */
    if (!private_daemon_start(&own, why, sizeof why)) {
        message_print("%s", why);
        return EXIT_NO_CONNECTION;
    }
    d->to.picture.geographic |=
        !d->to.planar && source_is_geographic(&d->reading.from, &d->reading.file);
    status = sending_send(&d->reading, own.client, set, line);
    if (status == EXIT_DONE)
        status = write_result(own.client, d);
    private_daemon_end(&own);
    return status;
}

int command_draw(struct delaunay_client *c, int argc, char **argv)
{
    struct drawing d = {.reading = {.from = {.form = SOURCE_GUESS}}};
    (void)c;
    int status = read_arguments(&d, argc, argv);
    if (status == EXIT_DONE)
        status = carry_out(&d);
    reading_free(&d.reading);
    return status;
}
