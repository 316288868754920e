/* journal_test.c - what edits write into the log is what comes back, whoever stands in line. A server
 * with a data directory, in this process. */
#include "server/journal.h"

#include "server/command.h"
#include "server/durable.h"
#include "server/recover.h"
#include "tests/server/directory.h"
#include "tests/server/local.h"
#include "tests/test.h"

#include <poll.h>
#include <string.h>

struct bench {
    struct local l;
    struct directory dir;
    struct waiter dropper; /* a request that waits for t, to drop it */
};

static void await_durable_event(struct bench *b)
{
    struct pollfd event = {.fd = durable_event(&b->l.server), .events = POLLIN};
    durable_turn_end(&b->l.server);
    CHECK(poll(&event, 1, 10000) == 1 && durable_on_event(&b->l.server));
}

static void begin(struct bench *b)
{
    *b = (struct bench){.dir = directory_quick()};
    local_start(&b->l, 0);
    b->l.config.data = b->dir.path;
    CHECK(durable_start(&b->l.server));
    while (!durable_is_complete(&b->l.server))
        await_durable_event(b);
}

static struct dataset *set_t(struct bench *b)
{
    return registry_find(&b->l.server.sets, &(struct word){"t", 1});
}

static void drop_t(struct waiter *w)
{
    struct bench *b = (struct bench *)(void *)((char *)w - offsetof(struct bench, dropper));
    struct request *q = &b->l.server.request;
    struct answer a = {.out = &b->l.out, .owner = 1, .role = ROLE_WRITE, .turn = wait_turn(w)};
    CHECK(request_split(q, "DROP t", 6));
    command_run(&b->l.server, q, &a);
    CHECK(a.wait == NULL && set_t(b) == NULL);
}

/* The snapshot pins the set while it is being dropped. Were it to say that the set has the change
 * which drops it, that would be passed over when the log is read, and the set would be back. */
TEST(set_that_is_dropped_before_a_snapshot_gets_its_turn_stays_dropped)
{
    struct datadir dir;
    struct recovery r;
    struct durable_facts facts;
    struct bench b;
    begin(&b);
    local_ask(&b.l, "ADD t 1 1\nADD u 2 2\n");
    struct dataset *set = set_t(&b);
    set->exclusive = true; /* as if a worker edited it */
    b.dropper.wake = drop_t;
    b.dropper.writes = true;
    wait_enter(&set->queue, &b.dropper);
    CHECK(strncmp(local_ask(&b.l, "SNAPSHOT\n"), "OK 0 lsn=2", 10) == 0);
    set->exclusive = false;
    wait_call(&set->queue);
    do {
        await_durable_event(&b);
        durable_facts(&b.l.server, &facts);
    } while (facts.snapshots == 0);
    local_stop(&b.l);
    CHECK(datadir_open(&dir, b.dir.path, false));
    recovery_init(&r, &dir);
    recovery_run(&r);
    CHECK_MSG(r.result == RECOVERY_OK, "%s", r.why);
    CHECK(registry_find(&r.replay.sets, &(struct word){"u", 1}) != NULL);
    CHECK(registry_find(&r.replay.sets, &(struct word){"t", 1}) == NULL);
    recovery_clear(&r);
    datadir_close(&dir);
    directory_remove(&b.dir);
}
