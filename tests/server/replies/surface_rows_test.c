/* surface_rows_test.c - values of a surface are made while they are sent. They are the values of the moment of the
 * request, although other clients edit the set, and they take the memory of a few pieces. */
#include "server/replies/row_stream.h"
#include "tests/server/local.h"
#include "tests/test.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { POINTS = 600 };

/* Each of more pieces than are made ahead. */
static const char *const rasters[] = {"RASTER t z 0 0 100 100 420 420 BINARY",
                                      "RASTER t z 0 0 100 100 200 220 METHOD natural BINARY",
                                      "RASTER t z -50 0 100 150 200 220 METHOD laplace MAXEDGE 20",
                                      "RASTER t z 0 0 100 100 9000 7 METHOD nearest"};
enum { RASTERS = sizeof rasters / sizeof rasters[0] };

/* Requests that make a set t of random points of a lattice, some of them twice, with a field z. The caller frees them. */
static char *random_set(void)
{
    char *text = malloc(POINTS * 40 + 100), *to = text;
    CHECK(text != NULL);
    to += sprintf(to, "LOAD t FIELDS z\n0 0 3\n100 0 4\n100 100 5\n0 100 6\n");
    for (int i = 0; i < POINTS; i++)
        to += sprintf(to, "%u %u %.3f\n", test_below(100), test_below(100), test_uniform());
    strcpy(to, ".\nTRIANGULATE t\n");
    return text;
}

static void start_surface(struct local *l, unsigned threads)
{
    char *text = random_set();
    local_start(l, threads);
    local_ask(l, text);
    free(text);
}

struct text {
    char *bytes;
    size_t n;
};

static struct text take_text(struct local *l)
{
    struct text t = {malloc(buf_len(&l->out) + 1), buf_len(&l->out)};
    CHECK(t.bytes != NULL);
    memcpy(t.bytes, buf_head(&l->out), t.n);
    return t;
}

static struct text reply_to(struct local *l, const char *request)
{
    local_ask(l, request);
    struct text t = take_text(l);
    t.n--; /* the NUL behind it */
    return t;
}

static bool is_same(const struct text *a, const struct text *b)
{
    return a->n == b->n && memcmp(a->bytes, b->bytes, a->n) == 0;
}

/* Reads what is left of the reply. */
static void finish(struct local *l, struct answer *a)
{
    while (a->next == ANSWER_STREAM) {
        stream_refill(&l->server, a);
        local_collect_all(l);
    }
}

/* The output, which other requests do not see. */
static struct buf put_aside(struct local *l)
{
    struct buf out = l->out;
    l->out = (struct buf){0};
    return out;
}

/* The reply to a raster, during which the edits are made. */
static struct text reply_during(struct local *l, const char *raster, const char *edits, bool *whole)
{
    struct answer a = local_begin(l, raster);
    stream_refill(&l->server, &a);
    local_collect_all(l);
    stream_refill(&l->server, &a);
    struct buf so_far = put_aside(l);
    local_ask(l, edits);
    local_collect_all(l);
    buf_free(&l->out);
    l->out = so_far;
    finish(l, &a);
    *whole = a.next == ANSWER_DONE && !a.broken;
    return take_text(l);
}

/* One raster, with the set edited after its first pieces. */
static void check_moment_of(const char *before, const char *raster, const char *edits,
                            unsigned threads)
{
    struct local l;
    bool whole;
    start_surface(&l, threads);
    CHECK(strstr(local_ask(&l, before), "ERR") == NULL);
    struct text want = reply_to(&l, raster), got = reply_during(&l, raster, edits, &whole);
    CHECK(strncmp(want.bytes, "OK ", 3) == 0 && want.n > 300000);
    CHECK_MSG(whole && is_same(&got, &want), "%u: %s, %s", threads, raster, edits);
    free(want.bytes);
    free(got.bytes);
    local_stop(&l);
}

static void check_moment(const char *raster, const char *edits, unsigned threads)
{
    check_moment_of("", raster, edits, threads);
}

/* After an edit a copy of the set is read, which has the same constraints, also between aliases. */
TEST_TIMEOUT(values_of_a_set_with_constraints_are_those_of_the_moment, 60)
{
    static const char before[] = "ADD t 1 1 1 1 99 98\nCONSTRAIN t PATH 0 1 2\n"
                                 "RELEASE t 1 2\n";
    for (size_t i = 0; i < RASTERS; i++) {
        if (strstr(rasters[i], "natural") != NULL || strstr(rasters[i], "laplace") != NULL)
            continue;
        check_moment_of(before, rasters[i], "RELEASE t ALL\nMOVE t 7 50.5 50.25\n", 2);
        check_moment_of(before, rasters[i], "CONSTRAIN t 1 2\n", 0);
        check_moment_of(before, rasters[i], "DEL t 0 CASCADE\n", 2);
    }
}

/* Also where borders change and the triangulation does not. */
TEST_TIMEOUT(values_inside_borders_are_those_of_the_moment, 60)
{
    static const char before[] = "CONSTRAIN t BORDER OF 7 RING 0 1 2\n";
    static const char *const inside[] = {
        "RASTER t z 0 0 100 100 420 420 INSIDE 7 BINARY",
        "RASTER t z 0 0 100 100 9000 7 METHOD nearest INSIDE",
        "RASTER t z -50 0 100 150 200 220 INSIDE MAXEDGE 20",
    };
    static const char *const edits[] = {"MOVE t 7 50.5 50.25\nADD t 33 22\n",
                                        "CONSTRAIN t BORDER OF 7 RING 0 1 2 3\nREGIONS t\n",
                                        "RELEASE t ALL\nCONSTRAIN t BORDER OF 7 RING 0 2 3\n",
                                        "CONSTRAIN t BORDER OF 8 RING 0 2 3\nREGIONS t\n"};
    for (size_t i = 0; i < sizeof inside / sizeof *inside; i++)
        for (size_t k = 0; k < sizeof edits / sizeof *edits; k++)
            check_moment_of(before, inside[i], edits[k], 2 * ((i + k) % 2));
}

TEST_TIMEOUT(values_are_those_of_the_moment_of_the_request, 120)
{
    static const char edits[] = "MOVE t 7 50.5 50.25\nDEL t 1 20 21 22\n"
                                "ADD t FIELDS z 33.3 44.4 9\nFSET t z 100 2 200 300 300 -5\n";
    for (size_t i = 0; i < RASTERS; i++) {
        check_moment(rasters[i], edits, 2);
        check_moment(rasters[i], i % 2 == 0 ? "FDROP t z\nMOVE t 3 1 1\n" : "DROP t\n",
                     2 * (i % 2));
    }
    check_moment(rasters[1], edits, 0);
    check_moment(rasters[2], "FSET t z 1 1 2 2 3 3\n", 2);
}

TEST_TIMEOUT(values_do_not_depend_on_the_number_of_threads, 60)
{
    char *text = random_set();
    struct local none, some;
    local_start(&none, 0);
    local_start(&some, 3);
    local_ask(&none, text);
    local_ask(&some, text);
    for (size_t i = 0; i < RASTERS; i++) {
        struct text want = reply_to(&none, rasters[i]), got = reply_to(&some, rasters[i]);
        CHECK_MSG(is_same(&want, &got), "%s", rasters[i]);
        free(want.bytes);
        free(got.bytes);
    }
    free(text);
    local_stop(&none);
    local_stop(&some);
}

/* A gigabyte, of which the client reads nothing. */
TEST(raster_that_is_not_read_takes_the_memory_of_a_few_pieces)
{
    struct local l;
    start_surface(&l, 2);
    struct answer a = local_begin(&l, "RASTER t z 0 0 100 100 16384 8192 BINARY");
    stream_refill(&l.server, &a);
    local_collect_all(&l);
    stream_refill(&l.server, &a);
    local_collect_all(&l);
    size_t bytes = budget_of(&l.server.budget, BUDGET_REPLIES);
    CHECK_MSG(bytes >= 8 * SURFACE_PIECE && bytes < 9 * SURFACE_PIECE, "%zu", bytes);
    CHECK_MSG(buf_len(&l.out) < 2 * SURFACE_PIECE, "%zu", buf_len(&l.out));
    stream_free(&l.server, a.stream);
    local_ask(&l, "DROP t\n");
    CHECK(budget_used(&l.server.budget) == 0);
    local_stop(&l);
}

TEST(raster_that_is_given_up_leaves_nothing_behind)
{
    struct local l;
    start_surface(&l, 2);
    for (int stage = 0; stage < 4; stage++) {
        struct answer a = local_begin(&l, rasters[0]);
        stream_refill(&l.server, &a);
        if (stage > 0)
            local_collect_all(&l);
        local_ask(&l, stage % 2 == 0 ? "MOVE t 7 50.5 50.25\n" : "MOVE t 7 1.5 2.5\n");
        if (stage > 1) { /* the copy is begun, */
            stream_refill(&l.server, &a);
            local_collect_all(&l);
            stream_refill(&l.server, &a);
        }
        if (stage > 2) /* or made */
            local_collect_all(&l);
        stream_free(&l.server, a.stream);
        local_collect_all(&l);
    }
    local_ask(&l, "DROP t\n");
    local_collect_all(&l);
    CHECK_MSG(budget_used(&l.server.budget) == 0, "%zu", budget_used(&l.server.budget));
    local_stop(&l);
}

TEST(raster_without_memory_for_a_copy_is_broken)
{
    struct local l;
    struct answer a;
    start_surface(&l, 2);
    a = local_begin(&l, rasters[0]);
    stream_refill(&l.server, &a);
    local_collect_all(&l);
    local_ask(&l, "MOVE t 7 50.5 50.25\n");
    l.config.max_memory = budget_used(&l.server.budget);
    finish(&l, &a);
    CHECK(a.broken);
    l.config.max_memory = SIZE_MAX;
    local_ask(&l, "DROP t\n");
    local_collect_all(&l);
    CHECK(budget_used(&l.server.budget) == 0);
    local_stop(&l);
}

TEST_TIMEOUT(rasters_survive_failed_allocations, 60)
{
    unsigned broken = 0;
    for (long n = 1; n < 200; n = 2 * n + 1) {
        struct local l;
        start_surface(&l, 0);
        struct text want = reply_to(&l, rasters[1]);
        struct answer a = local_begin(&l, rasters[1]);
        stream_refill(&l.server, &a);
        struct buf so_far = put_aside(&l);
        local_ask(&l, "MOVE t 7 50.5 50.25\n");
        buf_free(&l.out);
        l.out = so_far;
        test_fail_alloc(n);
        finish(&l, &a);
        test_fail_alloc(0);
        struct text got = take_text(&l);
        CHECK_MSG(a.broken || is_same(&got, &want), "allocation %ld", n);
        broken += a.broken;
        free(want.bytes);
        free(got.bytes);
        local_stop(&l);
    }
    CHECK(broken > 2);
}

/* A row of text has up to two MiB: there is one piece, and no more is taken than is reserved, whether or not it fits. */
TEST(raster_of_wide_rows_takes_no_more_than_it_has_reserved)
{
    enum { COLUMNS = 65536, TEXT = 33 * COLUMNS, VALUES = 8 * COLUMNS };
    struct local l;
    start_surface(&l, 2);
    size_t used = budget_used(&l.server.budget);
    l.config.max_memory = used + TEXT + VALUES - 100000;
    CHECK(strncmp(local_ask(&l, "RASTER t z 0 0 100 100 65536 100\n"), "ERR BUSY", 8) == 0);
    CHECK(budget_of(&l.server.budget, BUDGET_REPLIES) == 0);
    l.config.max_memory = used + TEXT + VALUES + 100000;
    struct answer a = local_begin(&l, "RASTER t z 0 0 100 100 65536 100");
    size_t sent = 0;
    for (int i = 0; i < 100 && a.next == ANSWER_STREAM; i++) {
        local_collect_all(&l);
        CHECK(budget_used(&l.server.budget) <= l.config.max_memory);
        stream_refill(&l.server, &a);
        CHECK_MSG(buf_len(&l.out) <= (size_t)128 * 1024, "%zu", buf_len(&l.out));
        sent += buf_len(&l.out);
        buf_consume(&l.out, buf_len(&l.out));
    }
    CHECK_MSG(sent > (size_t)TEXT, "%zu", sent);
    if (a.next == ANSWER_STREAM)
        stream_free(&l.server, a.stream);
    local_collect_all(&l);
    CHECK(budget_of(&l.server.budget, BUDGET_REPLIES) == 0);
    local_stop(&l);
}
