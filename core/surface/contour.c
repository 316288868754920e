/* contour.c - contours of the linear surface.
 *
 * First the class of every point is computed, the number of levels below its value: then most triangles, whose corners
 * have the same class, cost three look-ups. The others have a crossing for each level between their corners' classes:
 *
 *                above                 `in` is the edge that goes down, counterclockwise as seen from the
 *               /     \                triangle, and `out` the one that goes up; both are named by their ids. A
 *         in  /  - - -> \  out         line leaves a triangle and enters the next one by the same name, so
 *           /             \            crossings are joined without the triangulation.
 *       below ----------- below
 *
 * All is read in pieces, as of the moment of a view. The result does not depend on the order of the triangles, so they
 * are read as they lie in memory, until an edit changes the mesh: then the crossings are dropped, and all triangles are
 * read through a table, which continues with those of the view. */
#include "core/exact/predicates.h"
#include "core/memory/memory.h"
#include "core/mesh/fixed.h"
#include "core/query/query.h"
#include "core/set/view_rows.h"

#include "core/delaunay_surface.h"

#include <stdlib.h>
#include <string.h>

enum {
    PIECE = 4096,    /* triangles of the table */
    RECORDS = 16384, /* values, or triangles as they lie in memory */
    NEW = 8192       /* crossings of a piece */
};

#define MISSING UINT32_MAX /* the class of a point without a value */

struct edge {
    uint32_t lo, hi; /* ids */
};

struct crossing {
    uint32_t level; /* its number */
    struct edge in, out;
    struct dt_point from, to;
    uint32_t next; /* the crossing of the next triangle, DT_NONE: the line ends */
    bool follows;  /* there is one before */
    bool taken;    /* by a line */
};

enum stage { VALUES, MESH, TABLE, READ };

struct dt_contour {
    const struct dt_view *view;   /* borrows */
    const struct dt_field *field; /* borrows */
    double *level;                /* owns */
    uint32_t levels;
    double max_edge;
    bool inside; /* lines end at borders */
    struct dt_enclosure enclosure;
    enum stage stage;
    uint32_t *class; /* owns ids */
    uint32_t ids, from;
    uint32_t record; /* the next one of the mesh */
    struct dt_cursor cursor;
    uint32_t triangle
        [3 *
         PIECE]; /* that have been read, up to `end`, and `at` is next: from the level `sub` on */
    size_t at, end;
    uint32_t sub;
    struct crossing *crossing; /* owns cap */
    size_t n, cap;
    uint32_t *slot; /* owns slots: crossings by `in`, DT_NONE: none */
    size_t slots;
    const struct crossing **line; /* owns: the first crossing of each line */
    size_t lines;
    struct dt_point *place;         /* owns */
    struct dt_contour_line *result; /* owns */
};

void dt_contour_free(struct dt_contour *c)
{
    if (c == NULL)
        return;
    free(c->level);
    free(c->class);
    free(c->crossing);
    free(c->slot);
    free(c->line);
    free(c->place);
    free(c->result);
    free(c);
}

enum dt_status dt_contour_begin(const struct dt *t, const struct dt_view *v,
                                const struct dt_field *f, const double *level, uint32_t levels,
                                double max_edge, struct dt_contour **out)
{
    *out = NULL;
    enum dt_status s = dt_view_readable(t, v, true);
    if (s != DT_OK)
        return s;
    struct dt_contour *c = calloc(1, sizeof *c);
    if (c == NULL)
        return DT_NOMEM;
    c->view = v;
    c->field = f;
    c->levels = levels;
    c->max_edge = max_edge;
    c->ids = v == NULL ? t->points.next_id : dt_view_next_id(v);
    c->level = malloc(levels * sizeof *level + 1);
    c->class = malloc(c->ids * sizeof *c->class + 1);
    s = c->level == NULL || c->class == NULL ? DT_NOMEM : DT_OK;
    if (s == DT_OK)
        s = dt_table_begin(t, v, DT_TRIANGLES, false, &c->cursor);
    if (s != DT_OK) {
        dt_contour_free(c);
        return s;
    }
    if (levels > 0)
        memcpy(c->level, level, levels * sizeof *level);
    *out = c;
    return DT_OK;
}

enum dt_status dt_contour_inside(struct dt_contour *c, const struct dt *t, uint32_t number)
{
    if (dt_view_if_changed(t, c->view) != NULL)
        return DT_UNSURVEYED;
    c->inside = true;
    return dt_enclosure_of(t, number, &c->enclosure);
}

/* ---- classes ---- */

static uint32_t class_of(const struct dt_contour *c, double z)
{
    uint32_t a = 0, b = c->levels;
    if (isnan(z))
        return MISSING;
    while (a < b) {
        uint32_t middle = a + (b - a) / 2;
        if (c->level[middle] <= z)
            a = middle + 1;
        else
            b = middle;
    }
    return a;
}

static void read_values(struct dt_contour *c)
{
    uint32_t end = c->ids - c->from < RECORDS ? c->ids : c->from + RECORDS;
    while (c->from < end) {
        uint64_t at = c->from;
        const double *page = dt_field_page(c->field, c->view, &at);
        while (c->from < end && (page == NULL || c->from < at))
            c->class[c->from++] = MISSING;
        for (uint32_t i = 0; c->from < end && i < DT_FIELD_PAGE; i++)
            c->class[c->from++] = class_of(c, page[i]);
    }
    if (c->from == c->ids)
        c->stage = MESH;
}

/* ---- crossings ---- */

struct corner {
    uint32_t id;
    struct dt_point p;
    double z;
};

static double between(double a, double b, double share)
{
    double x = a + (b - a) * share, lo = a < b ? a : b, hi = a < b ? b : a;
    return x < lo ? lo : x > hi ? hi : x;
}

/* Where the level is on an edge, from its higher end. In each step rounding is monotone, so higher levels are not nearer
 * to the lower end. */
static struct dt_point place_of(const struct corner *higher, const struct corner *lower,
                                double level)
{
    double fall = higher->z - lower->z, share = (higher->z - level) / fall;
    if (isinf(fall))
        share = (higher->z / 2 - level / 2) / (higher->z / 2 - lower->z / 2);
    return (struct dt_point){between(higher->p.x, lower->p.x, share),
                             between(higher->p.y, lower->p.y, share)};
}

static enum dt_status read_corners(const struct dt *t, const struct dt_contour *c,
                                   const uint32_t *id, struct corner corner[3])
{
    double z[3];
    enum dt_status s = DT_OK;
    dt_field_values(c->field, c->view, id, 3, z);
    for (int k = 0; k < 3 && s == DT_OK; k++) {
        corner[k].id = id[k];
        corner[k].z = z[k];
        s = dt_view_get(t, c->view, id[k], &corner[k].p);
    }
    return s;
}

static bool has_surface(const struct dt_contour *c, const struct corner corner[3])
{
    for (int k = 0; c->max_edge < HUGE_VAL && k < 3; k++)
        if (dt_compare_radius(corner[k].p, corner[(k + 1) % 3].p, c->max_edge) > 0)
            return false;
    return true;
}

static struct edge edge_of(uint32_t a, uint32_t b)
{
    return a < b ? (struct edge){a, b} : (struct edge){b, a};
}

static struct crossing crossing_of(const struct dt_contour *c, const struct corner corner[3],
                                   uint32_t level)
{
    double at = c->level[level];
    struct crossing r = {.level = level, .next = DT_NONE};
    for (int k = 0; k < 3; k++) {
        const struct corner *a = &corner[k], *b = &corner[(k + 1) % 3];
        if (a->z >= at && b->z < at) {
            r.in = edge_of(a->id, b->id);
            r.from = place_of(a, b, at);
        } else if (a->z < at && b->z >= at) {
            r.out = edge_of(a->id, b->id);
            r.to = place_of(b, a, at);
        }
    }
    return r;
}

/* The levels first .. end - 1 are between the corners of the triangle. */
static void levels_between(const struct dt_contour *c, const uint32_t *id, uint32_t *first,
                           uint32_t *end)
{
    uint32_t a = c->class[id[0]], b = c->class[id[1]], d = c->class[id[2]];
    *first = a < b ? a : b;
    *first = d < *first ? d : *first;
    *end = a > b ? a : b;
    *end = d > *end ? d : *end;
    if (*end == MISSING)
        *end = *first;
}

/* Adds the crossings of a triangle, from the level c->sub on and while there are fewer than `most`. *whole: all of
 * them. */
static enum dt_status cross(const struct dt *t, struct dt_contour *c, const uint32_t *id,
                            size_t most, bool *whole)
{
    struct corner corner[3];
    uint32_t first, end;
    levels_between(c, id, &first, &end);
    *whole = true;
    if (first >= end)
        return DT_OK;
    enum dt_status s = read_corners(t, c, id, corner);
    if (s != DT_OK || !has_surface(c, corner))
        return s;
    uint32_t level = c->sub > first ? c->sub : first;
    while (level < end && c->n < most)
        c->crossing[c->n++] = crossing_of(c, corner, level++);
    *whole = level >= end;
    c->sub = *whole ? 0 : level;
    return DT_OK;
}

static enum dt_status make_room(struct dt_contour *c)
{
    if (c->cap - c->n >= NEW)
        return DT_OK;
    size_t cap = c->cap + c->cap / 2 + NEW;
    struct crossing *more = cap < DT_NONE ? realloc(c->crossing, cap * sizeof *more) : NULL;
    if (more == NULL)
        return DT_NOMEM;
    c->crossing = more;
    c->cap = cap;
    return DT_OK;
}

/* Whether a triangle, not a dead one, is inside the borders at which lines end. */
static bool has_lines(const struct dt_contour *c, const struct dt_mesh *m, uint32_t record)
{
    return !c->inside || dt_encloses(&c->enclosure, dt_face(m, 8 * record));
}

static enum dt_status read_mesh(const struct dt *t, struct dt_contour *c)
{
    const struct dt_mesh *m = &t->mesh;
    size_t most = c->n + NEW;
    uint32_t end = m->tri_end - c->record < RECORDS ? m->tri_end : c->record + RECORDS;
    enum dt_status s = make_room(c);
    while (s == DT_OK && c->record < end && c->n < most) {
        const uint32_t *v = m->half + 8 * (size_t)c->record;
        bool whole = true;
        if (v[2] < DT_DEAD && has_lines(c, m, c->record)) { /* no ghost either */
            const uint32_t *id = t->points.id;
            s = cross(t, c, (const uint32_t[]){id[v[0]], id[v[1]], id[v[2]]}, most, &whole);
        }
        c->record += whole;
    }
    if (s == DT_OK && c->record == m->tri_end)
        c->stage = READ;
    return s;
}

static enum dt_status read_table(const struct dt *t, struct dt_contour *c)
{
    size_t rows = 1, most = c->n + NEW;
    enum dt_status s = make_room(c);
    if (s == DT_OK && c->at == c->end) {
        s = dt_table_read(t, &c->cursor, c->triangle, 3 * PIECE, PIECE, &rows, &c->end);
        c->at = 0;
        if (s == DT_TOOLONG) /* the next call goes on */
            return DT_OK;
    }
    while (s == DT_OK && c->at < c->end && c->n < most) {
        bool whole;
        s = cross(t, c, &c->triangle[c->at], most, &whole);
        c->at += whole ? 3 : 0;
    }
    if (s == DT_OK && rows == 0)
        c->stage = READ;
    return s;
}

enum dt_status dt_contour_read(const struct dt *t, struct dt_contour *c, bool *done)
{
    enum dt_status s = dt_view_readable(t, c->view, true);
    if (s == DT_OK && c->inside && dt_view_if_changed(t, c->view) != NULL)
        return DT_UNSURVEYED;
    if (c->stage == MESH && s == DT_OK && dt_view_if_changed(t, c->view) != NULL) {
        c->stage = TABLE;
        c->n = c->sub = 0;
    }
    if (s == DT_OK && c->stage == VALUES)
        read_values(c);
    else if (s == DT_OK && c->stage != READ)
        s = c->stage == MESH ? read_mesh(t, c) : read_table(t, c);
    *done = s == DT_OK && c->stage == READ;
    return s;
}

static size_t slots_for(size_t n)
{
    size_t slots = 16;
    while (slots < 2 * n)
        slots *= 2;
    return slots;
}

size_t dt_contour_memory(const struct dt_contour *c)
{
    bool grows = c->stage == MESH || c->stage == TABLE;
    size_t cap = c->cap + (grows ? c->cap / 2 + NEW : 0);
    size_t end = c->stage == READ
                     ? slots_for(c->n) * sizeof *c->slot +
                           c->n * (sizeof *c->line + 2 * sizeof *c->place + sizeof *c->result)
                     : 0;
    return sizeof *c + c->levels * sizeof *c->level + c->ids * sizeof *c->class +
           cap * sizeof *c->crossing + end;
}

/* ---- lines ---- */

static size_t hash(uint32_t level, struct edge e)
{
    uint64_t h = (uint64_t)e.lo * 0x9e3779b97f4a7c15u ^ e.hi;
    h = (h ^ h >> 29) * 0xbf58476d1ce4e5b9u ^ level;
    h *= 0x94d049bb133111ebu;
    return (size_t)(h >> 32 ^ h);
}

/* The slot of the crossing of this level that enters by the edge, or the free slot where it belongs. */
static size_t slot_of(const struct dt_contour *c, uint32_t level, struct edge in)
{
    size_t i = hash(level, in) & (c->slots - 1);
    while (c->slot[i] != DT_NONE) {
        const struct crossing *k = &c->crossing[c->slot[i]];
        if (k->level == level && k->in.lo == in.lo && k->in.hi == in.hi)
            break;
        i = (i + 1) & (c->slots - 1);
    }
    return i;
}

static void join(struct dt_contour *c, struct dt_stop *stop)
{
    struct dt_piece p = dt_pieces(0, (uint32_t)c->n);
    memset(c->slot, 0xff, c->slots * sizeof *c->slot);
    while (dt_next_piece_of(stop, DT_POLL_MISSES, &p))
        for (uint32_t i = p.a; i < p.b; i++)
            c->slot[slot_of(c, c->crossing[i].level, c->crossing[i].in)] = i;
    p = dt_pieces(0, (uint32_t)c->n);
    while (dt_next_piece_of(stop, DT_POLL_MISSES, &p))
        for (uint32_t i = p.a; i < p.b; i++) {
            uint32_t next = c->slot[slot_of(c, c->crossing[i].level, c->crossing[i].out)];
            c->crossing[i].next = next;
            if (next != DT_NONE)
                c->crossing[next].follows = true;
        }
}

/* By the levels, then by the edges on which they begin. */
static int compare_crossings(const struct crossing *a, const struct crossing *b)
{
    if (a->level != b->level)
        return a->level < b->level ? -1 : 1;
    if (a->in.lo != b->in.lo)
        return a->in.lo < b->in.lo ? -1 : 1;
    return (a->in.hi > b->in.hi) - (a->in.hi < b->in.hi);
}

static int compare_lines(const void *a, const void *b)
{
    return compare_crossings(*(const struct crossing *const *)a,
                             *(const struct crossing *const *)b);
}

/* Takes the line of a crossing: of an open one, the first. A closed one begins at its least crossing. */
static void take_line(struct dt_contour *c, uint32_t first)
{
    const struct crossing *least = &c->crossing[first];
    uint32_t i = first;
    do {
        struct crossing *k = &c->crossing[i];
        if (compare_crossings(k, least) < 0)
            least = k;
        k->taken = true;
        i = k->next;
    } while (i != DT_NONE && i != first);
    c->line[c->lines++] = i == DT_NONE ? &c->crossing[first] : least;
}

static void take_lines(struct dt_contour *c, bool open, struct dt_stop *stop)
{
    struct dt_piece p = dt_pieces(0, (uint32_t)c->n);
    while (dt_next_piece_of(stop, DT_POLL_MISSES, &p))
        for (uint32_t i = p.a; i < p.b; i++)
            if (!c->crossing[i].taken && !(open && c->crossing[i].follows))
                take_line(c, i);
}

/* Appends a place to a line, unless it is equal to the one before. */
static void append(struct dt_contour_line *line, struct dt_point p)
{
    if (line->n == 0 || dt_compare_xy(line->p[line->n - 1], p) != 0)
        line->p[line->n++] = p;
}

/* The places of the line that begins at a crossing, from `place` on. */
static struct dt_contour_line trace(const struct dt_contour *c, const struct crossing *first,
                                    struct dt_point *place)
{
    struct dt_contour_line line = {.level = c->level[first->level], .p = place};
    const struct crossing *k = first;
    append(&line, k->from);
    while (k->next != DT_NONE && &c->crossing[k->next] != first) {
        k = &c->crossing[k->next];
        append(&line, k->from);
    }
    line.closed = k->next != DT_NONE;
    if (!line.closed)
        append(&line, k->to);
    while (line.closed && line.n > 1 && dt_compare_xy(line.p[0], line.p[line.n - 1]) == 0)
        line.n--;
    return line;
}

static size_t trace_all(struct dt_contour *c, struct dt_stop *stop)
{
    struct dt_point *place = c->place;
    struct dt_piece p = dt_pieces(0, (uint32_t)c->lines);
    size_t lines = 0;
    while (dt_next_piece_of(stop, DT_POLL_MISSES, &p))
        for (uint32_t i = p.a; i < p.b; i++) {
            struct dt_contour_line line = trace(c, c->line[i], place);
            if (line.n < (line.closed ? 3 : 2))
                continue;
            c->result[lines++] = line;
            place += line.n;
        }
    return lines;
}

enum dt_status dt_contour_end(struct dt_contour *c, const struct dt_options *opt,
                              const struct dt_contour_line **line, size_t *lines)
{
    struct dt_stop stop = dt_stop_of(opt);
    *line = NULL;
    *lines = 0;
    c->slots = slots_for(c->n);
    c->slot = malloc(c->slots * sizeof *c->slot);
    c->line = malloc(c->n * sizeof *c->line + 1);
    c->place = malloc(2 * c->n * sizeof *c->place + 1);
    c->result = malloc(c->n * sizeof *c->result + 1);
    if (c->slot == NULL || c->line == NULL || c->place == NULL || c->result == NULL)
        return DT_NOMEM;
    join(c, &stop);
    if (!dt_stopped(&stop))
        take_lines(c, true, &stop);
    if (!dt_stopped(&stop))
        take_lines(c, false, &stop);
    if (!dt_stopped(&stop))
        qsort(c->line, c->lines, sizeof *c->line, compare_lines);
    size_t n = dt_stopped(&stop) ? 0 : trace_all(c, &stop);
    if (dt_stopped(&stop))
        return dt_stop_status(&stop);
    *line = c->result;
    *lines = n;
    return DT_OK;
}
