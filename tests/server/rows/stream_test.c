/* stream_test.c - replies that workers make in pieces: the same bytes as without workers, and abandoned
 * replies, or those without memory, leave nothing behind. */
#include "server/command/command.h"
#include "server/rows/stream.h"
#include "tests/server/local.h"
#include "tests/test.h"

#include <math.h>
#include <string.h>

#define TAU 6.283185307179586

enum { SCATTERED = 13000, ON_CIRCLE = 12000 };

/* Points of a small lattice, many of them more than once, and a large circle around its centre: the
 * centre is joined to all of the circle. Then some points of the lattice are deleted. The caller
 * frees it. */
static char *set_of_many(void)
{
    char *text = malloc((SCATTERED + ON_CIRCLE) * 60 + 100), *to = text;
    CHECK(text != NULL);
    to += sprintf(to, "LOAD t\n1000 1000\n");
    for (int i = 0; i < SCATTERED; i++)
        to += sprintf(to, "%u %u\n", test_below(200), test_below(200));
    for (int i = 0; i < ON_CIRCLE; i++)
        to += sprintf(to, "%.17g %.17g\n", 1000 + 100 * cos(i * TAU / ON_CIRCLE),
                      1000 + 100 * sin(i * TAU / ON_CIRCLE));
    to += sprintf(to, ".\nDEL t");
    for (int i = 1; i < 2000; i++)
        if (i % 9 != 0)
            to += sprintf(to, " %d", i);
    strcpy(to, "\nTRIANGULATE t\n");
    return text;
}

struct text {
    char *bytes;
    size_t n;
};

static struct text reply_to(struct local *l, const char *request)
{
    local_ask(l, request);
    struct text t = {malloc(buf_len(&l->out)), buf_len(&l->out)};
    CHECK(t.bytes != NULL);
    memcpy(t.bytes, buf_head(&l->out), t.n);
    return t;
}

TEST_TIMEOUT(large_replies_have_the_same_bytes_whether_or_not_there_are_threads, 60)
{
    static const char *const requests[] = {"LISTS t CW", "TRIANGLES t", "EDGES t BINARY",
                                           "POINTS t", "WITHIN t -1 -1 2000 2000"};
    char *load = set_of_many();
    struct local none, some;
    local_start(&none, 0);
    local_start(&some, 3);
    local_ask(&none, load);
    local_ask(&some, load);
    for (size_t i = 0; i < sizeof requests / sizeof requests[0]; i++) {
        uint64_t jobs = some.server.count.jobs;
        struct text want = reply_to(&none, requests[i]), got = reply_to(&some, requests[i]);
        CHECK_MSG(want.n > 300000 && memcmp(want.bytes, "OK", 2) == 0, "%s", requests[i]);
        CHECK_MSG(got.n == want.n && memcmp(got.bytes, want.bytes, got.n) == 0, "%s", requests[i]);
        CHECK_MSG(some.server.count.jobs > jobs + 10, "%s", requests[i]);
        free(want.bytes);
        free(got.bytes);
    }
    local_stop(&none);
    local_stop(&some);
    free(load);
}

/* Requests the rows of t and waits only for the first. */
static struct answer begin(struct local *l, const char *request)
{
    struct answer a = local_begin(l, request);
    stream_refill(&l->server, &a);
    return a;
}

TEST_TIMEOUT(rows_of_an_abandoned_reply_are_freed, 60)
{
    struct local l;
    char *load = set_of_many();
    local_start(&l, 2);
    local_ask(&l, load);
    local_ask(&l, "LOCATE t 0 0"); /* builds the grid for searches */
    for (int i = 0; i < 20; i++) {
        struct answer a = begin(&l, i % 2 == 0 ? "LISTS t" : "POINTS t");
        stream_free(&l.server, a.stream); /* while workers make its rows */
    }
    local_ask(&l, "DROP t\n");
    local_collect_all(&l);
    CHECK(budget_of(&l.server.budget, BUDGET_SETS) == 0);
    free(load);
    local_stop(&l);
}

TEST(reply_whose_rows_do_not_fit_into_the_output_is_broken)
{
    struct local l;
    char *load = set_of_many();
    local_start(&l, 2);
    local_ask(&l, load);
    struct answer a = begin(&l, "POINTS t");
    local_collect_all(&l); /* some rows are made */
    buf_free(&l.out);
    test_fail_alloc(1);
    stream_refill(&l.server, &a);
    CHECK(test_alloc_failed() && a.broken);
    local_collect_all(&l);
    free(load);
    local_stop(&l);
}

TEST_TIMEOUT(large_replies_survive_failed_allocations, 60)
{
    struct local l;
    char *load = set_of_many();
    local_start(&l, 2);
    local_ask(&l, load);
    struct text want = reply_to(&l, "LISTS t");
    unsigned cut = 0;
    for (long n = 1; n < 40; n *= 2) {
        local_ask(&l, ""); /* room for the head of the reply */
        l.closed = false;
        test_fail_alloc(n);
        local_ask(&l, "LISTS t");
        test_fail_alloc(0);
        cut += l.closed;
        bool refused = strncmp(buf_head(&l.out), "ERR NOMEM", 9) == 0;
        CHECK_MSG(
            l.closed || refused ||
                (buf_len(&l.out) == want.n && memcmp(buf_head(&l.out), want.bytes, want.n) == 0),
            "allocation %ld", n);
    }
    CHECK(cut > 0);
    struct text again = reply_to(&l, "LISTS t");
    CHECK(again.n == want.n && memcmp(again.bytes, want.bytes, want.n) == 0);
    free(again.bytes);
    free(want.bytes);
    free(load);
    local_stop(&l);
}

/* ---- how much is sent at once ---- */

/* Two of four pieces of about 40 KB are sent. */
TEST(finished_pieces_are_sent_a_few_at_a_time)
{
    enum { POINTS = 21000, PIECE = 64 * 1024 };
    struct local l;
    char *text = malloc(POINTS * 50 + 100), *to = text;
    CHECK(text != NULL);
    to += sprintf(to, "LOAD t\n");
    for (int i = 0; i < POINTS; i++)
        to += sprintf(to, "%.17g %.17g\n", -1 + i / 30000.0, -1 + i / 30001.0);
    strcpy(to, ".\n");
    local_start(&l, 2);
    local_ask(&l, text);
    struct answer a = begin(&l, "POINTS t");
    local_collect_all(&l);
    buf_consume(&l.out, buf_len(&l.out));
    stream_refill(&l.server, &a);
    CHECK_MSG(buf_len(&l.out) > PIECE && buf_len(&l.out) < PIECE * 3 / 2, "%zu", buf_len(&l.out));
    stream_free(&l.server, a.stream);
    local_collect_all(&l);
    free(text);
    local_stop(&l);
}

/* ---- without memory ---- */

/* A hundred points in two rows, and two that coincide. */
static void start_ladder(struct local *l)
{
    char text[2000], *to = text + sprintf(text, "ADD t 0 0");
    for (int i = 0; i < 100; i++)
        to += sprintf(to, " %d %d", i / 2, i % 2);
    strcpy(to, "\nTRIANGULATE t\n");
    local_start(l, 0);
    local_ask(l, text);
    local_ask(l, "LISTS t 0 1 2 3\n"); /* room for words and replies */
    local_ask(l, "");
}

/* The ring of the point in the middle of a circle is a row of about 400 KB. */
TEST_TIMEOUT(row_that_is_very_long_is_sent_in_parts, 60)
{
    enum { RIM = 70000, MOST = 320 * 1024 };
    struct local none, some;
    char *text = malloc(RIM * 50 + 100), *to = text;
    CHECK(text != NULL);
    to += sprintf(to, "LOAD t\n0 0\n");
    for (int i = 0; i < RIM; i++)
        to += sprintf(to, "%.17g %.17g\n", cos(i * TAU / RIM), sin(i * TAU / RIM));
    strcpy(to, ".\nTRIANGULATE t\n");
    local_start(&none, 0);
    local_start(&some, 2);
    local_ask(&none, text);
    local_ask(&some, text);
    struct text want = reply_to(&none, "LISTS t");
    struct answer a = begin(&some, "LISTS t");
    while (a.next == ANSWER_STREAM) {
        size_t before = buf_len(&some.out);
        local_collect_all(&some);
        stream_refill(&some.server, &a);
        CHECK(buf_len(&some.out) - before <= MOST);
    }
    CHECK(a.next == ANSWER_DONE && want.n == buf_len(&some.out) + 1 &&
          memcmp(buf_head(&some.out), want.bytes, want.n - 1) == 0);
    free(want.bytes);
    free(text);
    local_stop(&none);
    local_stop(&some);
}

TEST(short_reply_without_memory_is_refused_and_the_client_stays)
{
    bool failed = true;
    for (long n = 1; failed; n++) {
        struct local l;
        start_ladder(&l);
        CHECK(n < 100);
        test_fail_alloc(n);
        const char *reply = local_ask(&l, "LISTS t 0 1 2 3\n");
        failed = test_alloc_failed();
        test_fail_alloc(0);
        bool refused = strncmp(reply, "ERR NOMEM", 9) == 0;
        CHECK_MSG(!l.closed && (failed || !refused), "allocation %ld", n);
        CHECK_MSG(refused || strncmp(reply, "OK 3 ", 5) == 0, "allocation %ld: %s", n, reply);
        local_stop(&l);
    }
}

/* All rows of an answer after its first line. */
static struct text rest_of(struct local *l, struct answer *a)
{
    buf_consume(&l->out, buf_len(&l->out));
    while (a->next == ANSWER_STREAM)
        stream_refill(&l->server, a);
    struct text t = {malloc(buf_len(&l->out) + 1), buf_len(&l->out)};
    CHECK(t.bytes != NULL);
    memcpy(t.bytes, buf_head(&l->out), t.n);
    t.bytes[t.n] = '\0';
    return t;
}

/* Requests the rows of 100 points, three times each; one of them moves before the rows are read. */
static bool reads_its_moment(long n, struct text *rows)
{
    struct local l;
    char text[1000], *to = text + sprintf(text, "GET t");
    for (int i = 0; i < 300; i++)
        to += sprintf(to, " %d", i % 100);
    start_ladder(&l);
    local_ask(&l, text);
    local_ask(&l, "");
    struct answer a = {.out = &l.out, .owner = 1, .client.role = ROLE_WRITE};
    CHECK(request_split(&l.server.reactor->request, text, strlen(text)));
    test_fail_alloc(n);
    command_run(&l.server, &l.server.reactor->request, &a);
    bool failed = test_alloc_failed();
    test_fail_alloc(0);
    CHECK(failed == (n > 0 && a.next != ANSWER_STREAM));
    CHECK_STR(local_ask(&l, "MOVE t 50 7 7\n"), "OK 0\n");
    *rows = rest_of(&l, &a);
    local_stop(&l);
    return failed;
}

TEST(rows_without_memory_for_a_view_are_refused)
{
    struct text want, rows;
    reads_its_moment(0, &want);
    CHECK(strstr(want.bytes, "50 24 1\n") != NULL);
    for (long n = 1; reads_its_moment(n, &rows); n++) {
        CHECK(n < 100 && rows.n == 0);
        free(rows.bytes);
    }
    CHECK(rows.n == want.n && memcmp(rows.bytes, want.bytes, want.n) == 0);
    free(rows.bytes);
    free(want.bytes);
}

/* One row, for which every point is examined. */
TEST(table_of_few_rows_and_many_points_is_not_read_at_once_when_memory_is_out)
{
    struct local l;
    start_ladder(&l);
    CHECK(strncmp(local_ask(&l, "COINCIDENT t\n"), "OK 1\n", 5) == 0);
    local_ask(&l, "");
    test_fail_alloc(1); /* the view */
    const char *reply = local_ask(&l, "COINCIDENT t\n");
    CHECK_MSG(test_alloc_failed() && strncmp(reply, "ERR NOMEM", 9) == 0, "%s", reply);
    test_fail_alloc(0);
    local_stop(&l);
}

/* ---- long rows ---- */

/* The centre of a circle has a ring and a cell of all other points. */
static void load_wheel(struct local *l, int rim)
{
    char *text = malloc((size_t)rim * 60 + 100), *to = text;
    CHECK(text != NULL);
    to += sprintf(to, "LOAD t\n0 0\n");
    for (int i = 0; i < rim; i++)
        to += sprintf(to, "%.17g %.17g\n", cos(i * TAU / rim), sin(i * TAU / rim));
    strcpy(to, ".\nTRIANGULATE t\n");
    local_ask(l, text);
    free(text);
}

/* Reads the reply with this memory limit; whether it is complete. Never reserves more than the limit. */
static bool read_within(struct local *l, const char *request, size_t memory)
{
    size_t used = budget_used(&l->server.budget), all = l->config.max_memory;
    local_limit(l, used + memory);
    l->server.budget.peak = used;
    l->closed = false;
    const char *reply = local_ask(l, request);
    CHECK_MSG(l->server.budget.peak <= used + memory, "%s", request);
    local_limit(l, all);
    return strncmp(reply, "OK ", 3) == 0 && !l->closed;
}

TEST(rows_that_are_longer_than_the_memory_left_end_the_reply_before_they_are_made)
{
    static const char *const requests[] = {"LISTS t\n", "VORONOI t\n", "LISTS t BINARY\n",
                                           "LISTS t WITHIN -2 -2 2 2\n"};
    enum { RIM = 30000, USUAL = 4 * 64 * 1024 + 100000, ROW = RIM * 90 };
    struct local l;
    local_start(&l, 2);
    load_wheel(&l, RIM);
    for (size_t i = 0; i < sizeof requests / sizeof *requests; i++) {
        CHECK_MSG(!read_within(&l, requests[i], USUAL), "%s", requests[i]);
        CHECK_MSG(read_within(&l, requests[i], USUAL + 2 * (size_t)ROW), "%s", requests[i]);
    }
    local_stop(&l);
}
