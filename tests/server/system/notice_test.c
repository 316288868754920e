/* notice_test.c - messages for the operator: levels, a limit, no unprintable bytes. */
#include "server/system/notice.h"
#include "tests/test.h"

#include <string.h>
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
    notice(NOTICE_ERROR, "it burns");
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
    notice(NOTICE_ERROR, "this is always shown");
    notice_tick();
    const char *text = read_back(f);
    CHECK(written >= 50 && written < MANY && strstr(text, "this is always shown") != NULL);
    const char *last = strstr(text, " lines were left out");
    CHECK(last != NULL);
    while (last[-1] != ' ')
        last--;
    CHECK(sscanf(last, "%u", &left_out) == 1 && written + left_out == MANY);
}
