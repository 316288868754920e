/* assembly_test.c - which changes the records of a LOAD are. */
#include "server/changes/assembly.h"

#include "tests/test.h"

static struct record about(enum record_type type, uint32_t first, uint32_t n, const void *items)
{
    struct record r = {.type = type, .first = first, .n = n, .items = items};
    if (type == RECORD_LOAD || type == RECORD_LOADED) {
        r.name = "t";
        r.name_len = 1;
    }
    if (type == RECORD_VALUES) {
        r.field = "z";
        r.field_len = 1;
    }
    return r;
}

/* Returns what the last of these records completes. */
static enum assembled join(struct assembly *s, const struct record *r, size_t n, struct change *c)
{
    for (size_t i = 0; i + 1 < n; i++)
        CHECK(assembly_take(s, &r[i], c) == ASSEMBLY_MORE);
    return assembly_take(s, &r[n - 1], c);
}

TEST(load_without_points_sets_a_run_of_values)
{
    static const double v[] = {1, 2, 3};
    const struct record r[] = {about(RECORD_LOAD, 9, 0, NULL), about(RECORD_VALUES, 4, 2, v),
                               about(RECORD_VALUES, 6, 1, v + 2), about(RECORD_LOADED, 0, 0, NULL)};
    struct assembly s = {0};
    struct change c;
    CHECK(join(&s, r, 4, &c) == ASSEMBLY_DONE);
    CHECK(c.kind == &change_kinds[CHANGE_RUN]);
    CHECK(c.n == 3 && c.columns->first == 4 && c.columns->n == 3 && c.columns->v[2] == 3);
    change_clear(&c);
}
