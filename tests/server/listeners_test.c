/* listeners_test.c - accepting connections when that fails, or when there are too many.
 * tests/faults/syscall_shim.c, found through SYSCALL_SHIM, makes calls fail. */
#include "tests/server/daemon.h"
#include "tests/server/said.h"
#include "tests/test.h"

#include <errno.h>
#include <fcntl.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <unistd.h>

/* The shim and the test share the number of system calls so far and the errno of accept4. */
struct shared {
    volatile uint64_t calls, accept_errno;
};

static struct daemon start_with_shim(struct shared **shared)
{
    char path[] = "/tmp/delaunayd-calls-XXXXXX";
    int fd = mkstemp(path);
    CHECK(fd >= 0 && ftruncate(fd, 4096) == 0);
    void *at = mmap(NULL, 4096, PROT_READ | PROT_WRITE, MAP_SHARED, fd, 0);
    CHECK(at != MAP_FAILED && getenv("SYSCALL_SHIM") != NULL);
    setenv("LD_PRELOAD", getenv("SYSCALL_SHIM"), 1);
    setenv("SYSCALLS_FILE", path, 1);
    struct daemon d = daemon_start(NULL);
    unsetenv("LD_PRELOAD");
    close(fd);
    unlink(path);
    *shared = at;
    return d;
}

TEST(accepting_that_fails_for_a_while_costs_nothing_and_goes_on)
{
    static const int errors[] = {ENOMEM, ENOBUFS, ENFILE, EMFILE};
    struct shared *shared;
    if (test_is_sanitized())
        SKIP("a sanitizer intercepts the program's calls");
    struct daemon d = start_with_shim(&shared);
    int known = daemon_connect(&d);
    say(known, "PING\n");
    expect(known, "OK 0\n");
    for (size_t i = 0; i < sizeof errors / sizeof errors[0]; i++) {
        shared->accept_errno = (uint64_t)errors[i];
        uint64_t before = shared->calls;
        int fd = daemon_connect(&d);
        say(fd, "PING\n");
        pause_ms(300);
        CHECK_MSG(shared->calls - before < 60, "%s: %d calls in 0.3 s", strerror(errors[i]),
                  (int)(shared->calls - before));
        say(known, "PING\n");
        expect(known, "OK 0\n");
        shared->accept_errno = 0;
        expect(fd, "OK 0\n");
        close(fd);
    }
    daemon_end(&d);
}

TEST(clients_without_a_descriptor_fill_no_log)
{
    enum { CLIENTS = 90, ROUNDS = 5 };
    int fd[CLIENTS];
    struct said said = said_begin();
    struct daemon d = daemon_start(NULL);
    said_end(&said);
    int known = daemon_connect(&d);
    say(known, "PING\n");
    expect(known, "OK 0\n");
    double start = seconds();
    struct rlimit few = {64, 64};
    CHECK(prlimit(d.pid, RLIMIT_NOFILE, &few, NULL) == 0);
    for (int round = 0; round < ROUNDS; round++) {
        for (int i = 0; i < CLIENTS; i++) {
            fd[i] = daemon_connect(&d);
            say(fd[i], "PING\n");
        }
        for (int i = 0; i < CLIENTS; i++) /* nobody leaves before all have an answer */
            hear_line(fd[i]);
        for (int i = 0; i < CLIENTS; i++)
            close(fd[i]);
        while (info_of(known, "clients") > 1)
            pause_ms(10);
    }
    CHECK(info_of(known, "refused") > ROUNDS * 20);
    double took = seconds() - start; /* there is a message a second at most */
    daemon_end(&d);
    unsigned lines = said_lines(&said, "");
    CHECK_MSG(lines >= 1 && lines <= 3 + took, "%u lines in %.1f s", lines, took);
}
