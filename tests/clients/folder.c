/* folder.c - see folder.h. */
#include "tests/clients/folder.h"

#include <stdio.h>
#include <stdlib.h>

#include "tests/clients/peer.h"
#include "tests/test.h"

char folder[64];

void folder_begin(void)
{
    CHECK(getenv("DELAUNAY") != NULL);
    snprintf(folder, sizeof folder, "/tmp/delaunay_folder_XXXXXX");
    CHECK(mkdtemp(folder) != NULL);
}

void folder_finish(void)
{
    int status;
    peer_shell(&status, "rm -r %s", folder);
}

const char *folder_run(int *status, const char *command)
{
    return peer_shell(status,
                      "D=$(realpath %s) DELAUNAYD=$(realpath %s) DELAUNAY_PORT=1 && "
                      "export D DELAUNAYD DELAUNAY_PORT && cd %s && { %s; } 2>&1",
                      getenv("DELAUNAY"), getenv("DELAUNAYD"), folder, command);
}

void folder_expect(const char *command, const char *want)
{
    int status;
    const char *got = folder_run(&status, command);
    CHECK_STR(got, want);
    CHECK_MSG(status == 0, "%s: status %d", command, status);
}
