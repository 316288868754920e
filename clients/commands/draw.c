/* draw.c - `delaunay draw FILE OUT` and `delaunay run FILE OUT`: from a file of points to a picture or a mesh,
 * by a private daemon. */
#include <ctype.h>
#include <stdio.h>
#include <string.h>

#include "clients/cli/command.h"
#include "clients/cli/message.h"
#include "clients/cli/private_daemon.h"
#include "clients/cli/sending.h"
#include "clients/commands/export.h"
#include "clients/commands/refining.h"

static const char set[] = "points";

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
    int status = refining_asked(&d->refining) ? refining_refine(c, &d->refining, set, d->to.inside)
                                              : EXIT_DONE;
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
