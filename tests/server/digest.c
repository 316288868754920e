/* digest.c - see digest.h. */
#include "tests/server/digest.h"

#include "proto/records/hash.h"
#include "server/sets/digest.h"
#include "tests/test.h"

uint64_t digest_now(const struct dataset *set)
{
    struct digest d;
    bool done = false;
    CHECK(digest_begin(&d, set));
    while (!done)
        CHECK(digest_read(&d, set->current->dt, &done) == DT_OK);
    dt_view_end(d.view);
    return d.value;
}

uint64_t digest_set(const struct dataset *set)
{
    struct dataset any = *set;
    any.version = 0;
    return digest_now(&any) | 1;
}

uint64_t digest_dt(struct dt *dt, bool triangulated)
{
    struct version v = {.dt = dt};
    struct dataset set = {.current = &v, .triangulated = triangulated};
    return digest_set(&set);
}

static void add(struct dataset *set, void *ctx)
{
    *(uint64_t *)ctx += hash_bytes(digest_set(set), set->name, set->name_len);
}

uint64_t digest_sets(const struct registry *sets)
{
    uint64_t sum = 0;
    registry_each(sets, add, &sum);
    return sum;
}
