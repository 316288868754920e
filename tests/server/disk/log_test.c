/* log_test.c - changes that the log reports as durable are durable, call by call. Without a daemon: calls
 * that change files are recorded and made to fail in this process (file_calls.h). */
#include "server/disk/log.h"

#include "core/delaunay.h"
#include "server/disk/log_file.h"
#include "server/disk/recover.h"
#include "tests/server/directory.h"
#include "tests/server/file_calls.h"
#include "tests/test.h"

#include <errno.h>
#include <poll.h>
#include <string.h>
#include <sys/eventfd.h>
#include <unistd.h>

/* ---- a log of its own for each test ---- */

struct bench {
    struct directory directory;
    struct datadir dir;
    int event;
    struct log *log;
    struct log_status status; /* as of the last look */
};

/* Without a log yet. */
static void begin_empty(struct bench *b)
{
    *b = (struct bench){.directory = directory_quick(), .event = eventfd(0, EFD_CLOEXEC)};
    CHECK(b->event >= 0 && datadir_open(&b->dir, b->directory.path, false));
    calls_watch(b->directory.path);
}

static void begin(struct bench *b, enum log_policy policy)
{
    begin_empty(b);
    b->log = log_new(&b->dir, policy, 1, 1, b->event);
    CHECK(b->log != NULL);
}

static void end(struct bench *b)
{
    if (b->log != NULL)
        log_free(b->log);
    datadir_close(&b->dir);
    close(b->event);
    directory_remove(&b->directory);
}

static uint64_t append(struct bench *b)
{
    struct record r = {.type = RECORD_DROP, .name = "t", .name_len = 1};
    return log_append(b->log, &r);
}

/* Waits until the log thread has published something, and reads it. */
static void look(struct bench *b)
{
    uint64_t count;
    struct pollfd ready = {.fd = b->event, .events = POLLIN};
    CHECK(poll(&ready, 1, 10000) == 1 && read(b->event, &count, sizeof count) == sizeof count);
    log_status(b->log, &b->status);
}

static void await_durable(struct bench *b, uint64_t lsn)
{
    log_push(b->log);
    while (b->status.durable < lsn) {
        look(b);
        CHECK_MSG(b->status.state != LOG_FAILED, "it failed: %s", strerror(b->status.error));
    }
}

static void await_failure(struct bench *b)
{
    log_push(b->log);
    while (b->status.state != LOG_FAILED)
        look(b);
}

/* ---- segments ---- */

TEST(log_syncs_its_records_before_it_begins_a_new_segment)
{
    struct bench b;
    begin(&b, LOG_NO);
    CHECK_STR(calls_text(), "create snapshot.1.tmp\nwrite snapshot.1.tmp\nsync snapshot.1.tmp\n"
                            "rename snapshot.1.tmp log.1\nsync .\ncreate reserve\n");
    calls_watch(b.directory.path);
    append(&b);
    CHECK(log_rotate(b.log, NULL) == 1);
    while (b.status.segment != 2)
        look(&b);
    CHECK_STR(calls_text(), "write log.1\nsync log.1\n"
                            "create snapshot.2.tmp\nwrite snapshot.2.tmp\nsync snapshot.2.tmp\n"
                            "rename snapshot.2.tmp log.2\nsync .\n");
    end(&b);
}

TEST(failed_sync_before_a_new_segment_is_a_failed_log)
{
    struct bench b;
    begin(&b, LOG_ALWAYS);
    calls_fail("sync log.1", 1, 1, EIO);
    append(&b);
    log_rotate(b.log, NULL);
    await_failure(&b);
    CHECK(b.status.error == EIO && b.status.durable == 0 && b.status.segment == 1);
    CHECK(calls_count("create snapshot.2.tmp") == 0);
    end(&b);
}

/* On Linux a file whose creation could not be synced may look as if it were: the next sync of the
 * directory succeeds without it, unless there is something new in it. */
TEST(segment_that_could_not_be_begun_is_created_again)
{
    static const char *const calls[] = {"write snapshot.2.tmp", "sync snapshot.2.tmp",
                                        "rename snapshot.2.tmp log.2", "sync ."};
    for (size_t i = 0; i < sizeof calls / sizeof calls[0]; i++) {
        struct bench b;
        begin(&b, LOG_ALWAYS);
        append(&b);
        await_durable(&b, 1);
        calls_fail(calls[i], 1, 1, EIO);
        CHECK(log_rotate(b.log, NULL) == 1);
        await_failure(&b);
        bool named = calls_count("rename snapshot.2.tmp log.2") == 1;
        CHECK(calls_count("create snapshot.2.tmp") == 1);
        CHECK(calls_count(named ? "remove log.2" : "remove snapshot.2.tmp") == 1);
        log_resume(b.log, 1, 1);
        while (b.status.state == LOG_FAILED)
            look(&b);
        CHECK(calls_count("create snapshot.2.tmp") == 2);
        CHECK(b.status.segment == 2 && b.status.durable == 1);
        end(&b);
    }
}

/* ---- what is durable, and what was synced ---- */

/* The records of a segment, oldest first; how many there are. */
static size_t read_segment(const struct bench *b, uint64_t first, struct record *r, size_t most)
{
    char name[DATAFILE_NAME], path[128];
    size_t n, at = SEGMENT_HEADER, records = 0;
    datafile_name(name, DATAFILE_LOG, first);
    snprintf(path, sizeof path, "%s/%s", b->directory.path, name);
    char *bytes = file_read(path, &n);
    while (at < n) {
        ptrdiff_t took = record_read(bytes + at, n - at, &r[records]);
        CHECK_MSG(took > 0 && records < most, "at byte %zu of %zu", at, n);
        r[records].name = NULL; /* it goes with the bytes */
        at += (size_t)took;
        records++;
    }
    free(bytes);
    return records;
}

TEST(log_calls_nothing_synced_that_is_only_written)
{
    static const enum log_policy policies[] = {LOG_NO, LOG_EVERYSEC};
    for (int i = 0; i < 2; i++) {
        struct record r[3];
        struct bench b;
        begin(&b, policies[i]);
        append(&b);
        await_durable(&b, 1);
        /* A test that is interrupted for a second may see the sync that is due every second. */
        bool synced = calls_count("sync log.1") > 1;
        CHECK(synced || b.status.synced == 0);
        append(&b);
        await_durable(&b, 2);
        CHECK(read_segment(&b, 1, r, 3) == 2 && r[0].synced == 0);
        CHECK(synced || r[1].synced == 0);
        end(&b);
    }
}

TEST(change_is_synced_within_seconds_by_the_policy_everysec)
{
    struct bench b;
    begin(&b, LOG_EVERYSEC);
    append(&b);
    await_durable(&b, 1);
    while (b.status.synced < 1) /* look() waits ten times as long at most */
        look(&b);
    CHECK(calls_end("write log.1\nsync log.1\n"));
    end(&b);
}

TEST(log_syncs_before_it_calls_a_change_durable)
{
    struct record r[3];
    struct bench b;
    begin(&b, LOG_ALWAYS);
    calls_stop("sync log.1");
    append(&b);
    log_push(b.log);
    calls_await_stopped();
    log_status(b.log, &b.status);
    CHECK(b.status.durable == 0 && b.status.synced == 0);
    calls_go_on();
    await_durable(&b, 1);
    CHECK(b.status.synced == 1);
    append(&b);
    await_durable(&b, 2);
    CHECK(read_segment(&b, 1, r, 3) == 2 && r[0].synced == 0 && r[1].synced == 1);
    end(&b);
}

TEST(log_that_is_closed_says_that_everything_before_was_synced)
{
    struct record r[3];
    struct bench b;
    begin(&b, LOG_NO);
    append(&b);
    log_free(b.log);
    b.log = NULL;
    CHECK(read_segment(&b, 1, r, 3) == 2 && r[1].type == RECORD_CLOSE && r[1].synced == 1);
    CHECK(calls_end("write log.1\nsync log.1\n"));
    end(&b);
}

/* ---- failures ---- */

TEST(change_that_does_not_fit_into_memory_is_a_failed_log)
{
    struct bench b;
    begin(&b, LOG_ALWAYS);
    test_fail_alloc(1);
    CHECK(append(&b) == 1 && test_alloc_failed());
    await_failure(&b);
    CHECK(b.status.error == ENOMEM && b.status.durable == 0);
    end(&b);
}

/* Points for log_append_load, which takes ownership. */
static double *points(size_t n)
{
    double *xy = dt_pages_grow(NULL, NULL, 0, n * 2 * sizeof *xy);
    CHECK(xy != NULL);
    memset(xy, 0, n * 2 * sizeof *xy);
    return xy;
}

TEST(large_load_that_cannot_be_encoded_is_a_failed_log)
{
    struct record r = {.type = RECORD_CHUNK, .name = "t", .name_len = 1, .n = RECORD_POINTS + 1};
    struct bench b;
    begin(&b, LOG_ALWAYS);
    log_append_load(b.log, &r, points(r.n), NULL, NULL);
    test_fail_alloc(1); /* on the log's thread, which encodes them */
    await_failure(&b);
    CHECK(test_alloc_failed() && b.status.error == ENOMEM && b.status.durable == 0);
    end(&b);
}

/* The rest of the record does not look like the beginning of a record. */
TEST(large_load_whose_record_is_written_in_part_is_a_failed_log)
{
    struct record r = {.type = RECORD_CHUNK, .name = "t", .name_len = 1, .n = RECORD_POINTS + 1};
    struct bench b;
    double *xy = points(r.n);
    for (size_t i = 0; i < 2 * (size_t)r.n; i++)
        xy[i] = 1.0 / 3;
    begin(&b, LOG_ALWAYS);
    calls_limit_space(300);
    log_append_load(b.log, &r, xy, NULL, NULL);
    await_failure(&b);
    CHECK(b.status.error == ENOSPC && b.status.durable == 0);
    end(&b);
}

/* Fails with one record in the file that may or may not be on the disk. */
static void fail(struct bench *b)
{
    calls_fail("sync log.1", 1, 1, EIO);
    append(b);
    await_failure(b);
}

static void resume(struct bench *b, uint64_t lsn)
{
    uint64_t failures = b->status.failures;
    log_resume(b->log, lsn, 1);
    while (b->status.state == LOG_FAILED && b->status.failures == failures)
        look(b);
}

TEST(log_that_goes_on_has_every_change_that_the_snapshot_has_not)
{
    struct record r[3];
    struct bench b;
    begin(&b, LOG_ALWAYS);
    fail(&b);
    append(&b);
    CHECK(log_rotate(b.log, NULL) == 2);
    append(&b); /* these two came while the snapshot was written */
    log_push(b.log);
    append(&b);
    resume(&b, 2);
    CHECK(b.status.state == LOG_GOOD && b.status.durable == 4 && b.status.segment == 3);
    CHECK(read_segment(&b, 3, r, 3) == 2 && r[0].lsn == 3 && r[1].lsn == 4);
    CHECK(calls_end("write log.3\nsync log.3\n"));
    end(&b);
}

TEST(log_stays_failed_when_a_change_was_lost_that_the_snapshot_has_not)
{
    struct bench b;
    begin(&b, LOG_ALWAYS);
    fail(&b);
    CHECK(log_rotate(b.log, NULL) == 1);
    test_fail_alloc(1);
    CHECK(append(&b) == 2 && test_alloc_failed());
    log_push(b.log);
    resume(&b, 1);
    CHECK(b.status.state == LOG_FAILED && b.status.error == ENOMEM && b.status.durable == 0);
    CHECK(append(&b) == 3 && log_rotate(b.log, NULL) == 3);
    resume(&b, 3); /* the next snapshot has it */
    CHECK(b.status.state == LOG_GOOD && b.status.durable == 3);
    end(&b);
}

TEST(write_that_was_interrupted_is_made_again)
{
    struct bench b;
    begin(&b, LOG_ALWAYS);
    calls_fail("write log.1", 1, 3, EINTR);
    append(&b);
    await_durable(&b, 1);
    CHECK(calls_failed() == 3 && b.status.failures == 0);
    end(&b);
}

/* It is a second file, on which the log does not depend. */
TEST(log_keeps_its_reserve_for_a_full_disk)
{
    static const int errors[] = {EIO, ENOSPC, EDQUOT};
    for (int i = 0; i < 3; i++) {
        struct bench b;
        begin(&b, LOG_ALWAYS);
        calls_fail("write log.1", 1, 1, errors[i]);
        append(&b);
        log_push(b.log);
        while (b.status.durable < 1 && b.status.state != LOG_FAILED)
            look(&b);
        CHECK(b.status.state == (i == 0 ? LOG_FAILED : LOG_FULL));
        CHECK(calls_count("remove reserve") == (i > 0) && b.status.failures == (i == 0));
        end(&b);
    }
}

TEST(half_a_reserve_is_removed)
{
    struct log_file f;
    struct bench b;
    begin_empty(&b);
    log_file_init(&f, &b.dir, 1);
    calls_fail("allocate reserve", 1, 1, ENOSPC);
    log_file_reserve(&f);
    CHECK(!f.reserved && calls_failed() == 1);
    CHECK_STR(calls_text(), "create reserve\nremove reserve\n");
    end(&b);
}

TEST(log_goes_without_a_reserve_where_there_cannot_be_one)
{
    static const int errors[] = {EROFS, ENOSPC};
    for (int i = 0; i < 2; i++) {
        struct bench b;
        begin_empty(&b);
        calls_fail("create reserve", 1, 1, errors[i]);
        b.log = log_new(&b.dir, LOG_ALWAYS, 1, 1, b.event);
        CHECK(b.log != NULL);
        log_status(b.log, &b.status);
        CHECK(b.status.state == (i == 0 ? LOG_GOOD : LOG_FULL));
        end(&b);
    }
}

TEST(segment_whose_header_does_not_fit_into_memory_is_a_failure)
{
    struct log_file f;
    struct bench b;
    begin_empty(&b);
    log_file_init(&f, &b.dir, 1);
    test_fail_alloc(1);
    log_file_start(&f, 1);
    CHECK(test_alloc_failed() && f.error == ENOMEM);
    log_file_clear(&f);
    end(&b);
}

TEST(log_that_cannot_begin_is_none)
{
    static const char *const calls[] = {"create snapshot.1.tmp", "write snapshot.1.tmp",
                                        "sync snapshot.1.tmp", "rename snapshot.1.tmp log.1",
                                        "sync ."};
    struct bench b;
    begin_empty(&b);
    for (size_t i = 0; i < sizeof calls / sizeof calls[0]; i++) {
        calls_fail(calls[i], 1, 1, EIO);
        CHECK(log_new(&b.dir, LOG_ALWAYS, 1, 1, -1) == NULL && calls_failed() == 1);
    }
    for (long n = 1;; n++) {
        test_fail_alloc(n);
        struct log *log = log_new(&b.dir, LOG_ALWAYS, 1, 1, -1);
        bool failed = test_alloc_failed();
        test_fail_alloc(0);
        CHECK(failed || log != NULL);
        if (log != NULL) { /* what has failed is in the C library, which goes without it */
            log_free(log);
            if (!failed)
                break;
        }
    }
    end(&b);
}

/* It could not guarantee that this is its end. */
TEST(log_that_has_failed_is_not_closed_with_a_record)
{
    struct bench b;
    begin(&b, LOG_ALWAYS);
    calls_fail("sync log.1", 1, 1, EIO);
    append(&b);
    await_failure(&b);
    CHECK(b.status.failures == 1);
    unsigned writes = calls_count("write log.1");
    log_free(b.log);
    b.log = NULL;
    CHECK(calls_count("write log.1") == writes && calls_end("write log.1\n"));
    end(&b);
}

TEST(change_that_could_not_be_kept_at_all_is_noticed_at_once)
{
    struct bench b;
    begin(&b, LOG_ALWAYS);
    test_fail_alloc_from(1);
    append(&b);
    test_fail_alloc(0);
    log_push(b.log); /* there is nothing to push but the news */
    await_failure(&b);
    CHECK(b.status.error == ENOMEM);
    end(&b);
}

TEST(log_on_a_full_disk_ends_with_a_whole_record)
{
    char name[DATAFILE_NAME], path[128];
    size_t n;
    struct record r[3];
    struct bench b;
    begin(&b, LOG_ALWAYS);
    append(&b);
    await_durable(&b, 1);
    calls_limit_space(40); /* with the reserve: a record and a piece of the next one */
    append(&b);
    append(&b);
    await_failure(&b);
    CHECK(b.status.error == ENOSPC && b.status.durable == 1);
    CHECK(calls_count("remove reserve") == 1 && calls_count("cut log.1") == 1);
    CHECK(read_segment(&b, 1, r, 3) == 1 && r[0].lsn == 1);
    datafile_name(name, DATAFILE_LOG, 1);
    snprintf(path, sizeof path, "%s/%s", b.directory.path, name);
    free(file_read(path, &n));
    CHECK(n == SEGMENT_HEADER + RECORD_HEADER + 1);
    end(&b);
}

/* Without any segment the directory of a snapshot could not be read any more. */
TEST(segment_that_was_there_stays_when_its_beginning_fails)
{
    char path[128];
    struct bench b;
    begin_empty(&b);
    directory_touch(&b.directory, "log.0000000000000005");
    calls_fail("sync .", 1, 1, EIO);
    CHECK(log_new(&b.dir, LOG_ALWAYS, 5, 1, -1) == NULL);
    CHECK(directory_file(&b.directory, "log.", 0, path));
    end(&b);
}

TEST(bytes_in_the_queue_are_counted_until_they_are_written)
{
    enum { RECORDS = 20000, POINTS = 50000 };
    struct bench b;
    begin(&b, LOG_ALWAYS);
    CHECK(log_queued(b.log) == 0);
    uint64_t last = 0;
    for (int i = 0; i < RECORDS; i++)
        last = append(&b);
    size_t small = log_queued(b.log);
    CHECK(small >= RECORDS * 20 && small < RECORDS * 20 * 8);
    struct record r = {.type = RECORD_CHUNK, .name = "t", .name_len = 1, .n = POINTS};
    last = log_append_load(b.log, &r, points(POINTS), NULL, NULL);
    CHECK(log_queued(b.log) == small + POINTS * 16);
    await_durable(&b, last);
    CHECK(log_queued(b.log) == 0);
    end(&b);
}

/* ---- positions ---- */

/* A record that every log can have. */
static uint64_t append_nothing(struct bench *b)
{
    struct record r = {.type = RECORD_CLOSE};
    return log_append(b->log, &r);
}

/* Recovers from the files of the directory. */
static void read_again(struct bench *b, struct recovery *r)
{
    recovery_init(r, &b->dir);
    recovery_run(r);
    CHECK_MSG(r->result == RECOVERY_OK, "%s", r->why);
}

TEST(digest_of_a_log_is_read_as_it_was_written_and_continues)
{
    struct bench b;
    struct recovery r;
    struct log_status before;
    begin(&b, LOG_ALWAYS);
    struct record add = {.type = RECORD_CHUNK, .name = "t", .name_len = 1, .n = 100000};
    log_append_load(b.log, &add, dt_pages_grow(NULL, NULL, 0, 100000 * 2 * sizeof(double)), NULL,
                    NULL);
    append_nothing(&b);
    log_rotate(b.log, NULL);
    append_nothing(&b);
    log_free(b.log); /* with RECORD_CLOSE */
    b.log = NULL;
    read_again(&b, &r);
    uint64_t last = r.last, digest = r.digest;
    recovery_clear(&r);
    CHECK(last == 9 && digest != 0);
    b.log = log_new(&b.dir, LOG_ALWAYS, last + 1, digest, b.event);
    log_status(b.log, &b.status);
    CHECK(b.status.durable == last && b.status.digest == digest);
    await_durable(&b, append_nothing(&b));
    before = b.status;
    log_rotate(b.log, NULL);
    log_free(b.log);
    b.log = NULL;
    read_again(&b, &r);
    CHECK(before.digest != digest && r.last == before.durable + 1 && r.digest != before.digest);
    recovery_clear(&r);
    end(&b);
}

TEST(lineage_of_a_log_changes_with_a_segment_of_its_own)
{
    struct bench b;
    struct recovery r;
    struct lineage l = {.life = 5, .history = history_begin(77)};
    begin_empty(&b);
    b.dir.lineage = l;
    b.log = log_new(&b.dir, LOG_ALWAYS, 1, 1, b.event);
    struct lineage next = {.life = 6, .history = history_next(&l.history, 4)};
    CHECK(log_rotate(b.log, &next) == 0); /* in the place of the first segment, which is empty */
    append_nothing(&b);
    next.history = history_next(&next.history, 8);
    log_rotate(b.log, &next);
    log_free(b.log);
    b.log = NULL;
    read_again(&b, &r);
    CHECK(r.lineage.life == 6 && r.lineage.history.generation == 3);
    CHECK(r.lineage.history.parent == 4 && r.lineage.history.nonce == 8);
    recovery_clear(&r);
    end(&b);
}
