/* digest_test.c - digests of sets: what they depend on, and what not. Versions differ from set to set, so where two sets
 * are compared these tests give both the same. */
#include "server/sets/digest.h"

#include "server/command/command.h"
#include "server/jobs/job.h"
#include "server/lifecycle.h"
#include "server/ops/limits.h"
#include "tests/server/local.h"
#include "tests/test.h"

#include <inttypes.h>
#include <poll.h>
#include <string.h>

enum { VERSION = 1000 };

/* The digest in the reply to DIGEST, when the set has this version. */
static uint64_t digest_at(struct local *l, const char *set, uint64_t version)
{
    char request[100];
    uint64_t digest, told;
    unsigned points;
    struct dataset *d = local_set(l, set);
    CHECK(d != NULL);
    d->version = version;
    snprintf(request, sizeof request, "DIGEST %s", set);
    const char *reply = local_ask(l, request);
    CHECK_MSG(sscanf(reply, "OK 0 digest=%16" SCNx64 " points=%u version=%" SCNu64 "\n", &digest,
                     &points, &told) == 3 &&
                  strchr(reply, ' ') + 26 == strstr(reply, " points="),
              "%s", reply);
    CHECK(told == version && points == d->current->sum.points);
    return digest;
}

/* The same of a set t that was made by these requests. */
static uint64_t digest_after(const char *requests)
{
    struct local l;
    local_start(&l, 0);
    CHECK(strstr(local_ask(&l, requests), "ERR") == NULL);
    uint64_t digest = digest_at(&l, "t", VERSION);
    local_stop(&l);
    return digest;
}

#define BASE "ADD t 0 0 4 0 0 4 1.5 1.5 4 0\nFSET t z 0 1 2 -2.5\n"

TEST(split_set_has_the_digest_of_its_points_values_and_parts)
{
    const char *const cross = "ADD t 0 0 4 4 0 4 4 0\nFSET t z 0 0 1 8 2 8 3 0\n";
    char split[200], parts[200];
    snprintf(split, sizeof split, "%sCONSTRAIN t OF 5 0 1\nCONSTRAIN t SPLIT 3 2\n", cross);
    snprintf(parts, sizeof parts,
             "%sADD t FIELDS z 2 2 4\nCONSTRAIN t 2 4 3 4\nCONSTRAIN t OF 5 0 4 1 4\n", cross);
    CHECK(digest_after(split) == digest_after(parts));
}

TEST(digest_differs_after_any_single_change)
{
    static const char *const sets[] = {
        BASE, BASE "MOVE t 3 1.5 1.5000000000000002\n", /* the last bit */
        BASE "MOVE t 3 1.5000000000000002 1.5\n", BASE "MOVE t 4 4 1\n", BASE "DEL t 4\n",
        BASE "ADD t 9 9\n", BASE "ADD t 9 9\nDEL t 5\n", /* the next id */
        BASE "FSET t z 0 1.0000000000000002\n", BASE "FSET t z 0 nan\n", BASE "FSET t z 1 1\n",
        BASE "FSET t z 0 nan 1 1\n", /* at another id */
        BASE "FSET t z 4 0\n",       /* of an alias */
        BASE "FSET t zz 0 1\n", BASE "FSET t zz 0 2\n", BASE "FSET t y 0 1\n",
        BASE "FSET t y 0 nan\n",                                     /* a field without values */
        BASE "FDROP t z\n", BASE "FDROP t z\nFSET t y 0 1 2 -2.5\n", /* another name */
        BASE "TRIANGULATE t\n", "CREATE t TOL 0.5\n" BASE, "CREATE t TOL 0.25\n" BASE, "CREATE t\n",
        "CREATE t TOL 1\n", "CREATE t\nTRIANGULATE t\n", "ADD t 0 0\nDEL t 0\n",
        "ADD t 0 0\nFSET t z 0 1\nDEL t 0\n", "ADD t 0 0\n", "ADD t 0 1\n", "ADD t 1 0\n",
        BASE "CONSTRAIN t 0 1\n", BASE "CONSTRAIN t BORDER 0 1\n", BASE "CONSTRAIN t OF 1 0 1\n",
        BASE "CONSTRAIN t 0 2\n", BASE "CONSTRAIN t PATH 0 1 2\n",
        BASE "TRIANGULATE t\nCONSTRAIN t 0 1\n",
        /* the same rows, but for the representative of the last point */
        "CREATE t TOL 1\nADD t 0 0 1.5 0 0.75 0\n",
        "CREATE t TOL 1\nADD t 0 0 1.5 0 0.7 0\nMOVE t 2 0.8 0\nMOVE t 2 0.75 0\n",
        "CREATE t TOL 1\nADD t 9 0 1.5 0 0.75 0\nMOVE t 0 0 0\n"};
    enum { N = sizeof sets / sizeof sets[0] };
    uint64_t digest[N];
    for (unsigned i = 0; i < N; i++) {
        digest[i] = digest_after(sets[i]);
        for (unsigned k = 0; k < i; k++)
            CHECK_MSG((digest[i] == digest[k]) == (i == N - 2 && k == N - 3), "%s and %s", sets[k],
                      sets[i]);
    }
}

TEST(digest_depends_on_the_version_and_on_when_the_set_ends)
{
    struct local l;
    local_start(&l, 0);
    local_ask(&l, BASE "EXPIRE t 1000\n");
    uint64_t d = digest_at(&l, "t", VERSION);
    CHECK(digest_at(&l, "t", VERSION + 1) != d);
    CHECK(digest_at(&l, "t", VERSION) == d);
    local_set(&l, "t")->temporary = true;
    CHECK(digest_at(&l, "t", VERSION) != d);
    local_set(&l, "t")->temporary = false;
    local_set(&l, "t")->expires_ms++;
    CHECK(digest_at(&l, "t", VERSION) != d);
    local_ask(&l, "PERSIST t\n");
    CHECK(digest_at(&l, "t", VERSION) == digest_after(BASE));
    local_stop(&l);
}

TEST(digest_is_the_same_when_a_change_has_been_undone)
{
    uint64_t base = digest_after(BASE);
    CHECK(digest_after(BASE "MOVE t 3 4 0\nMOVE t 3 1.5 1.5\n") == base);
    CHECK(digest_after(BASE "MOVE t 1 7 7\nMOVE t 1 4 0\n") == base);
    CHECK(digest_after(BASE "FSET t z 1 5\nFSET t z 1 nan\n") == base);
    CHECK(digest_after(BASE "FSET t y 0 nan\nFDROP t y\n") == base);
    CHECK(digest_after("ADD t 0 0 4 0 -0 4 1.5 1.5 4 -0\nFSET t z 2 -2.5 0 1\n") == base);
    CHECK(digest_after("CREATE t TOL -0\n" BASE) == base);
    CHECK(digest_after("CREATE other\nADD other 1 1\n" BASE) == base);
    CHECK(digest_after(BASE "CONSTRAIN t 0 3 1 2\nRELEASE t ALL\n") == base);
    uint64_t fenced = digest_after(BASE "CONSTRAIN t BORDER OF 9 RING 0 1 2\nCONSTRAIN t 3 4\n");
    CHECK(fenced != base);
    CHECK(digest_after(BASE "CONSTRAIN t 3 4 0 3\nCONSTRAIN t BORDER OF 9 1 0 2 1 0 2\n"
                            "RELEASE t 3 0\n") == fenced);
    CHECK(digest_after(BASE "FSET t z 1 0\n") == digest_after(BASE "FSET t z 1 -0\n"));
}

/* Values of deleted points, and whole pages of them. */
TEST(digest_does_not_depend_on_values_that_are_gone)
{
    enum { MANY = 2000 };
    char *text = malloc(64 * MANY), *more = malloc(64 * MANY);
    CHECK(text != NULL && more != NULL);
    size_t n = (size_t)sprintf(text, "LOAD t\n");
    for (int i = 0; i < MANY; i++)
        n += (size_t)sprintf(text + n, "%d %d\n", i, i * i);
    n += (size_t)sprintf(text + n, ".\nFSET t z 3 7 1999 8\n");
    size_t m = (size_t)sprintf(more, "%sFSET t z", text);
    for (int i = 600; i < 1700; i++)
        m += (size_t)sprintf(more + m, " %d %d", i, i);
    m += (size_t)sprintf(more + m, "\nDEL t");
    n += (size_t)sprintf(text + n, "DEL t");
    for (int i = 500; i < 1800; i++) {
        n += (size_t)sprintf(text + n, " %d", i);
        m += (size_t)sprintf(more + m, " %d", i);
    }
    CHECK(digest_after(text) == digest_after(more));
    free(text);
    free(more);
}

/* A random history of t, and u with its result, loaded at once and triangulated by the other engine. */
static void expect_equal_sets(struct local *l, bool triangulated)
{
    enum { POINTS = 60, FIELDS = 3 };
    char line[200], *copy = malloc(100000);
    int at[POINTS][2], value[FIELDS][POINTS];
    bool there[POINTS], has[FIELDS][POINTS] = {{false}};
    CHECK(copy != NULL);
    size_t n = (size_t)sprintf(copy, "ADD u");
    local_ask(l, "ADD t 0 0\nFSET t a 0 nan\nFSET t b 0 nan\nFSET t c 0 nan\n");
    for (int i = 1; i < POINTS; i++)
        local_ask(l, "ADD t 7 7\n");
    for (int i = 0; i < POINTS; i++) {
        there[i] = true;
        at[i][0] = at[i][1] = i == 0 ? 0 : 7;
    }
    for (int step = 0; step < 400; step++) {
        uint32_t id = test_below(POINTS), f = test_below(FIELDS);
        unsigned what = test_below(20);
        if (!there[id])
            continue;
        if (what == 0) {
            snprintf(line, sizeof line, "DEL t %u\n", (unsigned)id);
            there[id] = false;
        } else if (what == 1 && triangulated) {
            snprintf(line, sizeof line, "TRIANGULATE t\n");
        } else if (what < 10) {
            at[id][0] = (int)test_below(5), at[id][1] = (int)test_below(5);
            snprintf(line, sizeof line, "MOVE t %u %d %d\n", (unsigned)id, at[id][0], at[id][1]);
        } else {
            has[f][id] = test_below(3) > 0;
            value[f][id] = (int)test_below(9);
            snprintf(line, sizeof line, has[f][id] ? "FSET t %c %u %d\n" : "FSET t %c %u nan\n",
                     (char)('a' + f), (unsigned)id, value[f][id]);
        }
        CHECK_MSG(strncmp(local_ask(l, line), "OK", 2) == 0, "%s", line);
    }
    for (int i = 0; i < POINTS; i++)
        n += (size_t)sprintf(copy + n, " %d %d", at[i][0], at[i][1]);
    n += (size_t)sprintf(copy + n, "\nFSET u c 0 nan\nFSET u b 0 nan\nFSET u a 0 nan\n");
    if (triangulated)
        n += (size_t)sprintf(copy + n, "TRIANGULATE u METHOD shelling\nTRIANGULATE t\n");
    for (int i = POINTS - 1; i >= 0; i--) {
        for (int f = 0; f < FIELDS; f++)
            if (has[f][i])
                n += (size_t)sprintf(copy + n, "FSET u %c %d %d\n", 'a' + f, i, value[f][i]);
        if (!there[i])
            n += (size_t)sprintf(copy + n, "DEL u %d\n", i);
    }
    CHECK(strstr(local_ask(l, copy), "ERR") == NULL);
    CHECK(digest_at(l, "t", VERSION) == digest_at(l, "u", VERSION));
    free(copy);
}

TEST(digests_of_equal_sets_are_equal_whatever_their_history)
{
    for (unsigned i = 0; i < 20; i++) {
        struct local l;
        local_start(&l, i % 3);
        expect_equal_sets(&l, i % 2 == 1);
        local_stop(&l);
    }
}

/* Returns all that a client can see of the set with this name; the caller frees it. */
static char *replies_about(struct local *l, const char *set)
{
    char request[200], next[64];
    int n = snprintf(request, sizeof request, "FIELDS %s\n", set);
    bool z = strstr(local_ask(l, request), "\nz ") != NULL;
    n += snprintf(request + n, sizeof request - (size_t)n, "COINCIDENT %s\nHULL %s\nPOINTS %s%s\n",
                  set, set, set, z ? " FIELDS z" : "");
    snprintf(next, sizeof next, "%u\n", (unsigned)dt_next_id(local_set(l, set)->current->dt));
    const char *replies = local_ask(l, request);
    char *text = malloc(strlen(replies) + strlen(next) + 1);
    CHECK(text != NULL);
    return strcat(strcpy(text, replies), next);
}

/* A request about a set with few points, places and values, so that sets are often equal; it may be refused. */
static void change_a_little(struct local *l, char set)
{
    char line[100];
    unsigned id = test_below(2), x = test_below(2);
    switch (test_below(9)) {
    case 0:
        snprintf(line, sizeof line, "DROP %c\nCREATE %c\n", set, set);
        break;
    case 1:
        snprintf(line, sizeof line, "TRIANGULATE %c\n", set);
        break;
    case 2:
        snprintf(line, sizeof line, "FDROP %c z\n", set);
        break;
    case 3:
        snprintf(line, sizeof line, "DEL %c %u\n", set, id);
        break;
    case 4:
        snprintf(line, sizeof line, "FSET %c z %u nan\n", set, id);
        break;
    case 5:
        snprintf(line, sizeof line, "FSET %c z %u %u\n", set, id, x);
        break;
    case 6:
        snprintf(line, sizeof line, "MOVE %c %u %u 0\n", set, id, x);
        break;
    default:
        snprintf(line, sizeof line, "ADD %c %u 0\n", set, x);
    }
    local_ask(l, line);
}

TEST(digests_are_equal_where_replies_are_equal_and_nowhere_else)
{
    enum { SETS = 6, STEPS = 1500 };
    struct local l;
    char *replies[SETS] = {NULL};
    uint64_t digest[SETS];
    unsigned equal = 0;
    local_start(&l, 0);
    local_ask(&l, "CREATE a\nCREATE b\nCREATE c\nCREATE d\nCREATE e\nCREATE f\n");
    for (unsigned step = 0; step < STEPS; step++) {
        unsigned i = step < SETS ? step : test_below(SETS);
        char name[] = {(char)('a' + i), '\0'};
        change_a_little(&l, name[0]);
        free(replies[i]);
        replies[i] = replies_about(&l, name);
        digest[i] = digest_at(&l, name, VERSION);
        for (unsigned k = 0; k < SETS && k <= step; k++) {
            CHECK_MSG((digest[i] == digest[k]) == (strcmp(replies[i], replies[k]) == 0), "%s%s",
                      replies[i], replies[k]);
            equal += i != k && digest[i] == digest[k];
        }
    }
    CHECK(equal > STEPS / 50 && equal < STEPS * (SETS - 1) / 2);
    for (unsigned i = 0; i < SETS; i++)
        free(replies[i]);
    local_stop(&l);
}

/* ---- pieces ---- */

/* The set t with n points, and values of the field z at the ids near the ends of pages. */
static void load_many(struct local *l, uint32_t n)
{
    char *text = malloc(32 * (size_t)n + 64),
         *to = text + sprintf(text, "LOAD t %u\n", (unsigned)n);
    CHECK(text != NULL);
    for (uint32_t i = 0; i < n; i++)
        to += sprintf(to, "%u %u\n", (unsigned)(i % 1000), (unsigned)(i / 1000));
    CHECK(strncmp(local_ask(l, text), "OK", 2) == 0);
    for (uint32_t i = 511; i < n; i += 512) {
        sprintf(text, "FSET t z %u 1 %u 2\n", (unsigned)i, (unsigned)(i + 1 < n ? i + 1 : 0));
        CHECK(strncmp(local_ask(l, text), "OK", 2) == 0);
    }
    free(text);
}

TEST(digest_covers_every_row_and_page)
{
    static const uint32_t sizes[] = {DIGEST_ROWS - 1, DIGEST_ROWS, DIGEST_ROWS + 1,
                                     5 * DIGEST_ROWS + 100};
    for (unsigned k = 0; k < sizeof sizes / sizeof sizes[0]; k++) {
        struct local l;
        char line[100];
        uint32_t n = sizes[k], ids[] = {0, 511, 512, DIGEST_ROWS - 2, DIGEST_ROWS, n / 2, n - 1};
        local_start(&l, k % 2 * 2);
        load_many(&l, n);
        uint64_t before = digest_at(&l, "t", VERSION);
        for (unsigned i = 0; i < sizeof ids / sizeof ids[0]; i++) {
            unsigned id = ids[i];
            sprintf(line, "MOVE t %u -5 -5\n", id);
            if (id >= n)
                continue;
            local_ask(&l, line);
            CHECK_MSG(digest_at(&l, "t", VERSION) != before, "row %u of %u", id, (unsigned)n);
            sprintf(line, "MOVE t %u %u %u\nFSET t y %u 1\n", id, id % 1000, id / 1000, id);
            local_ask(&l, line);
            uint64_t one = digest_at(&l, "t", VERSION);
            sprintf(line, "FSET t y %u 2\n", id);
            local_ask(&l, line);
            uint64_t two = digest_at(&l, "t", VERSION);
            local_ask(&l, "FDROP t y\n");
            CHECK_MSG(one != two && one != before, "value %u of %u", id, (unsigned)n);
            CHECK(digest_at(&l, "t", VERSION) == before);
        }
        local_stop(&l);
    }
}

/* Edits between the pieces, of rows and values that have been read and that have not. */
TEST(empty_page_that_a_view_has_kept_does_not_count)
{
    struct local l;
    local_start(&l, 0);
    local_ask(&l, BASE "FSET t z 0 nan 2 nan\n");
    uint64_t empty = digest_at(&l, "t", VERSION);
    local_ask(&l, "FSET t z 0 1\n");
    struct version *v = version_pin(local_set(&l, "t")->current);
    struct dt_view *view = dt_view_begin(v->dt, false);
    local_ask(&l, "FSET t z 0 nan\n");
    CHECK(digest_at(&l, "t", VERSION) == empty);
    version_end_view(&l.server.sets, v, view);
    version_unpin(&l.server.sets, v);
    local_stop(&l);
}

TEST(digest_is_of_the_moment_when_it_begins)
{
    static const char *const edits[] = {
        "MOVE t 0 -7 -7\n",       "MOVE t 15999 -8 -8\n", "DEL t 3 12000 5000\n",
        "FSET t z 2 5 15000 5\n", "ADD t 0 0 500 500\n",  "FSET t a 9 9\n",
        "FSET t z 511 nan\n",     "FDROP t z\n",          "TRIANGULATE t\n",
        "FSET t z 1 1\n",         "EXPIRE t 900\n"};
    enum { EDITS = sizeof edits / sizeof edits[0], POINTS = 16000 };
    for (unsigned first = 0; first < EDITS; first++) {
        struct local l;
        struct digest d;
        bool done = false;
        local_start(&l, 0);
        load_many(&l, POINTS);
        local_ask(&l, "FSET t zz 0 1\nTRIANGULATE t\n");
        uint64_t quiet = digest_at(&l, "t", VERSION);
        struct version *v = version_pin(local_set(&l, "t")->current);
        CHECK(digest_begin(&d, local_set(&l, "t")));
        for (unsigned i = first; !done; i++) {
            CHECK(strstr(local_ask(&l, edits[i % EDITS]), "ERR NO") == NULL || i >= EDITS);
            unsigned before = digest_progress(&d);
            CHECK(digest_read(&d, v->dt, &done) == DT_OK);
            CHECK(digest_progress(&d) >= before && digest_progress(&d) <= 100);
        }
        CHECK(d.value == quiet && d.version == VERSION && d.points == POINTS);
        version_end_view(&l.server.sets, v, d.view);
        version_unpin(&l.server.sets, v);
        local_stop(&l);
    }
}

/* ---- the job ---- */

enum { LARGE = 50000 };

static void ask(struct local *l, struct answer *a, const char *line)
{
    struct word w = {line, strlen(line)};
    CHECK(request_split(&l->server.reactor->request, w.text, w.len));
    *a = (struct answer){.out = &l->out, .owner = 1, .client.role = ROLE_WRITE};
    command_run(&l->server, &l->server.reactor->request, a);
}

struct ending {
    struct server *server;
    enum dt_status status;
};

static void end_job(void *ctx, struct job *j)
{
    struct ending *e = ctx;
    e->status = j->status;
    server_finish_abandoned(e->server, j);
}

TEST(digest_of_a_large_set_is_a_job_that_is_cancelled_with_its_client)
{
    struct local l;
    struct answer a;
    struct ending e = {&l.server, DT_OK};
    local_start(&l, 1);
    load_many(&l, LARGE);
    uint64_t jobs = l.server.count.jobs, digest = digest_at(&l, "t", VERSION);
    CHECK(l.server.count.jobs == jobs + 1);
    struct version *v = local_set(&l, "t")->current;
    gate_close(&v->gate); /* so that the worker waits */
    ask(&l, &a, "DIGEST t");
    CHECK(a.next == ANSWER_WORK && strcmp(a.job->what, "reading") == 0);
    a.job->cancel = true;
    gate_open(&v->gate);
    while (!list_is_empty(&l.server.jobs)) {
        struct pollfd event = {.fd = workers_event(l.server.workers), .events = POLLIN};
        CHECK(poll(&event, 1, 10000) == 1);
        server_collect(&l.server, end_job, &e);
    }
    CHECK(e.status == DT_CANCELLED);
    CHECK(digest_at(&l, "t", VERSION) == digest);
    local_stop(&l);
}

TEST(digest_is_refused_when_too_many_requests_wait_for_a_worker)
{
    struct local l;
    struct answer a;
    local_start(&l, 1);
    load_many(&l, LARGE);
    struct version *v = local_set(&l, "t")->current;
    gate_close(&v->gate);
    for (int i = 0; i < 2 * LIMIT_QUEUED_JOBS && l.out.failed == false; i++) {
        buf_consume(&l.out, buf_len(&l.out));
        ask(&l, &a, "DIGEST t");
        if (a.next != ANSWER_WORK)
            break;
    }
    buf_append_char(&l.out, '\0');
    CHECK_STR(buf_head(&l.out), "ERR BUSY too many requests are waiting for a worker; try again\n");
    gate_open(&v->gate);
    local_stop(&l);
}
