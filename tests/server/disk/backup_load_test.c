/* backup_load_test.c - backups that are interrupted, that fail, or are made under load: a backup is complete or does
 * not exist. Also what a copy of all files is worth. The disk is tests/faults/disk_shim.c. */
#include "tests/faults/tree.h"
#include "tests/server/disk/backup_bench.h"
#include "tests/test.h"

#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <signal.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

/* ---- interruptions ---- */

static void set_disk(const struct bench *b, const char *op, long nth, int error)
{
    char number[32];
    setenv("LD_PRELOAD", getenv("DISK_SHIM"), 1);
    setenv("ASAN_OPTIONS", "verify_asan_link_order=0", 1);
    setenv("DISK_DIR", b->backups, 1);
    setenv("DISK_OP", op, 1);
    snprintf(number, sizeof number, "%ld", nth);
    setenv("DISK_NTH", number, 1);
    snprintf(number, sizeof number, "%d", error);
    setenv("DISK_ERRNO", number, 1);
}

static bool is_empty(const char *path)
{
    struct tree t = tree_read(path);
    bool empty = t.names == 0;
    tree_free(&t);
    return empty;
}

/* The n-th operation of the backup fails; whether there was one. */
static bool fail_once(const char *op, long nth, int error)
{
    struct bench b;
    struct directory root = directory_quick();
    begin_on(&b, root, root.path);
    CHECK(mkdir(b.backups, 0700) == 0);
    set_disk(&b, op, nth, error);
    start(&b, NULL);
    unsetenv("LD_PRELOAD");
    carry_out(&b.d, backup_history);
    snapshot(&b.d, 1);
    carry_out(&b.d, "ADD t 8 8\n");
    char *want = directory_state(&b.d, backup_names);
    const char *reply = ask(&b.d, "BACKUP x\n");
    bool failed = strncmp(reply, "OK ", 3) != 0;
    if (failed) {
        CHECK_MSG(strncmp(reply, "ERR IO the backup cannot be written: ", 37) == 0, "%s", reply);
        CHECK_MSG(is_empty(b.backups), "%s %ld", op, nth);
        CHECK(daemon_info(&b.d, "backups") == 0);
        expect_reply(&b.d, "ADD t 1 2\nDEL t 9\n", "OK 0 ");
        expect_reply(&b.d, "DEL t 9\n", "ERR NOPOINT ");
        expect_reply(&b.d, "BACKUP x\n", "OK 0 ");
    } else {
        check_restored(&b, "x", want);
    }
    free(want);
    end(&b);
    return failed;
}

static void fail_every(const char *op, int error, long least)
{
    long n = 1;
    while (fail_once(op, n, error))
        n++;
    CHECK_MSG(n > least, "%s: only %ld failures", op, n - 1);
}

TEST(full_disk_leaves_no_backup_and_no_part_of_one)
{
    fail_every("write", ENOSPC, 1);
}

TEST(backup_that_cannot_be_made_durable_does_not_exist)
{
    fail_every("sync", EIO, 3); /* the file, its directory, the directory of backups */
    fail_every("rename", EIO, 1);
    long failures = 0;
    for (long n = 1; n <= 10; n++)
        failures += fail_once("open", n, EIO);
    CHECK_MSG(failures >= 2, "%ld", failures); /* its directory, and the segment in it */
}

static void stall(const struct bench *b, char gate[100])
{
    snprintf(gate, 100, "%s/gate", b->root.path);
    setenv("LD_PRELOAD", getenv("DISK_SHIM"), 1);
    setenv("ASAN_OPTIONS", "verify_asan_link_order=0", 1);
    setenv("DISK_DIR", b->backups, 1);
    setenv("DISK_GATE", gate, 1);
    file_write(gate, "", 0);
}

/* A backup that has stalled in the middle of its work. */
static int stalled_backup(struct bench *b, char gate[100])
{
    struct directory root = directory_quick();
    begin_on(b, root, root.path);
    stall(b, gate);
    start(b, NULL);
    unsetenv("LD_PRELOAD");
    carry_out(&b->d, backup_history);
    snapshot(&b->d, 1);
    carry_out(&b->d, "ADD t 8 8\n");
    int fd = daemon_connect(&b->d);
    say(fd, "BACKUP x\n");
    struct directory part = backup_path(b, "x.tmp");
    char path[128];
    while (access(part.path, F_OK) != 0 || !directory_file(&part, "log.", 0, path))
        pause_ms(2);
    CHECK(!exists(b, "x"));
    return fd;
}

TEST(backup_delays_no_other_client_and_keeps_the_files_that_it_needs)
{
    struct bench b;
    char gate[100];
    int fd = stalled_backup(&b, gate);
    carry_out(&b.d, "ADD t 9 9\nTRIANGULATE t\n");
    snapshot(&b.d, 2);
    char path[128];
    CHECK(directory_file(&b.data, "snapshot.", 1, path));
    CHECK(unlink(gate) == 0);
    CHECK(number_in(hear_line(fd), "lsn=") == 12);
    CHECK(
        !directory_file(&b.data, "snapshot.", 1, path)); /* removed when the backup was complete */
    CHECK(directory_file(&b.data, "log.", 0, path) && !directory_file(&b.data, "log.", 1, path));
    struct directory x = backup_path(&b, "x");
    check_good(&x);
    close(fd);
    end(&b);
}

TEST(killed_daemon_leaves_no_backup_and_the_next_one_cleans_up)
{
    struct bench b;
    char gate[100];
    int fd = stalled_backup(&b, gate);
    daemon_stop(&b.d, SIGKILL);
    close(fd);
    CHECK(!exists(&b, "x") && exists(&b, "x.tmp"));
    CHECK(mkdir(backup_path(&b, "mine.tmp").path, 0700) == 0);
    file_write(backup_path(&b, "mine.tmp/me").path, "", 0);
    start(&b, NULL);
    char *want = directory_state(&b.d, backup_names);
    expect_reply(&b.d, "BACKUP y\n", "OK 0 ");
    CHECK(!exists(&b, "x") && !exists(&b, "x.tmp") && exists(&b, "y"));
    CHECK(exists(&b, "mine.tmp/me")); /* nothing else is removed */
    check_restored(&b, "y", want);
    free(want);
    end(&b);
}

TEST(stopping_daemon_cancels_a_backup)
{
    struct bench b;
    char gate[100];
    int fd = stalled_backup(&b, gate);
    kill(b.d.pid, SIGTERM);
    pause_ms(50);
    CHECK(unlink(gate) == 0);
    hear_line(fd);
    close(fd);
    int status;
    CHECK(waitpid(b.d.pid, &status, 0) == b.d.pid && WIFEXITED(status) && WEXITSTATUS(status) == 0);
    CHECK(!exists(&b, "x.tmp"));
    tree_remove(b.root.path);
}

/* ---- under load ---- */

/* A child that adds points (i, i * i % 1000), one by one; how many are acknowledged is in `*count`, which is shared. */
static pid_t start_adding(const struct daemon *d, int *acknowledged)
{
    int ends[2];
    CHECK(pipe2(ends, O_NONBLOCK) == 0);
    pid_t pid = fork();
    CHECK(pid >= 0);
    if (pid == 0) {
        close(ends[0]);
        int fd = daemon_connect(d);
        for (unsigned i = 0;; i++) {
            char request[60];
            snprintf(request, sizeof request, "ADD t %u %u\n", i, i * i % 1000);
            say(fd, request);
            if (strncmp(hear_line(fd), "OK ", 3) != 0 || write(ends[1], "", 1) != 1)
                _exit(1);
        }
    }
    close(ends[1]);
    *acknowledged = ends[0];
    while (daemon_info(d, "log_durable_lsn") < 100)
        pause_ms(2);
    return pid;
}

static void stop_adding(pid_t pid, int acknowledged)
{
    kill(pid, SIGKILL);
    CHECK(waitpid(pid, NULL, 0) == pid);
    close(acknowledged);
}

/* Adds the changes acknowledged since then to *n. */
static void count(int acknowledged, uint64_t *n)
{
    char bytes[4096];
    for (ssize_t got; (got = read(acknowledged, bytes, sizeof bytes)) > 0;)
        *n += (uint64_t)got;
}

/* The directory has the first points, at least `least` of them. */
static void check_beginning(const struct directory *dir, uint64_t least)
{
    char line[60];
    struct daemon d = directory_daemon(dir, NULL);
    int fd = daemon_connect(&d);
    say(fd, "POINTS t\n");
    uint64_t n = number_in(hear_line(fd), "OK ");
    CHECK_MSG(n >= least, "%" PRIu64 " points of %" PRIu64, n, least);
    for (unsigned i = 0; i < n; i++) {
        snprintf(line, sizeof line, "%u %u %u", i, i, i * i % 1000);
        CHECK_STR(hear_line(fd), line);
    }
    close(fd);
    daemon_stop(&d, SIGKILL);
}

static const char *const busy[] = {"--compact-at", "16k", NULL};

TEST(backup_during_edits_and_snapshots_has_everything_acknowledged_before_it)
{
    struct bench b;
    int acknowledged;
    uint64_t n = 0, least[12];
    char request[32];
    begin(&b, busy);
    pid_t pid = start_adding(&b.d, &acknowledged);
    for (int i = 0; i < 12; i++) {
        pause_ms(20);
        count(acknowledged, &n);
        least[i] = n;
        snprintf(request, sizeof request, "BACKUP n%d\n", i);
        const char *reply = ask(&b.d, request);
        CHECK_MSG(strncmp(reply, "OK ", 3) == 0 && number_in(reply, "lsn=") >= n, "%s", reply);
    }
    stop_adding(pid, acknowledged);
    daemon_stop(&b.d, SIGKILL);
    for (int i = 0; i < 12; i++) {
        char name[16];
        snprintf(name, sizeof name, "n%d", i);
        struct directory dir = backup_path(&b, name);
        check_good(&dir);
        check_beginning(&dir, least[i]);
    }
    tree_remove(b.root.path);
}

static void copy(const char *from, const char *to)
{
    int status;
    pid_t pid = fork();
    CHECK(pid >= 0);
    if (pid == 0) {
        execlp("cp", "cp", "-r", from, to, (char *)NULL);
        _exit(127);
    }
    CHECK(waitpid(pid, &status, 0) == pid && WIFEXITED(status) && WEXITSTATUS(status) == 0);
}

/* The daemon stands still, so this is like a snapshot of the file system: all files as they were at one moment.
 * A copy of a daemon that runs is worth less: files may be replaced between the listing and the copy. */
TEST(all_files_of_one_moment_are_a_backup)
{
    struct bench b;
    int acknowledged;
    uint64_t n = 0;
    begin(&b, busy);
    pid_t pid = start_adding(&b.d, &acknowledged);
    for (int i = 0; i < 12; i++) {
        struct directory to;
        snprintf(to.path, sizeof to.path, "%.50s/copy%d", b.root.path, i);
        pause_ms(10);
        count(acknowledged, &n);
        CHECK(kill(b.d.pid, SIGSTOP) == 0 && waitpid(b.d.pid, NULL, WUNTRACED) == b.d.pid);
        copy(b.data.path, to.path);
        CHECK(kill(b.d.pid, SIGCONT) == 0);
        check_good(&to);
        check_beginning(&to, n);
    }
    stop_adding(pid, acknowledged);
    end(&b);
}
