/* table.c - cursors over whole-set tables.
 *
 * Nothing is sorted as a whole: ids are visited in ascending order, and the rows that begin with an id are a
 * small part of its star. A cursor is before the row (id, sub): rows of lower ids are written, and of id itself
 * those whose second word is below sub. It ends before the id `end`; rows along the hull follow after that.
 *
 * `left` and `hull_left` are the rows still to come of either kind; 0 says that there are no more.
 * The number of rows of a part that was cut off is unknown: there `left` is an upper bound. */
#include "core/query/group.h"
#include "core/query/hull_walk.h"
#include "core/set/view_rows.h"
#include "core/set/view_stars.h"

#include <string.h>

/* Where rows go. */
struct sink {
    uint32_t *out;
    size_t cap, max_rows;  /* room: words and rows */
    size_t words, rows;    /* written */
    size_t need;           /* words of a point list's row for which there was no room */
    enum dt_status status; /* why there are no more rows: DT_NOMEM */
};

static bool has_room(const struct sink *k, size_t words)
{
    return k->rows < k->max_rows && words <= k->cap - k->words;
}

static uint32_t *row(struct sink *k, size_t words)
{
    uint32_t *at = k->out + k->words;
    k->words += words;
    k->rows++;
    return at;
}

static uint32_t count_rows(const struct dt_summary *sum, enum dt_table table)
{
    switch (table) {
    case DT_POINTS:
        return sum->points;
    case DT_COINCIDENT:
        return sum->coincident;
    case DT_LISTS:
        return sum->points - sum->coincident;
    case DT_TRIANGLES:
        return sum->triangles;
    case DT_EDGES:
        return sum->edges;
    case DT_HULL:
        return sum->hull;
    }
    return 0;
}

static bool needs_mesh(enum dt_table table)
{
    return table != DT_POINTS && table != DT_COINCIDENT;
}

enum dt_status dt_table_begin(const struct dt *t, const struct dt_view *v, enum dt_table table,
                              bool cw, struct dt_cursor *c)
{
    struct dt_summary sum;
    enum dt_status s = dt_view_readable(t, v, needs_mesh(table));
    if (s != DT_OK)
        return s;
    if (v != NULL)
        dt_view_summary(v, &sum);
    else
        dt_summary(t, &sum);
    *c = (struct dt_cursor){.table = table,
                            .cw = cw,
                            .rows = count_rows(&sum, table),
                            .view = v,
                            .end = v == NULL ? DT_NONE : dt_view_next_id(v),
                            .hull_at = DT_NONE,
                            .hull_before = DT_NONE};
    if (table == DT_LISTS || table == DT_HULL)
        c->hull_left = sum.hull;
    c->left = c->rows - c->hull_left;
    if (table == DT_LISTS)
        c->interior = c->left;
    return DT_OK;
}

bool dt_table_cut(const struct dt *t, struct dt_cursor *c, uint32_t ids, struct dt_cursor *part)
{
    *part = *c;
    if (c->left == 0) {
        c->hull_left = 0;
        return part->hull_left > 0;
    }
    uint32_t end = dt_view_ids_after(t, c->view, c->id, ids > 0 ? ids : 1);
    if (end >= c->end) {
        end = c->end;
        c->left = 0;
    }
    part->hull_left = 0;
    part->end = c->id = end;
    c->sub = 0;
    return true;
}

/* The next id, DT_NONE and nothing left if the cursor has come to its end. */
static uint32_t next_id(struct dt_view_ids *ids, struct dt_cursor *c)
{
    uint32_t id =
        ids->v == NULL ? dt_points_next_live(&ids->t->points, c->id) : dt_view_ids_next(ids, c->id);
    if (id < c->end)
        return id;
    c->left = 0;
    return DT_NONE;
}

/* A reader of the ids of all points asks for their coordinates next: those are prefetched. */
static void read_points(const struct dt *t, struct dt_cursor *c, struct sink *k)
{
    struct dt_view_ids ids = dt_view_ids_begin(t, c->view, c->id);
    while (c->left > 0 && has_room(k, 1)) {
        uint32_t id = next_id(&ids, c);
        if (id == DT_NONE)
            return;
        if (ids.v == NULL)
            dt_points_fetch(&t->points, id);
        *row(k, 1) = id;
        c->id = id + 1;
        c->left--;
    }
}

static void read_coincident(const struct dt *t, struct dt_cursor *c, struct sink *k)
{
    struct dt_view_ids ids = dt_view_ids_begin(t, c->view, c->id);
    while (c->left > 0 && has_room(k, 2)) {
        uint32_t id = next_id(&ids, c);
        if (id == DT_NONE)
            return;
        c->id = id + 1;
        uint32_t representative = dt_view_representative(t, ids.v, id);
        if (representative == id)
            continue;
        uint32_t *out = row(k, 2);
        out[0] = id;
        out[1] = representative;
        c->left--;
    }
}

/* The hull from the position of the cursor. Its first point is searched for when the first row is read and
 * not when the cursor is created, because that takes a walk along the whole hull. */
static struct dt_hull_walk hull_from(const struct dt *t, struct dt_cursor *c)
{
    if (c->hull_at == DT_NONE)
        c->hull_at = dt_hull_start(t, c->view, c->cw);
    return dt_hull_walk_at(t, c->view, c->cw, c->hull_at, c->hull_before);
}

static void hull_leave(const struct dt_hull_walk *w, struct dt_cursor *c)
{
    c->hull_at = w->id;
    c->hull_before = w->before;
}

static void read_hull(const struct dt *t, struct dt_cursor *c, struct sink *k)
{
    if (c->hull_left == 0)
        return;
    struct dt_hull_walk w = hull_from(t, c);
    for (; c->hull_left > 0 && has_room(k, 1); c->hull_left--) {
        *row(k, 1) = w.id;
        dt_hull_walk_step(&w);
    }
    hull_leave(&w, c);
}

/* Where the ring of a point list's row goes, of this degree or less; NULL: there is no room for the row. */
static uint32_t *list_ring(struct sink *k, uint32_t degree)
{
    if (has_room(k, 2 + (size_t)degree))
        return k->out + k->words + 2;
    k->need = 2 + (size_t)degree;
    return NULL;
}

static void end_list(struct sink *k, uint32_t id, uint32_t degree)
{
    uint32_t *out = row(k, 2 + (size_t)degree);
    out[0] = id;
    out[1] = degree;
}

/* Writes the row of an interior point, or one on the hull of a plane set; false if there is no room. */
static bool write_list(const struct dt *t, const struct dt_cursor *c, struct sink *k, uint32_t id,
                       struct dt_star star)
{
    uint32_t *ring = list_ring(k, 0), degree = DT_NONE;
    if (ring != NULL) /* the degree is known when the star has been walked round */
        degree = dt_star_copy(t, &star, ring, k->cap - k->words - 2);
    if (degree == DT_NONE) {
        k->need = 2 + (size_t)dt_star_count(t, &star);
        return false;
    }
    dt_ring_turn(ring, degree, star.on_hull, c->cw);
    end_list(k, id, degree);
    return true;
}

static bool write_list_on_line(struct sink *k, const struct dt_hull_walk *w)
{
    uint32_t two[2], degree = dt_hull_walk_ring(w, two), *ring = list_ring(k, degree);
    if (ring == NULL)
        return false;
    memcpy(ring, two, degree * sizeof *ring);
    end_list(k, w->id, degree);
    return true;
}

static bool write_star(const struct dt *t, const struct dt_cursor *c, struct sink *k,
                       const struct dt_stars *s, uint32_t i)
{
    uint32_t degree = s->degree[i];
    if (degree == DT_NONE)
        return write_list(t, c, k, s->id[i], dt_star_of(t, c->view, s->id[i]));
    uint32_t *ring = list_ring(k, degree);
    if (ring == NULL)
        return false;
    dt_ring_copy(ring, s->ring[i], degree, c->cw);
    end_list(k, s->id[i], degree);
    return true;
}

/* How many stars to read ahead for a sink that takes about `words` words for each. */
static uint32_t stars_ahead(const struct sink *k, size_t words)
{
    size_t n = (k->cap - k->words) / words + 1;
    n = n < k->max_rows - k->rows ? n : k->max_rows - k->rows;
    return n < DT_STARS ? (uint32_t)n : DT_STARS;
}

static void read_interior_lists(const struct dt *t, struct dt_cursor *c, struct sink *k)
{
    const struct dt_view *v = dt_view_if_changed(t, c->view);
    struct dt_stars stars;
    while (c->left > 0 && k->rows < k->max_rows) {
        dt_stars_read(t, v, c->id, c->end, stars_ahead(k, 8), &stars);
        if (stars.n == 0)
            c->left = 0;
        for (uint32_t i = 0; i < stars.n; i++) {
            if (!stars.on_hull[i]) {
                if (!write_star(t, c, k, &stars, i))
                    return;
                c->left--;
            }
            c->id = stars.id[i] + 1;
        }
    }
}

static void read_hull_lists(const struct dt *t, struct dt_cursor *c, struct sink *k)
{
    struct dt_hull_walk w = hull_from(t, c);
    for (bool fits = true; fits && c->hull_left > 0; c->hull_left -= fits) {
        fits =
            w.line ? write_list_on_line(k, &w) : write_list(t, c, k, w.id, dt_hull_walk_star(&w));
        if (fits)
            dt_hull_walk_step(&w);
    }
    hull_leave(&w, c);
}

static void read_lists(const struct dt *t, struct dt_cursor *c, struct sink *k)
{
    read_interior_lists(t, c, k);
    if (c->left == 0 && c->hull_left > 0)
        read_hull_lists(t, c, k);
}

/* Writes what star i has for the cursor; false if there is more than fits, or no memory. */
static bool write_group(const struct dt *t, struct dt_cursor *c, struct sink *k,
                        const struct dt_stars *s, uint32_t i, size_t width)
{
    struct dt_group g = {.id = s->id[i], .width = width, .cw = c->cw, .rows = k->out + k->words};
    g.room = (k->cap - k->words) / width;
    g.room = g.room < k->max_rows - k->rows ? g.room : k->max_rows - k->rows;
    if (g.room == 0)
        return false;
    g.from = s->id[i] == c->id ? c->sub : 0;
    if (s->degree[i] == DT_NONE)
        k->status = dt_group_of_many(&g, t, c->view);
    else if (s->degree[i] > 0)
        dt_group_of_ring(&g, s->ring[i], s->degree[i], s->on_hull[i]);
    if (k->status != DT_OK)
        return false;
    k->words += g.n * width;
    k->rows += g.n;
    c->left -= (uint32_t)g.n;
    c->id = g.more ? g.id : g.id + 1;
    c->sub = g.more ? g.rows[(g.n - 1) * width + 1] + 1 : 0;
    return !g.more;
}

static void read_groups(const struct dt *t, struct dt_cursor *c, struct sink *k, size_t width)
{
    const struct dt_view *v = dt_view_if_changed(t, c->view);
    struct dt_stars stars;
    while (c->left > 0 && has_room(k, width)) {
        dt_stars_read(t, v, c->id, c->end, stars_ahead(k, 2 * width), &stars);
        if (stars.n == 0)
            c->left = 0;
        for (uint32_t i = 0; i < stars.n; i++)
            if (!write_group(t, c, k, &stars, i, width))
                return;
    }
}

enum dt_status dt_table_read(const struct dt *t, struct dt_cursor *c, uint32_t *out, size_t cap,
                             size_t max_rows, size_t *rows, size_t *words)
{
    static const size_t width[] = {
        [DT_POINTS] = 1, [DT_COINCIDENT] = 2, [DT_TRIANGLES] = 3, [DT_EDGES] = 2, [DT_HULL] = 1};
    struct sink k = {.out = out, .cap = cap, .max_rows = max_rows};
    enum dt_status s = dt_view_readable(t, c->view, needs_mesh(c->table));
    *rows = *words = 0;
    if (s != DT_OK)
        return s;
    switch (c->table) {
    case DT_POINTS:
        read_points(t, c, &k);
        break;
    case DT_COINCIDENT:
        read_coincident(t, c, &k);
        break;
    case DT_LISTS:
        read_lists(t, c, &k);
        break;
    case DT_TRIANGLES:
    case DT_EDGES:
        read_groups(t, c, &k, width[c->table]);
        break;
    case DT_HULL:
        read_hull(t, c, &k);
        break;
    }
    *rows = k.rows;
    *words = k.words;
    if (k.rows > 0 || (c->left == 0 && c->hull_left == 0) || max_rows == 0)
        return DT_OK;
    if (k.status != DT_OK)
        return k.status;
    *words = c->table == DT_LISTS ? k.need : width[c->table];
    return DT_TOOSMALL;
}
