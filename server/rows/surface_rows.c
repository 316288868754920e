/* surface_rows.c - see surface_rows.h. */
#include "server/rows/surface_rows.h"

#include "core/delaunay_constraints.h"
#include "proto/reply.h"

#include <math.h>
#include <stdlib.h>

enum {
    CELLS_LINEAR = 1 << 15, /* values of a piece, some milliseconds of work */
    CELLS_NATURAL = 1 << 13,
    CELLS_TEXT = 1 << 13,
    STEPS_A_VISIT = 1 << 17 /* while edits wait */
};

/* Of a place, for all fields. */
static size_t numbers_of(const struct surface_rows *r)
{
    return r->fields * dt_surface_numbers(&(struct dt_surface){.quantity = r->quantity});
}

/* Returns how many places are looked up together: whole rows if they are text. */
static size_t batch(const struct surface_rows *r)
{
    bool light = r->how == DT_LINEAR || r->how == DT_CLOSEST;
    size_t left = r->end - r->at, n = (light ? CELLS_LINEAR : CELLS_NATURAL) / r->fields;
    if (!r->binary) {
        n = CELLS_TEXT / r->fields / r->columns * r->columns;
        n = n > 0 ? n : r->columns;
    }
    return n < left ? n : left;
}

/* Clears the numbers of cells that are not kept. */
static void clip(const struct surface_rows *r, size_t from, size_t n, double *value)
{
    const size_t numbers = numbers_of(r);
    for (size_t i = 0; i < n; i++)
        for (size_t k = 0; k < numbers && (r->kept[(from + i) / 8] >> (from + i) % 8 & 1) == 0; k++)
            value[i * numbers + k] = (double)NAN;
}

static enum dt_status find(const struct surface_rows *r, const struct dt_surface *s, size_t n,
                           const struct pace *pace, size_t *done)
{
    struct dt_options opt = pace_options(pace, STEPS_A_VISIT);
    size_t from = r->at + r->found;
    double *to = r->value + r->found * numbers_of(r);
    enum dt_status status = r->place != NULL
                                ? dt_values(r->dt, s, r->place + from, n, &opt, to, done)
                                : dt_raster_values(r->dt, s, &r->raster, from, n, &opt, to, done);
    if (r->kept != NULL)
        clip(r, from, *done, to);
    return status;
}

/* Bytes of the numbers of n places, whole rows if they are text. */
static size_t bytes_of(const struct surface_rows *r, size_t n)
{
    enum { NUMBER_TEXT = 33 }; /* of reply_row_numbers, which takes 2 more for a row */
    size_t numbers = n * numbers_of(r);
    return r->binary ? numbers * sizeof(double) : numbers * NUMBER_TEXT + n / r->columns * 2;
}

/* Writes the numbers found, if they are whole rows. */
static void write(struct surface_rows *r, struct buf *out, struct reservation *memory)
{
    size_t numbers = numbers_of(r), row = r->columns * numbers,
           n = r->binary ? r->found : r->found / r->columns * r->columns;
    if (!row_memory_reserve(memory, out, bytes_of(r, n), surface_rows_memory(r)))
        return;
    if (r->binary)
        reply_words_u32(out, (const uint32_t *)(const void *)r->value, 2 * n * numbers);
    for (size_t i = 0; !r->binary && i < n * numbers; i += row)
        reply_row_numbers(out, r->value + i, row);
    for (size_t i = n * numbers; i < r->found * numbers; i++)
        r->value[i - n * numbers] = r->value[i];
    r->at += n;
    r->found -= n;
}

static enum dt_status fill(struct surface_rows *r, const struct dt_surface *s, struct buf *out,
                           size_t limit, struct pace *pace, struct reservation *memory)
{
    enum dt_status status = DT_OK;
    bool ends = false;
    while (r->at < r->end && !ends && !out->failed && buf_len(out) < limit) {
        size_t n = pace->slow ? 1 : batch(r) - r->found, done;
        status = find(r, s, n, pace, &done);
        ends = pace_ends(pace, status, done);
        r->found += done;
        write(r, out, memory);
    }
    return status == DT_TOOLONG ? DT_OK : status;
}

/* The surface of one of the fields. */
static struct dt_surface surface_of(const struct surface_rows *r)
{
    return (struct dt_surface){.how = r->how,
                               .max_edge = r->max_edge,
                               .inside = r->inside.asked,
                               .number = r->inside.number,
                               .beyond = r->beyond,
                               .quantity = r->quantity};
}

enum dt_status surface_rows_fill(struct surface_rows *r, struct buf *out, size_t limit,
                                 struct pace *pace, struct reservation *memory)
{
    struct dt_surface s[DT_MAX_FIELDS];
    size_t begun = 0;
    r->passed = r->view != NULL && !(r->inside.asked ? dt_view_has_regions(r->dt, r->view)
                                                     : dt_view_is_current(r->dt, r->view));
    if (r->passed)
        return DT_OK;
    if (r->value == NULL) {
        r->room = batch(r) * numbers_of(r) * sizeof *r->value;
        r->value = malloc(r->room + 1);
    }
    enum dt_status status = r->value == NULL ? DT_NOMEM : DT_OK;
    for (; status == DT_OK && begun < r->fields; begun += status == DT_OK) {
        s[begun] = surface_of(r);
        s[begun].next = begun + 1 < r->fields ? &s[begun + 1] : NULL;
        status = dt_surface_begin(&s[begun], r->field[begun], r->view);
    }
    if (status == DT_OK)
        status = fill(r, s, out, limit, pace, memory);
    while (begun > 0)
        dt_surface_end(&s[--begun]);
    if (r->found == 0)
        surface_rows_clear(r);
    return status;
}

size_t surface_rows_piece(const struct surface_rows *r)
{
    size_t n = batch(r);
    return n * numbers_of(r) * sizeof *r->value + bytes_of(r, n);
}

size_t surface_rows_memory(const struct surface_rows *r)
{
    return r->value != NULL ? r->room : 0;
}

bool surface_rows_cut(struct surface_rows *r, struct surface_rows *part)
{
    *part = *r;
    r->value = NULL; /* is the part's */
    r->found = 0;
    if (r->at == r->end)
        return false;
    r->at += batch(r);
    part->end = r->at;
    return true;
}

void surface_rows_clear(struct surface_rows *r)
{
    free(r->value);
    r->value = NULL;
}
