/* digest.c - see digest.h. */
#include "server/sets/digest.h"

#include "core/delaunay_constraints.h"
#include "proto/records/digest.h"

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
    d->columns = 1 + sum.fields;
    const uint64_t facts[] = {d->next_id,
                              sum.points,
                              sum.triangulated || set->triangulated, /* it may be loading */
                              set->temporary,
                              bits_of(dt_tolerance(set->current->dt) + 0.0), /* -0 becomes 0 */
                              (uint64_t)set->expires_ms,
                              set->version};
    d->value = digest_bytes(0, facts, sizeof facts);
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

/* Reads pages of fields; false: there are no more. */
static bool read_pages(struct digest *d, const struct dt *dt)
{
    for (unsigned i = 0; i < DIGEST_PAGES; i++) {
        const double *page = d->field == NULL ? NULL : dt_field_page(d->field, d->view, &d->page);
        if (page == NULL) { /* the next field */
            d->field = dt_field_next(dt, d->view, d->field);
            if (d->field == NULL)
                return false;
            const char *name = dt_field_name(d->field);
            d->value = digest_bytes(d->value, name, strlen(name));
            d->page = 0;
            d->column++;
            continue;
        }
        if (has_values(page)) {
            d->value = digest_bytes(d->value, &d->page, sizeof d->page);
            d->value = digest_bytes(d->value, page, DT_FIELD_PAGE * sizeof *page);
        }
        d->page += DT_FIELD_PAGE;
    }
    return true;
}

static enum dt_status read_constraints(struct digest *d, const struct dt *dt)
{
    struct dt_constraint *v;
    size_t n;
    enum dt_status status = dt_constraints(dt, d->view, DT_NONE, &v, &n);
    if (status != DT_OK)
        return status;
    if (n > 0)
        d->value = digest_bytes(d->value, &n, sizeof n);
    for (size_t i = 0; i < n; i++) {
        const uint32_t words[] = {v[i].a, v[i].b, v[i].number << 1 | v[i].border};
        d->value = digest_bytes(d->value, words, sizeof words);
    }
    free(v);
    return DT_OK;
}

enum dt_status digest_read(struct digest *d, const struct dt *dt, bool *done)
{
    struct dt_row row[DIGEST_ROWS];
    size_t n;
    enum dt_status status = dt_view_rows(dt, d->view, &d->from, row, DIGEST_ROWS, &n);
    *done = false;
    if (status != DT_OK)
        return status;
    if (n > 0)
        d->value = digest_bytes(d->value, row, n * sizeof *row);
    else
        *done = !read_pages(d, dt);
    return *done ? read_constraints(d, dt) : DT_OK;
}

unsigned digest_progress(const struct digest *d)
{
    uint64_t ids = d->column == 0 ? d->from : d->page < d->next_id ? d->page : d->next_id;
    uint64_t all = (uint64_t)d->columns * d->next_id;
    return all == 0 ? 0 : (unsigned)(100 * ((uint64_t)d->column * d->next_id + ids) / all);
}
