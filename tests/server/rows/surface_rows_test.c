/* surface_rows_test.c - values of a surface are made while they are sent. They are the values of the moment of the
 * request, although other clients edit the set, and they take the memory of a few pieces. */
#include "server/rows/row_stream.h"
#include "tests/server/local.h"
#include "tests/test.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { POINTS = 600 };

/* Each of more pieces than are made ahead. */
static const char *const rasters[] = {
    "RASTER t z 0 0 100 100 420 420 BINARY", "RASTER t z 0 0 100 100 200 220 METHOD natural BINARY",
    "RASTER t z -50 0 100 150 200 220 METHOD laplace MAXEDGE 20",
    "RASTER t z 0 0 100 100 9000 7 METHOD nearest", "RASTER t y,z,y 0 0 100 100 320 220 BINARY"};
enum { RASTERS = sizeof rasters / sizeof rasters[0] };

/* Requests that make a set t of random points of a lattice, some of them twice, with fields y and z. The caller frees them. */
static char *random_set(void)
{
    char *text = malloc(POINTS * 60 + 200), *to = text;
    CHECK(text != NULL);
    to += sprintf(to, "LOAD t FIELDS z,y\n0 0 3 1\n100 0 4 2\n100 100 5 nan\n0 100 6 4\n");
    for (int i = 0; i < POINTS; i++)
        to += sprintf(to, "%u %u %.3f %.4f\n", test_below(100), test_below(100), test_uniform(),
                      test_uniform());
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

/* Reads the rest of the reply. */
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

/* ---- CLIP ---- */

static const char fields[] =
    "ADD f 10 10 90 20 80 95 5 60 30 30 60 30 40 60\nTRIANGULATE f\n"
    "CONSTRAIN f BORDER RING 0 1 2 3\nCONSTRAIN f BORDER RING 4 5 6\nREGIONS f\n";

static const char *const clipped[] = {"RASTER t z 0 0 100 100 420 420 CLIP f BINARY",
                                      "RASTER t z -50 0 100 150 400 420 CLIP f METHOD nearest",
                                      "RASTER t z 0 0 100 100 9000 29 OUTSIDE nearest CLIP f",
                                      "RASTER t z,y 0 0 100 100 220 320 CLIP f BINARY"};

/* Also where the other set is edited, or dropped. */
TEST_TIMEOUT(values_that_another_set_clips_are_those_of_the_moment, 60)
{
    static const char *const edits[] = {"MOVE t 7 50.5 50.25\nADD t 33 22\n", "DROP f\n",
                                        "RELEASE f ALL\nMOVE f 1 99 99\n", "DROP t\nDROP f\n"};
    for (size_t i = 0; i < sizeof clipped / sizeof *clipped; i++)
        for (size_t k = 0; k < sizeof edits / sizeof *edits; k++)
            check_moment_of(fields, clipped[i], edits[k], 2 * ((i + k) % 2));
}

/* A worker marks the cells: edits of the other set wait, edits of the set do not. */
TEST(cells_are_marked_while_the_set_is_edited)
{
    struct local l;
    start_surface(&l, 2);
    local_ask(&l, fields);
    struct text want = reply_to(&l, clipped[0]);
    struct answer a = local_run(&l, clipped[0]);
    CHECK(a.next == ANSWER_WORK);
    struct buf so_far = put_aside(&l);
    struct answer edit = local_run(&l, "MOVE t 7 50.5 50.25");
    CHECK(edit.next == ANSWER_DONE && memcmp(buf_head(&l.out), "OK 0", 4) == 0);
    struct answer waits = local_run(&l, "MOVE f 1 99 99");
    CHECK(waits.next == ANSWER_WAIT && waits.wait == &local_set(&l, "f")->queue);
    buf_free(&l.out);
    l.out = so_far;
    local_wait(&l, &a);
    finish(&l, &a);
    struct text got = take_text(&l);
    CHECK(is_same(&want, &got));
    local_ask(&l, "DROP t\nDROP f\n");
    local_collect_all(&l);
    CHECK_MSG(budget_used(&l.server.budget) == 0, "%zu", budget_used(&l.server.budget));
    free(want.bytes);
    free(got.bytes);
    local_stop(&l);
}

/* By an independent way: the set clips itself, and its surface ends at its borders. */
TEST(set_that_clips_itself_ends_at_its_borders)
{
    static const char *const how[] = {"METHOD linear", "METHOD nearest MAXEDGE 30"};
    char text[200];
    for (unsigned threads = 0; threads <= 2; threads += 2) {
        struct local l;
        start_surface(&l, threads);
        local_ask(
            &l,
            "CONSTRAIN t BORDER OF 7 SPLIT RING 0 1 2\nCONSTRAIN t BORDER OF 8 SPLIT RING 1 2 3\n"
            "REGIONS t\n");
        for (int i = 0; i < 4; i++) {
            snprintf(text, sizeof text, "RASTER t z -3 -7 120 103 %s %s INSIDE",
                     i < 2 ? "9 7" : "300 200", how[i % 2]);
            struct text want = reply_to(&l, text);
            memcpy(strstr(text, "INSIDE"), "CLIP t", 6);
            struct text got = reply_to(&l, text);
            CHECK_MSG(is_same(&want, &got), "%s", text);
            CHECK(strncmp(want.bytes, "OK ", 3) == 0 && strstr(want.bytes, "nan") != NULL);
            free(want.bytes);
            free(got.bytes);
        }
        local_stop(&l);
    }
}

TEST(requests_that_cannot_be_clipped)
{
    struct local l;
    start_surface(&l, 2);
    local_ask(&l, "ADD f 0 0 50 0 50 50 0 50\n");
    static const struct {
        const char *request, *reply;
    } cases[] = {
        {"RASTER t z 0 0 1 1 1 1 CLIP\n", "ERR SYNTAX"},
        {"RASTER t z 0 0 1 1 1 1 CLIP a/b\n", "ERR SYNTAX a set's name"},
        {"RASTER t z 0 0 1 1 1 1 CLIP g\n", "ERR NOSET there is no set g"},
        {"RASTER t z 0 0 1 1 1 1 CLIP f\n", "ERR UNTRIANGULATED"},
        {"TRIANGULATE f\nRASTER t z 0 0 1 1 1 1 CLIP f\n", "OK 0"},
        {"RASTER t z 0 0 1 1 1 1 CLIP f\n", "ERR NOREGION the set f has no borders"},
        {"CONSTRAIN f 0 1\n", "OK 0 added=1"},
        {"RASTER t z 0 0 1 1 1 1 CLIP f\n", "ERR NOREGION the set f has no borders"},
        {"CONSTRAIN f BORDER PATH 0 1 2\n", "OK 0 added=2"},
        {"RASTER t z 0 0 1 1 1 1 CLIP f\n", "ERR OPEN all borders of the set f are open"},
        {"CONSTRAIN f BORDER OF 3 RING 0 1 2\n", "OK 0 added=3"},
        {"RASTER t z 0 0 100 100 2 2 METHOD nearest CLIP f\n", "OK 2 columns=2\nnan nan\n"},
        {"INTERPOLATE t z 1 1 CLIP f\n", "ERR SYNTAX"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const char *reply = local_ask(&l, cases[i].request);
        CHECK_MSG(strncmp(reply, cases[i].reply, strlen(cases[i].reply)) == 0, "%s: %s",
                  cases[i].request, reply);
    }
    local_stop(&l);
}

/* A bit for each cell is reserved until the reply ends. */
TEST(marks_of_cells_are_counted)
{
    enum { BITS = 4096 * 4096 / 8 };
    struct local l;
    start_surface(&l, 2);
    local_ask(&l, fields);
    free(reply_to(&l, clipped[0]).bytes); /* a set takes a little more when it has been read */
    local_collect_all(&l);
    size_t used = budget_used(&l.server.budget);
    struct answer a = local_begin(&l, "RASTER t z 0 0 100 100 4096 4096 CLIP f BINARY");
    size_t with = budget_of(&l.server.budget, BUDGET_REPLIES);
    stream_free(&l.server, a.stream);
    local_collect_all(&l);
    a = local_begin(&l, "RASTER t z 0 0 100 100 4096 4096 BINARY");
    CHECK(with == budget_of(&l.server.budget, BUDGET_REPLIES) + BITS);
    stream_free(&l.server, a.stream);
    local_collect_all(&l);
    CHECK_MSG(budget_used(&l.server.budget) == used, "%zu %zu", budget_used(&l.server.budget),
              used);
    local_limit(&l, used + BITS / 2);
    CHECK(strncmp(local_ask(&l, "RASTER t z 0 0 100 100 4096 4096 CLIP f BINARY\n"), "ERR BUSY",
                  8) == 0);
    CHECK(budget_used(&l.server.budget) == used);
    local_stop(&l);
}

TEST(clipped_rasters_survive_failed_allocations)
{
    unsigned failed = 0;
    for (long n = 1; n < 60; n++) {
        struct local l;
        start_surface(&l, n % 2 == 0 ? 2 : 0);
        local_ask(&l, fields);
        struct text want = reply_to(&l, clipped[1]);
        local_collect_all(&l);
        size_t used = budget_used(&l.server.budget);
        test_fail_alloc(n);
        local_ask(&l, clipped[1]);
        test_fail_alloc(0);
        struct text got = take_text(&l);
        got.n--;
        failed += !is_same(&got, &want);
        local_collect_all(&l);
        CHECK_MSG(l.closed || l.out.failed || is_same(&got, &want) ||
                      strncmp(got.bytes, "ERR ", 4) == 0,
                  "allocation %ld: %.80s", n, got.bytes);
        CHECK(budget_used(&l.server.budget) == used);
        free(want.bytes);
        free(got.bytes);
        local_stop(&l);
    }
    CHECK(failed > 2);
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
    local_limit(&l, budget_used(&l.server.budget));
    finish(&l, &a);
    CHECK(a.broken);
    local_limit(&l, SIZE_MAX);
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
    local_limit(&l, used + TEXT + VALUES - 100000);
    CHECK(strncmp(local_ask(&l, "RASTER t z 0 0 100 100 65536 100\n"), "ERR BUSY", 8) == 0);
    CHECK(budget_of(&l.server.budget, BUDGET_REPLIES) == 0);
    local_limit(&l, used + TEXT + VALUES + 100000);
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
