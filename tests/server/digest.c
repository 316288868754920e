/* digest.c - see digest.h. */
#include "tests/server/digest.h"

#include "core/delaunay_fields.h"
#include "tests/test.h"

#include <string.h>

uint64_t digest_mix(uint64_t h, const void *bytes, size_t n)
{
    const unsigned char *p = bytes;
    for (; n > 0; n--)
        h = (h ^ *p++) * 0x100000001b3u;
    return h;
}

uint64_t digest_dt(const struct dt *dt, bool triangulated)
{
    uint32_t next = dt_next_id(dt), rep;
    double tol = dt_tolerance(dt);
    uint64_t h = digest_mix(digest_mix(digest_mix(1, &next, sizeof next), &tol, sizeof tol),
                            &triangulated, 1);
    for (uint32_t id = 0; id < next; id++) {
        struct dt_point p;
        if (dt_get(dt, id, &p) != DT_OK)
            continue;
        CHECK(dt_representative(dt, id, &rep) == DT_OK);
        h = digest_mix(digest_mix(digest_mix(h, &id, sizeof id), &rep, sizeof rep), &p, sizeof p);
    }
    for (const struct dt_field *f = dt_field_next(dt, NULL, NULL); f != NULL;
         f = dt_field_next(dt, NULL, f)) {
        const double *page;
        h = digest_mix(h, dt_field_name(f), strlen(dt_field_name(f)) + 1);
        for (uint64_t from = 0; (page = dt_field_page(f, NULL, &from)) != NULL;
             from += DT_FIELD_PAGE)
            h = digest_mix(digest_mix(h, &from, sizeof from), page, DT_FIELD_PAGE * sizeof *page);
    }
    return h | 1;
}

uint64_t digest_set(const struct dataset *set)
{
    uint64_t h = digest_dt(set->current->dt, set->triangulated);
    return set->expires_ms == 0 ? h : digest_mix(h, &set->expires_ms, sizeof set->expires_ms) | 1;
}

static void add(struct dataset *set, void *ctx)
{
    *(uint64_t *)ctx += digest_mix(digest_set(set), set->name, set->name_len);
}

uint64_t digest_sets(const struct registry *sets)
{
    uint64_t sum = 0;
    registry_each(sets, add, &sum);
    return sum;
}
