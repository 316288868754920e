/* said.c - see said.h. */
#include "tests/server/said.h"

#include "tests/server/daemon.h"
#include "tests/test.h"

#include <fcntl.h>
#include <string.h>
#include <unistd.h>

struct said said_begin(void)
{
    struct said s = {.file = tmpfile(), .before = dup(STDERR_FILENO)};
    CHECK(s.file != NULL && s.before >= 0);
    /* Daemons share the position in the file, which reading moves. */
    CHECK(fcntl(fileno(s.file), F_SETFL, O_APPEND) == 0);
    CHECK(dup2(fileno(s.file), STDERR_FILENO) >= 0);
    return s;
}

void said_end(const struct said *s)
{
    CHECK(dup2(s->before, STDERR_FILENO) >= 0);
    close(s->before);
}

unsigned said_lines(const struct said *s, const char *text)
{
    char line[600];
    unsigned n = 0;
    rewind(s->file);
    while (fgets(line, sizeof line, s->file) != NULL)
        n += strstr(line, text) != NULL;
    return n;
}

void said_await(const struct said *s, const char *text, unsigned n)
{
    double end = seconds() + 5 * test_slowness();
    while (said_lines(s, text) < n && seconds() < end)
        pause_ms(2);
    CHECK_MSG(said_lines(s, text) >= n, "standard error has %u lines with '%s', not %u",
              said_lines(s, text), text, n);
}
