/* row_test.c - the values of one row of a table. */
#include "clients/reading/row.h"

#include <string.h>

#include "tests/test.h"

/* The values of a row, each in brackets. */
static const char *values_of(const char *row, char separator)
{
    static char text[200];
    const struct row_style style = {.separator = separator, .line_end = '\n'};
    struct value v[10];
    size_t count = row_split(&style, row, row + strlen(row), v, 10), n = 0;
    text[0] = '\0';
    for (size_t i = 0; i < count && i < 10; i++)
        n += (size_t)snprintf(text + n, sizeof text - n, "[%.*s]", (int)v[i].len, v[i].text);
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

TEST(a_quote_counts_where_a_value_begins_and_its_end_is_followed_by_a_separator)
{
    CHECK_STR(values_of("\"a,b\",c", ','), "[a,b][c]");
    CHECK_STR(values_of("\"a\" ,c", ','), "[a][c]");
    CHECK_STR(values_of("\"a\"b,c", ','), "[\"a\"b][c]");
    CHECK_STR(values_of("5\",c", ','), "[5\"][c]");
    CHECK_STR(values_of("\"a \"\"b\"\"\",c", ','), "[a \"\"b\"\"][c]");
    CHECK_STR(values_of("\"a b\" c", ' '), "[a b][c]");
}
