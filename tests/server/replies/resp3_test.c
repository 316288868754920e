/* resp3_test.c - typed replies. */
#include "proto/resp.h"
#include "server/commands.h"
#include "server/replies/resp3.h"
#include "tests/test.h"

#include <string.h>

/* The types of the command's rows. */
static const char *types_of(const char *command)
{
    for (size_t i = 0; i < command_count; i++)
        if (strcmp(commands[i].name, command) == 0)
            return commands[i].rows;
    return NULL;
}

static void expect_bytes(const char *command, const char *lines, size_t n, const char *want)
{
    const char *types = types_of(command);
    for (size_t cut = 0; cut <= n; cut++) {
        if (cut > 0 && cut < n && lines[cut - 1] != '\n')
            continue;
        struct reply_reader r = {0};
        struct buf out = {0};
        char *exact = malloc(n + 1); /* of its exact size, so that a sanitizer sees an overrun */
        CHECK(exact != NULL);
        memcpy(exact, lines, cut);
        CHECK(resp3_reframe(&r, types, exact, cut, &out));
        memcpy(exact, lines + cut, n - cut);
        CHECK(resp3_reframe(&r, types, exact, n - cut, &out));
        CHECK(reply_reader_idle(&r));
        buf_append_char(&out, 0);
        CHECK_STR(buf_head(&out), want);
        buf_free(&out);
        free(exact);
    }
}

static void expect_typed(const char *command, const char *lines, const char *want)
{
    expect_bytes(command, lines, strlen(lines), want);
}

TEST(resp3_facts_are_a_map)
{
    expect_typed("ADD", "OK 0 first=0 added=12\n",
                 "%2\r\n$5\r\nfirst\r\n:0\r\n$5\r\nadded\r\n:12\r\n");
    expect_typed("STAT", "OK 0 triangulated=yes temporary=no tol=0\n",
                 "%3\r\n$12\r\ntriangulated\r\n#t\r\n$9\r\ntemporary\r\n#f\r\n"
                 "$3\r\ntol\r\n,0\r\n");
    expect_typed("TRIANGULATE", "OK 0 ms=1.5e-7\n", "%1\r\n$2\r\nms\r\n,1.5e-7\r\n");
    expect_typed("HELLO", "OK 0 server=delaunayd version=1.0\n",
                 "%2\r\n$6\r\nserver\r\n$9\r\ndelaunayd\r\n$7\r\nversion\r\n$3\r\n1.0\r\n");
    expect_typed("DIGEST", "OK 0 digest=1234567890123456 points=3\n",
                 "%2\r\n$6\r\ndigest\r\n$16\r\n1234567890123456\r\n$6\r\npoints\r\n:3\r\n");
    expect_typed("PING", "OK 0\n", "+OK\r\n");
}

TEST(resp3_rows_are_arrays_of_numbers)
{
    expect_typed("LISTS", "OK 2 interior=0\n0 1\n1 0 22\n",
                 "*2\r\n*2\r\n:0\r\n:1\r\n*3\r\n:1\r\n:0\r\n:22\r\n");
    expect_typed("NEAREST", "OK 1\n7 4 -0.5 1e+21\n",
                 "*1\r\n*4\r\n:7\r\n,4\r\n,-0.5\r\n,1e+21\r\n");
    expect_typed("WEIGHTS", "OK 1\n7 nan\n", "*1\r\n*2\r\n:7\r\n_\r\n");
    expect_typed("FIELDS", "OK 1\n7 2 4 nan\n", "*1\r\n*4\r\n$1\r\n7\r\n:2\r\n,4\r\n_\r\n");
    expect_typed("CONTOUR", "OK 1\n5 open 1 0 2\n",
                 "*1\r\n*5\r\n,5\r\n$4\r\nopen\r\n:1\r\n,0\r\n,2\r\n");
    expect_typed("CONTOUR", "OK 2\n-inf 5 0 outer 1 0 2\n5 inf 1 hole 1 3 4.5\n",
                 "*2\r\n*7\r\n,-inf\r\n,5\r\n:0\r\n$5\r\nouter\r\n:1\r\n,0\r\n,2\r\n"
                 "*7\r\n,5\r\n,inf\r\n:1\r\n$4\r\nhole\r\n:1\r\n,3\r\n,4.5\r\n");
    expect_typed("TRACE", "OK 1\ngrid 0 -1.5 2\n",
                 "*1\r\n*4\r\n$4\r\ngrid\r\n:0\r\n,-1.5\r\n:2\r\n");
    expect_typed("HELP", "OK 1\nPING - a b\n", "*1\r\n$10\r\nPING - a b\r\n");
}

TEST(resp3_sets_are_a_map_of_maps)
{
    expect_typed("SETS", "OK 2\na points=0\nb points=1\n",
                 "%2\r\n$1\r\na\r\n%1\r\n$6\r\npoints\r\n:0\r\n"
                 "$1\r\nb\r\n%1\r\n$6\r\npoints\r\n:1\r\n");
    expect_typed("SETS", "OK 0\n", "%0\r\n");
}

TEST(resp3_no_rows_are_an_empty_array)
{
    expect_typed("NEAREST", "OK 0\n", "*0\r\n");
    expect_typed("LOCATE", "OK 0 where=outside\n", "*0\r\n");
}

TEST(resp3_words_that_only_begin_like_numbers_are_texts)
{
    expect_typed("UNLISTED", "OK 1\n1 - -x 1x 1:2 99999999999999999999\n",
                 "*1\r\n*6\r\n:1\r\n$1\r\n-\r\n$2\r\n-x\r\n$2\r\n1x\r\n$3\r\n1:2\r\n"
                 ",99999999999999999999\r\n");
    expect_typed("ADD", "OK 0 empty= odd\n",
                 "%2\r\n$5\r\nempty\r\n$0\r\n\r\n$3\r\nodd\r\n$0\r\n\r\n");
}

TEST(resp3_errors_and_bytes_are_those_of_resp2)
{
    expect_typed("GET", "ERR NOSET there is none\n", "-NOSET there is none\r\n");
    expect_typed("GET", "# progress 5 x\nOK 0\n", "*0\r\n");
    expect_typed("POINTS", "OK 0 rows=1 bytes=4\nabcd", "$4\r\nabcd\r\n");
    expect_typed("POINTS", "OK 0 rows=0 bytes=0\n", "$0\r\n\r\n");
}

TEST(resp3_out_of_memory_is_noticed)
{
    static const char lines[] = "OK 1\n1 2 3.5\n";
    for (long fail = 1; fail < 4; fail++) {
        struct reply_reader r = {0};
        struct buf out = {0};
        test_fail_alloc(fail);
        resp3_reframe(&r, types_of("NEAREST"), lines, sizeof lines - 1, &out);
        test_fail_alloc(0);
        CHECK(out.failed || fail > 1);
        buf_free(&out);
    }
}

TEST(resp3_values_are_doubles_and_a_missing_one_is_null)
{
    expect_typed("FGET", "OK 2\n3 4\n5 nan\n", "*2\r\n*2\r\n:3\r\n,4\r\n*2\r\n:5\r\n_\r\n");
    expect_typed("FIELDS", "OK 1\nz 2 -1 7\n", "*1\r\n*4\r\n$1\r\nz\r\n:2\r\n,-1\r\n,7\r\n");
}
