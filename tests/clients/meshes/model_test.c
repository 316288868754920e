/* model_test.c - a set is fetched as a whole, at one moment: exports from servers that the tests play. */
#include <stdlib.h>
#include <string.h>

#include "tests/clients/peer.h"
#include "tests/test.h"

/* A server that has two points and the fields t and z, but not the command FGET. */
static void answer_values(int fd)
{
    static const unsigned char rows[2 * 36] = {
        [0] = 3,                                            /* id 3 at 0 0: t is 1.5, */
        [26] = 0xF8, [27] = 0x3F, [34] = 0xF8,              /* z is nan */
        [35] = 0x7F, [36] = 7,    [46] = 0xF0, [47] = 0x3F, /* id 7 at 1 0: */
        [62] = 0,    [63] = 0x40, [70] = 0x08, [71] = 0xC0, /* t is 2, z is -3 */
    };
    char line[200];
    while (peer_hear(fd, line, sizeof line)) {
        if (strcmp(line, "FIELDS s") == 0) {
            peer_say(fd, "OK 2\nt 2 1.5 2\nz 1 -3 -3\n");
        } else if (strcmp(line, "POINTS s FIELDS t,z BINARY") == 0) {
            peer_say(fd, "OK 0 rows=2 bytes=72\n");
            peer_send(fd, rows, sizeof rows);
        } else if (strcmp(line, "TRIANGLES s BINARY") == 0) {
            peer_say(fd, "OK 0 rows=0 bytes=0\n");
        } else if (strcmp(line, "HULL s") == 0) {
            peer_say(fd, "OK 2\n3 0 0\n7 1 0\n");
        } else if (strcmp(line, "STAT s") == 0) { /* of a server without versions */
            peer_say(fd, "OK 0 points=2\n");
        } else {
            peer_say(fd, "ERR UNKNOWN\n");
        }
    }
}

TEST(points_and_their_values_come_from_one_reply)
{
    char port[8];
    int status;
    peer_start(port, answer_values);
    const char *out =
        peer_shell(&status, "%s -p %s export s - -f node 2>/dev/null", getenv("DELAUNAY"), port);
    CHECK_MSG(status == 0 && strcmp(out, "2 2 2 1\n0 0 0 1.5 nan 1\n1 1 0 2 -3 1\n") == 0, "%s",
              out);
}

static int edits; /* how many edits happen while a model is fetched */

/* A server with three points, the third of which goes to 0 9 while the set is fetched; each STAT has a version. */
static void answer_during_edits(int fd)
{
    static unsigned char rows[3 * 20] = {[20] = 1, [30] = 0xF0, [31] = 0x3F, [40] = 2};
    static const unsigned char triangle[12] = {[4] = 1, [8] = 2};
    char line[200], text[60];
    int asked = 0, version = 7;
    while (peer_hear(fd, line, sizeof line)) {
        if (strcmp(line, "FIELDS s") == 0) {
            peer_say(fd, "OK 0\n");
        } else if (strcmp(line, "STAT s") == 0) {
            version += asked % 2 == 1 && asked / 2 < edits;
            asked++;
            snprintf(text, sizeof text, "OK 0 points=3 version=%d\n", version);
            peer_say(fd, text);
        } else if (strcmp(line, "POINTS s BINARY") == 0) {
            rows[58] = version > 7 + edits - 1 ? 0x22 : 0; /* y is 9, before that 2 */
            rows[59] = 0x40;
            peer_say(fd, "OK 0 rows=3 bytes=60\n");
            peer_send(fd, rows, sizeof rows);
        } else if (strcmp(line, "TRIANGLES s BINARY") == 0) {
            peer_say(fd, "OK 0 rows=1 bytes=12\n");
            peer_send(fd, triangle, sizeof triangle);
        } else if (strcmp(line, "HULL s") == 0) {
            peer_say(fd, "OK 3\n0 0 0\n1 1 0\n2 0 2\n");
        } else {
            peer_say(fd, "ERR UNKNOWN\n");
        }
    }
}

TEST(a_set_that_is_edited_while_it_is_fetched_is_fetched_again)
{
    char port[8];
    int status;
    edits = 3;
    peer_start(port, answer_during_edits);
    const char *out =
        peer_shell(&status, "%s -p %s export s - -f csv 2>&1", getenv("DELAUNAY"), port);
    CHECK_MSG(status == 0 && strstr(out, "0,1,2,0,0,1,0,0,9\n") != NULL, "%s", out);
    edits = 1000;
    peer_start(port, answer_during_edits);
    out = peer_shell(&status, "%s -p %s export s - -f csv 2>&1", getenv("DELAUNAY"), port);
    CHECK_MSG(status == 1 && strstr(out, "edited while it is read") != NULL, "%s", out);
}
