/* renew_test.c - a worker makes the grid of a set anew; whoever queries it does not wait for that. */
#include "server/dataset.h"
#include "tests/server/local.h"
#include "tests/test.h"

#include <string.h>

enum { POINTS = 10500, PIECE = 500 };

static struct dataset *set_named(struct local *l, const char *name)
{
    return registry_find(&l->server.sets, &(struct word){name, strlen(name)});
}

/* Adds n points, each by a request of its own. */
static void add_points(struct local *l, unsigned n)
{
    static char text[PIECE * 64];
    size_t at = 0;
    for (unsigned i = 0; i < n; i++)
        at += (size_t)sprintf(text + at, "ADD t %.6f %.6f\n", test_uniform(), test_uniform());
    local_ask(l, text);
}

/* A large set whose grid a worker is making anew, or has made. */
static void start_renewal(struct local *l)
{
    local_start(l, 2);
    for (unsigned n = 0; n < POINTS; n += PIECE)
        add_points(l, PIECE);
    local_ask(l, "TRIANGULATE t\n");
    CHECK(set_named(l, "t")->writer == NULL);
    for (unsigned n = 0; set_named(l, "t")->writer == NULL; n++) {
        CHECK(n < 2 * POINTS);
        add_points(l, 1);
    }
}

TEST(queries_go_on_while_a_worker_makes_the_grid_anew)
{
    struct local l;
    start_renewal(&l);
    struct dataset *set = set_named(&l, "t");
    struct job *j = set->writer;
    CHECK(!set->exclusive && dt_is_aged(set->current->dt));
    for (int i = 0; i < 50; i++)
        CHECK(strncmp(local_ask(&l, "NEAREST t 0.5 0.5\nLOCATE t 0.1 0.1\n"), "OK 1\n", 5) == 0);
    CHECK(set->writer == j && dt_is_aged(set->current->dt));
    CHECK(strncmp(local_ask(&l, "ADD t 0.25 0.25\n"), "OK 0 first=", 11) == 0); /* it waits */
    CHECK(set->writer == NULL && !dt_is_aged(set->current->dt));
    CHECK(strncmp(local_ask(&l, "CHECK t\n"), "OK 0 delaunay=yes", 17) == 0);
    local_stop(&l);
}

TEST(grid_that_is_in_use_is_not_exchanged)
{
    struct local l;
    start_renewal(&l);
    struct version *v = version_pin(set_named(&l, "t")->current); /* as a worker's query does */
    CHECK(strncmp(local_ask(&l, "ADD t 0.25 0.25\n"), "OK 0 first=", 11) == 0);
    CHECK(dt_is_aged(v->dt) && set_named(&l, "t")->current != v);
    version_unpin(&l.server.sets, v);
    CHECK(strncmp(local_ask(&l, "DEL t 0\nCHECK t\n"), "OK 0 deleted=1\nOK 0 delaunay=yes", 32) ==
          0);
    CHECK(!dt_is_aged(set_named(&l, "t")->current->dt));
    local_stop(&l);
}

TEST(set_may_go_while_its_grid_is_made_anew)
{
    struct local l;
    start_renewal(&l);
    CHECK_STR(local_ask(&l, "DROP t\nSETS\n"), "OK 0\nOK 0\n");
    local_stop(&l);
    start_renewal(&l);
    local_stop(&l);
}
