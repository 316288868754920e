/* submit_test.c - a restart restores what changes wrote to the log, in each order in which requests
 * wait. A server with a data directory, in this process. */
#include "server/jobs/submit.h"

#include "server/command/command.h"
#include "server/disk/recover.h"
#include "server/follow/follower.h"
#include "server/follow/leader.h"
#include "server/jobs/durable.h"
#include "server/jobs/job.h"
#include "server/jobs/restart.h"
#include "server/lifecycle.h"
#include "server/rows/stream.h"
#include "tests/server/directory.h"
#include "tests/server/file_calls.h"
#include "tests/server/local.h"
#include "tests/test.h"

#include <errno.h>
#include <poll.h>
#include <semaphore.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

struct bench {
    struct local l;
    struct directory dir;
    struct waiter dropper; /* a request that waits for t, to drop it */
};

static void await_durable_event(struct bench *b)
{
    struct pollfd event = {.fd = durable_event(&b->l.server), .events = POLLIN};
    durable_turn_end(&b->l.server);
    CHECK(poll(&event, 1, 10000) == 1 && restart_on_durable_event(&b->l.server));
}

static void begin(struct bench *b, unsigned threads)
{
    *b = (struct bench){.dir = directory_quick()};
    local_start(&b->l, threads);
    b->l.config.data = b->dir.path;
    CHECK(durable_start(&b->l.server));
    while (!durable_is_complete(&b->l.server))
        await_durable_event(b);
}

static struct dataset *set_t(const struct bench *b)
{
    return local_set(&b->l, "t");
}

static void drop_t(struct waiter *w)
{
    struct bench *b = (struct bench *)(void *)((char *)w - offsetof(struct bench, dropper));
    struct request *q = &b->l.server.reactor->request;
    struct answer a = {
        .out = &b->l.out, .owner = 1, .client.role = ROLE_WRITE, .turn = queue_turn(w)};
    CHECK(request_split(q, "DROP t", 6));
    command_run(&b->l.server, q, &a);
    CHECK(a.next == ANSWER_DONE && set_t(b) == NULL);
}

static void await_snapshot(struct bench *b)
{
    do
        await_durable_event(b);
    while (durable_saver(&b->l.server)->snapshots == 0);
}

/* Recovers what a restart would find, after the server has stopped. */
static void recover(struct bench *b, struct datadir *dir, struct recovery *r)
{
    CHECK(datadir_open(dir, b->dir.path, false));
    recovery_init(r, dir);
    recovery_run(r);
    CHECK_MSG(r->result == RECOVERY_OK, "%s", r->why);
}

static void end_recovery(struct bench *b, struct datadir *dir, struct recovery *r)
{
    recovery_clear(r);
    datadir_close(dir);
    directory_remove(&b->dir);
}

/* The snapshot pins the set while it is being dropped. If the snapshot said that the set has the change
 * that drops it, recovery would skip that change, and the set would be back. */
TEST(set_that_is_dropped_before_a_snapshot_reaches_it_stays_dropped)
{
    struct datadir dir;
    struct recovery r;
    struct bench b;
    begin(&b, 0);
    local_ask(&b.l, "ADD t 1 1\nADD u 2 2\n");
    struct dataset *set = set_t(&b);
    set->exclusive = true; /* as if a worker edited it */
    b.dropper.wake = drop_t;
    b.dropper.writes = true;
    queue_enter(&set->queue, &b.dropper);
    CHECK(strncmp(local_ask(&b.l, "SNAPSHOT\n"), "OK 0 lsn=2", 10) == 0);
    set->exclusive = false;
    queue_call(&set->queue);
    await_snapshot(&b);
    local_stop(&b.l);
    recover(&b, &dir, &r);
    CHECK(registry_find(&r.replay.sets, &(struct word){"u", 1}) != NULL);
    CHECK(registry_find(&r.replay.sets, &(struct word){"t", 1}) == NULL);
    end_recovery(&b, &dir, &r);
}

/* Another reactor answers CONFIG SET and SNAPSHOT, and the snapshot is written before the turn of the first one ends. */
TEST(snapshot_that_is_written_at_once_removes_what_the_new_setting_does_not_keep)
{
    struct bench b;
    struct pollfd event = {.events = POLLIN};
    uint64_t lsn;
    char path[128];
    begin(&b, 0);
    durable_keep_log(&b.l.server);
    local_ask(&b.l, "ADD t 1 1\n");
    CHECK(durable_begin_snapshot(&b.l.server, &lsn) == DURABLE_BEGUN);
    await_snapshot(&b);
    CHECK(directory_file(&b.dir, "log.", 1, path));
    local_ask(&b.l, "ADD t 2 2\n");
    durable_turn_end(&b.l.server);
    local_ask(&b.l, "CONFIG SET keep-log 1\n");
    CHECK(durable_begin_snapshot(&b.l.server, &lsn) == DURABLE_BEGUN);
    event.fd = durable_event(&b.l.server);
    do
        CHECK(poll(&event, 1, 10000) == 1 && restart_on_durable_event(&b.l.server));
    while (durable_saver(&b.l.server)->snapshots == 1);
    CHECK(!directory_file(&b.dir, "log.", 1, path));
    local_stop(&b.l);
    directory_remove(&b.dir);
}

/* ---- --min-followers within a turn ---- */

static void ignore_hold(struct hold *h)
{
    (void)h;
}

/* Makes a change, and writes it to the disk before the turn ends; whether its reply still waits. */
static bool waits_for_followers(struct bench *b)
{
    struct hold hold = {.groups = 0};
    struct pollfd event = {.fd = durable_event(&b->l.server), .events = POLLIN};
    local_ask(&b->l, "ADD t 1 1\n");
    uint64_t lsn = durable_last_lsn(&b->l.server);
    hold_acknowledgement(&b->l.server.held, &hold, lsn, 0);
    log_push(durable_log(&b->l.server));
    while (durable_status(&b->l.server)->durable < lsn)
        CHECK(poll(&event, 1, 10000) == 1 && restart_on_durable_event(&b->l.server));
    bool waits = hold.groups > 0;
    hold_clear(&hold);
    return waits;
}

static void begin_leading(struct bench *b)
{
    begin(b, 0);
    b->l.server.held.released = b->l.server.held.not_saved = ignore_hold;
    CHECK(leader_start(&b->l.server, &b->l.server.reactor->loop));
    CHECK(!waits_for_followers(b));
}

/* Another reactor answers CONFIG SET and the next change, which the disk has before the turn of the first one ends. */
TEST(change_after_config_set_min_followers_waits_at_once)
{
    struct bench b;
    begin_leading(&b);
    CHECK_STR(local_ask(&b.l, "CONFIG SET min-followers 1\n"), "OK 0\n");
    CHECK(waits_for_followers(&b));
    leader_turn_end(&b.l.server);
    CHECK(waits_for_followers(&b));
    local_ask(&b.l, "CONFIG SET min-followers 0\n");
    leader_turn_end(&b.l.server);
    CHECK(!waits_for_followers(&b));
    local_stop(&b.l);
    directory_remove(&b.dir);
}

/* The same after FOLLOW NONE. */
TEST(change_after_a_promotion_waits_for_followers_at_once)
{
    struct bench b;
    begin_leading(&b);
    struct server *s = &b.l.server;
    CHECK(follower_prepare(s, &s->reactor->loop));
    follower_begin(s);
    struct history newer = history_next(&durable_dir(s)->lineage.history, 1);
    follower_meet(s, &newer);
    CHECK(strncmp(local_ask(&b.l, "ADD t 1 1\n"), "ERR READONLY", 12) == 0);
    local_ask(&b.l, "CONFIG SET min-followers 1\n");
    CHECK(!s->held.needs_followers); /* it does not lead */
    leader_turn_end(s);
    CHECK(follower_promote(s) == NULL);
    CHECK(waits_for_followers(&b));
    local_stop(&b.l);
    directory_remove(&b.dir);
}

/* ---- followers of one leader ---- */

/* Returns the socket of the follower. */
static int connect_follower(struct server *s)
{
    struct sock_peer peer = {.kind = SOCK_UNIX};
    struct position from = {.lsn = 0};
    int fd[2];
    CHECK(socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, fd) == 0);
    CHECK(leader_add(s, fd[0], &peer, &from));
    return fd[1];
}

/* The disk has a change, and another follower connects before the turn ends. */
TEST(change_of_the_turn_in_which_a_follower_connects_is_sent_to_the_others)
{
    struct bench b;
    uint64_t least = UINT64_MAX;
    begin_leading(&b);
    struct server *s = &b.l.server;
    int first = connect_follower(s);
    leader_turn_end(s);
    CHECK(!waits_for_followers(&b));
    int second = connect_follower(s);
    leader_turn_end(s);
    for (const struct sender *f = NULL; (f = leader_next(s, f)) != NULL;)
        least = f->durable < least ? f->durable : least;
    CHECK(least == durable_status(s)->durable);
    local_stop(&b.l);
    close(first);
    close(second);
    directory_remove(&b.dir);
}

/* ---- what the reply of a worker's query shows ---- */

enum { POINTS = 30000 };

static sem_t gate;

static void run_at_gate(struct job *j)
{
    (void)j;
    sem_wait(&gate);
}

static void ignore(struct server *s, struct job *j, struct answer *a)
{
    (void)s, (void)j, (void)a;
}

/* Occupies both threads of a server with one worker, until open_gate. */
static void shut_gate(struct bench *b)
{
    sem_init(&gate, 0, 0);
    for (int i = 0; i < 2; i++)
        job_aside(&b->l.server, NULL, job_new(sizeof(struct job), run_at_gate, ignore), JOB_SHORT);
}

static void open_gate(void)
{
    sem_post(&gate);
    sem_post(&gate);
}

/* A live set so large that a WITHIN of all its points goes to a worker. */
static void begin_with_a_large_set(struct bench *b)
{
    static char text[POINTS * 40];
    size_t at = (size_t)sprintf(text, "LOAD t %d\n", POINTS);
    begin(b, 1);
    for (unsigned i = 0; i < POINTS; i++)
        at += (size_t)sprintf(text + at, "%.6f %.6f\n", test_uniform(), test_uniform());
    CHECK(strncmp(local_ask(&b->l, text), "OK 0 ", 5) == 0);
    CHECK(strncmp(local_ask(&b->l, "TRIANGULATE t\nNEAREST t 0 0\n"), "OK 0 ", 5) == 0);
}

static struct answer run(struct bench *b, const char *request)
{
    struct request *q = &b->l.server.reactor->request;
    struct answer a = {.out = &b->l.out, .owner = 1, .client.role = ROLE_WRITE};
    CHECK(request_split(q, request, strlen(request)));
    command_run(&b->l.server, q, &a);
    return a;
}

/* Sends a request that a worker will answer. */
static struct job *ask(struct bench *b, const char *request)
{
    struct answer a = run(b, request);
    CHECK(a.next == ANSWER_WORK);
    return a.job;
}

static struct answer owned; /* of the job with an owner */
static unsigned tellings;

static void tell(void *ctx, struct job *j)
{
    struct bench *b = ctx;
    if (j->owner == 0) {
        server_finish_abandoned(&b->l.server, j);
        return;
    }
    owned = (struct answer){.out = &b->l.out, .owner = 1, .client.role = ROLE_WRITE};
    tellings++;
    job_finish(&b->l.server, j, &owned);
    if (owned.next == ANSWER_STREAM)
        stream_free(&b->l.server, owned.stream);
}

static void collect(struct bench *b)
{
    struct pollfd event = {.fd = workers_event(b->l.server.workers), .events = POLLIN};
    CHECK(poll(&event, 1, 10000) == 1);
    server_collect(&b->l.server, tell, b);
}

static void end(struct bench *b)
{
    while (!list_is_empty(&b->l.server.jobs))
        collect(b);
    local_stop(&b->l);
    directory_remove(&b->dir);
}

/* The worker begins after the edit, so the reply shows the edit. */
TEST(query_by_a_worker_shows_the_last_change_before_it_was_answered)
{
    struct bench b;
    begin_with_a_large_set(&b);
    uint64_t before = set_t(&b)->current->lsn;
    shut_gate(&b);
    ask(&b, "WITHIN t 0 0 1 1");
    CHECK_STR(local_ask(&b.l, "MOVE t 0 0.5 0.5\n"), "OK 0\n");
    CHECK(set_t(&b)->current->lsn > before);
    open_gate();
    while (tellings == 0)
        collect(&b);
    CHECK(owned.shown == set_t(&b)->current->lsn);
    end(&b);
}

/* If it did, the failure of another client's change would end the reader's connection. */
TEST(query_that_brings_the_triangulation_up_to_date_acknowledges_nothing)
{
    char request[2000] = "ADD t";
    struct bench b;
    begin(&b, 0);
    local_ask(&b.l, "ADD t 0 0  4 0  0 4\nTRIANGULATE t\n");
    for (int i = 0; i < 100; i++)
        sprintf(request + strlen(request), " %d %d", i % 10, 10 + i / 10);
    CHECK(run(&b, request).lsn == set_t(&b)->current->lsn);
    CHECK(version_is_stale(set_t(&b)->current));
    struct answer a = run(&b, "NEAREST t 5 5");
    CHECK(!version_is_stale(set_t(&b)->current));
    CHECK(a.lsn == 0 && a.shown == set_t(&b)->current->lsn);
    end(&b);
}

/* A worker has made an edit, which the log has, but no reactor has ended the job yet. */
TEST(edit_is_in_the_log_from_when_others_can_read_it)
{
    char request[2000] = "DEL t";
    struct bench b;
    begin_with_a_large_set(&b);
    uint64_t before = set_t(&b)->current->lsn;
    for (int i = 0; i < 200; i++)
        sprintf(request + strlen(request), " %d", i);
    struct version *v = ask(&b, request)->base;
    while (v->lsn == before)
        sched_yield();
    gate_visit(&v->gate); /* as a reader of a piece does */
    gate_end_visit(&v->gate);
    CHECK(log_last(durable_log(&b.l.server)) == before + 1 && v->lsn == before + 1);
    CHECK(set_t(&b)->exclusive && tellings == 0);
    while (tellings == 0)
        collect(&b);
    CHECK(!set_t(&b)->exclusive && owned.lsn == before + 1 && v->lsn == before + 1);
    end(&b);
}

/* A snapshot has no set that is not born yet. So it must not claim to have the change that creates the set. */
TEST(set_that_a_worker_has_filled_before_a_snapshot_begins_is_restored)
{
    char request[2000] = "ADD t";
    struct datadir dir;
    struct recovery r;
    struct bench b;
    begin(&b, 1);
    for (int i = 0; i < 200; i++)
        sprintf(request + strlen(request), " %d %d", i % 10, i / 10);
    ask(&b, request);
    struct pollfd event = {.fd = workers_event(b.l.server.workers), .events = POLLIN};
    CHECK(poll(&event, 1, 10000) == 1); /* the worker is done, but no reactor has ended the job */
    CHECK(strncmp(local_ask(&b.l, "SNAPSHOT\n"), "OK 0 lsn=0", 10) == 0);
    while (tellings == 0)
        collect(&b);
    CHECK(owned.lsn == 1);
    await_snapshot(&b);
    local_stop(&b.l);
    recover(&b, &dir, &r);
    struct dataset *set = registry_find(&r.replay.sets, &(struct word){"t", 1});
    CHECK(set != NULL && dt_next_id(set->current->dt) == 200);
    end_recovery(&b, &dir, &r);
}

TEST(version_made_by_a_build_has_the_changes_of_the_version_before_it)
{
    struct bench b;
    begin_with_a_large_set(&b);
    struct version *before = set_t(&b)->current;
    uint64_t lsn = before->lsn;
    CHECK(strncmp(local_ask(&b.l, "TRIANGULATE t METHOD divide\n"), "OK 0 ", 5) == 0);
    CHECK(set_t(&b)->current != before && lsn > 0 && set_t(&b)->current->lsn == lsn);
    end(&b);
}

TEST(triangulation_is_logged_once)
{
    struct bench b;
    begin(&b, 0);
    local_ask(&b.l, "ADD t 0 0  1 0  0 1\nTRIANGULATE t\n");
    uint64_t lsn = set_t(&b)->current->lsn;
    CHECK(strncmp(local_ask(&b.l, "TRIANGULATE t METHOD shelling\n"), "OK 0 ", 5) == 0);
    CHECK(lsn == 2 && set_t(&b)->current->lsn == 2);
    end(&b);
}

/* ---- what is accepted, and when ---- */

TEST(full_disk_accepts_only_changes_that_free_space)
{
    struct bench b;
    begin(&b, 0);
    local_ask(&b.l, "ADD t 1 1  2 2\nADD u 3 3\n");
    do
        await_durable_event(&b);
    while (durable_saver(&b.l.server)->status.durable < 2);
    calls_watch(b.dir.path);
    calls_limit_space(0);
    local_ask(&b.l, "ADD t 4 4\n");
    do
        await_durable_event(&b);
    while (durable_saver(&b.l.server)->status.state == LOG_GOOD);
    static const char refusal[] = "ERR READONLY changes cannot be saved: No space left on device; "
                                  "DEL and DROP are possible\n";
    CHECK_STR(local_ask(&b.l, "ADD t 5 5\n"), refusal);
    CHECK_STR(local_ask(&b.l, "MOVE t 0 5 5\n"), refusal);
    CHECK(strncmp(local_ask(&b.l, "DEL t 0\n"), "OK 0 deleted=1", 14) == 0);
    CHECK_STR(local_ask(&b.l, "DROP u\n"), "OK 0\n");
    end(&b);
}

TEST(set_is_not_read_until_it_is_triangulated_again)
{
    struct bench b;
    begin(&b, 0);
    local_ask(&b.l, "ADD t 0 0  1 0  0 1\nTRIANGULATE t\n");
    local_stop(&b.l); /* the next server uses the same directory */
    local_start(&b.l, 1);
    b.l.config.data = b.dir.path;
    CHECK(durable_start(&b.l.server));
    while (
        list_is_empty(&b.l.server.jobs)) /* the job triangulates; its result is not collected yet */
        await_durable_event(&b);
    static const char refusal[] = "ERR LOADING the set t is being triangulated, ";
    CHECK(strncmp(local_ask(&b.l, "LISTS t 0\n"), refusal, strlen(refusal)) == 0);
    while (!list_is_empty(&b.l.server.jobs))
        collect(&b);
    CHECK_STR(local_ask(&b.l, "LISTS t 0\n"), "OK 1 interior=0 boundary=1\n0 1 2\n");
    end(&b);
}

/* It is not logged, because the set was triangulated before. If the set lost its lsn, a snapshot would
 * store none, and recovery would apply its changes a second time. */
TEST(triangulation_that_is_made_again_keeps_the_lsn_of_the_set)
{
    struct bench b;
    begin_with_a_large_set(&b);
    uint64_t lsn = set_t(&b)->current->lsn;
    CHECK(lsn > 0 && strncmp(local_ask(&b.l, "TRIANGULATE t METHOD divide\n"), "OK 0 ", 5) == 0);
    CHECK(set_t(&b)->current->lsn == lsn);
    end(&b);
}

/* ---- a directory that cannot be used ---- */

static bool starts(struct bench *b)
{
    local_start(&b->l, 0);
    b->l.config.data = b->dir.path;
    if (!durable_start(&b->l.server))
        return false;
    bool good = true;
    while (good && !durable_is_complete(&b->l.server)) {
        struct pollfd event = {.fd = durable_event(&b->l.server), .events = POLLIN};
        CHECK(poll(&event, 1, 10000) == 1);
        good = restart_on_durable_event(&b->l.server);
    }
    return good;
}

TEST(server_does_not_start_on_a_directory_that_cannot_be_written)
{
    static const char *const calls[] = {"create snapshot.1.tmp", "sync log.1"};
    struct bench b = {.dir = directory_quick()};
    for (size_t i = 0; i < sizeof calls / sizeof calls[0]; i++) {
        calls_watch(b.dir.path);
        calls_fail(calls[i], 1, 1, EIO);
        CHECK_MSG(!starts(&b), "%s", calls[i]);
        local_stop(&b.l);
        calls_watch(b.dir.path);
        CHECK(starts(&b)); /* the next attempt succeeds */
        local_ask(&b.l, i == 0 ? "ADD t 1 1\n" : "POINTS t\n");
        local_stop(&b.l);
    }
    directory_remove(&b.dir);
}

TEST(server_does_not_start_on_a_directory_that_does_not_exist)
{
    struct bench b = {0};
    strcpy(b.dir.path, "/nonexistent/directory");
    CHECK(!starts(&b) && b.l.server.durable == NULL);
    local_stop(&b.l);
}

TEST(one_snapshot_is_written_at_a_time)
{
    struct bench b;
    begin(&b, 0);
    CHECK(strncmp(local_ask(&b.l, "SNAPSHOT\n"), "OK 0 lsn=0", 10) == 0);
    CHECK_STR(local_ask(&b.l, "SNAPSHOT\n"), "ERR BUSY a snapshot is being written\n");
    end(&b);
}
