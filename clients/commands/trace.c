/* trace.c - `delaunay trace SET FILE`: fetches the steps of the shelling algorithm and animates them. */
#include <stdio.h>
#include <string.h>

#include "clients/cli/json.h"
#include "clients/cli/options.h"
#include "clients/cli/output.h"
#include "clients/cli/subcommand.h"
#include "clients/pictures/animation.h"
#include "proto/number.h"

struct work {
    const char *set, *path;
    bool force;
    struct animation_options animation;
    struct model model; /* owns */
    struct steps steps; /* owns */
};

static int read_option(void *ctx, const char *option, char **argv)
{
    struct work *w = ctx;
    double *seconds = &w->animation.seconds;
    if (options_is(option, "numbers"))
        w->animation.numbers = true;
    else if (options_is(option, "force"))
        w->force = true;
    else if (!proto_read_double(optarg, strlen(optarg), seconds) ||
             !(*seconds >= 1 && *seconds <= 36000))
        return options_wrong(argv[0], "--seconds is from 1 to 36000, not %s", optarg);
    return EXIT_DONE;
}

static int read_arguments(struct work *w, int argc, char **argv)
{
    int status = options_read(argc, argv, read_option, w, 2, "a set and a file");
    if (status != EXIT_DONE)
        return status;
    w->set = argv[optind];
    w->path = argv[optind + 1];
    return output_check(w->path, w->force);
}

static bool take_row(void *ctx, const struct delaunay_part *part)
{
    if (part->kind == DELAUNAY_PART_COMMENT)
        return request_show_comment(NULL, part);
    return part->kind != DELAUNAY_PART_ROW || steps_take(ctx, part->text, part->len);
}

static enum delaunay_result fetch(struct delaunay_client *c, struct work *w)
{
    char line[100];
    enum delaunay_result r = model_fetch(c, w->set, 0, &w->model);
    w->steps.fault = w->model.fault;
    if (r == DELAUNAY_OK && w->model.n == 0) {
        w->steps.fault = "the set is empty";
        r = DELAUNAY_STOPPED;
    }
    if (r != DELAUNAY_OK)
        return r;
    snprintf(line, sizeof line, "TRACE %.64s", w->set);
    return delaunay_request(c, line, take_row, &w->steps);
}

static int write_animation(void *ctx, FILE *out)
{
    const struct work *w = ctx;
    char title[120];
    snprintf(title, sizeof title, "%.64s: circular shelling of %zu points", w->set, w->model.n);
    return animation_write(out, &w->steps, title, &w->animation)
               ? EXIT_DONE
               : output_fault("", "out of memory");
}

static void report(const struct work *w)
{
    if (!json_chosen()) {
        printf("%s: %zu points, %zu steps\n", w->path, w->model.n, w->steps.n);
        return;
    }
    json_begin(true);
    json_text("file", w->path);
    json_number("points", w->model.n);
    json_number("steps", w->steps.n);
    json_finish();
}

int command_trace(struct delaunay_client *c, int argc, char **argv)
{
    struct work w = {.steps = {.m = &w.model}};
    if (argc == 2 && argv[1][0] != '-')
        return request_send_words(c, argc, argv);
    int status = read_arguments(&w, argc, argv);
    if (status != EXIT_DONE)
        return status;
    enum delaunay_result r = fetch(c, &w);
    if (r == DELAUNAY_STOPPED)
        status = output_fault("", w.steps.fault);
    else
        status = r == DELAUNAY_OK ? output_write(w.path, write_animation, &w, NULL)
                                  : request_outcome(c, r);
    if (status == EXIT_DONE && !output_is_standard(w.path))
        report(&w);
    steps_free(&w.steps);
    model_free(&w.model);
    return status;
}
