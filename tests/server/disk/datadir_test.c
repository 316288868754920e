/* datadir_test.c - the data directory itself. */
#include "server/disk/datadir.h"

#include "tests/server/directory.h"
#include "tests/server/file_calls.h"
#include "tests/test.h"

#include <errno.h>
#include <fcntl.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* Even if it existed already: the process that created it may have been killed before the sync. */
TEST(data_directory_is_synced_into_its_parent)
{
    struct directory parent = directory_new();
    struct datadir d;
    char path[100];
    snprintf(path, sizeof path, "%s/data", parent.path);
    for (int i = 0; i < 2; i++) {
        calls_watch(path);
        CHECK(datadir_open(&d, path, true));
        CHECK_STR(calls_text(), "sync ..\n");
        datadir_close(&d);
    }
    calls_fail("sync ..", 1, 1, EIO);
    CHECK(!datadir_open(&d, path, true) && d.fd < 0);
    CHECK(rmdir(path) == 0);
    directory_remove(&parent);
}

/* Whether the directory is the one that the descriptor has, which keeps its number from being used
 * again. */
static bool is_same(const char *path, int fd)
{
    struct stat a, b;
    CHECK(stat(path, &a) == 0 && fstat(fd, &b) == 0);
    return a.st_ino == b.st_ino;
}

TEST(an_empty_data_directory_is_made_again_so_that_its_name_is_synced)
{
    struct directory parent = directory_new();
    struct datadir d;
    char path[100];
    snprintf(path, sizeof path, "%s/data", parent.path);
    calls_watch(path);
    calls_fail("sync ..", 1, 1, EIO);
    CHECK(!datadir_open(&d, path, true));
    int failed = open(path, O_RDONLY);
    CHECK(datadir_open(&d, path, true) && !is_same(path, failed));
    CHECK(is_same(path, d.fd));
    datadir_close(&d);
    close(failed);
    CHECK(rmdir(path) == 0);
    directory_remove(&parent);
}

TEST(a_data_directory_that_has_a_file_or_was_made_by_an_operator_or_is_in_use_stays)
{
    struct directory directory = directory_quick();
    struct datadir d, other;
    int fd = open(directory.path, O_RDONLY);
    CHECK(chmod(directory.path, 0750) == 0);
    CHECK(datadir_open(&d, directory.path, true) && is_same(directory.path, fd));
    datadir_close(&d);
    CHECK(chmod(directory.path, 0700) == 0);
    CHECK(datadir_open(&d, directory.path, false) && is_same(directory.path, fd));
    CHECK(!datadir_open(&other, directory.path, true) && is_same(directory.path, fd));
    datadir_close(&d);
    directory_touch(&directory, "log.0000000000000001");
    CHECK(datadir_open(&d, directory.path, true) && is_same(directory.path, fd));
    datadir_close(&d);
    close(fd);
    directory_remove(&directory);
}

/* The names of the files that are ours, in their order. */
static const char *list(const struct datadir *d)
{
    static char text[400];
    struct datafiles files;
    CHECK(datadir_list(d, &files));
    text[0] = '\0';
    for (size_t i = 0; i < files.n; i++) {
        strcat(text, files.v[i].name);
        strcat(text, " ");
    }
    datafiles_free(&files);
    return text;
}

TEST(what_a_snapshot_replaces_is_forgotten_and_no_segment_that_has_later_changes)
{
    struct directory directory = directory_quick();
    struct datadir d;
    directory_touch(&directory, "snapshot.0000000000000001");
    directory_touch(&directory, "snapshot.0000000000000004");
    directory_touch(&directory, "log.0000000000000002");
    directory_touch(&directory,
                    "log.0000000000000004"); /* has change 5, which the snapshot has not */
    directory_touch(&directory, "log.0000000000000006");
    CHECK(datadir_open(&d, directory.path, false));
    datadir_forget(&d, 4);
    CHECK_STR(list(&d), "snapshot.0000000000000004 log.0000000000000004 log.0000000000000006 ");
    datadir_close(&d);
    directory_remove(&directory);
}

/* A file of that many bytes. */
static void make_file(const struct directory *dir, const char *name, size_t n)
{
    static const char bytes[200];
    char path[128];
    snprintf(path, sizeof path, "%s/%s", dir->path, name);
    file_write(path, bytes, n);
}

TEST(last_covered_segments_stay_for_followers_as_far_as_they_fit)
{
    struct directory directory = directory_quick();
    struct datadir d;
    make_file(&directory, "log.0000000000000001", 40);
    make_file(&directory, "log.0000000000000003", 100);
    make_file(&directory, "log.0000000000000005", 50);
    make_file(&directory, "log.0000000000000007", 150); /* is not covered, and does not count */
    directory_touch(&directory, "snapshot.0000000000000002");
    directory_touch(&directory, "snapshot.0000000000000006");
    CHECK(datadir_open(&d, directory.path, false));
    d.keep_log = 191;
    datadir_forget(&d, 6);
    CHECK_STR(list(&d), "snapshot.0000000000000006 log.0000000000000001 log.0000000000000003 "
                        "log.0000000000000005 log.0000000000000007 ");
    d.keep_log = 120; /* log.1 would fit, but not log.3: no gaps */
    datadir_forget(&d, 6);
    CHECK_STR(list(&d), "snapshot.0000000000000006 log.0000000000000005 log.0000000000000007 ");
    d.keep_log = 0;
    datadir_forget(&d, 6);
    CHECK_STR(list(&d), "snapshot.0000000000000006 log.0000000000000007 ");
    datadir_close(&d);
    directory_remove(&directory);
}

TEST(pinned_directory_forgets_nothing_until_it_is_unpinned)
{
    struct directory directory = directory_quick();
    struct datadir d;
    char path[128];
    directory_touch(&directory, "snapshot.0000000000000001");
    directory_touch(&directory, "snapshot.0000000000000004");
    CHECK(datadir_open(&d, directory.path, false));
    datadir_pin(&d);
    datadir_unpin(&d);
    datadir_pin(&d);
    datadir_pin(&d);
    datadir_forget(&d, 4);
    datadir_unpin(&d);
    CHECK(directory_file(&directory, "snapshot.", 1, path));
    datadir_unpin(&d);
    CHECK(!directory_file(&directory, "snapshot.", 1, path) &&
          directory_file(&directory, "snapshot.0000000000000004", 0, path));
    datadir_close(&d);
    directory_remove(&directory);
}

TEST(names_that_are_not_exactly_ours_are_left_alone)
{
    struct directory directory = directory_quick();
    struct datadir d;
    directory_touch(&directory, "log.0000000000000000"); /* the first change is 1 */
    directory_touch(&directory, "log.0000000000000001");
    directory_touch(&directory, "log.0000000000000001.tmp");
    directory_touch(&directory, "log.1");
    directory_touch(&directory, "log.000000000000000A");
    directory_touch(&directory, "snapshot.0000000000000002.tmp");
    directory_touch(&directory, "snapshot.00000000000000020");
    CHECK(datadir_open(&d, directory.path, false));
    CHECK_STR(list(&d), "log.0000000000000001 snapshot.0000000000000002.tmp ");
    datadir_close(&d);
    directory_remove(&directory);
}

TEST(directory_without_memory_for_its_list_is_not_taken_for_an_empty_one)
{
    struct directory directory = directory_quick();
    struct datadir d;
    struct datafiles files;
    directory_touch(&directory, "log.0000000000000001");
    CHECK(datadir_open(&d, directory.path, false));
    for (long n = 1;; n++) {
        test_fail_alloc(n);
        bool ok = datadir_list(&d, &files);
        bool failed = test_alloc_failed();
        test_fail_alloc(0);
        CHECK(ok == !failed && files.n == ok);
        datafiles_free(&files);
        if (!failed)
            break;
    }
    datadir_close(&d);
    directory_remove(&directory);
}

TEST(directory_whose_names_cannot_all_be_read_is_not_taken_for_one_with_fewer)
{
    struct directory directory = directory_quick();
    struct datadir d;
    struct datafiles files;
    directory_touch(&directory, "log.0000000000000001");
    CHECK(datadir_open(&d, directory.path, false));
    for (unsigned n = 1; n <= 4; n++) { /* with `.` and `..`, and the end */
        calls_watch(directory.path);
        calls_fail("list .", n, 1, EIO);
        CHECK(!datadir_list(&d, &files) && errno == EIO && files.n == 0);
    }
    datadir_close(&d);
    directory_remove(&directory);
}

/* A folder can be opened like a file, and reading it is an error. */
TEST(what_cannot_be_read_is_not_put_aside)
{
    struct directory directory = directory_quick();
    struct datadir d;
    struct datafiles files;
    char path[128], name[DATADIR_ASIDE];
    snprintf(path, sizeof path, "%s/log.%016x", directory.path, 1);
    CHECK(datadir_open(&d, directory.path, false) && mkdir(path, 0700) == 0);
    CHECK(datadir_list(&d, &files) && files.n == 1);
    CHECK(!datadir_copy_aside(&d, &files.v[0], 0, name) && errno == EINVAL);
    CHECK(!directory_file(&directory, "damaged", 0, path));
    datafiles_free(&files);
    datadir_close(&d);
    snprintf(path, sizeof path, "%s/log.%016x", directory.path, 1);
    CHECK(rmdir(path) == 0);
    directory_remove(&directory);
}
