/* check_test.c - what a start, --check and --repair say about files that are not ours, and about a directory that lacks
 * something. */
#include "server/disk/datadir.h"
#include "tests/server/directory.h"
#include "tests/test.h"

#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

enum { NOBODY = 65534 };

static void name_in(const struct directory *dir, const char *name, char path[128])
{
    snprintf(path, 128, "%s/%s", dir->path, name);
}

/* ---- files that are not ours ---- */

static const char *const ours[] = {"log.0000000000000001", "snapshot.0000000000000001", "reserve",
                                   "role", "snapshot.0000000000000002.tmp"};
enum { OURS = sizeof ours / sizeof ours[0] };

static void make_link(const char *path)
{
    CHECK(symlink("../victim", path) == 0);
}

static void make_pipe(const char *path)
{
    CHECK(mkfifo(path, 0600) == 0);
}

static void make_directory(const char *path)
{
    CHECK(mkdir(path, 0700) == 0);
}

static void make_socket(const char *path)
{
    struct sockaddr_un a = {.sun_family = AF_UNIX};
    int fd = socket(AF_UNIX, SOCK_STREAM, 0);
    strncpy(a.sun_path, path, sizeof a.sun_path - 1);
    CHECK(fd >= 0 && bind(fd, (struct sockaddr *)&a, sizeof a) == 0);
    close(fd);
}

static const struct oddity {
    const char *says;
    void (*make)(const char *path);
} oddities[] = {{"a symbolic link", make_link},
                {"a pipe", make_pipe},
                {"a directory", make_directory},
                {"a socket", make_socket}};

/* The file stays as it is, and the target of a link, too. */
static void check_refused(const struct directory *dir, const char *name, const char *says)
{
    static const char *const flags[] = {"--data", "--check", "--repair"};
    char text[2000], path[128];
    struct stat before, after;
    name_in(dir, name, path);
    CHECK(lstat(path, &before) == 0);
    for (size_t i = 0; i < sizeof flags / sizeof flags[0]; i++) {
        CHECK_MSG(directory_run(dir, flags[i], text, sizeof text) == 1, "%s %s", flags[i], name);
        CHECK_MSG(strstr(text, name) != NULL && strstr(text, says) != NULL, "%s", text);
    }
    CHECK(lstat(path, &after) == 0 && before.st_ino == after.st_ino &&
          before.st_size == after.st_size);
}

TEST(what_is_no_regular_file_is_named_and_neither_read_nor_truncated)
{
    size_t n;
    for (size_t kind = 0; kind < sizeof oddities / sizeof oddities[0]; kind++) {
        for (size_t i = 0; i < OURS; i++) {
            char path[128], victim[128];
            struct directory outside = directory_new(), dir = outside;
            name_in(&outside, "victim", victim);
            file_write(victim, "root", 4);
            snprintf(dir.path, sizeof dir.path, "%.50s/data", outside.path);
            CHECK(mkdir(dir.path, 0700) == 0);
            name_in(&dir, ours[i], path);
            oddities[kind].make(path);
            check_refused(&dir, ours[i], oddities[kind].says);
            free(file_read(victim, &n));
            CHECK(n == 4);
            CHECK(remove(path) == 0);
            directory_remove(&dir);
            directory_remove(&outside);
        }
    }
}

TEST(file_of_another_user_is_named_and_not_read)
{
    if (geteuid() != 0)
        return; /* only root can make one */
    for (size_t i = 0; i < OURS; i++) {
        char path[128];
        struct directory dir = directory_new();
        directory_touch(&dir, ours[i]);
        name_in(&dir, ours[i], path);
        CHECK(chown(path, NOBODY, NOBODY) == 0);
        check_refused(&dir, ours[i], "belongs to user 65534");
        directory_remove(&dir);
    }
}

/* Such a directory is that of a service whose user is another one; some file systems give all files another user. */
TEST(files_of_the_owner_of_the_directory_are_read)
{
    char text[2000], path[128];
    struct directory dir = directory_new();
    struct daemon d = directory_daemon(&dir, NULL);
    daemon_stop(&d, SIGTERM);
    CHECK(directory_file(&dir, "log.", 0, path));
    if (geteuid() == 0)
        CHECK(chown(dir.path, NOBODY, NOBODY) == 0 && chown(path, NOBODY, NOBODY) == 0);
    CHECK_MSG(directory_run(&dir, "--check", text, sizeof text) == 0, "%s", text);
    directory_remove(&dir);
}

/* The daemon would fill it with zeros, or truncate it. */
TEST(other_names_of_a_file_elsewhere_do_not_let_the_daemon_change_it)
{
    static const char *const names[] = {"reserve", "snapshot.0000000000000001.tmp", "role.new"};
    char text[2000], victim[128], path[128];
    size_t n;
    struct directory outside = directory_new(), dir = directory_new();
    struct daemon d = directory_daemon(&dir, NULL);
    daemon_stop(&d, SIGTERM);
    name_in(&outside, "victim", victim);
    file_write(victim, "root", 4);
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
        name_in(&dir, names[i], path);
        unlink(path);
        CHECK(link(victim, path) == 0);
    }
    CHECK(directory_run(&dir, "--repair", text, sizeof text) == 0);
    d = directory_daemon(&dir, NULL);
    carry_out(&d, "FOLLOW 127.0.0.1 1\nFOLLOW NONE\nADD t 1 1\nSNAPSHOT\n");
    daemon_stop(&d, SIGTERM);
    char *bytes = file_read(victim, &n);
    CHECK(n == 4 && memcmp(bytes, "root", 4) == 0);
    free(bytes);
    directory_remove(&dir);
    directory_remove(&outside);
}

/* ---- what is missing ---- */

/* Removes or changes one file; --check, a start and --repair name it, and then the directory is good. */
static void check_noticed(const struct directory *dir, const char *says, bool starts)
{
    char text[4000];
    int status = directory_run(dir, "--check", text, sizeof text);
    CHECK_MSG(status == 1 && strstr(text, "not good") && strstr(text, says), "%s", text);
    if (!starts)
        CHECK_MSG(directory_run(dir, "--data", text, sizeof text) == 1 && strstr(text, says), "%s",
                  text);
    CHECK_MSG(directory_run(dir, "--repair", text, sizeof text) == 0 && strstr(text, says), "%s",
              text);
    CHECK_MSG(directory_run(dir, "--check", text, sizeof text) == 0, "%s", text);
    struct daemon d = directory_daemon(dir, NULL);
    CHECK(daemon_stop(&d, SIGTERM) == 0);
}

static struct directory stopped_with_points(const char *policy, int sig, char log[128])
{
    const char *const arguments[] = {"--fsync", policy, NULL};
    struct directory dir = directory_new();
    struct daemon d = directory_daemon(&dir, arguments);
    for (int i = 0; i < 4; i++) /* one after the other's reply */
        carry_out(&d, "ADD t 1 1\n");
    daemon_stop(&d, sig);
    CHECK(directory_file(&dir, "log.", 0, log));
    return dir;
}

TEST(only_log_that_is_missing_is_a_loss)
{
    char log[128];
    struct directory dir = stopped_with_points("always", SIGTERM, log);
    CHECK(unlink(log) == 0);
    check_noticed(&dir, "every change is lost", false);
    directory_remove(&dir);
}

TEST(only_log_that_is_empty_or_noise_is_a_loss)
{
    static const size_t sizes[] = {0, 1, 31, 32, 64, 4000};
    for (size_t i = 0; i < sizeof sizes / sizeof sizes[0]; i++) {
        char log[128], noise[4000];
        struct directory dir = stopped_with_points("always", SIGTERM, log);
        for (size_t at = 0; at < sizes[i]; at++)
            noise[at] = (char)test_random();
        file_write(log, noise, sizes[i]);
        check_noticed(&dir, "log.0000000000000001", false);
        directory_remove(&dir);
    }
}

/* By the policy everysec no record says yet that the ones before it were synced. */
TEST(change_that_is_damaged_in_the_middle_is_a_loss_by_every_policy)
{
    static const char *const policies[] = {"always", "everysec", "no"};
    for (size_t i = 0; i < sizeof policies / sizeof policies[0]; i++) {
        for (size_t back = 1; back <= 3; back++) {
            char log[128];
            size_t n;
            struct directory dir = stopped_with_points(policies[i], SIGKILL, log);
            char *bytes = file_read(log, &n);
            size_t one = (n - SEGMENT_HEADER) / 4;
            bytes[n - one * back + test_below((uint32_t)one)] ^= (char)(1 << test_below(8));
            file_write(log, bytes, n);
            free(bytes);
            check_noticed(&dir, "log.0000000000000001", i > 0 || back == 1);
            directory_remove(&dir);
        }
    }
}

TEST(directory_that_no_daemon_has_used_or_that_was_killed_at_once_is_good)
{
    char text[2000], log[128];
    struct directory dir = directory_new();
    CHECK_MSG(directory_run(&dir, "--check", text, sizeof text) == 0, "%s", text);
    struct daemon d = directory_daemon(&dir, NULL);
    daemon_stop(&d, SIGKILL);
    CHECK_MSG(directory_run(&dir, "--check", text, sizeof text) == 0, "%s", text);
    directory_remove(&dir);
    dir = stopped_with_points("everysec", SIGKILL, log);
    CHECK_MSG(directory_run(&dir, "--check", text, sizeof text) == 0, "%s", text);
    CHECK(truncate(log, SEGMENT_HEADER + 100) == 0); /* within a record: a torn end */
    CHECK_MSG(directory_run(&dir, "--check", text, sizeof text) == 0, "%s", text);
    directory_remove(&dir);
}
