/* datadir_lost_test.c - a data directory that is deleted, renamed, emptied or replaced while a daemon runs. */
#include "tests/server/directory.h"
#include "tests/test.h"

#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

static char *ask(const struct daemon *d, const char *requests)
{
    size_t n;
    int fd = daemon_connect(d);
    say(fd, requests);
    shutdown(fd, SHUT_WR);
    char *replies = hear_all(fd, &n);
    close(fd);
    return replies;
}

/* Waits until the daemon has noticed what happened to the directory, which it looks at every second. */
static void await_durability(const struct daemon *d, const char *word, const char *also)
{
    char line[64];
    bool found = false;
    snprintf(line, sizeof line, "durability:%s\n", word);
    for (unsigned tries = 0; !found; tries++) {
        char *info = ask(d, "INFO durability\n");
        found = strstr(info, line) != NULL && strstr(info, also) != NULL;
        CHECK_MSG(found || tries < 100 * test_slowness(), "%s", info);
        free(info);
        pause_ms(found ? 0 : 50);
    }
}

static void check_readonly(const struct daemon *d, const char *state)
{
    char text[64];
    snprintf(text, sizeof text, "\ndata_directory:%s\n", state);
    await_durability(d, "readonly", text);
    char *info = ask(d, "ADD t 9 9\nGET t 0\n");
    CHECK_MSG(strncmp(info, "ERR READONLY changes cannot be saved: ", 38) == 0 &&
                  strstr(info, "data directory") != NULL && strstr(info, "OK 1\n0 1 1\n") != NULL,
              "%s", info);
    free(info);
}

static void check_recovered(struct daemon *d, const struct directory *dir)
{
    char text[2000];
    await_info_least(d, "snapshot_lsn", 1);
    await_durability(d, "good", "");
    carry_out(d, "ADD t 2 2\n");
    CHECK(daemon_stop(d, SIGKILL) == -1);
    CHECK_MSG(directory_run(dir, "--check", text, sizeof text) == 0, "%s", text);
    *d = directory_daemon(dir, NULL);
    converse(d, "GET t 0\nGET t 1\n", "OK 1\n0 1 1\nOK 1\n1 2 2\n");
    CHECK(daemon_stop(d, SIGTERM) == 0);
}

static struct daemon start_with_a_point(const struct directory *dir)
{
    struct daemon d = directory_daemon(dir, NULL);
    carry_out(&d, "ADD t 1 1\n");
    return d;
}

TEST_TIMEOUT(renamed_data_directory_is_noticed_and_used_again_when_it_is_back, 60)
{
    char away[128];
    struct directory dir = directory_new();
    struct daemon d = start_with_a_point(&dir);
    snprintf(away, sizeof away, "%s.away", dir.path);
    CHECK(rename(dir.path, away) == 0);
    check_readonly(&d, "gone");
    CHECK(mkdir(dir.path, 0700) == 0);
    check_readonly(&d, "replaced");
    CHECK(rmdir(dir.path) == 0 && rename(away, dir.path) == 0);
    check_recovered(&d, &dir);
    directory_remove(&dir);
}

TEST_TIMEOUT(deleted_data_directory_is_noticed_and_made_again_in_an_empty_one, 60)
{
    struct directory dir = directory_new();
    struct daemon d = start_with_a_point(&dir);
    directory_remove(&dir);
    check_readonly(&d, "gone");
    CHECK(mkdir(dir.path, 0700) == 0);
    check_recovered(&d, &dir);
    directory_remove(&dir);
}

TEST_TIMEOUT(directory_with_other_files_in_the_place_of_a_deleted_one_is_left_alone, 60)
{
    char path[128];
    struct directory dir = directory_new();
    struct daemon d = start_with_a_point(&dir);
    directory_remove(&dir);
    check_readonly(&d, "gone");
    CHECK(mkdir(dir.path, 0700) == 0);
    directory_touch(&dir, "other");
    check_readonly(&d, "replaced");
    CHECK(!directory_file(&dir, "log.", 0, path));
    snprintf(path, sizeof path, "%s/other", dir.path);
    CHECK(unlink(path) == 0);
    check_recovered(&d, &dir);
    directory_remove(&dir);
}

TEST_TIMEOUT(files_that_are_deleted_from_the_data_directory_are_written_again, 60)
{
    char path[128];
    struct directory dir = directory_new();
    struct daemon d = start_with_a_point(&dir);
    while (directory_file(&dir, "", 0, path))
        CHECK(unlink(path) == 0);
    check_recovered(&d, &dir);
    directory_remove(&dir);
}

/* Without the file a follower would be a leader after the next start. */
TEST_TIMEOUT(role_of_a_follower_is_written_again_with_everything_else, 60)
{
    char path[128];
    struct directory dir = directory_new();
    struct daemon d = directory_daemon(&dir, NULL);
    carry_out(&d, "FOLLOW 127.0.0.1 1\n");
    while (directory_file(&dir, "", 0, path))
        CHECK(unlink(path) == 0);
    for (unsigned i = 0; i < 100 * test_slowness() && !directory_file(&dir, "role", 0, path); i++)
        pause_ms(50);
    CHECK(directory_file(&dir, "role", 0, path) && daemon_stop(&d, SIGTERM) == 0);
    directory_remove(&dir);
}
