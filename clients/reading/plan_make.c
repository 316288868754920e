/* plan_make.c - see plan.h: the heading, the first row, and how many columns there are; roles.c decides what they are. */
#include "clients/reading/plan_make.h"

#include <stdlib.h>
#include <string.h>

#include "clients/reading/roles.h"
#include "clients/reading/sample.h"
#include "proto/number.h"

bool wish_columns(struct wish *w, const char *text)
{
    int n = 0;
    for (bool more = true; more; n++) {
        size_t len = strcspn(text, ",");
        uint32_t number;
        if (n == 3 || len == 0 || len >= PLAN_NAME - 1)
            return false;
        w->name[n][0] = '\0';
        if (!proto_read_u32(text, len, &number)) {
            memcpy(w->name[n], text, len);
            w->name[n][len] = '\0';
        } else if (number == 0) {
            return false;
        } else {
            w->column[n] = number - 1;
        }
        more = text[len] == ',';
        text += len + more;
    }
    w->chosen = true;
    w->has_z = n == 3;
    return n >= 2;
}

/* ---- headings ---- */

/* Takes the values that were split last as headings, from column `shift` on. */
static void take_headings(struct plan *p, const struct sample *s, size_t n, size_t shift)
{
    for (size_t i = 0; i < n && i + shift < p->columns; i++)
        report_clean(p->column[i + shift].heading, PLAN_NAME, s->value[i].text, s->value[i].len);
}

static bool has_name(const struct sample *s, size_t n, const char *name)
{
    for (size_t i = 0; i < n; i++)
        if (value_is_word(s->value[i], name))
            return true;
    return name[0] == '\0';
}

/* Whether the values that were split last are what the caller or the reader looks for. */
static bool is_wanted(const struct sample *s, size_t n, const struct wish *w)
{
    if (w->chosen)
        return (w->name[0][0] != '\0' || w->name[1][0] != '\0' || w->name[2][0] != '\0') &&
               has_name(s, n, w->name[0]) && has_name(s, n, w->name[1]) &&
               has_name(s, n, w->name[2]);
    return sample_is_heading(s->value, n);
}

static bool is_unit(struct value v)
{
    return v.len > 0 && (v.text[0] == '(' || v.text[0] == '[');
}

/* Removes values such as (deg) and [m], which belong to the headings before them, if that leaves the columns of the table. */
static size_t drop_units(struct sample *s, size_t n, size_t columns)
{
    size_t units = 0, kept = 0;
    for (size_t i = 0; i < n; i++)
        units += is_unit(s->value[i]);
    if (units == 0 || n - units != columns)
        return n;
    for (size_t i = 0; i < n; i++)
        if (!is_unit(s->value[i]))
            s->value[kept++] = s->value[i];
    return kept;
}

/* Splits a row before the values. Its line may be a comment, with another separator. Returns the number of columns, which is that
 * of the table if possible. */
static size_t split_heading(struct sample *s, const struct plan *p, size_t row)
{
    static const char others[] = "\t;|, ";
    const struct sample_row *r = &s->row[row];
    struct row_style style = p->row;
    const char *text = r->s;
    if (r->kind == ROW_COMMENT)
        while (text < r->end && (value_is_blank(*text) || strchr("#%/", *text) != NULL))
            text++;
    size_t n = row_split(&style, text, r->end, s->value, PLAN_COLUMNS);
    for (size_t i = 0; r->kind == ROW_COMMENT && n != p->columns && others[i] != '\0'; i++) {
        style.separator = others[i];
        n = row_split(&style, text, r->end, s->value, PLAN_COLUMNS);
    }
    if (n > PLAN_COLUMNS)
        n = PLAN_COLUMNS;
    return style.separator == ' ' ? drop_units(s, n, p->columns) : n;
}

/* Whether the first column has names of rows, as R writes them, so that headings begin at the second. */
static bool has_row_names(const struct plan *p)
{
    const struct column *c = &p->column[0];
    return c->texts > c->numbers || (c->quoted > 0 && c->missing == 0) ||
           (c->counting && c->numbers > 2 && c->least == 1);
}

/* The heading among the lines before the values: the first row that names what is wanted, else the first such comment. */
static bool find_heading(struct plan *p, const struct wish *w, struct sample *s)
{
    for (int comments = 0; comments < 2; comments++)
        for (size_t i = 0; i < s->first; i++) {
            const struct sample_row *r = &s->row[i];
            if (r->kind != (comments ? ROW_COMMENT : ROW_VALUES))
                continue;
            size_t n = split_heading(s, p, i);
            bool shifted = !comments && n + 1 == p->columns && has_row_names(p);
            if (!is_wanted(s, n, w) || (comments && n != p->columns && s->first < s->n))
                continue;
            if (!shifted && !comments && (n > p->columns || s->first == s->n)) {
                struct column *more = realloc(p->column, n * sizeof more[0]);
                if (more == NULL)
                    return plan_fault(p, false, "out of memory");
                p->column = more;
                for (size_t k = p->columns; k < n; k++)
                    p->column[k] = (struct column){.role = COLUMN_UNUSED};
                p->columns = n;
            } else if (!shifted && !comments && n < p->columns) {
                p->columns = n;
            }
            take_headings(p, s, n, shifted);
            p->headed = true;
            p->comment = comments > 0;
            p->heading_line = r->line;
            return true;
        }
    return true;
}

/* Without a heading that was wanted, but with a row in its place. */
static void find_other_heading(struct plan *p, struct sample *s)
{
    for (size_t i = 0; i < s->first; i++) {
        if (s->row[i].kind != ROW_VALUES || s->row[i].columns != p->columns || p->columns < 2)
            continue;
        take_headings(p, s, split_heading(s, p, i), 0);
        p->headed = true;
        p->heading_line = s->row[i].line;
        return;
    }
}

static void note_unread(const struct plan *p, const struct sample *s, struct report *report)
{
    for (size_t i = 0; i < s->first; i++) {
        const struct sample_row *r = &s->row[i];
        if (r->kind != ROW_VALUES || r->line == p->heading_line)
            continue;
        struct value v = value_trim(r->s, r->end);
        report_add(report, NOTE_SKIPPED, "line %ju is not read: %.*s", (uintmax_t)r->line,
                   v.len < 60 ? (int)v.len : 60, v.text);
    }
}

/* ---- the first row ---- */

/* The columns that have numbers: from the first number on, not fewer than other texts. Returns how many. */
static size_t find_numeric(struct sample *s, const struct plan *p, bool *numeric)
{
    size_t count = 0;
    int32_t balance[PLAN_COLUMNS] = {0};
    bool seen[PLAN_COLUMNS] = {false};
    for (size_t i = 0; i < s->n; i++) {
        size_t n = s->row[i].kind == ROW_VALUES ? sample_split(s, &p->row, i) : 0;
        for (size_t k = 0; k < n; k++) {
            bool number = sample_is_number(s->value[k]);
            seen[k] |= number;
            balance[k] += number ? 1 : !seen[k] || number_is_missing(s->value[k]) ? 0 : -1;
        }
    }
    for (size_t k = 0; k < PLAN_COLUMNS; k++) {
        numeric[k] = seen[k] && balance[k] >= 0;
        count += numeric[k];
    }
    return count;
}

/* Whether the row has numbers in half of these columns, where values may be missing. */
static bool is_of_values(struct sample *s, size_t n, const bool *numeric, size_t columns,
                         bool headed)
{
    size_t numbers = 0, missing = 0;
    for (size_t k = 0; k < n; k++) {
        numbers += numeric[k] && sample_is_number(s->value[k]);
        missing += numeric[k] && number_is_missing(s->value[k]);
    }
    if (headed && (missing == columns || columns == 0))
        return true;
    return numbers > 0 && 2 * (numbers + missing) >= columns;
}

/* The first row of values. Between it and the heading there may be two others, of units or types. */
static size_t find_first(struct sample *s, const struct plan *p, const struct wish *w)
{
    bool numeric[PLAN_COLUMNS], headed = false;
    size_t columns = find_numeric(s, p, numeric), between[3], rows = 0;
    for (size_t i = 0; i < s->n; i++) {
        if (s->row[i].kind != ROW_VALUES || s->row[i].columns == 0)
            continue;
        size_t n = split_heading(s, p, i);
        if (n > 1 && !headed && is_wanted(s, n, w)) {
            headed = true;
            continue;
        }
        if ((n > 1 || p->columns < 2) && is_of_values(s, n, numeric, columns, headed))
            return i;
        if (headed)
            between[rows++] = i;
        if (rows == 3)
            return between[0];
    }
    return rows > 0 ? between[0] : s->n;
}

/* ---- the plan ---- */

/* Excel's first line: sep=; */
static bool take_separator_line(struct plan *p, struct sample *s)
{
    const char *end = memchr(s->text, '\n', (size_t)(s->end - s->text));
    struct value v = value_trim(s->text, end != NULL ? end : s->end);
    if (v.len > 0 && v.text[0] == '"' && v.text[v.len - 1] == '"')
        v = (struct value){v.text + 1, v.len - 2};
    const char *tab = "sep=\t";
    bool found = v.len == 5 && value_is_word((struct value){v.text, 4}, "sep=");
    if (found)
        p->row.separator = v.text[4];
    else if (end != NULL && end - s->text >= 5 && strncmp(s->text, tab, 5) == 0)
        p->row.separator = '\t', found = true;
    if (found && s->skip_lines < 1)
        s->skip_lines = 1;
    return found;
}

static bool check_text(struct plan *p, const char *text, size_t n)
{
    const char *nul = memchr(text, '\0', n);
    if (nul == NULL)
        return true;
    for (const char *c = text; c < nul; c++)
        p->fault_line += *c == '\n';
    p->fault_line++;
    size_t zeros[2] = {0, 0};
    for (size_t i = 0; i < n && i < 1000; i++)
        zeros[i % 2] += text[i] == '\0';
    bool little = zeros[1] > 3 * zeros[0] + 1, big = zeros[0] > 3 * zeros[1] + 1;
    if (n > 3 && (little || big))
        return plan_fault(p, false,
                          "this is UTF-16 without a byte order mark; convert it with iconv -f "
                          "UTF-16%s -t UTF-8",
                          little ? "LE" : "BE");
    return plan_fault(p, false, "not a text file: it has NUL bytes");
}

/* Formats of grids and meshes, which begin with words of their own. */
static bool check_format(struct plan *p, const struct sample *s)
{
    static const char *const words[] = {"ncols",  "nrows", "DSAA", "DSBB", "DSRB",
                                        "north:", "OFF",   "COFF", "NOFF", "ply"};
    struct value v = value_trim(s->text, s->end);
    size_t len = 0;
    while (len < v.len && !value_is_blank(v.text[len]) && v.text[len] != '\n')
        len++;
    v.len = len;
    for (size_t i = 0; i < sizeof words / sizeof words[0]; i++)
        if (value_is_word(v, words[i])) {
            p->fault_line = 1;
            return plan_fault(p, false,
                              i < 6 ? "this is a grid, not a table of points; gdal_translate -of "
                                      "XYZ makes one of it"
                                    : "this is a mesh, not a table of points");
        }
    return true;
}

static void plan_node(struct plan *p, const struct wish *w, struct sample *s)
{
    size_t row = 0;
    while (row < s->n && s->row[row].kind != ROW_VALUES)
        row++;
    size_t n = row < s->n ? sample_split(s, &p->row, row) : 0;
    uint32_t attributes = 0;
    if (n > 2)
        proto_read_u32(s->value[2].text, s->value[2].len, &attributes);
    p->x = 1;
    p->y = 2;
    p->text = SIZE_MAX;
    p->any_length = p->obvious = true;
    p->first_line = row < s->n ? s->row[row].line + 1 : 1;
    for (size_t i = 0; i < p->columns; i++) {
        p->column[i].role = i == 1 ? COLUMN_X : i == 2 ? COLUMN_Y : COLUMN_UNUSED;
        if (i >= 3 && i - 3 < attributes) {
            snprintf(p->column[i].heading, PLAN_NAME, "a%zu", i - 2);
            if (w->all)
                p->column[i].role = COLUMN_FIELD;
        }
    }
}

static bool make(struct plan *p, const struct wish *w, struct sample *s, struct report *report)
{
    bool given = !w->node && take_separator_line(p, s);
    if (w->node)
        p->row.separator = ' ';
    else if (!given)
        p->row.separator = sample_separator(s);
    sample_take(s, &p->row);
    p->row.columns = sample_columns(s, 0);
    sample_take(s, &p->row);
    p->columns = p->row.columns;
    s->first = w->node ? 0 : find_first(s, p, w);
    p->columns = sample_columns(s, s->first);
    if (p->columns == 0)
        p->columns = sample_columns(s, 0);
    p->column = calloc(p->columns + 1, sizeof p->column[0]);
    if (p->column == NULL)
        return plan_fault(p, false, "out of memory");
    if (w->node) {
        plan_node(p, w, s);
        return true;
    }
    p->first_line = s->first < s->n ? s->row[s->first].line : UINT64_MAX;
    sample_describe(s, p);
    if (!find_heading(p, w, s))
        return false;
    if (!p->headed)
        find_other_heading(p, s);
    p->number = sample_numbers(s, p, report);
    sample_describe(s, p);
    p->row.columns = p->columns;
    p->fault_line = p->headed ? p->heading_line : s->first < s->n ? p->first_line : 0;
    if (p->fault_line == 0 && s->n > 0)
        p->fault_line = s->row[0].line;
    if (s->n == 0 && !s->whole)
        return plan_fault(p, false, "a line has more than 16 MB");
    if (s->first == s->n && !s->whole)
        return plan_fault(p, false,
                          "no numbers in the first rows; --skip-lines N leaves out lines");
    p->text = SIZE_MAX;
    if (p->columns == 0)
        return true;
    note_unread(p, s, report);
    return roles_choose(p, w, s, report);
}

bool plan_make(struct plan *p, const struct wish *w, const char *text, size_t n, bool whole,
               struct report *report)
{
    size_t mark = text_mark_length(text, n);
    if (!check_text(p, text, n))
        return false;
    struct sample *s = calloc(1, sizeof *s);
    if (s == NULL)
        return plan_fault(p, false, "out of memory");
    s->text = text + mark;
    s->end = text + n;
    s->whole = whole;
    s->most = PLAN_ROWS;
    s->skip_lines = w->skip_lines;
    bool has_lf = memchr(text, '\n', n) != NULL;
    p->row.line_end = has_lf || memchr(text, '\r', n) == NULL ? '\n' : '\r';
    bool ok = (w->skip_lines > 0 || check_format(p, s)) && make(p, w, s, report);
    free(s);
    return ok;
}

void plan_clear(struct plan *p)
{
    free(p->column);
    p->column = NULL;
}
