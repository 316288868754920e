/* table_file.c - see table_file.h. */
#include "clients/files/table_file.h"

#include "clients/files/headings.h"
#include "clients/files/table_row.h"
#include "proto/number.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

/* Where the row at s ends, beyond line breaks in quotes. Before the separator is known any may be it. */
static const char *find_row_end(const struct points_file *f, const char *s, const char *end)
{
    static const char candidates[] = ",;\t|";
    const struct table_file *t = f->parser;
    const char *lf = memchr(s, '\n', (size_t)(end - s));
    if (lf == NULL || memchr(s, '"', (size_t)(lf - s)) == NULL || *value_trim(s, lf).text == '#')
        return lf;
    bool begins = true;
    for (const char *p = s; p < end; p++) {
        if (*p == '\n')
            return p;
        if (begins && *p == '"' && (p = value_quote_end(p + 1, end)) == end)
            return NULL;
        begins = t->separator == ' ' ? value_is_blank(*p)
                 : t->separator != 0 ? *p == t->separator || (begins && value_is_blank(*p))
                                     : strchr(candidates, *p) != NULL || value_is_blank(*p);
    }
    return NULL;
}

static bool add_point(struct points_file *f, char separator, struct value x, struct value y)
{
    char room[2][NUMBER_ROOM];
    x = value_with_point(separator, x, room[0]);
    y = value_with_point(separator, y, room[1]);
    return points_file_add(f, x.text, x.len, y.text, y.len);
}

/* ---- the first row ---- */

/* The separator that the row has outside of quotes. */
static char find_separator(const char *s, const char *end)
{
    static const char candidates[] = "\t;|,";
    bool begins = true, seen[sizeof candidates] = {false};
    for (const char *p = s; p < end; p++) {
        if (begins && *p == '"' && (p = value_quote_end(p + 1, end)) == end)
            break;
        const char *c = strchr(candidates, *p);
        begins = c != NULL && *c != '\0';
        if (begins)
            seen[c - candidates] = true;
        begins |= value_is_blank(*p);
    }
    for (size_t i = 0; candidates[i] != '\0'; i++)
        if (seen[i])
            return candidates[i];
    return ' ';
}

bool table_choose_columns(struct table_file *t, const char *text)
{
    int n = 0;
    for (bool more = true; more; n++) {
        size_t len = strcspn(text, ",");
        uint32_t number;
        if (n == 3 || len == 0 || len >= TABLE_NAME_LIMIT)
            return false;
        if (!proto_read_u32(text, len, &number))
            memcpy(t->name[n], text, len);
        else if (number == 0)
            return false;
        else
            t->column[n] = number - 1;
        more = text[len] == ',';
        text += len + more;
    }
    t->chosen = true;
    t->has_z = n == 3;
    return n >= 2;
}

static bool find_name(const char *s, const char *end, char separator, const char *name,
                      size_t *column)
{
    struct value v;
    for (size_t i = 0; row_next(&s, end, separator, &v); i++)
        if (v.len == strlen(name) && strncasecmp(v.text, name, v.len) == 0) {
            *column = i;
            return true;
        }
    return false;
}

static int shown(struct value v)
{
    return v.len < 40 ? (int)v.len : 40;
}

/* Lists the columns of a row, and says what the user can do. */
static bool refuse(struct points_file *f, const char *s, const char *end, const char *what)
{
    const struct table_file *t = f->parser;
    char list[700];
    size_t n = 0, i = 0;
    struct value v;
    list[0] = '\0';
    for (; row_next(&s, end, t->separator, &v); i++)
        if (n + 80 < sizeof list)
            n += (size_t)snprintf(list + n, sizeof list - n, " %zu=%.*s", i + 1, shown(v), v.text);
        else if (list[n - 1] != '.')
            n += (size_t)snprintf(list + n, sizeof list - n, " ...");
    return points_file_stop(f, "%s; columns found:%s; choose with --columns X,Y, names or numbers",
                            what, list);
}

/* Keeps the headings or numbers of the columns of x and y. */
static void note_using(struct table_file *t, const char *s, const char *end, bool header)
{
    struct value v[2];
    for (int i = 0; i < 2; i++)
        if (!header || !row_find(s, end, t->separator, t->column[i], &v[i]))
            v[i] = (struct value){"", 0};
    if (header)
        snprintf(t->using, sizeof t->using, "x=%.*s y=%.*s", shown(v[0]), v[0].text, shown(v[1]),
                 v[1].text);
    else
        snprintf(t->using, sizeof t->using, "x=%zu y=%zu", t->column[0] + 1, t->column[1] + 1);
    t->headless = !header;
}

/* At the first row of values: notes which columns are used, to report them if that is not obvious. */
static void finish_using(struct table_file *t)
{
    const struct table_fields *e = &t->fields;
    size_t n = strlen(t->using), room = sizeof t->using - 60;
    if (!t->report && e->n == 0) {
        t->using[0] = '\0';
        return;
    }
    for (size_t i = 0; i < e->n && n + 2 * FIELDS_NAME < room; i++) {
        bool height = strcmp(e->name[i], "z") == 0 && e->height[0] != '\0';
        n += (size_t)snprintf(t->using + n, room - n, "%s%s%s%s", n > 0 ? " " : "", e->name[i],
                              height ? "=" : "", height ? e->height : "");
    }
    if (t->headless && e->n + 2 < t->columns)
        n += (size_t)snprintf(t->using + n, sizeof t->using - n, " of %zu", t->columns);
    if (t->headless)
        snprintf(t->using + n, sizeof t->using - n, ", without a header");
}

static bool choose_by_headings(struct table_file *t, const char *s, const char *end, bool *obvious)
{
    struct heading_search search = {.columns = 0};
    struct value v;
    while (row_next(&s, end, t->separator, &v))
        heading_search_add(&search, v.text, v.len);
    return heading_search_end(&search, t->column, obvious);
}

/* The comment before the first row as its header, if it has as many words. */
static bool choose_by_comment(struct table_file *t)
{
    const char *s = t->comment, *end = s + strlen(s);
    bool obvious;
    for (int i = 0; i < 2; i++) {
        char separator = i == 0 ? t->separator : find_separator(s, end), mine = t->separator;
        size_t n = 0;
        struct value v;
        for (const char *p = s; row_next(&p, end, separator, &v);)
            n++;
        t->separator = separator;
        bool chosen = n == t->columns && choose_by_headings(t, s, end, &obvious);
        if (chosen) {
            note_using(t, s, end, true);
            t->report = true;
            table_fields_add_headings(&t->fields, s, end, separator, t->column);
        }
        t->separator = mine;
        if (chosen)
            return true;
    }
    return false;
}

/* A first row that is not a header, or is not recognised as one. */
static bool start_without_header(struct points_file *f, const char *s, const char *end)
{
    struct table_file *t = f->parser;
    struct value v[2] = {{NULL, 0}, {NULL, 0}};
    if (t->comment[0] != '\0' && choose_by_comment(t))
        return true;
    t->column[0] = 0;
    t->column[1] = 1;
    if (t->columns < 2)
        return points_file_stop(f, "a point needs x and y");
    for (size_t i = 0; i < 2; i++)
        if (!row_find(s, end, t->separator, i, &v[i]) || !value_is_number(t->separator, v[i]))
            return refuse(f, s, end, "no header, and the first two columns are not numbers");
    note_using(t, s, end, false);
    t->counting = t->report = t->columns > 2 && !t->xyz;
    table_fields_add_numbers(&t->fields, t->columns, t->columns == 3 || (t->xyz && t->columns > 3),
                             t->column);
    return true;
}

static bool choose_columns(struct points_file *f, const char *s, const char *end, bool *header)
{
    struct table_file *t = f->parser;
    struct value v;
    bool obvious, numbers = false;
    *header = choose_by_headings(t, s, end, &obvious);
    if (*header) {
        note_using(t, s, end, true);
        t->report = !obvious;
        table_fields_add_headings(&t->fields, s, end, t->separator, t->column);
        return true;
    }
    for (const char *p = s; row_next(&p, end, t->separator, &v);) {
        numbers |= value_is_number(t->separator, v);
        t->columns++;
    }
    size_t columns = t->columns;
    if (numbers)
        return start_without_header(f, s, end);
    if (columns == 1)
        return points_file_stop(f, "not a number");
    return refuse(f, s, end, "no headings that are known for x and y");
}

/* The fields beside columns of x and y that the caller chose. */
static void choose_fields(struct table_file *t, const char *s, const char *end, bool header)
{
    struct value v = {"", 0};
    note_using(t, s, end, header);
    if (t->has_z && header)
        row_find(s, end, t->separator, t->column[2], &v);
    if (t->has_z)
        table_fields_add_height(&t->fields, t->column[2], v.text, v.len);
    if (t->fields.all && header)
        table_fields_add_headings(&t->fields, s, end, t->separator, t->column);
    else if (t->fields.all)
        table_fields_add_numbers(&t->fields, t->columns, false, t->column);
}

/* The header of a .node file: points, dimensions, attributes, markers. */
static void start_node(struct table_file *t, const char *s, const char *end)
{
    struct value v;
    uint32_t attributes;
    if (!t->fields.all || !row_find(s, end, ' ', 2, &v) ||
        !proto_read_u32(v.text, v.len, &attributes))
        return;
    for (uint32_t i = 0; i < attributes; i++) {
        char name[20];
        int n = snprintf(name, sizeof name, "a%u", i + 1);
        if (!table_fields_add(&t->fields, 3 + i, name, (size_t)n))
            return;
    }
}

/* The first row: *header says whether it is one. */
static bool start_csv(struct points_file *f, const char *s, const char *end, bool *header)
{
    struct table_file *t = f->parser;
    struct value v;
    bool named = t->name[0][0] != '\0' || t->name[1][0] != '\0' || t->name[2][0] != '\0', ok = true;
    if (t->separator == 0)
        t->separator = find_separator(s, end);
    t->columns = 0;
    for (int i = 0; i < 3; i++)
        if (t->name[i][0] != '\0' && !find_name(s, end, t->separator, t->name[i], &t->column[i])) {
            char what[TABLE_NAME_LIMIT + 40];
            snprintf(what, sizeof what, "no column is named %s", t->name[i]);
            return refuse(f, s, end, what);
        }
    *header = named || (t->chosen && (!row_find(s, end, t->separator, t->column[0], &v) ||
                                      !value_is_number(t->separator, v)));
    if (!t->chosen)
        ok = choose_columns(f, s, end, header);
    t->columns = 0;
    for (const char *p = s; row_next(&p, end, t->separator, &v);)
        t->columns++;
    if (t->chosen)
        choose_fields(t, s, end, *header);
    return ok;
}

/* ---- all rows ---- */

/* Finds both values. A row that is longer than the first one may have them in other columns: 1,5,2,5 under
 * x,y. */
static bool find_both(struct points_file *f, const char *s, const char *end, struct value *x,
                      struct value *y)
{
    struct table_file *t = f->parser;
    struct value v;
    size_t n = 0;
    bool longer = false;
    for (; row_next(&s, end, t->separator, &v); n++) {
        if (n == t->column[0])
            *x = v;
        if (n == t->column[1])
            *y = v;
        longer |= n >= t->columns && v.len > 0;
    }
    if (n <= t->column[0] || n <= t->column[1])
        return points_file_fault(f, "the row has too few columns");
    return t->any_length || !longer ||
           points_file_fault(f, "the row has more columns than the first one");
}

/* Without a header: a first column that counts 1, 2, 3 is not a coordinate. */
static bool check_counting(struct points_file *f, double x)
{
    struct table_file *t = f->parser;
    bool counts = x == floor(x) && (t->counted == 0 || x == t->count + 1);
    t->count = x;
    if (counts && ++t->counted == 3)
        return points_file_stop(f, "no header, and the first column counts rows; choose with "
                                   "--columns, for instance 2,3");
    t->counting = counts;
    return true;
}

/* Excel's first line: sep=; */
static bool is_separator_line(struct table_file *t, struct value row)
{
    if (row.len != 5 || strncasecmp(row.text, "sep=", 4) != 0)
        return false;
    t->separator = row.text[4];
    return true;
}

static bool is_no_row(struct table_file *t, const char *s, const char *end)
{
    struct value row = value_trim(s, end);
    if (row.len > 0 && row.text[0] == '#' && !t->started && row.len < TABLE_COMMENT_ROOM) {
        memcpy(t->comment, row.text + 1, row.len - 1);
        t->comment[row.len - 1] = '\0';
    }
    return row.len == 0 || row.text[0] == '#' || (!t->started && is_separator_line(t, row));
}

static bool start(struct points_file *f, const char *s, const char *end, bool *header)
{
    struct table_file *t = f->parser;
    t->started = true;
    if (t->node) {
        *header = true;
        start_node(t, s, end);
    } else if (!start_csv(f, s, end, header)) {
        return false;
    }
    t->any_length = t->node || t->xyz || (t->chosen && !*header);
    return true;
}

/* At the first row of values. */
static void start_values(struct points_file *f, const char *s, const char *end)
{
    struct table_file *t = f->parser;
    t->has_values = true;
    table_fields_sort(&t->fields);
    table_fields_check(&t->fields, s, end, t->separator, t->has_z ? t->column[2] : SIZE_MAX);
    finish_using(t);
    f->fields = t->fields.n;
    f->row = t->fields.row;
}

static bool parse_row(struct points_file *f, const char *s, const char *end)
{
    struct table_file *t = f->parser;
    struct value x = {NULL, 0}, y = x;
    bool header = false;
    if (is_no_row(t, s, end))
        return true;
    if (memchr(s, '\0', (size_t)(end - s)) != NULL)
        return points_file_stop(f, "not a text file");
    if (!t->started && !start(f, s, end, &header))
        return false;
    if (header)
        return true;
    if (!t->has_values)
        start_values(f, s, end);
    if (!find_both(f, s, end, &x, &y))
        return false;
    table_fields_read(&t->fields, s, end, t->separator);
    if (!add_point(f, t->separator, x, y))
        return false;
    table_fields_count(&t->fields);
    return !t->counting || check_counting(f, f->xy[2 * f->n - 2]);
}

void table_file_init(struct table_file *t, struct points_file *f)
{
    if (t->node) {
        t->separator = ' ';
        t->column[0] = 1;
        t->column[1] = 2;
    }
    f->parse_line = parse_row;
    f->find_end = find_row_end;
    f->parser = t;
}
