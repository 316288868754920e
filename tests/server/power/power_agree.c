/* power_agree.c - see power_agree.h. */
#include "tests/server/power/power_agree.h"

#include "tests/test.h"

#include <inttypes.h>
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

static const char *next_line(const char *at)
{
    return strchr(at, '\n') + 1;
}

static bool same_points(const struct daemon *d, const struct dataset *set, uint32_t points)
{
    char *reply = ask(d, "POINTS", set->name);
    uint32_t n, id;
    bool same = sscanf(reply, "OK %" SCNu32, &n) == 1 && n == points;
    const char *at = next_line(reply);
    for (; same && n > 0; n--, at = next_line(at)) {
        struct dt_point p, q;
        same = sscanf(at, "%" SCNu32 " %lf %lf", &id, &p.x, &p.y) == 3 &&
               dt_get(set->current->dt, id, &q) == DT_OK && p.x == q.x && p.y == q.y;
    }
    free(reply);
    return same;
}

static bool same_aliases(const struct daemon *d, const struct dataset *set, uint32_t aliases)
{
    char *reply = ask(d, "COINCIDENT", set->name);
    uint32_t n, id, rep, want;
    bool same = sscanf(reply, "OK %" SCNu32, &n) == 1 && n == aliases;
    const char *at = next_line(reply);
    for (; same && n > 0; n--, at = next_line(at))
        same = sscanf(at, "%" SCNu32 " %" SCNu32, &id, &rep) == 2 &&
               dt_representative(set->current->dt, id, &want) == DT_OK && rep == want;
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
    struct dt_summary sum;
    dt_summary(set->current->dt, &sum);
    if (a->fault != NULL)
        return;
    if (!same_points(a->d, set, sum.points))
        a->fault = "points";
    else if (!same_aliases(a->d, set, sum.coincident))
        a->fault = "representatives";
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
        snprintf(why, WHY_BYTES, "the daemon has other %s of %s than its directory", a.fault,
                 a.set);
    return same && a.fault == NULL;
}
