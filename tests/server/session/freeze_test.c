/* freeze_test.c - a daemon that was stopped for a while reads the bytes that have arrived before it judges its clients. */
#include "tests/server/daemon.h"
#include "tests/test.h"

#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

enum { BEFORE_MS = 300, FROZEN_MS = 1800 };

static void stop(const struct daemon *d)
{
    int status;
    CHECK(kill(d->pid, SIGSTOP) == 0);
    CHECK(waitpid(d->pid, &status, WUNTRACED) == d->pid && WIFSTOPPED(status));
}

TEST(requests_that_arrive_while_the_daemon_is_stopped_are_carried_out)
{
    const char *arguments[] = {"--idle-timeout", "1", "--load-timeout", "1", NULL};
    struct daemon d = daemon_start(arguments);
    int idle = daemon_connect(&d), loading = daemon_connect(&d), limited = daemon_connect(&d);
    say(idle, "PING\n");
    expect(idle, "OK 0\n");
    say(limited, "PING\n");
    expect(limited, "OK 0\n");
    say(loading, "PING\nLOAD u 2\n1 1\n");
    expect(loading, "OK 0\n");
    pause_ms(BEFORE_MS);
    stop(&d);
    say(idle, "ADD t 1 1\n");
    say(loading, "2 2\n");
    say(limited, "TIMEOUT 0.5 PING\n");
    pause_ms(FROZEN_MS);
    CHECK(kill(d.pid, SIGCONT) == 0);
    expect(idle, "OK 0 first=0 added=1 coincident=0\n");
    expect(loading, "OK 0 first=0 added=2 coincident=0\n");
    expect(limited, "OK 0\n");
}

TEST(time_in_which_the_daemon_is_stopped_is_not_idle_time)
{
    const char *arguments[] = {"--idle-timeout", "3", NULL};
    struct daemon d = daemon_start(arguments);
    int fd = daemon_connect(&d);
    say(fd, "PING\n");
    expect(fd, "OK 0\n");
    pause_ms(1000);
    stop(&d);
    pause_ms(3000);
    CHECK(kill(d.pid, SIGCONT) == 0);
    pause_ms(200);
    say(fd, "PING\n");
    expect(fd, "OK 0\n");
}
