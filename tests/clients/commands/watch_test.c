/* watch_test.c - `delaunay watch` prints events as they come. */
#include <stdlib.h>

#include "tests/clients/cli.h"
#include "tests/clients/peer.h"
#include "tests/test.h"

static void send_events(int fd)
{
    char line[100];
    peer_hear(fd, line, sizeof line);
    CHECK_STR(line, "watch t SINCE 6");
    peer_say(fd, "OK 0 version=7\nEVENT 2 set=t version=7 reset more\npoint 0 1 2.5\nlist 0 b\n");
    peer_say(fd, "EVENT 1 set=t version=8\ngone 0\nEVENT 0 set=t dropped\n");
}

static void send_a_part(int fd)
{
    char line[100];
    peer_hear(fd, line, sizeof line);
    peer_say(fd, "OK 0 version=7\nEVENT 2 set=t version=7 reset\npoint 0 1 2\n");
}

TEST(watch_prints_the_events_of_a_set_until_it_is_dropped)
{
    char port[8];
    int status;
    peer_start(port, send_events);
    CHECK_STR(peer_shell(&status, "%s -p %s watch t SINCE 6 2>&1", getenv("DELAUNAY"), port),
              "OK 0 version=7\nEVENT 2 set=t version=7 reset more\npoint 0 1 2.5\nlist 0 b\n"
              "EVENT 1 set=t version=8\ngone 0\nEVENT 0 set=t dropped\n");
    CHECK(status == 0);
}

TEST(watch_prints_an_object_for_each_event)
{
    char port[8];
    int status;
    peer_start(port, send_events);
    CHECK_STR(peer_shell(&status, "%s -p %s --json watch t SINCE 6 2>&1", getenv("DELAUNAY"), port),
              "{\"ok\":true,\"version\":7,\"rows\":[]}\n"
              "{\"ok\":true,\"set\":\"t\",\"version\":7,\"reset\":true,\"more\":true,"
              "\"rows\":[[\"point\",0,1,2.5],[\"list\",0,\"b\"]]}\n"
              "{\"ok\":true,\"set\":\"t\",\"version\":8,\"rows\":[[\"gone\",0]]}\n"
              "{\"ok\":true,\"set\":\"t\",\"dropped\":true,\"rows\":[]}\n");
    CHECK(status == 0);
}

TEST(watch_reports_a_lost_connection_and_a_refusal)
{
    char port[8];
    int status;
    peer_start(port, send_a_part);
    CHECK_STR(peer_shell(&status, "%s -p %s watch t 2>/dev/null", getenv("DELAUNAY"), port),
              "OK 0 version=7\nEVENT 2 set=t version=7 reset\npoint 0 1 2\n");
    CHECK(status == 3);
    cli_begin();
    CHECK_STR(cli_run(&status, "watch none"), "ERR NOSET there is no set none\n");
    CHECK(status == 1);
    cli_run(&status, "watch");
    CHECK(status == 2);
    cli_finish();
}

TEST(watch_follows_a_daemon)
{
    int status;
    const char *port;
    cli_begin();
    cli_run_well("add t 0 0 4 0 0 4");
    port = cli_daemon.port_text;
    CHECK_STR(peer_shell(&status,
                         "%s -p %s watch t | { head -n 5 | sed 's/version=.*/v/'; %s -p %s drop t "
                         ">&2; cat >&2; } 2>/dev/null",
                         getenv("DELAUNAY"), port, getenv("DELAUNAY"), port),
              "OK 0 v\nEVENT 3 set=t v\npoint 0 0 0\npoint 1 4 0\npoint 2 0 4\n");
    cli_finish();
}
