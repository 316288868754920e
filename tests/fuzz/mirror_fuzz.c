/* mirror_fuzz.c - rows of events for the copy that a mirror keeps. The first byte is the number of fields, then lines follow:
 * rows, `reset`, and an empty line for the end of an event. For any rings, the copy's counts must fit its content, and a
 * change must name points that were, or were not, in the copy. */
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include "clients/lib/mirror_copy.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void check(bool ok)
{
    if (!ok)
        abort();
}

static size_t points_of(const struct copy *c)
{
    size_t n = 0;
    for (uint32_t id = 0; id < c->ids; id++)
        n += copy_place(c, id) != NULL;
    return n;
}

static size_t words_of(const struct copy *c)
{
    size_t n = 0;
    for (uint32_t id = 0; id < c->ids; id++) {
        const struct copy_place *p = &c->place[id];
        check(!p->ringed || p->ring + p->len <= c->rings.n);
        n += p->ringed ? p->len : 0;
    }
    return n;
}

static void commit(struct copy *c)
{
    struct delaunay_change change;
    size_t before = c->points, constraints = c->constraints.rows.n;
    check(copy_commit(c, &change) == DELAUNAY_OK);
    check(c->points == before + change.n_added - change.n_gone && c->points == points_of(c));
    check(c->ringed_words == words_of(c) && c->ringed_words <= c->rings.n);
    for (size_t i = 0; i < change.n_added; i++)
        check(copy_place(c, change.added[i]) != NULL);
    for (size_t i = 0; i < change.n_gone; i++)
        check(copy_place(c, change.gone[i]) == NULL);
    check(c->constraints.rows.n + change.n_constraints_released <=
          constraints + change.n_constraints_added);
    constraints_sort(&c->constraints);
    for (size_t i = 1; i < c->constraints.rows.n; i++) /* each once */
        check(memcmp(&c->constraints.rows.at[i - 1], &c->constraints.rows.at[i],
                     offsetof(struct delaunay_segment, places)) != 0);
}

/* Large ids would need memory for all smaller ones. */
static bool has_large_number(const char *line, size_t len)
{
    size_t digits = 0;
    for (size_t i = 0; i < len; i++) {
        digits = line[i] >= '0' && line[i] <= '9' ? digits + 1 : 0;
        if (digits > 5)
            return true;
    }
    return false;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    if (size == 0)
        return 0;
    struct copy c = {.fields = data[0] % 4};
    const char *at = (const char *)data + 1, *end = (const char *)data + size;
    while (at < end) {
        const char *lf = memchr(at, '\n', (size_t)(end - at));
        size_t len = (size_t)((lf != NULL ? lf : end) - at);
        if (len == 0)
            commit(&c);
        else if (len == 5 && memcmp(at, "reset", 5) == 0)
            copy_reset(&c);
        else if (!has_large_number(at, len) && copy_row(&c, at, len) != DELAUNAY_OK)
            break;
        at += len + 1;
    }
    copy_free(&c);
    return 0;
}
