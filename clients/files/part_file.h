/* part_file.h - a file that is written as PATH.part and renamed when it is whole: nobody sees half of
 * it. It gets a mark (an extended attribute with its size and time), so that it is known later whether a
 * file is one of ours that nobody has changed. */
#ifndef CLIENTS_PART_FILE_H
#define CLIENTS_PART_FILE_H

#include <stdbool.h>
#include <stdio.h>

struct part_file {
    const char *path; /* borrowed */
    char part[4096 + 16];
    bool direct; /* a device or pipe, which is written as it is */
    FILE *out;
};

/* Whether there is a file of that name that holds something and has no mark. */
bool part_file_is_foreign(const char *path);

/* Says on the standard error that it is one. */
void part_file_refuse(const char *path);

/* Opens path.part for writing. Returns NULL, or the name that errno is about. */
const char *part_file_open(struct part_file *f, const char *path);

/* Ends the writing. False if some of it failed: see errno. */
bool part_file_close(struct part_file *f);

/* Marks the file `from`, which another program has written for us, and names it `path`. */
bool part_file_adopt(const char *from, const char *path);

/* After it: marks the file and gives it its name, or removes it. */
bool part_file_keep(struct part_file *f);
void part_file_drop(struct part_file *f);

#endif
