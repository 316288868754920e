/* sample.h - the first rows of a table, and what they show when they are split in one way or another. */
#pragma once

#include "clients/reading/plan.h"
#include "clients/reading/report.h"

enum { PLAN_COMMENTS = 100 };

struct sample_row {
    const char *s, *end;
    uint64_t line;
    enum row_kind kind;
    size_t columns; /* values; 0: all are empty */
    size_t numbers; /* how many of them are numbers or points */
    size_t points;
};

struct sample {
    const char *text, *end;
    bool whole;
    uint64_t skip_lines;
    struct sample_row row[PLAN_ROWS]; /* those of values, and the first comments */
    size_t n, most;                   /* rows; how many are taken */
    size_t first; /* the first row of values that is not a heading, a title or the like */
    struct value value[PLAN_COLUMNS]; /* of the row that was split last */
};

/* Collects the first rows in this style. */
void sample_take(struct sample *s, const struct row_style *style);

/* Splits a row; at most PLAN_COLUMNS values count. */
size_t sample_split(struct sample *s, const struct row_style *style, size_t row);

/* The number of columns that most rows of values have, from row `from` on. */
size_t sample_columns(const struct sample *s, size_t from);

/* Decides what separates the values of a row, and what their commas and points mean. */
char sample_separator(struct sample *s);
struct number_style sample_numbers(struct sample *s, const struct plan *p, struct report *report);

/* Whether it is a number in some style, degrees, a number with a unit, or a point. */
bool sample_is_number(struct value v);

/* Whether these values are headings that name x and y. */
bool sample_is_heading(const struct value *value, size_t n);

/* Fills in what p->column says of values. */
void sample_describe(struct sample *s, struct plan *p);
