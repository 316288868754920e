/* asc_grid.c - see asc_grid.h. The header ends where a word is neither a key nor the number after a key. */
#include "clients/grids/asc_grid.h"

#include <ctype.h>
#include <errno.h>
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "clients/reading/number.h"
#include "proto/number.h"
#include "proto/text.h"

enum key {
    NCOLS,
    NROWS,
    XLLCORNER,
    YLLCORNER,
    XLLCENTER,
    YLLCENTER,
    CELLSIZE,
    DX,
    DY,
    NODATA,
    NODATA_SHORT,
    KEYS
};

static const char *const keys[KEYS] = {[NCOLS] = "ncols",
                                       [NROWS] = "nrows",
                                       [XLLCORNER] = "xllcorner",
                                       [YLLCORNER] = "yllcorner",
                                       [XLLCENTER] = "xllcenter",
                                       [YLLCENTER] = "yllcenter",
                                       [CELLSIZE] = "cellsize",
                                       [DX] = "dx",
                                       [DY] = "dy",
                                       [NODATA] = "nodata_value",
                                       [NODATA_SHORT] = "nodata"};

static const double usual_nodata = -9999;

enum { BLOCK = 1 << 17 }; /* bytes of a file in memory, and so of the longest word */

struct asc {
    struct points_file *f;
    const char *p, *end; /* the text that has been read */
    char *block;         /* owns BLOCK bytes, which have it; NULL: all of the text is there */
    int fd;              /* where the rest comes from; -1: there is none */
    struct value back;   /* a word that was read, and is the next one; its text is NULL: none */
    uint64_t line;       /* of p, from 1 */
    double value[KEYS];
    bool given[KEYS];
};

/* ---- words ---- */

/* Reads more behind the n bytes before a->end, which move to the front of the block. False: the file has ended, or the block is full. */
static bool read_more(struct asc *a, size_t n)
{
    if (a->fd < 0 || n == BLOCK)
        return false;
    memmove(a->block, a->end - n, n);
    ssize_t got;
    do
        got = read(a->fd, a->block + n, BLOCK - n);
    while (got < 0 && errno == EINTR);
    if (got < 0)
        points_file_stop(a->f, "%s", strerror(errno));
    if (got <= 0)
        a->fd = -1;
    a->p = a->block;
    a->end = a->block + n + (got > 0 ? got : 0);
    return got > 0;
}

static bool pass_blanks(struct asc *a)
{
    do
        for (; a->p < a->end; a->line += *a->p++ == '\n')
            if (!text_is_space(*a->p))
                return true;
    while (read_more(a, 0));
    return false;
}

/* Valid until the next one is read; empty at the end. */
static struct value next_word(struct asc *a)
{
    struct value word = a->back;
    a->back.text = NULL;
    a->f->line = a->line;
    if (word.text != NULL)
        return word;
    word.len = 0;
    if (pass_blanks(a))
        do
            while (a->p + word.len < a->end && !text_is_space(a->p[word.len]))
                word.len++;
        while (a->p + word.len == a->end && read_more(a, word.len));
    word.text = a->p;
    a->p += word.len;
    a->f->line = a->line;
    return word;
}

static int key_of(struct value word)
{
    for (int i = 0; i < KEYS; i++)
        if (value_is_word(word, keys[i]))
            return i;
    return -1;
}

bool asc_begins(const char *text, size_t n)
{
    struct points_file none = {0};
    size_t mark = text_mark_length(text, n);
    struct asc a = {.f = &none, .p = text + mark, .end = text + n, .fd = -1, .line = 1};
    if (key_of(next_word(&a)) < 0)
        return false;
    struct value number = next_word(&a);
    return number.len > 0 && strchr("+-.0123456789", number.text[0]) != NULL;
}

/* ---- the header ---- */

static bool bad_header(struct asc *a, const char *what, struct value word)
{
    char text[60];
    return points_file_stop(a->f, "%s: \"%s\"", what,
                            report_clean(text, sizeof text, word.text, word.len));
}

static bool read_key(struct asc *a, int key)
{
    struct value number = next_word(a);
    double *v = &a->value[key];
    if (a->given[key])
        return points_file_stop(a->f, "the header has %s twice", keys[key]);
    a->given[key] = true;
    if (key >= NODATA && number_is_missing(number) && number.len > 0) {
        *v = (double)NAN;
        return true;
    }
    if (!proto_read_double(number.text, number.len, v) || (!isfinite(*v) && key < NODATA))
        return bad_header(a, "not a number in the header", number);
    if (key <= NROWS && (*v != floor(*v) || *v < 1 || *v > UINT32_MAX))
        return bad_header(a, "not a number of columns or rows", number);
    if (key >= CELLSIZE && key <= DY && !(*v > 0))
        return bad_header(a, "the side of a cell is above 0", number);
    return true;
}

/* Reads up to the first value. */
static bool read_header(struct asc *a)
{
    for (;;) {
        struct value word = next_word(a);
        int key = key_of(word);
        if (key >= 0) {
            if (!read_key(a, key))
                return false;
        } else if (word.len > 0 && isalpha((unsigned char)word.text[0]) &&
                   !number_is_missing(word)) {
            return bad_header(a, "not a word of the header of an ASCII grid", word);
        } else {
            a->back = word;
            return true;
        }
    }
}

/* Of the keys that say the same in different ways the header needs one. */
static bool need(struct asc *a, enum key key, enum key other)
{
    a->f->line = 0;
    if (!a->given[key] && !a->given[other])
        return points_file_stop(a->f, "the header of the ASCII grid has no %s", keys[key]);
    if (key != other && a->given[key] && a->given[other])
        return points_file_stop(a->f, "the header has %s and %s", keys[key], keys[other]);
    return true;
}

/* An axis: the corner or centre at the lower left, and the step. */
static void place_axis(const struct asc *a, struct grid_frame *g, int axis)
{
    bool centre = a->given[XLLCENTER + axis];
    double step = a->given[CELLSIZE] ? a->value[CELLSIZE] : a->value[DX + axis];
    g->origin[axis] = a->value[(centre ? XLLCENTER : XLLCORNER) + axis];
    g->first[axis] = centre ? 0 : 0.5;
    if (axis == 0) {
        g->column[0] = step;
        return;
    }
    g->row[1] = -step; /* the first row is the northernmost one */
    g->first[1] -= g->rows - (centre ? 1.0 : 0.0);
}

static bool make_frame(struct asc *a, struct grid_frame *g)
{
    *g = (struct grid_frame){.columns = (uint32_t)a->value[NCOLS],
                             .rows = (uint32_t)a->value[NROWS]};
    bool ok = need(a, XLLCORNER, XLLCENTER) && need(a, YLLCORNER, YLLCENTER);
    ok = ok && need(a, CELLSIZE, DX) && need(a, CELLSIZE, DY);
    if (!ok)
        return false;
    place_axis(a, g, 0);
    place_axis(a, g, 1);
    return true;
}

static bool choose_frame(struct asc *a, const struct grid_frame *frame, struct grid_notes *notes)
{
    enum key nodata = a->given[NODATA] ? NODATA : NODATA_SHORT;
    notes->nodata = a->given[nodata] ? a->value[nodata] : usual_nodata;
    if (!need(a, NCOLS, NCOLS) || !need(a, NROWS, NROWS))
        return false;
    if (frame == NULL)
        return make_frame(a, &notes->frame);
    notes->frame = *frame;
    if (frame->columns != a->value[NCOLS] || frame->rows != a->value[NROWS])
        return points_file_stop(a->f, "the header has other numbers of columns and rows than the "
                                      "raster");
    return true;
}

/* ---- the values ---- */

static bool is_nodata(double v, double nodata)
{
    return v == nodata || v == (double)(float)nodata ||
           (fabs(nodata) >= 0x1p100 && (float)v == (float)nodata);
}

/* One rounding where a step is 0 [fma: IEEE 754-2019, section 5.4.1]. */
static double centre(const struct grid_frame *g, int axis, uint32_t column, uint32_t row)
{
    return fma(g->first[0] + column, g->column[axis],
               fma(g->first[1] + row, g->row[axis], g->origin[axis]));
}

static bool bad_value(struct asc *a, uint32_t column, uint32_t row, struct value word)
{
    char text[60];
    points_file_bad(a->f, "row %" PRIu32 ", column %" PRIu32 ": not a number: \"%s\"", row + 1,
                    column + 1, report_clean(text, sizeof text, word.text, word.len));
    return points_file_skip(a->f, word.text, word.len);
}

static bool read_cell(struct asc *a, struct grid_notes *notes, uint32_t column, uint32_t row)
{
    const struct grid_frame *g = &notes->frame;
    struct points_file *f = a->f;
    struct value word = next_word(a);
    double v;
    if (word.len == 0 && f->fatal) /* reading failed */
        return false;
    if (word.len == 0)
        return points_file_stop(f,
                                "the file ends before row %" PRIu32 ", column %" PRIu32
                                " of %" PRIu32 " x %" PRIu32 " values",
                                row + 1, column + 1, g->columns, g->rows);
    bool number = proto_read_double(word.text, word.len, &v);
    if (number ? is_nodata(v, notes->nodata) : number_is_missing(word)) {
        notes->empty++;
        return true;
    }
    if (!number || !isfinite(v))
        return bad_value(a, column, row, word);
    f->row = &v;
    bool ok = points_file_append(f, centre(g, 0, column, row), centre(g, 1, column, row)) ||
              points_file_skip(f, word.text, word.len);
    f->row = NULL;
    return ok;
}

static bool read_values(struct asc *a, struct grid_notes *notes)
{
    for (uint32_t row = 0; row < notes->frame.rows; row++)
        for (uint32_t column = 0; column < notes->frame.columns; column++)
            if (!read_cell(a, notes, column, row))
                return false;
    return true;
}

static bool read_grid(struct asc *a, const struct grid_frame *frame, struct table_fields *t,
                      struct grid_notes *notes)
{
    a->f->fields = 1;
    table_fields_add(t, 2, "z", 1);
    if (!read_header(a) || !choose_frame(a, frame, notes) || !read_values(a, notes))
        return false;
    bool more = next_word(a).len > 0;
    while (frame != NULL && more) /* the program that writes it is not stopped before its end */
        more = next_word(a).len > 0;
    if (a->f->fatal)
        return false;
    return !more || points_file_stop(a->f, "there are more than %" PRIu32 " x %" PRIu32 " values",
                                     notes->frame.columns, notes->frame.rows);
}

bool asc_text_read(struct points_file *f, const char *text, size_t n,
                   const struct grid_frame *frame, struct table_fields *t, struct grid_notes *notes)
{
    struct asc a = {
        .f = f, .p = text + text_mark_length(text, n), .end = text + n, .fd = -1, .line = 1};
    *notes = (struct grid_notes){.nodata = usual_nodata};
    return read_grid(&a, frame, t, notes);
}

bool asc_file_read(struct points_file *f, int fd, const struct grid_frame *frame,
                   struct table_fields *t, struct grid_notes *notes)
{
    struct asc a = {.f = f, .block = malloc(BLOCK), .fd = fd, .line = 1};
    *notes = (struct grid_notes){.nodata = usual_nodata};
    if (a.block == NULL)
        return points_file_stop(f, "out of memory");
    a.p = a.end = a.block;
    while (a.end - a.block < 3 && read_more(&a, (size_t)(a.end - a.block)))
        continue;
    a.p += text_mark_length(a.p, (size_t)(a.end - a.p));
    bool ok = f->fault == NULL && read_grid(&a, frame, t, notes);
    free(a.block);
    return ok;
}

void grid_describe(const struct grid_notes *notes, char *to, size_t room)
{
    const struct grid_frame *g = &notes->frame;
    snprintf(to, room, "the centres of %" PRIu32 " x %" PRIu32 " cells of %.6g x %.6g", g->columns,
             g->rows, hypot(g->column[0], g->column[1]), hypot(g->row[0], g->row[1]));
}
