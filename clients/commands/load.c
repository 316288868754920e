/* load.c - `delaunay load SET FILE`: reads the whole file first, so that a bad line leaves the set
 * as it was. */
#include <stdio.h>
#include <string.h>

#include "clients/cli/json.h"
#include "clients/cli/sending.h"
#include "clients/cli/subcommand.h"

static int read_option(void *ctx, const char *option, char **argv)
{
    bool known;
    return file_options_take(ctx, option, argv, &known);
}

static int read_arguments(struct file_options *r, const char **set, int argc, char **argv)
{
    int status = options_read(argc, argv, read_option, r, 2, "a set and a file");
    if (status != EXIT_DONE)
        return status;
    *set = argv[optind];
    r->from.path = argv[optind + 1];
    return EXIT_DONE;
}

static void print_status(const struct file_options *r, const char *status)
{
    struct json_reply j = {.rows = 0};
    if (!json_chosen()) {
        puts(status);
        return;
    }
    json_part(&j, &(struct delaunay_part){DELAUNAY_PART_OK, status, strlen(status), true});
    file_options_json(r);
    json_end(&j);
}

static int load(struct delaunay_client *c, struct file_options *r, const char *set)
{
    bool go_on;
    char line[SENDING_STATUS];
    int status = file_options_read(r, &go_on);
    if (!go_on)
        return status;
    status = sending_send(r, c, set, line);
    if (status == EXIT_DONE)
        print_status(r, line);
    return status;
}

int command_load(struct delaunay_client *c, int argc, char **argv)
{
    struct file_options r = {.from = {.form = SOURCE_GUESS}};
    const char *set = NULL;
    int status = read_arguments(&r, &set, argc, argv);
    if (status == EXIT_DONE)
        status = load(c, &r, set);
    file_options_free(&r);
    return status;
}
