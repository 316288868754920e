/* table_file.c - see table_file.h. */
#include "clients/files/table_file.h"

#include "clients/files/headings.h"
#include "proto/number.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

struct value {
    const char *text;
    size_t len;
};

static bool is_blank(char c)
{
    return c == ' ' || c == '\t' || c == '\r';
}

static const char *skip_blanks(const char *s, const char *end, char separator)
{
    while (s < end && is_blank(*s) && *s != separator)
        s++;
    return s;
}

static struct value trimmed(const char *s, const char *end)
{
    while (s < end && is_blank(*s))
        s++;
    while (end > s && is_blank(end[-1]))
        end--;
    return (struct value){s, (size_t)(end - s)};
}

/* ---- rows ---- */

static bool ends_value(char c, char separator)
{
    return separator == ' ' ? is_blank(c) : c == separator;
}

/* The closing quote of a value whose opening one is before s, or `end`; a doubled one does not close. */
static const char *find_quote(const char *s, const char *end)
{
    for (; s < end; s++)
        if (*s == '"') {
            if (s + 1 == end || s[1] != '"')
                return s;
            s++;
        }
    return end;
}

/* The value at *s, which moves behind it and its separator; false at the end of the row. Quotes count only
 * where a value begins. */
static bool next_value(const char **s, const char *end, char separator, struct value *v)
{
    const char *p = *s;
    if (p > end)
        return false;
    p = separator == ' ' ? trimmed(p, end).text : skip_blanks(p, end, separator);
    if (separator == ' ' && p == end)
        return false;
    const char *start = p;
    if (p < end && *p == '"') {
        p = find_quote(p + 1, end);
        *v = (struct value){start + 1, (size_t)(p - start) - 1};
        if (p < end)
            p++;
        start = NULL;
    }
    while (p < end && !ends_value(*p, separator))
        p++;
    if (start != NULL)
        *v = trimmed(start, p);
    *s = p + 1;
    return true;
}

static bool find_value(const char *s, const char *end, char separator, size_t column,
                       struct value *v)
{
    for (size_t i = 0; next_value(&s, end, separator, v); i++)
        if (i == column)
            return true;
    return false;
}

/* Where the row at s ends, beyond line breaks in quotes. Before the separator is known any may be it. */
static const char *find_row_end(const struct points_file *f, const char *s, const char *end)
{
    static const char candidates[] = ",;\t|";
    const struct table_file *t = f->parser;
    const char *lf = memchr(s, '\n', (size_t)(end - s));
    if (lf == NULL || memchr(s, '"', (size_t)(lf - s)) == NULL || *trimmed(s, lf).text == '#')
        return lf;
    bool begins = true;
    for (const char *p = s; p < end; p++) {
        if (*p == '\n')
            return p;
        if (begins && *p == '"' && (p = find_quote(p + 1, end)) == end)
            return NULL;
        begins = t->separator == ' ' ? is_blank(*p)
                 : t->separator != 0 ? *p == t->separator || (begins && is_blank(*p))
                                     : strchr(candidates, *p) != NULL || is_blank(*p);
    }
    return NULL;
}

/* ---- numbers ---- */

enum { NUMBER_ROOM = 64 };

/* If semicolons separate, a comma is a decimal comma: then the number with a decimal point, in
 * room[NUMBER_ROOM]. */
static struct value with_point(char separator, struct value v, char *room)
{
    const char *comma = separator == ';' ? memchr(v.text, ',', v.len) : NULL;
    if (comma == NULL || v.len > NUMBER_ROOM || memchr(v.text, '.', v.len) != NULL)
        return v;
    memcpy(room, v.text, v.len);
    room[comma - v.text] = '.';
    return (struct value){room, v.len};
}

static bool is_number(char separator, struct value v)
{
    char room[NUMBER_ROOM];
    double number;
    v = with_point(separator, v, room);
    return proto_read_double(v.text, v.len, &number);
}

static bool add_point(struct points_file *f, char separator, struct value x, struct value y)
{
    char room[2][NUMBER_ROOM];
    x = with_point(separator, x, room[0]);
    y = with_point(separator, y, room[1]);
    return points_file_add(f, x.text, x.len, y.text, y.len);
}

/* ---- the first row ---- */

/* The separator that the row has outside of quotes. */
static char find_separator(const char *s, const char *end)
{
    static const char candidates[] = "\t;|,";
    bool begins = true, seen[sizeof candidates] = {false};
    for (const char *p = s; p < end; p++) {
        if (begins && *p == '"' && (p = find_quote(p + 1, end)) == end)
            break;
        const char *c = strchr(candidates, *p);
        begins = c != NULL && *c != '\0';
        if (begins)
            seen[c - candidates] = true;
        begins |= is_blank(*p);
    }
    for (size_t i = 0; candidates[i] != '\0'; i++)
        if (seen[i])
            return candidates[i];
    return ' ';
}

bool table_choose_columns(struct table_file *t, const char *text)
{
    const char *comma = strchr(text, ',');
    if (comma == NULL)
        return false;
    struct value part[2] = {{text, (size_t)(comma - text)}, {comma + 1, strlen(comma + 1)}};
    t->chosen = true;
    for (int i = 0; i < 2; i++) {
        uint32_t number;
        if (part[i].len == 0 || part[i].len >= TABLE_NAME_LIMIT)
            return false;
        if (!proto_read_u32(part[i].text, part[i].len, &number))
            memcpy(t->name[i], part[i].text, part[i].len);
        else if (number == 0)
            return false;
        else
            t->column[i] = number - 1;
    }
    return true;
}

static bool find_name(const char *s, const char *end, char separator, const char *name,
                      size_t *column)
{
    struct value v;
    for (size_t i = 0; next_value(&s, end, separator, &v); i++)
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
    for (; next_value(&s, end, t->separator, &v); i++)
        if (n + 80 < sizeof list)
            n += (size_t)snprintf(list + n, sizeof list - n, " %zu=%.*s", i + 1, shown(v), v.text);
        else if (list[n - 1] != '.')
            n += (size_t)snprintf(list + n, sizeof list - n, " ...");
    return points_file_stop(f, "%s; columns found:%s; choose with --columns X,Y, names or numbers",
                            what, list);
}

/* Says which columns are used. */
static void note_using(struct table_file *t, const char *s, const char *end, bool header)
{
    struct value v[2];
    for (int i = 0; i < 2; i++)
        if (!header || !find_value(s, end, t->separator, t->column[i], &v[i]))
            v[i] = (struct value){"", 0};
    if (header)
        snprintf(t->using, sizeof t->using, "x=%.*s y=%.*s", shown(v[0]), v[0].text, shown(v[1]),
                 v[1].text);
    else
        snprintf(t->using, sizeof t->using, "x=%zu y=%zu of %zu, without a header",
                 t->column[0] + 1, t->column[1] + 1, t->columns);
}

static bool choose_by_headings(struct table_file *t, const char *s, const char *end, bool *obvious)
{
    struct heading_search search = {.columns = 0};
    struct value v;
    while (next_value(&s, end, t->separator, &v))
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
        for (const char *p = s; next_value(&p, end, separator, &v);)
            n++;
        t->separator = separator;
        bool chosen = n == t->columns && choose_by_headings(t, s, end, &obvious);
        if (chosen)
            note_using(t, s, end, true);
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
        if (!find_value(s, end, t->separator, i, &v[i]) || !is_number(t->separator, v[i]))
            return refuse(f, s, end, "no header, and the first two columns are not numbers");
    if (t->columns > 2 && !t->xyz) {
        note_using(t, s, end, false);
        t->counting = true;
    }
    return true;
}

static bool choose_columns(struct points_file *f, const char *s, const char *end, bool *header)
{
    struct table_file *t = f->parser;
    struct value v;
    bool obvious, numbers = false;
    *header = choose_by_headings(t, s, end, &obvious);
    if (*header) {
        if (!obvious)
            note_using(t, s, end, true);
        return true;
    }
    for (const char *p = s; next_value(&p, end, t->separator, &v);) {
        numbers |= is_number(t->separator, v);
        t->columns++;
    }
    size_t columns = t->columns;
    if (numbers)
        return start_without_header(f, s, end);
    if (columns == 1)
        return points_file_stop(f, "not a number");
    return refuse(f, s, end, "no headings that are known for x and y");
}

/* The first row: *header says whether it is one. */
static bool start_csv(struct points_file *f, const char *s, const char *end, bool *header)
{
    struct table_file *t = f->parser;
    struct value v;
    bool named = t->name[0][0] != '\0' || t->name[1][0] != '\0', ok = true;
    if (t->separator == 0)
        t->separator = find_separator(s, end);
    t->columns = 0;
    for (int i = 0; i < 2; i++)
        if (t->name[i][0] != '\0' && !find_name(s, end, t->separator, t->name[i], &t->column[i])) {
            char what[TABLE_NAME_LIMIT + 40];
            snprintf(what, sizeof what, "no column is named %s", t->name[i]);
            return refuse(f, s, end, what);
        }
    *header = named || (t->chosen && (!find_value(s, end, t->separator, t->column[0], &v) ||
                                      !is_number(t->separator, v)));
    if (!t->chosen)
        ok = choose_columns(f, s, end, header);
    t->columns = 0;
    for (const char *p = s; next_value(&p, end, t->separator, &v);)
        t->columns++;
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
    for (; next_value(&s, end, t->separator, &v); n++) {
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
    struct value row = trimmed(s, end);
    if (row.len > 0 && row.text[0] == '#' && !t->started && row.len < TABLE_COMMENT_ROOM) {
        memcpy(t->comment, row.text + 1, row.len - 1);
        t->comment[row.len - 1] = '\0';
    }
    return row.len == 0 || row.text[0] == '#' || (!t->started && is_separator_line(t, row));
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
    if (!t->started) {
        t->started = true;
        if (t->node)
            header = true;
        else if (!start_csv(f, s, end, &header))
            return false;
        t->any_length = t->node || t->xyz || (t->chosen && !header);
    }
    if (header)
        return true;
    if (!find_both(f, s, end, &x, &y) || !add_point(f, t->separator, x, y))
        return false;
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
