/* private_daemon_test.c - starting a private daemon fails with a reason. */
#include "clients/cli/private_daemon.h"

#include <errno.h>
#include <string.h>
#include <sys/resource.h>
#include <unistd.h>

#include "tests/test.h"

/* Leaves room for n more open files. */
static void limit_files(unsigned n)
{
    int next = dup(0);
    CHECK(next >= 0 && close(next) == 0);
    struct rlimit limit = {(rlim_t)next + n, (rlim_t)next + n};
    CHECK(setrlimit(RLIMIT_NOFILE, &limit) == 0);
}

static void check_refused(const char *reason)
{
    struct private_daemon d;
    char why[300] = "";
    CHECK(!private_daemon_start(&d, why, sizeof why));
    CHECK_MSG(strstr(why, reason) != NULL, "%s", why);
}

TEST(private_daemon_says_that_it_cannot_make_its_first_pipe)
{
    limit_files(1);
    check_refused(strerror(EMFILE));
}

TEST(private_daemon_says_that_it_cannot_make_its_second_pipe)
{
    limit_files(2);
    check_refused(strerror(EMFILE));
}

TEST(private_daemon_says_that_its_program_is_missing)
{
    setenv("DELAUNAYD", "/nonexistent/delaunayd", 1);
    check_refused(strerror(ENOENT));
}

TEST(private_daemon_says_that_its_program_is_another_one)
{
    setenv("DELAUNAYD", "/bin/echo", 1);
    check_refused("it is not a daemon");
}
