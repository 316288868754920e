/* full_disk_test.c - the requests that still work, and the reports, while the disk is full. */
#include "tests/server/follow/node.h"
#include "tests/test.h"

#include <errno.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

/* The next daemon has a disk in this directory that is full from its n-th write on. */
static void fill_disk(const struct directory *dir, unsigned nth)
{
    char number[16];
    setenv("LD_PRELOAD", getenv("DISK_SHIM"), 1);
    setenv("ASAN_OPTIONS", "verify_asan_link_order=0", 1);
    setenv("DISK_DIR", dir->path, 1);
    setenv("DISK_OP", "write", 1);
    setenv("DISK_TIMES", "1000000", 1);
    snprintf(number, sizeof number, "%u", nth);
    setenv("DISK_NTH", number, 1);
    snprintf(number, sizeof number, "%d", ENOSPC);
    setenv("DISK_ERRNO", number, 1);
}

TEST(temporary_sets_are_possible_while_the_disk_is_full)
{
    struct directory dir = directory_new();
    fill_disk(&dir, 3);
    struct daemon d = directory_daemon(&dir, NULL);
    unsetenv("LD_PRELOAD");
    carry_out(&d, "ADD t 0 0 1 1\n");
    int fd = daemon_connect(&d);
    say(fd, "ADD t 2 2\n");
    CHECK(strncmp(hear_line(fd), "ERR IO", 6) == 0);
    close(fd);
    fd = daemon_connect(&d);
    say(fd,
        "CREATE u\nCREATE v TOL 0.5 TEMPORARY\nADD v 0 0 4 0 0 4 0.1 0\nTRIANGULATE v\nDROP v\n");
    CHECK(strncmp(hear_line(fd), "ERR READONLY", 12) == 0);
    CHECK(strncmp(hear_line(fd), "OK 0 version=", 13) == 0);
    CHECK(strncmp(hear_line(fd), "OK 0 first=0 added=4 coincident=1", 33) == 0);
    CHECK(strncmp(hear_line(fd), "OK 0 points=4 ", 14) == 0);
    CHECK_STR(hear_line(fd), "OK 0");
    close(fd);
    daemon_stop(&d, SIGKILL);
    directory_remove(&dir);
}

TEST_TIMEOUT(follower_whose_disk_is_full_says_so, 60)
{
    char address[32], why[FACT];
    struct node l = node_new(NULL), f = {.dir = directory_quick()};
    snprintf(address, sizeof address, "127.0.0.1:%u", l.d.port);
    strcpy(f.d.port_text, "0");
    fill_disk(&f.dir, 8);
    node_start(&f, (const char *const[]){"--follow", address, NULL});
    unsetenv("LD_PRELOAD");
    node_await(&l, "followers", "1");
    why[0] = '\0';
    for (unsigned i = 0; i < node_tries() && strstr(why, "No space left") == NULL; i++) {
        carry_out(&l.d, "ADD t 1 1\n");
        pause_ms(10);
        node_fact(&f, "link_error", why);
    }
    CHECK_STR(why, "changes cannot be saved here: No space left on device");
    daemon_stop(&f.d, SIGKILL);
    directory_remove(&f.dir);
    node_end(&l);
}

/* Permissions bind the daemon also if root runs the test. */
static void run_bound(const char *data)
{
    enum {
        OVERRIDE = 1,
        READ_SEARCH = 2
    }; /* CAP_DAC_...; not every C library has Linux's headers */
    prctl(PR_CAPBSET_DROP, OVERRIDE, 0, 0, 0);
    prctl(PR_CAPBSET_DROP, READ_SEARCH, 0, 0, 0);
    execl(getenv("DELAUNAYD"), "delaunayd", "--port", "0", "--data", data, (char *)NULL);
    _exit(127);
}

TEST(start_that_fails_for_want_of_a_permission_names_the_file)
{
    char path[128], text[600] = "";
    int status;
    struct directory dir = directory_new();
    struct daemon d = directory_daemon(&dir, NULL);
    carry_out(&d, "ADD t 0 0 1 1\n");
    daemon_stop(&d, SIGKILL);
    CHECK(directory_file(&dir, "log.", 0, path) && chmod(path, 0400) == 0);
    FILE *err = tmpfile();
    CHECK(err != NULL);
    pid_t pid = fork();
    CHECK(pid >= 0);
    if (pid == 0) {
        dup2(fileno(err), STDERR_FILENO);
        run_bound(dir.path);
    }
    CHECK(waitpid(pid, &status, 0) == pid && WIFEXITED(status));
    CHECK_MSG(WEXITSTATUS(status) == 1, "status %d", WEXITSTATUS(status));
    rewind(err);
    text[fread(text, 1, sizeof text - 1, err)] = '\0';
    CHECK_MSG(strstr(text, strrchr(path, '/') + 1) != NULL && strstr(text, "Permission denied"),
              "%s", text);
    fclose(err);
    directory_remove(&dir);
}
