/* trace.c - `delaunay trace SET FILE`: fetches the steps of the shelling algorithm and animates them. */
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "clients/cli/command.h"
#include "clients/cli/json.h"
#include "clients/cli/message.h"
#include "clients/cli/options.h"
#include "clients/cli/output.h"
#include "clients/cli/part_file.h"
#include "clients/pictures/film.h"
#include "proto/number.h"

struct arguments {
    const char *set, *path;
    struct film_options film;
};

static int read_arguments(struct arguments *a, int argc, char **argv)
{
    static const struct option options[] = {{"seconds", required_argument, NULL, 's'},
                                            {"numbers", no_argument, NULL, 'n'},
                                            {"force", no_argument, NULL, 'F'},
                                            {NULL, 0, NULL, 0}};
    int option;
    bool force = false;
    optind = 0;
    while ((option = options_next(argc, argv, "", options)) != -1) {
        if (option == 'n')
            a->film.numbers = true;
        else if (option == 'F')
            force = true;
        else if (option != 's')
            return options_unknown(argv[0], argv, option);
        else if (!proto_read_double(optarg, strlen(optarg), &a->film.seconds) ||
                 !(a->film.seconds >= 1 && a->film.seconds <= 36000))
            return options_wrong(argv[0], "--seconds is from 1 to 36000, not %s", optarg);
    }
    if (argc - optind != 2)
        return options_wrong(argv[0], "trace takes a set and a file");
    a->set = argv[optind];
    a->path = argv[optind + 1];
    return output_check(a->path, force);
}

static bool take_row(void *ctx, const struct delaunay_part *part)
{
    if (part->kind == DELAUNAY_PART_COMMENT)
        return command_show_comment(NULL, part);
    return part->kind != DELAUNAY_PART_ROW || steps_take(ctx, part->text, part->len);
}

static enum delaunay_result fetch(struct delaunay_client *c, const char *set, struct model *m,
                                  struct steps *t)
{
    char line[100];
    enum delaunay_result r = model_fetch(c, set, 0, m);
    t->fault = m->fault;
    if (r == DELAUNAY_OK && m->n == 0) {
        t->fault = "the set is empty";
        r = DELAUNAY_STOPPED;
    }
    if (r != DELAUNAY_OK)
        return r;
    snprintf(line, sizeof line, "TRACE %.64s", set);
    return delaunay_request(c, line, take_row, t);
}

static int failed(const char *about)
{
    message_print("%s: %s", about, strerror(errno));
    return EXIT_REFUSED;
}

static int write_film(FILE *out, const struct steps *t, const struct arguments *a)
{
    char title[120];
    snprintf(title, sizeof title, "%.64s: circular shelling of %zu points", a->set, t->m->n);
    if (film_write(out, t, title, &a->film))
        return EXIT_DONE;
    message_print("out of memory");
    return EXIT_REFUSED;
}

static void report(const struct steps *t, const struct arguments *a)
{
    if (!json_chosen()) {
        printf("%s: %zu points, %zu steps\n", a->path, t->m->n, t->n);
        return;
    }
    json_begin(true);
    json_text("file", a->path);
    json_number("points", t->m->n);
    json_number("steps", t->n);
    json_finish();
}

static int write_file(const struct steps *t, const struct arguments *a)
{
    struct part_file f;
    const char *fault = part_file_open(&f, a->path);
    if (fault != NULL)
        return failed(fault);
    int status = write_film(f.out, t, a);
    bool written = part_file_close(&f);
    if (status == EXIT_DONE && (!written || !part_file_keep(&f)))
        status = failed(a->path);
    if (status != EXIT_DONE)
        part_file_drop(&f);
    else
        report(t, a);
    return status;
}

int command_trace(struct delaunay_client *c, int argc, char **argv)
{
    struct arguments a = {0};
    struct model m = {0};
    struct steps t = {.m = &m};
    if (argc == 2 && argv[1][0] != '-')
        return command_any(c, argc, argv);
    int status = read_arguments(&a, argc, argv);
    if (status != EXIT_DONE)
        return status;
    enum delaunay_result r = fetch(c, a.set, &m, &t);
    if (r == DELAUNAY_STOPPED) {
        message_print("%s", t.fault);
        status = EXIT_REFUSED;
    } else if (r != DELAUNAY_OK) {
        status = command_outcome(c, r);
    } else if (strcmp(a.path, "-") == 0) {
        status = write_film(stdout, &t, &a);
    } else {
        status = write_file(&t, &a);
    }
    steps_free(&t);
    model_free(&m);
    return status;
}
