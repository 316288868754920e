/* aliases_test.c - groups of aliases against a model that scans all of them. No edit of a large family scans the
 * whole family. */
#include "core/points/aliases.h"

#include <stdlib.h>

#include "core/set/set.h"
#include "tests/test.h"

enum { VERTICES = 12, IDS = 600, MOST_LOG = 20 };

/* By id: the vertex that represents it, DT_NONE if it is no alias, and its index. */
struct model {
    uint32_t vertex[IDS], index[IDS], count;
    uint32_t root[VERTICES]; /* by vertex, DT_NONE if it has no group */
};

/* Fails unless the heap at i is a leftist one; returns how many nodes it has. */
static uint32_t check_heap(const struct dt_aliases *a, uint32_t i, uint32_t parent)
{
    if (i == DT_NONE)
        return 0;
    const struct dt_alias *x = &a->alias[i];
    uint32_t left = x->left == DT_NONE ? 0 : a->alias[x->left].rank,
             right = x->right == DT_NONE ? 0 : a->alias[x->right].rank;
    CHECK(x->parent == parent && left >= right && x->rank == right + 1);
    CHECK(parent == DT_NONE || a->alias[parent].id < x->id);
    return 1 + check_heap(a, x->left, i) + check_heap(a, x->right, i);
}

static uint32_t lowest_but(const struct model *m, uint32_t vertex, const uint32_t *ids, size_t n)
{
    size_t k = 0;
    for (uint32_t id = 0; id < IDS; id++) {
        while (k < n && ids[k] < id)
            k++;
        if (m->vertex[id] == vertex && (k == n || ids[k] != id))
            return id;
    }
    return DT_NONE;
}

static void check_model(const struct dt_aliases *a, const struct model *m)
{
    uint32_t ids[IDS], n = 0, in_heaps = 0;
    for (uint32_t id = 0; id < IDS; id++) {
        if (test_below(2) == 0)
            ids[n++] = id;
        if (m->vertex[id] != DT_NONE)
            CHECK(dt_aliases_representative(a, m->index[id]) == m->vertex[id] &&
                  a->alias[m->index[id]].id == id);
    }
    CHECK(a->count == m->count);
    for (uint32_t v = 0; v < VERTICES; v++) {
        uint32_t root = m->root[v], want = lowest_but(m, v, NULL, 0);
        CHECK((root == DT_NONE) == (want == DT_NONE));
        if (root == DT_NONE)
            continue;
        CHECK(dt_aliases_root(a, root) == root && a->group[root].representative == v);
        in_heaps += check_heap(a, a->group[root].lowest, DT_NONE);
        CHECK(a->alias[dt_aliases_lowest_but(a, root, NULL, 0)].id == want);
        want = lowest_but(m, v, ids, n);
        uint32_t got = dt_aliases_lowest_but(a, root, ids, n);
        CHECK(want == DT_NONE ? got == DT_NONE : a->alias[got].id == want);
    }
    CHECK(in_heaps == m->count);
}

static void join(struct dt_aliases *a, struct model *m, uint32_t v, uint32_t id)
{
    CHECK(dt_aliases_reserve(a) == DT_OK);
    if (m->root[v] == DT_NONE)
        m->root[v] = dt_aliases_new_group(a, v);
    m->index[id] = dt_aliases_join(a, m->root[v], id, (struct dt_point){id, v});
    m->vertex[id] = v;
    m->count++;
}

static void leave(struct dt_aliases *a, struct model *m, uint32_t id)
{
    uint32_t v = m->vertex[id], over = dt_aliases_leave(a, m->index[id]);
    m->vertex[id] = DT_NONE;
    m->count--;
    bool last = lowest_but(m, v, NULL, 0) == DT_NONE;
    CHECK(over == (last ? v : DT_NONE));
    if (last)
        m->root[v] = DT_NONE;
}

static void unite(struct dt_aliases *a, struct model *m, uint32_t from, uint32_t into)
{
    m->root[into] = dt_aliases_unite(a, m->root[from], m->root[into]);
    m->root[from] = DT_NONE;
    for (uint32_t id = 0; id < IDS; id++)
        m->vertex[id] = m->vertex[id] == from ? into : m->vertex[id];
}

TEST(groups_of_aliases_equal_a_model_while_they_join_leave_and_unite)
{
    for (unsigned round = 0; round < 30; round++) {
        static struct model m;
        struct dt_aliases a;
        dt_aliases_init(&a, NULL);
        m.count = 0;
        for (uint32_t i = 0; i < IDS; i++)
            m.vertex[i] = DT_NONE;
        for (uint32_t v = 0; v < VERTICES; v++)
            m.root[v] = DT_NONE;
        for (unsigned i = 0; i < 3000; i++) {
            uint32_t id = test_below(IDS), v = test_below(VERTICES), w = test_below(VERTICES);
            if (m.vertex[id] != DT_NONE)
                leave(&a, &m, id);
            else if (i / 1000 % 2 == 0 || test_below(3) == 0)
                join(&a, &m, v, id);
            if (test_below(40) == 0 && v != w && m.root[v] != DT_NONE && m.root[w] != DT_NONE)
                unite(&a, &m, v, w);
            if (i % 16 == 0)
                check_model(&a, &m);
        }
        for (uint32_t id = 0; id < IDS; id++)
            if (m.vertex[id] != DT_NONE)
                leave(&a, &m, id);
        uint32_t free_groups = 0;
        for (uint32_t g = a.free_group; g != DT_NONE; g = a.group[g].up)
            free_groups++;
        CHECK(a.count == 0 && free_groups == a.groups);
        dt_aliases_clear(&a);
    }
}

/* ---- large families ---- */

/* A family that grows by one alias after the other, always united into the smaller one. */
TEST(no_alias_is_far_from_the_root_of_its_family_however_they_were_united)
{
    enum { FAMILIES = 1024, LOG = 10 };
    struct dt_aliases a;
    dt_aliases_init(&a, NULL);
    CHECK(dt_aliases_reserve(&a) == DT_OK);
    uint32_t root = dt_aliases_new_group(&a, 0),
             first = dt_aliases_join(&a, root, 0, (struct dt_point){0, 0});
    for (uint32_t v = 1; v < FAMILIES; v++) {
        CHECK(dt_aliases_reserve(&a) == DT_OK);
        uint32_t one = dt_aliases_new_group(&a, v);
        dt_aliases_join(&a, one, v, (struct dt_point){v, 0});
        root = dt_aliases_unite(&a, root, one);
    }
    for (uint32_t i = 0; i < FAMILIES; i++) {
        unsigned up = 0;
        for (uint32_t g = a.alias[i].group; g != root; g = a.group[g].up)
            CHECK(++up <= LOG);
    }
    CHECK(dt_aliases_root(&a, a.alias[first].group) == root);
    dt_aliases_clear(&a);
}

/* Counts the changes that an edit of the points reports. */
struct counter {
    struct dt_changes changes;
    unsigned calls;
};

static void count(void *ctx, uint32_t what)
{
    (void)what;
    ((struct counter *)ctx)->calls++;
}

static void count_changes(struct counter *c, struct dt_points *p)
{
    *c = (struct counter){{count, count, count, count, c}, 0};
    p->changes = p->aliases.changes = &c->changes;
}

static void add_at(struct dt *t, double x, uint32_t n)
{
    struct dt_point *q = malloc(n * sizeof *q);
    struct dt_added added;
    for (uint32_t i = 0; i < n; i++)
        q[i] = (struct dt_point){x, 0};
    CHECK(dt_add(t, q, n, &added) == DT_OK);
    free(q);
}

static void delete_one(struct dt_points *p, uint32_t id)
{
    CHECK(dt_points_delete_ready(p, &id, 1, NULL) == DT_OK);
    dt_points_delete(p, id);
}

/* The first of b, then a's representative goes, whose heir stands where b's is: b's family and a's
 * become one. */
TEST(a_delete_that_unites_two_large_families_changes_neither_alias_by_alias)
{
    enum { LARGE = 200000 };
    struct counter c;
    struct dt *t = dt_new(1);
    struct dt_points *p = &t->points;
    add_at(t, 1.85, 1);
    add_at(t, 0.9, LARGE);
    add_at(t, 0, 1);
    add_at(t, 0.9, LARGE);
    delete_one(p, 0);
    CHECK(dt_points_vertices(p) == 2 && !dt_points_is_alias(p, 1));
    CHECK(dt_points_vertex(p, LARGE) != dt_points_vertex(p, LARGE + 2));
    count_changes(&c, p);
    delete_one(p, LARGE + 1);
    CHECK_MSG(c.calls < 10, "%u changes", c.calls);
    CHECK(dt_points_vertices(p) == 1 && p->aliases.count == 2 * LARGE - 1);
    CHECK(dt_points_vertex(p, LARGE) == dt_points_vertex(p, 1) &&
          dt_points_vertex(p, 2 * LARGE + 1) == dt_points_vertex(p, 1));
    CHECK(dt_points_heir(p, dt_points_vertex(p, 1), NULL, 0)->id == 2);
    dt_free(t);
}

/* Edits that scan the whole family would take minutes, more than the time limit of a test. */
TEST(edits_of_a_large_family_do_not_look_at_all_of_it)
{
    enum { LARGE = 200000, EDITS = 100000 };
    for (unsigned tolerant = 0; tolerant < 2; tolerant++) {
        uint32_t most = 0;
        struct dt *t = dt_new(tolerant ? 0.5 : 0);
        struct dt_points *p = &t->points;
        add_at(t, 0, LARGE);
        add_at(t, 7, EDITS);
        for (uint32_t i = 0; i < EDITS; i++) {
            uint32_t arriving = LARGE + (i * 7919u) % EDITS; /* in no order */
            CHECK(dt_move(t, arriving, (struct dt_point){0, 0}) == DT_OK);
            delete_one(p, i); /* the representative */
            uint32_t v = dt_points_vertex(p, i + 1);
            CHECK(p->id[v] == i + 1);
            uint32_t rank = dt_points_heir(p, v, NULL, 0)->rank;
            most = rank > most ? rank : most;
        }
        CHECK_MSG(most <= MOST_LOG, "a right spine of %u", most);
        CHECK(dt_points_live(p) == LARGE);
        dt_free(t);
    }
}

/* ---- representatives that go with their heirs ---- */

/* Four points, each within 1 of the next. x is an alias of c, and represents when c goes; then a, an alias
 * of r, lies where x does.
 *
 *      b <--0.9--> r <--0.9--> a, x <--0.95--> c
 */
static struct dt *heir_at_another_representative(bool live)
{
    const struct dt_point p[] = {{1.85, 0}, {0.9, 0}, {0, 0}, {0.9, 0}, {-0.9, 0}};
    struct dt *t = dt_new(1);
    struct dt_added added;
    uint32_t c = 0, deleted, missing;
    CHECK(dt_add(t, p, 5, &added) == DT_OK && added.coincident == 3);
    CHECK(!live || dt_triangulate(t, NULL) == DT_OK);
    CHECK(dt_delete(t, &c, 1, &deleted, &missing) == DT_OK);
    return t;
}

TEST(a_representative_deleted_with_its_successor_does_not_join_the_successors_neighbour)
{
    for (unsigned live = 0; live < 2; live++) {
        struct dt *t = heir_at_another_representative(live == 1);
        uint32_t r_and_a[] = {2, 3}, deleted, missing, rep;
        CHECK(dt_representative(t, 3, &rep) == DT_OK && rep == 2);
        CHECK(dt_delete(t, r_and_a, 2, &deleted, &missing) == DT_OK && deleted == 2);
        CHECK(dt_representative(t, 4, &rep) == DT_OK && rep == 4);
        CHECK(dt_refresh(t, NULL) == DT_OK);
        CHECK(!t->triangulated || dt_check(t, NULL, NULL) == DT_OK);
        dt_free(t);

        t = heir_at_another_representative(live == 1);
        CHECK(dt_delete(t, r_and_a, 1, &deleted, &missing) == DT_OK);
        CHECK(dt_representative(t, 4, &rep) == DT_OK && rep == 1); /* its heir has joined x */
        dt_free(t);
    }
}
