/* digest.c - see digest.h. */
#include "tests/server/digest.h"

#include "tests/test.h"

static uint64_t mix(uint64_t h, const void *bytes, size_t n)
{
    const unsigned char *p = bytes;
    for (; n > 0; n--)
        h = (h ^ *p++) * 0x100000001b3u;
    return h;
}

uint64_t digest_set(const struct dataset *set)
{
    const struct dt *dt = set->current->dt;
    uint32_t next = dt_next_id(dt), rep;
    double tol = dt_tolerance(dt);
    uint64_t h = mix(mix(mix(1, &next, sizeof next), &tol, sizeof tol), &set->triangulated, 1);
    for (uint32_t id = 0; id < next; id++) {
        struct dt_point p;
        if (dt_get(dt, id, &p) != DT_OK)
            continue;
        CHECK(dt_representative(dt, id, &rep) == DT_OK);
        h = mix(mix(mix(h, &id, sizeof id), &rep, sizeof rep), &p, sizeof p);
    }
    return h | 1;
}

static void add(struct dataset *set, void *ctx)
{
    *(uint64_t *)ctx += mix(digest_set(set), set->name, set->name_len);
}

uint64_t digest_sets(const struct registry *sets)
{
    uint64_t sum = 0;
    registry_each(sets, add, &sum);
    return sum;
}
