/* table_fields_test.c - further columns of a table: which become fields, their names and values. */
#include "clients/files/source.h"

#include "clients/reading/plan_make.h"

#include <math.h>
#include <string.h>
#include <unistd.h>

#include "tests/test.h"

enum which { HEIGHTS, ALL };

/* Reads the text as a file with this ending, with columns or NULL; it must be valid. */
static struct points_file read_text(struct source *s, const char *ending, const char *columns,
                                    enum which which, const char *text)
{
    static char path[64];
    struct points_file f = {.n = 0};
    snprintf(path, sizeof path, "/tmp/delaunay_fields_XXXXXX%s", ending);
    int fd = mkstemps(path, (int)strlen(ending));
    CHECK(fd >= 0 && write(fd, text, strlen(text)) == (ssize_t)strlen(text) && close(fd) == 0);
    *s = (struct source){.path = path, .form = SOURCE_GUESS};
    s->table.fields.all = which == ALL;
    CHECK(columns == NULL || wish_columns(&s->table.wish, columns));
    bool good = source_read(s, &f);
    unlink(path);
    CHECK_MSG(good, "%s", f.fault);
    return f;
}

/* The names of the fields and the values of the rows, as "z,t 1,2 3,nan". */
static void check_fields(const char *ending, const char *columns, enum which which,
                         const char *text, const char *want)
{
    struct source s;
    struct points_file f = read_text(&s, ending, columns, which, text);
    char got[600] = "";
    size_t n = 0;
    CHECK(f.fields == s.table.fields.n);
    for (size_t i = 0; i < f.fields; i++)
        n += (size_t)snprintf(got + n, sizeof got - n, "%s%s", i > 0 ? "," : "",
                              s.table.fields.name[i]);
    for (size_t i = 0; i < f.n * f.fields; i++)
        n += (size_t)snprintf(got + n, sizeof got - n, "%c%g", i % f.fields == 0 ? ' ' : ',',
                              f.value[i]);
    CHECK_STR(got, want);
    points_file_free(&f);
    source_free(&s);
}

TEST(the_third_column_of_an_xyz_file_is_z)
{
    check_fields(".xyz", NULL, HEIGHTS, "1 2 3\n4 5 6.5\n", "z 3 6.5");
    check_fields(".xyz", NULL, HEIGHTS, "1 2 3 200 100 50\n4 5 6 1 2 3\n", "z 3 6");
    check_fields(".xyz", NULL, HEIGHTS, "1 2\n4 5\n", "");
    check_fields(".csv", NULL, HEIGHTS, "10,2,3\n4,5,6\n", "z 3 6");
    check_fields(".csv", NULL, HEIGHTS, "10,2,3,4\n4,5,6,7\n", "");
    check_fields(".xy", NULL, HEIGHTS, "1 2\n3 4\n", "");
    check_fields(".xyz", NULL, HEIGHTS, "1 2 town\n3 4 5\n", "z nan 5");
    check_fields(".xyz", NULL, HEIGHTS, "1 2 town\n3 4 city\n", "");
}

TEST(a_heading_may_identify_the_column_of_heights)
{
    check_fields(".csv", NULL, HEIGHTS, "name,lon,lat,elevation (m)\nA,1,2,3\nB,4,5,6\n", "z 3 6");
    check_fields(".csv", NULL, HEIGHTS, "z;x;y\n1,5;2;3\n", "z 1.5");
    check_fields(".dat", NULL, HEIGHTS, "# x y z t\n1 2 3 4\n", "z 3");
    check_fields(".csv", NULL, HEIGHTS, "x,y,population\n1,2,3\n", "");
    check_fields(".csv", NULL, HEIGHTS, "x,y,elev,alt\n1,2,3,4\n", "z 3");
    check_fields(".csv", NULL, HEIGHTS, "x,y,height\n1,2,tall\n", "");
}

TEST(the_user_may_choose_the_column_of_heights)
{
    check_fields(".csv", "x,y,t", HEIGHTS, "x,y,z,t\n1,2,3,4\n5,6,7,8\n", "z 4 8");
    check_fields(".csv", "2,3,1", HEIGHTS, "1.5,2,3\n4,5,6\n", "z 1.5 4");
    check_fields(".csv", "x,y", HEIGHTS, "x,y,z\n1,2,3\n", "");
    check_fields(".xyz", "1,2", HEIGHTS, "1 2 3\n", "");
}

TEST(all_numeric_columns_become_fields_on_request)
{
    check_fields(
        ".csv", NULL, ALL,
        "id,x,y,name,elevation,2020,mean temp,n/a col\n1,2,3,A,4,5,6,\n7,8,9,B,10,11,12,x\n",
        "id,z,_2020,mean_temp 1,4,5,6 7,10,11,12");
    check_fields(".csv", NULL, ALL, "10,2,3,a,4\n4,5,6,b,7\n", "c3,c5 3,4 6,7");
    check_fields(".xyz", NULL, ALL, "1 2 3 4\n", "z,c4 3,4");
    check_fields(".csv", NULL, ALL, "x,y,t,t,t\n1,2,3,4,5\n", "t,t_2,t_3 3,4,5");
    check_fields(".csv", "lon,lat,b", ALL, "a,lon,b,lat\n1,2,3,4\n", "a,z 1,3");
    check_fields(".node", NULL, ALL, "2 2 2 1\n1 0 0 7 8 1\n2 1 0 9 10 0\n", "a1,a2 7,8 9,10");
}

TEST(values_that_are_not_numbers_are_missing_and_counted)
{
    struct source s;
    struct points_file f =
        read_text(&s, ".csv", NULL, HEIGHTS, "x,y,z\n1,2,3\n4,5,\n6,7,NA\n8,9,1e999\n10,11,-0\n");
    CHECK(f.n == 5 && f.fields == 1 && f.value[0] == 3 && f.value[4] == 0);
    CHECK(isnan(f.value[1]) && isnan(f.value[2]) && isnan(f.value[3]));
    CHECK(s.table.fields.missing[0] == 3);
    points_file_free(&f);
    source_free(&s);
}

TEST(columns_that_become_fields_are_reported)
{
    static const struct {
        const char *ending, *columns, *text, *want;
        enum which which;
    } c[] = {{".xyz", NULL, "1 2 3\n", "x=1 y=2 z=3, without a header", HEIGHTS},
             {".xyz", NULL, "1 2\n", "", HEIGHTS},
             {".xyz", NULL, "1 2 3 4\n", "x=1 y=2 z=3 of 4, without a header", HEIGHTS},
             {".csv", NULL, "lon,lat\n1,2\n", "", HEIGHTS},
             {".csv", NULL, "lon,lat,elev\n1,2,3\n", "x=lon y=lat z=elev", HEIGHTS},
             {".csv", NULL, "lon,lat,elev,t\n1,2,3,4\n", "x=lon y=lat z=elev t", ALL},
             {".csv", "lat,lon,t", "lon,lat,t\n1,2,3\n", "x=lat y=lon z=t", HEIGHTS},
             {".csv", "2,1", "1,2,3\n", "", HEIGHTS}};
    for (size_t i = 0; i < sizeof c / sizeof c[0]; i++) {
        struct source s;
        struct points_file f = read_text(&s, c[i].ending, c[i].columns, c[i].which, c[i].text);
        CHECK_STR(s.table.using, c[i].want);
        points_file_free(&f);
        source_free(&s);
    }
}

TEST(a_table_of_a_hundred_columns_has_64_fields)
{
    char text[3000];
    size_t n = (size_t)snprintf(text, sizeof text, "x,y");
    for (int i = 0; i < 98; i++)
        n += (size_t)snprintf(text + n, sizeof text - n, ",v%d", i);
    for (int i = 0; i < 100; i++)
        n += (size_t)snprintf(text + n, sizeof text - n, "%c%d", i == 0 ? '\n' : ',', i);
    struct source s;
    struct points_file f = read_text(&s, ".csv", NULL, ALL, text);
    CHECK(f.fields == 64 && f.value[63] == 65);
    CHECK_STR(s.table.fields.name[63], "v63");
    points_file_free(&f);
    source_free(&s);
}

TEST(columns_are_chosen_by_two_or_three_names)
{
    struct wish t = {.chosen = false};
    CHECK(!wish_columns(&t, "x") && !wish_columns(&t, "x,y,z,t"));
    CHECK(!wish_columns(&t, "x,") && !wish_columns(&t, ",y"));
    CHECK(!wish_columns(&t, "x,y,") && !wish_columns(&t, "1,0"));
}
