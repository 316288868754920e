/* role.c - see role.h. */
#include "server/follow/role.h"

#include "proto/number.h"
#include "server/system/own_file.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* ---- the file ---- */

static void read_decision(struct remembered_role *r, const char *line)
{
    char word[16], arg[ROLE_ADDRESS] = "", own[8] = "";
    unsigned port = 0;
    int n = sscanf(line, "%15s %79s %u %7s", word, arg, &port, own);
    bool address = n >= 3 && port != 0, owns = n == 4 && strcmp(own, "own") == 0;
    if (n >= 3 && strcmp(word, "follow") == 0 && address && (n == 3 || owns))
        r->kind = ROLE_FOLLOWS;
    else if (n >= 1 && strcmp(word, "lead") == 0 && (n == 1 || (n == 3 && address)))
        r->kind = ROLE_LEADS;
    else if (n == 2 && strcmp(word, "fenced") == 0 && history_read(arg, strlen(arg), &r->newer))
        r->kind = ROLE_FENCED;
    if (r->kind == ROLE_UNKNOWN || !address)
        return;
    strcpy(r->host, arg);
    r->port = port;
    r->own = owns;
}

/* A line behind the first one. */
static void read_more(struct remembered_role *r, const char *line)
{
    char word[16], arg[sizeof r->flag];
    if (sscanf(line, "%15s %91s", word, arg) != 2)
        return;
    if (strcmp(word, "flag") == 0)
        strcpy(r->flag, arg);
    else if (strcmp(word, "history") == 0 && r->kind == ROLE_LEADS)
        history_read(arg, strlen(arg), &r->newer);
}

struct remembered_role role_read(const char *path)
{
    struct remembered_role role = {.kind = ROLE_UNKNOWN};
    char line[160];
    int dir = open(path, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    int fd = dir < 0 ? -1 : own_file_open(dir, "role", O_RDONLY);
    FILE *in = fd < 0 ? NULL : fdopen(fd, "r");
    if (dir >= 0)
        close(dir);
    if (in == NULL) {
        if (fd >= 0)
            close(fd);
        return role;
    }
    if (fgets(line, sizeof line, in) != NULL)
        read_decision(&role, line);
    while (role.kind != ROLE_UNKNOWN && fgets(line, sizeof line, in) != NULL)
        read_more(&role, line);
    fclose(in);
    return role;
}

/* The text of the file; "": none is needed. */
static void write_text(char *to, size_t size, const struct remembered_role *r)
{
    char history[HISTORY_TEXT];
    size_t n = 0;
    to[0] = '\0';
    if (r->kind == ROLE_FOLLOWS)
        n = (size_t)snprintf(to, size, "follow %s %u%s\n", r->host, r->port, r->own ? " own" : "");
    else if (r->kind == ROLE_LEADS && r->port != 0)
        n = (size_t)snprintf(to, size, "lead %s %u\n", r->host, r->port);
    else if (r->kind == ROLE_LEADS && (r->flag[0] != '\0' || r->newer.origin != 0))
        n = (size_t)snprintf(to, size, "lead\n");
    history_write(history, &r->newer);
    if (r->kind == ROLE_FENCED)
        n = (size_t)snprintf(to, size, "fenced %s\n", history);
    else if (r->kind == ROLE_LEADS && r->newer.origin != 0)
        n += (size_t)snprintf(to + n, size - n, "history %s\n", history);
    if (n > 0 && r->flag[0] != '\0')
        snprintf(to + n, size - n, "flag %s\n", r->flag);
}

bool role_write(const struct datadir *dir, const struct remembered_role *r)
{
    static const char temporary[] = "role.new", name[] = "role";
    char text[320];
    write_text(text, sizeof text, r);
    size_t n = strlen(text);
    if (n == 0)
        return (unlinkat(dir->fd, name, 0) == 0 || errno == ENOENT) && datadir_sync(dir);
    int fd = own_file_create(dir->fd, temporary, O_WRONLY);
    bool ok = fd >= 0 && write(fd, text, n) == (ssize_t)n && fsync(fd) == 0;
    if (fd >= 0)
        close(fd);
    return ok && renameat(dir->fd, temporary, dir->fd, name) == 0 && datadir_sync(dir);
}

/* ---- decisions ---- */

bool role_decide(struct remembered_role *r, const char *flag)
{
    char host[ROLE_ADDRESS];
    unsigned port;
    if (flag == NULL)
        flag = "";
    else if (!role_read_address(flag, host, &port))
        return false;
    if (strcmp(flag, r->flag) != 0 && flag[0] != '\0') {
        r->own = r->own || r->kind != ROLE_FOLLOWS;
        r->kind = ROLE_FOLLOWS;
        strcpy(r->host, host);
        r->port = port;
    }
    snprintf(r->flag, sizeof r->flag, "%s", flag);
    return true;
}

bool role_read_address(const char *text, char host[ROLE_ADDRESS], unsigned *port)
{
    const char *colon = strrchr(text, ':');
    bool brackets = text[0] == '[';
    if (colon == NULL || (brackets && (colon == text || colon[-1] != ']')))
        return false;
    size_t n = (size_t)(colon - text) - (brackets ? 2 : 0);
    uint32_t v = 0;
    bool number = proto_read_u32(colon + 1, strlen(colon + 1), &v);
    if (n == 0 || n >= ROLE_ADDRESS || !number || v == 0 || v > 65535)
        return false;
    memcpy(host, text + brackets, n);
    host[n] = '\0';
    *port = v;
    return true;
}

void role_write_address(char text[ROLE_TEXT], const char *host, unsigned port)
{
    bool v6 = strchr(host, ':') != NULL;
    snprintf(text, ROLE_TEXT, "%s%.79s%s:%u", v6 ? "[" : "", host, v6 ? "]" : "", port);
}
