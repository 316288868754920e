/* input.h - opens a file, or the standard input, for reading; compressed files and UTF-16 are read through
 * another program, archives by zip_file.h. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <sys/types.h>

struct input {
    int fd;
    bool standard;       /* fd is not ours to close */
    pid_t child;         /* the program that converts, 0 if none does */
    const char *program; /* its name */
    char first;          /* the first non-blank character, 0 if unknown */
    bool las;            /* it begins as LAS and LAZ do, */
    bool grid;           /* as an ASCII grid does */
    bool raster;         /* it begins, or its name ends, as rasters do that GDAL reads */
    char member[256];    /* the name of the file in an archive, "" if it is none */
    uint64_t size;       /* bytes to read, 0 if unknown */
};

/* Opens the path, "-" for the standard input. False with a sentence in why[room] on failure. */
bool input_open(struct input *in, const char *path, char *why, size_t room);

/* Closes it; false with a sentence in why[room] if a converting program failed. `all`: everything was read. */
bool input_close(struct input *in, bool all, char *why, size_t room);
