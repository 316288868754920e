/* zip_file_test.c - the file of an archive is read, and nothing is guessed where there are several. */
#include <stdlib.h>
#include <string.h>

#include "tests/clients/cli.h"
#include "tests/clients/peer.h"
#include "tests/test.h"

/* An archive made by Info-ZIP, of a.csv: `x,y` and two points; stored. */
static const unsigned char stored[] = {
    'P', 'K', 3,  4,   10,  0,   0,   0,   0,   0,   0,   0,   0,   0,   0,   0,   0,   0,
    14,  0,   0,  0,   14,  0,   0,   0,   5,   0,   0,   0,   'a', '.', 'c', 's', 'v', 'x',
    ',', 'y', 10, '1', ',', '2', 10,  '3', ',', '4', '.', '5', 10,  'P', 'K', 1,   2,   10,
    0,   10,  0,  0,   0,   0,   0,   0,   0,   0,   0,   0,   0,   0,   0,   14,  0,   0,
    0,   14,  0,  0,   0,   5,   0,   0,   0,   0,   0,   0,   0,   0,   0,   0,   0,   0,
    0,   0,   0,  0,   0,   'a', '.', 'c', 's', 'v', 'P', 'K', 5,   6,   0,   0,   0,   0,
    1,   0,   1,  0,   51,  0,   0,   0,   49,  0,   0,   0,   0,   0};

static const char *load(const char *name, int *status)
{
    char command[300];
    snprintf(command, sizeof command, "load t %s", cli_path(name));
    return cli_run(status, command);
}

static void write_bytes(const char *name, const unsigned char *bytes, size_t n)
{
    FILE *f = fopen(cli_path(name), "wb");
    CHECK(f != NULL && fwrite(bytes, 1, n, f) == n && fclose(f) == 0);
}

static uint32_t crc(const unsigned char *s, size_t n)
{
    uint32_t v = ~0u;
    for (size_t i = 0; i < n; i++) {
        v ^= s[i];
        for (int k = 0; k < 8; k++)
            v = v >> 1 ^ (v & 1 ? 0xEDB88320u : 0);
    }
    return ~v;
}

TEST(a_stored_file_of_an_archive_is_read_and_its_checksum_compared)
{
    unsigned char bytes[sizeof stored];
    int status;
    cli_begin();
    memcpy(bytes, stored, sizeof stored);
    uint32_t sum = crc(bytes + 35, 14);
    for (int i = 0; i < 4; i++)
        bytes[49 + 16 + i] = (unsigned char)(sum >> (8 * i));
    write_bytes("a.zip", bytes, sizeof bytes);
    const char *out = load("a.zip", &status);
    CHECK_MSG(status == 0 && strstr(out, "a.zip: reading a.csv of the archive\n"), "%s", out);
    cli_expect("points t", "OK 2\n0 1 2\n1 3 4.5\n");
    bytes[40]++;
    write_bytes("a.zip", bytes, sizeof bytes);
    CHECK(strstr(load("a.zip", &status), "the archive is damaged") != NULL && status == 1);
    bytes[40]--;
    for (size_t n = 4; n < sizeof bytes; n += 7) { /* cut off anywhere */
        write_bytes("a.zip", bytes, n);
        out = load("a.zip", &status);
        CHECK_MSG(status == 1 && strstr(out, "the archive is not complete"), "%zu: %s", n, out);
    }
    bytes[49 + 8] = 1;
    write_bytes("a.zip", bytes, sizeof bytes);
    CHECK(strstr(load("a.zip", &status), "the archive is encrypted") != NULL && status == 1);
    bytes[49 + 8] = 0;
    bytes[49 + 10] = 12;
    write_bytes("a.zip", bytes, sizeof bytes);
    CHECK(strstr(load("a.zip", &status), "in a way that is not known") != NULL && status == 1);
    cli_finish();
}

TEST(archives_made_by_zip_are_read_and_several_files_are_named)
{
    int status;
    cli_begin();
    peer_shell(&status, "command -v zip");
    if (status != 0) {
        puts("skipped: archives are made by zip");
        cli_finish();
        return;
    }
    FILE *f = fopen(cli_path("points.csv"), "w");
    CHECK(f != NULL);
    fputs("x,y\n", f);
    for (int i = 0; i < 20000; i++)
        fprintf(f, "%d,%d\n", i, i * 7 % 1000);
    fclose(f);
    cli_write("read.me", "nothing\n");
    cli_write("b.geojson", "{\"type\":\"Point\",\"coordinates\":[1,2]}");
    peer_shell(&status,
               "cd %s && zip -q a.zip points.csv read.me && zip -q b.zip points.csv b.geojson "
               "&& mkdir d && cp b.geojson d && zip -qr c.zip d && zip -q e.zip read.me b.zip",
               cli_path(""));
    CHECK(status == 0);
    const char *out = load("a.zip", &status);
    CHECK_MSG(status == 0 && strstr(out, "added=20000") != NULL, "%s", out);
    out = peer_shell(&status, "cat %s | %s -p %s load u - 2>&1", cli_path("a.zip"),
                     getenv("DELAUNAY"), cli_daemon.port_text);
    CHECK_MSG(status == 0 && strstr(out, "added=20000") != NULL, "%s", out);
    out = load("b.zip", &status);
    CHECK_MSG(status == 1 && strstr(out, "the archive has 2 files: points.csv, b.geojson; unpack"),
              "%s", out);
    out = load("c.zip", &status);
    CHECK_MSG(status == 0 && strstr(out, "reading d/b.geojson of the archive"), "%s", out);
    out = load("e.zip", &status);
    CHECK_MSG(status == 1 && strstr(out, "the archive has 2 files: read.me, b.zip; unpack"), "%s",
              out);
    cli_finish();
}
