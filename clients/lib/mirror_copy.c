/* mirror_copy.c - the changes of an event are found before it is applied: old rings are in the copy, new ones in the event.
 *
 * A triangle that comes or goes changes the rings of its three corners, so the rings of the ids that an event names are enough.
 * Each triangle of these rings is examined once, from the smallest of its corners that the event names. It is searched in the
 * other state, in the shortest ring of its corners. Few triangles have long rings at all corners, so the cost is linear even
 * if one point is joined to all others [Chiba and Nishizeki, "Arboricity and subgraph listing algorithms", 1985]. */
#include "clients/lib/mirror_copy.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "clients/lib/array.h"
#include "clients/lib/words.h"

#define MANY_WORDS 65536 /* of an event: more are not kept for the next one */

/* ---- growing arrays ---- */

static bool words_room(struct copy_words *w, size_t n)
{
    return array_reserve((void **)&w->at, &w->cap, w->n + n, sizeof *w->at);
}

static bool words_add(struct copy_words *w, uint32_t word)
{
    if (!words_room(w, 1))
        return false;
    w->at[w->n++] = word;
    return true;
}

static bool resize(void **array, size_t n, size_t size)
{
    void *larger = n * size > 0 && n < SIZE_MAX / size ? realloc(*array, n * size) : NULL;
    if (larger != NULL)
        *array = larger;
    return larger != NULL;
}

/* Makes room for the id in the arrays by id. */
static bool ids_room(struct copy *c, uint32_t id)
{
    uint64_t want = id < 512 ? 1024 : 2 * (uint64_t)id;
    if (id >= c->room) {
        want = want < UINT32_MAX ? want : UINT32_MAX;
        if (!resize((void **)&c->place, want, sizeof *c->place) ||
            !resize((void **)&c->slot, want, sizeof *c->slot) ||
            (c->fields > 0 && !resize((void **)&c->value, want, c->fields * sizeof *c->value)))
            return false;
        c->room = (uint32_t)want;
    }
    for (; c->ids <= id; c->ids++) {
        c->place[c->ids] = (struct copy_place){0};
        c->slot[c->ids] = 0;
    }
    return true;
}

void copy_free(struct copy *c)
{
    struct copy_words *words[] = {
        &c->rings,           &c->event_rings,      &c->added, &c->moved, &c->gone,
        &c->triangles_added, &c->triangles_removed};
    for (size_t i = 0; i < sizeof words / sizeof words[0]; i++)
        free(words[i]->at);
    free(c->place);
    free(c->value);
    free(c->slot);
    free(c->entry);
    free(c->event_value);
    constraints_free(&c->constraints);
}

/* ---- gathering ---- */

void copy_forget(struct copy *c)
{
    for (size_t i = 0; i < c->entries; i++)
        c->slot[c->entry[i].id] = 0;
    c->entries = c->event_rings.n = c->event_values = 0;
    constraints_forget(&c->constraints);
    c->reset = false;
    if (c->event_rings.cap <= MANY_WORDS && c->entry_room <= MANY_WORDS)
        return;
    free(c->event_rings.at);
    free(c->entry);
    free(c->event_value);
    c->event_rings = (struct copy_words){0};
    c->entry = NULL;
    c->event_value = NULL;
    c->entry_room = c->event_value_room = 0;
}

void copy_reset(struct copy *c)
{
    copy_forget(c);
    c->reset = true;
}

/* The entry of an id, a new one if need be; NULL when out of memory. */
static struct copy_entry *entry_of(struct copy *c, uint32_t id)
{
    if (!ids_room(c, id))
        return NULL;
    if (c->slot[id] == 0) {
        if (c->entries == UINT32_MAX - 1 ||
            !array_reserve((void **)&c->entry, &c->entry_room, c->entries + 1, sizeof *c->entry))
            return NULL;
        c->entry[c->entries++] = (struct copy_entry){.id = id};
        c->slot[id] = (uint32_t)c->entries;
    }
    return &c->entry[c->slot[id] - 1];
}

static bool next_id(struct words *r, uint32_t *id)
{
    return words_next_u32(r, id) && *id < UINT32_MAX;
}

/* A number, or nan. */
static bool next_value(struct words *r, double *v)
{
    struct words before = *r;
    const char *word;
    if (words_next_double(r, v))
        return true;
    *r = before;
    *v = (double)NAN;
    return words_next(r, &word) == 3 && memcmp(word, "nan", 3) == 0;
}

static enum delaunay_result point_row(struct copy *c, struct copy_entry *e, struct words *r)
{
    if (!array_reserve((void **)&c->event_value, &c->event_value_room, c->event_values + c->fields,
                       sizeof *c->event_value))
        return DELAUNAY_NOMEM;
    bool ok = next_value(r, &e->x) && next_value(r, &e->y);
    for (unsigned k = 0; k < c->fields && ok; k++)
        ok = next_value(r, &c->event_value[c->event_values + k]);
    e->value = c->event_values;
    c->event_values += c->fields;
    e->point = true;
    e->gone = e->ringed = false;
    return ok && r->s >= r->end ? DELAUNAY_OK : DELAUNAY_BROKEN;
}

static enum delaunay_result list_row(struct copy *c, struct copy_entry *e, struct words *r)
{
    const char *kind;
    uint32_t id;
    if (words_next(r, &kind) != 1 || (*kind != 'i' && *kind != 'b'))
        return DELAUNAY_BROKEN;
    e->ring = c->event_rings.n;
    while (r->s < r->end) {
        if (!next_id(r, &id))
            return DELAUNAY_BROKEN;
        if (!words_add(&c->event_rings, id))
            return DELAUNAY_NOMEM;
    }
    e->len = (uint32_t)(c->event_rings.n - e->ring);
    e->inner = *kind == 'i';
    e->ringed = e->len > 0; /* the only point of a set has no neighbours */
    return DELAUNAY_OK;
}

/* `b line k` or `b border k`, and perhaps the places of both ends. */
static enum delaunay_result constraint_row(struct copy *c, uint32_t a, bool declared,
                                           struct words *r)
{
    const char *kind;
    size_t n = 0;
    struct delaunay_segment what = {.a = a};
    if (!next_id(r, &what.b) || (n = words_next(r, &kind)) == 0 || !next_id(r, &what.number))
        return DELAUNAY_BROKEN;
    what.border = n == 6 && memcmp(kind, "border", 6) == 0;
    bool good = what.border || (n == 4 && memcmp(kind, "line", 4) == 0);
    for (int i = 0; i < 4 && good && declared && (i > 0 || r->s < r->end); i++)
        good = next_value(r, &what.places[i]);
    if (!good || r->s < r->end)
        return DELAUNAY_BROKEN;
    return constraints_gather(&c->constraints, &what, declared) ? DELAUNAY_OK : DELAUNAY_NOMEM;
}

enum delaunay_result copy_row(struct copy *c, const char *text, size_t len)
{
    struct words r = {text, text + len};
    const char *kind;
    size_t n = words_next(&r, &kind);
    uint32_t id;
    if (!next_id(&r, &id))
        return DELAUNAY_BROKEN;
    if (n == 10 && memcmp(kind, "constraint", 10) == 0)
        return constraint_row(c, id, true, &r);
    if (n == 8 && memcmp(kind, "released", 8) == 0)
        return constraint_row(c, id, false, &r);
    struct copy_entry *e = entry_of(c, id);
    if (e == NULL)
        return DELAUNAY_NOMEM;
    if (n == 5 && memcmp(kind, "point", 5) == 0)
        return point_row(c, e, &r);
    if (n == 4 && memcmp(kind, "list", 4) == 0)
        return list_row(c, e, &r);
    if (n != 4 || memcmp(kind, "gone", 4) != 0 || r.s < r.end)
        return DELAUNAY_BROKEN;
    e->point = e->ringed = false;
    e->gone = true;
    return DELAUNAY_OK;
}

/* ---- rings before and after ---- */

struct ring {
    const uint32_t *at; /* NULL: there is none, or it is unknown */
    uint32_t len;
    bool inner;
};

static struct ring old_ring(const struct copy *c, uint32_t id)
{
    if (id >= c->ids || !c->place[id].ringed)
        return (struct ring){0};
    const struct copy_place *p = &c->place[id];
    return (struct ring){c->rings.at + p->ring, p->len, p->inner};
}

static struct ring new_ring(const struct copy *c, uint32_t id)
{
    if (id >= c->ids || c->slot[id] == 0)
        return old_ring(c, id);
    const struct copy_entry *e = &c->entry[c->slot[id] - 1];
    return e->ringed ? (struct ring){c->event_rings.at + e->ring, e->len, e->inner}
                     : (struct ring){0};
}

typedef struct ring ring_fn(const struct copy *c, uint32_t id);

/* The place of id in a ring; the length of the ring if it lacks the id. */
static uint32_t find(struct ring r, uint32_t id)
{
    uint32_t k = 0;
    while (k < r.len && r.at[k] != id)
        k++;
    return k;
}

/* Whether the neighbours of a boundary point with two of them are joined: they are not if all points are on one line.
 * A box may leave both their rings unknown; then they are taken to be. */
static bool are_joined(const struct copy *c, ring_fn *ring, struct ring r)
{
    struct ring a = ring(c, r.at[0]), b = ring(c, r.at[1]);
    if (a.at == NULL && b.at == NULL)
        return true;
    if (b.at == NULL || (a.at != NULL && a.len <= b.len)) /* one of them may be that of a hub */
        return find(a, r.at[1]) < a.len;
    return find(b, r.at[0]) < b.len;
}

/* Whether the ring has triangles: it may have two points of one line. */
static bool has_area(const struct copy *c, ring_fn *ring, struct ring r)
{
    return r.inner || r.len > 2 || (r.len == 2 && are_joined(c, ring, r));
}

/* Whether a state has the triangle t[0], t[1], t[2]. */
static bool has_triangle(const struct copy *c, ring_fn *ring, const uint32_t *t)
{
    struct ring best = {0};
    unsigned at = 0;
    for (unsigned k = 0; k < 3; k++) {
        struct ring r = ring(c, t[k]);
        if (r.at != NULL && (best.at == NULL || r.len < best.len)) {
            best = r;
            at = k;
        }
    }
    uint32_t k = find(best, t[(at + 1) % 3]);
    if (k == best.len || (k + 1 == best.len && !best.inner))
        return false;
    return best.at[(k + 1) % best.len] == t[(at + 2) % 3] && has_area(c, ring, best);
}

/* ---- what changes ---- */

/* Whether the triangle is looked at from another corner, a smaller id that the event names and whose ring is known. */
static bool is_seen_from(const struct copy *c, ring_fn *ring, uint32_t id, uint32_t other)
{
    return other < id && other < c->ids && c->slot[other] != 0 && ring(c, other).at != NULL;
}

/* Appends t to the triangles, its smallest id first. */
static bool add_triangle(struct copy_words *to, const uint32_t *t)
{
    unsigned k = t[1] < t[0] ? (t[2] < t[1] ? 2 : 1) : (t[2] < t[0] ? 2 : 0);
    return words_add(to, t[k]) && words_add(to, t[(k + 1) % 3]) && words_add(to, t[(k + 2) % 3]);
}

/* Adds the triangles at an id that one state has and the other one has not. */
static bool compare_star(const struct copy *c, uint32_t id, ring_fn *one, ring_fn *other,
                         struct copy_words *to)
{
    struct ring r = one(c, id);
    if (!has_area(c, one, r))
        return true;
    for (uint32_t k = r.inner ? 0 : 1; k < r.len; k++) {
        uint32_t t[3] = {id, r.at[k == 0 ? r.len - 1 : k - 1], r.at[k]};
        if (!is_seen_from(c, one, id, t[1]) && !is_seen_from(c, one, id, t[2]) &&
            !has_triangle(c, other, t) && !add_triangle(to, t))
            return false;
    }
    return true;
}

/* Bits are compared: equal nans are equal, zeros of different signs are not. */
static bool is_same(double a, double b)
{
    uint64_t one, other;
    memcpy(&one, &a, sizeof one);
    memcpy(&other, &b, sizeof other);
    return one == other;
}

static bool is_moved(const struct copy *c, const struct copy_entry *e)
{
    const struct copy_place *p = &c->place[e->id];
    bool same = is_same(p->x, e->x) && is_same(p->y, e->y);
    for (unsigned k = 0; k < c->fields && same; k++)
        same = is_same(c->value[(size_t)e->id * c->fields + k], c->event_value[e->value + k]);
    return !same;
}

static bool compare_point(struct copy *c, const struct copy_entry *e)
{
    bool was = c->place[e->id].present;
    if (e->gone)
        return !was || words_add(&c->gone, e->id);
    if (!e->point)
        return true;
    return was ? !is_moved(c, e) || words_add(&c->moved, e->id) : words_add(&c->added, e->id);
}

/* In an event with everything, what is not named is gone. */
static bool name_all(struct copy *c)
{
    for (uint32_t id = 0; c->reset && id < c->ids; id++) {
        struct copy_entry *e = c->place[id].present ? entry_of(c, id) : NULL;
        if (e == NULL && c->place[id].present)
            return false;
        if (e != NULL && !e->point)
            e->gone = true;
    }
    return true;
}

static bool compare(struct copy *c)
{
    struct copy_words *parts[] = {&c->added, &c->moved, &c->gone, &c->triangles_added,
                                  &c->triangles_removed};
    for (size_t i = 0; i < sizeof parts / sizeof parts[0]; i++)
        parts[i]->n = 0;
    bool ok = true;
    for (size_t i = 0; i < c->entries && ok; i++)
        ok = compare_point(c, &c->entry[i]) &&
             compare_star(c, c->entry[i].id, old_ring, new_ring, &c->triangles_removed) &&
             compare_star(c, c->entry[i].id, new_ring, old_ring, &c->triangles_added);
    return ok;
}

/* ---- applying ---- */

/* Makes room for n more words of rings; closes the gaps rather than growing when there are many. */
static bool rings_room(struct copy *c, size_t n)
{
    struct copy_words packed = {0};
    if (c->rings.n + n <= c->rings.cap)
        return true;
    if (!words_room(&packed, c->ringed_words + n + c->ids))
        return false;
    for (uint32_t id = 0; id < c->ids; id++) {
        struct copy_place *p = &c->place[id];
        if (!p->ringed)
            continue;
        memcpy(packed.at + packed.n, c->rings.at + p->ring, p->len * sizeof *packed.at);
        p->ring = packed.n;
        packed.n += p->len;
    }
    free(c->rings.at);
    c->rings = packed;
    return true;
}

static void drop_ring(struct copy *c, struct copy_place *p)
{
    c->ringed_words -= p->ringed ? p->len : 0;
    p->ringed = false;
}

static void apply(struct copy *c, const struct copy_entry *e)
{
    struct copy_place *p = &c->place[e->id];
    drop_ring(c, p);
    if (e->gone) {
        c->points -= p->present;
        p->present = false;
    } else if (e->point) {
        c->points += !p->present;
        p->present = true;
        p->x = e->x;
        p->y = e->y;
        if (c->fields > 0)
            memcpy(c->value + (size_t)e->id * c->fields, c->event_value + e->value,
                   c->fields * sizeof *c->value);
    }
    if (!e->ringed)
        return;
    p->ring = c->rings.n;
    p->len = e->len;
    p->inner = e->inner;
    p->ringed = true;
    memcpy(c->rings.at + p->ring, c->event_rings.at + e->ring, e->len * sizeof *c->rings.at);
    c->rings.n += e->len;
    c->ringed_words += e->len;
}

enum delaunay_result copy_commit(struct copy *c, struct delaunay_change *change)
{
    bool ok = name_all(c) && compare(c) && rings_room(c, c->event_rings.n) &&
              constraints_compare(&c->constraints, c->reset);
    for (size_t i = 0; i < c->entries && ok; i++)
        apply(c, &c->entry[i]);
    if (ok)
        constraints_apply(&c->constraints);
    *change = (struct delaunay_change){
        .reset = c->reset,
        .added = c->added.at,
        .moved = c->moved.at,
        .gone = c->gone.at,
        .n_added = c->added.n,
        .n_moved = c->moved.n,
        .n_gone = c->gone.n,
        .triangles_added = c->triangles_added.at,
        .triangles_removed = c->triangles_removed.at,
        .n_triangles_added = c->triangles_added.n / 3,
        .n_triangles_removed = c->triangles_removed.n / 3,
        .constraints_added = c->constraints.added.at,
        .constraints_released = c->constraints.released.at,
        .n_constraints_added = c->constraints.added.n,
        .n_constraints_released = c->constraints.released.n,
    };
    copy_forget(c);
    return ok ? DELAUNAY_OK : DELAUNAY_NOMEM;
}

const struct copy_place *copy_place(const struct copy *c, uint32_t id)
{
    return id < c->ids && c->place[id].present ? &c->place[id] : NULL;
}
