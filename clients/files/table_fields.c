/* table_fields.c - see table_fields.h. */
#include "clients/files/table_fields.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

#include "clients/files/headings.h"
#include "proto/number.h"

static bool is_taken(const struct table_fields *t, const char *name)
{
    for (size_t i = 0; i < t->n; i++)
        if (strcmp(t->name[i], name) == 0)
            return true;
    return false;
}

/* A field's name begins with a letter or '_'. */
static void make_name(char *name, const char *heading, size_t len)
{
    size_t n = 0;
    if (len > 0 && !isalpha((unsigned char)heading[0]))
        name[n++] = '_';
    for (size_t i = 0; i < len && n < FIELDS_NAME - 8; i++) {
        char c = heading[i];
        bool good = isalnum((unsigned char)c) || strchr("_.:-", c) != NULL;
        name[n++] = '_';
        if (good)
            name[n - 1] = c;
    }
    name[n] = '\0';
}

static bool has_column(const struct table_fields *t, size_t column)
{
    for (size_t i = 0; i < t->n; i++)
        if (t->column[i] == column)
            return true;
    return false;
}

bool table_fields_add_height(struct table_fields *t, size_t column, const char *heading, size_t len)
{
    snprintf(t->height, sizeof t->height, "%.*s", (int)(len < 40 ? len : 40), heading);
    if (len == 0)
        snprintf(t->height, sizeof t->height, "%zu", column + 1);
    return table_fields_add(t, column, "z", 1);
}

bool table_fields_add(struct table_fields *t, size_t column, const char *heading, size_t len)
{
    char name[FIELDS_NAME], numbered[FIELDS_NAME];
    if (t->n == FIELDS_MOST)
        return false;
    make_name(name, heading, len);
    if (len == 0)
        snprintf(name, sizeof name, "c%zu", column + 1);
    memcpy(numbered, name, sizeof name);
    for (unsigned i = 2; is_taken(t, numbered); i++)
        snprintf(numbered, sizeof numbered, "%.57s_%u", name, i);
    memcpy(t->name[t->n], numbered, sizeof numbered);
    t->column[t->n] = column;
    t->missing[t->n++] = 0;
    return true;
}

void table_fields_add_headings(struct table_fields *t, const char *s, const char *end,
                               char separator, const size_t *xy)
{
    bool any_height = t->n > 0;
    struct value v;
    for (size_t i = 0; row_next(&s, end, separator, &v); i++) {
        bool height = !any_height && heading_is_height(v.text, v.len);
        any_height |= height;
        if (i == xy[0] || i == xy[1] || has_column(t, i))
            continue;
        if (height ? !table_fields_add_height(t, i, v.text, v.len)
                   : t->all && !table_fields_add(t, i, v.text, v.len))
            break;
    }
}

void table_fields_add_numbers(struct table_fields *t, size_t columns, bool height, const size_t *xy)
{
    if (height)
        table_fields_add_height(t, 2, "", 0);
    for (size_t i = 0; t->all && i < columns; i++)
        if (i != xy[0] && i != xy[1] && !has_column(t, i) && !table_fields_add(t, i, "", 0))
            break;
}

/* By column, as rows are read. */
void table_fields_sort(struct table_fields *t)
{
    for (size_t i = 1; i < t->n; i++)
        for (size_t k = i; k > 0 && t->column[k] < t->column[k - 1]; k--) {
            char name[FIELDS_NAME];
            size_t column = t->column[k];
            memcpy(name, t->name[k], FIELDS_NAME);
            memcpy(t->name[k], t->name[k - 1], FIELDS_NAME);
            memcpy(t->name[k - 1], name, FIELDS_NAME);
            t->column[k] = t->column[k - 1];
            t->column[k - 1] = column;
        }
}

/* What tables have in the place of a number that is missing. */
static bool is_missing(struct value v)
{
    static const char *const words[] = {"", "-", "na", "n/a", "nan", "null", "none", "?"};
    for (size_t i = 0; i < sizeof words / sizeof words[0]; i++)
        if (v.len == strlen(words[i]) && strncasecmp(v.text, words[i], v.len) == 0)
            return true;
    return false;
}

void table_fields_check(struct table_fields *t, const char *s, const char *end, char separator,
                        size_t keep)
{
    struct value v;
    size_t kept = 0, k = 0;
    for (size_t i = 0; k < t->n && row_next(&s, end, separator, &v); i++) {
        if (i != t->column[k])
            continue;
        if (i == keep || value_is_number(separator, v) || is_missing(v)) {
            memmove(t->name[kept], t->name[k], FIELDS_NAME);
            t->column[kept++] = t->column[k];
        }
        k++;
    }
    t->n = kept;
}

/* Finite numbers alone: others cannot be stored. */
static bool read_number(char separator, struct value v, double *number)
{
    char room[NUMBER_ROOM];
    v = value_with_point(separator, v, room);
    return proto_read_double(v.text, v.len, number) && isfinite(*number);
}

void table_fields_read(struct table_fields *t, const char *s, const char *end, char separator)
{
    struct value v;
    size_t k = 0;
    for (size_t i = 0; k < t->n && row_next(&s, end, separator, &v); i++) {
        if (i != t->column[k])
            continue;
        if (!read_number(separator, v, &t->row[k]))
            t->row[k] = (double)NAN;
        k++;
    }
    for (; k < t->n; k++)
        t->row[k] = (double)NAN;
}

void table_fields_count(struct table_fields *t)
{
    for (size_t k = 0; k < t->n; k++)
        t->missing[k] += isnan(t->row[k]) != 0;
}
