/* snapshot_test.c - what a snapshot holds of the sets while it is being written. */
#include "server/snapshot.h"
#include "tests/server/directory.h"
#include "tests/server/local.h"
#include "tests/test.h"

#include <string.h>
#include <sys/eventfd.h>
#include <unistd.h>

static struct version *version_of(struct local *l, const char *name)
{
    struct word w = {name, strlen(name)};
    return registry_find(&l->server.sets, &w)->current;
}

TEST(snapshot_lets_go_of_the_sets_that_it_has_written)
{
    struct local l;
    struct datadir dir;
    struct directory d = directory_new();
    uint64_t count;
    int event = eventfd(0, EFD_CLOEXEC);
    local_start(&l, 0);
    local_ask(&l, "ADD a 0 0  1 1\nADD b 2 2\n");
    CHECK(event >= 0 && datadir_open(&dir, d.path, false));
    struct snapshot *snap = snapshot_begin(&dir, &l.server.sets, 2, event);
    CHECK(snap != NULL && version_of(&l, "a")->refs == 2 && version_of(&l, "b")->refs == 2);
    snapshot_release(snap, &l.server.sets);
    CHECK(version_of(&l, "a")->refs == 2);
    snapshot_go(snap);
    CHECK(read(event, &count, sizeof count) == sizeof count && snap->done);
    snapshot_release(snap, &l.server.sets);
    CHECK(version_of(&l, "a")->refs == 1 && version_of(&l, "b")->refs == 1);
    /* In place again; and what is gone is not let go of twice. */
    CHECK_STR(local_ask(&l, "MOVE a 0 7 7\nDROP b\nGET a 0\n"), "OK 0\nOK 0\nOK 1\n0 7 7\n");
    CHECK(snapshot_end(snap, &l.server.sets) == 0 && version_of(&l, "a")->refs == 1);
    local_stop(&l);
    close(event);
    datadir_close(&dir);
    directory_remove(&d);
}
