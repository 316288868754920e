/* reading.h - what load, draw and run share: the options that say how a file is read, and how they report it. */
#ifndef CLIENTS_READING_H
#define CLIENTS_READING_H

#include "clients/cli/options.h"
#include "clients/files/source.h"

enum reading_option {
    READING_FORMAT = 300,
    READING_COLUMNS,
    READING_SKIP_BAD,
    READING_FIELDS,
    READING_NODATA,
    READING_SKIP_LINES,
    READING_NEGATE,
    READING_DRY_RUN,
    READING_POINTS,
    READING_BORDER,
    READING_OF,
    READING_SPLIT
};

#define READING_OPTIONS                                                                            \
    {"columns", required_argument, NULL, READING_COLUMNS},                                         \
        {"skip-bad", no_argument, NULL, READING_SKIP_BAD},                                         \
        {"fields", no_argument, NULL, READING_FIELDS},                                             \
        {"nodata", required_argument, NULL, READING_NODATA},                                       \
        {"skip-lines", required_argument, NULL, READING_SKIP_LINES},                               \
        {"negate", required_argument, NULL, READING_NEGATE},                                       \
        {"points", no_argument, NULL, READING_POINTS},                                             \
        {"border", no_argument, NULL, READING_BORDER},                                             \
        {"of", required_argument, NULL, READING_OF}, {"split", no_argument, NULL, READING_SPLIT},  \
    {                                                                                              \
        "dry-run", no_argument, NULL, READING_DRY_RUN                                              \
    }

struct reading {
    struct source from;
    struct points_file file;
    bool dry_run;
    bool split; /* where lines cross they get points */
};

/* Takes one of these options; a usage error's status, or EXIT_DONE. *known says whether it is one. */
int reading_option(struct reading *r, int option, char **argv, bool *known);

/* Reads the file. With --dry-run it prints how. *go_on says whether the points are to be sent; returns the exit
 * status if they are not. */
int reading_read(struct reading *r, bool *go_on);

/* Prints where coincident points have different values. */
void reading_note_coincident(struct reading *r);

/* For --json: the key "input" with what was read. */
void reading_json(const struct reading *r);

void reading_free(struct reading *r);

#endif
