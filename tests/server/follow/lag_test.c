/* lag_test.c - what INFO replication says about a follower that has everything. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "tests/server/directory.h"
#include "tests/test.h"

static bool info_has(const struct daemon *d, const char *text)
{
    size_t n;
    int fd = daemon_connect(d);
    say(fd, "INFO replication\nQUIT\n");
    char *all = hear_all(fd, &n);
    close(fd);
    bool has = strstr(all, text) != NULL;
    free(all);
    return has;
}

/* The headers that come every second while there are no changes are acknowledged, too. */
TEST(lag_of_a_follower_that_has_everything_is_no_bytes)
{
    char address[40];
    struct directory dirs[2] = {directory_quick(), directory_quick()};
    struct daemon leader = directory_daemon(&dirs[0], NULL);
    snprintf(address, sizeof address, "127.0.0.1:%s", leader.port_text);
    const char *const follow[] = {"--follow", address, NULL};
    struct daemon follower = directory_daemon(&dirs[1], follow);
    int fd = daemon_connect(&leader);
    say(fd, "ADD t 1 1\nWAIT 1 60\n");
    CHECK(strncmp(hear_line(fd), "OK 0 first=0", 12) == 0);
    CHECK_STR(hear_line(fd), "OK 0 followers=1");
    pause_ms(1500); /* a header has come */
    for (int i = 0; i < 100 && !info_has(&leader, "lag_records=0,lag_bytes=0,"); i++)
        pause_ms(50);
    CHECK(info_has(&leader, "lag_records=0,lag_bytes=0,"));
    close(fd);
    daemon_end(&follower);
    daemon_end(&leader);
    directory_remove(&dirs[0]);
    directory_remove(&dirs[1]);
}
