/* answer_rows.c - see answer_rows.h. */
#include "server/rows/answer_rows.h"

#include "server/ops/cost.h"
#include "server/rows/row_stream.h"

#include <stdlib.h>

enum {
    AT_ONCE = 64,       /* points of a table that is written without a stream, */
    LIST_AT_ONCE = 256, /* or rows of a list */
    HEAVY_ROWS = 20000  /* more rows, or tables of more points, are made by workers */
};

static bool answer_at_once(struct server *s, struct answer *a, struct rows *rows)
{
    enum { BYTES_AT_ONCE = 16 * 1024 };
    bool heavy = rows->heavy && (row_is_of_cell(rows->form) || rows->form == ROW_SURFACE);
    if (heavy || rows_count(rows) > (rows->table ? AT_ONCE : LIST_AT_ONCE))
        return false;
    struct reservation memory =
        server_reservation(s, BUDGET_REPLIES); /* then it is the connection's */
    rows->memory = &memory; // cppcheck-suppress autoVariables ; until rows_fill returns
    rows->pace = (struct pace){.steps = COST_STEPS_AT_ONCE};
    rows_fill(rows, a->out, rows->table ? SIZE_MAX : buf_len(a->out) + BYTES_AT_ONCE);
    rows->pace = (struct pace){0};
    rows->memory = NULL;
    reservation_set(&memory, 0);
    return rows->done || rows->status != DT_OK;
}

/* Whether the rows are read from the set; rows of a list are not. */
static bool reads_set(const struct rows *rows)
{
    return rows->table || !row_is_of_list(rows->form);
}

/* Whether the view must include the triangulation. */
static bool reads_rings(const struct rows *rows)
{
    return rows->table ? rows->cursor.table != DT_POINTS && rows->cursor.table != DT_COINCIDENT
                       : rows->form == ROW_RING || row_is_computed(rows->form);
}

/* The number of points that are read: COINCIDENT, for instance, reads all for its few rows. */
static uint32_t table_work(const struct version *v, enum dt_table table)
{
    return table == DT_HULL ? v->sum.hull : v->sum.points;
}

static bool is_heavy(const struct rows *rows)
{
    size_t work = rows->table ? table_work(rows->version, rows->cursor.table) : rows_count(rows);
    return rows->heavy || rows->form == ROW_SURFACE || work > HEAVY_ROWS;
}

/* Begins the view of the rows, if they need one. False when out of memory. */
static bool begin_view(struct rows *rows)
{
    if (rows->view == NULL && reads_set(rows))
        rows->view = dt_view_begin(rows->version->dt, reads_rings(rows));
    rows->surface.view = rows->view;
    return rows->view != NULL || !reads_set(rows);
}

static void begin_stream(struct server *s, struct answer *a, struct rows *rows,
                         const struct places *places)
{
    if (!world_alone(a)) {
        rows_clear(rows);
        return;
    }
    if (!begin_view(rows))
        answer_out_of_memory(a);
    else if (row_stream_begin(s, a, rows, is_heavy(rows), places))
        return;
    version_end_view(&s->sets, rows->version, rows->view);
    rows_clear(rows);
}

static void answer_with(struct server *s, struct answer *a, struct rows *rows,
                        const struct places *places)
{
    if (rows->view != NULL || !answer_at_once(s, a, rows)) {
        begin_stream(s, a, rows, places);
        return;
    }
    if (rows->status != DT_OK)
        answer_out_of_memory(a);
    rows_clear(rows);
}

void answer_rows(struct server *s, struct answer *a, struct rows *rows, struct dt_ids *ids)
{
    if (ids != NULL)
        rows->ids = *ids;
    answer_with(s, a, rows, NULL);
    if (ids != NULL && a->next == ANSWER_STREAM)
        *ids = (struct dt_ids){0};
}

void answer_places(struct server *s, struct answer *a, struct rows *rows, struct places *places)
{
    rows->place = places->p;
    rows->places = places->n;
    answer_with(s, a, rows, places);
    if (a->next != ANSWER_STREAM)
        row_stream_free_places(s, places);
}

/* ---- tables ---- */

/* The length of a binary table: 4 bytes a word, 16 for the coordinates of a point, and 8 for each of its values. */
static uint64_t table_bytes(const struct version *v, const struct rows *rows)
{
    const struct dt_cursor *c = &rows->cursor;
    switch (c->table) {
    case DT_POINTS:
    case DT_HULL:
        return (uint64_t)c->rows * (20 + 8 * rows->fields);
    case DT_COINCIDENT:
    case DT_EDGES:
        return (uint64_t)c->rows * 8;
    case DT_TRIANGLES:
        return (uint64_t)c->rows * 12;
    case DT_LISTS: /* id, degree, and every edge from both its ends */
        return (uint64_t)c->rows * 8 + (uint64_t)v->sum.edges * 8;
    }
    return 0;
}

static void begin_table(struct server *s, struct answer *a, struct rows *made)
{
    struct rows rows = *made;
    struct version *v = rows.version;
    enum dt_table table = rows.cursor.table;
    bool cw = rows.cw, binary = rows.binary;
    if (table_work(v, table) > AT_ONCE && !world_alone(a)) {
        rows_clear(&rows);
        return;
    }
    if (table_work(v, table) > AT_ONCE) {
        rows.view = dt_view_begin(v->dt, reads_rings(&rows));
        if (rows.view == NULL) {
            answer_out_of_memory(a);
            return;
        }
    }
    enum dt_status status = dt_table_begin(v->dt, rows.view, table, cw, &rows.cursor);
    if (status != DT_OK) {
        version_end_view(&s->sets, v, rows.view);
        answer_status(a, status);
        return;
    }
    reply_ok(a->out, binary ? 0 : rows.cursor.rows);
    if (table == DT_LISTS) {
        reply_key_u64(a->out, "interior", rows.cursor.interior);
        reply_key_u64(a->out, "boundary", rows.cursor.rows - rows.cursor.interior);
    } else if (binary) {
        reply_key_u64(a->out, "rows", rows.cursor.rows);
    }
    if (binary)
        reply_key_u64(a->out, "bytes", table_bytes(v, &rows));
    reply_end(a->out);
    answer_rows(s, a, &rows, NULL);
}

void answer_table(struct server *s, struct answer *a, struct version *v, enum dt_table table,
                  bool cw, bool binary)
{
    struct rows rows = {
        .version = v, .table = true, .binary = binary, .cw = cw, .cursor.table = table};
    begin_table(s, a, &rows);
}

void answer_points(struct server *s, struct answer *a, struct version *v, bool binary,
                   const struct dt_field **field, size_t fields)
{
    struct rows rows = {.version = v,
                        .table = true,
                        .binary = binary,
                        .cursor.table = DT_POINTS,
                        .field = field,
                        .fields = fields};
    begin_table(s, a, &rows);
    if (a->next != ANSWER_STREAM)
        free(field);
}
