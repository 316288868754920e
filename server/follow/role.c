/* role.c - see role.h. */
#include "server/follow/role.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

struct remembered_role role_read(const char *path)
{
    struct remembered_role role = {.port = 0};
    char name[4096], line[160], word[16], arg[ROLE_ADDRESS];
    unsigned port;
    snprintf(name, sizeof name, "%s/role", path);
    FILE *in = fopen(name, "re");
    if (in == NULL)
        return role;
    if (fgets(line, sizeof line, in) != NULL) {
        int n = sscanf(line, "%15s %79s %u", word, arg, &port);
        if (n == 3 && strcmp(word, "follow") == 0) {
            strcpy(role.host, arg);
            role.port = port;
        } else if (n == 2 && strcmp(word, "fenced") == 0) {
            role.fenced = history_read(arg, strlen(arg), &role.newer);
        }
    }
    fclose(in);
    return role;
}

bool role_write(const struct datadir *dir, const char *line)
{
    static const char temporary[] = "role.new", name[] = "role";
    size_t n = strlen(line);
    if (n == 0)
        return (unlinkat(dir->fd, name, 0) == 0 || errno == ENOENT) && datadir_sync(dir);
    int fd = openat(dir->fd, temporary, O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0600);
    bool ok = fd >= 0 && write(fd, line, n) == (ssize_t)n && fsync(fd) == 0;
    if (fd >= 0)
        close(fd);
    return ok && renameat(dir->fd, temporary, dir->fd, name) == 0 && datadir_sync(dir);
}

bool role_read_address(const char *text, char host[ROLE_ADDRESS], unsigned *port)
{
    const char *colon = strrchr(text, ':');
    bool brackets = text[0] == '[';
    if (colon == NULL || (brackets && (colon == text || colon[-1] != ']')))
        return false;
    size_t n = (size_t)(colon - text) - (brackets ? 2 : 0);
    char *end;
    unsigned long v = strtoul(colon + 1, &end, 10);
    bool digits = colon[1] >= '0' && colon[1] <= '9'; /* strtoul takes signs and spaces, too */
    if (n == 0 || n >= ROLE_ADDRESS || *end != '\0' || !digits || v == 0 || v > 65535)
        return false;
    memcpy(host, text + brackets, n);
    host[n] = '\0';
    *port = (unsigned)v;
    return true;
}
