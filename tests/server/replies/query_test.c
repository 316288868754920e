/* query_test.c - which searches a reactor carries out and which a worker; both find the same. */
#include "server/ops/cost.h"
#include "tests/server/local.h"
#include "tests/test.h"

#include <math.h>
#include <string.h>

#define TAU 6.283185307179586

static char *uniform(unsigned n)
{
    char *text = malloc(n * 50 + 100), *to = text;
    CHECK(text != NULL);
    to += sprintf(to, "LOAD t %u\n", n);
    for (unsigned i = 0; i < n; i++)
        to += sprintf(to, "%.6f %.6f\n", test_uniform(), test_uniform());
    strcpy(to, "TRIANGULATE t\nNEAREST t 0 0\n");
    return text;
}

/* A hub, the point 0, with n points around it. */
static char *wheel(unsigned n)
{
    char *text = malloc(n * 60 + 100), *to = text;
    CHECK(text != NULL);
    to += sprintf(to, "LOAD t %u\n0 0\n", n + 1);
    for (unsigned i = 0; i < n; i++)
        to += sprintf(to, "%.17g %.17g\n", cos(i * TAU / n), sin(i * TAU / n));
    strcpy(to, "TRIANGULATE t\nNEAREST t 0 0\n");
    return text;
}

static uint64_t jobs_for(struct local *l, const char *request)
{
    uint64_t before = l->server.count.jobs;
    local_ask(l, request);
    CHECK_MSG(strncmp(buf_head(&l->out), "OK", 2) == 0, "%s", request);
    return l->server.count.jobs - before;
}

TEST(searches_that_find_little_need_no_worker_however_large_the_set)
{
    struct local l;
    char *load = uniform(100000), text[100];
    local_start(&l, 2);
    local_ask(&l, load);
    for (int i = 0; i < 200; i++) {
        double x = test_uniform(), y = test_uniform();
        sprintf(text, "WITHIN t %.6f %.6f 0.005", x, y);
        CHECK(jobs_for(&l, text) == 0);
        sprintf(text, "WITHIN t %.6f %.6f %.6f %.6f", x, y, x + 0.01, y + 0.01);
        CHECK(jobs_for(&l, text) == 0);
        sprintf(text, "NEAREST t %.6f %.6f 10", x, y);
        CHECK(jobs_for(&l, text) == 0);
    }
    CHECK(jobs_for(&l, "WITHIN t 0.2 0.2 0.8 0.8") > 0);
    CHECK(jobs_for(&l, "NEAREST t 0.5 0.5 5000") > 0);
    free(load);
    local_stop(&l);
}

TEST(requests_about_a_hub_go_to_a_worker)
{
    static const char *const requests[] = {"LISTS t 0", "TRIANGLES t 0", "EDGES t 0", "DEL t 0"};
    struct local l;
    char *load = wheel(2 * COST_STEPS_AT_ONCE);
    local_start(&l, 2);
    local_ask(&l, load);
    CHECK(jobs_for(&l, "LISTS t 5") == 0 && jobs_for(&l, "TRIANGLES t 5") == 0 &&
          jobs_for(&l, "TRIANGLES t 0 5") == 0 && jobs_for(&l, "EDGES t 5") == 0 &&
          jobs_for(&l, "LOCATE t 0.3 0.2") == 0);
    for (size_t i = 0; i < sizeof requests / sizeof requests[0]; i++)
        CHECK_MSG(jobs_for(&l, requests[i]) > 0, "%s", requests[i]);
    CHECK(strncmp(local_ask(&l, "CHECK t"), "OK 0 delaunay=yes", 17) == 0);
    free(load);
    local_stop(&l);
}

/* Points on a circle are all natural neighbours of a place inside; one beside a flat hull needs long numbers. */
TEST(weights_with_many_neighbours_or_long_numbers_go_to_a_worker)
{
    struct local l;
    char *load = wheel(4 * COST_STEPS_AT_ONCE);
    local_start(&l, 2);
    local_ask(&l, load);
    CHECK(jobs_for(&l, "WEIGHTS t 0.3 0.2") == 0);
    CHECK(jobs_for(&l, "DEL t 0") > 0);
    CHECK(jobs_for(&l, "WEIGHTS t 0.3 0.2") == 0);
    CHECK(jobs_for(&l, "WEIGHTS t 0.3 0.2 METHOD natural") > 0);
    CHECK(strncmp(buf_head(&l.out), "OK 8000\n", 8) == 0);
    CHECK(jobs_for(&l, "WEIGHTS t 0.3 0.2 METHOD laplace") > 0);
    CHECK(strncmp(buf_head(&l.out), "OK 8000\n", 8) == 0);
    local_ask(&l, "ADD u -1e60 0  1e60 1e-40  0 1e60  1e-42 -1e-30  1 1\nTRIANGULATE u");
    CHECK(jobs_for(&l, "WEIGHTS u 1e-41 0") == 0);
    CHECK(jobs_for(&l, "WEIGHTS u 1e-41 0 METHOD natural") > 0);
    free(load);
    local_stop(&l);
}

TEST_TIMEOUT(searches_find_the_same_with_and_without_workers, 60)
{
    static const char *const requests[] = {
        "WITHIN t 0.1 0.1 0.9 0.9",   "WITHIN t 0.5 0.5 0.45",    "NEAREST t 0.3 0.3 40000",
        "NEAREST t 0.3 0.3 3000",     "WITHIN t 0.4 0.4 0.6 0.6", "NEAREST t 2 2 99999999",
        "WITHIN t -1 -1 2 2",         "LISTS t 0 1 2 3 4 5 6 7",  "TRIANGLES t 0",
        "WITHIN t 0.5 0.5 0.0000001",
    };
    char *loads[] = {uniform(100000), wheel(20000)};
    for (int k = 0; k < 2; k++) {
        struct local none, some;
        local_start(&none, 0);
        local_start(&some, 3);
        local_ask(&none, loads[k]);
        local_ask(&some, loads[k]);
        for (size_t i = 0; i < sizeof requests / sizeof requests[0]; i++) {
            local_ask(&none, requests[i]);
            local_ask(&some, requests[i]);
            size_t n = buf_len(&none.out);
            CHECK_MSG(n == buf_len(&some.out) &&
                          memcmp(buf_head(&none.out), buf_head(&some.out), n) == 0,
                      "%s", requests[i]);
        }
        local_stop(&none);
        local_stop(&some);
        free(loads[k]);
    }
}

/* The replies to places, boxes and discs among points of a lattice, some of which coincide. */
static char *searches(struct local *l)
{
    struct buf all = {0};
    for (int i = 0; i < 12; i++) {
        char text[300];
        snprintf(text, sizeof text,
                 "NEAREST t %d.5 %d\nNEAREST t %d %d.5 9\nNEAREST t %d 0 100000\n"
                 "WITHIN t %d %d 2.5\nWITHIN t %d %d 70 3\n",
                 i, i, 5 * i, 3 * i, i, 4 * i, i, i, 2 * i);
        buf_append_text(&all, local_ask(l, text));
    }
    buf_append_char(&all, '\0');
    CHECK(!all.failed);
    return buf_head(&all);
}

TEST(places_and_ranges_are_answered_alike_before_and_after_triangulate)
{
    for (int large = 0; large < 2; large++) {
        struct local l;
        uint64_t jobs;
        int side = large ? 80 : 40; /* more points than a reactor examines, or fewer */
        char *load = malloc(64 + 6400 * 2 * 12), *to = load;
        CHECK(load != NULL);
        to += sprintf(to, "CREATE t TOL 0.25\nLOAD t\n");
        for (int i = 0; i < side * side; i++)
            to += sprintf(to, i % 7 == 0 ? "%d %d\n%d.125 %d\n" : "%d %d\n", i % side, i / side,
                          i % side, i / side);
        strcpy(to, ".\nDEL t 1 5 100\n");
        local_start(&l, 2);
        local_ask(&l, load);
        char *before = searches(&l);
        jobs = l.server.count.jobs;
        local_ask(&l, "NEAREST t 1 1");
        CHECK((l.server.count.jobs > jobs) == (large == 1));
        local_ask(&l, "TRIANGULATE t");
        char *after = searches(&l);
        CHECK_STR(before, after);
        CHECK(strstr(before, "ERR") == NULL);
        free(before);
        free(after);
        free(load);
        local_stop(&l);
    }
}
