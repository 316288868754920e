/* asc_grid_test.c - the cells of ASCII grids become points at their centres. */
#include "clients/grids/asc_grid.h"

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tests/test.h"

static struct points_file file;
static struct table_fields fields;
static struct grid_notes notes;

static bool read_text(const char *text, const struct grid_frame *frame, bool skip_bad)
{
    points_file_free(&file);
    memset(&fields, 0, sizeof fields);
    file.skip_bad = skip_bad;
    return asc_text_read(&file, text, strlen(text), frame, &fields, &notes);
}

/* The points are want[3 n], x y z. */
static void expect(const char *text, const double *want, size_t n)
{
    CHECK_MSG(read_text(text, NULL, false), "%s: %s", text, file.fault);
    CHECK_MSG(file.n == n && file.fields == 1 && fields.n == 1, "%zu points", file.n);
    CHECK_STR(fields.name[0], "z");
    for (size_t i = 0; i < n; i++)
        CHECK_MSG(file.xy[2 * i] == want[3 * i] && file.xy[2 * i + 1] == want[3 * i + 1] &&
                      file.value[i] == want[3 * i + 2],
                  "%zu: %.17g %.17g %.17g", i, file.xy[2 * i], file.xy[2 * i + 1], file.value[i]);
    points_file_free(&file);
}

static void refuse(const char *text, uint64_t line, const char *fault)
{
    CHECK_MSG(!read_text(text, NULL, false), "%s", text);
    CHECK_STR(file.fault, fault);
    CHECK_MSG(file.line == line, "%ju", (uintmax_t)file.line);
    points_file_free(&file);
}

#define HEAD "ncols 3\nnrows 2\nxllcorner 10\nyllcorner 20\ncellsize 2\n"

TEST(points_of_a_grid_are_the_centres_of_its_cells_from_the_north)
{
    static const double all[] = {11, 23, 1, 13, 23, 2, 15, 23, 3, 11, 21, 4, 13, 21, 5, 15, 21, 6};
    char how[100];
    expect(HEAD "1 2 3\n4 5 6\n", all, 6);
    grid_describe(&notes, how, sizeof how);
    CHECK_STR(how, "the centres of 3 x 2 cells of 2 x 2");
    CHECK(notes.empty == 0);
    /* The header in another order and case, with other ends of lines, and the rows broken elsewhere. */
    expect("\xEF\xBB\xBF\r\nYLLCENTER\t21\r\nNRows 2\r\nXllCenter 11\r\ncellsize 2.0\r\nNCOLS 3\r\n"
           "1\r\n2 3 4 5\r\n 6",
           all, 6);
    expect("ncols 3 nrows 2 xllcorner 1e1 yllcenter 21 dx 2 dy 2 nodata -1 1 2 3 4 5 6", all, 6);
}

TEST(cells_of_a_grid_may_be_longer_than_wide)
{
    static const double want[] = {0.25, 3, 7, 0.25, 1, 8};
    expect("ncols 1\nnrows 2\nxllcorner 0\nyllcorner 0\ndx 0.5\ndy 2\n7\n8\n", want, 2);
    char how[100];
    grid_describe(&notes, how, sizeof how);
    CHECK_STR(how, "the centres of 1 x 2 cells of 0.5 x 2");
}

TEST(cells_without_a_value_are_left_out_and_counted)
{
    static const double one[] = {13, 21, 5};
    expect("ncols 3\nnrows 2\nxllcorner 10\nyllcorner 20\ncellsize 2\nNODATA_value -1\n"
           "-1 nan NaN\n-1.0 5 -nan\n",
           one, 1);
    CHECK(notes.empty == 5 && notes.nodata == -1);
    expect(HEAD "-9999 -9999.0 NA\n-9999 5 *\n", one, 1);
    CHECK(notes.empty == 5 && notes.nodata == -9999);
    expect(HEAD "NODATA_value nan\nnan nan nan\nnan 5 nan\n", one, 1);
    CHECK(notes.empty == 5 && isnan(notes.nodata));
    /* Programs that write the lowest float with fewer digits than its cells have. */
    expect(HEAD "NODATA_value -3.4028235e+38\n-3.4028234663852886e+38 -3.40282347e+38 nan\n"
                "-3.402823466385289e+38 5 nan\n",
           one, 1);
    CHECK(notes.empty == 5);
    expect(HEAD "NODATA_value -9999.1\n-9999.099609375 -9999.1 nan\nnan 5 nan\n", one, 1);
    expect(HEAD "nan nan nan\nnan nan nan\n", NULL, 0);
    CHECK(notes.empty == 6);
}

TEST(a_value_near_nodata_is_a_value)
{
    static const double want[] = {0.5, 0.5, -9999.0000000000018};
    expect("ncols 1\nnrows 1\nxllcorner 0\nyllcorner 0\ncellsize 1\n-9999.0000000000018\n", want,
           1);
}

/* The nearest double to the exact sum of the doubles that the header gives: 128 bits hold it here. */
TEST(centres_of_cells_are_rounded_once)
{
    enum { N = 1000 };
    static char text[40 * N];
    const double cell = 1.0 / 3600, corner = -6.2501388888888888;
    size_t at = (size_t)sprintf(
        text, "ncols %d\nnrows 1\nxllcorner %.17g\nyllcorner 0\ncellsize %.17g\n", N, corner, cell);
    for (int i = 0; i < N; i++)
        at += (size_t)sprintf(text + at, "%d ", i);
    CHECK(read_text(text, NULL, false) && file.n == N);
    for (int i = 0; i < N; i++) {
        /* x = whole / 2^70 exactly: the step has 53 bits from 2^-12 down, the corner from 2^2 down, and i + 1/2 one more */
        __int128 whole =
            (__int128)ldexp(corner, 70) + (__int128)(2 * i + 1) * (__int128)ldexp(cell, 69);
        CHECK_MSG(file.xy[2 * i] == ldexp((double)whole, -70), "%d: %.17g", i, file.xy[2 * i]);
    }
    points_file_free(&file);
}

TEST(bad_grids_are_named_by_row_and_column)
{
    refuse(HEAD "1 2 3\n4 x 6\n", 7, "row 2, column 2: not a number: \"x\"");
    refuse(HEAD "1 2 3\n4 1e999 6\n", 7, "row 2, column 2: not a number: \"1e999\"");
    refuse(HEAD "1 2 3,5\n4 5 6\n", 6, "row 1, column 3: not a number: \"3,5\"");
    refuse(HEAD "1 2 3\n4 5\n", 8, "the file ends before row 2, column 3 of 3 x 2 values");
    refuse(HEAD, 6, "the file ends before row 1, column 1 of 3 x 2 values");
    refuse(HEAD "1 2 3\n4 5 6\n7\n", 8, "there are more than 3 x 2 values");
}

TEST(bad_headers_of_grids_are_named)
{
    refuse("ncols 3\nnrows 2\ncellsize 2\nyllcorner 0\n1 2 3 4 5 6", 0,
           "the header of the ASCII grid has no xllcorner");
    refuse("ncols 3\nxllcorner 0\nyllcorner 0\ncellsize 2\n1 2 3", 0,
           "the header of the ASCII grid has no nrows");
    refuse("ncols 1\nnrows 1\nxllcorner 0\nyllcorner 0\ndx 2\n1", 0,
           "the header of the ASCII grid has no cellsize");
    refuse("ncols 1\nnrows 1\nxllcorner 0\nxllcenter 0\nyllcorner 0\ncellsize 2\n1", 0,
           "the header has xllcorner and xllcenter");
    refuse("ncols 1\nnrows 1\nxllcorner 0\nyllcorner 0\ncellsize 2\ndx 2\n1", 0,
           "the header has cellsize and dx");
    refuse("ncols 3\nncols 3\n", 2, "the header has ncols twice");
    refuse("ncols 3.5\n", 1, "not a number of columns or rows: \"3.5\"");
    refuse("ncols 0\n", 1, "not a number of columns or rows: \"0\"");
    refuse("ncols 4294967296\n", 1, "not a number of columns or rows: \"4294967296\"");
    refuse("ncols 3\nnrows\nxllcorner 0\n", 3, "not a number in the header: \"xllcorner\"");
    refuse("ncols 3\ncellsize 0\n", 2, "the side of a cell is above 0: \"0\"");
    refuse("ncols 3\nxllcorner 1e999\n", 2, "not a number in the header: \"1e999\"");
    refuse("ncols 3\nbyteorder LSBFIRST\n", 2,
           "not a word of the header of an ASCII grid: \"byteorder\"");
    refuse("ncols 1\nnrows 1\nxllcorner 1e99\nyllcorner 0\ncellsize 2\n1", 6,
           "a coordinate must be 0 or from 2^-142 to 2^201 in magnitude");
}

TEST(bad_values_of_a_grid_can_be_skipped)
{
    CHECK(read_text(HEAD "1 2 x\n4 ? 6\n", NULL, true));
    CHECK(file.n == 4 && file.skipped == 1 && notes.empty == 1 && file.xy[4] == 11);
    CHECK_STR(file.skip[0].text, "x");
    CHECK(!read_text(HEAD "1 2 x\n", NULL, true));
    points_file_free(&file);
}

TEST(a_frame_says_where_the_cells_of_a_grid_lie)
{
    struct grid_frame frame = {.columns = 3,
                               .rows = 2,
                               .origin = {100, 50},
                               .column = {1, 2},
                               .row = {-2, 1},
                               .first = {0.5, 0.5}};
    CHECK(read_text(HEAD "1 2 3\n4 5 6\nPROJCS[\"x\"]\n", &frame, false) && file.n == 6);
    for (int i = 0; i < 6; i++) {
        double c = i % 3 + 0.5, r = i / 3 + 0.5;
        CHECK(file.xy[2 * i] == 100 + c - 2 * r && file.xy[2 * i + 1] == 50 + 2 * c + r);
    }
    frame.rows = 3;
    CHECK(!read_text(HEAD "1 2 3\n4 5 6\n", &frame, false));
    CHECK_STR(file.fault, "the header has other numbers of columns and rows than the raster");
    points_file_free(&file);
}

/* Words lie across the blocks in which a file is read, and pieces of a pipe end anywhere. */
TEST(a_file_is_read_as_its_text_is)
{
    enum { COLUMNS = 300, ROWS = 400 };
    static char text[20 * COLUMNS * ROWS];
    size_t at = (size_t)sprintf(
        text, "\xEF\xBB\xBFncols %d\nnrows %d\nxllcorner 0\nyllcorner 0\ncellsize 1\n", COLUMNS,
        ROWS);
    for (int i = 0; i < COLUMNS * ROWS; i++)
        at += (size_t)sprintf(text + at, "%.*f%s", (int)test_below(9), test_uniform() * 1000,
                              i % 7 == 0 ? " \r\n" : " ");
    CHECK(read_text(text, NULL, false) && file.n == COLUMNS * ROWS);
    for (size_t piece = 1; piece < 1 << 17; piece = piece * 97 + 2) {
        struct points_file other = {0};
        int pipes[2];
        CHECK(pipe(pipes) == 0);
        pid_t child = fork();
        if (child == 0) {
            for (size_t i = 0; i < at; i += piece)
                if (write(pipes[1], text + i, at - i < piece ? at - i : piece) < 0)
                    _exit(1);
            _exit(0);
        }
        close(pipes[1]);
        memset(&fields, 0, sizeof fields);
        CHECK_MSG(asc_file_read(&other, pipes[0], NULL, &fields, &notes), "%s", other.fault);
        close(pipes[0]);
        CHECK(waitpid(child, NULL, 0) == child);
        CHECK(other.n == file.n && other.line == file.line);
        CHECK(memcmp(other.xy, file.xy, 2 * file.n * sizeof file.xy[0]) == 0);
        CHECK(memcmp(other.value, file.value, file.n * sizeof file.value[0]) == 0);
        points_file_free(&other);
    }
    points_file_free(&file);
}

TEST(a_file_that_cannot_be_read_or_is_too_short_is_refused)
{
    static const char text[] = HEAD "1 2 3 4 5";
    FILE *f = tmpfile();
    CHECK(f != NULL && fwrite(text, 1, sizeof text - 1, f) == sizeof text - 1 && fflush(f) == 0);
    memset(&fields, 0, sizeof fields);
    points_file_free(&file);
    CHECK(lseek(fileno(f), 0, SEEK_SET) == 0 &&
          !asc_file_read(&file, fileno(f), NULL, &fields, &notes));
    CHECK_STR(file.fault, "the file ends before row 2, column 3 of 3 x 2 values");
    fclose(f);
    points_file_free(&file);
    int folder = open("/tmp", O_RDONLY);
    CHECK(folder >= 0 && !asc_file_read(&file, folder, NULL, &fields, &notes));
    CHECK_STR(file.fault, strerror(EISDIR));
    close(folder);
    points_file_free(&file);
}

TEST(grids_are_recognised_by_their_first_words)
{
    static const char *const yes[] = {"ncols 3", "NROWS  12\r", "\xEF\xBB\xBF \nxllcorner\t-5",
                                      "dx .5", "nodata_value -1"},
                             *const no[] = {
                                 "",      "ncols", "ncols nrows\n3 2", "ncols,nrows\n1,2",
                                 "x y\n", "0 0 1", "ncolsx 3",         "DSAA\n3 2"};
    for (size_t i = 0; i < sizeof yes / sizeof yes[0]; i++)
        CHECK_MSG(asc_begins(yes[i], strlen(yes[i])), "%s", yes[i]);
    for (size_t i = 0; i < sizeof no / sizeof no[0]; i++)
        CHECK_MSG(!asc_begins(no[i], strlen(no[i])), "%s", no[i]);
}
