/* sample.c - see sample.h. */
#include "clients/reading/sample.h"

#include <string.h>

#include "clients/reading/wkt.h"
#include "proto/number.h"

static const struct number_style lenient = {.comma = COMMA_DECIMAL};

bool sample_is_number(struct value v)
{
    double x;
    bool solid;
    struct value unit;
    return proto_read_double(v.text, v.len, &x) || number_shape(v) != SHAPE_NONE ||
           number_read_degrees(&lenient, v, 0, &x) || number_read_degrees(&lenient, v, 1, &x) ||
           wkt_is_geometry(v, &solid) ||
           (number_split_unit(&v, &unit) && number_shape(v) != SHAPE_NONE);
}

bool sample_is_heading(const struct value *value, size_t n)
{
    struct heading_search search = {0};
    size_t column[2];
    bool obvious;
    for (size_t i = 0; i < n; i++)
        heading_search_add(&search, i, value[i].text, value[i].len);
    return heading_search_end(&search, column, &obvious);
}

static void look_at(struct sample *s, const struct row_style *style, struct sample_row *row)
{
    bool any = false, solid;
    size_t n = row_split(style, row->s, row->end, s->value, PLAN_COLUMNS);
    row->columns = n < PLAN_COLUMNS ? n : PLAN_COLUMNS;
    for (size_t i = 0; i < row->columns; i++) {
        any |= s->value[i].len > 0;
        row->numbers += sample_is_number(s->value[i]);
        row->points += wkt_is_geometry(s->value[i], &solid);
    }
    if (!any)
        row->columns = 0;
}

void sample_take(struct sample *s, const struct row_style *style)
{
    const char *p = s->text;
    size_t comments = 0;
    s->n = 0;
    for (uint64_t line = 1; p < s->end && s->n < s->most; line++) {
        struct row_quotes quotes = {0};
        const char *end = row_end(style, p, s->end, s->whole, &quotes);
        if (end == NULL && !s->whole)
            break;
        if (end == NULL)
            end = s->end;
        struct sample_row *row = &s->row[s->n];
        *row = (struct sample_row){p, end, line, row_kind(p, end), 0, 0, 0};
        bool comment = row->kind == ROW_COMMENT;
        comments += comment;
        if (line > s->skip_lines &&
            (row->kind == ROW_VALUES || (comment && comments <= PLAN_COMMENTS))) {
            if (!comment)
                look_at(s, style, row);
            s->n++;
        }
        line += quotes.breaks;
        p = end + 1;
    }
}

size_t sample_split(struct sample *s, const struct row_style *style, size_t row)
{
    size_t n = row_split(style, s->row[row].s, s->row[row].end, s->value, PLAN_COLUMNS);
    return n < PLAN_COLUMNS ? n : PLAN_COLUMNS;
}

static bool has_values(const struct sample_row *row)
{
    return row->kind == ROW_VALUES && row->columns > 0;
}

size_t sample_columns(const struct sample *s, size_t from)
{
    uint16_t rows[PLAN_COLUMNS + 1] = {0};
    size_t best = 0;
    for (size_t i = from; i < s->n; i++)
        if (has_values(&s->row[i]))
            rows[s->row[i].columns]++;
    for (size_t n = 1; n <= PLAN_COLUMNS; n++)
        if (rows[n] > rows[best])
            best = n;
    return best;
}

/* ---- separators ---- */

struct fit {
    size_t rows, columns;   /* rows from the first number on; columns of most of them */
    size_t agree, full;     /* rows with so many columns; rows of nothing but numbers */
    size_t numbers, points; /* in all rows */
    bool framed;            /* a row before them has as many columns */
    bool headings;          /* a row before them has headings of x and y, as many as columns */
};

static struct fit try_separator(struct sample *s, char separator, char line_end)
{
    struct row_style style = {.separator = separator, .line_end = line_end};
    struct fit fit = {0};
    size_t from = 0;
    s->most = PLAN_ROWS / 5;
    sample_take(s, &style);
    s->most = PLAN_ROWS;
    while (from < s->n && (!has_values(&s->row[from]) || s->row[from].numbers == 0 ||
                           sample_is_heading(s->value, sample_split(s, &style, from))))
        from++;
    fit.columns = sample_columns(s, from);
    for (size_t i = from; i < s->n; i++) {
        const struct sample_row *row = &s->row[i];
        if (!has_values(row))
            continue;
        fit.rows++;
        fit.agree += row->columns == fit.columns;
        fit.full += row->columns == row->numbers && row->columns > 1;
        fit.numbers += row->numbers;
        fit.points += row->points > 0;
    }
    for (size_t i = 0; i < from && !fit.headings; i++) {
        size_t n = s->row[i].kind == ROW_VALUES ? sample_split(s, &style, i) : 0;
        fit.framed |= n > 1 && n == fit.columns;
        fit.headings = n > 1 && (fit.rows == 0 || n == fit.columns || n + 1 == fit.columns) &&
                       sample_is_heading(s->value, n);
    }
    return fit;
}

/* Most rows: all but one in ten, and one. */
static bool are_most(size_t some, size_t rows)
{
    return rows - some <= rows / 10 + (rows > 1);
}

/* Returns how well a separator fits, 4 at best. */
static int rank(const struct fit *f)
{
    if (f->headings)
        return 4;
    if (f->rows > 0 && f->rows - f->points <= f->rows / 10)
        return 3 + f->framed;
    if (f->rows == 0 || f->columns < 2)
        return 0;
    if (are_most(f->agree, f->rows) && are_most(f->full, f->rows))
        return 3;
    return are_most(f->agree, f->rows) && f->numbers >= 2 * f->agree ? 2 : 1;
}

char sample_separator(struct sample *s)
{
    static const char candidates[] = "\t;|, ";
    char line_end = memchr(s->text, '\n', (size_t)(s->end - s->text)) != NULL ? '\n' : '\r';
    char found = ' ';
    int best = 0;
    size_t rows = 0;
    for (size_t i = 0; candidates[i] != '\0'; i++) {
        struct fit fit = try_separator(s, candidates[i], line_end);
        int r = rank(&fit);
        if (r > best || (r == best && r == 1 && fit.agree > rows)) {
            best = r;
            found = candidates[i];
            rows = fit.agree;
        }
    }
    for (size_t i = 0; best == 0 && found == ' ' && i < s->n; i++) /* a heading alone */
        for (size_t k = 0; k < 4 && found == ' '; k++)
            if (s->row[i].kind == ROW_VALUES &&
                memchr(s->row[i].s, candidates[k], (size_t)(s->row[i].end - s->row[i].s)) != NULL)
                found = candidates[k];
    return found;
}

/* ---- what commas and points mean ---- */

struct number_style sample_numbers(struct sample *s, const struct plan *p, struct report *report)
{
    size_t seen[SHAPE_COUNT] = {0};
    for (size_t i = s->first; i < s->n; i++) {
        size_t n = has_values(&s->row[i]) ? sample_split(s, &p->row, i) : 0;
        for (size_t k = 0; k < n && k < p->columns; k++)
            if (p->column[k].numbers >= p->column[k].texts)
                seen[number_shape(s->value[k])]++;
    }
    struct number_style style = {.point_groups =
                                     seen[SHAPE_POINT_GROUPS] > 0 && seen[SHAPE_POINT] == 0};
    bool either = seen[SHAPE_COMMA_EITHER] > 0, separates = p->row.separator == ',';
    if (seen[SHAPE_COMMA] > 0 || seen[SHAPE_POINT_GROUPS] > 0)
        style.comma = either && seen[SHAPE_COMMA_GROUPS] > 0 ? COMMA_UNKNOWN : COMMA_DECIMAL;
    else if (seen[SHAPE_COMMA_GROUPS] > 0 || (either && seen[SHAPE_POINT] > 0))
        style.comma = COMMA_GROUPS;
    else if (either ? !separates : p->row.separator == ';' && seen[SHAPE_POINT] == 0)
        style.comma = COMMA_DECIMAL;
    style.commas =
        either || seen[SHAPE_COMMA] + seen[SHAPE_COMMA_GROUPS] > 0 || seen[SHAPE_POINT_GROUPS] > 0;
    bool certain = seen[SHAPE_COMMA] + seen[SHAPE_COMMA_GROUPS] + seen[SHAPE_POINT_GROUPS] > 0;
    if (either && !certain && style.comma != COMMA_UNKNOWN)
        report_add(report, NOTE_DOUBT, "commas as in 1,234 are taken for %s",
                   style.comma == COMMA_DECIMAL ? "decimal commas" : "separators of thousands");
    if (seen[SHAPE_POINT_EITHER] > 0 && seen[SHAPE_COMMA] > 0 && !style.point_groups)
        report_add(report, NOTE_DOUBT,
                   "beside decimal commas, points as in 1.234 are taken for "
                   "decimal points");
    return style;
}

/* ---- columns ---- */

static void note_number(struct column *c, const struct number_style *style, struct value v)
{
    double x;
    if (!number_read(style, v, &x) && !number_read(&lenient, v, &x))
        return;
    bool whole = memchr(v.text, '.', v.len) == NULL && memchr(v.text, ',', v.len) == NULL;
    bool first = c->numbers == 0;
    c->ascending = first || (c->ascending && x > c->last);
    c->counting = first || (c->counting && x == c->last + 1);
    c->even = c->numbers < 2 || (c->even && x - c->last == c->step);
    c->step = first ? 0 : x - c->last;
    c->least = first || x < c->least ? x : c->least;
    c->greatest = first || x > c->greatest ? x : c->greatest;
    c->last = x;
    c->decimals += !whole;
    c->numbers++;
}

static void note_value(struct column *c, const struct number_style *style, struct value v,
                       uint64_t line)
{
    double degrees;
    bool solid;
    struct value number = v, unit;
    if (number_shape(v) != SHAPE_NONE) {
        note_number(c, style, v);
        return;
    }
    bool missing = number_is_missing(v);
    c->missing += missing;
    if (missing)
        return;
    if (c->text[0] == '\0') {
        report_clean(c->text, sizeof c->text, v.text, v.len);
        c->text_line = line;
    }
    if (number_read_degrees(&lenient, v, 0, &degrees) ||
        number_read_degrees(&lenient, v, 1, &degrees)) {
        c->degrees++;
    } else if (wkt_is_geometry(v, &solid)) {
        c->points++;
        c->solid += solid;
    } else if (number_split_unit(&number, &unit) && number_shape(number) != SHAPE_NONE &&
               unit.len < sizeof c->unit && (c->units == 0 || value_is_word(unit, c->unit))) {
        memcpy(c->unit, unit.text, unit.len);
        c->unit[unit.len] = '\0';
        c->units++;
        note_number(c, style, number);
    } else {
        c->texts++;
    }
}

void sample_describe(struct sample *s, struct plan *p)
{
    for (size_t i = 0; i < p->columns; i++) {
        struct column *c = &p->column[i];
        struct column fresh = {.role = c->role};
        memcpy(fresh.heading, c->heading, sizeof fresh.heading);
        *c = fresh;
    }
    for (size_t i = s->first; i < s->n; i++) {
        size_t n = has_values(&s->row[i]) ? sample_split(s, &p->row, i) : 0;
        for (size_t k = 0; k < n && k < p->columns; k++) {
            const struct value v = s->value[k];
            p->column[k].quoted += v.text > s->text && v.text[-1] == '"';
            note_value(&p->column[k], &p->number, v, s->row[i].line);
        }
    }
}
