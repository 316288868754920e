/* power_agree.c - see power_agree.h. */
#include "tests/server/power/power_agree.h"

#include "tests/server/digest.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

struct asked {
    const struct daemon *d;
    const char *fault; /* NULL: none so far */
    char set[SET_NAME_LIMIT + 1];
};

/* The reply to `COMMAND set`, once the set exists; the caller frees it. */
static char *ask(const struct daemon *d, const char *command, const char *set)
{
    for (;; pause_ms(1)) {
        char request[100];
        size_t n;
        int fd = daemon_connect(d);
        snprintf(request, sizeof request, "%s %s\n", command, set);
        say(fd, request);
        shutdown(fd, SHUT_WR);
        char *reply = hear_all(fd, &n);
        close(fd);
        if (strncmp(reply, "ERR LOADING", 11) != 0)
            return reply;
        free(reply);
    }
}

static bool same_digest(const struct daemon *d, struct dataset *set)
{
    uint64_t there;
    char *reply = ask(d, "DIGEST", set->name);
    bool same = sscanf(reply, "OK 0 digest=%" SCNx64, &there) == 1 && there == digest_now(set);
    free(reply);
    return same;
}

static bool same_triangulation(const struct daemon *d, const struct dataset *set)
{
    char *reply = ask(d, "CHECK", set->name);
    bool same = strncmp(reply, set->triangulated ? "OK 0 delaunay=yes" : "ERR UNTRIANGULATED",
                        set->triangulated ? 17 : 18) == 0;
    free(reply);
    return same;
}

static void ask_about(struct dataset *set, void *ctx)
{
    struct asked *a = ctx;
    if (a->fault != NULL)
        return;
    if (!same_digest(a->d, set))
        a->fault = "digest";
    else if (!same_triangulation(a->d, set))
        a->fault = "triangulation";
    memcpy(a->set, set->name, sizeof a->set);
}

bool power_agrees(const struct daemon *d, const struct registry *sets, char why[WHY_BYTES])
{
    struct asked a = {.d = d};
    size_t n;
    char *reply = ask(d, "SETS", "");
    bool same = sscanf(reply, "OK %zu", &n) == 1 && n == sets->sets;
    free(reply);
    if (!same)
        snprintf(why, WHY_BYTES, "the daemon has other sets than its directory");
    if (same)
        registry_each(sets, ask_about, &a);
    if (a.fault != NULL)
        snprintf(why, WHY_BYTES, "the daemon has another %s of %s than its directory", a.fault,
                 a.set);
    return same && a.fault == NULL;
}
