/* part_file_test.c - a file that appears when it is complete, and only if all of it was written. */
#include "clients/cli/part_file.h"

#include <fcntl.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/xattr.h>
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

/* From now on, files of this process may not grow beyond `bytes` bytes. */
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

TEST(part_file_whose_last_write_fails_reports_it_on_closing)
{
    struct part_file f;
    begin();
    CHECK(part_file_open(&f, path) == NULL && fputs("text", f.out) >= 0);
    limit_files(0);
    CHECK(!part_file_close(&f));
    limit_files(RLIM_INFINITY);
    finish();
}

TEST(part_file_with_an_earlier_failed_write_reports_it_on_closing)
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

/* Skips the test if files here cannot have extended attributes. */
static void need_attributes(void)
{
    FILE *f = fopen(path, "w");
    CHECK(f != NULL && fclose(f) == 0);
    bool can = setxattr(path, "user.delaunay_test", "1", 1, 0) == 0;
    unlink(path);
    if (!can)
        SKIP("this machine has no extended attributes in /tmp");
}

static void write_text(const char *to, const char *text)
{
    FILE *f = fopen(to, "w");
    CHECK(f != NULL && fputs(text, f) >= 0 && fclose(f) == 0);
}

TEST(part_file_recognises_its_own_files_until_they_are_changed)
{
    struct part_file f;
    begin();
    CHECK(!part_file_is_foreign(path)); /* there is none */
    need_attributes();
    for (int i = 0; i < 2; i++) {
        CHECK(part_file_open(&f, path) == NULL && fputs("text", f.out) >= 0);
        CHECK(part_file_close(&f) && part_file_keep(&f));
        CHECK(!part_file_is_foreign(path));
    }
    FILE *more = fopen(path, "a"); /* the file keeps its attributes */
    CHECK(more != NULL && fputs("!", more) >= 0 && fclose(more) == 0);
    CHECK(part_file_is_foreign(path));
    finish();
}

TEST(part_file_treats_any_other_file_as_foreign_unless_it_is_empty)
{
    begin();
    write_text(path, "x,y\n");
    CHECK(part_file_is_foreign(path));
    write_text(path, "");
    CHECK(!part_file_is_foreign(path));
    CHECK(!part_file_is_foreign("/dev/null"));
    finish();
}

TEST(part_file_writes_to_a_device_and_leaves_it_there)
{
    struct part_file f;
    struct stat st;
    begin();
    CHECK(mkfifo(path, 0600) == 0);
    int reader = open(path, O_RDONLY | O_NONBLOCK);
    CHECK(reader >= 0 && part_file_open(&f, path) == NULL && fputs("text", f.out) >= 0);
    CHECK(part_file_close(&f) && part_file_keep(&f));
    CHECK(stat(path, &st) == 0 && S_ISFIFO(st.st_mode) && access(part, F_OK) != 0);
    part_file_drop(&f);
    CHECK(access(path, F_OK) == 0);
    close(reader);
    finish();
}
