/* load.c - `delaunay load SET FILE`: reads the whole file first, so that a bad line leaves the set
 * as it was. */
#include <errno.h>
#include <fcntl.h>
#include <getopt.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "clients/command.h"
#include "clients/points_file.h"
#include "clients/progress.h"
#include "clients/table_file.h"

enum form { FORM_XY, FORM_CSV, FORM_GEOJSON, FORM_NODE };

static const char *const form_names[] = {"xy", "csv", "geojson", "node"};

struct loading {
    const char *set, *path;
    enum form form;
    struct table_file table;
};

struct reading {
    struct progress bar;
    uint64_t size; /* bytes of the file, 0 if unknown */
};

static void show_reading(void *ctx, uint64_t bytes, size_t points)
{
    struct reading *r = ctx;
    progress_update(&r->bar, bytes, r->size, points);
}

static void show_sending(void *ctx, size_t done, size_t total)
{
    progress_update(ctx, done, total, done);
}

/* Reads the file into *f; says what is wrong if anything is. */
static bool read_points(struct points_file *f, struct loading *l)
{
    const char *path = l->path;
    bool standard = strcmp(path, "-") == 0;
    int fd = standard ? STDIN_FILENO : open(path, O_RDONLY | O_CLOEXEC);
    const char *name = standard ? "standard input" : path;
    if (fd < 0) {
        fprintf(stderr, "delaunay: %s: %s\n", name, strerror(errno));
        return false;
    }
    struct reading r = {0};
    struct stat st;
    if (fstat(fd, &st) == 0 && S_ISREG(st.st_mode))
        r.size = (uint64_t)st.st_size;
    progress_start(&r.bar, "reading");
    l->table.node = l->form == FORM_NODE;
    if (l->form == FORM_CSV || l->form == FORM_NODE)
        table_file_init(&l->table, f);
    bool ok = l->form == FORM_GEOJSON ? points_file_read_geojson(f, fd)
                                      : points_file_read(f, fd, show_reading, &r);
    progress_end(&r.bar);
    if (!standard)
        close(fd);
    if (!ok && f->line > 0)
        fprintf(stderr, "delaunay: %s:%ju: %s; nothing was loaded\n", name, (uintmax_t)f->line,
                f->fault);
    else if (!ok)
        fprintf(stderr, "delaunay: %s: %s; nothing was loaded\n", name, f->fault);
    return ok;
}

/* ---- arguments ---- */

static bool read_form(const char *name, enum form *form)
{
    for (size_t i = 0; i < sizeof form_names / sizeof form_names[0]; i++)
        if (strcmp(name, form_names[i]) == 0) {
            *form = (enum form)i;
            return true;
        }
    return false;
}

static void guess_form(struct loading *l)
{
    const char *dot = strrchr(l->path, '.');
    if (l->table.chosen)
        l->form = FORM_CSV;
    else if (dot != NULL && (strcmp(dot, ".json") == 0 || strcmp(dot, ".ndjson") == 0))
        l->form = FORM_GEOJSON;
    else if (dot != NULL)
        read_form(dot + 1, &l->form);
}

static int wrong(const char *what)
{
    fprintf(stderr, "delaunay: %s\nTry 'delaunay load --help'.\n", what);
    return EXIT_USAGE;
}

static int read_arguments(struct loading *l, int argc, char **argv)
{
    static const struct option options[] = {{"format", required_argument, NULL, 'f'},
                                            {"columns", required_argument, NULL, 'c'},
                                            {NULL, 0, NULL, 0}};
    bool named = false;
    int option;
    optind = 0;
    while ((option = getopt_long(argc, argv, "f:c:", options, NULL)) != -1) {
        if (option == 'f' && read_form(optarg, &l->form))
            named = true;
        else if (option != 'c' || !table_choose_columns(&l->table, optarg))
            return wrong("unknown option, format or columns");
    }
    if (argc - optind != 2)
        return wrong("load takes a set and a file");
    l->set = argv[optind];
    l->path = argv[optind + 1];
    if (!named)
        guess_form(l);
    return EXIT_DONE;
}

int command_load(struct delaunay_client *c, int argc, char **argv)
{
    struct points_file f = {0};
    struct loading l = {.form = FORM_XY};
    int status = read_arguments(&l, argc, argv);
    if (status != EXIT_DONE)
        return status;
    if (!read_points(&f, &l)) {
        points_file_free(&f);
        return EXIT_REFUSED;
    }
    struct progress bar;
    progress_start(&bar, "sending");
    enum delaunay_result r = delaunay_send_points(c, l.set, f.xy, f.n, show_sending, &bar);
    progress_end(&bar);
    points_file_free(&f);
    if (r == DELAUNAY_OK)
        r = delaunay_receive(c, command_show_comment, NULL);
    if (r == DELAUNAY_OK)
        puts(delaunay_status(c)->text);
    return command_outcome(c, r);
}
