/* clean_paths.c - see clean_paths.h. Corners are found again in a hash table with linear probing. */
#include "clients/points/clean_paths.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { NOBODY = UINT32_MAX };

static uint64_t mix(uint64_t v)
{
    v = (v ^ v >> 30) * 0xBF58476D1CE4E5B9u;
    v = (v ^ v >> 27) * 0x94D049BB133111EBu;
    return v ^ v >> 31;
}

static uint64_t bits(double v)
{
    uint64_t b;
    v += 0.0; /* -0 is 0 */
    memcpy(&b, &v, sizeof b);
    return b;
}

static bool same_place(const struct points_file *f, size_t a, size_t b)
{
    return f->xy[2 * a] == f->xy[2 * b] && f->xy[2 * a + 1] == f->xy[2 * b + 1];
}

size_t points_difference(const struct points_file *f, size_t a, size_t b)
{
    for (size_t k = 0; k < f->fields; k++) {
        double v = f->value[f->fields * a + k], w = f->value[f->fields * b + k];
        if (v != w && !(isnan(v) && isnan(w)))
            return k;
    }
    return f->fields;
}

static bool are_same(const struct points_file *f, size_t a, size_t b, bool values)
{
    return same_place(f, a, b) && (!values || points_difference(f, a, b) == f->fields);
}

uint32_t place_table_find(struct place_table *t, size_t i, bool values)
{
    const double *xy = t->f->xy + 2 * i;
    size_t at = (size_t)mix(bits(xy[0]) ^ mix(bits(xy[1]))) & (t->cap - 1);
    while (t->place[at] != NOBODY && !are_same(t->f, t->place[at], i, values))
        at = (at + 1) & (t->cap - 1);
    if (t->place[at] == NOBODY)
        t->place[at] = (uint32_t)i;
    return t->place[at];
}

bool place_table_init(struct place_table *t, const struct points_file *f, size_t n)
{
    *t = (struct place_table){.f = f, .cap = 64};
    while (t->cap < 2 * n)
        t->cap *= 2;
    t->place = malloc(t->cap * sizeof t->place[0]);
    if (t->place != NULL)
        memset(t->place, 0xFF, t->cap * sizeof t->place[0]);
    return t->place != NULL;
}

void place_table_free(struct place_table *t)
{
    free(t->place);
}

static void keep_point(struct points_file *f, size_t from, size_t to)
{
    memmove(f->xy + 2 * to, f->xy + 2 * from, 2 * sizeof f->xy[0]);
    if (f->fields > 0)
        memmove(f->value + f->fields * to, f->value + f->fields * from,
                f->fields * sizeof f->value[0]);
}

/* next[i], NOBODY where no path has a corner, becomes the new place of the point i. */
static void number_points(struct points_file *f, struct place_table *t, uint32_t *next)
{
    size_t kept = 0;
    for (size_t i = 0; i < f->n; i++) {
        uint32_t first = next[i] != NOBODY ? place_table_find(t, i, true) : (uint32_t)i;
        next[i] = first < i ? next[first] : (uint32_t)kept++;
    }
}

static void move_points(struct points_file *f, const uint32_t *next)
{
    size_t kept = 0;
    for (size_t i = 0; i < f->n; i++)
        if (next[i] == kept)
            keep_point(f, i, kept++);
    f->n = kept;
    for (size_t i = 0; i < f->paths.corners; i++)
        f->paths.corner[i] = next[f->paths.corner[i]];
}

static bool join_points(struct points_file *f)
{
    uint32_t *next = malloc((f->n + 1) * sizeof next[0]);
    struct place_table t;
    bool ok = place_table_init(&t, f, f->paths.corners) && next != NULL;
    if (ok) {
        memset(next, 0xFF, f->n * sizeof next[0]);
        for (size_t i = 0; i < f->paths.corners; i++)
            next[f->paths.corner[i]] = 0; /* a corner */
        number_points(f, &t, next);
        move_points(f, next);
    }
    place_table_free(&t);
    free(next);
    return ok;
}

/* ---- steps and rings ---- */

static void drop_short_steps(struct points_file *f, struct path *path)
{
    uint32_t *corner = f->paths.corner + path->first;
    size_t kept = 0, n = path->n;
    for (size_t i = 0; i < n; i++)
        if (kept == 0 || !same_place(f, corner[kept - 1], corner[i]))
            corner[kept++] = corner[i];
    while (path->closed && kept > 1 && same_place(f, corner[0], corner[kept - 1]))
        kept--;
    f->paths.short_steps += n - kept;
    path->n = kept;
    if (kept < 3 && !path->border)
        path->closed = false;
}

static bool is_flat(const struct path *path)
{
    return path->n < 2 || (path->closed && path->n < 3);
}

/* A number of the ring's sides that does not depend on where it begins and which way it runs. */
static uint64_t hash_of(const struct paths *p, const struct path *path)
{
    uint64_t hash = mix(path->number);
    for (size_t i = 0; i < paths_steps(path); i++) {
        uint32_t end[2];
        paths_step(p, path, i, end);
        hash += mix((uint64_t)(end[0] < end[1] ? end[0] : end[1]) << 32 | (end[0] ^ end[1]));
    }
    return hash;
}

static int compare_segments(const void *a, const void *b)
{
    const struct segment *s = a, *t = b;
    if (s->what != t->what)
        return s->what < t->what ? -1 : 1;
    if (s->a != t->a)
        return s->a < t->a ? -1 : 1;
    return s->b < t->b ? -1 : s->b > t->b;
}

static size_t put_segments(const struct paths *p, const struct path *path, struct segment *to)
{
    size_t n = paths_steps(path);
    for (size_t i = 0; i < n; i++) {
        uint32_t end[2];
        paths_step(p, path, i, end);
        to[i] = (struct segment){2 * path->number + path->border, end[0] < end[1] ? end[0] : end[1],
                                 end[0] < end[1] ? end[1] : end[0]};
    }
    return n;
}

/* 1, 0, or -1 when out of memory. */
static int have_same_sides(const struct paths *p, const struct path *a, const struct path *b)
{
    if (a->number != b->number || a->n != b->n)
        return 0;
    struct segment *s = malloc(2 * a->n * sizeof s[0]);
    if (s == NULL)
        return -1;
    put_segments(p, a, s);
    put_segments(p, b, s + a->n);
    qsort(s, a->n, sizeof s[0], compare_segments);
    qsort(s + a->n, a->n, sizeof s[0], compare_segments);
    bool same = memcmp(s, s + a->n, a->n * sizeof s[0]) == 0;
    free(s);
    return same;
}

struct ring {
    uint64_t hash;
    size_t path;
};

static int compare_rings(const void *a, const void *b)
{
    const struct ring *r = a, *s = b;
    if (r->hash != s->hash)
        return r->hash < s->hash ? -1 : 1;
    return r->path < s->path ? -1 : r->path > s->path;
}

/* Makes rings flat that their polygon has already. */
static bool drop_same_rings(struct paths *p)
{
    struct ring *ring = malloc((p->n + 1) * sizeof ring[0]);
    size_t n = 0;
    bool ok = ring != NULL;
    for (size_t i = 0; ok && i < p->n; i++)
        if (p->path[i].border && p->path[i].closed)
            ring[n++] = (struct ring){hash_of(p, &p->path[i]), i};
    if (ok)
        qsort(ring, n, sizeof ring[0], compare_rings);
    for (size_t i = 1, kept = 0; ok && i < n; i++) {
        struct path *path = &p->path[ring[i].path];
        int same = ring[i].hash == ring[kept].hash
                       ? have_same_sides(p, &p->path[ring[kept].path], path)
                       : 0;
        ok = same >= 0;
        if (same > 0) {
            path->n = 0;
            p->same_rings++;
        } else {
            kept = i;
        }
    }
    free(ring);
    return ok;
}

static void drop_flat_paths(struct paths *p)
{
    size_t kept = 0;
    for (size_t i = 0; i < p->n; i++)
        if (!is_flat(&p->path[i]))
            p->path[kept++] = p->path[i];
    p->n = kept;
    p->segments = 0;
    for (size_t i = 0; i < kept; i++)
        p->segments += paths_steps(&p->path[i]);
}

bool paths_clean(struct points_file *f)
{
    struct paths *p = &f->paths;
    if (p->n == 0)
        return true;
    bool ok = p->given || join_points(f);
    for (size_t i = 0; ok && i < p->n; i++) {
        drop_short_steps(f, &p->path[i]);
        p->flat_rings += p->path[i].closed && is_flat(&p->path[i]);
    }
    if (!ok || !drop_same_rings(p)) {
        f->line = 0;
        return points_file_stop(f, "out of memory");
    }
    drop_flat_paths(p);
    return true;
}

void segments_sort(struct segment *segment, size_t n)
{
    qsort(segment, n, sizeof segment[0], compare_segments);
}

struct segment *paths_segments(const struct paths *p, size_t *n)
{
    size_t all = 0, kept = 0;
    struct segment *s = malloc((p->segments + 1) * sizeof s[0]);
    if (s == NULL)
        return NULL;
    for (size_t i = 0; i < p->n; i++)
        all += put_segments(p, &p->path[i], s + all);
    segments_sort(s, all);
    for (size_t i = 0, same = 1; i < all; i += same) {
        for (same = 1; i + same < all && compare_segments(&s[i], &s[i + same]) == 0; same++)
            continue;
        if ((s[i].what & 1) == 0 || same % 2 == 1)
            s[kept++] = s[i];
    }
    *n = kept;
    return s;
}
