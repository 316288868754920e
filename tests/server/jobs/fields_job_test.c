/* fields_job_test.c - FIELDS of a set that is too large for a reactor. */
#include "core/delaunay_fields.h"
#include "tests/server/local.h"
#include "tests/test.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The page summaries of 64 fields. */
TEST_TIMEOUT(fields_of_a_large_set_are_summed_up_by_a_worker, 60)
{
    enum { MANY = 170000 };
    char *text = malloc(MANY * 16 + 10000), *to = text + sprintf(text, "LOAD t\n");
    CHECK(text != NULL);
    for (int i = 0; i < MANY; i++)
        to += sprintf(to, "%d %d\n", i % 1000, i / 1000);
    to += sprintf(to, ".\n");
    for (int i = 0; i < DT_MAX_FIELDS; i++)
        to += sprintf(to, "FSET t f%d 0 %d %d 7\n", i, i, MANY - 1);
    struct local l[2];
    char *reply[2];
    for (unsigned k = 0; k < 2; k++) {
        local_start(&l[k], 2 * k);
        local_ask(&l[k], text);
        uint64_t jobs = l[k].server.count.jobs;
        reply[k] = strdup(local_ask(&l[k], "FIELDS t\n"));
        CHECK(l[k].server.count.jobs == jobs + k);
        CHECK(reply[k] != NULL && strncmp(reply[k], "OK 64\nf0 2 0 7\n", 15) == 0);
    }
    CHECK_STR(reply[1], reply[0]);
    for (unsigned k = 0; k < 2; k++) {
        free(reply[k]);
        local_stop(&l[k]);
    }
    free(text);
}
