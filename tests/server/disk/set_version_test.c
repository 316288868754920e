/* set_version_test.c - the versions of sets, as clients see them: they grow with every change, survive restarts, and are
 * never used twice. */
#include "tests/server/directory.h"
#include "tests/test.h"

#include <inttypes.h>
#include <signal.h>
#include <string.h>
#include <unistd.h>

/* The version in the last reply to the requests. */
static uint64_t version_after(const struct daemon *d, const char *requests)
{
    size_t n;
    int fd = daemon_connect(d);
    say(fd, requests);
    say(fd, "QUIT\n");
    char *text = hear_all(fd, &n), *last = NULL;
    close(fd);
    for (char *at = text; (at = strstr(at, " version=")) != NULL; at++)
        last = at;
    CHECK_MSG(last != NULL && strstr(text, "ERR") == NULL, "%s", text);
    uint64_t v = strtoull(last + strlen(" version="), NULL, 10);
    free(text);
    CHECK(v > 0 && v < (uint64_t)1 << 53);
    return v;
}

TEST(version_grows_with_every_change_and_stat_shows_it)
{
    static const char *const edits[] = {
        "CREATE t\n",       "ADD t 0 0 4 0 4 4 0 4\n", "TRIANGULATE t\n", "ADD t FIELDS z 1 1 7\n",
        "LOAD t\n2 1\n.\n", "MOVE t 5 2 2\n",          "FSET t z 0 1\n",  "FDROP t z\n",
        "DEL t 5\n",        "EXPIRE t 1000\n",         "PERSIST t\n"};
    struct directory dir = directory_new();
    struct daemon memory = daemon_start(NULL), disk = directory_daemon(&dir, NULL);
    uint64_t before[2] = {0, 0};
    for (size_t i = 0; i < sizeof edits / sizeof edits[0]; i++) {
        for (int k = 0; k < 2; k++) {
            const struct daemon *d = k == 0 ? &memory : &disk;
            uint64_t v = version_after(d, edits[i]);
            CHECK_MSG(v > before[k], "%s", edits[i]);
            CHECK(version_after(d, "STAT t\n") == v);
            before[k] = v;
        }
    }
    CHECK(version_after(&disk, "TRIANGULATE t\nPERSIST t\n") == before[1]);
    daemon_end(&memory);
    daemon_end(&disk);
    directory_remove(&dir);
}

TEST(version_survives_kills_and_snapshots)
{
    struct directory dir = directory_new();
    struct daemon d = directory_daemon(&dir, NULL);
    uint64_t a = version_after(&d, "ADD a 0 0 4 0 4 4\nTRIANGULATE a\nMOVE a 1 5 5\n");
    uint64_t b = version_after(&d, "CREATE b\nADD b FIELDS z 1 2 3\n");
    for (int i = 0; i < 4; i++) {
        daemon_stop(&d, SIGKILL);
        d = directory_daemon(&dir, NULL);
        CHECK(version_after(&d, "STAT a\n") == a && version_after(&d, "STAT b\n") == b);
        if (i == 1) {
            carry_out(&d, "SNAPSHOT\n");
            await_info(&d, "snapshots", 1);
        }
        uint64_t now = version_after(&d, "MOVE b 0 3 3\n");
        CHECK(now > b && now > a);
        b = now;
    }
    daemon_end(&d);
    directory_remove(&dir);
}

/* A power cut takes the end of the log, whose changes clients have seen. */
TEST(version_of_a_change_that_was_lost_is_not_used_again)
{
    struct directory dir = directory_new();
    char path[128];
    size_t n;
    struct daemon d = directory_daemon(&dir, NULL);
    uint64_t kept = version_after(&d, "ADD t 0 0\n");
    CHECK(directory_file(&dir, "log.", 0, path));
    char *bytes = file_read(path, &n);
    uint64_t lost = version_after(&d, "ADD t 1 1\nADD t 2 2\nADD t 3 3\n");
    daemon_stop(&d, SIGKILL);
    file_write(path, bytes, n);
    free(bytes);
    d = directory_daemon(&dir, NULL);
    CHECK(version_after(&d, "STAT t\n") == kept);
    CHECK(version_after(&d, "ADD t 1 1\n") > lost);
    daemon_end(&d);
    directory_remove(&dir);
}

TEST(version_of_a_set_that_is_made_again_is_another_one)
{
    uint64_t v[6];
    struct directory dir = directory_new();
    struct daemon d = directory_daemon(&dir, NULL);
    v[0] = version_after(&d, "ADD t 0 0\n");
    v[1] = version_after(&d, "DROP t\nCREATE t TEMPORARY\nADD t 0 0\n");
    await_info(&d, "sets", 0); /* the temporary set has ended with its connection */
    v[2] = version_after(&d, "ADD t 0 0\n");
    daemon_stop(&d, SIGKILL);
    d = directory_daemon(&dir, NULL);
    v[3] = version_after(&d, "DROP t\nADD t 0 0\n");
    daemon_end(&d);
    d = daemon_start(NULL);
    v[4] = version_after(&d, "ADD t 0 0\n");
    daemon_stop(&d, SIGKILL);
    d = daemon_start(NULL);
    v[5] = version_after(&d, "ADD t 0 0\n");
    daemon_end(&d);
    for (int i = 0; i < 6; i++)
        for (int k = 0; k < i; k++)
            CHECK_MSG(v[i] != v[k], "%d and %d: %" PRIu64, k, i, v[i]);
    CHECK(v[2] < v[3]); /* lives without a directory have random numbers */
    directory_remove(&dir);
}
