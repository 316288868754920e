/* las_file_test.c - point clouds: LAS is read, LAZ through another program, and archives through their directory. */
#include "clients/files/las_file.h"

#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "tests/clients/cli.h"
#include "tests/clients/peer.h"
#include "tests/test.h"

enum { POINTS = 3, ROOM = 1000 };

struct las {
    unsigned char bytes[ROOM];
    size_t n;
};

static void put(struct las *l, size_t at, uint64_t v, size_t n)
{
    for (size_t i = 0; i < n; i++)
        l->bytes[at + i] = (unsigned char)(v >> (8 * i));
}

static void put_double(struct las *l, size_t at, double v)
{
    uint64_t bits;
    memcpy(&bits, &v, sizeof bits);
    put(l, at, bits, 8);
}

/* Three points, whose places in centimetres and the offset 1000 are (1, 2, 3), (-150, 250, 12345), (7, 8, 9). */
static struct las make_las(unsigned minor, unsigned format)
{
    static const uint16_t length[] = {20, 28, 26, 34, 57, 63, 30, 36, 38, 59, 67};
    static const int place[POINTS][3] = {{1, 2, 3}, {-150, 250, 12345}, {7, 8, 9}};
    struct las l = {.n = 0};
    size_t header = minor < 3 ? 227 : minor == 3 ? 235 : 375, data = header + 10;
    memcpy(l.bytes, "LASF", 4);
    put(&l, 24, 1, 1);
    put(&l, 25, minor, 1);
    put(&l, 94, header, 2);
    put(&l, 96, data, 4);
    put(&l, 104, format, 1);
    put(&l, 105, length[format] + 2u, 2);
    put(&l, 107, minor < 4 ? POINTS : 0, 4);
    if (minor == 4)
        put(&l, 247, POINTS, 8);
    for (size_t k = 0; k < 3; k++) {
        put_double(&l, 131 + 8 * k, 0.01);
        put_double(&l, 155 + 8 * k, k < 2 ? 1000 : 0);
    }
    for (size_t i = 0; i < POINTS; i++) {
        size_t at = data + i * (length[format] + 2u);
        for (size_t k = 0; k < 3; k++)
            put(&l, at + 4 * k, (uint32_t)place[i][k], 4);
        put(&l, at + 12, 100 + i, 2);
        put(&l, at + (format < 6 ? 15 : 16), 2 + i, 1);
    }
    l.n = data + POINTS * (length[format] + 2u);
    return l;
}

static void write_las(const char *name, const struct las *l)
{
    FILE *f = fopen(cli_path(name), "wb");
    CHECK(f != NULL && fwrite(l->bytes, 1, l->n, f) == l->n && fclose(f) == 0);
}

static const char *load(const char *name, const char *options, int *status)
{
    char command[300];
    snprintf(command, sizeof command, "load t %s %s", cli_path(name), options);
    return cli_run(status, command);
}

TEST(las_of_all_versions_and_formats_is_read_to_the_last_digit)
{
    cli_begin();
    for (unsigned minor = 0; minor < 5; minor++)
        for (unsigned format = 0; format < 11; format++) {
            struct las l = make_las(minor, format);
            int status;
            write_las("a.las", &l);
            const char *out = load("a.las", "--fields", &status);
            CHECK_MSG(status == 0, "%s", out);
            cli_expect("points t FIELDS z,intensity,classification",
                       "OK 3\n0 1000.01 1000.02 0.03 100 2\n1 998.5 1002.5 123.45 101 3\n"
                       "2 1000.07 1000.08 0.09 102 4\n");
            cli_run_well("drop t");
        }
    cli_finish();
}

TEST(las_is_known_by_its_first_bytes_and_read_from_pipes_and_archives)
{
    struct las l = make_las(2, 1);
    int status;
    cli_begin();
    write_las("a.dat", &l);
    const char *out = load("a.dat", "", &status);
    CHECK_MSG(status == 0 && strstr(out, "a.dat: using x y z of the points\n"), "%s", out);
    CHECK(strstr(out, "not used: intensity, classification") != NULL);
    CHECK(strstr(out, "noise") == NULL);
    put(&l, 237 + 2 * 30 + 15, 7, 1);
    write_las("noise.las", &l);
    CHECK(strstr(load("noise.las", "", &status), "1 points are classified as noise") != NULL);
    out = peer_shell(&status, "cat %s | %s -p %s load u -", cli_path("a.dat"), getenv("DELAUNAY"),
                     cli_daemon.port_text);
    CHECK(status == 0 && strstr(out, "added=3") != NULL);
    out = peer_shell(&status, "gzip -c %s | %s -p %s load v -", cli_path("a.dat"),
                     getenv("DELAUNAY"), cli_daemon.port_text);
    CHECK(status == 0 && strstr(out, "added=3") != NULL);
    cli_finish();
}

TEST(points_behind_those_that_the_header_of_a_las_file_counts_are_a_doubt)
{
    struct las l = make_las(2, 1);
    int status;
    cli_begin();
    put(&l, 107, 2, 4);
    write_las("a.las", &l);
    const char *out = load("a.las", "", &status);
    CHECK_MSG(status == 0 && strstr(out, "room for 1 more points than its header says") != NULL,
              "%s", out);
    cli_finish();
}

TEST(las_that_is_damaged_is_refused_with_the_reason)
{
    static const struct {
        size_t at, n;
        uint64_t v;
        const char *why;
    } damage[] = {{24, 1, 2, "a version of LAS that is not known"},
                  {104, 1, 20, "a format of LAS points that is not known"},
                  {105, 2, 19, "not LAS: the header contradicts itself"},
                  {96, 4, 230, "not LAS: the header contradicts itself"},
                  {131, 8, 0, "a scale or an offset is not a number"},
                  {155, 8, 0x7FF8000000000000, "a scale or an offset is not a number"},
                  {247, 8, 4, "the file ends after 3 of 4 points"},
                  {96, 4, 9000, "the file ends before its points"}};
    int status;
    cli_begin();
    for (size_t i = 0; i < sizeof damage / sizeof damage[0]; i++) {
        struct las l = make_las(4, 6);
        put(&l, damage[i].at, damage[i].v, damage[i].n);
        write_las("a.las", &l);
        const char *out = load("a.las", "", &status);
        CHECK_MSG(status == 1 && strstr(out, damage[i].why) != NULL, "%s: %s", damage[i].why, out);
    }
    struct las l = make_las(2, 0);
    l.n = 100;
    write_las("a.las", &l);
    CHECK(strstr(load("a.las", "", &status), "the header is not complete") && status == 1);
    l = make_las(2, 0);
    l.n -= 1;
    write_las("a.las", &l);
    CHECK(strstr(load("a.las", "", &status), "the file ends after 2 of 3 points") && status == 1);
    cli_finish();
}

/* A program of that name that keeps its arguments in a file and prints lines as the real one does. */
static void make_stub(const char *name, const char *output, int status)
{
    char text[500], path[128];
    mkdir(cli_path("bin"), 0700);
    snprintf(text, sizeof text, "#!/bin/sh\nprintf '%%s ' \"$@\" >%s\nprintf '%s'\nexit %d\n",
             cli_path("arguments"), output, status);
    snprintf(path, sizeof path, "bin/%s", name);
    cli_write(path, text);
    CHECK(chmod(cli_path(path), 0700) == 0);
}

static const char *load_laz(int *status)
{
    char directory[128];
    snprintf(directory, sizeof directory, "%s", cli_path("bin"));
    return peer_shell(status, "PATH=%s:/usr/bin:/bin %s -p %s load t %s 2>&1", directory,
                      getenv("DELAUNAY"), cli_daemon.port_text, cli_path("a.laz"));
}

TEST(laz_is_read_through_pdal_or_las2txt)
{
    struct las l = make_las(2, 1);
    int status;
    cli_begin();
    l.bytes[104] |= 0x80;
    write_las("a.laz", &l);
    peer_shell(&status, "command -v pdal || command -v las2txt");
    if (status != 0) {
        const char *out = load_laz(&status);
        CHECK_MSG(status == 1 &&
                      strstr(out, "the program pdal (Debian: pdal) or las2txt is needed"),
                  "%s", out);
    }
    make_stub("las2txt", "1000.01,1000.02,0.03\\r\\n998.50,1002.50,123.45\\r\\n1,2,3\\r\\n", 0);
    const char *out = load_laz(&status);
    CHECK_MSG(status == 0 && strstr(out, "added=3") != NULL, "%s", out);
    cli_expect("points t FIELDS z",
               "OK 3\n0 1000.01 1000.02 0.03\n1 998.5 1002.5 123.45\n2 1 2 3\n");
    char want[300];
    snprintf(want, sizeof want, "-i %s -stdout -parse xyz -sep comma ", cli_path("a.laz"));
    CHECK_STR(peer_shell(&status, "cat %s", cli_path("arguments")), want);
    cli_run_well("drop t");

    make_stub("pdal", "5.00,6.00,7.00\\n1.00,2.00,3.00\\n3.00,4.00,5.00\\n", 0);
    out = load_laz(&status);
    CHECK_MSG(status == 0 && strstr(out, "added=3") != NULL, "%s", out);
    cli_expect("get t 0", "OK 1\n0 5 6\n");
    out = peer_shell(&status, "cat %s", cli_path("arguments"));
    CHECK(strncmp(out, "translate --writer writers.text ", 32) == 0);
    CHECK(strstr(out, "--writers.text.order=X:2,Y:2,Z:2 ") != NULL);
    snprintf(want, sizeof want, " %s STDOUT ", cli_path("a.laz"));
    CHECK(strstr(out, want) != NULL);
    cli_finish();
}

TEST(laz_of_which_a_program_reads_only_a_part_is_refused)
{
    struct las l = make_las(2, 1);
    int status;
    cli_begin();
    l.bytes[104] |= 0x80;
    write_las("a.laz", &l);
    make_stub("pdal", "5.00,6.00,7.00\\n1.00,2.00,3.00\\n", 0);
    CHECK(strstr(load_laz(&status), "pdal has written 2 of 3 points") != NULL && status == 1);
    make_stub("pdal", "5.00,6.00,7.00\\n", 1);
    CHECK(strstr(load_laz(&status), "pdal could not read all of it") != NULL && status == 1);
    make_stub("pdal", "PDAL: something is wrong\\n", 0);
    CHECK(strstr(load_laz(&status), "a line that is not x,y,z: PDAL") != NULL && status == 1);
    const char *out = peer_shell(&status, "%s -p %s load t - <%s 2>&1", getenv("DELAUNAY"),
                                 cli_daemon.port_text, cli_path("a.laz"));
    CHECK_MSG(strstr(out, "LAZ is read from a file of its own") != NULL && status == 1, "%s", out);
    cli_finish();
}
