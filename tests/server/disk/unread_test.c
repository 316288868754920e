/* unread_test.c - unreadable files, and running out of memory while a directory is read, are not
 * mistaken for damage; and files that are not part of a log are ignored. */
#include "tests/server/disk/recover_files.h"
#include "tests/server/file_calls.h"

#include <errno.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* A folder can be opened like a file, and reading it is an error. */
TEST(file_that_cannot_be_read_is_an_error_and_stays)
{
    for (int kind = DATAFILE_SNAPSHOT; kind <= DATAFILE_LOG; kind++) {
        char path[128];
        struct bench b;
        begin(&b);
        path_of(&b, (enum datafile_kind)kind, 1, path);
        CHECK(mkdir(path, 0700) == 0);
        read_all(&b);
        CHECK_MSG(b.r.result == RECOVERY_ERROR && strstr(b.r.why, "cannot read") != NULL, "%s",
                  b.r.why);
        CHECK(rmdir(path) == 0);
        end(&b);
    }
}

TEST(file_that_cannot_be_opened_is_an_error_and_stays)
{
    for (int kind = DATAFILE_SNAPSHOT; kind <= DATAFILE_LOG; kind++) {
        char path[128];
        struct bench b;
        begin(&b);
        path_of(&b, (enum datafile_kind)kind, 1, path);
        CHECK(symlink("nowhere", path) == 0);
        read_all(&b);
        CHECK_MSG(b.r.result == RECOVERY_ERROR && strstr(b.r.why, "cannot read") != NULL, "%s",
                  b.r.why);
        end(&b);
    }
}

TEST(read_that_was_interrupted_is_made_again)
{
    struct bench b;
    begin(&b);
    begin_file(&b, SEGMENT_LOG, 1);
    put_point(&b, 1, 0, 0);
    end_file(&b, DATAFILE_LOG, 1);
    calls_watch(b.directory.path);
    calls_fail("read log.1", 1, 3, EINTR);
    read_all(&b);
    CHECK_MSG(b.r.result == RECOVERY_OK && b.r.last == 1 && calls_failed() == 3, "%s", b.r.why);
    end(&b);
}

/* A snapshot and a log, whose end is damaged in one of three ways: a torn record with whole ones
 * behind it, a load without its end, a damaged header. */
static void write_sample(struct bench *b, int damage)
{
    enum { ROWS = 40 };
    static struct record_row row[ROWS];
    const double xy[] = {7, 7, 8, 8};
    for (uint32_t i = 0; i < ROWS; i++)
        row[i] = (struct record_row){.id = i, .representative = i, .x = i, .y = i * i};
    begin_file(b, SEGMENT_SNAPSHOT, 4);
    put(b, (struct record){.lsn = 1, .type = RECORD_SET, .first = ROWS, .n = ROWS, .synced = 4});
    put(b, (struct record){.lsn = 2, .type = RECORD_ROWS, .n = ROWS, .items = row});
    put(b, (struct record){.lsn = 3, .type = RECORD_END, .n = 1});
    end_file(b, DATAFILE_SNAPSHOT, 4);
    begin_file(b, SEGMENT_LOG, 5);
    put_point(b, 5, 4, ROWS);
    put(b, (struct record){.lsn = 6, .type = RECORD_DELETE, .n = 2, .items = (uint32_t[]){1, 2}});
    put(b, (struct record){.lsn = 7, .type = RECORD_LOAD, .first = ROWS + 1, .n = 2});
    put(b, (struct record){.lsn = 8, .type = RECORD_CHUNK, .n = 2, .items = xy});
    if (damage != 1)
        put(b, (struct record){.lsn = 9, .type = RECORD_LOADED, .n = 2});
    if (damage == 0)
        buf_head(&b->bytes)[b->end[5] + 3] ^= 1;
    end_file(b, DATAFILE_LOG, 5);
    if (damage != 2)
        return;
    begin_file(b, SEGMENT_LOG, 10);
    buf_head(&b->bytes)[3] ^= 1;
    end_file(b, DATAFILE_LOG, 10);
}

static void check_out_of_memory(bool mend)
{
    static const uint64_t last[] = {5, 6, 9};
    for (int damage = 0; damage < 3; damage++) {
        bool failed = true;
        for (long n = 1; failed; n++) {
            struct bench b;
            begin(&b);
            write_sample(&b, damage);
            recovery_init(&b.r, &b.dir);
            b.r.mend = mend;
            test_fail_alloc(n);
            recovery_run(&b.r);
            failed = test_alloc_failed();
            test_fail_alloc(0);
            if (!failed && damage == 2 && !mend)
                CHECK(b.r.result == RECOVERY_REFUSED && b.r.bad_log);
            else if (b.r.result == RECOVERY_OK)
                CHECK_MSG(b.r.last == last[damage] && (b.r.torn || mend),
                          "damage %d, allocation %ld: %s", damage, n, b.r.why);
            else
                CHECK_MSG(failed && b.r.result == RECOVERY_ERROR && !b.r.bad_log &&
                              !b.r.bad_snapshot,
                          "damage %d, allocation %ld: %s", damage, n, b.r.why);
            CHECK(n < 200);
            end(&b);
        }
    }
}

TEST(memory_that_runs_out_while_a_directory_is_read_is_no_damage)
{
    check_out_of_memory(false);
    check_out_of_memory(true);
}

/* So large that more than one block is read. */
static void write_large_sample(struct bench *b, bool damaged)
{
    enum { ROWS = 3000, BLOCKS = 4, BLOCK = 256 << 10 };
    static struct record_row row[ROWS];
    static const double xy[2 * ROWS] = {1, 1};
    begin_file(b, SEGMENT_SNAPSHOT, 4);
    put(b,
        (struct record){
            .lsn = 1, .type = RECORD_SET, .first = ROWS * BLOCKS, .n = ROWS * BLOCKS, .synced = 4});
    for (uint32_t block = 0; block < BLOCKS; block++) {
        for (uint32_t i = 0, id = block * ROWS; i < ROWS; i++, id++)
            row[i] = (struct record_row){.id = id, .representative = id, .x = id};
        put(b, (struct record){.lsn = block + 2, .type = RECORD_ROWS, .n = ROWS, .items = row});
    }
    put(b, (struct record){.lsn = BLOCKS + 2, .type = RECORD_END, .n = 1});
    CHECK(buf_len(&b->bytes) > BLOCK);
    end_file(b, DATAFILE_SNAPSHOT, 4);
    begin_file(b, SEGMENT_LOG, 5);
    for (uint32_t i = 0; i < 10; i++)
        put(b, (struct record){.lsn = 5 + i,
                               .type = RECORD_ADD,
                               .first = ROWS * (BLOCKS + i),
                               .n = ROWS,
                               .items = xy});
    if (damaged)
        buf_head(&b->bytes)[SEGMENT_HEADER + 3] ^= 1;
    CHECK(buf_len(&b->bytes) > BLOCK);
    end_file(b, DATAFILE_LOG, 5);
}

TEST(memory_that_runs_out_while_a_large_directory_is_read_is_no_damage)
{
    for (int damaged = 0; damaged < 2; damaged++) {
        bool failed = true;
        for (long n = 1; failed; n++) {
            struct bench b;
            begin(&b);
            write_large_sample(&b, damaged);
            test_fail_alloc(n);
            read_all(&b);
            failed = test_alloc_failed();
            test_fail_alloc(0);
            if (b.r.result == RECOVERY_OK)
                CHECK_MSG(b.r.last == (damaged ? 4 : 14) && b.r.later == (damaged ? 9 : 0),
                          "allocation %ld: %s", n, b.r.why);
            else
                CHECK_MSG(failed && b.r.result == RECOVERY_ERROR, "allocation %ld: %s", n, b.r.why);
            CHECK(n < 300);
            end(&b);
        }
    }
}

TEST(snapshot_under_the_name_of_a_log_is_no_log)
{
    struct bench b;
    begin(&b);
    begin_file(&b, SEGMENT_SNAPSHOT, 1);
    put_point(&b, 1, 0, 0);
    end_file(&b, DATAFILE_LOG, 1);
    read_all(&b);
    CHECK(b.r.result == RECOVERY_REFUSED && points_of_t(&b) == 0);
    end(&b);
}

/* Such as the bytes that a disk had in this place before. */
TEST(records_of_another_time_behind_damage_do_not_count)
{
    static const uint64_t numbers[] = {1, 2 + (1 << 30)};
    for (int i = 0; i < 2; i++) {
        struct bench b;
        begin(&b);
        begin_file(&b, SEGMENT_LOG, 1);
        put_point(&b, 1, 0, 0);
        put_point(&b, 2, 0, 1);
        buf_head(&b.bytes)[b.end[1] + 3] ^= 1;
        record_write(&b.bytes, &(struct record){.lsn = numbers[i], .type = RECORD_CLOSE});
        end_file(&b, DATAFILE_LOG, 1);
        read_all(&b);
        CHECK(b.r.result == RECOVERY_OK && b.r.torn && b.r.last == 1 && b.r.later == 0);
        end(&b);
    }
}

TEST(reading_ends_when_it_is_given_up)
{
    for (int damage = 0; damage < 3; damage++) {
        struct bench b;
        begin(&b);
        write_sample(&b, damage);
        recovery_init(&b.r, &b.dir);
        b.r.cancel = true;
        recovery_run(&b.r);
        CHECK(b.r.result == RECOVERY_CANCELLED);
        end(&b);
    }
}
