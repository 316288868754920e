/* table_row.c - see table_row.h. */
#include "clients/files/table_row.h"

#include "proto/number.h"

#include <string.h>

bool value_is_blank(char c)
{
    return c == ' ' || c == '\t' || c == '\r';
}

static const char *skip_blanks(const char *s, const char *end, char separator)
{
    while (s < end && value_is_blank(*s) && *s != separator)
        s++;
    return s;
}

struct value value_trim(const char *s, const char *end)
{
    while (s < end && value_is_blank(*s))
        s++;
    while (end > s && value_is_blank(end[-1]))
        end--;
    return (struct value){s, (size_t)(end - s)};
}

/* ---- rows ---- */

static bool ends_value(char c, char separator)
{
    return separator == ' ' ? value_is_blank(c) : c == separator;
}

const char *value_quote_end(const char *s, const char *end)
{
    for (; s < end; s++)
        if (*s == '"') {
            if (s + 1 == end || s[1] != '"')
                return s;
            s++;
        }
    return end;
}

bool row_next(const char **s, const char *end, char separator, struct value *v)
{
    const char *p = *s;
    if (p > end)
        return false;
    p = separator == ' ' ? value_trim(p, end).text : skip_blanks(p, end, separator);
    if (separator == ' ' && p == end)
        return false;
    const char *start = p;
    if (p < end && *p == '"') {
        p = value_quote_end(p + 1, end);
        *v = (struct value){start + 1, (size_t)(p - start) - 1};
        if (p < end)
            p++;
        start = NULL;
    }
    while (p < end && !ends_value(*p, separator))
        p++;
    if (start != NULL)
        *v = value_trim(start, p);
    *s = p + 1;
    return true;
}

bool row_find(const char *s, const char *end, char separator, size_t column, struct value *v)
{
    for (size_t i = 0; row_next(&s, end, separator, v); i++)
        if (i == column)
            return true;
    return false;
}

struct value value_with_point(char separator, struct value v, char *room)
{
    const char *comma = separator == ';' ? memchr(v.text, ',', v.len) : NULL;
    if (comma == NULL || v.len > NUMBER_ROOM || memchr(v.text, '.', v.len) != NULL)
        return v;
    memcpy(room, v.text, v.len);
    room[comma - v.text] = '.';
    return (struct value){room, v.len};
}

bool value_is_number(char separator, struct value v)
{
    char room[NUMBER_ROOM];
    double number;
    v = value_with_point(separator, v, room);
    return proto_read_double(v.text, v.len, &number);
}
