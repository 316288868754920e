/* resume_test.c - watchers of a daemon that is killed and started again: they continue with SINCE, and then equal the
 * set. */
#include "tests/server/directory.h"
#include "tests/server/watch/mirror.h"
#include "tests/test.h"

#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

enum { MIRRORS = 3, POINTS = 60, EDITS = 20 };

static void append_edit(char *text, size_t size)
{
    size_t at = strlen(text);
    unsigned id = test_below(POINTS);
    switch (test_below(6)) {
    case 4:
        snprintf(text + at, size - at, "CONSTRAIN t %u %u\n", id, id / 2);
        break;
    case 5:
        snprintf(text + at, size - at, "RELEASE t %u %u\n", id, id / 2);
        break;
    case 0:
        snprintf(text + at, size - at, "ADD t %g %g\n", test_uniform(), test_uniform());
        break;
    case 1:
        snprintf(text + at, size - at, "FSET t z %u %u\n", id, (unsigned)test_below(9));
        break;
    case 2:
        snprintf(text + at, size - at, "DEL t %u\n", POINTS + id); /* there may be none */
        break;
    default:
        snprintf(text + at, size - at, "MOVE t %u %g %g\n", id, test_uniform(), test_uniform());
    }
}

/* Edits one by one, while the mirrors hear of some, and a last burst of which no reply is awaited. */
static void edit_and_kill(const struct daemon *d, struct mirror *m)
{
    char text[EDITS * 64] = "";
    int fd = daemon_connect(d);
    for (int i = 0; i < EDITS; i++) {
        text[0] = '\0';
        append_edit(text, sizeof text);
        say(fd, text);
        const char *got = hear_line(fd);
        if (strncmp(got, "OK", 2) == 0 && test_below(4) == 0)
            mirror_catch_up(&m[test_below(MIRRORS)], version_in(got));
    }
    text[0] = '\0';
    for (int i = 0; i < EDITS; i++)
        append_edit(text, sizeof text);
    say(fd, text);
    if (test_below(2) == 0)
        hear_line(fd);
    daemon_stop(d, SIGKILL);
    close(fd);
}

TEST_TIMEOUT(watchers_of_a_killed_daemon_continue_and_have_the_same_set, 120)
{
    enum { ROUNDS = 6 };
    static struct mirror m[MIRRORS] = {{.options = {.fields = "z", .constraints = true}},
                                       {.options = {.box = "0.2 0.6 0.7 0.1", .constraints = true}},
                                       {.options = {.resp = true}}};
    struct directory dir = directory_new();
    struct daemon d;
    for (int i = 0; i < ROUNDS; i++) {
        const char *const policy = i % 2 == 0 ? "always" : "everysec";
        d = directory_daemon(&dir,
                             (const char *const[]){"--compact-at", "8k", "--fsync", policy, NULL});
        int fd = daemon_connect(&d);
        if (i == 0) {
            load_random(fd, "t", POINTS);
            ask_version(fd, "FSET t z 0 1\n");
            ask_version(fd, "TRIANGULATE t\n");
        }
        uint64_t version = ask_version(fd, "STAT t\n");
        for (int k = 0; k < MIRRORS; k++) {
            CHECK(m[k].version <= version);
            mirror_watch(&m[k], &d, i > 0);
            while (!m[k].whole || m[k].version < version)
                mirror_take(&m[k]);
            mirror_check(&m[k], fd, true);
        }
        close(fd);
        edit_and_kill(&d, m);
        for (int k = 0; k < MIRRORS; k++)
            mirror_disconnect(&m[k]);
    }
    for (int k = 0; k < MIRRORS; k++)
        mirror_free(&m[k]);
    directory_remove(&dir);
}
