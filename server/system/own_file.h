/* own_file.h - files and folders in a directory of the daemon: opens regular files that belong to its user, or to the owner of
 * the directory, and never through a symbolic link. Another user who may write in the directory cannot make the daemon read, wait
 * for or change anything else. */
#pragma once

#include <dirent.h>
#include <errno.h>
#include <stdbool.h>
#include <stddef.h>

/* Opens the file, which exists already; `flags` are those of open(2). -1 with errno: EINVAL if it is refused; then a message
 * on standard error says why. */
int own_file_open(int dir, const char *name, int flags);

/* Creates an empty file, in place of one of that name. -1 with errno. */
int own_file_create(int dir, const char *name, int flags);

/* Writes all bytes. False with errno. */
bool own_file_write(int fd, const char *bytes, size_t n);

/* Closes the descriptor, unless it is -1; returns `ok` and preserves errno. */
bool own_file_close(int fd, bool ok);

/* Whether there is no such name, or a file that own_file_open does not refuse; with `folder`, a folder instead of a file. If
 * not, a message on standard error says why; `path` names the directory in the message. */
bool own_file_admits(int dir, const char *path, const char *name, bool folder);

/* Opens a folder of the directory, but not through a symbolic link. -1 with errno. */
int own_folder_open(int dir, const char *name);

/* Begins to read the names in the directory, whose descriptor stays open; ends with closedir. NULL with errno. */
DIR *own_folder_names(int dir);

/* Whether the directory has no names. If it cannot be read, it may have some. */
bool own_folder_is_empty(int dir);

/* Whether an error of a file means that the disk, or the user's share of it, is full. */
static inline bool own_file_lacks_space(int error)
{
    return error == ENOSPC || error == EDQUOT;
}
