/* part_file_test.c - a file that appears when it is complete, and only if all of it was written. */
#include "clients/part_file.h"

#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <unistd.h>

#include "tests/test.h"

static char directory[64], path[80], part[100];

static void begin(void)
{
    snprintf(directory, sizeof directory, "/tmp/delaunay_part_XXXXXX");
    CHECK(mkdtemp(directory) != NULL);
    snprintf(path, sizeof path, "%s/a", directory);
    snprintf(part, sizeof part, "%s.part", path);
}

static void finish(void)
{
    unlink(path);
    unlink(part);
    CHECK(rmdir(directory) == 0);
}

/* Files of this process may grow to so many bytes from now on. */
static void limit_files(rlim_t bytes)
{
    struct rlimit limit;
    signal(SIGXFSZ, SIG_IGN);
    CHECK(getrlimit(RLIMIT_FSIZE, &limit) == 0);
    limit.rlim_cur = bytes;
    CHECK(setrlimit(RLIMIT_FSIZE, &limit) == 0);
}

TEST(part_file_appears_when_it_is_kept)
{
    struct part_file f;
    begin();
    CHECK(part_file_open(&f, path) == NULL && fputs("text", f.out) >= 0);
    CHECK(access(path, F_OK) != 0 && access(part, F_OK) == 0);
    CHECK(part_file_close(&f) && access(path, F_OK) != 0);
    CHECK(part_file_keep(&f) && access(path, F_OK) == 0 && access(part, F_OK) != 0);
    finish();
}

TEST(part_file_that_is_dropped_leaves_nothing)
{
    struct part_file f;
    begin();
    CHECK(part_file_open(&f, path) == NULL && part_file_close(&f));
    part_file_drop(&f);
    CHECK(access(path, F_OK) != 0 && access(part, F_OK) != 0);
    finish();
}

TEST(part_file_whose_last_write_fails_is_not_closed_well)
{
    struct part_file f;
    begin();
    CHECK(part_file_open(&f, path) == NULL && fputs("text", f.out) >= 0);
    limit_files(0);
    CHECK(!part_file_close(&f));
    limit_files(RLIM_INFINITY);
    finish();
}

TEST(part_file_with_a_write_that_failed_once_is_not_closed_well)
{
    static char block[1 << 16];
    struct part_file f;
    begin();
    CHECK(part_file_open(&f, path) == NULL);
    limit_files(0);
    CHECK(fwrite(block, 1, sizeof block, f.out) < sizeof block);
    limit_files(RLIM_INFINITY);
    CHECK(fputs("the rest", f.out) >= 0);
    CHECK(!part_file_close(&f));
    finish();
}

TEST(part_file_needs_a_folder_and_a_path_that_is_not_too_long)
{
    struct part_file f;
    char long_path[sizeof f.part];
    CHECK(strcmp(part_file_open(&f, "/nonexistent/a"), "/nonexistent/a.part") == 0);
    memset(long_path, 'a', sizeof long_path);
    long_path[sizeof long_path - 5] = '\0'; /* one byte too many with ".part" */
    CHECK(part_file_open(&f, long_path) == long_path);
}
