/* plan_make_test.c - separators of values, headings, rows and columns that count: difficult files. */
#include <string.h>

#include "tests/clients/files/tables.h"
#include "tests/test.h"

#define CSV ".csv"
#define TXT ".txt"
#define SQUARE "0 0; 1 0; 1 1"

/* ---- quotes ---- */

TEST(lone_quotes_in_a_table_between_tabs_lose_no_row)
{
    tables_expect(".tsv", "0\t0\t\"a\n1\t0\tb\n0\t1\t\"c\n1\t1\td\n", "0 0; 1 0; 0 1; 1 1",
                  "in 2 lines a quote is not closed and taken as it is, first in line 1");
    tables_expect(".tsv", "x\ty\tname\n0\t0\t\"The\n1\t0\tEnd\"\n1\t1\t\"whole\"\n", SQUARE,
                  "in 1 line a quote is not closed");
    tables_expect(".tsv", "x\ty\tname\n0\t0\t5\" pipe\n1\t0\tb\n1\t1\t6\" pipe\n", SQUARE, NULL);
}

TEST(a_quoted_value_that_spans_lines_is_reported)
{
    tables_expect(CSV, "x,y,note\n0,0,\"two\nlines\"\n1,0,b\n1,1,\"a\nb\nc\"\n", SQUARE,
                  "spanning: 2 quoted values span lines, the first lines 2 to 3");
    tables_expect(CSV, "note,x,y\n\"1,2\n3\",0,0\nb,1,0\nb,1,1\n", SQUARE,
                  "spanning: 1 quoted value spans lines, from lines 2 to 3");
}

TEST(a_quote_whose_lines_are_rows_is_not_one)
{
    tables_expect(CSV, "x,y,note\n0,0,\"6 inch\n1,0,b\n0,1,5\"\n1,1,d\n3,3,c\n",
                  "0 0; 1 0; 0 1; 1 1; 3 3", "in 1 line a quote is not closed");
    tables_expect(CSV, "x,y,note\n0,0,\"open\n1,0,b\n1,1,c\n", SQUARE, "a quote is not closed");
    tables_expect(CSV, "x,y,note\n0,0,a\n1,0,b\n1,1,\"open", SQUARE, "a quote is not closed");
}

TEST(quoted_numbers_headings_and_separators_are_read)
{
    tables_expect(
        CSV,
        "\"x\",\"y\",\"a,b\"\n\"0\",\"0\",\"1,2\"\n\"1\",\"0\",\"\"\n\"1\",\"1\",\"a \"\"b\"\"\"\n",
        SQUARE, "columns not used: a,b");
    tables_expect(TXT, "name x y\n\"AREA 51\" 0 0\n\"B\" 1 0\n\"C D\" 1 1\n", SQUARE, NULL);
}

/* ---- separators and numbers ---- */

TEST(decimal_commas_are_read_beside_tabs_semicolons_bars_blanks_and_in_quotes)
{
    tables_expect(TXT,
                  "Rechtswert\tHochwert\tH\xC3\xB6he\r\n0,5\t0,25\t500,0\r\n1,5\t0,75\t501,5\r\n",
                  "0.5 0.25 500; 1.5 0.75 501.5", "using x=Rechtswert y=Hochwert z=H\xC3\xB6he");
    tables_expect(CSV, "x;y\n1,5;-2,25\n3;4.5\n", "1.5 -2.25; 3 4.5", NULL);
    tables_expect(CSV, "x|y\n1,5|2,25\n", "1.5 2.25", NULL);
    tables_expect(TXT, "1,5 2,25\n3,5 4\n", "1.5 2.25; 3.5 4", NULL);
    tables_expect(CSV, "x,y\n\"1,5\",\"2,25\"\n\"3,5\",\"4\"\n", "1.5 2.25; 3.5 4", NULL);
    tables_expect(CSV, "x;y\n1,5E+02;-2,5e1\n", "150 -25", NULL);
}

TEST(thousands_are_read_where_their_marks_leave_no_doubt)
{
    tables_expect(CSV, "x,y,z\n0,0,\"1,012.5\"\n1,0,\"1,013\"\n", "0 0 1012.5; 1 0 1013", NULL);
    tables_expect(CSV, "x;y;z\n4.468.123,45;5.332.111,2;1.012\n4.468.124,45;5.332.112,2;512,5\n",
                  "4468123.45 5332111.2 1012; 4468124.45 5332112.2 512.5", NULL);
    tables_expect(CSV, "x;y\n2'600'000.5;1'200'000\n2'600'001.5;1'200'001\n",
                  "2600000.5 1200000; 2600001.5 1200001", NULL);
    tables_expect(CSV, "x;y\n1 149 429,97;4 804 525,5\n1 149 430;4 804 526\n",
                  "1149429.97 4804525.5; 1149430 4804526", NULL);
    tables_expect(CSV,
                  "x;y\n1\xC2\xA0"
                  "149,5;2\xE2\x80\xAF"
                  "000,5\n",
                  "1149.5 2000.5", NULL);
}

TEST(a_comma_that_may_be_decimal_or_between_thousands_is_a_doubt)
{
    tables_expect(CSV, "x;y;z\n0;0;500,123\n1;0;600,456\n", "0 0 500.123; 1 0 600.456",
                  "doubt: commas as in 1,234 are taken for decimal commas");
    tables_expect(CSV, "x;y;z\n0;0;1,234\n1.5;0;2,345\n", "0 0 1234; 1.5 0 2345",
                  "doubt: commas as in 1,234 are taken for separators of thousands");
    tables_refuse(CSV, "x,y\n\"1,234\",\"2,345\"\n", "not a number without doubt");
}

TEST(a_comma_that_comes_late_among_decimal_points_is_not_decimal)
{
    char text[20000] = "x;y;z\n";
    size_t n = strlen(text);
    for (int i = 0; i < PLAN_ROWS + 5; i++)
        n += (size_t)sprintf(text + n, "%d;%d.5;1\n", i, i);
    strcpy(text + n, "1,250;7;1\n");
    tables_refuse(CSV, text, "not a number without doubt, because of its comma: \"1,250\"");
}

TEST(exponents_of_fortran_signs_and_unicode_minus_are_read)
{
    tables_expect(TXT, " 0.1D+01  0.2D+02\n-.5D0 +3.\n", "1 20; -0.5 3", NULL);
    tables_expect(CSV,
                  "x,y\n\xE2\x88\x92"
                  "1.5,+2\n",
                  "-1.5 2", NULL);
}

TEST(columns_padded_with_blanks_and_trailing_separators_are_read)
{
    tables_expect(CSV, "x , y , z\n  0 ,  0 ,  5 \n  1 ,  0 ,  6 \n", "0 0 5; 1 0 6", NULL);
    tables_expect(CSV, "x,y,\n0,0,\n1,0,\n1,1,\n", SQUARE, "");
    tables_expect(CSV, "x,y\n0,0,\n1,0,,\n1,1\n", SQUARE, "");
    tables_expect(TXT, "   0.0      0.0\n   1.0      0.0\n   1.0      1.0  \n", SQUARE, "");
}

TEST(lines_may_end_in_lf_crlf_or_cr_alone)
{
    tables_expect(CSV, "x,y\r0,0\r1,0\r1,1\r", SQUARE, "");
    tables_expect(CSV, "x,y\r0,0\r1,0\r1,1", SQUARE, "");
    tables_expect(CSV, "x,y\r\n0,0\r\n1,0\r\n1,1", SQUARE, "");
    tables_expect(TXT, "0 0\r1 0\r1 1\r", SQUARE, "");
    tables_refuse(CSV, "x,y\n0,0\n1,0\r1,1\n", "3: the row has too many columns");
}

/* ---- headings ---- */

TEST(headings_of_heights_are_known_in_many_languages)
{
    static const char *const heights[] = {"ele",
                                          "Elevation (m)",
                                          "ALT",
                                          "H\xC3\xB6he",
                                          "H\xF6he",
                                          "H\xC3\x96HE",
                                          "Hoehe_NHN",
                                          "altitude",
                                          "hauteur",
                                          "Altitud",
                                          "cota",
                                          "quota",
                                          "altezza",
                                          "Altura",
                                          "hoogte",
                                          "wysoko\xC5\x9B\xC4\x87",
                                          ("rz\xC4\x99"
                                           "dna"),
                                          "v\xC3\xBD\xC5\xA1ka",
                                          "h\xC3\xB8jde",
                                          "h\xC3\xB6jd",
                                          "korkeus",
                                          "Elevaci\xC3\xB3n",
                                          "eleva\xC3\xA7\xC3\xA3o",
                                          "hgt",
                                          "Z [m]"};
    for (size_t i = 0; i < sizeof heights / sizeof heights[0]; i++) {
        char text[200];
        snprintf(text, sizeof text, "x;y;%s\n0;0;5\n1;0;6\n", heights[i]);
        tables_expect(CSV, text, "0 0 5; 1 0 6", "using x=x y=y z=");
    }
}

TEST(headings_of_coordinates_are_known_in_many_languages)
{
    static const char *const headings[] = {
        "Longitude;Latitude",
        "longitud;latitud",
        "Longitudine;Latitudine",
        "L\xC3\xA4ngengrad;Breitengrad",
        "L\xE4ngengrad;Breitengrad",
        "Lengtegraad;Breedtegraad",
        "D\xC5\x82ugo\xC5\x9B\xC4\x87 geograficzna;Szeroko\xC5\x9B\xC4\x87 geograficzna",
        "Rechtswert;Hochwert",
        "Est;Nord",
        "Este;Norte",
        "Leste;Norte",
        "Oost;Noord",
        "\xC3\x98st;Nord",
        "\xC3\x96st;Norr",
        "Ascissa;Ordinata",
        ("Abscisse;Ordonn\xC3\xA9"
         "e"),
        "UTM_E;UTM_N",
        "Longitude (\xC2\xB0);Latitude (\xC2\xB0)"};
    for (size_t i = 0; i < sizeof headings / sizeof headings[0]; i++) {
        char text[200];
        snprintf(text, sizeof text, "%s\n0;0\n1;0\n1;1\n", headings[i]);
        tables_expect(CSV, text, SQUARE, NULL);
    }
}

TEST(a_heading_may_be_a_comment_in_any_style_with_rules_below_it)
{
    tables_expect(TXT, "# lat, lon, depth\n# ---\n48.1,11.5,3\n48.2,11.7,3\n",
                  "11.5 48.1 3; 11.7 48.2 3", "using x=lon y=lat z=depth");
    tables_expect(TXT, "% file signature: 'LASF'\n% x y z i\n0,0,5,1\n1,0,6,2\n", "0 0 5; 1 0 6",
                  "columns not used: i");
    tables_expect(TXT, "// made by hand\n//X Y Z\n0 0 5\n1 0 6\n", "0 0 5; 1 0 6", "using x=X");
    tables_expect(TXT, "##\n## a b c\n#----\n0 0 5\n1 0 6\n", "0 0 5; 1 0 6",
                  "x=1 y=2 z=3, without a header");
}

TEST(titles_and_rows_of_units_are_not_read_and_named)
{
    tables_expect(CSV,
                  "time,latitude,longitude,altitude\nUTC,degrees_north,degrees_east,m\n"
                  "2024,40.1,-30,5\n2024,41,-31,6\n",
                  "-30 40.1 5; -31 41 6", "skipped: line 2 is not read: UTC,degrees_north");
    tables_expect(CSV, "Survey of Loch Ness, 2024\n\nx,y,z\n0,0,5\n1,0,6\n", "0 0 5; 1 0 6",
                  "line 1 is not read: Survey of Loch Ness, 2024");
    tables_expect(TXT, "My survey of the field\n0 0 5\n1 0 6\n", "0 0 5; 1 0 6",
                  "line 1 is not read");
    tables_expect(".pts", "3\n0 0 5 10\n1 0 6 20\n1 1 7 30\n", "0 0 5; 1 0 6; 1 1 7",
                  "line 1 is not read: 3");
    tables_expect(CSV, "x,y\nm,m\nfloat,float\n0,0\n1,0\n1,1\n", SQUARE, "line 3 is not read");
    tables_refuse(CSV, "x,y\na,b\na,b\na,b\n1,2\n", "2: not a number: \"a\" in column x");
}

TEST(a_grid_or_a_mesh_is_no_table_of_points)
{
    tables_refuse(".txt", "DSAA\n3 2\n0 1\n0 1\n1 6\n1 2 3\n4 5 6\n", "1: this is a grid");
    tables_refuse(".off", "OFF\n3 0 0\n0 0 1\n1 0 2\n1 1 3\n", "1: this is a mesh");
}

TEST(an_ascii_grid_is_recognised_by_its_header_and_points_may_have_its_ending)
{
    tables_expect(
        ".asc", "ncols 3\nnrows 2\nxllcorner 0\nyllcorner 0\ncellsize 10\n1 2 3\n4 -9999 6\n",
        "5 15 1; 15 15 2; 25 15 3; 5 5 4; 25 5 6", "1 cell without a value (-9999) is left out");
    tables_expect(".txt", "NROWS 1\nNCOLS 2\nxllcenter 0\nyllcenter 0\ncellsize 10\n7 8\n",
                  "0 0 7; 10 0 8", "using the centres of 2 x 1 cells of 10 x 10");
    tables_expect(".asc", "0 0 5\n1 0 6\n", "0 0 5; 1 0 6", "using x=1 y=2 z=3");
    tables_refuse(".asc", "ncols 2\nnrows 1\nxllcorner 0\nyllcorner 0\ncellsize 10\n1 b\n",
                  "6: row 1, column 2: not a number: \"b\"");
}

TEST(a_title_is_no_heading_and_a_heading_is_no_title)
{
    tables_refuse(CSV, "id,a,b\n1,2,3\n", "1=id 2=a 3=b");
    tables_refuse(TXT, "Survey points\n1 2\n3 4\n", "no headings that are known");
    tables_refuse(CSV, "Paris,2.35,48.85\n", "columns found: 1=Paris 2=2.35 3=48.85");
    tables_refuse(CSV, "a,b,c\nd,e,f\n", "columns found: 1=a 2=b 3=c");
}

static void skip_two(struct source *s)
{
    s->table.wish.skip_lines = 2;
}

TEST(lines_at_the_front_are_left_out_on_request)
{
    struct outcome o;
    static const char text[] = "0,0\n5,5\n1,0\n1,1\n";
    tables_read(&o, CSV, text, strlen(text), skip_two);
    CHECK_STR(o.points, "1 0; 1 1");
}

TEST(a_heading_alone_is_a_file_without_points_and_one_row_is_enough)
{
    tables_expect(CSV, "x,y,z\n", "", "there are no points in it");
    tables_expect(CSV, "lon;lat", "", "there are no points in it");
    tables_expect(CSV, "", "", "there are no points in it");
    tables_expect(CSV, "\n\n# nothing\n", "", "there are no points in it");
    tables_expect(CSV, "x,y\n1,2", "1 2", "");
    tables_expect(CSV, "1,2", "1 2", "");
    tables_expect(TXT, "1 2 3", "1 2 3", NULL);
}

TEST(units_in_brackets_between_blanks_belong_to_their_headings)
{
    tables_expect(TXT, "Latitude (deg) Longitude (deg) Depth [m]\n48 11 3\n49 12 4\n",
                  "11 48 3; 12 49 4", NULL);
}

TEST(excel_s_line_with_the_separator_is_obeyed)
{
    tables_expect(CSV, "sep=;\nx;y\n0;0\n1,0;0\n1;1\n", SQUARE, "");
    tables_expect(CSV, "sep=|\r\nx|y\r\n0|0\r\n1|0\r\n1|1\r\n", SQUARE, "");
}

/* ---- rows ---- */

TEST(rows_of_empty_values_are_no_points)
{
    tables_expect(CSV, "x;y;z\n0;0;1\n;;\n1;0;2\n;;\n;;\n", "0 0 1; 1 0 2",
                  "skipped: 3 lines have only empty values, the first is line 3");
    tables_expect(CSV, "x,y,z\n0,0,1\n,,\n", "0 0 1", "line 3 has only empty values");
}

TEST(names_of_rows_as_r_writes_them_are_no_column_of_the_heading)
{
    tables_expect(TXT, "\"x\" \"y\" \"z\"\n\"1\" 0 0 5\n\"2\" 1 0 6\n", "0 0 5; 1 0 6",
                  "using x=x y=y z=z");
    tables_expect(CSV, "\"x\",\"y\"\n\"a\",0,0\n\"b\",1,0\n\"c\",1,1\n", SQUARE,
                  "columns not used: 1");
    tables_expect(TXT, "x y z\n1 0 0 5\n2 1 0 6\n3 1 1 7\n", "0 0 5; 1 0 6; 1 1 7", NULL);
    tables_refuse(CSV, "x,y\n1,5,2\n4,5,2\n", "too many columns: 3 instead of 2");
}

TEST(points_of_gmt_segments_are_points_of_one_set)
{
    tables_expect(TXT, "> -L first\n0 0\n1 0\n>\n1 1\n", SQUARE, NULL);
    tables_expect(".gmt", "# @VGMT1.0\n>\n0 0 5\n1 0 6\n", "0 0 5; 1 0 6", NULL);
}

TEST(a_row_between_blanks_that_is_shifted_is_bad)
{
    tables_refuse(TXT,
                  "ID NAME LAT LON ELEV FLAG\n1 GROOM 37.2 -115.8 1360 A\n"
                  "2 AREA 51 37.23 -115.81 1361\n3 RENO 39.5 -119.8 1340 A\n"
                  "4 ELKO 40.8 -115.7 1540 B\n",
                  "3: the row seems to be shifted: \"1361\" in column FLAG");
    tables_refuse(TXT, "ID NAME LAT LON\n1 GROOM 37.2 -115.8\n2 AREA 51 37.23 -115.81\n",
                  "3: the row has too many columns: 5 instead of 4");
    tables_refuse(TXT, "x y z t\n0 0 5 1\n1 0 6\n", "too few columns: 3 instead of 4");
    tables_refuse(TXT, "NAME LAT LON\nA 37 -115\n38 -116\n", "too few columns: 2 instead of 3");
    tables_expect(TXT, "x y z name\n0 0 5 two words\n1 0 6 one\n", "0 0 5; 1 0 6", NULL);
}

TEST(a_row_between_commas_may_be_short_but_not_long)
{
    tables_expect(CSV, "x,y,z\n0,0,5\n1,0\n1,1,7\n", "0 0 5; 1 0 nan; 1 1 7",
                  "missing: z: 1 of 3 values are missing");
    tables_refuse(CSV, "x,y,z\n0,0,5\n1\n", "3: the row has too few columns: 1 instead of 3");
    tables_refuse(CSV, "x,y\n1,5,2,5\n", "4 instead of 2 (decimal commas?)");
}

TEST(comments_that_look_like_rows_are_reported)
{
    tables_expect(CSV, "x,y\n0,0\n#5,5\n1,0\n# a note\n1,1\n", SQUARE,
                  "skipped: line 3 looks like a row but is a comment, and is not read");
    tables_expect(CSV, "x,y\n#5,5\n0,0\n1,0\n1,1\n", SQUARE, "line 2 looks like a row");
    tables_expect(CSV, "x,y\n0,0\n#N/A,5\n1,0\n1,1\n", SQUARE, "line 3 looks like a row");
    tables_expect(CSV, "x,y,name\n0,0,a\n//5,?,b\n1,0,c\n1,1,d\n", SQUARE, "line 3 looks like");
    tables_expect(CSV, "x,y\n0,0\n// note\n% 1\n1,0\n1,1\n", SQUARE, "");
    tables_expect(CSV, "x,y\n# a, b\n0,0\n1,0\n1,1\n", SQUARE, "");
}

TEST(the_bad_value_and_its_column_are_named)
{
    tables_refuse(CSV, "x,y\n1,2\n1,b\n", "3: not a number: \"b\" in column y");
    tables_refuse(CSV, "lat,lon\n1,2\n,3\n", "3: not a number: \"\" in column lat");
    tables_refuse(CSV, "1,2\n1,#REF!\n", "2: not a number: \"#REF!\" in column 2");
    tables_refuse(CSV, "x,y\n1,2\n1,\x1B[2J\n", "\"?[2J\"");
}

/* ---- columns ---- */

TEST(a_first_value_that_is_odd_or_missing_decides_nothing)
{
    tables_expect(CSV, "x,y,z\n0,0,*****\n1,0,6\n1,1,7\n", "0 0 nan; 1 0 6; 1 1 7",
                  "z: 1 of 3 values are missing");
    tables_expect(CSV, "x,y,z\n0,0,??\n1,0,6\n1,1,7\n", "0 0 nan; 1 0 6; 1 1 7",
                  "the first that is not a number is \"??\" in line 2");
    tables_expect(CSV, "x,y,z\n0,0,12 m\n1,0,13 m\n", "0 0 12; 1 0 13",
                  "read: the unit m of z is left out");
    tables_expect(CSV, "x,y,z\n0,0,about 12\n1,0,tall\n", "0 0; 1 0",
                  "z has no numbers; the first value is \"about 12\" in line 2");
    tables_expect(CSV, "x,y,z\n0,0,12 m\n1,0,40 ft\n1,1,13 m\n", "0 0 12; 1 0 nan; 1 1 13",
                  "\"40 ft\" in line 3");
}

TEST(words_for_missing_values_are_missing)
{
    static const char *const words[] = {"",     "NA",   "NaN", "null", "-",  "n/a",
                                        "None", "#N/A", "\\N", "?",    "--", "."};
    for (size_t i = 0; i < sizeof words / sizeof words[0]; i++) {
        char text[100];
        snprintf(text, sizeof text, "x,y,z\n0,0,%s\n1,0,6\n", words[i]);
        tables_expect(CSV, text, "0 0 nan; 1 0 6", "missing: z: 1 of 2 values are missing\n");
    }
}

TEST(columns_that_are_not_used_are_named)
{
    tables_expect(CSV, "id,x,y,depth of snow\n1,0,0,5\n2,1,0,6\n", "0 0; 1 0",
                  "unused: columns not used: id, depth of snow (--fields keeps those of numbers)");
    tables_expect(CSV, "name,x,y\na,0,0\nb,1,0\n", "0 0; 1 0", "columns not used: name\n");
    tables_expect(".xyz", "0 0 5 1 2 3\n1 0 6 1 2 3\n", "0 0 5; 1 0 6",
                  "columns not used: 4, 5, 6");
}

TEST(a_column_z_precedes_other_heights)
{
    tables_expect(CSV, "x,y,h,z\n0,0,1,100\n1,0,2,101\n", "0 0 100; 1 0 101",
                  "columns not used: h (--fields");
}

TEST(several_pairs_of_coordinates_are_a_doubt)
{
    tables_expect(CSV, "lon,lat,x,y\n11,48,0.1,0.2\n12,49,0.3,0.1\n", "0.1 0.2; 0.3 0.1",
                  "doubt: x and y are x and y, not lon and lat; --columns chooses others");
    tables_expect(CSV, "lon,lat,x,y\n11,48,,\n12,49,,\n", "11 48; 12 49", "columns not used: x, y");
}

TEST(degrees_in_one_column_and_minutes_in_another_are_refused)
{
    tables_refuse(CSV, "lat_deg,lat_min,lon_deg,lon_min\n53,20,6,15\n53,21,6,16\n",
                  "1: lon_deg and lon_min have degrees and parts");
    tables_refuse(CSV, "Lat D,Lat M,Lon D,Lon M\n53,20,6,15\n53,21,6,16\n", "which are not put");
    tables_expect(CSV, "lat_deg,lon_deg\n53.5,6.25\n", "6.25 53.5", "using x=lon_deg");
    tables_expect(CSV, "lat,lon,lat_deg,lat_min\n53.5,6.25,53,30\n", "6.25 53.5", NULL);
}

TEST(a_column_of_hemispheres_that_is_not_used_is_a_doubt)
{
    tables_expect(CSV, "lat,ns,lon,ew\n53,N,6,E\n33,S,6,E\n", "6 53; 6 33",
                  "doubt: ns has S or W, which changes no sign");
    tables_expect(CSV, "lat,ns,lon,ew\n53,N,6,E\n33,N,7,E\n", "6 53; 7 33",
                  "columns not used: ns, ew\n");
    tables_expect(CSV, "lat,ns,lon\n53,N,6\n-33,S,7\n", "6 53; 7 -33", "columns not used: ns\n");
}

TEST(a_column_of_points_in_wkt_has_the_coordinates)
{
    tables_expect(CSV,
                  "WKT,fid,name,height\nPOINT (0 0),0,\"Haus 0, Hof\",500\n"
                  "\"POINT (1 0)\",1,\"Haus 1, Hof\",501\n",
                  "0 0 500; 1 0 501", "using x y of WKT z=height");
}

TEST(semicolons_in_wkt_do_not_separate_columns_between_commas)
{
    tables_expect(CSV, "id,geom\n1,SRID=4326;POINT(1 2)\n2,SRID=4326;POINT(3 4)\n", "1 2; 3 4",
                  "using x y of geom");
}

TEST(points_in_wkt_are_in_one_reference_system)
{
    tables_expect(CSV, "id|geom\n1|POINT(1 2)\n2|SRID=4326;POINT(3 4)\n3|SRID=4326;POINT(5 6)\n",
                  "1 2; 3 4; 5 6", NULL);
    tables_refuse(CSV, "id|geom\n1|SRID=4326;POINT(1 2)\n2|SRID=25832;POINT(5e5 5e6)\n",
                  "3: the point has another reference system (SRID) than 4326");
}

TEST(matrices_of_octave_that_become_one_set_are_a_doubt)
{
    tables_expect(
        TXT,
        "# Created by Octave\n# name: a\n# type: matrix\n# rows: 2\n# columns: 2\n 0 0\n 1 "
        "0\n\n\n# name: b\n# type: matrix\n# rows: 1\n# columns: 2\n 1 1\n",
        SQUARE, "another matrix begins in line 10; the rows of 2 matrices become one set");
    tables_expect(TXT, "# name: a\n# type: matrix\n# rows: 3\n# columns: 2\n 0 0\n 1 0\n 1 1\n",
                  SQUARE, "");
}

TEST(points_in_wkt_may_have_heights_and_be_beside_other_geometries)
{
    tables_expect(CSV, "id|geom\n1|SRID=4326;POINT Z (0 0 5)\n2|POINTZ(1 0 6)\n", "0 0 5; 1 0 6",
                  "using x y of geom z");
    tables_expect(CSV, "id|geom\n1|POINT M (0 0 5)\n2|POINT ZM(1 0 6 9)\n", "0 0 nan; 1 0 6", NULL);
    tables_expect(CSV, "id|geom\n1|POINT M (0 0 5)\n2|POINTM(1 0 6)\n", "0 0; 1 0", NULL);
    tables_expect(TXT, "POINT (0 0)\nPOINT (1 0)\nPOINT (1 1)\n", SQUARE, NULL);
    tables_expect(CSV, "WKT,id\nPOINT (0 0),1\n\"LINESTRING (1 0, 1 1)\",2\n", SQUARE, NULL);
    tables_expect(CSV, "WKT,id\nPOINT (0 0),1\nPOINT EMPTY,2\n", "0 0",
                  "line 3 has an empty geometry");
    tables_refuse(CSV, "WKT,id\nPOINT (0 0),1\nPOINT (0),2\n",
                  "3: no points, lines or polygons in well-known text, at \")\"");
    tables_refuse(CSV, "WKT,id\nPOINT (0 0),1\nCIRCULARSTRING (0 0),2\n",
                  "3: CIRCULARSTRING has curves, and only straight lines are read; ogr2ogr -nlt "
                  "CONVERT_TO_LINEAR makes straight lines of curves");
}

/* ---- without a heading ---- */

TEST(numbers_of_points_dates_and_decimal_commas_are_not_coordinates)
{
    tables_refuse(CSV, "1,20,30\n2,40,50\n3,60,70\n", "the first column counts rows");
    tables_refuse(TXT,
                  "1,934735.1,581308.4,1117.1,BASE\n2,934800.2,581400.5,1118,GS\n"
                  "5,934700.3,581350.6,1119,GS\n9,934900.3,581250.6,1119,TREE\n",
                  "the first column seems to number the points");
    tables_refuse(CSV, "20240101,48.1,11.5\n20240101,48.2,11.6\n", "the first column has dates");
    tables_refuse(CSV, "2024,1,15,48.1,11.5\n2024,2,15,48.2,11.6\n", "the first column has dates");
    tables_refuse(CSV, "2024-01-01,48.1,11.5\n2024-01-02,48.2,11.6\n",
                  "the first two columns are not numbers");
    tables_refuse(CSV, "12:30:00,48.1,11.5\n12:30:01,48.2,11.6\n",
                  "the first column seems to have times");
    tables_expect(CSV, "6:30:00,48:30\n7:30:00,49:30\n", "6.5 48.5; 7.5 49.5", NULL);
    tables_refuse(CSV, "12,05,48,1\n13,5,49,25\n", "decimal commas");
    tables_expect(CSV, "12,5,48,1\n13,5,49,25\n", "12 5; 13 5", "if commas are decimal commas");
    tables_expect(CSV, "0,0,5\n10,0,6\n20,0,7\n", "0 0 5; 10 0 6; 20 0 7",
                  "doubt: the first column has only whole numbers");
    tables_expect(TXT, "1001 100.5 200.5 3.5\n1005 101.5 201.5 3.6\n1003 111.5 201.5 3.6\n",
                  "1001 100.5; 1005 101.5; 1003 111.5", "if it numbers the points or has years");
    tables_expect(CSV, "0,10.5,5.5\n10,11.5,6.5\n20,12.5,7.5\n",
                  "0 10.5 5.5; 10 11.5 6.5; 20 12.5 7.5", "only whole numbers");
    tables_expect(CSV, "10.5,2,5\n11.5,3,6\n", "10.5 2 5; 11.5 3 6", "without a header\n");
    tables_expect(".xyz", "1 0 5\n2 0 6\n3 0 7\n", "1 0 5; 2 0 6; 3 0 7", NULL);
}
