/* rows.c - see rows.h. */
#include "server/rows/rows.h"

#include "core/delaunay_fields.h"
#include "server/ops/limits.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum {
    CELLS = 64,          /* read at a time */
    CELL_TEXT = 256,     /* bytes of a usual one, about */
    TABLE_WORDS = 4096,  /* read from a table at a time */
    PART_IDS = 600,      /* of a part: ids of a table or rows of a list, about 30 KB of text, */
    PART_BINARY = 1800,  /* or in binary: 36 to 58 KB, */
    PART_CELLS = 150,    /* of a part: cells, */
    PART_MADE = 600,     /* the same in binary, */
    PART_AREAS = 2000,   /* or areas, both if they have been made */
    PART_WORDS = 7500,   /* of a part in binary */
    PART_NUMBERS = 3000, /* words of a part of lines or loops */
    PLACE_WORDS = 4096, /* of the places that are looked up at a time; no row of a place has more */
    PLACE_STEPS = 20000, /* of a look-up, while edits wait, */
    CELL_STEPS = 1 << 16 /* or of cells */
};

/* Bytes of text that the functions of reply.h reserve for each id, or number, of a row. */
enum { ID_TEXT = 11, NUMBER_TEXT = 33, ROW_TEXT = 64 };

/* Makes room for a row of that number of ids and numbers, and for `beside` bytes that it takes while it is made. */
static bool make_room(const struct rows *r, struct buf *out, size_t ids, size_t numbers,
                      size_t beside)
{
    size_t text = r->binary ? 4 * ids + 8 * numbers : ID_TEXT * ids + NUMBER_TEXT * numbers;
    return row_memory_reserve(r->memory, out, text + ROW_TEXT, beside);
}

/* A row of an id and n numbers. */
static void write_numbers(const struct rows *r, struct buf *out, uint32_t id, const double *v,
                          size_t n)
{
    if (!r->binary) {
        reply_row_values(out, id, v, n);
        return;
    }
    reply_word_u32(out, id);
    reply_words_double(out, v, n);
}

/* ---- rows from ids ---- */

/* The values of a point of DT_POINTS, after its coordinates; in text, its row has ended already. */
static void write_values(const struct rows *r, struct buf *out, uint32_t id)
{
    for (size_t i = 0; i < r->fields && !out->failed; i++) {
        double value;
        dt_field_values(r->field[i], r->view, &id, 1, &value);
        if (r->binary)
            reply_word_double(out, value);
        else
            reply_more_value(out, value);
    }
}

static void write_point(struct rows *r, struct buf *out, uint32_t id)
{
    struct dt_point p;
    r->status = dt_view_get(r->version->dt, r->view, id, &p);
    if (r->status != DT_OK)
        return;
    double number[3] = {p.x, p.y}, dx = p.x - r->from.x, dy = p.y - r->from.y;
    size_t n = 2;
    if (r->form == ROW_NEIGHBOUR)
        number[n++] = sqrt(dx * dx + dy * dy);
    write_numbers(r, out, id, number, n);
    write_values(r, out, id);
}

static void write_ids(struct rows *r, struct buf *out, const uint32_t *id)
{
    if (r->binary)
        reply_words_u32(out, id, r->width);
    else
        reply_row_ids(out, id, r->width);
}

static void write_ring(struct rows *r, struct buf *out, const uint32_t *id)
{
    uint32_t rep;
    bool boundary;
    r->ring.n = 0;
    r->status = dt_view_ring(r->version->dt, r->view, *id, r->cw, &r->ring, &rep, &boundary);
    if (r->status != DT_OK || !make_room(r, out, r->ring.n + 2, 0, r->ring.cap * sizeof *r->ring.v))
        return;
    if (r->binary) {
        uint32_t head[2] = {rep, (uint32_t)r->ring.n};
        reply_words_u32(out, head, 2);
        reply_words_u32(out, r->ring.v, r->ring.n);
        return;
    }
    reply_row_ids(out, &rep, 1);
    if (r->ring.n > 0 && !out->failed) {
        out->data[out->end - 1] = ' '; /* the ring is on the same line */
        reply_row_ids(out, r->ring.v, r->ring.n);
    }
}

void row_value_put(uint32_t word[ROW_VALUE_WORDS], uint32_t id, double value)
{
    word[0] = id;
    memcpy(&word[1], &value, sizeof value);
}

void row_line_put(uint32_t word[ROW_LINE_WORDS], double level, bool closed, uint32_t places)
{
    memcpy(word, &level, sizeof level);
    word[2] = closed;
    word[3] = places;
}

void row_band_put(uint32_t word[ROW_BAND_WORDS], const struct dt_band_ring *ring)
{
    memcpy(word, &ring->low, sizeof ring->low);
    memcpy(word + 2, &ring->high, sizeof ring->high);
    word[4] = ring->number;
    word[5] = ring->hole;
    word[6] = (uint32_t)ring->n;
}

void row_region_put(uint32_t word[ROW_REGION_WORDS], const struct dt_region *region)
{
    word[0] = region->number;
    word[1] = region->closed;
    word[2] = region->triangles;
    memcpy(&word[3], &region->area, sizeof region->area);
}

static void write_words(struct rows *r, struct buf *out, const uint32_t *word)
{
    if (r->binary)
        reply_words_u32(out, word, reply_row_words(r->format, word));
    else if (row_memory_reserve(r->memory, out, reply_row_room(r->format, word), 0))
        reply_row(out, r->format, word);
}

/* The words of the list that the row at `at` takes. */
static size_t list_words(const struct rows *r, size_t at)
{
    return r->form == ROW_WORDS ? reply_row_words(r->format, r->ids.v + at) : r->width;
}

static void write_listed(struct rows *r, struct buf *out, const uint32_t *word)
{
    switch (r->form) {
    case ROW_POINT:
    case ROW_NEIGHBOUR:
        write_point(r, out, *word);
        break;
    case ROW_RING:
        write_ring(r, out, word);
        break;
    case ROW_WORDS:
        write_words(r, out, word);
        break;
    default:
        write_ids(r, out, word);
    }
}

/* Prefetches the data of the next rows. */
static void fetch_next(const struct rows *r)
{
    const uint32_t *id = r->ids.v + r->at;
    size_t left = r->ids.n - r->at, n = left < DT_AHEAD ? left : DT_AHEAD;
    if (r->form == ROW_RING)
        dt_fetch_ids(r->version->dt, id, n);
    else if (r->form == ROW_POINT || r->form == ROW_NEIGHBOUR)
        dt_fetch_points(r->version->dt, id, n);
}

static void fill_from_ids(struct rows *r, struct buf *out, size_t limit)
{
    while (r->at < r->ids.n && r->status == DT_OK && !out->failed && buf_len(out) < limit) {
        const uint32_t *id = r->ids.v + r->at;
        if (pace_is_cancelled(&r->pace)) {
            r->status = DT_CANCELLED;
            return;
        }
        if (r->at % DT_AHEAD == 0 && r->ids.n > 1)
            fetch_next(r);
        write_listed(r, out, id);
        r->at += list_words(r, r->at);
    }
    r->done = r->at == r->ids.n;
}

/* ---- rows from places ---- */

_Static_assert((int)LIMIT_NEAREST_MANY <= (int)PLACE_WORDS, "a row of a place is found in one go");

/* Finds the rows of the next n places, or of fewer if the steps do not last. */
static enum dt_status find(struct rows *r, size_t n, uint32_t *out, size_t *done)
{
    struct dt_options opt = pace_options(&r->pace, PLACE_STEPS);
    const struct dt *dt = r->version->dt;
    const struct dt_point *p = r->place + r->at;
    return r->form == ROW_TRIANGLE
               ? dt_locate_many(dt, r->view, p, n, &opt, out, done)
               : dt_nearest_many(dt, r->view, p, n, (uint32_t)r->width, &opt, out, done);
}

/* Returns how many places a piece of this number of words has. */
static size_t places_of(const struct rows *r, size_t words)
{
    return r->width == 0 ? SIZE_MAX : words < r->width ? 1 : words / r->width;
}

static void fill_from_places(struct rows *r, struct buf *out, size_t limit)
{
    uint32_t v[PLACE_WORDS];
    size_t most = places_of(r, PLACE_WORDS), done;
    bool ends = false;
    while (r->at < r->places && !ends && !out->failed && buf_len(out) < limit) {
        size_t left = r->places - r->at, n = r->pace.slow ? 1 : left < most ? left : most;
        enum dt_status status = find(r, n, v, &done);
        ends = pace_ends(&r->pace, status, done);
        r->status = status == DT_TOOLONG ? DT_OK : status;
        reply_words_u32(out, v, done * r->width);
        r->at += done;
    }
    r->done = r->at == r->places;
}

/* ---- rows from cells ---- */

static void write_polygon(const struct rows *r, struct buf *out, const struct dt_cell *cell,
                          const struct dt_point *corner)
{
    if (!make_room(r, out, 2, 2 * (size_t)cell->corners, 0))
        return;
    if (!r->binary) {
        reply_row_polygon(out, cell->id, cell->corners, &corner->x);
        return;
    }
    reply_word_u32(out, cell->id);
    reply_word_u32(out, cell->corners);
    reply_words_double(out, &corner->x, 2 * (size_t)cell->corners);
}

/* Writes n cells, at most CELLS. */
static void write_each(const struct rows *r, struct buf *out, const struct dt_cell *cell, size_t n,
                       const struct dt_point *corner)
{
    double area[CELLS];
    if (r->form == ROW_AREA)
        dt_cell_areas(cell, n, corner, area);
    for (size_t i = 0; i < n; corner += cell[i++].corners)
        if (r->form == ROW_AREA)
            write_numbers(r, out, cell[i].id, &area[i], 1);
        else
            write_polygon(r, out, &cell[i], corner);
}

/* Writes one cell that has more corners than the usual buffer, and at most that number. */
static enum dt_status write_long_cell(struct rows *r, struct dt_cells *c, struct buf *out,
                                      size_t corners, size_t *n)
{
    struct dt_cell cell;
    if (!make_room(r, out, 2, r->form == ROW_AREA ? 1 : 2 * corners,
                   corners * sizeof(struct dt_point)))
        return DT_NOMEM;
    struct dt_point *corner = malloc(corners * sizeof *corner);
    if (corner == NULL)
        return DT_NOMEM;
    enum dt_status status =
        dt_cells_read(r->version->dt, c, &cell, 1, corner, corners, n, &corners);
    write_each(r, out, &cell, *n, corner);
    free(corner);
    return status;
}

/* Writes the next areas, which have been made. Returns how many. */
static size_t write_areas(struct rows *r, struct buf *out)
{
    uint32_t id[CELLS];
    double area[CELLS];
    size_t n = dt_areas_read(&r->cells, id, area, CELLS);
    for (size_t i = 0; i < n; i++)
        write_numbers(r, out, id[i], &area[i], 1);
    return n;
}

/* Writes the next cells of the cursor: *n. */
static enum dt_status write_cells(struct rows *r, struct dt_cells *c, struct buf *out, size_t limit,
                                  size_t *n)
{
    struct dt_cell cell[CELLS];
    struct dt_point corner[8 * CELLS];
    struct dt_options opt = pace_options(&r->pace, CELL_STEPS);
    size_t corners, left = (limit - buf_len(out)) / CELL_TEXT + 1,
                    room = r->pace.slow   ? 1
                           : left < CELLS ? left
                                          : CELLS;
    c->opt = &opt;
    enum dt_status status =
        dt_cells_read(r->version->dt, c, cell, room, corner, 8 * CELLS, n, &corners);
    if (status == DT_TOOSMALL)
        status = write_long_cell(r, c, out, corners, n);
    else
        write_each(r, out, cell, *n, corner);
    c->opt = NULL;
    return status;
}

/* The same for the next cells of the rows. */
static enum dt_status write_next_cells(struct rows *r, struct buf *out, size_t limit, size_t *n)
{
    struct dt_cells one;
    enum dt_status status = DT_OK;
    if (r->ids.v != NULL) {
        dt_cells_only(&r->cells, r->ids.v[r->at], &one);
        status = write_cells(r, &one, out, limit, n);
        r->at += status == DT_OK;
        r->done = r->at == r->ids.n;
        return status;
    }
    if (r->form == ROW_AREA && r->cells.made != NULL)
        *n = write_areas(r, out);
    else
        status = write_cells(r, &r->cells, out, limit, n);
    r->done = status == DT_OK && *n == 0;
    return status;
}

static void fill_from_cells(struct rows *r, struct buf *out, size_t limit)
{
    bool ends = false;
    dt_cells_as_of(&r->cells, r->view);
    r->done = r->ids.v != NULL && r->at == r->ids.n;
    while (!r->done && !ends && !out->failed && buf_len(out) < limit) {
        size_t n = 0;
        enum dt_status status = write_next_cells(r, out, limit, &n);
        ends = pace_ends(&r->pace, status, n);
        r->status = status == DT_TOOLONG ? DT_OK : status;
    }
}

/* ---- rows from tables ---- */

/* The number of words of the row that starts at w. */
static size_t row_words(enum dt_table table, const uint32_t *w)
{
    switch (table) {
    case DT_POINTS:
    case DT_HULL:
        return 1;
    case DT_COINCIDENT:
    case DT_EDGES:
        return 2;
    case DT_TRIANGLES:
        return 3;
    case DT_LISTS:
        return 2 + w[1];
    }
    return 1;
}

static void write_table_row(struct rows *r, struct buf *out, uint32_t *w, size_t words)
{
    enum dt_table table = r->cursor.table;
    if (table == DT_POINTS || table == DT_HULL) {
        r->form = ROW_POINT;
        write_point(r, out, w[0]);
    } else if (r->binary) {
        reply_words_u32(out, w, words);
    } else if (table == DT_LISTS) {
        if (!make_room(r, out, words, 0, 0))
            return;
        w[1] = w[0]; /* the degree is not part of the text */
        reply_row_ids(out, w + 1, words - 1);
    } else {
        reply_row_ids(out, w, words);
    }
}

/* Reads one row that is longer than the usual buffer, and writes it. */
static enum dt_status write_long_row(struct rows *r, struct buf *out, size_t words)
{
    size_t rows;
    uint32_t *v = make_room(r, out, words, 0, words * sizeof *v) ? malloc(words * sizeof *v) : NULL;
    if (v == NULL)
        return DT_NOMEM;
    enum dt_status status = dt_table_read(r->version->dt, &r->cursor, v, words, 1, &rows, &words);
    if (status == DT_OK && rows == 1)
        write_table_row(r, out, v, words);
    free(v);
    return status;
}

/* Writes the next rows. */
static enum dt_status write_rows(struct rows *r, struct buf *out, size_t limit)
{
    uint32_t v[TABLE_WORDS];
    /* A word takes up to 11 bytes of text, and the row of a point about four times that, and its values. In binary
     * form a word takes four bytes, and most tables are sent as they are. */
    bool as_it_is = r->binary && r->cursor.table != DT_POINTS && r->cursor.table != DT_HULL;
    size_t row = 40 + 20 * r->fields, cap = (limit - buf_len(out)) / (as_it_is ? 4 : row) + 16;
    size_t rows = 0, words = 0;
    enum dt_status status =
        dt_table_read(r->version->dt, &r->cursor, v, cap < TABLE_WORDS ? cap : TABLE_WORDS,
                      TABLE_WORDS, &rows, &words);
    if (status == DT_TOOSMALL)
        return write_long_row(r, out, words);
    if (status != DT_OK)
        return status;
    r->done = rows == 0;
    if (as_it_is)
        reply_words_u32(out, v, words);
    for (size_t at = as_it_is ? words : 0; at < words && r->status == DT_OK;) {
        size_t n = row_words(r->cursor.table, v + at);
        write_table_row(r, out, v + at, n);
        at += n;
    }
    return r->status;
}

static void fill_from_table(struct rows *r, struct buf *out, size_t limit)
{
    enum dt_status status = DT_OK;
    while (!r->done && status == DT_OK && !out->failed && buf_len(out) < limit)
        status = pace_is_cancelled(&r->pace) ? DT_CANCELLED : write_rows(r, out, limit);
    r->status = status == DT_TOOLONG ? DT_OK : status;
}

/* ---- rows from a surface ---- */

static void fill_from_surface(struct rows *r, struct buf *out, size_t limit)
{
    r->status = surface_rows_fill(&r->surface, out, limit, &r->pace, r->memory);
    r->done = r->surface.at == r->surface.end;
}

void rows_fill(struct rows *r, struct buf *out, size_t limit)
{
    if (r->form == ROW_SURFACE)
        fill_from_surface(r, out, limit);
    else if (r->table)
        fill_from_table(r, out, limit);
    else if (row_is_of_cell(r->form))
        fill_from_cells(r, out, limit);
    else if (row_is_of_place(r->form))
        fill_from_places(r, out, limit);
    else
        fill_from_ids(r, out, limit);
    if (out->failed)
        r->status = DT_NOMEM;
}

/* ---- parts ---- */

size_t rows_count(const struct rows *r)
{
    if (r->form == ROW_SURFACE)
        return r->surface.end;
    if (row_is_of_place(r->form))
        return r->places;
    if (row_is_of_cell(r->form) && r->ids.v == NULL)
        return r->cells.rows;
    return r->table ? r->cursor.rows : r->ids.n / r->width;
}

static bool cut_cells(struct rows *r, struct rows *part)
{
    dt_cells_as_of(&r->cells, r->view);
    uint32_t made = r->form == ROW_AREA ? PART_AREAS : PART_MADE;
    return dt_cells_cut(r->version->dt, &r->cells, r->cells.made != NULL ? made : PART_CELLS,
                        &part->cells);
}

bool rows_cut(struct rows *r, struct rows *part)
{
    *part = *r;
    part->ring = (struct dt_ids){0};
    if (r->form == ROW_SURFACE)
        return surface_rows_cut(&r->surface, &part->surface);
    if (r->table)
        return dt_table_cut(r->version->dt, &r->cursor, r->binary ? PART_BINARY : PART_IDS,
                            &part->cursor);
    if (!r->table && row_is_of_place(r->form)) {
        size_t places = places_of(r, PART_WORDS), left = r->places - r->at;
        r->at += left < places ? left : places;
        part->places = r->at;
        return part->at < part->places;
    }
    if (row_is_of_cell(r->form) && r->ids.v == NULL)
        return cut_cells(r, part);
    size_t n = row_is_of_cell(r->form) ? PART_CELLS
               : r->form == ROW_WORDS  ? PART_NUMBERS
                                       : PART_IDS * r->width;
    for (size_t from = r->at; r->at < r->ids.n && r->at - from < n;)
        r->at += list_words(r, r->at);
    part->ids.n = r->at;
    return part->at < part->ids.n;
}

size_t rows_piece(const struct rows *r, size_t usual)
{
    return r->form == ROW_SURFACE ? surface_rows_piece(&r->surface) : usual;
}

size_t rows_memory(const struct rows *r)
{
    return r->ring.cap * sizeof *r->ring.v + surface_rows_memory(&r->surface);
}

void rows_clear(struct rows *r)
{
    free(r->ring.v);
    r->ring = (struct dt_ids){0};
    surface_rows_clear(&r->surface);
}
