/* bands.c - reads what the bands of a linear surface consist of.
 *
 * A band is the part of the surface between two neighbouring levels. In a triangle it has one piece. The boundary of a
 * band consists of sides: lines of the lower level, lines of the upper level in reverse, and parts of the surface's border.
 *
 *                 upper level               The pieces of a band are connected by the edges that they share. Each
 *               / <- - - - \                polygon is one connected part. It has several rings if it has holes; so
 *              /   piece    \               pieces are united in a forest while triangles are read, and rings
 *             / - - - - - -> \              with the same root belong together.
 *                lower level
 *
 * A point of the band connects all pieces around it, so the point itself is their root and a triangle of
 * three points costs two unions. That is wrong for two kinds of points, which are marked (DT_CLASS_MARK).
 * At a point whose value is a level, two parts of a band may only touch. At a corner of a triangle that the surface
 * lacks, two parts of the surface may only touch. Pieces at marked points are connected by their edges instead:
 * either a crossing joins them (bands_join.c), or both ends of the edge are marked, and a tie names it.
 *
 * So no coordinate is compared, except to sort the sides around a marked point. */
#include "core/contours/bands.h"

#include "core/exact/predicates.h"
#include "core/set/view.h"
#include "core/set/view_stars.h"

#include <stdlib.h>

enum {
    NEW = 8192,       /* crossings of a piece of reading, or parts of the border */
    MOST_STARS = 4096 /* of a piece */
};

/* ---- begin and end ---- */

void dt_bands_free(struct dt_bands *b)
{
    if (b == NULL)
        return;
    dt_reading_clear(&b->read);
    void *owned[] = {b->border, b->crossing, b->end,  b->tie, b->parent, b->next, b->knot,
                     b->slot,   b->tie_slot, b->walk, b->at,  b->place,  b->loop, b->ring};
    for (size_t i = 0; i < sizeof owned / sizeof *owned; i++)
        free(owned[i]);
    free(b);
}

enum dt_status dt_bands_begin(const struct dt *t, const struct dt_view *v, const struct dt_field *f,
                              const double *level, uint32_t levels, double max_edge,
                              struct dt_bands **out)
{
    struct dt_bands *b = *out = calloc(1, sizeof *b);
    if (b == NULL)
        return DT_NOMEM;
    enum dt_status s = dt_reading_begin(&b->read, t, v, f, level, levels, max_edge);
    if (s == DT_OK) {
        b->pieces = b->piece_cap = b->read.ids;
        b->parent = malloc(b->piece_cap * sizeof *b->parent + 1);
        s = b->parent == NULL ? DT_NOMEM : DT_OK;
    }
    if (s != DT_OK) {
        dt_bands_free(b);
        *out = NULL;
    }
    return s;
}

enum dt_status dt_bands_inside(struct dt_bands *b, const struct dt *t, uint32_t number)
{
    return dt_pass_inside(&b->read.pass, t, number);
}

/* The most that a triangle, or an edge of the border, adds to an array. */
static size_t at_once(const struct dt_bands *b)
{
    return (size_t)b->read.levels + 4;
}

/* The room that it has at most after make_room. */
static size_t cap_for(const struct dt_bands *b, size_t n, size_t cap)
{
    return n + NEW + at_once(b) <= cap ? cap : cap + cap / 2 + NEW + at_once(b);
}

/* Makes room for NEW more, and for those that a triangle adds. */
static bool grow(const struct dt_bands *b, void *array, size_t n, size_t *cap, size_t size)
{
    size_t need = n + NEW + at_once(b);
    return need < DT_NONE / 4 && dt_items_reserve(array, need, cap, size) == DT_OK;
}

static enum dt_status make_room(struct dt_bands *b)
{
    return grow(b, &b->border, b->borders, &b->border_cap, sizeof *b->border) &&
                   grow(b, &b->crossing, b->crossings, &b->crossing_cap, sizeof *b->crossing) &&
                   grow(b, &b->end, b->ends, &b->end_cap, sizeof *b->end) &&
                   grow(b, &b->tie, b->ties, &b->tie_cap, sizeof *b->tie) &&
                   grow(b, &b->parent, b->pieces, &b->piece_cap, sizeof *b->parent)
               ? DT_OK
               : DT_NOMEM;
}

static bool fits(const struct dt_bands *b)
{
    size_t n = at_once(b);
    return b->borders + n <= b->border_cap && b->crossings + n <= b->crossing_cap &&
           b->ends + n <= b->end_cap && b->ties + n <= b->tie_cap && b->pieces + n <= b->piece_cap;
}

static bool has_room(const struct dt_bands *b)
{
    return b->crossings + b->borders < b->most && fits(b);
}

size_t dt_bands_memory(const struct dt_bands *b)
{
    size_t arrays = b->border_cap * sizeof *b->border + b->crossing_cap * sizeof *b->crossing +
                    b->end_cap * sizeof *b->end + b->tie_cap * sizeof *b->tie +
                    b->piece_cap * sizeof *b->parent;
    size_t more = cap_for(b, b->borders, b->border_cap) * sizeof *b->border +
                  cap_for(b, b->crossings, b->crossing_cap) * sizeof *b->crossing +
                  cap_for(b, b->ends, b->end_cap) * sizeof *b->end +
                  cap_for(b, b->ties, b->tie_cap) * sizeof *b->tie +
                  cap_for(b, b->pieces, b->piece_cap) * sizeof *b->parent;
    return sizeof *b + b->read.levels * sizeof *b->read.level +
           b->read.ids * sizeof *b->read.class +
           (b->stage == DT_BANDS_READ ? arrays + dt_bands_join_memory(b) : more);
}

/* ---- sides ---- */

static void put_end(struct dt_bands *b, const struct dt_corner *at, uint32_t class, uint32_t side,
                    bool begins, const struct dt_corner *toward, bool beside)
{
    if (dt_is_band(b, class))
        b->end[b->ends++] =
            (struct dt_band_end){at->id, class, side, begins, beside, at->p, toward->p};
}

/* Adds the part of a border edge that begins and ends at these levels; DT_NONE: at its corners. */
static void put_part(struct dt_bands *b, const struct dt_corner *p, const struct dt_corner *q,
                     uint32_t class, uint32_t start, uint32_t end, struct dt_point from)
{
    uint32_t side = (uint32_t)b->borders;
    if (!dt_is_band(b, class))
        return;
    b->border[b->borders++] = (struct dt_band_border){class, p->id, q->id, start, end, from};
    if (start == DT_NONE)
        put_end(b, p, class, side, true, q, false);
    if (end == DT_NONE)
        put_end(b, q, class, side, false, p, false);
}

/* Adds the parts of an edge that the surface has on its left only. Parts of no length, beyond a corner whose value is a level,
 * are left out. */
static void put_border(struct dt_bands *b, const struct dt_corner *p, const struct dt_corner *q)
{
    bool rises = p->class < q->class;
    uint32_t start = DT_NONE;
    struct dt_point from = p->p;
    for (uint32_t class = p->class; class != q->class; class += rises ? 1 : UINT32_MAX) {
        uint32_t level = rises ? class : class - 1;
        double z = b->read.level[level];
        if (rises && q->z == z) {
            put_part(b, p, q, class, start, DT_NONE, from);
            return;
        }
        if (!rises && p->z == z)
            continue;
        put_part(b, p, q, class, start, level, from);
        start = level;
        from = rises ? dt_level_place(q, p, z) : dt_level_place(p, q, z);
    }
    put_part(b, p, q, q->class, start, DT_NONE, from);
}

static void put_crossing(struct dt_bands *b, const struct dt_corner corner[3], uint32_t level,
                         uint32_t below, uint32_t above)
{
    double at = b->read.level[level];
    struct dt_band_crossing c = {.level = level, .above = above, .below = below};
    const struct dt_corner *in = NULL, *out = NULL; /* vertices on the line */
    for (int k = 0; k < 3; k++) {
        const struct dt_corner *p = &corner[k], *q = &corner[(k + 1) % 3];
        if (p->z >= at && q->z < at) {
            in = p->z == at ? p : NULL;
            c.in = in != NULL ? (struct dt_edge){p->id, p->id} : dt_edge_of(p->id, q->id);
            c.from = dt_level_place(p, q, at);
        } else if (p->z < at && q->z >= at) {
            out = q->z == at ? q : NULL;
            c.out = out != NULL ? (struct dt_edge){q->id, q->id} : dt_edge_of(p->id, q->id);
            c.to = dt_level_place(q, p, at);
        }
    }
    if (in != NULL && in == out) /* the line is a point */
        return;
    bool along = in != NULL && out != NULL;
    uint32_t up = dt_band_side(b, b->crossings, false), down = up + 1;
    for (int k = 0; k < 2; k++) {
        const struct dt_corner *v = k == 0 ? in : out;
        if (v == NULL)
            continue;
        const struct dt_corner *toward =
            along ? (k == 0 ? out : in) : &corner[(v - corner + 1) % 3];
        put_end(b, v, level + 1, up, k == 0, toward, !along);
        put_end(b, v, level, down, k == 1, toward, !along);
    }
    b->crossing[b->crossings++] = c;
}

/* ---- pieces ---- */

static uint32_t new_piece(struct dt_bands *b)
{
    uint32_t i = (uint32_t)b->pieces++;
    return b->parent[i] = i;
}

/* A triangle whose corners all have the class. */
static void take_plain(struct dt_bands *b, const uint32_t id[3])
{
    uint32_t *parent = b->parent, piece = DT_NONE;
    const uint32_t *class = b->read.class;
    if (((class[id[0]] | class[id[1]] | class[id[2]]) & DT_CLASS_MARK) == 0) {
        dt_piece_unite(parent, id[0], id[1]);
        dt_piece_unite(parent, id[1], id[2]);
        return;
    }
    for (int k = 0; k < 3; k++) {
        if ((class[id[k]] & DT_CLASS_MARK) != 0)
            continue;
        if (piece != DT_NONE)
            dt_piece_unite(parent, piece, id[k]);
        piece = id[k];
    }
    if (piece == DT_NONE)
        piece = new_piece(b);
    for (int k = 0; k < 3; k++) {
        uint32_t p = id[k], q = id[(k + 1) % 3];
        if ((class[p] & class[q] & DT_CLASS_MARK) != 0)
            b->tie[b->ties++] = (struct dt_band_tie){dt_edge_of(p, q), piece};
    }
}

/* Whether the piece of the class has the whole edge, whose ends are marked: from its lower level, or between, to its upper level,
 * or between. */
static bool has_edge(const struct dt_bands *b, const struct dt_corner *p, const struct dt_corner *q,
                     uint32_t class)
{
    const struct dt_corner *low = p->class < q->class ? p : q, *high = low == p ? q : p;
    return p->marked && q->marked && low->class == class &&
           (high->class == class || (high->class == class + 1 && high->z == b->read.level[class]));
}

/* The piece of the class in a triangle that levels cross; DT_NONE: there is none. A piece without area, a corner or an edge on the
 * level, connects nothing but the piece beyond the edge. */
static uint32_t take_piece(struct dt_bands *b, const struct dt_corner corner[3], uint32_t class)
{
    uint32_t piece = DT_NONE;
    if (!dt_is_band(b, class))
        return DT_NONE;
    for (int k = 0; k < 3; k++) {
        if (corner[k].class != class || corner[k].marked)
            continue;
        if (piece != DT_NONE)
            dt_piece_unite(b->parent, piece, corner[k].id);
        piece = corner[k].id;
    }
    if (piece == DT_NONE)
        piece = new_piece(b);
    for (int k = 0; k < 3; k++) {
        const struct dt_corner *p = &corner[k], *q = &corner[(k + 1) % 3];
        if (has_edge(b, p, q, class))
            b->tie[b->ties++] = (struct dt_band_tie){dt_edge_of(p->id, q->id), piece};
    }
    return piece;
}

/* ---- triangles ---- */

static enum dt_status take_crossed(struct dt_bands *b, const struct dt *t, const uint32_t id[3],
                                   uint32_t first, uint32_t end)
{
    struct dt_corner corner[3];
    uint32_t below = DT_NONE;
    enum dt_status s = dt_reading_corners(t, &b->read, id, corner, 3);
    if (s != DT_OK || !dt_reading_is_short(&b->read, corner))
        return s;
    for (uint32_t class = first; class <= end; class ++) {
        uint32_t piece = take_piece(b, corner, class);
        if (class > first)
            put_crossing(b, corner, class - 1, below, piece);
        below = piece;
    }
    return DT_OK;
}

static enum dt_status take(void *ctx, const struct dt *t, const uint32_t id[3], bool *whole)
{
    struct dt_bands *b = ctx;
    uint32_t first, end;
    dt_classes_between(&b->read, id, &first, &end);
    if (end == DT_CLASS || (first == end && !dt_is_band(b, first)))
        return DT_OK;
    *whole = has_room(b);
    if (!*whole)
        return DT_OK;
    if (first < end)
        return take_crossed(b, t, id, first, end);
    if (b->read.max_edge == HUGE_VAL || dt_reading_has_ids(t, &b->read, id))
        take_plain(b, id);
    return DT_OK;
}

/* ---- the border ---- */

static enum dt_status take_border(struct dt_bands *b, const struct dt *t, uint32_t p, uint32_t q)
{
    struct dt_corner corner[2];
    enum dt_status s = fits(b) ? DT_OK : make_room(b); /* a star may have many such edges */
    if (s == DT_OK)
        s = dt_reading_corners(t, &b->read, (const uint32_t[]){p, q}, corner, 2);
    if (s == DT_OK)
        put_border(b, &corner[0], &corner[1]);
    return s;
}

/* Takes the sides of a triangle that the surface lacks, or of a ghost, beyond which it has one. */
static enum dt_status take_gap(struct dt_bands *b, const struct dt *t, uint32_t record)
{
    const uint32_t *v = t->mesh.half + 8 * (size_t)record, *id = t->points.id;
    bool ghost = v[2] == DT_NONE;
    enum dt_status s = DT_OK;
    for (uint32_t k = 0; k < (ghost ? 1 : 3) && s == DT_OK; k++) {
        if (dt_reading_has(t, &b->read, v[4 + k] / 8))
            s = take_border(b, t, id[v[(k + 1) % 3]], id[v[k]]);
        if (!ghost)
            b->read.class[id[v[k]]] |= DT_CLASS_MARK;
    }
    return s;
}

static enum dt_status read_border(const struct dt *t, struct dt_bands *b, bool *done)
{
    const struct dt_mesh *m = &t->mesh;
    uint32_t end = m->tri_end - b->record < DT_READ_PIECE ? m->tri_end : b->record + DT_READ_PIECE;
    bool whole = dt_reading_is_whole(&b->read);
    enum dt_status s = DT_OK;
    while (s == DT_OK && b->record < end && has_room(b)) {
        uint32_t corner = m->half[8 * (size_t)b->record + 2];
        if (corner == DT_NONE ||
            (!whole && corner != DT_DEAD && !dt_reading_has(t, &b->read, b->record)))
            s = take_gap(b, t, b->record);
        b->record++;
    }
    *done = s == DT_OK && b->record == m->tri_end;
    return s;
}

/* The same from the star that a point had: the edges from the point to its neighbours. */
static enum dt_status take_star(struct dt_bands *b, const struct dt *t, uint32_t id,
                                const uint32_t *ring, size_t n, bool on_hull)
{
    bool first = !on_hull &&
                 dt_reading_has_ids(t, &b->read, (const uint32_t[]){id, ring[n - 1], ring[0]}),
         before = first;
    enum dt_status s = DT_OK;
    for (size_t i = 0; i < n && s == DT_OK; i++) {
        bool outside = i + 1 == n && on_hull, has = i + 1 == n && first;
        if (i + 1 < n)
            has = dt_reading_has_ids(t, &b->read, (const uint32_t[]){id, ring[i], ring[i + 1]});
        if (has && !before)
            s = take_border(b, t, id, ring[i]);
        if (!has && !outside)
            b->read.class[id] |= DT_CLASS_MARK;
        before = has;
    }
    return s;
}

static enum dt_status read_border_then(const struct dt *t, struct dt_bands *b, bool *done)
{
    const struct dt_view *v = b->read.pass.view;
    struct dt_neighbours around = {0};
    struct dt_stars stars;
    enum dt_status s = DT_OK;
    *done = v->line;
    for (uint32_t n = 0; s == DT_OK && !*done && n < MOST_STARS && has_room(b); n += stars.n) {
        dt_stars_read(t, v, b->record, b->read.ids, DT_STARS, &stars);
        *done = stars.n == 0;
        for (uint32_t i = 0; i < stars.n && s == DT_OK && has_room(b); i++) {
            uint32_t id = stars.id[i];
            if (stars.degree[i] != DT_NONE)
                s = take_star(b, t, id, stars.ring[i], stars.degree[i], stars.on_hull[i]);
            else if ((s = dt_neighbours_read(t, v, id, &around)) == DT_OK)
                s = take_star(b, t, id, around.ring.v, around.ring.n, around.on_hull);
            b->record = id + 1;
        }
    }
    free(around.ring.v);
    return s;
}

/* ---- reading ---- */

static void begin_again(struct dt_bands *b)
{
    b->stage = DT_BANDS_VALUES;
    b->read.from = b->record = 0;
    b->borders = b->crossings = b->ends = b->ties = 0;
    b->pieces = b->read.ids;
}

static bool read_values(struct dt_bands *b)
{
    uint32_t from = b->read.from;
    bool done = dt_reading_classes(&b->read);
    for (; from < b->read.from; from++)
        b->parent[from] = from;
    return done;
}

static enum dt_status read_piece(const struct dt *t, struct dt_bands *b, bool *done)
{
    if (b->stage == DT_BANDS_VALUES) {
        *done = read_values(b);
        return DT_OK;
    }
    enum dt_status s = make_room(b);
    if (s != DT_OK)
        return s;
    b->most = b->crossings + b->borders + NEW;
    if (b->stage == DT_BANDS_TRIANGLES)
        return dt_reading_visit(t, &b->read, take, b, done);
    return b->read.pass.tabled ? read_border_then(t, b, done) : read_border(t, b, done);
}

enum dt_status dt_bands_read(const struct dt *t, struct dt_bands *b, bool *done)
{
    bool stage_done = false;
    enum dt_status s = dt_pass_check(&b->read.pass, t);
    if (s == DT_OK && b->stage != DT_BANDS_READ && dt_pass_is_late(&b->read.pass, t))
        begin_again(b);
    if (s == DT_OK && b->stage != DT_BANDS_READ)
        s = read_piece(t, b, &stage_done);
    if (s == DT_OK && stage_done)
        b->stage++;
    *done = s == DT_OK && b->stage == DT_BANDS_READ;
    return s;
}

enum dt_status dt_bands_end(struct dt_bands *b, const struct dt_options *opt,
                            const struct dt_band_ring **ring, size_t *rings)
{
    struct dt_stop stop = dt_stop_of(opt);
    *ring = NULL;
    *rings = 0;
    enum dt_status s = dt_bands_join(b, &stop);
    if (s == DT_OK)
        s = dt_bands_sort(b, &stop);
    if (s != DT_OK)
        return s;
    *ring = b->ring;
    *rings = b->rings;
    return DT_OK;
}
