/* private.c - see private.h. */
#include "server/system/private.h"

#include "server/system/notice.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const char pattern[] = "/delaunay_XXXXXX", name[] = "/socket";

bool private_make(char path[PRIVATE_PATH])
{
    const char *tmp = getenv("TMPDIR");
    if (tmp == NULL || tmp[0] != '/' || strlen(tmp) + sizeof pattern + sizeof name > PRIVATE_PATH)
        tmp = "/tmp";
    snprintf(path, PRIVATE_PATH, "%s%s", tmp, pattern);
    if (mkdtemp(path) == NULL)
        return notice_error("cannot make a directory in %s: %s", tmp, strerror(errno));
    strcat(path, name);
    return true;
}

void private_remove(const char *path)
{
    char directory[PRIVATE_PATH];
    snprintf(directory, sizeof directory, "%.*s", (int)(strrchr(path, '/') - path), path);
    rmdir(directory);
}

bool private_owner_is_gone(int fd)
{
    char ignored[256];
    ssize_t n = read(fd, ignored, sizeof ignored);
    return n == 0 || (n < 0 && errno != EINTR && errno != EAGAIN);
}
