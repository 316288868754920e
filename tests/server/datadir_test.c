/* datadir_test.c - the data directory itself. */
#include "server/datadir.h"

#include "tests/server/directory.h"
#include "tests/server/file_calls.h"
#include "tests/test.h"

#include <errno.h>
#include <unistd.h>

/* Even where it was there already: whoever made it may have been killed before that. */
TEST(data_directory_is_synced_into_its_parent)
{
    struct directory parent = directory_new();
    struct datadir d;
    char path[100];
    snprintf(path, sizeof path, "%s/data", parent.path);
    for (int i = 0; i < 2; i++) {
        calls_watch(path);
        CHECK(datadir_open(&d, path, true));
        CHECK_STR(calls_text(), "sync ..\n");
        datadir_close(&d);
    }
    calls_fail("sync ..", 1, 1, EIO);
    CHECK(!datadir_open(&d, path, true) && d.fd < 0);
    CHECK(rmdir(path) == 0);
    directory_remove(&parent);
}
