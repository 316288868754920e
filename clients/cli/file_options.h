/* file_options.h - what load, draw and run share: the options that say how a file is read, and how they report it. */
#pragma once

#include "clients/cli/options.h"
#include "clients/files/source.h"

struct file_options {
    struct source from;
    struct points_file file;
    bool dry_run;
    bool split; /* where lines cross they get points */
};

/* Takes an option of load; a usage error's status, or EXIT_DONE. *known says whether it is one. */
int file_options_take(struct file_options *r, const char *option, char **argv, bool *known);

/* Reads the file. With --dry-run it prints how. *go_on says whether the points are to be sent; returns the exit
 * status if they are not. */
int file_options_read(struct file_options *r, bool *go_on);

/* Prints where coincident points have different values. */
void file_options_note_coincident(struct file_options *r);

/* For --json: the key "input" with what was read. */
void file_options_json(const struct file_options *r);

void file_options_free(struct file_options *r);
