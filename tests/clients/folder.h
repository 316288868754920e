/* folder.h - a test's own folder, in which shell commands run as those of a user do. */
#pragma once

/* Its path, from folder_begin on. */
extern char folder[64];

/* Makes the folder. Needs $DELAUNAY and $DELAUNAYD. */
void folder_begin(void);

/* Removes it with all that is in it. */
void folder_finish(void);

/* Runs a shell command in the folder, in which $D is `delaunay`; nothing listens at its default address. Returns its output and
 * errors (static storage) and, in *status, its exit status. */
const char *folder_run(int *status, const char *command);

/* The command must print that and succeed. */
void folder_expect(const char *command, const char *want);
