/* private_daemon.c - see private_daemon.h. `delaunayd --private` prints the path of its socket, and ends at the
 * end of its standard input, whose other end is here. */
#include "clients/cli/private_daemon.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "clients/reading/program.h"

static bool fail(char *why, size_t room, const char *what, int error)
{
    snprintf(why, room, "%s: %s", what, strerror(error));
    return false;
}

/* The path of the daemon; one without a '/' is looked for in $PATH. */
static void find_program(char *path, size_t room)
{
    const char *chosen = getenv("DELAUNAYD");
    ssize_t n = readlink("/proc/self/exe", path, room - 1);
    char *slash = NULL;
    if (n > 0) {
        path[n] = '\0';
        slash = strrchr(path, '/');
    }
    if (chosen != NULL && chosen[0] != '\0') {
        snprintf(path, room, "%s", chosen);
    } else if (slash != NULL && (size_t)(slash - path) + sizeof "/delaunayd" <= room) {
        strcpy(slash, "/delaunayd");
        if (access(path, X_OK) != 0)
            strcpy(path, "delaunayd");
    } else {
        snprintf(path, room, "delaunayd");
    }
}

/* Reads the line with the path of its socket, and connects to it. */
static bool connect_to(struct private_daemon *d, int out, const char *program, char *why,
                       size_t room)
{
    char line[256];
    static const char ready[] = "ready on ";
    FILE *f = fdopen(out, "r");
    bool said = f != NULL && fgets(line, sizeof line, f) != NULL &&
                strncmp(line, ready, sizeof ready - 1) == 0;
    if (f != NULL)
        fclose(f);
    else
        close(out);
    if (!said) {
        snprintf(why, room, "%s: it is not a daemon, or one without --private", program);
        return false;
    }
    line[strcspn(line, "\n")] = '\0';
    d->client = delaunay_connect(line + sizeof ready - 1, "", why, room);
    return d->client != NULL;
}

bool private_daemon_start(struct private_daemon *d, char *why, size_t room)
{
    char program[4096];
    const char *words[] = {program, "--private", "--log-level", "error", NULL};
    int in[2], out;
    *d = (struct private_daemon){.owner = -1};
    find_program(program, sizeof program);
    if (pipe2(in, O_CLOEXEC) != 0)
        return fail(why, room, program, errno);
    d->owner = in[1];
    int error = program_start(&d->pid, words, in[0], &out, true);
    close(in[0]);
    if (error == 0 && connect_to(d, out, program, why, room))
        return true;
    if (error != 0) {
        d->pid = 0;
        fail(why, room, program, error);
    }
    private_daemon_end(d);
    return false;
}

void private_daemon_end(struct private_daemon *d)
{
    delaunay_close(d->client);
    close(d->owner);
    if (d->pid > 0)
        program_end(d->pid);
}
