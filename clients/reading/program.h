/* program.h - another program, whose output is read: a file format that it knows becomes one that we know; or which is run to its end. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <sys/types.h>

enum { PROGRAM_WORDS = 16, PROGRAM_MISSING = 127 };

/* Starts word[0], searched for in $PATH, with these words, at most PROGRAM_WORDS and then NULL. The program reads
 * `in`, or our standard input if that is -1. The caller reads its output from *out, and closes it. apart: it gets a process group of its
 * own, so that ^C does not end it. GZIP leaves the environment. Returns 0 or an errno. */
int program_start(pid_t *pid, const char *const *word, int in, int *out, bool apart);

/* Waits until it has ended. Returns 0 if it has succeeded. */
int program_end(pid_t pid);

/* Runs a program with these words, and our output, and waits for it. Returns its exit status; PROGRAM_MISSING if there is no such
 * program; -1 if it was killed or could not be started. */
int program_run(const char *const *word);
