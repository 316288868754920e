/* own_file.h - opens files in a directory of the daemon: regular files that belong to its user, or to the owner of the
 * directory, and never through a symbolic link. Another user who may write in the directory cannot make the daemon read, wait
 * for or change anything else. */
#pragma once

#include <stdbool.h>

/* Opens the file, which exists already; `flags` are those of open(2). -1 with errno: EINVAL if it is refused; then a message
 * on standard error says why. */
int own_file_open(int dir, const char *name, int flags);

/* Creates an empty file, in place of one of that name. -1 with errno. */
int own_file_create(int dir, const char *name, int flags);

/* Closes the descriptor, unless it is -1; returns `ok` and preserves errno. */
bool own_file_close(int fd, bool ok);

/* Whether there is no such name, or a file that own_file_open does not refuse; with `folder`, a folder instead of a file. If
 * not, a message on standard error says why; `path` names the directory in the message. */
bool own_file_admits(int dir, const char *path, const char *name, bool folder);
