/* output.h - the file that a subcommand writes: complete or not at all; it never replaces a file that another
 * program wrote. */
#pragma once

#include <stdbool.h>
#include <stdio.h>

/* Print a message on the standard error, after "ABOUT: " unless that is "", or the text of errno for a file;
 * both return EXIT_REFUSED. */
int output_fault(const char *about, const char *what);
int output_failed(const char *path);

/* Whether the standard output takes no colours: it is not a terminal, or NO_COLOR is set. */
bool output_is_plain(void);

/* Whether the path is "-", the standard output; and whether it may be written: with `force` always, else if no other
 * program's file is there, which is said. Returns the exit status. */
bool output_is_standard(const char *path);
int output_check(const char *path, bool force);

/* The format that the user named, or the path's ending, or `standard` if it has none. */
const char *output_form(const char *named, const char *path, const char *standard);

/* The name of a file beside the one at `path`: PATH with this ending in place of its own. False if there is no room. */
bool output_beside(const char *path, const char *ending, char *to, size_t room);

enum { OUTPUT_PATH = 4096 };

/* The same, and whether that file may be written. Returns the exit status. */
int output_check_beside(const char *path, const char *ending, bool force, char to[OUTPUT_PATH]);

/* Writes into `out`; returns the exit status, after a message if it fails. */
typedef int output_write_fn(void *ctx, FILE *out);

/* Turns the file at `part` into what will be called `path`, in its place. Returns the exit status. */
typedef int output_convert_fn(const char *part, const char *path);

/* Writes the file, converts it unless convert is NULL, and gives it its name. On any failure there is no new
 * file. Returns the exit status. */
int output_write(const char *path, output_write_fn *write, void *ctx, output_convert_fn *convert);
