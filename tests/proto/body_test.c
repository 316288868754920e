/* body_test.c - the points that follow LOAD, in every form, cut at every byte. */
#include "proto/body.h"
#include "tests/test.h"

#include <math.h>
#include <string.h>

static bool small_enough(const double *v, size_t n)
{
    for (size_t i = 0; i < n; i++)
        if (!(fabs(v[i]) < 1000))
            return false;
    return true;
}

/* Feeds text[n] in pieces of `piece` bytes, keeping bytes that are not consumed, as a connection does; -1:
 * broken framing. */
static ptrdiff_t feed(struct body *b, const char *text, size_t n, size_t piece, bool ends)
{
    size_t taken = 0, arrived = 0;
    while (!b->complete && arrived < n) {
        arrived = arrived + piece < n ? arrived + piece : n;
        ptrdiff_t took = body_feed(b, text + taken, arrived - taken, ends && arrived == n);
        if (took < 0)
            return -1;
        CHECK((size_t)took <= arrived - taken);
        taken += (size_t)took;
    }
    return (ptrdiff_t)taken;
}

static ptrdiff_t feed_text(struct body *b, const char *text, bool ends)
{
    return feed(b, text, strlen(text), strlen(text), ends);
}

static bool has_points(const struct body *b, size_t n, const double *xy)
{
    return b->complete && b->fault == BODY_GOOD && b->n == n && memcmp(b->xy, xy, n * 16) == 0;
}

TEST(body_that_ends_with_a_dot_is_read_in_any_pieces)
{
    static const char text[] = "1 2\n  3.5\t-4 \r\n\n# a comment\n #another\n5e2 .5\n.\nPING\n";
    static const double want[] = {1, 2, 3.5, -4, 500, .5};
    for (size_t piece = 1; piece <= sizeof text - 1; piece++) {
        struct body b;
        body_init(&b, BODY_DOT, 0, 10, small_enough);
        CHECK(feed(&b, text, sizeof text - 1, piece, false) == (ptrdiff_t)sizeof text - 1 - 5);
        CHECK(has_points(&b, 3, want) && b.line == 7);
        body_free(&b);
    }
}

TEST(body_of_lines_in_many_forms_is_read_in_any_pieces)
{
    static const char text[] = "0.25 -17\r\n1e2\t\t-2.5E-1\n-0 +0.0\n 3 4\n5 6 \n"
                               "0.1234567890123456789 12\n7 8\r \n.5 5.\n.\r\nPING\n";
    static const double want[] = {0.25, -17, 100, -0.25, -0.0, 0, 3, 4, 5, 6, 0.1234567890123456789,
                                  12,   .5,  5};
    for (size_t piece = 1; piece <= sizeof text - 1; piece++) {
        struct body b;
        body_init(&b, BODY_DOT, 0, 10, small_enough);
        ptrdiff_t took = feed(&b, text, sizeof text - 1, piece, false);
        CHECK(took == (ptrdiff_t)sizeof text - 1 - 5 && b.line == 9);
        CHECK(b.fault == BODY_NUMBER && b.fault_line == 7); /* `8\r` is not a number */
        body_free(&b);
    }
    char *good = strdup(text);
    memmove(strstr(good, "7 8"), strstr(good, ".5 5."), strlen(strstr(good, ".5 5.")) + 1);
    struct body b;
    body_init(&b, BODY_DOT, 0, 10, small_enough);
    CHECK(feed_text(&b, good, false) > 0);
    CHECK(has_points(&b, 7, want));
    body_free(&b);
    free(good);
}

TEST(body_of_counted_lines_ends_with_the_last_one)
{
    static const char text[] = "1 2\n# counts as a line\n3 4\n.\n";
    static const double want[] = {1, 2, 3, 4};
    for (size_t piece = 1; piece <= sizeof text - 1; piece++) {
        struct body b;
        body_init(&b, BODY_LINES, 3, 10, small_enough);
        CHECK(feed(&b, text, sizeof text - 1, piece, false) == (ptrdiff_t)sizeof text - 1 - 2);
        CHECK(has_points(&b, 2, want));
        body_free(&b);
    }
}

TEST(body_that_ends_before_its_first_byte_is_a_fault)
{
    for (int binary = 0; binary < 2; binary++) {
        struct body b;
        body_init(&b, binary ? BODY_BINARY : BODY_LINES, 2, 10, small_enough);
        CHECK(body_feed(&b, NULL, 0, false) == 0 && !b.complete);
        CHECK(body_feed(&b, NULL, 0, true) == 0 && b.complete && b.fault == BODY_ENDED);
        body_free(&b);
    }
}

TEST(body_of_no_lines_is_complete_at_once)
{
    struct body b;
    body_init(&b, BODY_LINES, 0, 10, small_enough);
    CHECK(b.complete && b.n == 0);
    body_init(&b, BODY_BINARY, 0, 10, small_enough);
    CHECK(b.complete && b.n == 0);
    body_init(&b, BODY_DOT, 0, 10, small_enough);
    CHECK(!b.complete);
}

TEST(body_in_binary_form_is_read_in_any_pieces)
{
    /* 1.0, -2.0, 0.5, 3.0 in little-endian order, then the next request */
    static const char text[] = "\0\0\0\0\0\0\xf0\x3f\0\0\0\0\0\0\0\xc0"
                               "\0\0\0\0\0\0\xe0\x3f\0\0\0\0\0\0\x08\x40PING";
    static const double want[] = {1, -2, .5, 3};
    for (size_t piece = 1; piece <= 36; piece++) {
        struct body b;
        body_init(&b, BODY_BINARY, 2, 10, small_enough);
        CHECK(feed(&b, text, 36, piece, false) == 32);
        CHECK(has_points(&b, 2, want));
        body_free(&b);
    }
}

/* The fault of a body, whose rest must have been read to its end. */
static enum body_fault fault_of(const char *text, uint64_t line)
{
    struct body b;
    body_init(&b, BODY_DOT, 0, 3, small_enough);
    CHECK(feed_text(&b, text, false) == (ptrdiff_t)strlen(text));
    CHECK(b.complete && b.fault_line == line && b.xy == NULL);
    return b.fault;
}

TEST(body_with_bad_lines_is_discarded_and_reports_the_first)
{
    CHECK(fault_of("1 2\n3\n4 x\n.\n", 2) == BODY_SYNTAX);
    CHECK(fault_of("1 2 3\n.\n", 1) == BODY_SYNTAX);
    CHECK(fault_of("\n#\n1 x\n5\n.\n", 3) == BODY_NUMBER);
    CHECK(fault_of("nan 1\n.\n", 1) == BODY_NUMBER);
    CHECK(fault_of("1 1\n2 -1000\n.\n", 2) == BODY_RANGE);
    CHECK(fault_of("1 1\n2 1\n3 1\n4 1\n5\n.\n", 4) == BODY_TOOBIG);
}

TEST(body_in_binary_form_refuses_invalid_coordinates)
{
    double bad[] = {(double)NAN, HUGE_VAL, 1000};
    enum body_fault want[] = {BODY_NUMBER, BODY_RANGE, BODY_RANGE};
    for (int i = 0; i < 3; i++) {
        double xy[] = {1, 1, 2, bad[i], 3, 3};
        struct body b;
        body_init(&b, BODY_BINARY, 3, 10, small_enough);
        CHECK(body_feed(&b, (const char *)xy, sizeof xy, false) == (ptrdiff_t)sizeof xy);
        CHECK(b.complete && b.fault == want[i] && b.fault_line == 2);
        body_free(&b);
    }
}

/* The fault of a binary body of 32 points, of which the first comes alone and the others together. */
static enum body_fault fault_of_run(const double *xy, size_t limit, uint64_t line)
{
    struct body b;
    body_init(&b, BODY_BINARY, 32, limit, small_enough);
    CHECK(body_feed(&b, (const char *)xy, 16, false) == 16 && b.n == 1);
    CHECK(body_feed(&b, (const char *)xy + 16, 31 * 16, false) == 31 * 16);
    CHECK(b.complete && b.line == 32 && b.fault_line == line);
    CHECK(b.fault == BODY_GOOD ? has_points(&b, 32, xy) : b.xy == NULL);
    enum body_fault fault = b.fault;
    body_free(&b);
    return fault;
}

TEST(body_in_binary_form_takes_many_points_at_once_and_finds_the_invalid_one)
{
    double xy[64];
    for (size_t i = 0; i < 64; i++)
        xy[i] = (double)i;
    CHECK(fault_of_run(xy, 32, 0) == BODY_GOOD);
    CHECK(fault_of_run(xy, 31, 32) == BODY_TOOBIG);
    CHECK(fault_of_run(xy, 5, 6) == BODY_TOOBIG);
    for (size_t i = 2; i < 64; i++) {
        double before = xy[i];
        xy[i] = i % 3 == 0 ? (double)NAN : -1000;
        CHECK(fault_of_run(xy, 32, i / 2 + 1) == (i % 3 == 0 ? BODY_NUMBER : BODY_RANGE));
        xy[i] = before;
    }
}

TEST(body_that_ends_too_early_is_a_fault)
{
    struct body b;
    body_init(&b, BODY_DOT, 0, 10, small_enough);
    CHECK(feed_text(&b, "1 2\n3 4", true) == 7);
    CHECK(b.complete && b.fault == BODY_ENDED && b.fault_line == 3 && b.xy == NULL);
    body_init(&b, BODY_BINARY, 2, 10, small_enough);
    CHECK(body_feed(&b, "12345678901234567", 17, true) == 17);
    CHECK(b.complete && b.fault == BODY_ENDED && b.fault_line == 2);
}

TEST(body_with_a_bad_line_keeps_that_fault_when_it_ends_too_early)
{
    struct body b;
    body_init(&b, BODY_DOT, 0, 10, small_enough);
    CHECK(feed_text(&b, "1 2\n3 x\n4 5\n", true) == 12);
    CHECK(b.complete && b.fault == BODY_NUMBER && b.fault_line == 2);
}

TEST(body_may_end_with_a_line_without_its_lf)
{
    static const double want[] = {1, 2};
    struct body b;
    body_init(&b, BODY_DOT, 0, 10, small_enough);
    CHECK(feed_text(&b, "1 2\n.", true) == 5 && has_points(&b, 1, want));
    body_free(&b);
    body_init(&b, BODY_LINES, 1, 10, small_enough);
    CHECK(feed_text(&b, "1 2", true) == 3 && has_points(&b, 1, want));
    body_free(&b);
}

TEST(body_with_a_nul_or_an_endless_line_breaks_the_framing)
{
    static char text[LINE_LIMIT + 1];
    struct body b;
    body_init(&b, BODY_DOT, 0, 10, small_enough);
    CHECK(body_feed(&b, "1 2\n3\0 4\n", 9, false) == -1 && b.line_fault == LINE_NUL);
    body_free(&b);
    memset(text, ' ', sizeof text);
    body_init(&b, BODY_DOT, 0, 10, small_enough);
    CHECK(body_feed(&b, text, sizeof text, false) == -1 && b.line_fault == LINE_TOO_LONG);
    body_free(&b);
}

/* Two numbers with too many blanks between them, in one piece. */
TEST(body_with_a_plain_line_that_is_too_long_breaks_the_framing)
{
    static char text[LINE_LIMIT + 2];
    for (size_t len = LINE_LIMIT; len <= LINE_LIMIT + 1; len++) {
        struct body b;
        memset(text, ' ', len);
        text[0] = text[len - 1] = '1';
        text[len] = '\n';
        body_init(&b, BODY_LINES, 1, 10, small_enough);
        ptrdiff_t took = body_feed(&b, text, len + 1, false);
        CHECK(len == LINE_LIMIT ? took == (ptrdiff_t)len + 1 && b.n == 1
                                : took == -1 && b.line_fault == LINE_TOO_LONG);
        body_free(&b);
    }
}

TEST(body_without_memory_is_read_to_its_end_and_discarded)
{
    struct body b;
    body_init(&b, BODY_DOT, 0, 10, small_enough);
    test_fail_alloc(1);
    CHECK(feed_text(&b, "1 2\n3 4\n.\n", false) == 10);
    CHECK(test_alloc_failed() && b.complete && b.fault == BODY_NOMEM && b.fault_line == 1);
}

/* Counts the memory of the body. */
struct counted {
    size_t bytes; /* of the only array */
    unsigned moves;
};

static void *grow_counted(void *ctx, void *p, size_t used, size_t bytes)
{
    struct counted *c = ctx;
    CHECK(used <= c->bytes && bytes > c->bytes);
    c->bytes = bytes;
    c->moves++;
    return realloc(p, bytes);
}

TEST(body_stores_points_in_the_callers_memory_of_just_the_right_size)
{
    struct body b;
    for (int with_lines = 0; with_lines < 2; with_lines++) {
        struct counted c = {0};
        double xy[] = {1, 1};
        body_init(&b, with_lines ? BODY_LINES : BODY_BINARY, 1000, 10000, small_enough);
        b.memory = (struct body_memory){grow_counted, free, &c};
        for (int i = 0; i < 1000; i++) {
            size_t n = with_lines ? 4 : sizeof xy;
            const char *bytes = with_lines ? "1 1\n" : (const char *)xy;
            CHECK(body_feed(&b, bytes, n, false) == (ptrdiff_t)n);
            CHECK(c.bytes >= b.n * 16 && c.bytes <= 8 * b.n * 16 + 64 * 16);
        }
        CHECK(b.complete && b.n == 1000 && c.bytes <= 1001 * 16 && c.moves <= 4);
        body_fail(&b, BODY_LONGER);
        CHECK(b.xy == NULL && b.cap == 0);
    }
}

/* Has a body of many points written in pieces into its array, as soon as it has room; the first ones are fed. */
static void write_points(struct body *b, const double *xy, size_t bytes, size_t piece)
{
    size_t at = 0, fed = 0;
    while (at < bytes) {
        size_t n = piece, room = 0;
        char *to = body_room(b, &room);
        if (to != NULL) {
            n = n < room ? n : room;
            CHECK(room <= bytes - at);
            memcpy(to, (const char *)xy + at, n);
            body_wrote(b, n);
        } else {
            n = n < bytes - at ? n : bytes - at;
            CHECK(body_feed(b, (const char *)xy + at, n, false) == (ptrdiff_t)n);
            fed += n;
        }
        at += n;
    }
    CHECK(b->complete && (b->fault != BODY_GOOD || fed < 128 * 1024));
}

TEST(body_in_binary_form_may_be_written_into_its_array)
{
    enum { N = 20000 };
    static double xy[2 * N];
    for (size_t i = 0; i < 2 * (size_t)N; i++)
        xy[i] = (double)(i % 999);
    for (size_t piece = 1; piece < 100000; piece = 3 * piece + 7) {
        struct body b;
        body_init(&b, BODY_BINARY, N, N, small_enough);
        write_points(&b, xy, sizeof xy, piece);
        CHECK(has_points(&b, N, xy));
        body_free(&b);
        body_init(&b, BODY_BINARY, 2 * N / 5, N, small_enough);
        body_columns(&b, 2, 3);
        write_points(&b, xy, sizeof xy, piece);
        CHECK(b.fault == BODY_GOOD && b.n == 2 * N / 5 && memcmp(b.xy, xy, sizeof xy) == 0);
        body_free(&b);
    }
}

TEST(body_that_is_written_into_its_array_finds_the_invalid_point_and_the_limit)
{
    enum { N = 20000 };
    static double xy[2 * N];
    for (size_t piece = 5; piece < 100000; piece = 3 * piece + 7) {
        struct body b;
        xy[2 * 17000 + 1] = 1000;
        body_init(&b, BODY_BINARY, N, N, small_enough);
        write_points(&b, xy, sizeof xy, piece);
        CHECK(b.fault == BODY_RANGE && b.fault_line == 17001 && b.line == N && b.xy == NULL);
        xy[2 * 17000 + 1] = 0;
        body_init(&b, BODY_BINARY, N, 15000, small_enough);
        write_points(&b, xy, sizeof xy, piece);
        CHECK(b.fault == BODY_TOOBIG && b.fault_line == 15001 && b.line == N && b.xy == NULL);
    }
}

/* The bytes before the end of a body of text, line by line. */
static size_t scan_lines(enum body_form form, const char *text, uint64_t most, uint64_t *lines,
                         bool *ended)
{
    const char *at = text, *lf;
    *ended = false;
    for (*lines = 0; *lines < most && (lf = strchr(at, '\n')) != NULL; at = lf + 1, ++*lines)
        if (form == BODY_DOT && (strncmp(at, ".\n", 2) == 0 || strncmp(at, ".\r\n", 3) == 0)) {
            *ended = true;
            break;
        }
    *ended = *ended || *lines == most;
    return (size_t)(at - text);
}

TEST(body_of_text_is_scanned_for_its_last_line)
{
    static const char *const line[] = {"1 2\n",    "\n",     "0.123456789 0.123456789\n",
                                       ".\n",      ".5 2\n", ".\r\n",
                                       "1 . 2.\n", "# .\n",  "-1 -2 \r\n"};
    for (int round = 0; round < 20000; round++) {
        char text[5000], *to = text;
        uint32_t n = test_below(round % 100 == 0 ? 180 : 12), kinds = round % 3 == 0 ? 9 : 3;
        for (uint32_t i = 0; i < n; i++)
            to = stpcpy(to, line[test_below(kinds)]);
        strcpy(to, test_below(2) == 0 ? "" : "17");
        for (int form = BODY_DOT; form <= BODY_LINES; form++) {
            struct body b;
            uint64_t most = 1 + test_below(15), lines, want_lines;
            bool ended, want_ended;
            body_init(&b, (enum body_form)form, 0, 10, small_enough);
            size_t want = scan_lines((enum body_form)form, text, most, &want_lines, &want_ended);
            CHECK(body_scan(&b, text, strlen(text), most, &lines, &ended) == want);
            CHECK(lines == want_lines && ended == want_ended);
            want = scan_lines((enum body_form)form, text, UINT64_MAX, &want_lines, &want_ended);
            CHECK(body_scan(&b, text, strlen(text), UINT64_MAX, &lines, &ended) == want);
            CHECK(lines == want_lines && ended == want_ended);
        }
    }
}

TEST(body_of_thousands_of_empty_lines_is_scanned)
{
    static char text[10000];
    struct body b;
    uint64_t lines;
    bool ended;
    memset(text, '\n', sizeof text);
    body_init(&b, BODY_DOT, 0, 10, small_enough);
    CHECK(body_scan(&b, text, sizeof text, UINT64_MAX, &lines, &ended) == sizeof text);
    CHECK(lines == sizeof text && !ended);
}

TEST(body_does_not_trust_the_announced_count)
{
    struct body b;
    body_init(&b, BODY_BINARY, UINT32_MAX, UINT32_MAX, small_enough);
    double xy[] = {1, 1};
    CHECK(body_feed(&b, (const char *)xy, sizeof xy, false) == 16 && !b.complete && b.cap < 1000);
    body_free(&b);
}

TEST(body_with_values_is_read_in_any_pieces)
{
    static const char text[] = "1 2 3 nan\n # 1\n\n -4\t5  6e2 NaN \r\n7 8 -0 1\n.\nPING\n";
    static const double want[] = {1, 2, 3, 0, -4, 5, 600, 0, 7, 8, -0.0, 1};
    for (size_t piece = 1; piece <= sizeof text - 1; piece++) {
        struct body b;
        body_init(&b, BODY_DOT, 0, 10, small_enough);
        body_columns(&b, 2, 2);
        CHECK(feed(&b, text, sizeof text - 1, piece, false) == (ptrdiff_t)sizeof text - 1 - 5);
        CHECK(b.complete && b.fault == BODY_GOOD && b.n == 3);
        for (size_t i = 0; i < 12; i++)
            CHECK(b.xy[i] == want[i] || (isnan(b.xy[i]) && (i == 3 || i == 7)));
        body_free(&b);
    }
}

TEST(body_of_values_alone_is_read_in_any_pieces)
{
    static const double v[] = {1.5, (double)NAN, 1e300};
    for (size_t piece = 1; piece <= sizeof v; piece++) {
        struct body b;
        body_init(&b, BODY_BINARY, 3, 10, small_enough);
        body_columns(&b, 0, 1);
        CHECK(feed(&b, (const char *)v, sizeof v, piece, false) == sizeof v);
        CHECK(b.complete && b.fault == BODY_GOOD && b.n == 3);
        CHECK(b.xy[0] == 1.5 && isnan(b.xy[1]) && b.xy[2] == 1e300);
        body_free(&b);
    }
}

static void check_wide_fault(const char *text, enum body_fault fault, uint64_t line)
{
    struct body b;
    body_init(&b, BODY_DOT, 0, 2, small_enough);
    body_columns(&b, 2, 1);
    CHECK(feed_text(&b, text, false) == (ptrdiff_t)strlen(text));
    CHECK_MSG(b.fault == fault && b.fault_line == line, "%s: %d, line %d", text, (int)b.fault,
              (int)b.fault_line);
    body_free(&b);
}

TEST(body_with_values_ends_at_its_first_bad_line)
{
    check_wide_fault("1 2 3\n1 2\n1 2 3 4\n.\n", BODY_SYNTAX, 2);
    check_wide_fault("1 2 3 4\n.\n", BODY_SYNTAX, 1);
    check_wide_fault("1 2 3\nnan 2 3\n.\n", BODY_NUMBER, 2);
    check_wide_fault("1 2 nana\n.\n", BODY_NUMBER, 1);
    check_wide_fault("1 5000 3\n.\n", BODY_RANGE, 1);
    check_wide_fault("1 2 1e999\n.\n", BODY_VALUE, 1);
    check_wide_fault("1 2 3\n1 2 3\n1 2 3\n.\n", BODY_TOOBIG, 3);
}
