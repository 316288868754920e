/* zip_file.h - the one file of an archive [PKWARE, APPNOTE.TXT 6.3]. */
#pragma once

#include <stdbool.h>
#include <stddef.h>

struct zip_member {
    char name[256];
    bool deflated; /* its bytes are a gzip file, else they are as they are */
    int fd;        /* a file without a name, at its beginning; the caller's to close */
};

/* Finds the only file in the archive, or the only one whose ending says that it has points, and copies its bytes. False with a
 * sentence in why[room]: the archive is damaged, or has several such files, which are named. */
bool zip_open(int fd, struct zip_member *m, char *why, size_t room);
