/* digest.c - see digest.h. */
#include "server/sets/digest.h"

#include "core/delaunay_constraints.h"
#include "proto/records/hash.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

_Static_assert(sizeof(struct dt_row) == 2 * sizeof(uint32_t) + 2 * sizeof(double),
               "a row has no bytes but those of its values");

static uint64_t bits_of(double v)
{
    uint64_t bits;
    memcpy(&bits, &v, sizeof bits);
    return bits;
}

bool digest_begin(struct digest *d, const struct dataset *set)
{
    struct dt_summary sum;
    *d = (struct digest){.version = set->version, .view = dt_view_begin(set->current->dt, false)};
    if (d->view == NULL)
        return false;
    dt_view_summary(d->view, &sum);
    d->points = sum.points;
    d->next_id = dt_view_next_id(d->view);
    d->constraints = dt_constraints_count(set->current->dt);
    d->columns = 1 + sum.fields + (d->constraints > 0);
    const uint64_t facts[] = {d->next_id,
                              sum.points,
                              sum.triangulated || set->triangulated, /* it may be loading */
                              set->temporary,
                              bits_of(dt_tolerance(set->current->dt) + 0.0), /* -0 becomes 0 */
                              (uint64_t)set->expires_ms,
                              set->version};
    d->value = hash_bytes(0, facts, sizeof facts);
    return true;
}

/* A page whose last value was removed while a view read it stays for a while. */
static bool has_values(const double *page)
{
    for (uint32_t i = 0; i < DT_FIELD_PAGE; i++)
        if (!isnan(page[i]))
            return true;
    return false;
}

/* Reads pages of fields; false: all have been read. */
static bool read_pages(struct digest *d, const struct dt *dt)
{
    for (unsigned i = 0; i < DIGEST_PAGES; i++) {
        const double *page = d->field == NULL ? NULL : dt_field_page(d->field, d->view, &d->page);
        if (page == NULL) { /* the next field */
            d->field = dt_field_next(dt, d->view, d->field);
            if (d->field == NULL)
                return false;
            const char *name = dt_field_name(d->field);
            d->value = hash_bytes(d->value, name, strlen(name));
            d->page = 0;
            d->column++;
            continue;
        }
        if (has_values(page)) {
            d->value = hash_bytes(d->value, &d->page, sizeof d->page);
            d->value = hash_bytes(d->value, page, DT_FIELD_PAGE * sizeof *page);
        }
        d->page += DT_FIELD_PAGE;
    }
    return true;
}

/* Whether there are constraints, and they are next. */
static bool is_at_constraints(const struct digest *d)
{
    return d->constraints > 0 && d->column + 1 == d->columns;
}

/* All values have been read. */
static void begin_constraints(struct digest *d)
{
    d->column = d->columns - 1;
    if (d->constraints > 0)
        d->value = hash_bytes(d->value, &d->constraints, sizeof d->constraints);
}

/* Reads the next constraints; *done: all have been read. */
static enum dt_status read_constraints(struct digest *d, const struct dt *dt, bool *done)
{
    struct dt_constraint_list list = {.n = 0};
    enum dt_status status = dt_constraints_read(dt, d->view, &d->end, DIGEST_CONSTRAINTS, &list);
    for (size_t i = 0; i < list.n && status == DT_OK; i++) {
        const struct dt_constraint *c = &list.v[i];
        const uint32_t words[] = {c->a, c->b, c->number << 1 | c->border};
        d->value = hash_bytes(d->value, words, sizeof words);
    }
    free(list.v);
    *done = d->end == DT_NONE;
    return status;
}

enum dt_status digest_read(struct digest *d, const struct dt *dt, bool *done)
{
    struct dt_row row[DIGEST_ROWS];
    size_t n;
    *done = false;
    if (is_at_constraints(d))
        return read_constraints(d, dt, done);
    enum dt_status status = dt_view_rows(dt, d->view, &d->from, row, DIGEST_ROWS, &n);
    if (status != DT_OK)
        return status;
    if (n > 0) {
        d->value = hash_bytes(d->value, row, n * sizeof *row);
    } else if (!read_pages(d, dt)) {
        begin_constraints(d);
        *done = d->constraints == 0;
    }
    return DT_OK;
}

unsigned digest_progress(const struct digest *d)
{
    uint64_t at = is_at_constraints(d) ? d->end : d->column == 0 ? d->from : d->page;
    uint64_t ids = at < d->next_id ? at : d->next_id;
    uint64_t all = (uint64_t)d->columns * d->next_id;
    return all == 0 ? 0 : (unsigned)(100 * ((uint64_t)d->column * d->next_id + ids) / all);
}
