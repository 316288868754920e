/* snapshot_test.c - the content of a snapshot while sets are edited. */
#include "server/disk/snapshot.h"

#include "core/delaunay_fields.h"
#include "server/command/command.h"
#include "server/disk/log_file.h"
#include "server/disk/recover.h"
#include "server/disk/replay.h"
#include "server/jobs/job.h"
#include "server/lifecycle.h"
#include "tests/server/digest.h"
#include "tests/server/directory.h"
#include "tests/server/file_calls.h"
#include "tests/server/local.h"
#include "tests/test.h"

#include <errno.h>
#include <poll.h>
#include <signal.h>
#include <string.h>
#include <sys/eventfd.h>
#include <unistd.h>

static struct version *version_of(const struct local *l, const char *name)
{
    return local_set(l, name)->current;
}

/* ---- a server, and a directory for its snapshots ---- */

struct bench {
    struct local l;
    struct directory directory;
    struct datadir dir;
    int event; /* of the snapshot's thread */
};

static void begin(struct bench *b, const char *requests)
{
    b->directory = directory_quick();
    b->event = eventfd(0, EFD_CLOEXEC);
    local_start(&b->l, 0);
    local_ask(&b->l, requests);
    CHECK(b->event >= 0 && datadir_open(&b->dir, b->directory.path, false));
}

static void end(struct bench *b)
{
    local_stop(&b->l);
    close(b->event);
    datadir_close(&b->dir);
    directory_remove(&b->directory);
}

/* Pins the sets, for a snapshot of the first four changes. */
static struct snapshot *pin(struct bench *b)
{
    struct snapshot *snap = snapshot_begin(&b->dir, &b->l.server.sets, 4, b->event);
    CHECK(snap != NULL);
    return snap;
}

static void write_rows(const struct bench *b, struct snapshot *snap)
{
    uint64_t count;
    snapshot_go(snap, 1);
    CHECK(read(b->event, &count, sizeof count) == sizeof count && snap->done);
}

/* Writes it; returns what snapshot_end does. */
static int finish(struct bench *b, struct snapshot *snap)
{
    write_rows(b, snap);
    return snapshot_end(snap, &b->l.server.sets);
}

static bool has_snapshot(const struct bench *b)
{
    char path[128];
    return directory_file(&b->directory, "snapshot.", 0, path);
}

TEST(snapshot_lets_go_of_the_sets_that_it_has_written)
{
    struct bench b;
    struct local *l = &b.l;
    begin(&b, "ADD a 0 0  1 1\nADD b 2 2\n");
    struct snapshot *snap = pin(&b);
    CHECK(version_of(l, "a")->refs == 2 && version_of(l, "b")->refs == 2);
    snapshot_release(snap, &l->server.sets);
    CHECK(version_of(l, "a")->refs == 2);
    write_rows(&b, snap);
    snapshot_release(snap, &l->server.sets);
    CHECK(version_of(l, "a")->refs == 1 && version_of(l, "b")->refs == 1);
    /* Edited in place again; and nothing is released twice. */
    CHECK_STR(local_ask(l, "MOVE a 0 7 7\nDROP b\nGET a 0\n"), "OK 0\nOK 0\nOK 1\n0 7 7\n");
    CHECK(snapshot_end(snap, &l->server.sets) == 0 && version_of(l, "a")->refs == 1);
    end(&b);
}

/* A set may have been pinned after later changes than those up to which the snapshot has all. */
TEST(set_of_a_snapshot_has_the_number_of_its_own_last_change)
{
    struct bench b;
    struct recovery r;
    begin(&b, "ADD a 0 0  1 1\n");
    directory_touch(&b.directory, "log.0000000000000005");
    local_set(&b.l, "a")->current->lsn = 7;
    CHECK(finish(&b, pin(&b)) == 0);
    recovery_init(&r, &b.dir);
    recovery_run(&r);
    CHECK(r.replay.snapshot == 4);
    CHECK(registry_find(&r.replay.sets, &(struct word){"a", 1})->current->lsn == 7);
    recovery_clear(&r);
    end(&b);
}

/* Values at ids far apart, so that several pages and a gap are written; more than one record
 * has. */
TEST(snapshot_has_the_values_of_its_moment_whatever_edits_come_between)
{
    enum { POINTS = 70000 };
    struct bench b;
    struct recovery r;
    char *load = malloc(POINTS * 16 + 400), *to = load;
    CHECK(load != NULL);
    to += sprintf(to, "LOAD a\n");
    for (int i = 0; i < POINTS; i++)
        to += sprintf(to, "%d %d\n", i % 1000, i / 1000);
    strcpy(to,
           ".\nFSET a z 0 1 600 2 40000 3 69999 4\nFSET a y 5 5\nFSET a none 1 nan\nADD b 0 0\n");
    begin(&b, load);
    free(load);
    struct dt *a = version_of(&b.l, "a")->dt;
    static double v[POINTS];
    uint32_t missing;
    CHECK(dt_field_set_run(a, "all", 3, 0, v, POINTS, NULL, &missing) == DT_OK);
    uint64_t want = digest_dt(a, false);
    struct snapshot *snap = pin(&b);
    CHECK_STR(local_ask(&b.l, "FSET a z 0 9 601 9\nFDROP a y\nFDROP a all\nFSET a all 0 1\n"
                              "FSET a new 3 3\nDEL a 600 40000\nMOVE a 0 7 7\nADD b 1 1\n"),
              "OK 0\nOK 0\nOK 0\nOK 0\nOK 0\nOK 0 deleted=2\nOK 0\n"
              "OK 0 first=1 added=1 coincident=0\n");
    CHECK(digest_dt(a, false) != want && finish(&b, snap) == 0);
    directory_touch(&b.directory, "log.0000000000000005");
    recovery_init(&r, &b.dir);
    recovery_run(&r);
    CHECK_MSG(r.result == RECOVERY_OK || r.replay.snapshot == 4, "%s", r.why);
    struct dataset *set = registry_find(&r.replay.sets, &(struct word){"a", 1});
    CHECK(set != NULL && digest_dt(set->current->dt, false) == want);
    recovery_clear(&r);
    end(&b);
}

TEST(snapshot_that_is_given_up_is_none)
{
    struct bench b;
    begin(&b, "");
    CHECK(snapshot_end(pin(&b), &b.l.server.sets) == ECANCELED); /* it has not begun */
    struct snapshot *snap = pin(&b);
    snap->cancel = true;
    CHECK(finish(&b, snap) == ECANCELED && !has_snapshot(&b));
    end(&b);
}

/* ---- its calls: their order, and what happens where one fails ---- */

/* Writes a snapshot of one set into a directory that has an older one, while the first such call
 * fails; what snapshot_end returns. */
static int write_while(struct bench *b, const char *call)
{
    begin(b, "ADD a 0 0  1 1\n");
    directory_touch(&b->directory, "snapshot.0000000000000001");
    directory_touch(&b->directory, "log.0000000000000002");
    CHECK(log_file_begin(&b->dir, 5, 1));
    calls_watch(b->directory.path);
    calls_fail(call, 1, 1, EIO);
    return finish(b, pin(b));
}

TEST(snapshot_is_on_the_disk_before_what_it_replaces_is_removed)
{
    struct bench b;
    CHECK(write_while(&b, "") == 0);
    CHECK_STR(calls_text(), "create snapshot.4.tmp\nwrite snapshot.4.tmp\nsync snapshot.4.tmp\n"
                            "rename snapshot.4.tmp snapshot.4\nsync .\n"
                            "remove snapshot.1\nremove log.2\n");
    end(&b);
}

TEST(snapshot_that_fails_anywhere_leaves_what_was_there)
{
    static const char *const calls[] = {"create snapshot.4.tmp", "write snapshot.4.tmp",
                                        "sync snapshot.4.tmp", "rename snapshot.4.tmp snapshot.4",
                                        "sync ."};
    for (size_t i = 0; i < sizeof calls / sizeof calls[0]; i++) {
        char path[128];
        struct bench b;
        CHECK(write_while(&b, calls[i]) == EIO);
        CHECK(calls_count("remove snapshot.1") == 0 && calls_count("remove log.2") == 0);
        CHECK((calls_count("rename snapshot.4.tmp snapshot.4") == 1) == (i == 4));
        CHECK((calls_count("remove snapshot.4") == 1) == (i == 4));
        /* Not even one whose name may get lost. */
        CHECK(!directory_file(&b.directory, "snapshot.", 1, path));
        end(&b);
    }
}

/* 9.6 MB of rows. Between two syncs the disk has no more than 8 MiB to write, for the log waits for
 * it. */
static int write_large_while(struct bench *b, const char *call)
{
    enum { POINTS = 400000 };
    char *load = malloc(POINTS * 16 + 100), *to = load;
    CHECK(load != NULL);
    to += sprintf(to, "LOAD t\n");
    for (int i = 0; i < POINTS; i++)
        to += sprintf(to, "%d %d\n", i % 1000, i / 1000);
    strcpy(to, ".\n");
    begin(b, load);
    free(load);
    calls_watch(b->directory.path);
    calls_fail(call, 1, 1, EIO);
    struct snapshot *snap = pin(b);
    write_rows(b, snap);
    CHECK(snap->bytes > 8 << 20 || snap->error != 0);
    return snapshot_end(snap, &b->l.server.sets);
}

TEST(snapshot_is_synced_every_8_MiB)
{
    struct bench b;
    CHECK(write_large_while(&b, "") == 0);
    CHECK_STR(calls_text(), "create snapshot.4.tmp\nwrite snapshot.4.tmp\nsync snapshot.4.tmp\n"
                            "write snapshot.4.tmp\nsync snapshot.4.tmp\n"
                            "rename snapshot.4.tmp snapshot.4\nsync .\n");
    end(&b);
}

/* A later sync may succeed although the disk lacks what this one did not write. */
TEST(snapshot_ends_with_the_first_sync_that_fails)
{
    struct bench b;
    CHECK(write_large_while(&b, "sync snapshot.4.tmp") == EIO);
    CHECK_STR(calls_text(), "create snapshot.4.tmp\nwrite snapshot.4.tmp\nremove snapshot.4.tmp\n");
    end(&b);
}

TEST(write_of_a_snapshot_that_was_interrupted_is_made_again)
{
    struct bench b;
    begin(&b, "");
    calls_watch(b.directory.path);
    calls_fail("write snapshot.4.tmp", 1, 3, EINTR);
    CHECK(finish(&b, pin(&b)) == 0 && calls_failed() == 3);
    end(&b);
}

/* It has replaced one of the same name, without which the log has a gap. */
TEST(snapshot_whose_new_name_cannot_be_synced_stays_if_there_was_one_of_that_name)
{
    struct bench b;
    begin(&b, "");
    directory_touch(&b.directory, "snapshot.0000000000000004");
    calls_watch(b.directory.path);
    calls_fail("sync .", 1, 1, EIO);
    CHECK(finish(&b, pin(&b)) == EIO && has_snapshot(&b));
    end(&b);
}

/* Its thread may report its end only after the server has stopped and closed its own descriptor. */
TEST(snapshot_reports_its_end_through_a_descriptor_of_its_own)
{
    int ends[2];
    uint64_t count;
    struct bench b;
    begin(&b, "");
    int kept = dup(b.event);
    struct snapshot *snap = pin(&b);
    CHECK(kept >= 0 && pipe(ends) == 0 && dup2(ends[1], b.event) == b.event);
    snapshot_go(snap, 1);
    struct pollfd counted = {.fd = kept, .events = POLLIN},
                  other = {.fd = ends[0], .events = POLLIN};
    CHECK(poll(&counted, 1, 10000) == 1 && read(kept, &count, sizeof count) == sizeof count);
    CHECK(poll(&other, 1, 0) == 0 && snapshot_end(snap, &b.l.server.sets) == 0);
    close(kept);
    close(ends[0]);
    close(ends[1]);
    end(&b);
}

/* ---- without memory ---- */

/* The written file can be read again, and contains the two sets. */
static void check_readable(struct bench *b)
{
    struct recovery r;
    CHECK(log_file_begin(&b->dir, 5, 1));
    recovery_init(&r, &b->dir);
    recovery_run(&r);
    CHECK_MSG(r.result == RECOVERY_OK, "%s", r.why);
    const struct dataset *set = registry_find(&r.replay.sets, &(struct word){"a", 1});
    CHECK(r.replay.sets.sets == 2 && dt_next_id(set->current->dt) == 2);
    recovery_clear(&r);
}

/* Writes two sets with the n-th allocation failing; whether one did. */
static bool survives(long n)
{
    struct bench b;
    begin(&b, "ADD a 0 0  1 1\nADD b 2 2\n");
    test_fail_alloc(n);
    struct snapshot *snap = snapshot_begin(&b.dir, &b.l.server.sets, 4, b.event);
    if (snap != NULL) {
        int error = finish(&b, snap);
        CHECK_MSG(error == 0 || error == ENOMEM || error == EAGAIN, "%s", strerror(error));
        CHECK((error == 0) == has_snapshot(&b));
    }
    bool failed = test_alloc_failed();
    test_fail_alloc(0);
    if (has_snapshot(&b))
        check_readable(&b);
    end(&b);
    return failed;
}

TEST(snapshot_for_which_there_is_no_memory_is_none)
{
    long n = 1;
    while (survives(n))
        CHECK(++n < 100);
    CHECK(n > 5);
}

/* Writes a set whose points have moved meanwhile, with the n-th allocation of that failing; whether
 * one did. *error is what snapshot_end returns. */
static bool write_after_edit(long n, int *error)
{
    struct bench b;
    begin(&b, "ADD a 0 0  1 1\n");
    struct snapshot *snap = pin(&b);
    test_fail_alloc(n);
    local_ask(&b.l, "MOVE a 0 9 9\n");
    bool failed = test_alloc_failed();
    test_fail_alloc(0);
    *error = finish(&b, snap);
    CHECK((*error == 0) == has_snapshot(&b));
    end(&b);
    return failed;
}

TEST(snapshot_whose_rows_were_lost_by_an_edit_without_memory_is_none)
{
    unsigned lost = 0;
    int error = 0;
    for (long n = 1; write_after_edit(n, &error); n++) {
        CHECK(n < 100 && (error == 0 || error == ENOMEM));
        lost += error == ENOMEM;
    }
    CHECK(error == 0 && lost > 0);
}

/* ---- edits while it is being written ---- */

enum { POINTS = 20000 }; /* some turns' worth */

/* The sets of the one snapshot that is in the directory. */
static void read_back(const struct directory *d, struct replay *p)
{
    char path[128];
    size_t n, at = SEGMENT_HEADER;
    struct record r;
    CHECK(directory_file(d, "snapshot.", 0, path));
    char *bytes = file_read(path, &n);
    replay_init(p);
    while (at < n) {
        ptrdiff_t took = record_read(bytes + at, n - at, &r);
        const char *fault = took > 0 ? replay_snapshot(p, &r) : r.fault;
        CHECK_MSG(fault == NULL, "%s", fault);
        at += (size_t)took;
    }
    free(bytes);
}

static size_t rows_of(struct dt *t, struct dt_row *row)
{
    struct dt_view *v = dt_view_begin(t, false);
    uint32_t from = 0;
    size_t n;
    CHECK(v != NULL && dt_view_rows(t, v, &from, row, POINTS, &n) == DT_OK);
    dt_view_end(v);
    return n;
}

static void check_rows(struct dt *got, struct dt *want)
{
    static struct dt_row a[POINTS], b[POINTS];
    size_t n = rows_of(got, a);
    CHECK(dt_next_id(got) == dt_next_id(want));
    CHECK(rows_of(want, b) == n && memcmp(a, b, n * sizeof *a) == 0);
}

/* Points on a lattice, so that many coincide. */
static void compose_points(char *to, size_t size)
{
    size_t at = (size_t)snprintf(to, size, "LOAD t %u\n", (unsigned)POINTS);
    for (unsigned i = 0; i < POINTS; i++)
        at += (size_t)snprintf(to + at, size - at, "%u %u\n", test_below(120), test_below(120));
}

static void compose_edits(char *to, size_t size, unsigned edits)
{
    size_t at = 0;
    for (unsigned i = 0; i < edits; i++) {
        unsigned kind = test_below(8), id = test_below(POINTS), x = test_below(120),
                 y = test_below(120);
        if (kind == 0)
            at += (size_t)snprintf(to + at, size - at, "ADD t %u %u\n", x, y);
        else if (kind < 4)
            at += (size_t)snprintf(to + at, size - at, "DEL t %u\n", id);
        else
            at += (size_t)snprintf(to + at, size - at, "MOVE t %u %u %u\n", id, x, y);
    }
}

TEST(snapshot_holds_the_set_as_it_was_whatever_edits_come_meanwhile)
{
    static char text[POINTS * 40];
    struct local l;
    struct datadir dir;
    struct directory d = directory_new();
    int event = eventfd(0, EFD_CLOEXEC);
    local_start(&l, 2);
    compose_points(text, sizeof text);
    local_ask(&l, text);
    CHECK(event >= 0 && datadir_open(&dir, d.path, false));
    for (uint64_t lsn = 1; lsn <= 4; lsn++) {
        struct word name = {"t", 1};
        struct dt *then;
        struct replay p;
        uint64_t count;
        struct version *v = version_of(&l, "t");
        CHECK(dt_clone(v->dt, &then) == DT_OK);
        struct snapshot *snap = snapshot_begin(&dir, &l.server.sets, lsn, event);
        CHECK(snap != NULL);
        compose_edits(text, sizeof text, 300);
        local_ask(&l, text);
        snapshot_go(snap, 1);
        while (!snap->done) {
            compose_edits(text, sizeof text, 10);
            local_ask(&l, text);
        }
        CHECK(read(event, &count, sizeof count) == sizeof count);
        CHECK(snapshot_end(snap, &l.server.sets) == 0);
        CHECK(version_of(&l, "t") == v && v->refs == 1); /* it was edited in place */
        read_back(&d, &p);
        check_rows(registry_find(&p.sets, &name)->current->dt, then);
        replay_clear(&p);
        dt_free(then);
        if (lsn == 2)
            local_ask(&l, "TRIANGULATE t\n");
    }
    CHECK(strncmp(local_ask(&l, "CHECK t\n"), "OK 0 delaunay=yes", 17) == 0);
    local_stop(&l);
    close(event);
    datadir_close(&dir);
    directory_remove(&d);
}

static void deliver(void *ctx, struct job *j)
{
    struct local *l = ctx;
    struct answer a = {.out = &l->out, .owner = 1, .client.role = ROLE_WRITE};
    job_finish(&l->server, j, &a);
}

/* A reactor never waits for the snapshot's thread, which may be slow to get a processor. */
TEST(edit_leaves_its_turn_to_a_worker_while_the_rows_are_read)
{
    struct local l;
    struct answer a = {.out = &l.out, .owner = 1, .client.role = ROLE_WRITE};
    local_start(&l, 1);
    struct request *q = &l.server.reactor->request;
    local_ask(&l, "ADD t 0 0  1 1\nADD other 5 5\n");
    struct version *v = version_of(&l, "t");
    CHECK(gate_try_visit(&v->gate)); /* the snapshot's thread reads */
    CHECK(request_split(q, "MOVE t 1 7 7", 12));
    buf_rewind(&l.out, 0);
    command_run(&l.server, q, &a);
    CHECK(a.next == ANSWER_WORK && buf_len(&l.out) == 0);
    CHECK_STR(local_ask(&l, "MOVE other 0 6 6\nPING\n"), "OK 0\nOK 0\n");
    CHECK(!gate_try_close(&v->gate));
    gate_end_visit(&v->gate);
    struct pollfd event = {.fd = workers_event(l.server.workers), .events = POLLIN};
    CHECK(poll(&event, 1, 10000) == 1);
    buf_rewind(&l.out, 0);
    server_collect(&l.server, deliver, &l);
    buf_append_char(&l.out, '\0');
    CHECK_STR(buf_head(&l.out), "OK 0\n");
    CHECK_STR(local_ask(&l, "GET t 1\n"), "OK 1\n1 7 7\n");
    CHECK(version_of(&l, "t") == v && gate_try_close(&v->gate));
    gate_open(&v->gate);
    local_stop(&l);
}

/* After kill -9 a daemon reads the same state as another one that got the same requests. */
TEST_TIMEOUT(edits_during_snapshots_survive_kill, 60)
{
    static const char *const names[] = {"t", NULL};
    static char text[POINTS * 40];
    struct directory dir = directory_new();
    struct daemon d = directory_daemon(&dir, NULL), oracle = daemon_start(NULL);
    compose_points(text, sizeof text);
    carry_out(&d, text);
    carry_out(&oracle, text);
    for (int round = 0; round < 4; round++) {
        int fd = daemon_connect(&d), other = daemon_connect(&oracle);
        if (round == 1) {
            carry_out(&d, "TRIANGULATE t\n");
            carry_out(&oracle, "TRIANGULATE t\n");
        }
        say(fd, "SNAPSHOT\n");
        CHECK(strncmp(hear_line(fd), "OK", 2) == 0);
        for (int i = 0; i < 5; i++) {
            char line[128];
            compose_edits(text, sizeof text, 200);
            say(fd, text);
            say(other, text);
            for (int n = 0; n < 200; n++) {
                snprintf(line, sizeof line, "%s", hear_line(other));
                CHECK_UNVERSIONED(hear_line(fd), line);
            }
        }
        close(fd);
        close(other);
        if (round != 3) /* then it may be killed half way */
            await_info(&d, "snapshot_running", 0);
        daemon_stop(&d, SIGKILL);
        d = directory_daemon(&dir, NULL);
        await_info(&d, "loaded_percent", 100);
        char *got = directory_state(&d, names), *want = directory_state(&oracle, names);
        CHECK(strcmp(got, want) == 0);
        free(got);
        free(want);
    }
    daemon_stop(&d, SIGKILL);
    directory_remove(&dir);
}
