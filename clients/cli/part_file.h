/* part_file.h - a file that is written as PATH.part and renamed when it is complete, so that incomplete files
 * are never visible. It gets a mark (an extended attribute with its size and time), which later identifies our
 * own unchanged files. */
#pragma once

#include <stdbool.h>
#include <stdio.h>

struct part_file {
    const char *path; /* borrowed */
    char part[4096 + 16];
    bool direct; /* a device or pipe, which is written as it is; a folder, which cannot be */
    FILE *out;
};

/* Whether there is a non-empty file of that name without a mark. */
bool part_file_is_foreign(const char *path);

/* Opens path.part for writing. Returns NULL, or the name to which errno refers. */
const char *part_file_open(struct part_file *f, const char *path);

/* Ends the writing. False if some of it failed: see errno. */
bool part_file_close(struct part_file *f);

/* Marks the file `from`, which another program has written for us, and names it `path`. */
bool part_file_adopt(const char *from, const char *path);

/* After it: marks the file and gives it its name, or removes it. */
bool part_file_keep(struct part_file *f);
void part_file_drop(struct part_file *f);
