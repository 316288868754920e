/* handlers_test.c - the commands without sockets: with and without workers, and with memory that
 * runs out. */
#include "server/commands.h"
#include "tests/server/local.h"
#include "tests/test.h"

#include <string.h>

#define SQUARE "ADD t 0 0  4 0  4 4  0 4  2 2  2 2\n"

/* n points along a parabola, as one load; the caller frees it. */
static char *parabola(int n)
{
    char *text = malloc((size_t)n * 32 + 100);
    CHECK(text != NULL);
    size_t at = (size_t)sprintf(text, "LOAD t\n");
    for (int i = 0; i < n; i++)
        at += (size_t)sprintf(text + at, "%d %lld\n", i, (long long)i * i);
    strcpy(text + at, ".\n");
    return text;
}

TEST(commands_are_named_once_and_explained)
{
    struct local l;
    local_start(&l, 0);
    for (size_t i = 0; i < command_count; i++) {
        struct word name = {commands[i].name, strlen(commands[i].name)};
        CHECK(command_find(&l.server, &name) == &commands[i]);
        CHECK(strncmp(commands[i].usage, commands[i].name, name.len) == 0);
        CHECK(commands[i].least >= 1 && commands[i].help[0] != '\0');
        CHECK(!command_needs_set(&commands[i]) || (commands[i].flags & CMD_SET) != 0);
        unsigned edits = CMD_SET | CMD_WRITE;
        CHECK((commands[i].flags & edits) == edits || commands[i].change == CHANGE_NONE);
        CHECK(commands[i].read == NULL || commands[i].handler == cmd_change);
    }
    local_stop(&l);
}

/* Clients know by its name whether a body follows a request: proto/request.h. */
TEST(names_say_which_commands_have_a_body)
{
    for (size_t i = 0; i < command_count; i++) {
        bool body = commands[i].body.rows != LOAD_NOTHING;
        CHECK_MSG(line_is_whole_request(commands[i].name, strlen(commands[i].name)) == !body, "%s",
                  commands[i].name);
    }
}

/* Whether the status line has the fact `key:type` or `key:type?` of command.h, with a value of that type. */
static bool has_fact(const char *reply, const char *fact)
{
    static const char *const ranges[] = {"i0123456789", "d0123456789.e+-", "b01yesno", NULL};
    char key[40];
    size_t n = strcspn(fact, ":");
    snprintf(key, sizeof key, " %.*s=", (int)n, fact);
    const char *at = strstr(reply, key);
    if (at == NULL)
        return fact[n + 2] == '?';
    size_t length = strcspn(at += n + 2, " \n");
    for (size_t i = 0; ranges[i] != NULL; i++)
        if (ranges[i][0] == fact[n + 1])
            return length > 0 && strspn(at, ranges[i] + 1) >= length;
    return fact[n + 1] == 's' && length > 0;
}

TEST(results_of_commands_are_those_of_the_table)
{
    static const char *const requests[] = {
        SQUARE,        "LOAD t 1\n9 9\n", "LOADB t 0\n", "TRIANGULATE t\n", "CHECK t\n",
        "DEL t 1\n",   "STAT t\n",        "DIGEST t\n",  "EXPIRE t 9\n",    "TTL t\n",
        "PERSIST t\n", "TTL t\n",         "STAT t\n",    "WAIT 0 1\n",      "HELLO\n"};
    struct local l;
    local_start(&l, 0);
    for (size_t i = 0; i < sizeof requests / sizeof requests[0]; i++) {
        struct word name = {requests[i], strcspn(requests[i], " \n")};
        const char *reply = local_ask(&l, requests[i]);
        CHECK_MSG(strncmp(reply, "OK ", 3) == 0, "%s%s", requests[i], reply);
        const char *fact = command_find(&l.server, &name)->result;
        for (; fact != NULL; fact = strchr(fact, ' ') != NULL ? strchr(fact, ' ') + 1 : NULL)
            CHECK_MSG(has_fact(reply, fact), "%s%s: %s", requests[i], reply, fact);
    }
    local_stop(&l);
}

TEST(workers_give_the_same_replies_as_none)
{
    static const char *const requests[] = {"TRIANGULATE t METHOD divide",
                                           "LISTS t",
                                           "TRIANGLES t",
                                           "POINTS t",
                                           "NEAREST t 3 3 500",
                                           "LISTS t 1 2 900 4",
                                           "HULL t CW",
                                           "CHECK t",
                                           "ADD t 5 5",
                                           "LISTS t 3000",
                                           "STAT t",
                                           "DEL t 3 4 5",
                                           "EDGES t"};
    struct local none, some;
    char *load = parabola(3000);
    local_start(&none, 0);
    local_start(&some, 3);
    CHECK_UNVERSIONED(local_ask(&some, load), local_ask(&none, load));
    for (size_t i = 0; i < sizeof requests / sizeof requests[0]; i++) {
        char *want = strdup(local_ask(&none, requests[i]));
        CHECK(strncmp(want, "OK", 2) == 0);
        char *got = strdup(local_ask(&some, requests[i]));
        if (i == 0) { /* the time it took differs */
            *strstr(want, "ms=") = '\0';
            *strstr(got, "ms=") = '\0';
        }
        CHECK_UNVERSIONED(got, want);
        free(got);
        free(want);
    }
    CHECK(some.server.count.jobs > 2 && none.server.count.jobs == 0);
    free(load);
    local_stop(&none);
    local_stop(&some);
}

TEST(set_that_is_read_is_edited_in_place)
{
    struct local l;
    local_start(&l, 0);
    local_ask(&l, SQUARE);
    struct dataset *set = local_set(&l, "t");
    struct version *v = version_pin(set->current);
    struct dt_view *view = dt_view_begin(v->dt, false);
    CHECK(view != NULL);
    CHECK_STR(local_ask(&l, "MOVE t 0 9 9\nGET t 0"), "OK 0\nOK 1\n0 9 9\n");
    CHECK(set->current == v);
    struct dt_point p;
    CHECK(dt_view_get(v->dt, view, 0, &p) == DT_OK && p.x == 0 && p.y == 0);
    local_ask(&l, "DROP t");
    CHECK(dt_view_get(v->dt, view, 0, &p) == DT_OK && p.x == 0);
    version_end_view(&l.server.sets, v, view);
    version_unpin(&l.server.sets, v);
    CHECK(budget_of(&l.server.budget, BUDGET_SETS) == 0);
    local_stop(&l);
}

/* A hundred points in a line, so many that the set is triangulated again. */
static const char *many_points(const char *name)
{
    static char text[2000];
    size_t at = (size_t)sprintf(text, "ADD %s", name);
    for (int i = 0; i < 100; i++)
        at += (size_t)sprintf(text + at, " %d 50", i);
    return text;
}

TEST(edit_that_ends_in_a_rebuild_makes_a_version_of_its_own_while_triangles_are_read)
{
    struct local l;
    local_start(&l, 0);
    local_ask(&l, SQUARE "TRIANGULATE t");
    struct dataset *set = local_set(&l, "t");
    struct version *v = version_pin(set->current);
    struct dt_view *view = dt_view_begin(v->dt, true);
    CHECK(view != NULL);
    local_ask(&l, "MOVE t 0 0.5 0.5\nTRIANGULATE t METHOD divide");
    CHECK(set->current == v);
    local_ask(&l, many_points("t"));
    CHECK(set->current != v && v->refs == 1);
    struct dt_point p;
    CHECK(dt_view_get(v->dt, view, 0, &p) == DT_OK && p.x == 0);
    version_end_view(&l.server.sets, v, view);
    version_unpin(&l.server.sets, v);
    v = set->current;
    local_ask(&l, "LISTS t\nDEL t 0\nTRIANGULATE t METHOD divide");
    CHECK(set->current == v); /* it has no readers, so it is edited in place */
    local_stop(&l);
}

/* On a worker, and beside those who read the set. */
TEST(grid_for_searches_is_built_when_the_first_one_asks)
{
    struct local l;
    char *load = parabola(3000);
    local_start(&l, 2);
    local_ask(&l, load);
    local_ask(&l, "TRIANGULATE t\nLISTS t 5");
    struct version *read = version_pin(local_set(&l, "t")->current);
    size_t without = read->sum.memory;
    uint64_t jobs = l.server.count.jobs;
    CHECK(!read->sum.searchable);
    CHECK(strncmp(local_ask(&l, "NEAREST t 3 9"), "OK 1\n3 ", 7) == 0);
    CHECK(l.server.count.jobs == jobs + 1 && read->sum.searchable && read->sum.memory > without);
    CHECK(local_set(&l, "t")->current == read);
    local_ask(&l, "LOCATE t 3 9\nNEAREST t 4 16");
    CHECK(l.server.count.jobs == jobs + 1);
    version_unpin(&l.server.sets, read);
    local_ask(&l, "TRIANGULATE t METHOD divide");
    jobs = l.server.count.jobs;
    local_ask(&l, "ADD t 0.5 9"); /* an edit that finds no grid builds it, too */
    CHECK(l.server.count.jobs == jobs + 1);
    local_ask(&l, "ADD t 0.6 9\nMOVE t 3000 0.7 9\nDEL t 3001\nNEAREST t 0 0");
    CHECK(l.server.count.jobs == jobs + 1);
    free(load);
    local_stop(&l);
}

TEST(set_that_a_failed_request_created_is_gone)
{
    struct local l;
    local_start(&l, 0);
    local_ask(&l, "ADD t 1 2 3 x\nLOAD u\n1 1\n2\n.\nADD v 1 1e300\n");
    CHECK_STR(local_ask(&l, "SETS"), "OK 0\n");
    CHECK(l.server.sets.sets == 0 && budget_of(&l.server.budget, BUDGET_SETS) == 0);
    local_stop(&l);
}

TEST(memory_of_sets_is_accounted_for)
{
    struct local l;
    struct dt_summary sum;
    char *load = parabola(1000);
    local_start(&l, 2);
    local_ask(&l, load);
    local_ask(&l, "TRIANGULATE t\nADD u 1 1\nDEL t 1 2 3\nLISTS t\n");
    size_t total = 0;
    for (int i = 0; i < 2; i++) {
        dt_summary(local_set(&l, i == 0 ? "t" : "u")->current->dt, &sum);
        total += sum.memory;
    }
    CHECK(budget_of(&l.server.budget, BUDGET_SETS) == total &&
          budget_of(&l.server.budget, BUDGET_LOADS) == 0);
    local_ask(&l, "DROP t\nDROP u\n");
    CHECK(budget_of(&l.server.budget, BUDGET_SETS) == 0);
    free(load);
    local_stop(&l);
}

TEST(set_that_is_read_is_not_copied_beyond_the_memory_for_sets)
{
    struct local l;
    char *load = parabola(3000), *more = parabola(600);
    local_start(&l, 0);
    local_ask(&l, load);
    local_ask(&l, "TRIANGULATE t");
    struct version *v = version_pin(local_set(&l, "t")->current);
    struct dt_view *view = dt_view_begin(v->dt, true);
    size_t all = l.config.max_memory;
    local_limit(&l, budget_of(&l.server.budget, BUDGET_SETS) + 1);
    CHECK(strncmp(local_ask(&l, more), "ERR ", 4) == 0);
    CHECK_STR(local_ask(&l, "MOVE t 0 9 9"), "OK 0\n"); /* in place */
    local_limit(&l, all);
    version_end_view(&l.server.sets, v, view);
    version_unpin(&l.server.sets, v);
    CHECK(strncmp(local_ask(&l, more), "OK 0", 4) == 0);
    free(load);
    free(more);
    local_stop(&l);
}

/* With memory for the points alone, and for a copy alone. */
TEST(set_that_is_read_is_not_copied_beside_what_an_edit_takes)
{
    struct local l;
    char *load = parabola(50000), *more = parabola(10000);
    bool busy = false;
    local_start(&l, 0);
    local_ask(&l, load);
    local_ask(&l, "TRIANGULATE t");
    struct version *v = version_pin(local_set(&l, "t")->current);
    struct dt_view *view = dt_view_begin(v->dt, true);
    local_limit(&l, budget_of(&l.server.budget, BUDGET_SETS));
    for (int i = 0; i < 200 && !busy; i++) {
        local_limit(&l, l.config.max_memory + 256 * 1024);
        const char *reply = local_ask(&l, more);
        CHECK(strncmp(reply, "ERR ", 4) == 0);
        busy = strncmp(reply, "ERR BUSY the set is being read", 30) == 0;
    }
    CHECK(busy);
    version_end_view(&l.server.sets, v, view);
    CHECK(strncmp(local_ask(&l, more), "OK 0 first=50000 added=10000 ", 29) == 0); /* in place */
    version_unpin(&l.server.sets, v);
    free(load);
    free(more);
    local_stop(&l);
}

/* ---- memory runs out ---- */

/* The state of the server's sets that requests can see. */
static char *state(struct local *l)
{
    char *text = strdup(local_ask(l, "SETS\nPOINTS t\nCOINCIDENT t\n"));
    CHECK(text != NULL);
    return text;
}

/* Carries out `request` after `before`, failing the n-th allocation. False when there was no n-th
 * one. */
static bool survives(const char *before, const char *request, long n)
{
    struct local l;
    local_start(&l, 0);
    local_ask(&l, before);
    char *was = state(&l);
    size_t sets = l.server.sets.sets;
    local_ask(&l, ""); /* room for the reply, so that only the request's own allocations fail */
    test_fail_alloc(n);
    const char *reply = local_ask(&l, request);
    bool failed = test_alloc_failed();
    test_fail_alloc(0);
    bool refused = strncmp(reply, "ERR NOMEM", 9) == 0;
    CHECK_MSG(refused || strncmp(reply, "OK", 2) == 0 || l.closed, "%s, allocation %ld: %s",
              request, n, reply);
    char *is = state(&l);
    if (refused)
        CHECK_STR(is, was);
    CHECK(!refused || l.server.sets.sets == sets); /* not even one that nobody sees */
    CHECK_MSG(budget_used(&l.server.budget) == budget_of(&l.server.budget, BUDGET_SETS),
              "%s, allocation %ld: it keeps memory", request, n);
    if (refused && !l.closed) /* and the next request succeeds */
        CHECK_MSG(strncmp(local_ask(&l, request), "OK", 2) == 0, "%s, again after allocation %ld",
                  request, n);
    free(was);
    free(is);
    local_stop(&l);
    return failed;
}

TEST_TIMEOUT(requests_survive_every_failed_allocation, 60)
{
    static const struct {
        const char *before, *request;
    } steps[] = {
        {"", "CREATE t TOL 1"},
        {"", "ADD t 1 2 3 4"},
        {SQUARE, "ADD t 1 2 3 4 2 2 2 2"},
        {SQUARE "TRIANGULATE t", "ADD t 1 2 3 4 2 2 2 2"},
        {"", "LOAD t\n1 1\n2 2\n3 3\n.\n"},
        {SQUARE, "LOAD t 2\n1 1\n2 2\n"},
        {SQUARE, "DEL t 1 4"},
        {SQUARE "TRIANGULATE t", "DEL t 1 4"},
        {SQUARE, "MOVE t 1 7 7"},
        {SQUARE, "TRIANGULATE t"},
        {SQUARE "TRIANGULATE t", "TRIANGULATE t METHOD shelling"},
        {SQUARE "TRIANGULATE t", "TRIANGULATE t METHOD divide"},
        {SQUARE "TRIANGULATE t\nADD t 1 1", "LISTS t"},
        {SQUARE "TRIANGULATE t", "LISTS t"},
        {SQUARE "TRIANGULATE t", "LISTS t 0 4 2"},
        {SQUARE "TRIANGULATE t", "TRIANGLES t"},
        {SQUARE "TRIANGULATE t", "TRIANGLES t 4"},
        {SQUARE "TRIANGULATE t", "EDGES t 4"},
        {SQUARE "TRIANGULATE t", "HULL t"},
        {SQUARE "TRIANGULATE t", "CHECK t"},
        {SQUARE "TRIANGULATE t", "NEAREST t 1 1 4"},
        {SQUARE "TRIANGULATE t", "WITHIN t 0 0 9 9"},
        {SQUARE "TRIANGULATE t", "LOCATE t 1 1"},
        {SQUARE, "TRACE t"},
        {SQUARE, "GET t 1 2 3"},
        {SQUARE, "POINTS t"},
        {SQUARE, "SETS"},
        {SQUARE, "STAT t"},
        {SQUARE "FSET t z 1 2", "DIGEST t"},
    };
    for (size_t i = 0; i < sizeof steps / sizeof steps[0]; i++)
        for (long n = 1; survives(steps[i].before, steps[i].request, n); n++)
            CHECK(n < 1000);
}

TEST(long_replies_survive_every_failed_allocation)
{
    char *load = parabola(300);
    strcat(load, "TRIANGULATE t\n");
    long n = 1;
    for (; survives(load, "LISTS t", n); n++)
        CHECK(n < 1000);
    CHECK(n > 1);
    free(load);
}

TEST(copies_survive_every_failed_allocation)
{
    for (long n = 1;; n++) {
        struct local l;
        local_start(&l, 0);
        local_ask(&l, SQUARE "TRIANGULATE t");
        struct version *v = version_pin(local_set(&l, "t")->current);
        struct dt_view *view = dt_view_begin(v->dt, true);
        local_ask(&l, many_points("u")); /* room for the words */
        local_ask(&l, "");
        test_fail_alloc(n);
        const char *reply = local_ask(&l, many_points("t"));
        bool failed = test_alloc_failed();
        test_fail_alloc(0);
        bool added = strncmp(reply, "OK 0", 4) == 0;
        CHECK(added || (failed && strncmp(reply, "ERR NOMEM", 9) == 0));
        CHECK((local_set(&l, "t")->current != v) == added);
        CHECK(strncmp(local_ask(&l, "CHECK t"), "OK 0 delaunay=yes", 17) == 0);
        version_end_view(&l.server.sets, v, view);
        version_unpin(&l.server.sets, v);
        local_stop(&l);
        if (!failed)
            break;
    }
}
