/* harness_test.c - the test harness itself: what CHECK_STR compares, and what the program that runs the tests counts. */
#include "tests/test.h"

#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#define VERSION " version=3765198393640951"

/* Whether `check` ends a test. */
static bool fails(void (*check)(void))
{
    int status;
    pid_t pid = fork();
    CHECK(pid >= 0);
    if (pid == 0) {
        if (freopen("/dev/null", "w", stderr) == NULL)
            _exit(2);
        check();
        _exit(0);
    }
    CHECK(waitpid(pid, &status, 0) == pid && WIFEXITED(status) && WEXITSTATUS(status) < 2);
    return WEXITSTATUS(status) == 1;
}

static void a_version_that_was_not_asked_for(void)
{
    CHECK_STR("OK 0 points=3" VERSION "\nOK 1" VERSION "\n", "OK 0 points=3\nOK 1\n");
}

static void a_version_that_was_asked_for(void)
{
    CHECK_STR("OK 0 points=3" VERSION "\nOK 1" VERSION "\n", "OK 0 points=3\nOK 1" VERSION "\n");
}

static void another_version(void)
{
    CHECK_STR("OK 0 version=3765198393640952\n", "OK 0" VERSION "\n");
}

static void no_version(void)
{
    CHECK_STR("OK 0\n", "OK 0" VERSION "\n");
}

static void two_versions(void)
{
    CHECK_UNVERSIONED("OK 0 version=3765198393640952\n", "OK 0" VERSION "\n");
}

TEST(versions_of_sets_are_compared_where_they_are_given)
{
    CHECK(!fails(a_version_that_was_not_asked_for) && !fails(a_version_that_was_asked_for));
    CHECK(fails(another_version) && fails(no_version) && !fails(two_versions));
}

/* ---- the program, run by itself ---- */

/* The output of this program with the arguments, up to 4,000 bytes, and whether its exit status is 0. */
static const char *output_of(const char *arguments, bool *good)
{
    static char text[4000];
    char command[300], self[200];
    ssize_t len = readlink("/proc/self/exe", self, sizeof self - 1);
    CHECK(len > 0);
    self[len] = '\0';
    snprintf(command, sizeof command, "HARNESS_TEST=1 %s %s 2>&1", self, arguments);
    FILE *f = popen(command, "r");
    CHECK(f != NULL);
    size_t n = fread(text, 1, sizeof text - 1, f);
    text[n] = '\0';
    *good = pclose(f) == 0;
    return text;
}

/* The same of the last line. */
static const char *last_line(const char *arguments, bool *good)
{
    const char *text = output_of(arguments, good), *line = text;
    for (const char *at = text; (at = strchr(at, '\n')) != NULL && *++at != '\0';)
        line = at;
    return line;
}

TEST(sample_that_skips_itself)
{
    if (getenv("HARNESS_TEST") != NULL)
        SKIP("%s", "no reason");
}

TEST(sample_that_fails)
{
    CHECK(getenv("HARNESS_TEST") == NULL);
}

static void check_one(int n)
{
    CHECK(n == 1);
}

TEST(sample_whose_caller_is_named)
{
    printf("a line that is shown\n");
    TEST_CALL(check_one(1));
    if (getenv("HARNESS_TEST") != NULL)
        TEST_CALL(check_one(2));
}

TEST(failed_tests_are_named_again_at_the_end_and_with_the_line_of_the_caller)
{
    bool good;
    const char *text = output_of("sample_that sample_whose", &good);
    CHECK(!good);
    CHECK_STR(strstr(text, "failed: "),
              "failed: sample_that_fails (tests/core/harness_test.c)\n"
              "failed: sample_whose_caller_is_named (tests/core/harness_test.c)\n"
              "0 passed, 2 failed, 1 skipped\n");
    CHECK(strstr(text, "a line that is shown\n") != NULL && strstr(text, ": from here\n") != NULL);
}

TEST(skipped_tests_are_a_third_outcome)
{
    bool good;
    CHECK_STR(last_line("sample_that_skips", &good), "0 passed, 0 failed, 1 skipped\n");
    CHECK(good);
    CHECK_STR(last_line("sample_that", &good), "0 passed, 1 failed, 1 skipped\n");
    CHECK(!good);
    CHECK_STR(last_line("versions_of_sets", &good), "1 passed, 0 failed\n");
    CHECK(good);
}

TEST(each_word_that_selects_no_test_fails)
{
    bool good;
    CHECK_STR(last_line("versions_of_sets nothing_is_called_so", &good), "1 passed, 1 failed\n");
    CHECK(!good);
    CHECK_STR(last_line("qqq xxqx", &good), "0 passed, 2 failed\n");
    CHECK(!good);
    CHECK_STR(last_line("-a versions_of_sets qqq", &good), "1 passed, 0 failed\n");
    CHECK(good);
    CHECK_STR(last_line("-l versions_of_sets", &good),
              "versions_of_sets_are_compared_where_they_are_given (tests/core/harness_test.c)\n");
    CHECK(good);
    last_line("-l versions_of_sets qqq", &good);
    CHECK(!good);
}
