/* regions_find.c - finds what borders enclose; see regions.h.
 *
 *   1. The numbers. A border is closed if every vertex is the end of an even number of its constraints.
 *   2. The sides: for each edge and each closed border that covers it an odd number of times, the edge and the region.
 *   3. The tour: each face is flooded, and beyond each of its sides is the next face, unless it has been visited. On the
 *      way across a side its regions are entered or left, and on the way back the other way round. A flood meets every
 *      side from either face; that which is inside the region gives the side its direction.
 *   4. Areas, exact: half the sum of the cross products of the sides of a region, counterclockwise. */
#include <stdlib.h>

#include "core/constraints/enforce.h"
#include "core/constraints/regions.h"
#include "core/exact/sum.h"
#include "core/memory/memory.h"
#include "core/memory/sort.h"
#include "core/mesh/fixed.h"

enum { UNKNOWN = (1 << 29) - 1 }; /* no face has this number: there are fewer triangles */

/* A part of a border's constraint, as a key for dt_sort_keys. At first it has the lower half edge and the index of the region;
 * later the region and the half edge with the region on its left. */
typedef uint64_t side_key;

/* A half edge of a face with a side on it. */
struct door {
    uint32_t h, side; /* the first of the sides of its edge */
};

/* A face that the tour is in. */
struct room {
    struct door from; /* through which it was entered */
    size_t doors;     /* of the rooms before it */
};

struct survey {
    struct dt_regions *r;
    const struct dt_mesh *m;
    struct dt_mesh *faces; /* the same, for its faces */
    const struct dt_points *p;
    const struct dt_declared *d;
    struct dt_stop *work;
    side_key *side; /* owns `cap`, holds `sides` */
    size_t sides, cap;
    uint32_t *start; /* owns: by the leading bits of a half edge, the first side not before it */
    unsigned shift;
    uint32_t *enclosing; /* owns, by region: the range under way, DT_NONE if the face is outside */
    uint32_t open;       /* ranges under way */
    bool *left;          /* owns, by side: the region is on the left of the lower half edge */
    struct dt_ids flood; /* owns: stack of its triangles */
    struct door *door;   /* owns: stack, of all rooms */
    size_t doors, door_cap;
    struct room *room; /* owns: stack */
    size_t rooms, room_cap;
};

/* ---- which borders there are ---- */

/* The next border from row *i on, and the vertices that it joins; false: there is none. */
static bool next_border(const struct survey *s, uint32_t *i, uint32_t *number, uint32_t end[2])
{
    for (; *i < s->d->end; ++*i) {
        const struct dt_declared_row *row = &s->d->row[*i];
        if (!dt_declared_is_live(s->d, *i) || (row->what & 1) == 0)
            continue;
        *number = row->what >> 1;
        end[0] = dt_points_vertex(s->p, row->end[0]);
        end[1] = dt_points_vertex(s->p, row->end[1]);
        ++*i;
        return true;
    }
    return false;
}

/* Makes the regions those with a key, which is sorted: the number and an end. An end that is there an odd number of times
 * is open. */
static enum dt_status list_regions(struct dt_regions *r, const uint64_t *key, size_t n)
{
    size_t count = 0;
    for (size_t i = 0; i < n; i++)
        count += i == 0 || key[i] >> 32 != key[i - 1] >> 32;
    r->region = calloc(count + 1, sizeof *r->region);
    if (r->region == NULL)
        return DT_NOMEM;
    for (size_t i = 0, k = 0; i < n; i += k) {
        uint32_t number = (uint32_t)(key[i] >> 32);
        if (r->n == 0 || r->region[r->n - 1].number != number)
            r->region[r->n++] = (struct dt_region){.number = number, .closed = true};
        for (k = 1; i + k < n && key[i + k] == key[i]; k++)
            ;
        r->region[r->n - 1].closed &= k % 2 == 0;
    }
    return DT_OK;
}

static enum dt_status find_regions(struct survey *s)
{
    uint32_t number, end[2], borders = 0, n = 0;
    for (uint32_t i = 0; next_border(s, &i, &number, end); borders++)
        ;
    uint64_t *key = dt_array_new(2 * (size_t)borders + 1, sizeof *key);
    if (key == NULL)
        return DT_NOMEM;
    for (uint32_t i = 0; next_border(s, &i, &number, end);)
        for (int k = 0; k < 2; k++)
            key[n++] = (uint64_t)number << 32 | end[k];
    dt_sort_keys(key, n);
    enum dt_status status = list_regions(s->r, key, n);
    dt_array_free(key);
    return status == DT_OK ? dt_work(s->work, borders) : status;
}

/* ---- sides ---- */

static uint32_t lower(const struct dt_mesh *m, uint32_t h)
{
    uint32_t g = dt_twin(m, h);
    return h < g ? h : g;
}

static enum dt_status add_chain(struct survey *s, uint32_t region, const uint32_t end[2])
{
    const struct dt_point *xy = s->p->xy;
    enum dt_status status = DT_OK;
    for (uint32_t v = end[0], near = s->m->leaving[v]; v != end[1] && status == DT_OK;) {
        uint32_t h = dt_chain_next(s->m, xy, near, xy[end[1]]);
        side_key key = (uint64_t)lower(s->m, h) << 32 | region;
        status = dt_items_append(&s->side, &s->sides, &s->cap, &key, sizeof key);
        if (status == DT_OK)
            status = dt_work(s->work, 1);
        near = dt_twin(s->m, h);
        v = dt_origin(s->m, near);
    }
    return status;
}

/* Leaves those that are there an odd number of times, once. */
static size_t keep_odd(side_key *side, size_t n)
{
    size_t kept = 0;
    for (size_t i = 0; i < n; i++)
        if (kept > 0 && side[kept - 1] == side[i])
            kept--;
        else
            side[kept++] = side[i];
    return kept;
}

/* So that the sides of an edge are found in constant time, expected. */
static enum dt_status index_sides(struct survey *s)
{
    while (s->m->tri_end >> s->shift > s->sides)
        s->shift++;
    s->shift += 3; /* half edges */
    uint32_t n = (8 * s->m->tri_end >> s->shift) + 2;
    size_t i = 0;
    s->start = dt_array_new(n, sizeof *s->start);
    s->left = calloc(s->sides + 1, sizeof *s->left);
    if (s->start == NULL || s->left == NULL)
        return DT_NOMEM;
    for (uint32_t at = 0; at < n; at++) {
        while (i < s->sides && s->side[i] >> 32 >> s->shift < at)
            i++;
        s->start[at] = (uint32_t)i;
    }
    return DT_OK;
}

static enum dt_status find_sides(struct survey *s)
{
    uint32_t number, end[2];
    enum dt_status status = DT_OK;
    for (uint32_t i = 0; status == DT_OK && next_border(s, &i, &number, end);) {
        const struct dt_region *region = dt_regions_find(s->r, number);
        if (region->closed)
            status = add_chain(s, (uint32_t)(region - s->r->region), end);
    }
    dt_sort_keys(s->side, s->sides);
    s->sides = keep_odd(s->side, s->sides);
    if (s->sides >= UINT32_MAX)
        return DT_TOOBIG;
    return status == DT_OK ? index_sides(s) : status;
}

static uint32_t edge_of(const struct survey *s, uint32_t side)
{
    return (uint32_t)(s->side[side] >> 32);
}

static uint32_t region_of(const struct survey *s, uint32_t side)
{
    return (uint32_t)s->side[side];
}

static bool is_side_of(const struct survey *s, uint32_t side, uint32_t edge)
{
    return side < s->sides && edge_of(s, side) == edge;
}

/* The first side of the edge of h, DT_NONE if there is none. */
static uint32_t side_at(const struct survey *s, uint32_t h)
{
    uint32_t edge = lower(s->m, h), i = s->start[edge >> s->shift];
    while (i < s->sides && edge_of(s, i) < edge)
        i++;
    return is_side_of(s, i, edge) ? i : DT_NONE;
}

/* ---- the tour ---- */

/* Crosses a side: the regions that end here, at the face, or at the end of all so far, and those that begin. */
static void toggle(struct survey *s, uint32_t side)
{
    struct dt_regions *r = s->r;
    for (uint32_t i = side, edge = edge_of(s, side); is_side_of(s, i, edge); i++) {
        uint32_t *range = &s->enclosing[region_of(s, i)];
        if (*range != DT_NONE) {
            r->range[*range].end = r->faces;
            *range = DT_NONE;
            s->open--;
        } else {
            *range = r->ranges++;
            r->range[*range] = (struct dt_region_range){r->faces, 0, region_of(s, i), 0};
            s->open++;
        }
    }
}

/* The flood of the face has come to a side: the regions that the face is in are on the left of h. */
static enum dt_status add_door(struct survey *s, uint32_t h, uint32_t side)
{
    uint32_t edge = edge_of(s, side);
    for (uint32_t i = side; is_side_of(s, i, edge); i++)
        if (s->enclosing[region_of(s, i)] != DT_NONE)
            s->left[i] = h == edge;
    return dt_items_append(&s->door, &s->doors, &s->door_cap, &(struct door){h, side},
                           sizeof *s->door);
}

static enum dt_status reach(struct survey *s, uint32_t h, uint32_t face)
{
    dt_face_set(s->faces, h, face);
    return dt_ids_append(&s->flood, dt_base(h));
}

static enum dt_status look_beyond(struct survey *s, uint32_t h, uint32_t face)
{
    uint32_t side = dt_is_fixed(s->m, h) ? side_at(s, h) : DT_NONE, g = dt_twin(s->m, h);
    if (side != DT_NONE)
        return add_door(s, h, side);
    return dt_face(s->m, g) == UNKNOWN ? reach(s, g, face) : DT_OK;
}

/* The next face, of h, through the door. */
static enum dt_status enter(struct survey *s, uint32_t h, struct door from)
{
    enum dt_status status = dt_items_append(&s->room, &s->rooms, &s->room_cap,
                                            &(struct room){from, s->doors}, sizeof *s->room);
    if (status != DT_OK)
        return status;
    uint32_t face = s->r->faces++;
    s->r->inside[face] = s->open > 0;
    status = reach(s, h, face);
    while (status == DT_OK && s->flood.n > 0) {
        uint32_t t = s->flood.v[--s->flood.n];
        status = dt_work(s->work, 1);
        for (uint32_t k = 0; k < 3 && status == DT_OK; k++)
            status = look_beyond(s, t + k, face);
    }
    return status;
}

static enum dt_status tour(struct survey *s)
{
    const struct dt_mesh *m = s->m;
    enum dt_status status = enter(s, m->hull, (struct door){DT_NONE, DT_NONE});
    while (status == DT_OK && s->rooms > 0) {
        struct room *room = &s->room[s->rooms - 1];
        if (s->doors == room->doors) {
            if (room->from.side != DT_NONE)
                toggle(s, room->from.side);
            s->rooms--;
            continue;
        }
        struct door door = s->door[--s->doors];
        uint32_t beyond = dt_twin(m, door.h);
        if (dt_face(m, beyond) != UNKNOWN)
            continue;
        toggle(s, door.side);
        status = enter(s, beyond, door);
    }
    return status;
}

/* There is no triangle. */
static enum dt_status stay_outside(struct dt_regions *r)
{
    r->inside[r->faces++] = false;
    return DT_OK;
}

static enum dt_status prepare_tour(struct survey *s)
{
    size_t edges = 0;
    for (uint32_t i = 0; i < s->sides; i++)
        edges += i == 0 || edge_of(s, i) != edge_of(s, i - 1);
    s->enclosing = dt_array_new(s->r->n + (size_t)1, sizeof *s->enclosing);
    s->r->range = malloc((s->sides + 1) * sizeof *s->r->range);
    s->r->inside = malloc((edges + 1) * sizeof *s->r->inside);
    if (s->enclosing == NULL || s->r->range == NULL || s->r->inside == NULL)
        return DT_NOMEM;
    for (uint32_t i = 0; i < s->r->n; i++)
        s->enclosing[i] = DT_NONE;
    for (uint32_t t = 0; t < s->m->tri_end; t++)
        dt_face_set(s->faces, 8 * t, UNKNOWN);
    return DT_OK;
}

/* ---- ranges and areas ---- */

/* Of the ranges lo .. hi - 1; returns the largest end. */
static uint32_t set_most(struct dt_region_range *range, uint32_t lo, uint32_t hi)
{
    if (lo == hi)
        return 0;
    uint32_t mid = lo + (hi - lo) / 2, most = range[mid].end;
    uint32_t before = set_most(range, lo, mid), after = set_most(range, mid + 1, hi);
    most = most > before ? most : before;
    return range[mid].most = most > after ? most : after;
}

/* The array becomes as large as it needs to be: bytes > 0. */
static void *shrink(void *array, size_t bytes)
{
    void *less = realloc(array, bytes);
    if (less == NULL)
        return array;
    return less;
}

/* Sorts the ranges by region, stably. */
static enum dt_status sort_ranges(struct dt_regions *r)
{
    r->sorted = malloc((r->ranges + (size_t)1) * sizeof *r->sorted);
    r->start = calloc(r->n + (size_t)2, sizeof *r->start);
    if (r->sorted == NULL || r->start == NULL)
        return DT_NOMEM;
    for (uint32_t i = 0; i < r->ranges; i++)
        r->start[r->range[i].region + 2]++;
    for (uint32_t i = 2; i < r->n + 2; i++)
        r->start[i] += r->start[i - 1];
    for (uint32_t i = 0; i < r->ranges; i++) /* start[k + 1] becomes the end of k */
        r->sorted[r->start[r->range[i].region + 1]++] = i;
    return DT_OK;
}

static enum dt_status finish_ranges(struct dt_regions *r)
{
    uint32_t kept = 0;
    for (uint32_t i = 0; i < r->ranges; i++)
        if (r->range[i].first < r->range[i].end)
            r->range[kept++] = r->range[i];
    r->ranges = kept;
    set_most(r->range, 0, kept);
    r->range = shrink(r->range, (r->ranges + (size_t)1) * sizeof *r->range);
    r->inside = shrink(r->inside, (r->faces + (size_t)1) * sizeof *r->inside);
    return sort_ranges(r);
}

static void add_half(const struct survey *s, uint32_t h, struct dt_sum *sum)
{
    const struct dt_point *xy = s->p->xy;
    dt_sum_cross(sum, xy[dt_origin(s->m, h)], xy[dt_dest(s->m, h)]);
}

/* The area of all faces that are inside any region. */
static double area_inside(const struct survey *s)
{
    struct dt_sum sum = {0};
    for (uint32_t i = 0; i < s->sides; i++) {
        uint32_t h = edge_of(s, i), g = dt_twin(s->m, h);
        bool in = s->r->inside[dt_face(s->m, h)];
        if ((i == 0 || edge_of(s, i - 1) != h) && in != s->r->inside[dt_face(s->m, g)])
            add_half(s, in ? h : g, &sum);
    }
    return dt_sum_half(&sum);
}

static void find_areas(struct survey *s)
{
    s->r->area = area_inside(s);
    for (uint32_t i = 0; i < s->sides; i++) {
        uint32_t h = edge_of(s, i), region = region_of(s, i);
        s->side[i] = (uint64_t)region << 32 | (s->left[i] ? h : dt_twin(s->m, h));
    }
    dt_sort_keys(s->side, s->sides);
    for (size_t i = 0; i < s->sides;) {
        uint64_t region = s->side[i] >> 32;
        struct dt_sum sum = {0};
        for (; i < s->sides && s->side[i] >> 32 == region; i++)
            add_half(s, (uint32_t)s->side[i], &sum);
        s->r->region[region].area = dt_sum_half(&sum);
    }
}

/* ---- all of it ---- */

static void clear(struct survey *s)
{
    free(s->side);
    dt_array_free(s->start);
    dt_array_free(s->enclosing);
    free(s->left);
    free(s->flood.v);
    free(s->door);
    free(s->room);
}

static enum dt_status survey_all(struct dt_regions *r, struct dt_mesh *m, const struct dt_points *p,
                                 const struct dt_declared *d, struct dt_stop *work)
{
    struct survey s = {.r = r, .m = m, .faces = m, .p = p, .d = d, .work = work};
    enum dt_status status = find_regions(&s);
    if (status == DT_OK)
        status = find_sides(&s);
    if (status == DT_OK)
        status = prepare_tour(&s);
    if (status == DT_OK)
        status = m->vertices < 2 ? stay_outside(r) : tour(&s);
    if (status == DT_OK)
        status = finish_ranges(r);
    if (status == DT_OK) {
        find_areas(&s);
        r->current = true;
    }
    clear(&s);
    return status;
}

enum dt_status dt_regions_survey(struct dt_regions *r, struct dt_mesh *m, const struct dt_points *p,
                                 const struct dt_declared *d, struct dt_stop *work)
{
    enum dt_status status = dt_is_one_border(d) ? dt_regions_survey_one(r, m, p, d, work)
                                                : survey_all(r, m, p, d, work);
    if (status != DT_OK)
        dt_regions_clear(r);
    return status;
}

/* ---- the proof ---- */

/* Whether the regions that only one of the faces is in, out of in[2][n], are those of the sides. */
static bool differ_by(const struct survey *s, uint32_t side, uint32_t *const in[2],
                      const uint32_t n[2])
{
    uint32_t edge = side == DT_NONE ? DT_NONE : edge_of(s, side);
    for (uint32_t i = 0, k = 0; i < n[0] || k < n[1];) {
        bool first = k == n[1] || (i < n[0] && in[0][i] < in[1][k]);
        if (!first && i < n[0] && in[0][i] == in[1][k]) {
            i++;
            k++;
            continue;
        }
        uint32_t region = first ? in[0][i++] : in[1][k++];
        if (side == DT_NONE || !is_side_of(s, side, edge) || region_of(s, side) != region)
            return false;
        side++;
    }
    return side == DT_NONE || !is_side_of(s, side, edge);
}

/* Whether faces on both sides of every edge of the triangle are as its sides say. */
static bool is_triangle_right(const struct survey *s, const struct dt_regions *r, uint32_t t,
                              uint32_t *const in[2])
{
    uint32_t face = dt_face(s->m, t);
    bool right = face < r->faces && (!dt_is_ghost(s->m, t) || face == 0);
    for (uint32_t h = t; h < t + 3 && right; h++) {
        uint32_t g = dt_twin(s->m, h), beyond = dt_face(s->m, g);
        uint32_t side = dt_is_fixed(s->m, h) ? side_at(s, h) : DT_NONE;
        if (face == beyond) {
            right = side == DT_NONE;
        } else if (h < g && beyond < r->faces) {
            uint32_t n[2] = {dt_regions_of(r, face, in[0], r->n),
                             dt_regions_of(r, beyond, in[1], r->n)};
            for (int k = 0; k < 2; k++)
                dt_sort_ids(in[k], n[k], NULL, NULL);
            right = dt_is_fixed(s->m, h) && differ_by(s, side, in, n) &&
                    r->inside[face] == (n[0] > 0) && r->inside[beyond] == (n[1] > 0);
        }
    }
    return right;
}

static bool are_numbers_right(const struct dt_regions *r, const struct dt_regions *fresh)
{
    bool right = r->n == fresh->n;
    for (uint32_t i = 0; i < r->n && right; i++)
        right = r->region[i].number == fresh->region[i].number &&
                r->region[i].closed == fresh->region[i].closed;
    return right;
}

bool dt_regions_hold(const struct dt_regions *r, const struct dt_mesh *m, const struct dt_points *p,
                     const struct dt_declared *d)
{
    struct dt_regions fresh = {0};
    struct survey s = {.r = &fresh, .m = m, .p = p, .d = d};
    uint32_t *in[2] = {malloc((r->n + 1) * sizeof *in[0]), malloc((r->n + 1) * sizeof *in[1])};
    bool holds = true;
    if (in[0] != NULL && in[1] != NULL && find_regions(&s) == DT_OK && find_sides(&s) == DT_OK) {
        holds = are_numbers_right(r, &fresh) && dt_regions_of(r, 0, NULL, 0) == 0;
        for (uint32_t t = 0; t < m->tri_end && holds; t++)
            holds = dt_is_dead(m, 8 * t) || is_triangle_right(&s, r, 8 * t, in);
    }
    clear(&s);
    dt_regions_clear(&fresh);
    free(in[0]);
    free(in[1]);
    return holds;
}
