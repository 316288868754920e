/* rows_test.c - rows that take long: a piece of them ends at a bound of steps, and where its flag is set. */
#include "server/rows/rows.h"
#include "tests/server/local.h"
#include "tests/test.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define TAU 6.283185307179586

enum { RIM = 50000, PLACES = 6 };

/* Points on a circle, with a field z, and one in the middle if there is a hub. */
static void start_circle(struct local *l, bool hub)
{
    char *text = malloc((RIM + 1) * 60 + 100), *to = text;
    CHECK(text != NULL);
    to += sprintf(to, "LOAD t FIELDS z\n%s", hub ? "0 0 1\n" : "");
    for (int i = 0; i < RIM; i++)
        to += sprintf(to, "%.17g %.17g %d\n", cos(i * TAU / RIM), sin(i * TAU / RIM), i % 7);
    strcpy(to, ".\nTRIANGULATE t\nNEAREST t 0 0\n");
    local_start(l, 0);
    local_ask(l, text);
    free(text);
}

/* Near the middle: each one alone exceeds the bound of a piece. */
static void put_places(struct dt_point *place)
{
    for (int i = 0; i < PLACES; i++)
        place[i] = (struct dt_point){1e-7 * (i + 1), 1e-9};
}

static struct rows nearest_rows(struct local *l, const struct dt_point *place)
{
    return (struct rows){.version = local_set(l, "t")->current,
                         .binary = true,
                         .form = ROW_NEAREST,
                         .width = 4,
                         .place = place,
                         .places = PLACES};
}

static struct rows value_rows(struct local *l, const struct dt_point *place)
{
    static const struct dt_field *field[1];
    struct version *v = local_set(l, "t")->current;
    field[0] = dt_field_find(v->dt, "z", 1);
    return (struct rows){.version = v,
                         .form = ROW_SURFACE,
                         .surface = {.dt = v->dt,
                                     .field = field,
                                     .fields = 1,
                                     .how = DT_NATURAL,
                                     .max_edge = HUGE_VAL,
                                     .place = place,
                                     .columns = 1,
                                     .binary = true,
                                     .end = PLACES}};
}

/* The cell of the hub, whose id is 0. */
static struct rows cell_rows(struct local *l)
{
    static uint32_t hub[] = {0};
    struct rows r = {.version = local_set(l, "t")->current,
                     .binary = true,
                     .form = ROW_CELL,
                     .width = 1,
                     .ids = {hub, 1, 1}};
    struct dt_point lo = {-2, -2}, hi = {2, 2};
    CHECK(dt_cells_begin(r.version->dt, NULL, lo, hi, &r.cells) == DT_OK);
    return r;
}

/* Whole rows of this many bytes are made one a call, after a call that has found only that the next one is slow. */
static void check_one_row_a_call(struct rows r, size_t rows, size_t bytes)
{
    struct buf out = {0};
    rows_fill(&r, &out, SIZE_MAX);
    CHECK(r.status == DT_OK && r.pace.slow && !r.done && buf_len(&out) == 0);
    for (size_t made = 1; made <= rows; made++) {
        rows_fill(&r, &out, SIZE_MAX);
        CHECK(r.status == DT_OK && buf_len(&out) == made * bytes);
        CHECK(r.done == (made == rows) && r.pace.slow == !r.done);
    }
    rows_clear(&r);
    buf_free(&out);
}

TEST_TIMEOUT(rows_that_exceed_the_bound_of_a_piece_are_made_one_at_a_time, 60)
{
    struct local l;
    struct dt_point place[PLACES];
    put_places(place);
    start_circle(&l, true);
    check_one_row_a_call(nearest_rows(&l, place), PLACES, 16);
    check_one_row_a_call(cell_rows(&l), 1, 8 + 16 * RIM);
    local_stop(&l);
    start_circle(&l, false);
    check_one_row_a_call(value_rows(&l, place), PLACES, 8);
    local_stop(&l);
}

static void check_cancelled(struct rows r, bool slow)
{
    atomic_bool cancel = true;
    struct buf out = {0};
    r.pace = (struct pace){.cancel = &cancel, .slow = slow};
    rows_fill(&r, &out, SIZE_MAX);
    CHECK(r.status == DT_CANCELLED && buf_len(&out) == 0);
    rows_clear(&r);
    buf_free(&out);
}

TEST_TIMEOUT(rows_are_cancelled_also_within_one_that_takes_long, 60)
{
    struct local l;
    struct dt_point place[PLACES];
    put_places(place);
    start_circle(&l, true);
    for (int slow = 0; slow < 2; slow++) {
        check_cancelled(nearest_rows(&l, place), slow);
        check_cancelled(value_rows(&l, place), slow);
        check_cancelled(cell_rows(&l), slow);
    }
    local_stop(&l);
}
