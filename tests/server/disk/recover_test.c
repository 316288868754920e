/* recover_test.c - the result of reading a directory, record by record and call by call. The files
 * are composed here, without a daemon. */
#include "tests/server/disk/recover_files.h"

#include "server/disk/log_file.h"
#include "tests/server/file_calls.h"
#include "tests/test.h"

#include <errno.h>
#include <string.h>
#include <unistd.h>

static bool file_is(const char *path, const char *bytes, size_t n)
{
    size_t there;
    char *got = file_read(path, &there);
    bool same = there == n && memcmp(got, bytes, n) == 0;
    free(got);
    return same;
}

/* ---- a damaged end ---- */

static void flip_a_bit(struct bench *b, size_t at)
{
    buf_head(&b->bytes)[at] ^= 4;
    end_file(b, DATAFILE_LOG, 1);
}

TEST(changes_behind_a_flipped_bit_are_put_aside_and_not_deleted)
{
    char path[128];
    struct bench b;
    begin(&b);
    write_unsynced(&b, 10);
    flip_a_bit(&b, b.end[4] + 20);
    read_all(&b);
    CHECK_MSG(b.r.result == RECOVERY_OK && b.r.torn && points_of_t(&b) == 4, "%s", b.r.why);
    calls_watch(b.directory.path);
    CHECK(recovery_tidy(&b.r));
    CHECK_STR(calls_text(),
              "create damaged.log.1\nwrite damaged.log.1\nsync damaged.log.1\nsync .\n"
              "cut log.1\nsync log.1\nwrite log.1\nsync log.1\n");
    CHECK_MSG(strstr(b.r.why, "damaged.log.0000000000000001") != NULL, "%s", b.r.why);
    CHECK_MSG(strstr(b.r.why, "5 intact records") != NULL, "%s", b.r.why);
    CHECK(directory_file(&b.directory, "damaged.", 0, path));
    CHECK(file_is(path, buf_head(&b.bytes) + b.end[4], b.end[10] - b.end[4]));
    CHECK(directory_file(&b.directory, "log.", 0, path));
    CHECK(file_is(path, buf_head(&b.bytes), b.end[4]));
    end(&b);
}

TEST(last_change_is_put_aside_when_it_is_damaged)
{
    char path[128];
    struct bench b;
    begin(&b);
    write_unsynced(&b, 3);
    flip_a_bit(&b, b.end[3] - 1);
    read_all(&b);
    CHECK(b.r.result == RECOVERY_OK && points_of_t(&b) == 2 && recovery_tidy(&b.r));
    CHECK(directory_file(&b.directory, "damaged.", 0, path));
    CHECK(file_is(path, buf_head(&b.bytes) + b.end[2], b.end[3] - b.end[2]));
    end(&b);
}

/* Its length is damaged, and the number of its points consistently: the file seems to end within
 * it. */
TEST(change_behind_one_that_seems_to_be_cut_off_is_put_aside)
{
    static const char length[] = {0x41, 0x1f, 0, 0}, points[] = {(char)0xf4, 0x01, 0, 0};
    char path[128];
    struct bench b;
    begin(&b);
    write_unsynced(&b, 3);
    memcpy(buf_head(&b.bytes) + b.end[1] + 4, length, sizeof length); /* 8001 = 1 + 16 * 500 */
    memcpy(buf_head(&b.bytes) + b.end[1] + 32, points, sizeof points);
    end_file(&b, DATAFILE_LOG, 1);
    read_all(&b);
    CHECK(b.r.result == RECOVERY_OK && points_of_t(&b) == 1 && recovery_tidy(&b.r));
    CHECK(directory_file(&b.directory, "damaged.", 0, path));
    CHECK(file_is(path, buf_head(&b.bytes) + b.end[1], b.end[3] - b.end[1]));
    end(&b);
}

TEST(segment_with_a_damaged_header_and_a_damaged_change_is_refused)
{
    char path[128];
    struct bench b;
    begin(&b);
    write_unsynced(&b, 1);
    flip_a_bit(&b, b.end[1] - 1);
    flip_a_bit(&b, 3);
    read_all(&b);
    CHECK(b.r.result == RECOVERY_REFUSED && b.r.bad_log);
    CHECK(directory_file(&b.directory, "log.", 0, path));
    CHECK(file_is(path, buf_head(&b.bytes), b.end[1]));
    end(&b);
}

static void expect_cut(struct bench *b, size_t at, size_t n)
{
    char path[128];
    path_of(b, DATAFILE_LOG, 1, path);
    file_write(path, buf_head(&b->bytes), n);
    read_all(b);
    CHECK(b->r.result == RECOVERY_OK && b->r.torn && recovery_tidy(&b->r));
    CHECK(file_is(path, buf_head(&b->bytes), at));
    CHECK(!directory_file(&b->directory, "damaged.", 0, path));
    recovery_clear(&b->r);
}

/* Nothing in it was ever acknowledged. */
TEST(end_that_is_only_incomplete_is_cut_off_without_a_copy)
{
    double p[] = {1, 1, 2, 2};
    struct bench b;
    begin(&b);
    write_unsynced(&b, 3);
    expect_cut(&b, b.end[2], b.end[3] - 1);
    expect_cut(&b, b.end[2], b.end[2] + 1);
    put(&b, (struct record){.lsn = 4, .type = RECORD_LOAD, .first = 3});
    expect_cut(&b, b.end[3], b.end[4]);
    put(&b, (struct record){.lsn = 5, .type = RECORD_CHUNK, .n = 2, .items = p});
    expect_cut(&b, b.end[3], b.end[5]);
    expect_cut(&b, b.end[3], b.end[5] - 1);
    end(&b);
}

/* A LOAD counts when it is complete; its last record may have been acknowledged. */
TEST(load_whose_last_record_is_damaged_is_put_aside)
{
    char path[128];
    double p[] = {1, 1, 2, 2};
    struct bench b;
    begin(&b);
    write_unsynced(&b, 3);
    put(&b, (struct record){.lsn = 4, .type = RECORD_LOAD, .first = 3});
    put(&b, (struct record){.lsn = 5, .type = RECORD_CHUNK, .n = 2, .items = p});
    put(&b, (struct record){.lsn = 6, .type = RECORD_LOADED, .n = 2});
    flip_a_bit(&b, b.end[5] + 9);
    read_all(&b);
    CHECK(b.r.result == RECOVERY_OK && points_of_t(&b) == 3 && recovery_tidy(&b.r));
    CHECK(directory_file(&b.directory, "damaged.", 0, path));
    CHECK(file_is(path, buf_head(&b.bytes) + b.end[3], b.end[6] - b.end[3]));
    end(&b);
}

TEST(damaged_end_stays_where_it_is_while_it_cannot_be_put_aside)
{
    static const char *const calls[] = {"create damaged.log.1", "write damaged.log.1",
                                        "sync damaged.log.1", "sync ."};
    char path[128];
    struct bench b;
    begin(&b);
    write_unsynced(&b, 10);
    flip_a_bit(&b, b.end[4] + 20);
    for (size_t i = 0; i <= sizeof calls / sizeof calls[0]; i++) {
        read_all(&b);
        calls_watch(b.directory.path);
        if (i == 0)
            calls_limit_space(100); /* a piece of it */
        else
            calls_fail(calls[i - 1], 1, 1, EIO);
        CHECK(!recovery_tidy(&b.r) && b.r.result == RECOVERY_ERROR);
        CHECK_MSG(strstr(b.r.why, "aside") != NULL, "%s", b.r.why);
        CHECK(!directory_file(&b.directory, "damaged.", 0, path));
        path_of(&b, DATAFILE_LOG, 1, path);
        CHECK(file_is(path, buf_head(&b.bytes), b.end[10]));
        recovery_clear(&b.r);
    }
    end(&b);
}

/* ---- what is read is on the disk before anything depends on it ---- */

/* The daemon that wrote it may have been killed before it could sync it. In its last segment a
 * failed sync may have marked pages as saved that are not: they are written again. */
TEST(log_that_was_read_is_saved_before_a_new_segment_begins)
{
    struct bench b;
    begin(&b);
    write_unsynced(&b, 3);
    begin_file(&b, SEGMENT_LOG, 4);
    put_point(&b, 4, 3, 3);
    put_point(&b, 5, 4, 4);
    put_point(&b, 6, 4, 5);
    put_point(&b, 7, 4, 6);
    end_file(&b, DATAFILE_LOG, 4);
    read_all(&b);
    CHECK_MSG(b.r.result == RECOVERY_OK && points_of_t(&b) == 7, "%s", b.r.why);
    CHECK(b.r.synced_at == b.end[4]);
    calls_watch(b.directory.path);
    CHECK(recovery_tidy(&b.r));
    CHECK_STR(calls_text(), "write log.4\nsync log.4\nsync log.1\n");
    end(&b);
}

TEST(log_that_cannot_be_saved_again_is_not_built_on)
{
    static const char *const calls[] = {"write log.1", "sync log.1"};
    for (size_t i = 0; i < 2; i++) {
        struct bench b;
        begin(&b);
        write_unsynced(&b, 3);
        read_all(&b);
        calls_watch(b.directory.path);
        calls_fail(calls[i], 1, 1, EIO);
        CHECK(!recovery_tidy(&b.r) && b.r.result == RECOVERY_ERROR);
        end(&b);
    }
}

/* A snapshot beside a log that it covers is copied, which takes long if it is large. */
TEST(copy_of_a_snapshot_is_given_up_when_the_server_stops)
{
    char path[128];
    struct bench b;
    begin(&b);
    begin_file(&b, SEGMENT_LOG, 1);
    put_point(&b, 1, 0, 0);
    end_file(&b, DATAFILE_LOG, 1);
    begin_file(&b, SEGMENT_LOG, 2);
    end_file(&b, DATAFILE_LOG, 2);
    begin_file(&b, SEGMENT_SNAPSHOT, 1);
    put(&b, (struct record){.lsn = 1, .type = RECORD_END});
    end_file(&b, DATAFILE_SNAPSHOT, 1);
    read_all(&b);
    CHECK_MSG(b.r.result == RECOVERY_OK, "%s", b.r.why);
    b.r.cancel = true;
    calls_watch(b.directory.path);
    CHECK(!recovery_tidy(&b.r) && b.r.result == RECOVERY_CANCELLED);
    CHECK(calls_end("create snapshot.1.tmp\nremove snapshot.1.tmp\n"));
    path_of(&b, DATAFILE_SNAPSHOT, 1, path);
    CHECK(access(path, F_OK) == 0);
    end(&b);
}

/* The part considered synced is never more than what was synced, and hardly less. */
TEST(what_was_synced_for_certain_is_followed_from_record_to_record)
{
    struct bench b;
    begin(&b);
    begin_file(&b, SEGMENT_LOG, 1);
    static const uint64_t synced[] = {0, 0, 0, 2, 2, 5, 5, 5, 5};
    for (uint32_t i = 0; i < 9; i++)
        put_point(&b, i + 1, synced[i], i);
    end_file(&b, DATAFILE_LOG, 1);
    read_all(&b);
    CHECK(b.r.synced_at <= b.end[5] && b.r.synced_at >= b.end[2]);
    end(&b);
}

/* ---- which changes count ---- */

static void expect_points(struct bench *b, uint64_t last, uint32_t points)
{
    read_all(b);
    CHECK_MSG(b->r.result == RECOVERY_OK, "%s", b->r.why);
    CHECK(b->r.last == last && points_of_t(b) == points);
}

/* Its DROP has the lsn of the snapshot: carried out a second time it would find no set. */
TEST(change_that_the_snapshot_has_is_not_carried_out_again)
{
    struct bench b;
    begin(&b);
    begin_file(&b, SEGMENT_SNAPSHOT, 2);
    put(&b, (struct record){.lsn = 1, .type = RECORD_END});
    end_file(&b, DATAFILE_SNAPSHOT, 2);
    begin_file(&b, SEGMENT_LOG, 1);
    put(&b, (struct record){.lsn = 1, .type = RECORD_CREATE});
    put(&b, (struct record){.lsn = 2, .type = RECORD_DROP});
    put_point(&b, 3, 0, 0);
    end_file(&b, DATAFILE_LOG, 1);
    expect_points(&b, 3, 1);
    end(&b);
}

/* The set was pinned for the snapshot when the change had been made that has lsn 2. */
TEST(change_that_a_set_of_the_snapshot_has_is_not_carried_out_again)
{
    struct record_row row = {0, 0, 0, 1};
    struct bench b;
    begin(&b);
    begin_file(&b, SEGMENT_SNAPSHOT, 1);
    put(&b, (struct record){.lsn = 1, .synced = 2, .type = RECORD_SET, .first = 1, .n = 1});
    put(&b, (struct record){.lsn = 2, .type = RECORD_ROWS, .n = 1, .items = &row});
    put(&b, (struct record){.lsn = 3, .type = RECORD_END, .n = 1});
    end_file(&b, DATAFILE_SNAPSHOT, 1);
    begin_file(&b, SEGMENT_LOG, 2);
    put_point(&b, 2, 0, 0);
    put_point(&b, 3, 0, 1);
    end_file(&b, DATAFILE_LOG, 2);
    expect_points(&b, 3, 2);
    end(&b);
}

TEST(log_that_lacks_one_change_behind_the_snapshot_is_refused)
{
    struct bench b;
    begin(&b);
    begin_file(&b, SEGMENT_SNAPSHOT, 5);
    put(&b, (struct record){.lsn = 1, .type = RECORD_END});
    end_file(&b, DATAFILE_SNAPSHOT, 5);
    begin_file(&b, SEGMENT_LOG, 7);
    put_point(&b, 7, 0, 0);
    end_file(&b, DATAFILE_LOG, 7);
    read_all(&b);
    CHECK(b.r.result == RECOVERY_REFUSED && strstr(b.r.why, "change 6 is missing") != NULL);
    end(&b);
}

TEST(log_that_begins_right_behind_the_snapshot_is_read)
{
    struct bench b;
    begin(&b);
    begin_file(&b, SEGMENT_SNAPSHOT, 5);
    put(&b, (struct record){.lsn = 1, .type = RECORD_END});
    end_file(&b, DATAFILE_SNAPSHOT, 5);
    begin_file(&b, SEGMENT_LOG, 6);
    put_point(&b, 6, 0, 0);
    end_file(&b, DATAFILE_LOG, 6);
    expect_points(&b, 6, 1);
    end(&b);
}

/* ---- numbers ---- */

TEST(log_that_lacks_one_change_between_two_is_no_whole_log)
{
    struct bench b;
    begin(&b);
    begin_file(&b, SEGMENT_LOG, 1);
    put_point(&b, 1, 0, 0);
    put(&b, (struct record){.lsn = 3, .type = RECORD_TRIANGULATE}); /* makes sense without 2 */
    end_file(&b, DATAFILE_LOG, 1);
    read_all(&b);
    CHECK(b.r.result == RECOVERY_OK && b.r.torn && b.r.aside && b.r.last == 1);
    end(&b);
}

TEST(snapshot_with_a_record_of_another_number_is_refused)
{
    static const uint64_t numbers[][2] = {{1, 2}, {2, 3}, {1, 3}};
    for (int i = 0; i < 3; i++) {
        struct bench b;
        begin(&b);
        begin_file(&b, SEGMENT_SNAPSHOT, 4);
        put(&b, (struct record){.lsn = numbers[i][0], .type = RECORD_SET});
        put(&b, (struct record){.lsn = numbers[i][1], .type = RECORD_END, .n = 1});
        end_file(&b, DATAFILE_SNAPSHOT, 4);
        begin_file(&b, SEGMENT_LOG, 5);
        end_file(&b, DATAFILE_LOG, 5);
        read_all(&b);
        CHECK(b.r.result == (i == 0 ? RECOVERY_OK : RECOVERY_REFUSED));
        end(&b);
    }
}

/* ---- what cannot be cut off ---- */

TEST(log_whose_end_cannot_be_cut_off_is_not_built_on)
{
    static const char *const calls[] = {"cut log.1", "sync log.1"};
    for (int i = 0; i < 2; i++) {
        char path[128];
        struct bench b;
        begin(&b);
        write_unsynced(&b, 3);
        path_of(&b, DATAFILE_LOG, 1, path);
        file_write(path, buf_head(&b.bytes), b.end[3] - 5);
        read_all(&b);
        CHECK(b.r.result == RECOVERY_OK && b.r.torn && !b.r.aside);
        calls_watch(b.directory.path);
        calls_fail(calls[i], 1, 1, EIO);
        CHECK(!recovery_tidy(&b.r) && b.r.result == RECOVERY_ERROR && calls_failed() == 1);
        CHECK_MSG(strstr(b.r.why, "cannot cut the end off") != NULL, "%s", b.r.why);
        end(&b);
    }
}
