/* parser_test.c - text that workers parse in blocks: the body equals a body that was fed all of the text at once. */
#include "server/bodies/parser.h"

#include "tests/server/local.h"
#include "tests/test.h"

#include <stdlib.h>
#include <string.h>

struct text {
    char *bytes;
    size_t n;
};

/* Lines of many forms; one of `bad` has a fault, 0: none. The caller frees it. */
static struct text make_text(uint32_t lines, uint32_t bad)
{
    bool dots = test_below(2) == 0; /* at the beginning of lines */
    char *text = malloc(lines * 100 + 100), *to = text;
    CHECK(text != NULL);
    for (uint32_t i = 0; i < lines; i++) {
        double x = test_uniform(), y = test_uniform();
        if (bad != 0 && test_below(bad) == 0)
            to += sprintf(to, test_below(2) == 0 ? "1 x\n" : "1e300 2\n");
        else if (test_below(50) == 0)
            to += sprintf(to, test_below(2) == 0 ? "# %.9g\n" : "\n", x);
        else
            to += sprintf(to, test_below(9) != 0 ? "%.17g %.17g\n" : " %.5f\t%.3f \r\n", x, y);
        if (dots && test_below(100) == 0)
            to += sprintf(to, ".5 .25\n");
    }
    return (struct text){text, (size_t)(to - text)};
}

static void be_ready(void *ctx)
{
    *(bool *)ctx = true;
}

static void begin_body(struct body *b, enum body_form form, uint64_t lines, size_t limit)
{
    body_init(b, form, lines, limit, dt_coordinates_ok);
}

static void submit(struct parser *p)
{
    if (parser_is_full(p))
        parser_submit(p);
}

/* Has the text parsed, which arrives in pieces, as a session does. The number of bytes of the body; -1: broken framing. */
static ptrdiff_t parse(struct local *l, struct body *b, struct text t)
{
    bool ready = false;
    size_t at = 0;
    struct parser *p = parser_new(&l->server, b, 0, be_ready, &ready);
    CHECK(p != NULL);
    while (!parser_is_done(p)) {
        enum parser_step step = parser_step(p);
        size_t n = 0, piece = 1 + test_below(200000);
        char *to = step == PARSER_WAITS ? parser_room(p, &n) : NULL;
        if (step == PARSER_BROKEN)
            break;
        n = n < piece ? n : piece;
        n = n < t.n - at ? n : t.n - at;
        if (n > 0) {
            memcpy(to, t.bytes + at, n);
            parser_received(p, n);
            at += n;
        } else if (step == PARSER_WAITS) {
            if (at == t.n)
                parser_end(p);
            local_collect_all(l);
        }
        submit(p);
    }
    bool broken = !parser_is_done(p);
    size_t rest = 0;
    if (!broken)
        (void)parser_rest(p, &rest);
    parser_free(p);
    local_collect_all(l);
    at -= rest;
    ptrdiff_t took = 0;
    for (; !broken && !b->complete; at += (size_t)took)
        if ((took = body_feed(b, t.bytes + at, t.n - at, true)) < 0)
            return -1;
    return broken ? -1 : (ptrdiff_t)at;
}

static bool same(const struct body *a, const struct body *b)
{
    return a->n == b->n && a->line == b->line && a->fault == b->fault && a->left == b->left &&
           (a->fault == BODY_GOOD || a->fault_line == b->fault_line) &&
           a->line_fault == b->line_fault && (a->xy == NULL) == (b->xy == NULL) &&
           (a->xy == NULL || memcmp(a->xy, b->xy, a->n * 16) == 0);
}

/* Parses the text, and compares the body with one that has been fed the text. */
static void check(struct local *l, struct text t, enum body_form form, uint64_t lines, size_t limit)
{
    struct body fed, parsed;
    begin_body(&fed, form, lines, limit);
    begin_body(&parsed, form, lines, limit);
    ptrdiff_t want = 0, took = 0;
    for (; !fed.complete && took >= 0; want += took)
        took = body_feed(&fed, t.bytes + want, t.n - (size_t)want, true);
    want = took < 0 ? -1 : want;
    took = parse(l, &parsed, t);
    CHECK_MSG(took == want, "%td, not %td", took, want);
    CHECK(want < 0 ? parsed.line_fault == fed.line_fault : same(&parsed, &fed));
    CHECK(l->server.budget.of[BUDGET_LOADS] == 0);
    body_free(&fed);
    body_free(&parsed);
}

static uint64_t count(struct text t)
{
    uint64_t n = 0;
    for (size_t i = 0; i < t.n; i++)
        n += t.bytes[i] == '\n';
    return n;
}

TEST_TIMEOUT(text_that_workers_parse_gives_the_body_that_it_gives_when_it_is_fed, 60)
{
    struct local l;
    local_start(&l, 3);
    for (int round = 0; round < 6; round++) {
        struct text t = make_text(20000 + test_below(30000), round % 3 == 0 ? 40000 : 0);
        uint64_t lines = count(t);
        check(&l, t, BODY_LINES, lines, DT_MAX_POINTS);
        check(&l, t, BODY_LINES, lines - test_below((uint32_t)lines - 1), DT_MAX_POINTS);
        check(&l, t, BODY_LINES, lines + 1, DT_MAX_POINTS); /* ends too early */
        check(&l, t, BODY_LINES, lines, 1 + test_below((uint32_t)lines));
        memcpy(t.bytes + t.n, ".\r\nPING\n", 8);
        t.n += 8;
        check(&l, t, BODY_DOT, 0, DT_MAX_POINTS);
        check(&l, t, BODY_DOT, 0, 10000);
        free(t.bytes);
    }
    local_stop(&l);
}

TEST(text_that_workers_parse_may_end_without_a_line_end_or_in_the_middle)
{
    struct local l;
    local_start(&l, 2);
    struct text t = make_text(20000, 0);
    uint64_t lines = count(t);
    for (size_t cut = 1; cut < 20; cut++) {
        struct text part = {t.bytes, t.n - cut};
        check(&l, part, BODY_LINES, lines, DT_MAX_POINTS);
        check(&l, part, BODY_DOT, 0, DT_MAX_POINTS);
    }
    free(t.bytes);
    local_stop(&l);
}

TEST(text_that_workers_parse_with_a_nul_or_a_line_that_is_too_long_is_broken)
{
    struct local l;
    local_start(&l, 2);
    for (int i = 0; i < 20; i++) {
        struct text t = make_text(20000, i % 2 == 0 ? 0 : 10000);
        size_t at = test_below((uint32_t)t.n);
        if (i < 10)
            t.bytes[at] = '\0';
        else
            memset(t.bytes + at % (t.n - LINE_LIMIT - 10), ' ', LINE_LIMIT + 3);
        check(&l, t, BODY_LINES, count(t) + 1, DT_MAX_POINTS);
        check(&l, t, BODY_DOT, 0, DT_MAX_POINTS);
        free(t.bytes);
    }
    local_stop(&l);
}

TEST(parser_that_is_freed_while_workers_have_its_blocks_leaves_nothing)
{
    struct local l;
    struct text t = make_text(20000, 0);
    local_start(&l, 2);
    for (size_t part = 0; part < t.n; part += t.n / 7) {
        struct body b;
        bool ready = false;
        size_t n;
        begin_body(&b, BODY_DOT, 0, DT_MAX_POINTS);
        struct parser *p = parser_new(&l.server, &b, 0, be_ready, &ready);
        char *to;
        for (size_t at = 0; at < part && (to = parser_room(p, &n)) != NULL; at += n) {
            n = n < part - at ? n : part - at;
            memcpy(to, t.bytes + at, n);
            parser_received(p, n);
            submit(p);
        }
        parser_free(p);
        body_free(&b);
        local_collect_all(&l);
        CHECK(!ready && l.server.budget.of[BUDGET_LOADS] == 0);
    }
    free(t.bytes);
    local_stop(&l);
}

TEST_TIMEOUT(text_is_parsed_although_any_allocation_of_its_parser_fails, 60)
{
    struct local l;
    struct text t = make_text(20000, 0);
    local_start(&l, 2);
    for (long fail = 1; fail < 25; fail++) {
        struct body b;
        begin_body(&b, BODY_LINES, count(t), DT_MAX_POINTS);
        CHECK(body_feed(&b, t.bytes, 100000, false) > 0); /* it has memory */
        body_free(&b);
        begin_body(&b, BODY_LINES, count(t), DT_MAX_POINTS);
        bool ready = false;
        struct parser *p = parser_new(&l.server, &b, 0, be_ready, &ready);
        size_t n;
        test_fail_alloc(fail);
        char *to = parser_room(p, &n);
        for (size_t at = 0; to != NULL && at < t.n; at += n, to = parser_room(p, &n)) {
            n = n < t.n - at ? n : t.n - at;
            memcpy(to, t.bytes + at, n);
            parser_received(p, n);
            submit(p);
            local_collect_all(&l);
            while (parser_step(p) == PARSER_MOVED)
                ;
        }
        test_fail_alloc(0);
        CHECK(b.fault == BODY_GOOD || b.fault == BODY_NOMEM);
        parser_free(p);
        body_free(&b);
        local_collect_all(&l);
        CHECK(l.server.budget.of[BUDGET_LOADS] == 0);
    }
    free(t.bytes);
    local_stop(&l);
}
