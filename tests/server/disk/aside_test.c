/* aside_test.c - a snapshot from a leader replaces a data directory: after a crash at any moment the directory has the
 * old state or the new one. */
#include "server/disk/aside.h"

#include "server/disk/recover.h"
#include "tests/faults/tree.h"
#include "tests/server/digest.h"
#include "tests/server/directory.h"
#include "tests/server/file_calls.h"
#include "tests/test.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { OLD_LSN = 3, NEW_LSN = 0x25, BEFORE = 0x77 };

static struct segment header(void)
{
    return (struct segment){.version = RECORD_VERSION,
                            .kind = SEGMENT_SNAPSHOT,
                            .lsn = NEW_LSN,
                            .life = 4,
                            .history = {.origin = 5, .generation = 1, .nonce = 6},
                            .digest = BEFORE};
}

/* The records of a snapshot with one set of one point. */
static void put_records(struct buf *out)
{
    struct record_row row = {.id = 0, .representative = 0, .x = 1, .y = 2};
    struct record r[] = {{.lsn = 1, .type = RECORD_SET, .synced = NEW_LSN, .first = 1, .n = 1},
                         {.lsn = 2, .type = RECORD_ROWS, .n = 1, .items = &row},
                         {.lsn = 3, .type = RECORD_END, .n = 1}};
    for (int i = 0; i < 2; i++) {
        r[i].name = "new";
        r[i].name_len = 3;
    }
    for (int i = 0; i < 3; i++)
        record_write(out, &r[i]);
    CHECK(!out->failed);
}

/* ---- a directory with the old state ---- */

struct bench {
    struct directory directory;
    struct datadir dir;
    bool put_in_place; /* what aside_put_in_place has returned */
};

static struct bench begin(void)
{
    struct bench b = {.directory = directory_quick()};
    struct buf out = {0};
    char path[128];
    struct segment h = {.version = RECORD_VERSION, .kind = SEGMENT_LOG, .lsn = 1, .digest = 9};
    char *to = buf_reserve(&out, SEGMENT_HEADER);
    segment_write(to, &h);
    buf_commit(&out, SEGMENT_HEADER);
    for (unsigned i = 1; i <= OLD_LSN; i++) {
        char name[] = {'o', (char)('0' + i)};
        struct record r = {.lsn = i, .type = RECORD_CREATE, .name = name, .name_len = sizeof name};
        record_write(&out, &r);
    }
    snprintf(path, sizeof path, "%s/log.%016x", b.directory.path, 1);
    file_write(path, buf_head(&out), buf_len(&out));
    buf_free(&out);
    directory_touch(&b.directory, "role");
    CHECK(datadir_open(&b.dir, b.directory.path, false));
    return b;
}

static void end(struct bench *b)
{
    datadir_close(&b->dir);
    tree_remove(b->directory.path);
}

static bool receive(struct bench *b, struct aside *a)
{
    struct segment h = header();
    struct buf out = {0};
    put_records(&out);
    bool ok = aside_begin(a, &b->dir, &h) && aside_write(a, buf_head(&out), 10) &&
              aside_write(a, buf_head(&out) + 10, buf_len(&out) - 10);
    buf_free(&out);
    return ok;
}

/* Receives the new state and puts it in place, as far as that goes. */
static void replace(struct bench *b)
{
    struct aside a = {.dir = NULL};
    struct segment h = header();
    struct datadir arrived;
    b->put_in_place = false;
    if (!receive(b, &a)) {
        aside_abandon(&a);
    } else if (aside_complete(&a, &h, &arrived)) {
        b->put_in_place = aside_put_in_place(&b->dir);
        aside_close(&arrived);
    }
}

/* ---- what a start finds ---- */

/* The lsn of the last change; the sets are those of that state. */
static uint64_t state_of(struct bench *b)
{
    struct recovery r;
    struct stat s;
    recovery_init(&r, &b->dir);
    recovery_run(&r);
    CHECK_MSG(r.result == RECOVERY_OK && !r.torn, "%s", r.why);
    uint64_t last = r.last;
    CHECK(last == OLD_LSN || last == NEW_LSN);
    CHECK(r.replay.sets.sets == (last == OLD_LSN ? OLD_LSN : 1));
    CHECK(last == OLD_LSN || r.digest == BEFORE);
    recovery_clear(&r);
    CHECK(fstatat(b->dir.fd, "incoming", &s, 0) != 0 && fstatat(b->dir.fd, "arrived", &s, 0) != 0);
    CHECK(fstatat(b->dir.fd, "role", &s, 0) == 0);
    return last;
}

TEST(received_snapshot_replaces_everything)
{
    struct bench b = begin();
    replace(&b);
    CHECK(b.put_in_place && state_of(&b) == NEW_LSN);
    CHECK(aside_finish(&b.dir) && state_of(&b) == NEW_LSN);
    end(&b);
}

TEST(snapshot_that_is_abandoned_or_left_behind_leaves_nothing)
{
    struct bench b = begin();
    struct aside a;
    struct segment h = header();
    struct datadir arrived;
    CHECK(receive(&b, &a));
    aside_abandon(&a);
    CHECK(state_of(&b) == OLD_LSN);
    aside_abandon(&a);
    CHECK(receive(&b, &a) && aside_complete(&a, &h, &arrived));
    aside_close(&arrived);
    CHECK(receive(&b, &a) && aside_complete(&a, &h, &arrived)); /* replaces it */
    aside_close(&arrived);
    CHECK(aside_finish(&b.dir) && state_of(&b) == OLD_LSN);
    end(&b);
}

/* ---- crashes ---- */

/* The process is killed before the n-th call. False: it makes fewer. */
static bool kill_at(struct bench *b, unsigned n, void (*work)(struct bench *b))
{
    calls_watch(b->directory.path);
    calls_fail("*", n, UINT_MAX, EIO);
    work(b);
    bool killed = calls_failed() > 0;
    calls_watch("/nowhere");
    return killed;
}

static void finish(struct bench *b)
{
    aside_finish(&b->dir);
}

TEST(directory_has_the_old_state_or_the_new_one_whenever_the_process_is_killed)
{
    bool killed = true, seen_new = false;
    for (unsigned n = 1; killed; n++) {
        struct bench b = begin();
        killed = kill_at(&b, n, replace);
        CHECK(b.put_in_place == !killed);
        CHECK_MSG(aside_finish(&b.dir), "killed before call %u", n);
        uint64_t last = state_of(&b);
        CHECK_MSG(!seen_new || last == NEW_LSN, "killed before call %u", n);
        seen_new = last == NEW_LSN;
        end(&b);
    }
    CHECK(seen_new);
}

TEST(replacement_that_is_killed_again_at_the_next_start_is_still_finished)
{
    bool first = true;
    for (unsigned n = 1; first; n++) {
        bool again = true;
        for (unsigned m = 1; again; m++) {
            struct bench b = begin(), c = begin();
            first = kill_at(&b, n, replace);
            kill_at(&c, n, replace);
            again = kill_at(&b, m, finish);
            CHECK(aside_finish(&b.dir) && aside_finish(&c.dir));
            CHECK_MSG(state_of(&b) == state_of(&c), "killed before calls %u and %u", n, m);
            end(&b);
            end(&c);
        }
    }
}

/* The error is reported, and the next try succeeds. */
TEST(snapshot_that_cannot_be_received_leaves_nothing)
{
    struct segment h = header();
    bool failed = true;
    for (unsigned n = 1; failed; n++) {
        struct bench b = begin();
        struct aside a = {.dir = NULL};
        struct datadir arrived;
        calls_watch(b.directory.path);
        calls_fail("*", n, 1, ENOSPC);
        bool ok = receive(&b, &a) && aside_complete(&a, &h, &arrived);
        failed = calls_failed() > 0;
        CHECK(ok || (failed && errno == ENOSPC));
        calls_watch("/nowhere");
        if (ok)
            aside_close(&arrived);
        else
            aside_abandon(&a);
        replace(&b);
        CHECK(b.put_in_place && state_of(&b) == NEW_LSN);
        end(&b);
    }
}
