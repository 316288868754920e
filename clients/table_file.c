/* table_file.c - see table_file.h. */
#include "clients/table_file.h"

#include "proto/number.h"

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

static struct value trimmed(const char *s, const char *end)
{
    while (s < end && is_blank(*s))
        s++;
    while (end > s && is_blank(end[-1]))
        end--;
    if (end - s >= 2 && *s == '"' && end[-1] == '"')
        return (struct value){s + 1, (size_t)(end - s) - 2};
    return (struct value){s, (size_t)(end - s)};
}

/* The value at *s, which moves behind it and its separator; false at the end of the row. */
static bool next_value(const char **s, const char *end, char separator, struct value *v)
{
    const char *p = *s;
    bool quoted = false;
    if (separator == ' ')
        while (p < end && is_blank(*p))
            p++;
    if (p > end || (separator == ' ' && p == end))
        return false;
    const char *start = p;
    for (; p < end && (quoted || (separator == ' ' ? !is_blank(*p) : *p != separator)); p++)
        quoted ^= *p == '"';
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

static bool is_number(const struct value *v)
{
    double number;
    return proto_read_double(v->text, v->len, &number);
}

static char find_separator(const char *s, const char *end)
{
    static const char candidates[] = ",;\t";
    for (const char *c = candidates; *c != '\0'; c++)
        if (memchr(s, *c, (size_t)(end - s)) != NULL)
            return *c;
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

static void guess_columns(struct table_file *t, const char *s, const char *end)
{
    static const char *const names[][2] = {{"x", "y"},
                                           {"lon", "lat"},
                                           {"lng", "lat"},
                                           {"longitude", "latitude"},
                                           {"easting", "northing"}};
    size_t column[2];
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++)
        if (find_name(s, end, t->separator, names[i][0], &column[0]) &&
            find_name(s, end, t->separator, names[i][1], &column[1])) {
            memcpy(t->column, column, sizeof column);
            return;
        }
}

/* The first row: *header tells whether it is one. */
static bool start_csv(struct table_file *t, struct points_file *f, const char *s, const char *end,
                      bool *header)
{
    struct value v;
    t->separator = find_separator(s, end);
    bool named = t->name[0][0] != '\0' || t->name[1][0] != '\0';
    for (int i = 0; i < 2; i++)
        if (t->name[i][0] != '\0' && !find_name(s, end, t->separator, t->name[i], &t->column[i]))
            return points_file_fault(f, "no column has the name that was asked for");
    if (!t->chosen)
        t->column[1] = 1;
    *header = named || !find_value(s, end, t->separator, t->column[0], &v) || !is_number(&v);
    if (*header && !t->chosen)
        guess_columns(t, s, end);
    return true;
}

static bool parse_row(struct points_file *f, const char *s, const char *end)
{
    struct table_file *t = f->parser;
    struct value x, y;
    bool header = false;
    struct value row = trimmed(s, end);
    if (row.len == 0 || row.text[0] == '#')
        return true;
    if (!t->started) {
        t->started = true;
        if (t->node)
            header = true;
        else if (!start_csv(t, f, s, end, &header))
            return false;
    }
    if (header)
        return true;
    if (!find_value(s, end, t->separator, t->column[0], &x) ||
        !find_value(s, end, t->separator, t->column[1], &y))
        return points_file_fault(f, "the row has too few columns");
    return points_file_add(f, x.text, x.len, y.text, y.len);
}

void table_file_init(struct table_file *t, struct points_file *f)
{
    if (t->node) {
        t->separator = ' ';
        t->column[0] = 1;
        t->column[1] = 2;
    }
    f->parse_line = parse_row;
    f->parser = t;
}
