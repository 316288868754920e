/* table.c - cursors over whole-set tables.
 *
 * Nothing is sorted as a whole: ids are visited in ascending order, and the rows that begin with an id are a
 * small part of its star. A cursor is before the row (id, sub): rows of lower ids are written, and of id itself
 * those whose second word is below sub. It ends before the id `end`; rows along the hull follow after that.
 *
 * `left` and `hull_left` are the rows still to come of either kind; 0 marks the end.
 * The number of rows of a part that was cut off is unknown: `left` is then an upper bound. */
#include "core/memory/sort.h"
#include "core/query/hull_walk.h"
#include "core/set/view_rows.h"
#include "core/set/view_stars.h"

#include <stdlib.h>
#include <string.h>

/* The target of rows. */
struct sink {
    uint32_t *out;
    size_t cap, max_rows;  /* room: words and rows */
    size_t words, rows;    /* written */
    size_t need;           /* words of a point list's row for which there was no room */
    enum dt_status status; /* why there are no more rows: DT_NOMEM, or DT_TOOLONG for now */
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

/* The same on a line; then the walk takes a step. */
static bool write_list_on_line(struct sink *k, struct dt_hull_walk *w)
{
    struct dt_hull_walk here = *w;
    uint32_t two[2], degree = dt_hull_walk_ring(w, two), *ring = list_ring(k, degree);
    if (ring == NULL) {
        *w = here;
        return false;
    }
    memcpy(ring, two, degree * sizeof *ring);
    end_list(k, here.id, degree);
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

/* Returns the number of stars to read ahead for a sink that takes about `words` words for each. */
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
    for (; c->hull_left > 0; c->hull_left--) {
        if (!(w.line ? write_list_on_line(k, &w) : write_list(t, c, k, w.id, w.star)))
            break;
        if (!w.line)
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

/* ---- TRIANGLES and EDGES: the rows that begin with one id, sorted by their second word ----
 *
 * The key of a row is its second word and, below that, its third one, 0 in edges. */

/* The keys of the rows that begin with c->id, from the second word c->sub on, given its star (star.h): into key[n].
 * Returns how many. */
static inline size_t keys_of_star(const struct dt_cursor *c, const uint32_t *ring, size_t n,
                                  bool on_hull, uint64_t *key)
{
    size_t rows = 0;
    for (size_t i = 0; c->table == DT_EDGES && i < n; i++)
        if (ring[i] > c->id && ring[i] >= c->sub)
            key[rows++] = (uint64_t)ring[i] << 32;
    for (size_t i = 0; c->table == DT_TRIANGLES && i + on_hull < n; i++) {
        uint32_t b = ring[i], d = ring[i + 1 < n ? i + 1 : 0];
        uint32_t second = c->cw ? d : b, third = c->cw ? b : d;
        if (second > c->id && third > c->id && second >= c->sub)
            key[rows++] = (uint64_t)second << 32 | third;
    }
    return rows;
}

static inline void sort_keys(uint64_t *key, size_t n)
{
    if (n > DT_STAR_MAX) {
        dt_sort_keys(key, n);
        return;
    }
    for (size_t i = 1; i < n; i++) {
        uint64_t here = key[i];
        size_t j = i;
        for (; j > 0 && key[j - 1] > here; j--)
            key[j] = key[j - 1];
        key[j] = here;
    }
}

static inline void write_key(const struct dt_cursor *c, struct sink *k, uint64_t key)
{
    bool edge = c->table == DT_EDGES;
    uint32_t *out = row(k, edge ? 2 : 3);
    out[0] = c->id;
    out[1] = (uint32_t)(key >> 32);
    if (!edge)
        out[2] = (uint32_t)key;
}

/* All rows of c->id are written. */
static void end_id(struct dt_cursor *c)
{
    c->id++;
    c->sub = 0;
}

/* Writes the rows with these keys that fit; false if there are more. */
static inline bool write_keys(struct dt_cursor *c, struct sink *k, uint64_t *key, size_t n,
                              size_t width)
{
    size_t room = (k->cap - k->words) / width;
    room = room < k->max_rows - k->rows ? room : k->max_rows - k->rows;
    size_t fit = n < room ? n : room;
    sort_keys(key, n);
    for (size_t i = 0; i < fit; i++)
        write_key(c, k, key[i]);
    c->left -= (uint32_t)fit;
    if (fit == n)
        end_id(c);
    else if (fit > 0)
        c->sub = (uint32_t)(key[fit - 1] >> 32) + 1;
    return fit == n;
}

enum { SCAN = 1 << 14 }; /* points that one call looks at for neighbours: some milliseconds */

/* Looks for neighbours of c->id among all points from c->sub on: they have it in their stars. False: there may be
 * more. */
static bool scan_neighbours(const struct dt *t, struct dt_cursor *c, struct sink *k, size_t width)
{
    struct dt_neighbours around = {0};
    uint32_t id = c->sub > c->id ? c->sub : c->id + 1, third;
    struct dt_view_ids ids = dt_view_ids_begin(t, c->view, id);
    for (uint32_t left = SCAN; k->status == DT_OK && has_room(k, width); id++) {
        id = dt_view_ids_next(&ids, id);
        if (id == DT_NONE)
            break;
        c->sub = id; /* no point before it begins a row */
        if (left-- == 0) {
            k->status = DT_TOOLONG;
            break;
        }
        if (dt_view_representative(t, c->view, id) != id)
            continue;
        k->status = dt_neighbours_read(t, c->view, id, &around);
        if (k->status != DT_OK || !dt_neighbours_have(&around, c->id, c->cw, &third) ||
            (width == 3 && (third < c->id || third == DT_NONE)))
            continue;
        write_key(c, k, (uint64_t)id << 32 | third);
        c->left--;
        c->sub = id + 1;
    }
    free(around.ring.v);
    if (id == DT_NONE)
        end_id(c);
    return id == DT_NONE;
}

/* The rows of the representative c->id, which has many neighbours. A table is read in pieces, and each piece walks
 * round the whole star again. For a star with a large share of all points, a scan of the points is faster: a piece
 * continues where the last one stopped. */
static bool write_large_star(const struct dt *t, struct dt_cursor *c, struct sink *k, size_t width)
{
    struct dt_neighbours around = {0};
    struct dt_star star = dt_star_of(t, c->view, c->id);
    uint32_t many = (c->view == NULL ? t->mesh.vertices : c->view->sum.points) / 16 + 1;
    uint32_t degree =
        star.saved != NULL ? star.saved_degree : dt_star_degree(&t->mesh, star.vertex, many);
    if (degree >= many)
        return scan_neighbours(t, c, k, width);
    k->status = dt_neighbours_read(t, c->view, c->id, &around);
    uint64_t *key = k->status == DT_OK ? malloc(degree * sizeof *key) : NULL;
    bool all = false;
    if (key == NULL)
        k->status = DT_NOMEM;
    else
        all = write_keys(c, k, key, keys_of_star(c, around.ring.v, degree, around.on_hull, key),
                         width);
    free(key);
    free(around.ring.v);
    return all;
}

static void read_by_id(const struct dt *t, struct dt_cursor *c, struct sink *k, size_t width)
{
    const struct dt_view *v = dt_view_if_changed(t, c->view);
    struct dt_stars stars;
    uint64_t key[DT_STAR_MAX];
    for (bool all = true; all && c->left > 0 && has_room(k, width);) {
        dt_stars_read(t, v, c->id, c->end, stars_ahead(k, 2 * width), &stars);
        if (stars.n == 0)
            c->left = 0;
        for (uint32_t i = 0; all && i < stars.n; i++) {
            if (stars.id[i] != c->id)
                c->sub = 0;
            c->id = stars.id[i];
            if (stars.degree[i] == DT_NONE)
                all = write_large_star(t, c, k, width);
            else
                all = write_keys(
                    c, k, key,
                    keys_of_star(c, stars.ring[i], stars.degree[i], stars.on_hull[i], key), width);
        }
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
        read_by_id(t, c, &k, width[c->table]);
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
