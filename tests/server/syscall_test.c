/* syscall_test.c - how many system calls a request costs, counted by tests/faults/syscall_shim.c,
 * which is found through SYSCALL_SHIM. */
#include "tests/server/daemon.h"
#include "tests/test.h"

#include <fcntl.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

/* A daemon that counts its calls in *calls. */
static struct daemon start_counting(const volatile uint64_t **calls)
{
    char path[] = "/tmp/delaunayd-calls-XXXXXX";
    int fd = mkstemp(path);
    CHECK(fd >= 0 && ftruncate(fd, 4096) == 0);
    void *at = mmap(NULL, 4096, PROT_READ, MAP_SHARED, fd, 0);
    CHECK(at != MAP_FAILED && getenv("SYSCALL_SHIM") != NULL);
    setenv("LD_PRELOAD", getenv("SYSCALL_SHIM"), 1);
    setenv("SYSCALLS_FILE", path, 1);
    struct daemon d = daemon_start(NULL);
    unsetenv("LD_PRELOAD");
    close(fd);
    unlink(path);
    *calls = at;
    return d;
}

/* Sends `rounds` batches of `depth` requests, each when the one before has been answered; returns
 * the calls per request. */
static double calls_per_request(const struct daemon *d, const volatile uint64_t *calls,
                                const char *request, const char *reply, int depth, int rounds)
{
    char *batch = calloc((size_t)depth, strlen(request) + 1);
    char *want = calloc((size_t)depth, strlen(reply) + 1);
    int fd = daemon_connect(d);
    CHECK(batch != NULL && want != NULL);
    for (int i = 0; i < depth; i++) {
        strcat(batch, request);
        strcat(want, reply);
    }
    say(fd, request);
    expect(fd, reply);
    uint64_t before = *calls;
    for (int i = 0; i < rounds; i++) {
        say(fd, batch);
        expect(fd, want);
    }
    uint64_t after = *calls;
    close(fd);
    free(batch);
    free(want);
    CHECK(after > before);
    return (double)(after - before) / (depth * rounds);
}

TEST(requests_cost_few_system_calls)
{
    const volatile uint64_t *calls;
    if (test_is_sanitized())
        SKIP("a sanitizer intercepts the program's calls");
    struct daemon d = start_counting(&calls);
    converse(&d, "ADD t 1 2\n", "OK 0 first=0 added=1 coincident=0\n");
    double single = calls_per_request(&d, calls, "PING\n", "OK 0\n", 1, 2000);
    CHECK_MSG(single <= 3.1, "%.3f one by one", single);
    double lines = calls_per_request(&d, calls, "GET t 0\n", "OK 1\n0 1 2\n", 64, 200);
    CHECK_MSG(lines <= 0.1, "%.3f pipelined", lines);
    double resp = calls_per_request(&d, calls, "*1\r\n$4\r\nPING\r\n", "+PONG\r\n", 64, 200);
    CHECK_MSG(resp <= 0.1, "%.3f pipelined in RESP", resp);
}
