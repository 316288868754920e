/* table_row_test.c - the values of one row of a table. */
#include "clients/files/table_row.h"

#include <string.h>

#include "tests/test.h"

/* The values of a row, each in brackets. */
static const char *values_of(const char *row, char separator)
{
    static char text[200];
    const char *at = row, *end = row + strlen(row);
    struct value v;
    size_t n = 0;
    text[0] = '\0';
    for (int i = 0; i < 10 && row_next(&at, end, separator, &v); i++)
        n += (size_t)snprintf(text + n, sizeof text - n, "[%.*s]", (int)v.len, v.text);
    return text;
}

TEST(blanks_at_the_end_of_a_row_are_no_value_where_blanks_separate)
{
    CHECK_STR(values_of("1 2", ' '), "[1][2]");
    CHECK_STR(values_of("1 2 ", ' '), "[1][2]");
    CHECK_STR(values_of(" 1  2 \t \r", ' '), "[1][2]");
    CHECK_STR(values_of("  ", ' '), "");
}

TEST(nothing_behind_the_last_comma_is_a_value)
{
    CHECK_STR(values_of("1,2,", ','), "[1][2][]");
    CHECK_STR(values_of("1,,2", ','), "[1][][2]");
}
