/* top_test.c - the screen of `delaunay top` fits its terminal and reacts to keys. */
#include <string.h>

#include "clients/commands/top_screen.h"
#include "tests/clients/cli.h"
#include "tests/clients/terminal.h"
#include "tests/test.h"

/* Facts with the longest values, and many commands. */
static void fill(struct top_facts *f, int calls)
{
    static const char *const keys[] = {"version",      "uptime_s",     "threads",    "sets",
                                       "commands",     "errors",       "slow",       "jobs",
                                       "jobs_running", "jobs_waiting", "clients",    "max_clients",
                                       "connections",  "memory_used",  "max_memory", "memory_peak",
                                       "resident",     "memory_kept",  "log_bytes",  "log_syncs"};
    char row[300];
    *f = (struct top_facts){.n = 0};
    for (size_t i = 0; i < sizeof keys / sizeof keys[0]; i++)
        top_take(f, row, (size_t)snprintf(row, sizeof row, "%s:123456789012345", keys[i]));
    for (int i = 0; i < 30; i++)
        top_take(f, row,
                 (size_t)snprintf(row, sizeof row,
                                  "command_COMMAND%d:calls=%d,errors=1,p50_us=%d.5,p99_us=%d.25,"
                                  "max_us=123456789.125,waits=0",
                                  i, calls * (i + 1), i, 1000 - i));
}

/* The number of lines of the screen, without control sequences. */
static unsigned lines_of(const char *text, unsigned columns)
{
    unsigned lines = 1, width = 0;
    for (const char *p = text; *p != '\0'; p++) {
        if (*p == '\033') {
            p += strcspn(p, "HKJm");
        } else if (*p == '\n') {
            lines++;
            width = 0;
        } else if (*p != '\r') {
            CHECK_MSG(++width <= columns, "%.80s", p);
        }
    }
    return lines;
}

static char *drawing(const struct top_view *view)
{
    static struct top_facts now, before;
    char *text;
    size_t size;
    FILE *out = open_memstream(&text, &size);
    fill(&before, 10);
    fill(&now, 20);
    top_draw(out, &now, &before, view);
    fclose(out);
    return text;
}

TEST(top_fits_any_terminal)
{
    static const unsigned sizes[][2] = {{24, 80}, {25, 132}, {10, 80}, {3, 20}, {1, 1}, {60, 200}};
    for (size_t i = 0; i < sizeof sizes / sizeof sizes[0]; i++) {
        struct top_view view = {.lines = sizes[i][0], .columns = sizes[i][1], .seconds = 1};
        char *text = drawing(&view);
        CHECK(lines_of(text, view.columns) == view.lines);
        free(text);
    }
}

TEST(top_sorts_commands_by_calls_in_a_second_or_by_time)
{
    struct top_view view = {.lines = 24, .columns = 80, .seconds = 2};
    char *text = drawing(&view);
    CHECK(strstr(text, "COMMAND29") != NULL && strstr(text, "COMMAND0 ") == NULL);
    CHECK(strstr(text, "COMMAND29             600       150 ") != NULL); /* 600 - 300 in 2 s */
    free(text);
    view.by_time = true;
    text = drawing(&view);
    CHECK(strstr(text, "COMMAND0 ") != NULL && strstr(text, "COMMAND29") == NULL);
    free(text);
}

TEST(top_reacts_to_keys)
{
    cli_begin();
    terminal_start("top");
    terminal_wait_for("delaunayd ");
    terminal_wait_for("q quit");
    terminal_wait_for("q quit"); /* a second later */
    terminal_type("p");
    terminal_wait_for("paused");
    terminal_type("p");
    terminal_wait_for("q quit");
    terminal_type("q");
    CHECK(terminal_finish() == 0);
    terminal_start("top");
    terminal_wait_for("q quit");
    terminal_type("\003"); /* as if interrupted */
    CHECK(terminal_finish() == 0);
    cli_finish();
}
