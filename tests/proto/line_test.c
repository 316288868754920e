/* line_test.c - finding lines in bytes. */
#include "proto/line.h"
#include "tests/test.h"

#include <string.h>

static ptrdiff_t read_text(const char *text, bool last, struct line *line)
{
    return line_read(text, strlen(text), last, line);
}

TEST(line_ends_at_lf_or_crlf)
{
    struct line line;
    CHECK(read_text("PING\nx", false, &line) == 5 && line.len == 4);
    CHECK(read_text("PING\r\nx", false, &line) == 6 && line.len == 4);
    CHECK(read_text("\n", false, &line) == 1 && line.len == 0);
    CHECK(read_text("a\rb\n", false, &line) == 4 && line.len == 3);
}

TEST(line_without_its_end_waits_unless_it_is_the_last)
{
    struct line line;
    CHECK(read_text("PING", false, &line) == 0);
    CHECK(read_text("PING", true, &line) == 4 && line.len == 4);
    CHECK(read_text("PING\r", true, &line) == 5 && line.len == 4);
    CHECK(read_text("", true, &line) == 0);
}

TEST(line_with_a_nul_is_invalid_even_before_its_end)
{
    struct line line;
    CHECK(line_read("a\0b\n", 4, false, &line) == -1 && line.fault == LINE_NUL);
    CHECK(line_read("a\0b", 3, false, &line) == -1 && line.fault == LINE_NUL);
    CHECK(line_read("a\n\0", 3, false, &line) == 2);
}

TEST(line_has_at_most_64_kib)
{
    static char text[LINE_LIMIT + 3];
    struct line line;
    memset(text, 'x', sizeof text);
    CHECK(line_read(text, LINE_LIMIT, false, &line) == 0);
    text[LINE_LIMIT] = '\r'; /* might still be the first half of its end */
    CHECK(line_read(text, LINE_LIMIT + 1, false, &line) == 0);
    text[LINE_LIMIT + 1] = '\n';
    CHECK(line_read(text, LINE_LIMIT + 2, false, &line) == LINE_LIMIT + 2 &&
          line.len == LINE_LIMIT);
    text[LINE_LIMIT] = 'x';
    CHECK(line_read(text, LINE_LIMIT + 1, false, &line) == -1 && line.fault == LINE_TOO_LONG);
    CHECK(line_read(text, LINE_LIMIT + 2, false, &line) == -1 && line.fault == LINE_TOO_LONG);
}
