/* log_test.c - what the log says is durable is durable, call by call. No daemon: the calls that change
 * files are watched and made to fail in this process (file_calls.h). */
#include "server/log.h"

#include "server/log_file.h"
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

static void begin(struct bench *b, enum log_policy policy)
{
    *b = (struct bench){.directory = directory_quick(), .event = eventfd(0, EFD_CLOEXEC)};
    CHECK(b->event >= 0 && datadir_open(&b->dir, b->directory.path, false));
    calls_watch(b->directory.path);
    b->log = log_new(&b->dir, policy, 1, b->event);
    CHECK(b->log != NULL);
}

static void end(struct bench *b)
{
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

/* Waits until the log thread has published something, and looks at it. */
static void look(struct bench *b)
{
    uint64_t count;
    struct pollfd ready = {.fd = b->event, .events = POLLIN};
    CHECK(poll(&ready, 1, 10000) == 1 && read(b->event, &count, sizeof count) == sizeof count);
    log_status(b->log, &b->status);
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
    CHECK_STR(calls_text(), "create log.1\nwrite log.1\nsync log.1\nsync .\ncreate reserve\n");
    calls_watch(b.directory.path);
    append(&b);
    CHECK(log_rotate(b.log) == 1);
    while (b.status.segment != 2)
        look(&b);
    CHECK_STR(calls_text(), "write log.1\nsync log.1\n"
                            "create log.2\nwrite log.2\nsync log.2\nsync .\n");
    end(&b);
}

TEST(failed_sync_before_a_new_segment_is_a_failed_log)
{
    struct bench b;
    begin(&b, LOG_ALWAYS);
    calls_fail("sync log.1", 1, 1, EIO);
    append(&b);
    log_rotate(b.log);
    await_failure(&b);
    CHECK(b.status.error == EIO && b.status.durable == 0 && b.status.segment == 1);
    CHECK(calls_count("create log.2") == 0);
    end(&b);
}
