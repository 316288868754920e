/* table_row.h - the values of a row of a table, and numbers among them. */
#ifndef CLIENTS_TABLE_ROW_H
#define CLIENTS_TABLE_ROW_H

#include <stdbool.h>
#include <stddef.h>

struct value {
    const char *text;
    size_t len;
};

bool value_is_blank(char c);

/* Without blanks at both ends. */
struct value value_trim(const char *s, const char *end);

/* The closing quote of a value whose opening one is before s, or `end`; a doubled one does not close. */
const char *value_quote_end(const char *s, const char *end);

/* The value at *s, which moves behind it and its separator; false at the end of the row. Quotes count only
 * where a value begins. The separator ' ' means any number of blanks. */
bool row_next(const char **s, const char *end, char separator, struct value *v);

/* The value in a column, counted from 0. */
bool row_find(const char *s, const char *end, char separator, size_t column, struct value *v);

enum { NUMBER_ROOM = 64 };

/* If semicolons separate, a comma is a decimal comma: then the number with a decimal point, in
 * room[NUMBER_ROOM]. */
struct value value_with_point(char separator, struct value v, char *room);

bool value_is_number(char separator, struct value v);

#endif
