/* points_file_test.c - files of lines `x y`, good and bad. */
#include "clients/files/table_file.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tests/test.h"

/* An open file with these bytes, already unlinked. */
static int file_with(const char *bytes, size_t n)
{
    FILE *f = tmpfile();
    CHECK(f != NULL && fwrite(bytes, 1, n, f) == n && fflush(f) == 0);
    int fd = dup(fileno(f));
    fclose(f);
    CHECK(lseek(fd, 0, SEEK_SET) == 0);
    return fd;
}

static bool read_xy(struct points_file *f, int fd)
{
    struct table_file t = {.wish = {.xy = true}};
    bool ok = table_file_read(&t, f, fd, NULL, NULL);
    table_file_free(&t);
    return ok;
}

static void check_read(const char *text, const char *want)
{
    char got[400] = "";
    struct points_file f = {0};
    int fd = file_with(text, strlen(text));
    CHECK_MSG(read_xy(&f, fd), "line %d: %s", (int)f.line, f.fault);
    for (size_t i = 0; i < f.n; i++)
        snprintf(got + strlen(got), sizeof got - strlen(got), "%g %g;", f.xy[2 * i],
                 f.xy[2 * i + 1]);
    CHECK_STR(got, want);
    close(fd);
    points_file_free(&f);
}

TEST(points_file_skips_blank_lines_and_comments)
{
    check_read("# places\n1 2\n\n  \t\n#\n 3\t4 \n  # more\n5 6\n", "1 2;3 4;5 6;");
    check_read("", "");
    check_read("\n", "");
}

TEST(points_file_accepts_crlf_and_a_last_line_without_end)
{
    check_read("1 2\r\n3 4\r\n\r\n5e-1 -.5", "1 2;3 4;0.5 -0.5;");
}

static void check_fault(const char *text, uint64_t line, const char *fault)
{
    struct points_file f = {0};
    int fd = file_with(text, strlen(text));
    CHECK_MSG(!read_xy(&f, fd), "accepted: %s", text);
    CHECK_STR(f.fault, fault);
    CHECK_MSG(f.line == line, "%s: line %d", text, (int)f.line);
    close(fd);
    points_file_free(&f);
}

TEST(points_file_reports_the_number_of_a_bad_line)
{
    const char *range = "a coordinate must be 0 or from 2^-142 to 2^201 in magnitude";
    check_fault("1 2\n# x\n3\n4 5\n", 3, "a point needs x and y");
    check_fault("1 2\n1 2 3\n", 2, "more than x and y; --columns 1,2 takes the first two");
    check_fault("1 2\n1 two\n", 2, "not a number: \"two\" in column 2");
    check_fault("1 2\nnan 1\n", 2, "not a number: \"nan\" in column 1");
    check_fault("\n\n1 2\n0x10 1", 4, "not a number: \"0x10\" in column 1");
    check_fault("1 1e61\n", 1, range);
    check_fault("1e-43 0\n", 1, range);
    check_fault("1 1e400\n", 1, range);
    check_fault("1e-400 1\n", 1, range);
}

TEST(points_file_reads_across_blocks)
{
    const size_t n = 200000;
    char *text = malloc(40 * n);
    size_t len = 0;
    for (size_t i = 0; i < n; i++)
        len +=
            (size_t)sprintf(text + len, i % 7 == 0 ? "%zu %zu.25\r\n" : "%zu %zu.25\n", i, 2 * i);
    struct points_file f = {0};
    int fd = file_with(text, len);
    CHECK(read_xy(&f, fd) && f.n == n && f.line == n);
    for (size_t i = 0; i < n; i++)
        CHECK(f.xy[2 * i] == (double)i && f.xy[2 * i + 1] == (double)(2 * i) + 0.25);
    close(fd);
    points_file_free(&f);
    free(text);
}

/* Writes the text byte by byte, in a process of its own. */
static int dribble(const char *text)
{
    int fd[2];
    CHECK(pipe(fd) == 0);
    if (fork() == 0) {
        for (; *text != 0; text++)
            if (write(fd[1], text, 1) != 1)
                _exit(1);
        _exit(0);
    }
    close(fd[1]);
    return fd[0];
}

TEST(points_file_reads_from_a_pipe_in_small_pieces)
{
    struct points_file f = {0};
    int fd = dribble("1.5 2.5\n-3e2 4\n# end\n7 8");
    CHECK(read_xy(&f, fd) && f.n == 3);
    CHECK(f.xy[2] == -300 && f.xy[5] == 8);
    close(fd);
    points_file_free(&f);
}

TEST(points_file_limits_the_length_of_a_line)
{
    size_t n = (16 << 20) + 400000;
    char *text = malloc(n);
    struct points_file f = {0};
    memset(text, '1', n);
    memcpy(text, "1 2\n", 4);
    int fd = file_with(text, n);
    CHECK(!read_xy(&f, fd) && f.line == 2);
    CHECK_STR(f.fault, "a line has more than 16 MB");
    close(fd);
    points_file_free(&f);
    free(text);
}

TEST(points_file_reports_a_read_error)
{
    struct points_file f = {0};
    int fd = open("/", O_RDONLY);
    CHECK(fd >= 0 && !read_xy(&f, fd));
    CHECK_STR(f.fault, strerror(EISDIR));
    CHECK(f.line == 0);
    close(fd);
    points_file_free(&f);
}

TEST(points_file_reports_that_memory_ran_out)
{
    char text[5000 * 4];
    for (size_t i = 0; i < sizeof text; i += 4)
        memcpy(text + i, "1 2\n", 4);
    bool failed = true;
    for (long nth = 1; failed; nth++) {
        struct points_file f = {0};
        int fd = file_with(text, sizeof text);
        test_fail_alloc(nth);
        bool ok = read_xy(&f, fd);
        failed = test_alloc_failed();
        test_fail_alloc(0);
        CHECK(ok == !failed);
        if (failed)
            CHECK_STR(f.fault, "out of memory");
        close(fd);
        points_file_free(&f);
    }
}
