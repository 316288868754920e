/* backup_test.c - BACKUP: a backup has the sets of its moment, and later changes do not alter it; refused
 * requests. */
#include "server/disk/backup.h"
#include "tests/faults/tree.h"
#include "tests/server/disk/backup_bench.h"
#include "tests/test.h"

#include <fcntl.h>
#include <inttypes.h>
#include <signal.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

/* ---- what is in a backup ---- */

static void back_up_and_restore(const char *policy)
{
    struct bench b;
    begin(&b, (const char *const[]){"--fsync", policy, NULL});
    expect_reply(&b.d, "BACKUP nothing\n", "OK 0 lsn=0 files=1 ");
    carry_out(&b.d, backup_history);
    char *want = directory_state(&b.d, backup_names);
    expect_reply(&b.d, "BACKUP log\n", "OK 0 lsn=11 files=1 ");
    snapshot(&b.d, 1);
    expect_reply(&b.d, "BACKUP snapshot\n", "OK 0 lsn=11 files=2 ");
    CHECK(daemon_info(&b.d, "backups") == 3 && daemon_info(&b.d, "backup_lsn") == 11 &&
          daemon_info(&b.d, "backup_timestamp_s") > 1700000000);
    carry_out(&b.d, "DEL t 0\nDROP a\nADD b 3 3\n");
    char *later = directory_state(&b.d, backup_names);
    expect_reply(&b.d, "BACKUP both\n", "OK 0 lsn=14 files=2 ");
    carry_out(&b.d, "DROP b\n");
    snapshot(&b.d, 2); /* removes the files that the backups have */
    check_restored(&b, "log", want);
    check_restored(&b, "snapshot", want);
    check_restored(&b, "both", later);
    struct directory nothing = backup_path(&b, "nothing");
    check_good(&nothing);
    expect_reply(&b.d, "SETS\n", "OK 1");
    free(want);
    free(later);
    end(&b);
}

TEST(backup_has_the_sets_as_they_were_whatever_happens_later)
{
    back_up_and_restore("always");
}

TEST(backup_has_the_sets_as_they_were_with_every_fsync_policy)
{
    back_up_and_restore("everysec");
    back_up_and_restore("no");
}

/* Edits are still on their way to the disk when BACKUP arrives. */
TEST(backup_has_the_changes_that_were_sent_before_it)
{
    struct bench b;
    begin(&b, NULL);
    int fd = daemon_connect(&b.d);
    for (uint64_t i = 1; i <= 50; i++) {
        char request[100];
        snprintf(request, sizeof request, "ADD t %" PRIu64 " 0\nBACKUP n%" PRIu64 "\n", i, i);
        say(fd, request);
        hear_line(fd);
        CHECK(number_in(hear_line(fd), "lsn=") == i);
    }
    close(fd);
    end(&b);
}

static ino_t inode(const struct directory *dir, const char *prefix, unsigned n, nlink_t *links)
{
    char path[128];
    struct stat st;
    CHECK(directory_file(dir, prefix, n, path) && stat(path, &st) == 0);
    *links = st.st_nlink;
    return st.st_ino;
}

/* Only the segment that is being written grows, so it is copied. */
TEST(backup_links_snapshots_and_closed_segments_and_copies_the_open_one)
{
    struct bench b;
    nlink_t links;
    begin(&b, NULL);
    carry_out(&b.d, backup_history);
    snapshot(&b.d, 1);
    carry_out(&b.d, "ADD t 8 8\n");
    daemon_stop(&b.d, SIGKILL);
    start(&b, NULL); /* with a new segment */
    carry_out(&b.d, "ADD t 9 9\n");
    const char *reply = ask(&b.d, "BACKUP x\n");
    struct directory x = backup_path(&b, "x");
    char path[128];
    struct stat st;
    CHECK(number_in(reply, "files=") == 3 && directory_file(&x, "log.", 1, path) &&
          stat(path, &st) == 0 && number_in(reply, "copied=") == (uint64_t)st.st_size);
    CHECK(inode(&x, "snapshot.", 0, &links) == inode(&b.data, "snapshot.", 0, &links));
    CHECK(links == 2);
    CHECK(inode(&x, "log.", 0, &links) == inode(&b.data, "log.", 0, &links) && links == 2);
    CHECK(inode(&x, "log.", 1, &links) != inode(&b.data, "log.", 1, &links) && links == 1);
    end(&b);
}

TEST(backup_on_another_file_system_is_a_copy)
{
    struct bench b;
    struct stat here, there;
    struct directory root = directory_new(), other = directory_quick();
    CHECK(stat(root.path, &here) == 0 && stat(other.path, &there) == 0);
    begin_on(&b, root, other.path);
    start(&b, NULL);
    carry_out(&b.d, backup_history);
    snapshot(&b.d, 1);
    char *want = directory_state(&b.d, backup_names);
    const char *reply = ask(&b.d, "BACKUP x\n");
    CHECK(here.st_dev == there.st_dev || number_in(reply, "copied=") == number_in(reply, "size="));
    check_restored(&b, "x", want);
    free(want);
    end(&b);
    tree_remove(other.path);
}

/* ---- what is refused ---- */

TEST(backup_needs_a_data_directory_and_a_directory_for_backups)
{
    struct directory dir = directory_quick();
    struct daemon d = daemon_start((const char *const[]){"--backup-dir", dir.path, NULL});
    expect_reply(&d, "BACKUP x\n", "ERR IO there is no data directory");
    daemon_stop(&d, SIGKILL);
    d = directory_daemon(&dir, NULL);
    expect_reply(&d, "BACKUP x\n", "ERR IO there is no directory for backups (--backup-dir)");
    expect_reply(&d, "CONFIG SET backup-dir /tmp\n", "ERR SYNTAX ");
    daemon_stop(&d, SIGKILL);
    d = directory_daemon(&dir, (const char *const[]){"--backup-dir", dir.path, NULL});
    expect_reply(&d, "BACKUP x\n", "ERR IO the backup cannot be written: Invalid argument");
    daemon_stop(&d, SIGKILL);
    tree_remove(dir.path);
}

TEST(backup_cannot_leave_its_directory)
{
    static const char *const bad[] = {"..", ".", ".x", "../x", "x/y", "/x", "x.tmp", "x y"};
    struct bench b;
    char request[128];
    begin(&b, NULL);
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        snprintf(request, sizeof request, "BACKUP %s\n", bad[i]);
        expect_reply(&b.d, request, "ERR SYNTAX ");
    }
    CHECK(!backup_may_name("", 0) && !backup_may_name("a\0b", 3) &&
          backup_may_name("2026.1_a:-", 10));
    snprintf(request, sizeof request, "BACKUP %0*d\n", BACKUP_NAME_LIMIT, 1);
    expect_reply(&b.d, request, "OK 0 ");
    snprintf(request, sizeof request, "BACKUP %0*d\n", BACKUP_NAME_LIMIT + 1, 1);
    expect_reply(&b.d, request, "ERR SYNTAX ");
    end(&b);
}

TEST(backup_replaces_nothing_but_an_empty_directory)
{
    struct bench b;
    begin(&b, NULL);
    expect_reply(&b.d, "BACKUP x\n", "OK 0 ");
    expect_reply(&b.d, "BACKUP x\n", "ERR EXISTS there is a x already");
    file_write(backup_path(&b, "file").path, "", 0);
    expect_reply(&b.d, "BACKUP file\n", "ERR EXISTS ");
    CHECK(symlink("x", backup_path(&b, "link").path) == 0);
    expect_reply(&b.d, "BACKUP link\n", "ERR EXISTS ");
    CHECK(mkdir(backup_path(&b, "empty").path, 0700) == 0);
    expect_reply(&b.d, "BACKUP empty\n", "OK 0 ");
    end(&b);
}

TEST(backup_needs_a_token_for_writing)
{
    struct bench b;
    char tokens[100];
    struct directory root = directory_quick();
    begin_on(&b, root, root.path);
    snprintf(tokens, sizeof tokens, "%s/tokens", root.path);
    file_write(tokens, "ro reader\nrw writer\n", 20);
    CHECK(mkdir(b.backups, 0700) == 0);
    b.d = daemon_start((const char *const[]){"--data", b.data.path, "--backup-dir", b.backups,
                                             "--auth-file", tokens, NULL});
    converse(&b.d, "BACKUP x\nAUTH reader\nBACKUP x\n",
             "ERR NOAUTH authenticate first: AUTH token\nOK 0 role=ro\n"
             "ERR DENIED your token is for reading only\n");
    converse(&b.d, "AUTH writer\nBACKUP x\n",
             "OK 0 role=rw\nOK 0 lsn=0 files=1 size=64 copied=64\n");
    end(&b);
}

TEST(one_backup_at_a_time_in_a_directory)
{
    struct bench b;
    begin(&b, NULL);
    expect_reply(&b.d, "BACKUP x\n", "OK 0 ");
    int fd = open(b.backups, O_RDONLY | O_DIRECTORY);
    CHECK(fd >= 0 && flock(fd, LOCK_EX) == 0);
    expect_reply(&b.d, "BACKUP y\n", "ERR BUSY another backup is being written");
    close(fd);
    expect_reply(&b.d, "BACKUP y\n", "OK 0 ");
    end(&b);
}

/* A repair changes files in place; a backup shares these files. */
TEST(repair_changes_no_backup)
{
    struct bench b;
    char path[128], text[4000];
    size_t n;
    begin(&b, NULL);
    carry_out(&b.d, "ADD t 0 0\nADD t 1 1\nADD t 2 2\nADD t 3 3\n");
    daemon_stop(&b.d, SIGTERM);
    start(&b, NULL);
    expect_reply(&b.d, "BACKUP x\n", "OK 0 ");
    daemon_stop(&b.d, SIGTERM);
    CHECK(directory_file(&b.data, "log.", 0, path));
    char *bytes = file_read(path, &n);
    bytes[n / 2] ^= 1;
    bytes[20] ^= 1; /* in the header */
    file_write(path, bytes, n);
    struct directory x = backup_path(&b, "x");
    struct tree before = tree_read(x.path);
    directory_run(&b.data, "--repair", text, sizeof text);
    struct tree after = tree_read(x.path), data = tree_read(b.data.path);
    CHECK_MSG(strstr(text, "cut off") != NULL && strstr(text, "header") != NULL, "%s", text);
    CHECK(tree_difference(&before, &after) == NULL && tree_difference(&before, &data) != NULL);
    tree_free(&before);
    tree_free(&after);
    tree_free(&data);
    free(bytes);
    tree_remove(b.root.path);
}
