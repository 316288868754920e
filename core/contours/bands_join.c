/* bands_join.c - joins the sides of bands to rings.
 *
 * Every side has a next one. If the side ends on an edge, the next one is found by the name of the edge and the level,
 * as lines of contours are joined. If it ends at a vertex, all sides of the band there are sorted around the vertex:
 *
 *            b    out          The band is between a side that begins at the vertex and the next one,
 *         in  \\  /             counterclockwise, that ends there. So a band that only touches itself at the
 *       -----  v  ----- in     vertex passes it several times, and stays on the left of each pass. A side
 *             / \              that begins and one that ends along the same edge of the mesh have no band
 *          out   a             between them, or the band on both sides: both go.
 *
 * Then each walk along the sides goes around one connected part. It is cut where it passes a vertex again, as alpha.c
 * cuts it, so all rings are simple. The one ring of a connected part that goes around it counterclockwise
 * is the outer one.
 *
 * All this is decided by ids, levels and exact signs. Coordinates of crossings are rounded, so a ring may touch or cross
 * itself or another one by as much as they are rounded. */
#include "core/contours/bands.h"

#include "core/exact/predicates.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

static size_t sides_of(const struct dt_bands *b)
{
    return b->borders + 2 * b->crossings;
}

size_t dt_bands_join_memory(const struct dt_bands *b)
{
    size_t sides = sides_of(b), loops = sides / 2 + 1;
    size_t sorting = b->ends * sizeof *b->end + loops * sizeof *b->loop; /* merge sort copies */
    return (dt_edge_slots(b->crossings) + dt_edge_slots(b->ties) + 4 * sides) * sizeof(uint32_t) +
           2 * sides * sizeof *b->place + loops * (sizeof *b->loop + sizeof *b->ring) + sorting;
}

/* ---- sides that meet on an edge ---- */

static bool is_vertex(struct dt_edge e)
{
    return e.lo == e.hi;
}

/* The slot of a crossing: twice its number, plus 1 if it has been entered by its `out`. Or the free slot where it
 * belongs. */
static size_t slot_of(const struct dt_bands *b, uint32_t level, struct dt_edge e)
{
    size_t i = dt_edge_hash(level, e) & (b->slots - 1);
    for (; b->slot[i] != DT_NONE; i = (i + 1) & (b->slots - 1)) {
        const struct dt_band_crossing *c = &b->crossing[b->slot[i] / 2];
        const struct dt_edge *at = b->slot[i] % 2 == 0 ? &c->in : &c->out;
        if (c->level == level && at->lo == e.lo && at->hi == e.hi)
            break;
    }
    return i;
}

/* Joins the sides of a crossing to those of the next one, j, and unites the pieces along the edge between. */
static void join_next(struct dt_bands *b, uint32_t i, uint32_t j)
{
    const struct dt_band_crossing *c = &b->crossing[i], *d = &b->crossing[j];
    b->next[dt_band_side(b, i, false)] = dt_band_side(b, j, false);
    b->next[dt_band_side(b, j, true)] = dt_band_side(b, i, true);
    if (dt_is_band(b, c->level + 1))
        dt_piece_unite(b->parent, c->above, d->above);
    if (dt_is_band(b, c->level))
        dt_piece_unite(b->parent, c->below, d->below);
}

/* Joins a side of the border to those of the crossings at its ends. */
static void join_border(struct dt_bands *b, uint32_t side)
{
    const struct dt_band_border *p = &b->border[side];
    struct dt_edge e = dt_edge_of(p->a, p->b);
    if (p->start != DT_NONE) {
        uint32_t at = b->slot[slot_of(b, p->start, e)];
        b->next[dt_band_side(b, at / 2, at % 2 == 0)] = side;
    }
    if (p->end != DT_NONE) {
        uint32_t at = b->slot[slot_of(b, p->end, e)];
        b->next[side] = dt_band_side(b, at / 2, at % 2 != 0);
    }
}

static void join_edges(struct dt_bands *b, struct dt_stop *stop)
{
    struct dt_piece p = dt_pieces(0, (uint32_t)b->crossings);
    while (dt_next_piece_of(stop, DT_POLL_MISSES, &p))
        for (uint32_t i = p.a; i < p.b; i++)
            if (!is_vertex(b->crossing[i].in))
                b->slot[slot_of(b, b->crossing[i].level, b->crossing[i].in)] = 2 * i;
    p = dt_pieces(0, (uint32_t)b->crossings);
    while (dt_next_piece_of(stop, DT_POLL_MISSES, &p))
        for (uint32_t i = p.a; i < p.b; i++) {
            if (is_vertex(b->crossing[i].out))
                continue;
            size_t slot = slot_of(b, b->crossing[i].level, b->crossing[i].out);
            if (b->slot[slot] == DT_NONE) /* the border is here */
                b->slot[slot] = 2 * i + 1;
            else
                join_next(b, i, b->slot[slot] / 2);
        }
    p = dt_pieces(0, (uint32_t)b->borders);
    while (dt_next_piece_of(stop, DT_POLL_MISSES, &p))
        for (uint32_t i = p.a; i < p.b; i++)
            join_border(b, i);
}

/* ---- pieces ---- */

static size_t tie_slot_of(const struct dt_bands *b, struct dt_edge e)
{
    size_t i = dt_edge_hash(0, e) & (b->tie_slots - 1);
    for (; b->tie_slot[i] != DT_NONE; i = (i + 1) & (b->tie_slots - 1)) {
        const struct dt_edge *at = &b->tie[b->tie_slot[i]].edge;
        if (at->lo == e.lo && at->hi == e.hi)
            break;
    }
    return i;
}

static void unite_ties(struct dt_bands *b, struct dt_stop *stop)
{
    struct dt_piece p = dt_pieces(0, (uint32_t)b->ties);
    while (dt_next_piece_of(stop, DT_POLL_MISSES, &p))
        for (uint32_t i = p.a; i < p.b; i++) {
            size_t slot = tie_slot_of(b, b->tie[i].edge);
            if (b->tie_slot[slot] == DT_NONE)
                b->tie_slot[slot] = i;
            else
                dt_piece_unite(b->parent, b->tie[b->tie_slot[slot]].piece, b->tie[i].piece);
        }
}

static uint32_t tied_piece(const struct dt_bands *b, uint32_t p, uint32_t q)
{
    uint32_t i = b->tie_slot[tie_slot_of(b, dt_edge_of(p, q))];
    return i == DT_NONE ? DT_NONE : b->tie[i].piece;
}

/* A piece on the left of a part of the border. DT_NONE: it has no corner of the piece that is not marked, so the crossing at
 * one of its ends knows. */
static uint32_t border_piece(const struct dt_bands *b, const struct dt_band_border *p)
{
    const uint32_t *class = b->read.class;
    if (p->start == DT_NONE && class[p->a] == p->class) /* not marked */
        return p->a;
    if (p->end == DT_NONE && class[p->b] == p->class)
        return p->b;
    return p->start == DT_NONE && p->end == DT_NONE ? tied_piece(b, p->a, p->b) : DT_NONE;
}

/* A piece on the left of a side; DT_NONE: not known from this side. */
static uint32_t piece_of(const struct dt_bands *b, uint32_t side)
{
    if (side < b->borders)
        return border_piece(b, &b->border[side]);
    const struct dt_band_crossing *c = &b->crossing[(side - b->borders) / 2];
    return (side - b->borders) % 2 != 0 ? c->below : c->above;
}

/* ---- sides that meet at a vertex ---- */

static int compare_vertices(const void *p, const void *q)
{
    const struct dt_band_end *a = p, *b = q;
    if (a->vertex != b->vertex)
        return a->vertex < b->vertex ? -1 : 1;
    return (a->class > b->class) - (a->class < b->class);
}

/* Whether the direction is from east, included, to west, excluded, counterclockwise. */
static bool is_upper(const struct dt_band_end *e)
{
    return e->toward.y > e->at.y || (e->toward.y == e->at.y && e->toward.x > e->at.x);
}

/* Counterclockwise from the east. */
static int compare_directions(const void *p, const void *q)
{
    const struct dt_band_end *a = p, *b = q;
    bool upper = is_upper(a);
    if (upper != is_upper(b))
        return upper ? -1 : 1;
    int turn = dt_orient2d(a->at, a->toward, b->toward);
    return turn != 0 ? -turn : a->beside - b->beside;
}

/* Removes the pairs of sides along one edge. If both have a piece on their left, these pieces share the edge. */
static size_t cancel_pairs(const struct dt_bands *b, struct dt_band_end *e, size_t n)
{
    size_t kept = 0;
    for (size_t i = 0; i < n; i++) {
        if (kept == 0 || compare_directions(&e[kept - 1], &e[i]) != 0) {
            e[kept++] = e[i];
            continue;
        }
        uint32_t p = piece_of(b, e[--kept].side), q = piece_of(b, e[i].side);
        if (p != DT_NONE && q != DT_NONE)
            dt_piece_unite(b->parent, p, q);
    }
    return kept;
}

/* Joins the sides of a band at a vertex. */
static void join_around(struct dt_bands *b, struct dt_band_end *e, size_t n)
{
    qsort(e, n, sizeof *e, compare_directions);
    n = cancel_pairs(b, e, n);
    bool several = n > 2;
    b->knots += several;
    for (size_t i = 0; i < n; i++) {
        const struct dt_band_end *before = &e[i > 0 ? i - 1 : n - 1];
        if (e[i].begins) {
            b->knot[e[i].side] = several ? (uint32_t)b->knots : 0;
            continue;
        }
        assert(before->begins);
        b->next[e[i].side] = before->side;
    }
}

static void join_vertices(struct dt_bands *b, struct dt_stop *stop)
{
    struct dt_piece p = dt_pieces(0, (uint32_t)b->ends);
    if (b->ends > 0)
        qsort(b->end, b->ends, sizeof *b->end, compare_vertices);
    for (size_t i = 0, n; i < b->ends; i += n) {
        for (n = 1; i + n < b->ends && compare_vertices(&b->end[i], &b->end[i + n]) == 0; n++)
            ;
        join_around(b, &b->end[i], n);
        if (i >= p.b && !dt_next_piece_of(stop, DT_POLL_MISSES, &p))
            return;
    }
}

/* ---- walks ---- */

static uint32_t class_of(const struct dt_bands *b, uint32_t side)
{
    if (side < b->borders)
        return b->border[side].class;
    return b->crossing[(side - b->borders) / 2].level + ((side - b->borders) % 2 == 0);
}

static struct dt_point start_of(const struct dt_bands *b, uint32_t side)
{
    if (side < b->borders)
        return b->border[side].from;
    const struct dt_band_crossing *c = &b->crossing[(side - b->borders) / 2];
    return (side - b->borders) % 2 == 0 ? c->from : c->to;
}

/* Takes the sides of the walk from `from` to `end` as a loop. Places that are equal to the one before are left out. */
static void take_loop(struct dt_bands *b, size_t from, size_t end, uint32_t piece)
{
    struct dt_point *p = b->place + b->places;
    size_t n = 0;
    for (size_t i = from; i < end; i++) {
        struct dt_point at = start_of(b, b->walk[i]);
        if (n == 0 || dt_compare_xy(p[n - 1], at) != 0)
            p[n++] = at;
    }
    while (n > 1 && dt_compare_xy(p[0], p[n - 1]) == 0)
        n--;
    b->loop[b->loops++] = (struct dt_band_loop){class_of(b, b->walk[from]), piece, p, n, false, 0};
    b->places += n;
}

/* Marks the sides of a walk as taken: they have no next one any more. Returns how many they are. */
static size_t read_walk(struct dt_bands *b, uint32_t first, uint32_t *piece)
{
    size_t n = 0;
    uint32_t side = first;
    do {
        uint32_t next = b->next[side];
        assert(next != DT_NONE);
        b->next[side] = DT_NONE;
        b->walk[n++] = side;
        if (*piece == DT_NONE)
            *piece = piece_of(b, side);
        side = next;
    } while (side != first);
    assert(*piece != DT_NONE);
    *piece = dt_piece_find(b->parent, *piece);
    return n;
}

/* Cuts a walk into loops: the sides since a knot was passed before are one, and the walk continues without them. */
static void cut_walk(struct dt_bands *b, size_t n, uint32_t piece)
{
    size_t top = 0;
    for (size_t i = 0; i < n; i++) {
        uint32_t side = b->walk[i], knot = b->knot[side];
        if (knot > 0 && b->at[knot - 1] != DT_NONE) {
            size_t from = b->at[knot - 1];
            take_loop(b, from, top, piece);
            for (; top > from; top--)
                if (b->knot[b->walk[top - 1]] > 0)
                    b->at[b->knot[b->walk[top - 1]] - 1] = DT_NONE;
        }
        if (knot > 0)
            b->at[knot - 1] = (uint32_t)top;
        b->walk[top++] = side;
    }
    take_loop(b, 0, top, piece);
    for (; top > 0; top--)
        if (b->knot[b->walk[top - 1]] > 0)
            b->at[b->knot[b->walk[top - 1]] - 1] = DT_NONE;
}

static void take_walks(struct dt_bands *b, struct dt_stop *stop)
{
    struct dt_piece p = dt_pieces(0, (uint32_t)sides_of(b));
    while (dt_next_piece_of(stop, DT_POLL_MISSES, &p))
        for (uint32_t i = p.a; i < p.b; i++) {
            uint32_t piece = DT_NONE;
            if (b->next[i] == DT_NONE || !dt_is_band(b, class_of(b, i)))
                continue;
            size_t n = read_walk(b, i, &piece);
            cut_walk(b, n, piece);
        }
}

static bool reserve(struct dt_bands *b)
{
    size_t sides = sides_of(b) + 1;
    b->slots = dt_edge_slots(b->crossings);
    b->tie_slots = dt_edge_slots(b->ties);
    b->slot = malloc(b->slots * sizeof *b->slot);
    b->tie_slot = malloc(b->tie_slots * sizeof *b->tie_slot);
    b->next = malloc(sides * sizeof *b->next);
    b->knot = calloc(sides, sizeof *b->knot);
    b->walk = malloc(sides * sizeof *b->walk);
    b->at = malloc((b->ends / 4 + 1) * sizeof *b->at); /* a knot has four ends or more */
    b->place = malloc(sides * sizeof *b->place);
    b->loop = malloc((sides / 2 + 1) * sizeof *b->loop); /* each has two sides or more */
    if (b->slot == NULL || b->tie_slot == NULL || b->next == NULL || b->knot == NULL ||
        b->walk == NULL || b->at == NULL || b->place == NULL || b->loop == NULL)
        return false;
    memset(b->slot, 0xff, b->slots * sizeof *b->slot);
    memset(b->tie_slot, 0xff, b->tie_slots * sizeof *b->tie_slot);
    memset(b->next, 0xff, sides * sizeof *b->next);
    memset(b->at, 0xff, (b->ends / 4 + 1) * sizeof *b->at);
    return true;
}

enum dt_status dt_bands_join(struct dt_bands *b, struct dt_stop *stop)
{
    if (!reserve(b))
        return DT_NOMEM;
    join_edges(b, stop);
    if (!dt_stopped(stop))
        unite_ties(b, stop);
    if (!dt_stopped(stop))
        join_vertices(b, stop);
    if (!dt_stopped(stop))
        take_walks(b, stop);
    return dt_stop_status(stop);
}
