/* table_fields.c - see table_fields.h. */
#include "clients/points/table_fields.h"

#include <ctype.h>
#include <stdio.h>
#include <string.h>

#include "clients/reading/number.h"
#include "clients/reading/report.h"

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

bool table_fields_add_height(struct table_fields *t, size_t column, const char *heading, size_t len)
{
    snprintf(t->height, sizeof t->height, "%.*s", (int)(len < 40 ? len : 40), heading);
    if (len == 0)
        snprintf(t->height, sizeof t->height, "%zu", column + 1);
    return table_fields_add(t, column, "z", 1);
}

void table_fields_note_odd(struct table_fields *t, size_t k, uint64_t line, const char *text,
                           size_t len)
{
    struct odd_value *odd = &t->odd[k];
    if (odd->line > 0 || number_is_missing((struct value){text, len}))
        return;
    odd->line = line;
    report_clean(odd->text, sizeof odd->text, text, len);
}

/* Moves the last field to its place by column. */
static void sort_last(struct table_fields *t)
{
    for (size_t k = t->n - 1; k > 0 && t->column[k] < t->column[k - 1]; k--) {
        char name[FIELDS_NAME];
        size_t column = t->column[k];
        memcpy(name, t->name[k], FIELDS_NAME);
        memcpy(t->name[k], t->name[k - 1], FIELDS_NAME);
        memcpy(t->name[k - 1], name, FIELDS_NAME);
        t->column[k] = t->column[k - 1];
        t->column[k - 1] = column;
    }
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
    sort_last(t);
    return true;
}
