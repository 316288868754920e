/* saver_test.c - when snapshots are written, with a simulated clock: a disk that stays broken is
 * tried less and less often; once it works again, a snapshot saves what was lost. */
#include "server/disk/saver.h"

#include "tests/server/directory.h"
#include "tests/server/file_calls.h"
#include "tests/server/local.h"
#include "tests/test.h"

#include <errno.h>
#include <poll.h>
#include <string.h>
#include <sys/eventfd.h>
#include <unistd.h>

enum { TICK_MS = 500 };

/* A set, a log, a saver, and no daemon. */
struct bench {
    struct local l;
    struct directory directory;
    struct datadir dir;
    struct holders held;
    struct log *log;
    size_t compact_at;
    struct saver saver;
    int64_t now_ms;
};

static void begin(struct bench *b)
{
    *b = (struct bench){.directory = directory_quick(), .compact_at = 1 << 20, .now_ms = 12345};
    local_start(&b->l, 0);
    local_ask(&b->l, "ADD t 1 1\n");
    CHECK(datadir_open(&b->dir, b->directory.path, false));
    calls_watch(b->directory.path);
    int event = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
    b->log = log_new(&b->dir, LOG_ALWAYS, 1, 1, event);
    CHECK(b->log != NULL);
    b->saver = (struct saver){.dir = &b->dir,
                              .sets = &b->l.server.sets,
                              .held = &b->held,
                              .log = b->log,
                              .compact_at = &b->compact_at,
                              .event = event};
    log_status(b->log, &b->saver.status);
}

static void end(struct bench *b)
{
    saver_clear(&b->saver);
    log_free(b->log);
    close(b->saver.event);
    datadir_close(&b->dir);
    local_stop(&b->l);
    directory_remove(&b->directory);
}

static void step(struct bench *b)
{
    saver_step(&b->saver, b->now_ms, false);
}

/* Waits for an event from the log or the snapshot, and takes the next step. */
static void step_on_event(struct bench *b)
{
    uint64_t count;
    struct pollfd ready = {.fd = b->saver.event, .events = POLLIN};
    CHECK(poll(&ready, 1, 10000) == 1);
    CHECK(read(b->saver.event, &count, sizeof count) == sizeof count);
    step(b);
}

/* Appends a change and waits until the log has processed it. */
static uint64_t change(struct bench *b)
{
    struct record r = {.type = RECORD_CLOSE};
    uint64_t lsn = log_append(b->log, &r);
    log_push(b->log);
    while (b->saver.status.durable < lsn && b->saver.status.state != LOG_FAILED)
        step_on_event(b);
    return lsn;
}

static void settle(struct bench *b)
{
    while (b->saver.state != SAVER_IDLE)
        step_on_event(b);
}

/* Advances the clock, with a step every half second and one for every event. */
static void pass(struct bench *b, int64_t ms)
{
    for (int64_t end_ms = b->now_ms + ms; b->now_ms < end_ms; b->now_ms += TICK_MS) {
        step(b);
        settle(b);
    }
}

/* ---- how often ---- */

TEST(backoff_doubles_up_to_its_limit_and_begins_again_after_a_success)
{
    static const int64_t waits[] = {500, 1000, 2000, 4000, 8000, 16000, 32000, 60000, 60000, 60000};
    struct backoff b = {0};
    int64_t now = 1000;
    CHECK(backoff_allows(&b, now));
    for (size_t i = 0; i < sizeof waits / sizeof waits[0]; i++) {
        backoff_failed(&b, now);
        CHECK(!backoff_allows(&b, now + waits[i] - 1) && backoff_allows(&b, now + waits[i]));
        now += waits[i];
    }
    for (int i = 0; i < 1000; i++)
        backoff_failed(&b, now);
    CHECK(backoff_allows(&b, now + BACKOFF_LIMIT_MS));
    backoff_succeeded(&b);
    CHECK(backoff_allows(&b, 0));
    backoff_failed(&b, now);
    CHECK(backoff_allows(&b, now + BACKOFF_FIRST_MS));
}

/* Loses a change. */
static void fail_log(struct bench *b)
{
    struct record r = {.type = RECORD_CLOSE};
    log_push(b->log);
    test_fail_alloc(1);
    log_append(b->log, &r);
    CHECK(test_alloc_failed());
    log_push(b->log);
    while (b->saver.status.state != LOG_FAILED)
        step_on_event(b);
}

TEST(disk_that_stays_broken_is_tried_ever_more_rarely)
{
    struct bench b;
    begin(&b);
    calls_fail("create snapshot.1.tmp", 1, 1000000, EIO);
    fail_log(&b);
    pass(&b, 60000);
    CHECK_MSG(calls_failed() == 7, "%u",
              calls_failed()); /* at 0, 0.5, 1.5, 3.5, 7.5, 15.5, 31.5 s */
    CHECK(saver_failures(&b.saver) == 7);
    CHECK(saver_retry_ms(&b.saver, b.now_ms) > 0);
    CHECK(saver_retry_ms(&b.saver, b.now_ms) <= BACKOFF_LIMIT_MS);
    pass(&b, 600000);
    CHECK_MSG(calls_failed() >= 16 && calls_failed() <= 18, "%u", calls_failed());
    /* When the disk works again, at the next attempt. */
    calls_fail("", 1, 1, EIO);
    pass(&b, BACKOFF_LIMIT_MS + TICK_MS);
    CHECK(b.saver.status.state == LOG_GOOD && b.saver.status.durable == 1);
    CHECK(b.saver.snapshot_lsn == 1 && saver_retry_ms(&b.saver, b.now_ms) == 0);
    /* The next failure is the first one again. */
    change(&b);
    calls_fail("create snapshot.3.tmp", 1, 1, EIO);
    fail_log(&b);
    settle(&b);
    CHECK(b.saver.status.state == LOG_FAILED && saver_failures(&b.saver) == 1);
    pass(&b, 1000);
    CHECK(b.saver.status.state == LOG_GOOD && b.saver.snapshot_lsn == 3);
    end(&b);
}

TEST(snapshot_that_fails_while_the_log_is_good_is_tried_ever_more_rarely)
{
    struct bench b;
    begin(&b);
    b.compact_at = 1;
    calls_fail("create snapshot.1.tmp", 1, 1000000, ENOSPC);
    change(&b);
    settle(&b);
    pass(&b, 60000);
    CHECK_MSG(calls_failed() == 7 && b.saver.status.state == LOG_GOOD, "%u", calls_failed());
    CHECK(saver_failures(&b.saver) == 7);
    /* The log's own failure does not wait for that. */
    calls_fail("sync log.2", 1, 1, EIO);
    change(&b);
    settle(&b);
    CHECK(b.saver.status.state == LOG_GOOD && b.saver.snapshot_lsn == 2);
    end(&b);
}

TEST(first_failure_after_a_snapshot_is_tried_again_soon)
{
    struct bench b;
    begin(&b);
    calls_fail("create snapshot.1.tmp", 1, 5, EIO);
    change(&b);
    for (int i = 0; i < 6; i++) {
        CHECK(saver_failures(&b.saver) == (unsigned)i && saver_begin(&b.saver, b.now_ms));
        settle(&b);
    }
    CHECK(saver_failures(&b.saver) == 0 && b.saver.snapshots == 1);
    end(&b);
}

/* ---- a failed log ---- */

TEST(snapshot_makes_up_for_a_failed_log_at_once)
{
    struct bench b;
    begin(&b);
    calls_fail("sync log.1", 1, 1, EIO);
    CHECK(change(&b) == 1);
    CHECK(b.saver.state == SAVER_MENDING && b.saver.status.durable == 0);
    settle(&b);
    CHECK(b.saver.status.state == LOG_GOOD && b.saver.status.durable == 1);
    CHECK(b.saver.snapshot_lsn == 1 && b.saver.status.segment == 2);
    CHECK(change(&b) == 2 && b.saver.status.durable == 2);
    end(&b);
}

TEST(log_that_fails_while_a_snapshot_waits_for_its_segment_gets_one_of_its_own)
{
    struct bench b;
    begin(&b);
    b.compact_at = 1;
    calls_fail("create snapshot.2.tmp", 1, 1, EIO);
    change(&b);
    CHECK(b.saver.state == SAVER_ROTATING || b.saver.state == SAVER_MENDING);
    settle(&b);
    CHECK(b.saver.status.state == LOG_GOOD && b.saver.snapshot_lsn == 1 && b.saver.snapshots == 1);
    end(&b);
}

TEST(snapshot_is_not_written_before_the_log_has_its_new_segment)
{
    struct bench b;
    begin(&b);
    calls_stop("create snapshot.2.tmp");
    change(&b);
    CHECK(saver_begin(&b.saver, b.now_ms));
    calls_await_stopped();
    for (int i = 0; i < 3; i++)
        step(&b);
    CHECK(b.saver.state == SAVER_ROTATING && calls_count("rename snapshot.1.tmp snapshot.1") == 0);
    calls_go_on();
    settle(&b);
    CHECK(b.saver.snapshots == 1);
    end(&b);
}

TEST(snapshot_without_memory_is_given_up_and_tried_again)
{
    struct bench b;
    begin(&b);
    change(&b);
    struct record r = {.type = RECORD_CLOSE};
    log_append(b.log, &r);
    calls_stop("write log.1"); /* so that the log's thread takes no memory meanwhile */
    log_push(b.log);
    calls_await_stopped();
    test_fail_alloc(2); /* the first one is for the log's new segment */
    CHECK(!saver_begin(&b.saver, b.now_ms) && test_alloc_failed());
    test_fail_alloc(0);
    calls_go_on();
    CHECK(b.saver.state == SAVER_IDLE && saver_failures(&b.saver) == 1);
    CHECK(saver_begin(&b.saver, b.now_ms));
    settle(&b);
    CHECK(b.saver.snapshots == 1 && saver_failures(&b.saver) == 0);
    end(&b);
}

TEST(no_snapshot_begins_while_the_server_stops)
{
    struct bench b;
    begin(&b);
    change(&b);
    b.compact_at = 1;
    saver_step(&b.saver, b.now_ms, true);
    CHECK(b.saver.state == SAVER_IDLE);
    step(&b);
    CHECK(b.saver.state == SAVER_ROTATING);
    end(&b);
}

TEST(log_that_cannot_begin_its_new_segment_is_tried_again)
{
    struct bench b;
    begin(&b);
    calls_fail("create snapshot.2.tmp", 1, 2, EIO);
    fail_log(&b);
    settle(&b);
    CHECK(b.saver.status.state == LOG_FAILED && saver_failures(&b.saver) == 1);
    CHECK(b.saver.snapshots == 1);
    pass(&b, 3000);
    CHECK(b.saver.status.state == LOG_GOOD && b.saver.snapshots == 3);
    end(&b);
}

/* It would take a snapshot for every change. */
TEST(log_that_goes_on_only_to_fail_again_is_tried_ever_more_rarely)
{
    unsigned snapshots = 0;
    struct bench b;
    begin(&b);
    for (int64_t end_ms = b.now_ms + 60000; b.now_ms < end_ms; b.now_ms += TICK_MS) {
        if (b.saver.status.state == LOG_GOOD) {
            char line[32];
            snprintf(line, sizeof line, "sync log.%llu",
                     (unsigned long long)b.saver.status.segment);
            calls_fail(line, 1, 1, EIO);
            change(&b);
        }
        step(&b);
        settle(&b);
    }
    snapshots = (unsigned)b.saver.snapshots;
    CHECK_MSG(snapshots >= 5 && snapshots <= 8, "%u", snapshots);
    end(&b);
}

static unsigned saved, not_saved;

static void on_saved(struct hold *h)
{
    (void)h;
    saved++;
}

static void on_not_saved(struct hold *h)
{
    hold_clear(h);
    not_saved++;
}

/* Requests that free space are accepted, and are attempted before any failure is reported. */
TEST(change_that_frees_space_on_a_full_disk_does_not_get_the_error_of_an_earlier_one)
{
    struct hold before = {0}, after = {0};
    struct record r = {.type = RECORD_CLOSE};
    struct bench b;
    begin(&b);
    b.held.released = on_saved;
    b.held.not_saved = on_not_saved;
    calls_limit_space(0);
    hold_acknowledgement(&b.held, &before, 1, 0);
    change(&b);
    settle(&b);
    CHECK(b.saver.status.state == LOG_FAILED && not_saved == 1);
    CHECK(log_append(b.log, &r) == 2);
    hold_acknowledgement(&b.held, &after, 2, 0);
    step(&b);
    CHECK(b.saver.state == SAVER_IDLE && not_saved == 1);
    calls_limit_space(1 << 20);
    pass(&b, 1000);
    CHECK(not_saved == 1 && saved == 1);
    end(&b);
}

/* In the reserve there is room for as many changes as it takes to free space. */
TEST(full_disk_gets_a_snapshot_when_something_may_have_been_deleted)
{
    struct bench b;
    begin(&b);
    calls_limit_space(1000);
    struct record large = {.type = RECORD_CLOSE};
    char name[RECORD_NAME_LIMIT];
    memset(name, 'x', sizeof name);
    large.name = name;
    large.name_len = sizeof name;
    while (b.saver.status.state == LOG_GOOD) {
        uint64_t lsn = log_append(b.log, &large);
        log_push(b.log);
        while (b.saver.status.durable < lsn)
            step_on_event(&b);
    }
    CHECK(b.saver.status.state == LOG_FULL && b.saver.state != SAVER_IDLE);
    calls_limit_space(1 << 20);
    settle(&b);
    CHECK(b.saver.snapshots == 1);
    pass(&b, 10000);
    CHECK(b.saver.snapshots == 1); /* nothing has changed since */
    change(&b);
    settle(&b);
    CHECK(b.saver.snapshots == 2);
    change(&b);
    settle(&b);
    CHECK(b.saver.snapshots == 2); /* not so soon */
    pass(&b, 1000);
    CHECK(b.saver.snapshots == 3);
    end(&b);
}

TEST(full_disk_is_tried_again_as_soon_as_something_may_have_been_deleted)
{
    struct bench b;
    begin(&b);
    calls_limit_space(0);
    change(&b);
    settle(&b);
    CHECK(b.saver.status.state == LOG_FAILED && saver_disk_is_full(&b.saver));
    pass(&b, 100000);
    CHECK(saver_retry_ms(&b.saver, b.now_ms) > 10000);
    calls_limit_space(1 << 20);
    struct record r = {.type = RECORD_CLOSE};
    CHECK(log_append(b.log, &r) == 2);
    log_push(b.log);
    pass(&b, 1000);
    CHECK(b.saver.status.state == LOG_GOOD && b.saver.status.durable == 2);
    end(&b);
}

/* ---- a log that has become long ---- */

TEST(snapshot_is_due_when_the_log_is_long_and_longer_than_the_last_snapshot)
{
    struct bench b;
    begin(&b);
    uint64_t start = saver_log_bytes(&b.saver);
    CHECK(start == SEGMENT_HEADER);
    change(&b);
    CHECK(b.saver.state == SAVER_IDLE && saver_log_bytes(&b.saver) > start);
    b.compact_at = 1;
    b.saver.read_bytes = 1000;    /* from before the start */
    for (int i = 0; i < 9; i++) { /* not written yet when it begins */
        struct record r = {.type = RECORD_CLOSE};
        log_append(b.log, &r);
    }
    step(&b);
    CHECK(b.saver.state == SAVER_ROTATING);
    settle(&b);
    CHECK(b.saver.snapshots == 1 && b.saver.status.segment == 11);
    CHECK(saver_log_bytes(&b.saver) == SEGMENT_HEADER);
    unsigned changes = 0; /* a snapshot costs no more than the log did */
    for (; b.saver.snapshots == 1; changes++) {
        CHECK(saver_log_bytes(&b.saver) <= b.saver.snapshot_bytes + 2 * RECORD_HEADER);
        change(&b);
        settle(&b);
    }
    CHECK(changes > 2);
    end(&b);
}

TEST(attempts_that_fail_do_not_make_the_log_look_longer)
{
    struct bench b;
    begin(&b);
    calls_fail("create snapshot.1.tmp", 1, 3, EIO);
    change(&b);
    uint64_t bytes = saver_log_bytes(&b.saver);
    for (int i = 0; i < 3; i++) {
        CHECK(saver_begin(&b.saver, b.now_ms));
        settle(&b);
    }
    CHECK(calls_failed() == 3 && saver_log_bytes(&b.saver) == bytes + SEGMENT_HEADER);
    end(&b);
}
