/* load.c - `delaunay load SET FILE`: reads the whole file first, so that a bad line leaves the set
 * as it was. */
#include <stdio.h>

#include "clients/cli/command.h"
#include "clients/cli/message.h"
#include "clients/cli/options.h"
#include "clients/files/progress.h"
#include "clients/files/source.h"

static void show_sending(void *ctx, size_t done, size_t total)
{
    progress_update(ctx, done, total, done);
}

enum delaunay_result command_send_points(struct delaunay_client *c, const char *set,
                                         const struct points_file *f, const struct source *s)
{
    const struct table_fields *t = &s->table.fields;
    char names[FIELDS_MOST * (FIELDS_NAME + 1)] = "";
    struct progress bar;
    for (size_t i = 0, n = 0; i < f->fields; i++)
        n += (size_t)snprintf(names + n, sizeof names - n, "%s%s", i > 0 ? "," : "", t->name[i]);
    progress_start(&bar, "sending");
    enum delaunay_result r =
        delaunay_send_values(c, set, names, f->xy, f->value, f->n, show_sending, &bar);
    progress_end(&bar);
    return r == DELAUNAY_OK ? delaunay_receive(c, command_show_comment, NULL) : r;
}

bool command_read_points(struct source *s, struct points_file *f)
{
    bool ok = source_read(s, f);
    if (!ok && f->line > 0)
        message_keep("%s:%ju: %s", s->path, (uintmax_t)f->line, f->fault);
    else if (!ok)
        message_keep("%s: %s", s->path, f->fault);
    return ok;
}

static int read_arguments(struct source *s, const char **set, int argc, char **argv)
{
    static const struct option options[] = {{"format", required_argument, NULL, 'f'},
                                            {"columns", required_argument, NULL, 'c'},
                                            {"skip-bad", no_argument, NULL, 's'},
                                            {"fields", no_argument, NULL, 'a'},
                                            {NULL, 0, NULL, 0}};
    int option;
    optind = 0;
    while ((option = options_next(argc, argv, "f:c:", options)) != -1) {
        if (option == 's')
            s->skip_bad = true;
        else if (option == 'a')
            s->table.fields.all = true;
        else if (option == 'f' && !source_read_form(optarg, s))
            return options_wrong(
                argv[0], "unknown format %s; there are xy, csv, geojson, node, xyz", optarg);
        else if (option == 'c' && !table_choose_columns(&s->table, optarg))
            return options_wrong(
                argv[0], "--columns %s is not X,Y or X,Y,Z: names, or numbers from 1", optarg);
        else if (option != 'f' && option != 'c')
            return options_unknown(argv[0], argv, option);
    }
    if (argc - optind != 2)
        return options_wrong(argv[0], "load takes a set and a file");
    *set = argv[optind];
    s->path = argv[optind + 1];
    return EXIT_DONE;
}

int command_load(struct delaunay_client *c, int argc, char **argv)
{
    struct points_file f = {0};
    struct source s = {.form = SOURCE_GUESS};
    const char *set = NULL;
    int status = read_arguments(&s, &set, argc, argv);
    if (status != EXIT_DONE)
        return status;
    if (!command_read_points(&s, &f)) {
        points_file_free(&f);
        return EXIT_REFUSED;
    }
    enum delaunay_result r = command_send_points(c, set, &f, &s);
    points_file_free(&f);
    if (r == DELAUNAY_OK)
        command_print_status(c);
    return command_outcome(c, r);
}
