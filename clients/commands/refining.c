/* refining.c - see refining.h. */
#include "clients/commands/refining.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

#include "clients/cli/command.h"
#include "clients/cli/message.h"
#include "proto/number.h"

int refining_option(struct refining *r, int option, char **argv, bool *known)
{
    const char **to = option == REFINING_ANGLE    ? &r->angle
                      : option == REFINING_AREA   ? &r->area
                      : option == REFINING_LENGTH ? &r->length
                                                  : &r->limit;
    double v;
    *known = option >= REFINING_ANGLE && option <= REFINING_LIMIT;
    if (option == REFINING_KEEP) {
        r->keep = true;
        return EXIT_DONE;
    }
    if (!*known)
        return EXIT_DONE;
    if (!proto_read_double(optarg, strlen(optarg), &v) || !(v > 0 || option == REFINING_LIMIT))
        return options_wrong(argv[0], "a limit is a number above 0, not %s", optarg);
    *to = optarg;
    return EXIT_DONE;
}

bool refining_asked(const struct refining *r)
{
    return r->angle != NULL || r->area != NULL || r->length != NULL;
}

/* Appends the word and its value, unless that is NULL, to line[n], which has room for `room`; returns the new n. */
static size_t put(char *line, size_t n, size_t room, const char *word, const char *value)
{
    if (value == NULL || n >= room)
        return n;
    int more = snprintf(line + n, room - n, " %s %s", word, value);
    return n + (more > 0 ? (size_t)more : 0);
}

static void report(const struct delaunay_part *status)
{
    const char *angle;
    size_t len;
    uint64_t added = 0, unrefined = 0, hull = 0;
    delaunay_key_number(status, "added", &added);
    delaunay_key_number(status, "unrefined", &unrefined);
    delaunay_key_number(status, "hull", &hull);
    if (hull > 0)
        fprintf(stderr, "delaunay: there is no border, so the hull is one\n");
    if (delaunay_key(status, "angle", &angle, &len))
        fprintf(stderr, "delaunay: %" PRIu64 " points added; the least angle is %.*s degrees\n",
                added, (int)(len > 6 ? 6 : len), angle);
    if (unrefined > 0)
        fprintf(stderr,
                "delaunay: triangles that are not as wanted: %" PRIu64
                "; sharp corners stay, and at most --limit points are added\n",
                unrefined);
}

int refining_refine(struct delaunay_client *c, const struct refining *r, const char *set,
                    const char *inside)
{
    char line[400];
    int begin = snprintf(line, sizeof line, "REFINE %s%s", set, r->keep ? " KEEP" : "");
    size_t n = put(line, (size_t)begin, sizeof line, "ANGLE", r->angle);
    n = put(line, n, sizeof line, "AREA", r->area);
    n = put(line, n, sizeof line, "LENGTH", r->length);
    n = put(line, n, sizeof line, "LIMIT", r->limit);
    if (inside != NULL && strcmp(inside, "any") != 0)
        n = put(line, n, sizeof line, "INSIDE", inside);
    if (n >= sizeof line)
        return options_wrong("", "a limit has too many digits");
    enum delaunay_result result = delaunay_request(c, line, command_show_comment, NULL);
    if (result != DELAUNAY_OK)
        return command_outcome(c, result);
    report(delaunay_status(c));
    return EXIT_DONE;
}
