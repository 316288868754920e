/* notice_test.c - messages for the operator: levels, a limit, no unprintable bytes. */
#include "server/system/notice.h"
#include "tests/test.h"

#include <fcntl.h>
#include <signal.h>
#include <string.h>
#include <sys/resource.h>
#include <unistd.h>

/* Redirects standard error to a file; read_back returns what was written to it. */
static FILE *take_stderr(void)
{
    FILE *f = tmpfile();
    CHECK(f != NULL && dup2(fileno(f), STDERR_FILENO) >= 0);
    unsetenv("JOURNAL_STREAM");
    return f;
}

static const char *read_back(FILE *f)
{
    static char text[1 << 16];
    notice_flush(5000);
    rewind(f);
    text[fread(text, 1, sizeof text - 1, f)] = '\0';
    return text;
}

static unsigned lines_of(const char *text)
{
    unsigned n = 0;
    for (; *text != '\0'; text++)
        n += *text == '\n';
    return n;
}

TEST(notices_have_levels)
{
    FILE *f = take_stderr();
    enum notice_level level;
    CHECK(notice_parse_level("warning", &level) && level == NOTICE_WARNING);
    CHECK(!notice_parse_level("loud", &level) && level == NOTICE_WARNING);
    notice_set_level(level);
    notice(NOTICE_INFO, "not this");
    notice(NOTICE_WARNING, "but this, %d", 7);
    CHECK(!notice_wanted(NOTICE_INFO) && notice_wanted(NOTICE_ERROR));
    const char *text = read_back(f);
    CHECK_MSG(strstr(text, " delaunayd: warning: but this, 7\n") != NULL, "%s", text);
    CHECK(lines_of(text) == 1);
}

TEST(notices_for_the_journal_begin_with_their_priority)
{
    FILE *f = take_stderr();
    setenv("JOURNAL_STREAM", "8:1", 1);
    CHECK(!notice_error("it burns"));
    CHECK_STR(read_back(f), "<3>delaunayd: it burns\n");
}

TEST(notices_are_one_printable_line)
{
    static char big[2000];
    FILE *f = take_stderr();
    memset(big, 'x', sizeof big - 1);
    notice(NOTICE_ERROR, "%s", "a\nb\r\x1b[31m\xff");
    notice(NOTICE_ERROR, "%s", big);
    const char *text = read_back(f);
    CHECK(lines_of(text) == 2 && strstr(text, "a?b??[31m?\n") != NULL);
    CHECK(strlen(text) < 1000);
}

TEST(notices_beyond_the_limit_are_counted)
{
    enum { MANY = 400 };
    FILE *f = take_stderr();
    for (int i = 0; i < MANY; i++)
        notice(NOTICE_WARNING, "flood");
    unsigned written = lines_of(read_back(f)), left_out;
    CHECK(!notice_error("%s is always shown", "this"));
    notice_tick();
    const char *text = read_back(f);
    CHECK(written >= 50 && written < MANY && strstr(text, "this is always shown") != NULL);
    const char *last = strstr(text, " lines were left out");
    CHECK(last != NULL);
    while (last[-1] != ' ')
        last--;
    CHECK(sscanf(last, "%u", &left_out) == 1 && written + left_out == MANY);
}

/* The sum of the lines that messages say were left out. */
static unsigned left_out_by(const char *text)
{
    unsigned sum = 0, n;
    for (const char *at = text; (at = strstr(at, "warning: ")) != NULL; at++)
        if (sscanf(at, "warning: %u lines were left out", &n) == 1)
            sum += n;
    return sum;
}

TEST(notices_do_not_wait_for_a_full_pipe_and_are_counted)
{
    enum { MANY = 400, ROOM = 1 << 20 };
    static char text[ROOM];
    int end[2];
    unsetenv("JOURNAL_STREAM");
    CHECK(pipe(end) == 0 && fcntl(end[1], F_SETPIPE_SZ, 4096) > 0);
    CHECK(dup2(end[1], STDERR_FILENO) >= 0);
    close(end[1]);
    for (int i = 0; i < MANY; i++)
        notice(NOTICE_ERROR, "message");
    notice_tick(); /* no room for the report, either */
    size_t n = 0;
    fcntl(end[0], F_SETFL, O_NONBLOCK);
    for (unsigned seen = 0; seen < MANY && n < ROOM - 1;) {
        ssize_t got = read(end[0], text + n, ROOM - 1 - n);
        n += got > 0 ? (size_t)got : 0;
        text[n] = '\0';
        notice_flush(20);
        notice_tick();
        seen = 0;
        for (const char *at = text; (at = strstr(at, ": message\n")) != NULL; at++)
            seen++;
        seen += left_out_by(text);
        CHECK_MSG(seen <= MANY, "%u of %u", seen, MANY);
    }
    CHECK(left_out_by(text) > 0);
}

TEST(notices_that_a_full_disk_does_not_take_are_counted_later)
{
    int full = open("/dev/full", O_WRONLY | O_CLOEXEC);
    unsetenv("JOURNAL_STREAM");
    CHECK(full >= 0 && dup2(full, STDERR_FILENO) >= 0);
    for (int i = 0; i < 7; i++)
        notice(NOTICE_WARNING, "message");
    notice_flush(5000);
    notice_tick(); /* the report is lost as well, but not its count */
    notice_flush(5000);
    FILE *f = take_stderr();
    notice_tick();
    const char *text = read_back(f);
    CHECK_MSG(left_out_by(text) == 7 && lines_of(text) == 1, "%s", text);
}

TEST(notice_after_a_torn_one_is_a_line_of_its_own)
{
    enum { ROOM = 60 }; /* bytes: more than a line with a short text, less than two */
    FILE *f = take_stderr();
    struct rlimit limit, small;
    signal(SIGXFSZ, SIG_IGN);
    CHECK(getrlimit(RLIMIT_FSIZE, &limit) == 0);
    small = limit;
    small.rlim_cur = ROOM;
    notice(NOTICE_WARNING, "one");
    notice_flush(5000);
    CHECK(setrlimit(RLIMIT_FSIZE, &small) == 0);
    notice(NOTICE_WARNING, "two");
    notice_flush(5000);
    CHECK(setrlimit(RLIMIT_FSIZE, &limit) == 0);
    notice(NOTICE_WARNING, "three");
    notice_tick();
    const char *text = read_back(f);
    CHECK_MSG(strstr(text, "two\n") == NULL && strstr(text, "delaunayd: warning: three\n") != NULL,
              "%s", text);
    CHECK_MSG(lines_of(text) == 4 && left_out_by(text) == 1, "%s", text);
}
