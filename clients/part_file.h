/* part_file.h - a file that is written as PATH.part and renamed when it is whole: nobody sees half of
 * it. */
#ifndef CLIENTS_PART_FILE_H
#define CLIENTS_PART_FILE_H

#include <stdbool.h>
#include <stdio.h>

struct part_file {
    const char *path; /* borrowed */
    char part[4096 + 8];
    FILE *out;
};

/* Opens path.part for writing. Returns NULL, or the name that errno is about. */
const char *part_file_open(struct part_file *f, const char *path);

/* Ends the writing. False if some of it failed: see errno. */
bool part_file_close(struct part_file *f);

/* After it: gives the file its name, or takes it away. */
bool part_file_keep(struct part_file *f);
void part_file_drop(struct part_file *f);

#endif
