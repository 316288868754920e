/* private.h - the address of a daemon that serves one process alone: a Unix socket in a new
 * directory that only this user may enter. */
#pragma once

#include <stdbool.h>

enum { PRIVATE_PATH = 108 }; /* bytes, the NUL included: what the path of a Unix socket may have */

/* Makes the directory, in $TMPDIR or /tmp, and names a socket in it. False: the reason is on standard
 * error. */
bool private_make(char path[PRIVATE_PATH]);

/* Removes the directory of that socket, which has been removed. */
void private_remove(const char *path);

/* Whether the owner, who holds the other end of this pipe or socket, has ended. The data that the owner sends is ignored. */
bool private_owner_is_gone(int fd);
