/* resp_test.c - requests and replies in RESP framing. */
#include "proto/resp.h"
#include "tests/test.h"

#include <string.h>

/* Reads the text as one request; its words, with '|' between them, go to words[256]. */
static ptrdiff_t read_text(const char *text, size_t n, struct resp *out, char *words)
{
    struct request q = {0};
    char *exact = malloc(n + 1); /* of its exact size, so that a sanitizer sees an overrun */
    CHECK(exact != NULL);
    memcpy(exact, text, n);
    ptrdiff_t took = resp_read(exact, n, &q, out);
    *words = 0;
    for (size_t i = 0; took > 0 && i < q.n; i++)
        sprintf(words + strlen(words), "%.*s|", (int)q.word[i].len, q.word[i].text);
    request_free(&q);
    free(exact);
    return took;
}

static void expect_fault(const char *text, enum resp_fault want)
{
    struct resp r;
    char words[256];
    CHECK_MSG(read_text(text, strlen(text), &r, words) == -1 && r.fault == want, "%s", text);
    CHECK(strlen(resp_fault_text(r.fault)) > 0);
}

TEST(resp_request_is_read_at_every_cut)
{
    static const char text[] = "*3\r\n$3\r\nGET\r\n$12\r\na word\r\nwith\r\n$0\r\n\r\n";
    struct resp r;
    char words[256];
    size_t n = sizeof text - 1;
    CHECK(read_text(text, n, &r, words) == (ptrdiff_t)n);
    CHECK_STR(words, "GET|a word\r\nwith||");
    CHECK(!r.has_body);
    for (size_t cut = 1; cut < n; cut++) {
        CHECK(read_text(text, cut, &r, words) == 0);
        CHECK(r.need > cut && r.need <= n);
    }
    CHECK(read_text("*1\r\n$4\r\nPING\r\n*1\r\n", 18, &r, words) == 14);
    CHECK_STR(words, "PING|");
}

TEST(resp_empty_arrays_are_not_requests)
{
    struct resp r;
    char words[256];
    CHECK(read_text("*0\r\n", 4, &r, words) == 4);
    CHECK_STR(words, "");
    CHECK(read_text("*-1\r\n", 5, &r, words) == 5);
}

TEST(resp_refuses_input_that_is_not_an_array_of_bulk_strings)
{
    static const char *const bad[] = {
        "*x\r\n",
        "*\r\n",
        "*1\n$4\r\n",
        "*1\r\r",
        "*-2\r\n",
        "*1\r\n:1\r\n",
        "*1\r\n$-1\r\n",
        "*1\r\n$2\r\nabcd",
        "*1\r\n+OK\r\n",
        "*--1\r\n",
        "*99999999999999999999\r\n",
        "*1\r\n$\r\n",
        "*00000000001\r\n$4\r\nPING\r\n",
        "*1\r\n$4\r\nPING\r\r",
        "*1\r\n$4\r\nPING\n\n",
    };
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++)
        expect_fault(bad[i], RESP_BROKEN);
}

TEST(resp_refuses_requests_that_are_too_long)
{
    expect_fault("*33000\r\n", RESP_TOO_LONG);
    expect_fault("*2\r\n$131073\r\n", RESP_TOO_LONG);
    expect_fault("*2\r\n$3\r\nGET\r\n$131070\r\n", RESP_TOO_LONG);
    expect_fault("*4\r\n$4\r\nload\r\n$1\r\nt\r\n$1\r\n1\r\n$9999999999\r\n", RESP_TOO_LONG);
}

TEST(resp_fourth_word_of_a_load_is_its_body)
{
    static const char text[] = "*4\r\n$5\r\nloadb\r\n$1\r\nt\r\n$1\r\n1\r\n$16\r\n0123";
    struct resp r;
    char words[256];
    CHECK(read_text(text, sizeof text - 1, &r, words) == sizeof text - 1 - 4);
    CHECK_STR(words, "loadb|t|1|");
    CHECK(r.has_body && r.body == 16);
    CHECK(read_text("*4\r\n$3\r\nGET\r\n$1\r\nt\r\n$1\r\n1\r\n$1\r\n2\r\n", 35, &r, words) > 0);
    CHECK(!r.has_body);
}

/* Whether the last one of some words, separated by blanks, is taken as a body. */
static bool ends_with_body(const char *line)
{
    char copy[200], text[400] = "", words[256];
    struct resp r;
    size_t n = 0;
    for (const char *at = line; at != NULL; at = strchr(at + 1, ' '))
        n++;
    snprintf(copy, sizeof copy, "%s", line);
    int len = sprintf(text, "*%zu\r\n", n);
    for (char *w = strtok(copy, " "); w != NULL; w = strtok(NULL, " "))
        len += sprintf(text + len, "$%zu\r\n%s\r\n", strlen(w), w);
    CHECK(read_text(text, (size_t)len, &r, words) > 0);
    return r.has_body;
}

TEST(resp_words_behind_places_are_options_or_a_body)
{
    CHECK(ends_with_body("INTERPOLATEB t z 1 ABCDEFGHABCDEFGH"));
    CHECK(ends_with_body("INTERPOLATEB t z 1 METHOD linear ABCDEFGHABCDEFGH"));
    CHECK(ends_with_body("INTERPOLATEB t z 1 INSIDE ABCDEFGHABCDEFGH"));
    CHECK(ends_with_body("INTERPOLATEB t z 1 INSIDE 3 ABCDEFGHABCDEFGH"));
    CHECK(ends_with_body("INTERPOLATEB t z 1 INSIDE MAXEDGE 2 METHOD linear ABCDEFGHABCDEFGH"));
    CHECK(!ends_with_body("INTERPOLATEB t z 1 INSIDE"));
    CHECK(!ends_with_body("INTERPOLATEB t z 1 INSIDE 3"));
    CHECK(!ends_with_body("INTERPOLATEB t z 1 METHOD linear INSIDE"));
    CHECK(!ends_with_body("INTERPOLATEB t z 1 MAXEDGE 0.12345678901234"));
    CHECK(!ends_with_body("INTERPOLATEB t z 1"));
    CHECK(ends_with_body("GRADIENTB t z 1 INSIDE 3 ABCDEFGHABCDEFGH"));
    CHECK(!ends_with_body("GRADIENTB t z 1 MAXEDGE 3"));
}

TEST(resp_paths_follow_as_lines)
{
    CHECK(ends_with_body("LOAD t 1 text"));
    CHECK(ends_with_body("LOAD t 1 FIELDS z text"));
    CHECK(!ends_with_body("LOAD t FIELDS z"));
    CHECK(!ends_with_body("LOAD t PATHS SPLIT"));
    CHECK(!ends_with_body("LOAD t 1 PATHS"));
    CHECK(!ends_with_body("LOAD t PATHS OF 3 SPLIT"));
    CHECK(!ends_with_body("LOAD t 1 PATHS FIELDS z"));
}

TEST(resp_records_of_constraints_are_a_body)
{
    CHECK(ends_with_body("LOADB t 1 CONSTRAINTS 0 ABCDEFGHABCDEFGH"));
    CHECK(ends_with_body("LOADB t 1 CONSTRAINTS 0 SPLIT ABCDEFGHABCDEFGH"));
    CHECK(ends_with_body("LOADB t 1 CONSTRAINTS 0 FIELDS z ABCDEFGHABCDEFGH"));
    CHECK(ends_with_body("LOADB t 1 CONSTRAINTS 0 SPLIT FIELDS z ABCDEFGHABCDEFGH"));
    CHECK(!ends_with_body("LOADB t 1 CONSTRAINTS 0"));
    CHECK(!ends_with_body("LOADB t 1 CONSTRAINTS 0 SPLIT"));
    CHECK(!ends_with_body("LOADB t 1 CONSTRAINTS 0 FIELDS z"));
    CHECK(!ends_with_body("LOADB t 1 CONSTRAINTS 0 SPLIT FIELDS z"));
}

TEST(resp_out_of_memory_is_reported)
{
    struct request q = {0};
    struct resp r;
    test_fail_alloc(1);
    CHECK(resp_read("*1\r\n$4\r\nPING\r\n", 14, &q, &r) == -1 && r.fault == RESP_NOMEM);
    test_fail_alloc(0);
    request_free(&q);
}

static void expect_reframed(const char *lines, size_t n, const char *want)
{
    for (size_t cut = 0; cut <= n; cut++) {
        if (cut > 0 && cut < n && lines[cut - 1] != '\n')
            continue;
        struct reply_reader r = {0};
        struct buf out = {0};
        CHECK(resp_reframe(&r, lines, cut, &out));
        CHECK(resp_reframe(&r, lines + cut, n - cut, &out));
        CHECK(reply_reader_idle(&r));
        buf_append_char(&out, 0);
        CHECK_STR(buf_head(&out), want);
        buf_free(&out);
    }
}

static void expect_reframed_text(const char *lines, const char *want)
{
    expect_reframed(lines, strlen(lines), want);
}

TEST(resp_replies_say_the_same_as_lines)
{
    expect_reframed_text("OK 0\n", "+OK\r\n");
    expect_reframed_text("OK 0 first=0 added=1\nOK 0\n", "+OK first=0 added=1\r\n+OK\r\n");
    expect_reframed_text("ERR NOSET there is none\n", "-NOSET there is none\r\n");
    expect_reframed_text("OK 2 interior=0\n0 1\n1 0 22 33 44\n",
                         "*2\r\n$3\r\n0 1\r\n$12\r\n1 0 22 33 44\r\n");
    expect_reframed_text("# progress 5 x\nOK 0\n", "+OK\r\n");
    expect_reframed_text("OK 0 rows=1 bytes=4\nabcdOK 0\n", "$4\r\nabcd\r\n+OK\r\n");
    expect_reframed_text("OK 0 rows=0 bytes=0\nOK 0\n", "$0\r\n\r\n+OK\r\n");
}

TEST(resp_long_rows_have_long_headers)
{
    char lines[300], want[320];
    for (size_t len = 98; len < 103; len++) {
        int n = sprintf(lines, "OK 1\n%0*d\n", (int)len, 7);
        sprintf(want, "*1\r\n$%d\r\n%0*d\r\n", (int)len, (int)len, 7);
        expect_reframed(lines, (size_t)n, want);
    }
}

TEST(resp_headers_have_as_many_digits_as_needed)
{
    static const size_t lengths[] = {0, 9, 10, 99, 100, 101, 1000, 65536};
    static char text[65536];
    for (size_t i = 0; i < sizeof lengths / sizeof lengths[0]; i++) {
        struct buf out = {0};
        char want[64];
        size_t n = (size_t)snprintf(want, sizeof want, "*%zu\r\n$%zu\r\n", lengths[i], lengths[i]);
        memset(text, 'x', sizeof text);
        resp_array(&out, lengths[i]);
        resp_bulk(&out, text, lengths[i]);
        CHECK(buf_len(&out) == n + lengths[i] + 2 && memcmp(buf_head(&out), want, n) == 0);
        CHECK(memcmp(buf_head(&out) + n, text, lengths[i]) == 0);
        CHECK(memcmp(buf_head(&out) + n + lengths[i], "\r\n", 2) == 0);
        buf_free(&out);
    }
    struct buf out = {0};
    resp_array(&out, SIZE_MAX);
    CHECK(buf_len(&out) == 23 && memcmp(buf_head(&out), "*18446744073709551615\r\n", 23) == 0);
    buf_free(&out);
}
