/* failing_disk_test.c - a disk that fails at any moment: nothing acknowledged is lost, and the daemon
 * continues when the disk works again. The disk is tests/faults/disk_shim.c, found through
 * DISK_SHIM. */
#include "tests/server/directory.h"
#include "tests/test.h"

#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <signal.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

/* ---- a ledger of requests and their outcomes ---- */

enum fate { REFUSED, ACKNOWLEDGED, UNKNOWN };

enum { EDITS = 24, GROUP = 3 };

/* Edit number k adds GROUP points at (k, 1..GROUP), or, if k % 4 == 3, deletes the points of k - 2. */
struct ledger {
    enum fate fate[EDITS];
    uint32_t first[EDITS]; /* of an ACKNOWLEDGED addition */
};

static bool deletes(int k)
{
    return k % 4 == 3;
}

static bool send_all(int fd, const char *text)
{
    size_t n = strlen(text);
    return send(fd, text, n, MSG_NOSIGNAL) == (ssize_t)n;
}

/* A line, or an empty one if the connection is closed. */
static void hear_reply(int fd, char *line, size_t size)
{
    size_t n = 0;
    while (n + 1 < size && recv(fd, line + n, 1, 0) == 1 && line[n] != '\n')
        n++;
    line[n] = '\0';
}

/* Repeats the request until it is not refused, for a few seconds. */
static enum fate ask(const struct daemon *d, int *fd, const char *request, char *reply, size_t size)
{
    for (unsigned tries = 0; tries < 400 * test_slowness(); tries++, pause_ms(10)) {
        bool sent = send_all(*fd, request);
        reply[0] = '\0';
        if (sent)
            hear_reply(*fd, reply, size);
        if (strncmp(reply, "OK", 2) == 0)
            return ACKNOWLEDGED;
        if (strncmp(reply, "ERR READONLY", 12) == 0 || strncmp(reply, "ERR BUSY", 8) == 0 ||
            strncmp(reply, "ERR LOADING", 11) == 0)
            continue;
        if (strncmp(reply, "ERR NOSET", 9) == 0) /* an earlier attempt did it */
            return REFUSED;
        CHECK_MSG(reply[0] == '\0' || strncmp(reply, "ERR IO", 6) == 0, "%s", reply);
        close(*fd);
        *fd = daemon_connect(d);
        return UNKNOWN;
    }
    return REFUSED;
}

static void edit(const struct daemon *d, int *fd, struct ledger *l, int k)
{
    char request[200], reply[300];
    if (deletes(k)) {
        uint32_t first = l->first[k - 2];
        l->fate[k] = REFUSED;
        if (l->fate[k - 2] != ACKNOWLEDGED)
            return;
        snprintf(request, sizeof request, "DEL t %" PRIu32 " %" PRIu32 " %" PRIu32 "\n", first,
                 first + 1, first + 2);
    } else {
        snprintf(request, sizeof request, "ADD t %d 1 %d 2 %d 3\n", k, k, k);
    }
    l->fate[k] = ask(d, fd, request, reply, sizeof reply);
    if (l->fate[k] == ACKNOWLEDGED && !deletes(k))
        CHECK(sscanf(reply, "OK 0 first=%" SCNu32, &l->first[k]) == 1);
}

/* Either all points of the group exist with the reported ids, or no point of the group exists. */
static void check_group(const struct ledger *l, int k, const char *points)
{
    int there = 0;
    uint32_t id;
    for (int i = 1; i <= GROUP; i++) {
        char place[32];
        snprintf(place, sizeof place, " %d %d\n", k, i);
        const char *at = strstr(points, place);
        if (at == NULL)
            continue;
        there++;
        while (at > points && at[-1] != '\n')
            at--;
        CHECK(sscanf(at, "%" SCNu32, &id) == 1);
        CHECK(l->fate[k] != ACKNOWLEDGED || id == l->first[k] + (uint32_t)i - 1);
    }
    enum fate removal = k % 4 == 1 && k + 2 < EDITS ? l->fate[k + 2] : REFUSED;
    CHECK_MSG(there == 0 || there == GROUP, "%d of group %d", there, k);
    CHECK_MSG(there == GROUP || l->fate[k] != ACKNOWLEDGED || removal != REFUSED,
              "group %d was acknowledged and is not there", k);
    CHECK_MSG(there == 0 || (l->fate[k] != REFUSED && removal != ACKNOWLEDGED),
              "group %d is there, but should not be", k);
}

/* The reply to POINTS, once the daemon has read its directory, which may take a while on a busy
 * machine. */
static char *points_of(const struct daemon *d)
{
    for (;; pause_ms(10)) {
        size_t n;
        int fd = daemon_connect(d);
        say(fd, "POINTS t\n");
        shutdown(fd, SHUT_WR);
        char *points = hear_all(fd, &n);
        close(fd);
        if (strncmp(points, "ERR LOADING ", 12) != 0)
            return points;
        free(points);
    }
}

static void check_ledger(const struct directory *dir, const struct ledger *l)
{
    struct daemon d = directory_daemon(dir, NULL);
    char *points = points_of(&d);
    CHECK_MSG(strncmp(points, "OK ", 3) == 0 || strncmp(points, "ERR NOSET ", 10) == 0, "%s",
              points);
    for (int k = 0; k < EDITS; k++)
        if (!deletes(k))
            check_group(l, k, points);
    free(points);
    daemon_stop(&d, SIGKILL);
}

/* ---- the disk ---- */

static void set_disk(const struct directory *dir, const char *op, long nth, long times, int error)
{
    char number[32];
    setenv("LD_PRELOAD", getenv("DISK_SHIM"), 1);
    setenv("ASAN_OPTIONS", "verify_asan_link_order=0", 1);
    setenv("DISK_DIR", dir->path, 1);
    setenv("DISK_OP", op, 1);
    snprintf(number, sizeof number, "%ld", nth);
    setenv("DISK_NTH", number, 1);
    snprintf(number, sizeof number, "%ld", times);
    setenv("DISK_TIMES", number, 1);
    snprintf(number, sizeof number, "%d", error);
    setenv("DISK_ERRNO", number, 1);
}

/* One life of a daemon on a disk that fails. Whether the disk has failed at all. */
static bool live(const char *op, long nth, long times, int error)
{
    struct ledger l = {0};
    char path[128], fired[140], reply[300];
    struct directory dir = directory_new();
    struct daemon d;
    set_disk(&dir, op, nth, times, error);
    snprintf(fired, sizeof fired, "%s.fired", dir.path);
    setenv("DISK_FIRED", fired, 1);
    bool started = directory_try(&dir, NULL, &d);
    unsetenv("LD_PRELOAD");
    bool failed = access(fired, F_OK) == 0;
    CHECK_MSG(started || failed, "it did not start, and the disk was good");
    if (started) {
        int fd = daemon_connect(&d);
        for (int k = 0; k < EDITS; k++) {
            edit(&d, &fd, &l, k);
            if (k == EDITS / 2)
                ask(&d, &fd, "SNAPSHOT\n", reply, sizeof reply);
            while (k == EDITS / 2 && daemon_info(&d, "snapshot_running") != 0)
                pause_ms(2);
        }
        CHECK_MSG(l.fate[EDITS - 2] == ACKNOWLEDGED, "%s %ld: it does not go on", op, nth);
        failed = access(fired, F_OK) == 0;
        daemon_stop(&d, SIGKILL);
    }
    check_ledger(&dir, &l);
    CHECK(!directory_file(&dir, "damaged.", 0, path));
    unlink(fired);
    directory_remove(&dir);
    return failed;
}

static void fail_every(const char *op, long times, int error, long least)
{
    long n = 1;
    while (live(op, n, times, error))
        n++;
    CHECK_MSG(n > least, "only %ld calls of %s", n - 1, op);
}

TEST_TIMEOUT(every_write_may_fail, 120)
{
    fail_every("write", 1, EIO, 20);
}

TEST_TIMEOUT(every_write_may_be_cut_short, 120)
{
    fail_every("short", 1, EIO, 20);
}

TEST_TIMEOUT(every_sync_may_fail, 120)
{
    fail_every("sync", 1, EIO, 20);
}

TEST_TIMEOUT(every_rename_may_fail, 60)
{
    fail_every("rename", 1, EIO, 1);
}

TEST_TIMEOUT(every_open_may_fail, 60)
{
    fail_every("open", 1, EMFILE, 3);
}

TEST_TIMEOUT(disk_may_fail_several_times_in_a_row, 60)
{
    live("sync", 7, 3, EIO);
    live("write", 9, 3, EIO);
}

/* With the disk full, requests that free space still work, and the others when there is space again. */
TEST_TIMEOUT(full_disk_lets_points_be_deleted, 60)
{
    struct ledger l = {0};
    char reply[300];
    struct directory dir = directory_new();
    struct daemon d;
    set_disk(&dir, "write", 6, 1, ENOSPC);
    CHECK(directory_try(&dir, NULL, &d));
    unsetenv("LD_PRELOAD");
    int fd = daemon_connect(&d);
    for (int k = 0; k < EDITS; k++)
        edit(&d, &fd, &l, k);
    CHECK(l.fate[EDITS - 1] == ACKNOWLEDGED);
    CHECK(daemon_info(&d, "log_failures") == 0); /* the reserve was enough */
    CHECK(ask(&d, &fd, "PING\n", reply, sizeof reply) == ACKNOWLEDGED);
    daemon_stop(&d, SIGKILL);
    check_ledger(&dir, &l);
    directory_remove(&dir);
}

TEST_TIMEOUT(file_size_limit_makes_the_daemon_read_only_not_dead, 60)
{
    char reply[300];
    uint32_t kept = 0;
    struct directory dir = directory_new();
    struct rlimit old, small = {2000, 2000};
    CHECK(getrlimit(RLIMIT_FSIZE, &old) == 0);
    small.rlim_max = old.rlim_max;
    CHECK(setrlimit(RLIMIT_FSIZE, &small) == 0);
    struct daemon d = directory_daemon(&dir, NULL);
    setrlimit(RLIMIT_FSIZE, &old);
    int fd = daemon_connect(&d);
    for (int i = 0; i < 200; i++) {
        char request[64];
        snprintf(request, sizeof request, "ADD t %d 1\n", i);
        if (!send_all(fd, request))
            break;
        hear_reply(fd, reply, sizeof reply);
        if (strncmp(reply, "OK", 2) != 0)
            break;
        kept++;
    }
    CHECK(strncmp(reply, "ERR ", 4) == 0 && kept > 10);
    close(fd);
    converse(&d, "GET t 1\n", "OK 1\n1 1 1\n");
    daemon_stop(&d, SIGKILL);
    d = directory_daemon(&dir, NULL);
    uint32_t there = 0;
    fd = daemon_connect(&d);
    say(fd, "SETS\n");
    hear_line(fd);
    CHECK(sscanf(hear_line(fd), "t points=%" SCNu32, &there) == 1 && there >= kept);
    daemon_stop(&d, SIGKILL);
    directory_remove(&dir);
}

/* A load that does not fit, even into the reserve: it is not acknowledged, nothing else is lost,
 * and after dropping the set the daemon works again. */
TEST_TIMEOUT(load_that_fills_the_disk_is_not_acknowledged, 60)
{
    struct ledger l = {0};
    char reply[300];
    struct directory dir = directory_new();
    struct daemon d;
    set_disk(&dir, "write", 5, 4, ENOSPC);
    CHECK(directory_try(&dir, NULL, &d));
    unsetenv("LD_PRELOAD");
    int fd = daemon_connect(&d), other = daemon_connect(&d);
    for (int k = 0; k < 3; k++)
        edit(&d, &fd, &l, k);
    char head[] = "LOADB big 70000\n";
    double *xy = calloc(140000, sizeof *xy);
    say(other, head);
    say_bytes(other, xy, 140000 * sizeof *xy);
    free(xy);
    do /* a slow machine reports the progress */
        hear_reply(other, reply, sizeof reply);
    while (reply[0] == '#');
    CHECK_MSG(strncmp(reply, "ERR ", 4) == 0, "%s", reply);
    close(other);
    while (ask(&d, &fd, "DROP big\n", reply, sizeof reply) == UNKNOWN)
        pause_ms(10);
    for (int k = 3; k < EDITS; k++)
        edit(&d, &fd, &l, k);
    CHECK(l.fate[EDITS - 1] == ACKNOWLEDGED);
    daemon_stop(&d, SIGKILL);
    check_ledger(&dir, &l);
    d = directory_daemon(&dir, NULL);
    converse(&d, "STAT big\n", "ERR NOSET there is no set big\n");
    daemon_stop(&d, SIGKILL);
    directory_remove(&dir);
}

/* A daemon whose log fails with its second ADD, as do all attempts to recover. */
static struct daemon start_failing(const struct directory *dir, const char *op, long nth, int error)
{
    struct daemon d;
    set_disk(dir, op, nth, 1000000, error);
    CHECK(directory_try(dir, NULL, &d));
    unsetenv("LD_PRELOAD");
    carry_out(&d, "ADD t 0 0  1 1\n");
    return d;
}

static void expect_refusals(struct daemon *d, const struct directory *dir, const char *want)
{
    char reply[300];
    int loader = daemon_connect(d), fd = daemon_connect(d);
    say(loader, "LOAD t\n3 3\n"); /* begun before the failure */
    say(fd, "ADD t 2 2\n");
    hear_reply(fd, reply, sizeof reply);
    CHECK_MSG(strncmp(reply, "ERR IO", 6) == 0, "%s", reply);
    say(loader, "4 4\n.\n");
    hear_reply(loader, reply, sizeof reply);
    CHECK_MSG(strncmp(reply, "ERR READONLY", 12) == 0, "%s", reply);
    converse(d, "GET t 0\n", "OK 1\n0 0 0\n");
    close(fd);
    fd = daemon_connect(d);
    say(fd, want);
    hear_reply(fd, reply, sizeof reply);
    CHECK_MSG(strncmp(reply, "ERR READONLY", 12) == 0, "%s", reply);
    CHECK(daemon_info(d, "snapshot_failures") > 0);
    close(fd);
    close(loader);
    daemon_stop(d, SIGKILL);
    directory_remove(dir);
}

TEST(failed_log_takes_no_change_not_even_one_that_frees_space)
{
    struct directory dir = directory_new();
    struct daemon d = start_failing(&dir, "sync", 4, EIO);
    expect_refusals(&d, &dir, "DEL t 0\n");
}

TEST(full_disk_takes_no_change_that_needs_space)
{
    struct directory dir = directory_new();
    struct daemon d = start_failing(&dir, "write", 3, ENOSPC);
    expect_refusals(&d, &dir, "MOVE t 0 5 5\n");
}

/* Waits until a process listens at the path. */
static int await_unix(const char *path)
{
    int fd;
    for (unsigned tries = 0; (fd = connect_unix(path)) < 0; tries++) {
        CHECK(tries < 1000 * test_slowness());
        pause_ms(2);
    }
    return fd;
}

/* The ready line waits for a second, so the Unix socket is there first. */
TEST_TIMEOUT(clients_get_an_error_while_the_directory_is_read, 60)
{
    char path[128];
    struct directory dir = directory_new();
    struct daemon d = directory_daemon(&dir, NULL);
    carry_out(&d, "ADD t 1 1\nADD t 2 2\nTRIANGULATE t\n");
    daemon_stop(&d, SIGKILL);
    snprintf(path, sizeof path, "%s/socket", dir.path);
    set_disk(&dir, "stall", 4, 1, 1500); /* longer than the conversation below, on a busy machine */
    pid_t pid = fork();
    CHECK(pid >= 0);
    if (pid == 0) {
        close(STDOUT_FILENO);
        open("/dev/null", O_WRONLY);
        execl(getenv("DELAUNAYD"), "delaunayd", "--port", "0", "--data", dir.path, "--unix", path,
              (char *)NULL);
        _exit(127);
    }
    unsetenv("LD_PRELOAD");
    int fd = await_unix(path);
    say(fd, "PING\nPOINTS t\nSETS\nADD t 3 3\nPING\n");
    expect(fd, "OK 0\nERR LOADING the data directory is being read");
    hear_line(fd);
    CHECK(strncmp(hear_line(fd), "ERR LOADING", 11) == 0);
    CHECK(strncmp(hear_line(fd), "ERR LOADING", 11) == 0);
    expect(fd, "OK 0\n");
    say(fd, "INFO\n");
    while (strcmp(hear_line(fd), "durability:loading") != 0)
        ;
    close(fd);
    fd = await_unix(path);
    const char *reply;
    do {
        say(fd, "NEAREST t 0 0\n");
        reply = hear_line(fd);
    } while (strncmp(reply, "ERR LOADING", 11) == 0);
    CHECK_STR(reply, "OK 1");
    kill(pid, SIGKILL);
    CHECK(waitpid(pid, NULL, 0) == pid);
    directory_remove(&dir);
}
