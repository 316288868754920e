/* salvage_calls_test.c - --repair of a damaged snapshot call by call: the order in which it changes
 * files, and the state after a failed call or allocation. The files are composed here. */
#include "server/repair/salvage.h"

#include "tests/server/disk/recover_files.h"
#include "tests/server/file_calls.h"

#include <errno.h>

/* A snapshot of the sets a and b, and a log of one change with the number `log`. */
struct sample {
    uint64_t snapshot, log;
    bool lost; /* b has lost its row; else the record that begins it is damaged */
};

static void write_sample(struct bench *b, const struct sample *s)
{
    const struct record first = {.lsn = 1, .type = RECORD_SET, .name = "a", .name_len = 1},
                        last = {.lsn = s->lost ? 4 : 3, .type = RECORD_END, .n = 2},
                        change = {.lsn = s->log, .type = RECORD_CREATE, .name = "c", .name_len = 1};
    struct record second = {.lsn = 2, .type = RECORD_SET, .name = "b", .name_len = 1};
    second.first = second.n = s->lost;
    begin_file(b, SEGMENT_SNAPSHOT, s->snapshot);
    record_write(&b->bytes, &first);
    size_t at = buf_len(&b->bytes);
    record_write(&b->bytes, &second);
    if (!s->lost)
        buf_head(&b->bytes)[at + 8] ^= 1;
    record_write(&b->bytes, &last);
    end_file(b, DATAFILE_SNAPSHOT, s->snapshot);
    begin_file(b, SEGMENT_LOG, s->log);
    record_write(&b->bytes, &change);
    end_file(b, DATAFILE_LOG, s->log);
}

/* Its calls are watched from then on. */
static void begin_with(struct bench *b, struct sample s)
{
    begin(b);
    write_sample(b, &s);
    calls_watch(b->directory.path);
}

static bool has_set(const struct bench *b, const char *name)
{
    return registry_find(&b->r.replay.sets, &(struct word){name, 1}) != NULL;
}

/* No file loses its first name before its second name and its replacement are on the disk; and a
 * removed name does not come back. */
TEST(repair_of_a_snapshot_is_on_the_disk_before_what_it_replaces_is_removed)
{
    struct bench b;
    begin_with(&b, (struct sample){.snapshot = 5, .log = 6});
    CHECK(salvage(&b.dir));
    CHECK_STR(calls_text(), "link snapshot.5 damaged.snapshot.5\nlink log.6 damaged.log.6\nsync .\n"
                            "create snapshot.6.tmp\nwrite snapshot.6.tmp\nsync snapshot.6.tmp\n"
                            "rename snapshot.6.tmp snapshot.6\nsync .\nremove snapshot.5\n"
                            "create snapshot.7.tmp\nwrite snapshot.7.tmp\nsync snapshot.7.tmp\n"
                            "rename snapshot.7.tmp log.7\nsync .\nremove log.6\nsync .\n");
    end(&b);
}

TEST(snapshot_that_is_not_needed_has_its_second_name_on_the_disk_before_it_loses_the_first)
{
    struct bench b;
    begin_with(&b, (struct sample){.snapshot = 1, .log = 1});
    CHECK(salvage(&b.dir));
    CHECK_STR(calls_text(), "link snapshot.1 damaged.snapshot.1\nsync .\n"
                            "remove snapshot.1\nsync .\n");
    end(&b);
}

/* The n-th call of the sequence above that is equal to `line` fails. `remove snapshot.5` is missing: the snapshot that
 * replaces it removes it, and a failure of that removal is harmless, because the new snapshot is newer. */
TEST(repair_of_a_snapshot_that_fails_anywhere_says_so)
{
    static const struct {
        const char *line;
        unsigned n;
    } calls[] = {
        {"link snapshot.5 damaged.snapshot.5", 1},
        {"link log.6 damaged.log.6", 1},
        {"sync .", 1},
        {"create snapshot.6.tmp", 1},
        {"write snapshot.6.tmp", 1},
        {"sync snapshot.6.tmp", 1},
        {"rename snapshot.6.tmp snapshot.6", 1},
        {"sync .", 2},
        {"create snapshot.7.tmp", 1},
        {"write snapshot.7.tmp", 1},
        {"sync snapshot.7.tmp", 1},
        {"rename snapshot.7.tmp log.7", 1},
        {"sync .", 3},
        {"remove log.6", 1},
        {"sync .", 4},
    };
    for (size_t i = 0; i < sizeof calls / sizeof calls[0]; i++) {
        struct bench b;
        begin_with(&b, (struct sample){.snapshot = 5, .log = 6});
        calls_fail(calls[i].line, calls[i].n, 1, EIO);
        CHECK_MSG(!salvage(&b.dir) && calls_failed() == 1, "%s %u", calls[i].line, calls[i].n);
        end(&b);
    }
}

TEST(repair_of_a_snapshot_without_memory_keeps_everything)
{
    bool failed = true;
    for (long n = 1; failed; n++) {
        struct bench b;
        begin_with(&b, (struct sample){.snapshot = 5, .log = 6});
        CHECK(n < 300);
        test_fail_alloc(n);
        bool good = salvage(&b.dir);
        failed = test_alloc_failed();
        test_fail_alloc(0);
        bool replaced = calls_count("rename snapshot.6.tmp snapshot.6") > 0;
        CHECK_MSG(good || failed, "allocation %ld", n);
        CHECK_MSG(replaced || calls_count("remove snapshot.5") == 0, "allocation %ld", n);
        if (good && replaced) {
            read_all(&b);
            CHECK_MSG(b.r.result == RECOVERY_OK && b.r.replay.sets.sets == 2 && has_set(&b, "a"),
                      "allocation %ld: %zu sets", n, b.r.replay.sets.sets);
        }
        end(&b);
    }
}

TEST(repair_without_memory_for_a_loss_replaces_nothing)
{
    bool failed = true;
    char text[4000];
    for (long n = 1; failed; n++) {
        struct bench b;
        begin_with(&b, (struct sample){.snapshot = 5, .log = 6, .lost = true});
        datadir_close(&b.dir); /* the repair locks it */
        CHECK(n < 300);
        test_fail_alloc(n);
        directory_repair(&b.directory, text, sizeof text);
        failed = test_alloc_failed();
        test_fail_alloc(0);
        bool replaced = strstr(text, "the old files are in damaged.*") != NULL;
        CHECK_MSG((failed || replaced) && strstr(text, "Success") == NULL, "%s", text);
        CHECK_MSG(!replaced || strstr(text, "lost: the set b") != NULL, "allocation %ld: %s", n,
                  text);
        CHECK(datadir_open(&b.dir, b.directory.path, false));
        end(&b);
    }
}

TEST(snapshot_is_needed_where_a_change_before_it_is_missing)
{
    struct bench b;
    begin_with(&b, (struct sample){.snapshot = 5, .log = 1});
    CHECK(salvage(&b.dir));
    read_all(&b);
    CHECK(b.r.result == RECOVERY_OK && b.r.last == 5 && has_set(&b, "a"));
    end(&b);
}
