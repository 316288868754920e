/* contour.c - contours of the linear surface.
 *
 * The classes of the corners (reading.h) say which levels cross a triangle; each has a crossing in it:
 *
 *                above                 `in` is the edge that goes down, counterclockwise as seen from the
 *               /     \                triangle, and `out` the one that goes up; both are named by their ids. A
 *         in  /  - - -> \  out         line leaves a triangle and enters the next one by the same name, so
 *           /             \            crossings are joined without the triangulation.
 *       below ----------- below
 *
 * If an edit changes the mesh before all triangles are read, the crossings are dropped, and all are read again. */
#include "core/contours/reading.h"
#include "core/exact/predicates.h"

#include <stdlib.h>
#include <string.h>

enum { NEW = 8192 }; /* crossings of a piece */

struct crossing {
    uint32_t level; /* its number */
    struct dt_edge in, out;
    struct dt_point from, to;
    uint32_t next; /* the crossing of the next triangle, DT_NONE: the line ends */
    bool follows;  /* there is one before */
    bool taken;    /* by a line */
};

enum stage { VALUES, TRIANGLES, READ };

struct dt_contour {
    struct dt_reading read; /* owns */
    enum stage stage;
    uint32_t sub;              /* the first level of the next triangle that is not read */
    struct crossing *crossing; /* owns cap */
    size_t n, cap, most;       /* `most`: of this piece */
    uint32_t *slot;            /* owns slots: crossings by `in`, DT_NONE: none */
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
    dt_reading_clear(&c->read);
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
    struct dt_contour *c = *out = calloc(1, sizeof *c);
    if (c == NULL)
        return DT_NOMEM;
    enum dt_status s = dt_reading_begin(&c->read, t, v, f, level, levels, max_edge);
    if (s != DT_OK) {
        dt_contour_free(c);
        *out = NULL;
    }
    return s;
}

enum dt_status dt_contour_inside(struct dt_contour *c, const struct dt *t, uint32_t number)
{
    return dt_pass_inside(&c->read.pass, t, number);
}

/* ---- crossings ---- */

static struct crossing crossing_of(const struct dt_contour *c, const struct dt_corner corner[3],
                                   uint32_t level)
{
    double at = c->read.level[level];
    struct crossing r = {.level = level, .next = DT_NONE};
    for (int k = 0; k < 3; k++) {
        const struct dt_corner *a = &corner[k], *b = &corner[(k + 1) % 3];
        if (a->z >= at && b->z < at) {
            r.in = dt_edge_of(a->id, b->id);
            r.from = dt_level_place(a, b, at);
        } else if (a->z < at && b->z >= at) {
            r.out = dt_edge_of(a->id, b->id);
            r.to = dt_level_place(b, a, at);
        }
    }
    return r;
}

/* Adds the crossings of a triangle, from the level c->sub on and while there are fewer than c->most. *whole: all of
 * them. */
static enum dt_status cross(void *ctx, const struct dt *t, const uint32_t id[3], bool *whole)
{
    struct dt_contour *c = ctx;
    struct dt_corner corner[3];
    uint32_t first, end;
    dt_classes_between(&c->read, id, &first, &end);
    if (first == end || end == DT_CLASS)
        return DT_OK;
    enum dt_status s = dt_reading_corners(t, &c->read, id, corner, 3);
    if (s != DT_OK || !dt_reading_is_short(&c->read, corner))
        return s;
    uint32_t level = c->sub > first ? c->sub : first;
    while (level < end && c->n < c->most)
        c->crossing[c->n++] = crossing_of(c, corner, level++);
    *whole = level >= end;
    c->sub = *whole ? 0 : level;
    return DT_OK;
}

static enum dt_status make_room(struct dt_contour *c)
{
    c->most = c->n + NEW;
    return c->most < DT_NONE ? dt_items_reserve(&c->crossing, c->most, &c->cap, sizeof *c->crossing)
                             : DT_NOMEM;
}

static enum dt_status read_triangles(const struct dt *t, struct dt_contour *c)
{
    bool all = false;
    enum dt_status s = make_room(c);
    if (s == DT_OK)
        s = dt_reading_visit(t, &c->read, cross, c, &all);
    if (all)
        c->stage = READ;
    return s;
}

enum dt_status dt_contour_read(const struct dt *t, struct dt_contour *c, bool *done)
{
    enum dt_status s = dt_pass_check(&c->read.pass, t);
    if (s == DT_OK && c->stage == TRIANGLES && dt_pass_is_late(&c->read.pass, t))
        c->n = c->sub = 0;
    if (s == DT_OK && c->stage == TRIANGLES)
        s = read_triangles(t, c);
    else if (s == DT_OK && c->stage == VALUES && dt_reading_classes(&c->read))
        c->stage = TRIANGLES;
    *done = s == DT_OK && c->stage == READ;
    return s;
}

size_t dt_contour_memory(const struct dt_contour *c)
{
    bool grows = c->stage == TRIANGLES;
    size_t cap = c->cap + (grows ? c->cap / 2 + NEW : 0);
    size_t end = c->stage == READ
                     ? dt_edge_slots(c->n) * sizeof *c->slot +
                           c->n * (sizeof *c->line + 2 * sizeof *c->place + sizeof *c->result)
                     : 0;
    return sizeof *c + c->read.levels * sizeof *c->read.level +
           c->read.ids * sizeof *c->read.class + cap * sizeof *c->crossing + end;
}

/* ---- lines ---- */

/* The slot of the crossing of this level that enters by the edge, or the free slot where it belongs. */
static size_t slot_of(const struct dt_contour *c, uint32_t level, struct dt_edge in)
{
    size_t i = dt_edge_hash(level, in) & (c->slots - 1);
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
    struct dt_contour_line line = {.level = c->read.level[first->level], .p = place};
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
    c->slots = dt_edge_slots(c->n);
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
