/* reading.h - what load, draw and run share: the options that say how a file is read, and how they report it. */
#ifndef CLIENTS_READING_H
#define CLIENTS_READING_H

#include "clients/cli/options.h"
#include "clients/files/source.h"
#include "clients/lib/delaunay_client.h"

enum reading_option {
    READING_FORMAT = 300,
    READING_COLUMNS,
    READING_SKIP_BAD,
    READING_FIELDS,
    READING_NODATA,
    READING_SKIP_LINES,
    READING_NEGATE,
    READING_DRY_RUN
};

#define READING_OPTIONS                                                                            \
    {"columns", required_argument, NULL, READING_COLUMNS},                                         \
        {"skip-bad", no_argument, NULL, READING_SKIP_BAD},                                         \
        {"fields", no_argument, NULL, READING_FIELDS},                                             \
        {"nodata", required_argument, NULL, READING_NODATA},                                       \
        {"skip-lines", required_argument, NULL, READING_SKIP_LINES},                               \
        {"negate", required_argument, NULL, READING_NEGATE},                                       \
    {                                                                                              \
        "dry-run", no_argument, NULL, READING_DRY_RUN                                              \
    }

struct reading {
    struct source from;
    struct points_file file;
    bool dry_run;
};

/* Takes one of these options; a usage error's status, or EXIT_DONE. *known says whether it is one. */
int reading_option(struct reading *r, int option, char **argv, bool *known);

/* Reads the file. With --dry-run it prints how. *go_on says whether the points are to be sent; returns the exit
 * status if they are not. */
int reading_read(struct reading *r, bool *go_on);

/* Sends the points with their fields into a set, with a progress bar, receives the reply, and says where coincident points have
 * different values. */
enum delaunay_result reading_send(struct reading *r, struct delaunay_client *c, const char *set);

/* For --json: the key "input" with what was read. */
void reading_json(const struct reading *r);

void reading_free(struct reading *r);

#endif
