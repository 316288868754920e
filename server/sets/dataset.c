/* dataset.c - see dataset.h. */
#include "server/sets/dataset.h"

#include "server/system/random.h"

#include <assert.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { FIRST_BUCKETS = 64 };

/* ---- versions ---- */

struct version *version_new(struct registry *r, struct dt *dt)
{
    struct version *v = malloc(sizeof *v);
    if (v == NULL)
        return NULL;
    *v = (struct version){.dt = dt, .refs = 1};
    gate_init(&v->gate, &r->lanes);
    return v;
}

struct version *version_pin(struct version *v)
{
    v->refs++;
    return v;
}

void version_unpin(struct registry *r, struct version *v)
{
    if (--v->refs > 0)
        return;
    list_remove(&v->untidy);
    reservation_set(&v->memory, 0);
    r->discard(r->discard_ctx, v->dt);
    free(v);
}

bool version_update(struct registry *r, struct version *v)
{
    size_t before = v->sum.memory;
    dt_summary(v->dt, &v->sum);
    if (v->memory.budget != r->budget) { /* of another registry, or none yet */
        reservation_set(&v->memory, 0);
        v->memory = (struct reservation){.budget = r->budget, .kind = BUDGET_SETS};
    }
    reservation_set(&v->memory, v->sum.memory);
    return v->sum.memory != before;
}

/* Frees some of the saved images. True: nothing is left. */
static bool tidy(struct registry *r, struct version *v)
{
    if (!gate_try_close(&v->gate))
        return false;
    bool more = dt_view_tidy(v->dt);
    version_update(r, v);
    gate_open(&v->gate);
    return !more;
}

void version_end_view(struct registry *r, struct version *v, struct dt_view *view)
{
    if (view == NULL)
        return;
    dt_view_end(view);
    if (!list_holds(&v->untidy) && !tidy(r, v))
        list_append(&r->untidy, &v->untidy);
}

void registry_tidy(struct registry *r)
{
    enum { MOST = 10 }; /* versions that are tidied in one call */
    int calls = 0;
    for (struct version *v = list_first(&r->untidy), *next; v != NULL && calls < MOST;
         v = next, calls++) {
        next = list_next(&r->untidy, v);
        if (tidy(r, v))
            list_remove(&v->untidy);
    }
}

bool version_is_stale(const struct version *v)
{
    return v->sum.triangulated && !v->sum.current;
}

/* ---- waiting ---- */

bool dataset_admits(const struct dataset *set, bool writes, const struct request_queue *turn)
{
    if (!writes)
        return !set->exclusive;
    return set->writer == NULL && queue_is_first(&set->queue, turn);
}

static bool admits_waiter(const struct request_queue *q, const struct waiter *w)
{
    const struct dataset *set =
        (const struct dataset *)((const char *)q - offsetof(struct dataset, queue));
    return !set->exclusive && (!w->writes || set->writer == NULL);
}

/* ---- the registry ---- */

static void discard_now(void *ctx, struct dt *dt)
{
    dt_free(dt);
}

void registry_init(struct registry *r)
{
    *r = (struct registry){.discard = discard_now};
}

static size_t hash(const char *name, size_t len) /* FNV-1a */
{
    uint64_t h = 0xcbf29ce484222325u;
    for (size_t i = 0; i < len; i++)
        h = (h ^ (unsigned char)name[i]) * 0x100000001b3u;
    return (size_t)(h ^ h >> 32);
}

static struct dataset **bucket_of(const struct registry *r, const char *name, size_t len)
{
    return &r->bucket[hash(name, len) & (r->buckets - 1)];
}

struct dataset *registry_find(const struct registry *r, const struct word *name)
{
    if (r->buckets == 0)
        return NULL;
    for (struct dataset *set = *bucket_of(r, name->text, name->len); set != NULL; set = set->next)
        if (set->name_len == name->len && memcmp(set->name, name->text, name->len) == 0)
            return set;
    return NULL;
}

static void enter_bucket(struct registry *r, struct dataset *set)
{
    struct dataset **bucket = bucket_of(r, set->name, set->name_len);
    set->next = *bucket;
    *bucket = set;
}

static bool rehash(struct registry *r)
{
    struct dataset **before = r->bucket;
    size_t n = r->buckets, more = n == 0 ? FIRST_BUCKETS : 2 * n;
    struct dataset **bucket = calloc(more, sizeof bucket[0]);
    if (bucket == NULL)
        return false;
    r->bucket = bucket;
    r->buckets = more;
    for (size_t i = 0; i < n; i++) {
        for (struct dataset *set = before[i], *next; set != NULL; set = next) {
            next = set->next;
            enter_bucket(r, set);
        }
    }
    free(before);
    return true;
}

/* A reactor that shares the world has no business here. */
static void check_alone(const struct registry *r)
{
    assert(r->world == NULL || gate_is_closed(r->world));
}

struct dataset *registry_create(struct registry *r, const struct word *name, double tolerance)
{
    check_alone(r);
    if (r->sets >= r->buckets && !rehash(r))
        return NULL;
    struct dataset *set = calloc(1, sizeof *set);
    struct dt *dt = dt_new_in(tolerance, r->pages);
    struct version *v = dt != NULL ? version_new(r, dt) : NULL;
    if (set == NULL || v == NULL) {
        free(set);
        free(v);
        dt_free(dt);
        return NULL;
    }
    set->current = v;
    set->queue.admits = admits_waiter;
    set->name_len = name->len;
    memcpy(set->name, name->text, name->len);
    enter_bucket(r, set);
    r->sets++;
    version_update(r, v);
    return set;
}

/* ---- sets that are dropped at some time ---- */

void registry_expire(struct registry *r, struct dataset *set, int64_t at_ms)
{
    r->expiring -= set->expires_ms != 0;
    r->expiring += at_ms != 0;
    set->expires_ms = at_ms;
    list_remove(&set->expiring);
    if (at_ms != 0)
        list_append(&r->expiring_sets, &set->expiring);
}

struct dataset *registry_next_expiring(struct registry *r)
{
    struct dataset *set = list_pop(&r->expiring_sets);
    if (set != NULL)
        list_append(&r->expiring_sets, &set->expiring);
    return set;
}

/* ---- the end of a set ---- */

static void forget_copies(struct registry *r, struct dataset *set)
{
    if (set->skip_copies != NULL)
        r->forget(r, set);
}

static void free_set(struct registry *r, struct dataset *set)
{
    r->sets--;
    forget_copies(r, set);
    registry_expire(r, set, 0);
    list_remove(&set->fellow);
    version_unpin(r, set->current);
    free(set);
}

void registry_drop(struct registry *r, struct dataset *set)
{
    check_alone(r);
    if (set->watched != NULL && r->dropped != NULL)
        r->dropped(set);
    struct dataset **at = bucket_of(r, set->name, set->name_len);
    while (*at != set)
        at = &(*at)->next;
    *at = set->next;
    queue_wake_all(&set->queue);
    free_set(r, set);
}

void registry_set_version(struct registry *r, struct dataset *set, uint64_t version)
{
    set->version = version;
    if (set->watched != NULL && r->changed != NULL)
        r->changed(set);
}

/* ---- sets that are replaced by those of another registry ---- */

/* The set of the same name. */
static struct dataset *counterpart(const struct registry *r, const struct dataset *of)
{
    struct word name = {.text = of->name, .len = of->name_len};
    return registry_find(r, &name);
}

/* Whether the set continues, with the contents of `by`. A new state that has the version of the old one would not be noticed. */
static bool goes_on(const struct dataset *set, const struct dataset *by, bool same)
{
    if (by == NULL || set->temporary)
        return by == NULL && set->temporary;
    return same || set->version != by->version;
}

static void drop_others(struct registry *r, const struct registry *from, bool same)
{
    for (size_t i = 0; i < r->buckets; i++) {
        for (struct dataset *set = r->bucket[i], *next; set != NULL; set = next) {
            next = set->next;
            if (!goes_on(set, counterpart(from, set), same))
                registry_drop(r, set);
        }
    }
}

/* The contents of `by`, which is freed, become the contents of the set. */
static void replace_contents(struct registry *r, struct dataset *set, struct dataset *by, bool same)
{
    uint64_t lsn = by->current->lsn;
    if (same && set->version == by->version && set->triangulated == by->triangulated) {
        version_unpin(r, by->current);
    } else {
        forget_copies(r, set);
        dataset_publish(r, set, by->current);
        set->current->lsn = lsn;
    }
    registry_set_version(r, set, by->version);
    set->triangulated = by->triangulated;
    queue_wake_all(&set->queue);
    free(by);
}

/* Moves a set from its registry, whose buckets are not used any more. */
static void move_set(struct registry *r, struct dataset *set, struct registry *from, bool same)
{
    struct dataset *old = counterpart(r, set);
    int64_t expires_ms = set->expires_ms;
    registry_expire(from, set, 0);
    version_update(r, set->current);
    gate_init(&set->current->gate, &r->lanes);
    if (old != NULL) {
        replace_contents(r, old, set, same);
        registry_expire(r, old, expires_ms);
        return;
    }
    enter_bucket(r, set);
    r->sets++;
    registry_expire(r, set, expires_ms);
}

bool registry_replace(struct registry *r, struct registry *from, bool same)
{
    while (r->buckets < r->sets + from->sets)
        if (!rehash(r))
            return false;
    drop_others(r, from, same);
    for (size_t i = 0; i < from->buckets; i++) {
        for (struct dataset *set = from->bucket[i], *next; set != NULL; set = next) {
            next = set->next;
            move_set(r, set, from, same);
        }
    }
    free(from->bucket);
    r->life = from->life;
    r->unlogged = from->unlogged > r->unlogged ? from->unlogged : r->unlogged;
    *from = (struct registry){0};
    return true;
}

/* ---- versions that clients see ----
 *
 * The number of a life counts seconds, or starts if these are more, so it fits into 32 bits until 2106. A life can have
 * 2^20 changes a second before its versions reach those of the next one. The lowest bit keeps logged changes apart from
 * others: the lsn makes the former the same after a restart. */

enum { LIFE_SHIFT = 21 };

/* The numbers of lives in memory. They are larger than the seconds until 2038, and 2^20 smaller than 2^32, so that 2^40
 * changes fit below 2^53. */
#define FIRST_IN_MEMORY (UINT32_C(1) << 31)
#define LIVES_IN_MEMORY ((UINT32_C(1) << 31) - (UINT32_C(1) << 20))

uint64_t registry_version(struct registry *r, uint64_t lsn)
{
    uint64_t base = (uint64_t)r->life << LIFE_SHIFT;
    return base + (lsn != 0 ? 2 * lsn : 2 * ++r->unlogged + 1);
}

static void note_life(struct dataset *set, void *ctx)
{
    uint32_t *last = ctx;
    uint32_t life = (uint32_t)(set->version >> LIFE_SHIFT);
    *last = life > *last ? life : *last;
}

static void give_version(struct dataset *set, void *ctx)
{
    if (set->version == 0)
        set->version = registry_version(ctx, 0);
}

void registry_begin_life(struct registry *r, uint32_t last)
{
    struct timespec now;
    clock_gettime(CLOCK_REALTIME, &now);
    registry_each(r, note_life, &last);
    r->life = now.tv_sec > last ? (uint32_t)now.tv_sec : last + 1;
    r->unlogged = (uint64_t)now.tv_nsec / 1000;
    registry_each(r, give_version, r);
}

void registry_begin_life_in_memory(struct registry *r)
{
    r->life = FIRST_IN_MEMORY + (uint32_t)(random_bits() % LIVES_IN_MEMORY);
    r->unlogged = 0;
}

void registry_clear(struct registry *r)
{
    for (size_t i = 0; i < r->buckets; i++) {
        for (struct dataset *set = r->bucket[i], *next; set != NULL; set = next) {
            next = set->next;
            free_set(r, set);
        }
    }
    free(r->bucket);
    r->bucket = NULL;
    r->buckets = 0;
}

void registry_each(const struct registry *r, void (*visit)(struct dataset *set, void *ctx),
                   void *ctx)
{
    for (size_t i = 0; i < r->buckets; i++)
        for (struct dataset *set = r->bucket[i]; set != NULL; set = set->next)
            if (set->born)
                visit(set, ctx);
}

/* The cursor is incremented from its highest bit down. So when the number of buckets doubles, both halves of
 * a visited bucket are behind the cursor. [Redis, dictScan] */
size_t registry_scan(const struct registry *r, size_t cursor,
                     void (*visit)(struct dataset *set, void *ctx), void *ctx)
{
    if (r->buckets == 0)
        return 0;
    cursor &= r->buckets - 1; /* a client may have chosen it */
    for (struct dataset *set = r->bucket[cursor]; set != NULL; set = set->next)
        if (set->born)
            visit(set, ctx);
    size_t bit = r->buckets >> 1;
    for (; (cursor & bit) != 0; bit >>= 1)
        cursor ^= bit;
    return cursor | bit;
}

void dataset_publish(struct registry *r, struct dataset *set, struct version *v)
{
    check_alone(r);
    v->lsn = set->current->lsn;
    version_unpin(r, set->current);
    set->current = v;
}
