/* reply_read_test.c - the client's framing, fed in one piece, byte by byte, and cut at every byte. */
#include "proto/reply_read.h"

#include <string.h>

#include "tests/test.h"

/* Writes what a reader returns for bytes[n], which arrive in pieces of alternating sizes. A line for each part has
 * its kind, its text, and '.' if the reply ends with it; "bad" at a fault. */
static void transcribe(char *out, size_t room, const char *bytes, size_t n, size_t first,
                       size_t then)
{
    static const char *const kind[] = {
        [REPLY_OK] = "ok",       [REPLY_ERR] = "err",     [REPLY_ROW] = "row",
        [REPLY_BYTES] = "bytes", [REPLY_EVENT] = "event", [REPLY_COMMENT] = "#"};
    struct reply_reader r = {0};
    struct reply_part part;
    size_t start = 0, end = 0, used = 0;
    bool in_bytes = false;
    out[0] = 0;
    while (end < n) {
        size_t piece = end == 0 ? first : then;
        end = end + piece < n ? end + piece : n;
        /* of its exact size, so that a sanitizer sees an overrun */
        char *exact = malloc(end - start + 1);
        memcpy(exact, bytes + start, end - start);
        size_t at = 0, size = end - start;
        ptrdiff_t took;
        while ((took = reply_read(&r, exact + at, size - at, &part)) > 0) {
            at += (size_t)took;
            if (part.kind == REPLY_BYTES &&
                in_bytes) /* raw bytes are one part however they are cut */
                used += (size_t)snprintf(out + used, room - used, "%.*s", (int)part.len, part.text);
            else
                used += (size_t)snprintf(out + used, room - used, "%s|%.*s", kind[part.kind],
                                         (int)part.len, part.text);
            in_bytes = part.kind == REPLY_BYTES && !part.last;
            if (!in_bytes)
                used += (size_t)snprintf(out + used, room - used, "%s\n", part.last ? "." : "");
        }
        start += at;
        free(exact);
        if (took < 0) {
            CHECK(r.fault != NULL && reply_read(&r, "OK 0\n", 5, &part) == -1);
            snprintf(out + used, room - used, "bad\n");
            return;
        }
    }
    snprintf(out + used, room - used, "%s", reply_reader_idle(&r) ? "" : "cut\n");
}

/* Checks the transcript of text in any pieces. */
static void check_parts_of(const char *text, size_t n, const char *want)
{
    char got[4000];
    transcribe(got, sizeof got, text, n, n, n);
    CHECK_STR(got, want);
    transcribe(got, sizeof got, text, n, 1, 1);
    CHECK_STR(got, want);
    for (size_t cut = 1; cut < n; cut++) {
        transcribe(got, sizeof got, text, n, cut, n);
        CHECK_STR(got, want);
    }
}

static void check_parts(const char *text, const char *want)
{
    check_parts_of(text, strlen(text), want);
}

TEST(reply_read_separates_pipelined_replies)
{
    check_parts("OK 0 first=0 added=5 coincident=0\nOK 2 interior=1\n4 0 1\n0 1 4\nERR NOSET no "
                "set t\nOK 0\n",
                "ok|OK 0 first=0 added=5 coincident=0.\nok|OK 2 interior=1\nrow|4 0 1\nrow|0 1 4.\n"
                "err|ERR NOSET no set t.\nok|OK 0.\n");
}

TEST(reply_read_accepts_crlf_and_empty_rows)
{
    check_parts("OK 3\r\n\r\n\nx\r\nOK 0\r\n", "ok|OK 3\nrow|\nrow|\nrow|x.\nok|OK 0.\n");
}

TEST(reply_read_passes_comments_before_a_status_line_only)
{
    check_parts("# progress 40 building\n#\nOK 1\n# a row\nERR BUSY later\n",
                "#|# progress 40 building\n#|#\nok|OK 1\nrow|# a row.\nerr|ERR BUSY later.\n");
}

TEST(reply_read_takes_events_only_where_they_are_expected)
{
    static const char text[] = "EVENT 1 set=t version=7\ngone 3\n";
    struct reply_reader r = {.events = true};
    struct reply_part part;
    ptrdiff_t took = reply_read(&r, text, sizeof text - 1, &part);
    CHECK(took == 24 && part.kind == REPLY_EVENT && !part.last);
    CHECK(reply_read(&r, text + took, sizeof text - 1 - (size_t)took, &part) == 7 &&
          part.kind == REPLY_ROW && part.last);
    check_parts("OK 1\nEVENT 0 set=t\n", "ok|OK 1\nrow|EVENT 0 set=t.\n");
    check_parts(text, "bad\n");
}

TEST(reply_read_counts_raw_bytes_of_any_value)
{
    check_parts("OK 0 rows=1 bytes=7\nOK 0\n\r\nOK 0 bytes=0\nOK 0\n",
                "ok|OK 0 rows=1 bytes=7\nbytes|OK 0\n\r\n.\nok|OK 0 bytes=0.\nok|OK 0.\n");
}

TEST(reply_read_accepts_bytes_as_a_key_only_without_rows)
{
    check_parts("OK 1 bytes=9\nrow\nOK 0 notbytes=3 kbytes=x\n",
                "ok|OK 1 bytes=9\nrow|row.\nok|OK 0 notbytes=3 kbytes=x.\n");
}

TEST(reply_read_notices_where_a_reply_is_cut)
{
    check_parts("OK 2\none\n", "ok|OK 2\nrow|one\ncut\n");
    check_parts("OK 0", "cut\n");
    check_parts("OK 0\nO", "ok|OK 0.\ncut\n");
    check_parts("", "");
}

TEST(reply_read_refuses_input_that_is_not_a_reply)
{
    static const char *const wrong[] = {"\n",
                                        "HTTP/1.1 200 OK\n",
                                        "OK\n",
                                        "OK \n",
                                        "OK x\n",
                                        "OK -1\n",
                                        "OK 1x\n",
                                        "ok 0\n",
                                        "OKAY 0\n",
                                        "ERR\n",
                                        "ERR \n",
                                        "ERR lower\n",
                                        " OK 0\n",
                                        "+PONG\n",
                                        "-ERR x\n",
                                        "OK  0\n",
                                        "OK 0 bytes=\n",
                                        "OK 0 bytes=-1\n",
                                        "OK 18446744073709551616\n",
                                        "OK 0 bytes=99999999999999999999\n"};
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++)
        check_parts(wrong[i], "bad\n");
    check_parts("OK 0\njunk\n", "ok|OK 0.\nbad\n");
    check_parts_of("OK 0\0\n", 6, "bad\n");
    check_parts_of("OK 1\na\0b\n", 9, "ok|OK 1\nbad\n");
}

TEST(reply_read_limits_the_length_of_a_status_line_but_not_of_a_row)
{
    size_t n = 3 * REPLY_STATUS_LIMIT;
    char *text = malloc(n);
    struct reply_reader r = {0};
    struct reply_part part;
    memset(text, 'x', n);
    CHECK(reply_read(&r, text, REPLY_STATUS_LIMIT, &part) == 0);
    CHECK(reply_read(&r, text, n, &part) == -1);

    r = (struct reply_reader){0};
    memcpy(text, "OK 1\n", 5);
    CHECK(reply_read(&r, text, n, &part) == 5);
    CHECK(reply_read(&r, text + 5, n - 6, &part) == 0);
    text[n - 1] = '\n';
    CHECK(reply_read(&r, text + 5, n - 5, &part) == (ptrdiff_t)n - 5);
    CHECK(part.kind == REPLY_ROW && part.len == n - 6 && part.last);
    free(text);
}

TEST(reply_read_costs_no_more_in_small_pieces)
{
    size_t n = 4000000;
    char *text = malloc(n);
    struct reply_reader r = {0};
    struct reply_part part;
    memset(text, 'x', n);
    memcpy(text, "OK 1\n", 5);
    CHECK(reply_read(&r, text, n, &part) == 5);
    for (size_t end = 6; end < n; end++) /* quadratic would take an hour */
        CHECK(reply_read(&r, text + 5, end - 5, &part) == 0);
    free(text);
}

TEST(reply_key_finds_whole_keys_only)
{
    struct reply_part s = {REPLY_OK, "OK 12 points=5 xpoints=6 empty= last=7", 38, true};
    const char *value;
    size_t len;
    uint64_t v;
    CHECK(reply_key_number(&s, "points", &v) && v == 5);
    CHECK(reply_key_number(&s, "xpoints", &v) && v == 6);
    CHECK(reply_key_number(&s, "last", &v) && v == 7);
    CHECK(reply_key(&s, "empty", &value, &len) && len == 0);
    CHECK(!reply_key_number(&s, "empty", &v));
    CHECK(!reply_key(&s, "point", &value, &len) && !reply_key(&s, "OK", &value, &len) &&
          !reply_key(&s, "las", &value, &len));
    CHECK(!reply_key(&s, "lastx", &value, &len));
    CHECK(reply_rows(&s) == 12);
    s.len = 36; /* "... last" without its value lies beyond the end */
    CHECK(!reply_key_number(&s, "last", &v));
}
