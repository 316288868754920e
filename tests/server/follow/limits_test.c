/* limits_test.c - a follower whose own limits are lower than the size of its leader, and its state when it cannot continue; how
 * long a leader waits for a follower. */
#include "server/follow/link.h"
#include "tests/server/follow/node.h"
#include "tests/test.h"

#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static struct node follower_with(const struct node *leader, const char *option, const char *value)
{
    char address[32];
    snprintf(address, sizeof address, "127.0.0.1:%u", leader->d.port);
    return node_new((const char *const[]){"--follow", address, option, value, NULL});
}

static void load(const struct node *n, const char *set, unsigned points)
{
    int fd = daemon_connect(&n->d);
    load_random(fd, set, points);
    close(fd);
}

static void await_error(const struct node *n, const char *part)
{
    char why[FACT] = "";
    for (unsigned i = 0; i < node_tries() && strstr(why, part) == NULL; i++) {
        pause_ms(10);
        node_fact(n, "link_error", why);
    }
    CHECK_MSG(strstr(why, part) != NULL, "%s", why);
}

TEST_TIMEOUT(follower_has_what_its_leader_has_although_its_own_limit_of_points_is_lower, 60)
{
    struct node l = node_new(NULL), f = follower_with(&l, "--max-points", "3");
    carry_out(&l.d, "ADD a 0 0 1 0 0 1 5 5\n");
    load(&l, "large", 70000); /* several records */
    carry_out(&l.d, "ADD a 2 2\nADD a FIELDS z 3 3 1\nTRIANGULATE a\n");
    node_expect_same(&l, &f);
    CHECK(node_is(&f, "link", "receiving") && node_is(&f, "link_error", ""));
    node_end(&l);
    node_end(&f);
}

TEST_TIMEOUT(promoted_follower_has_its_own_limit_of_points, 60)
{
    struct node l = node_new(NULL), f = follower_with(&l, "--max-points", "3");
    carry_out(&l.d, "ADD a 0 0 1 0 0 1 5 5\n");
    node_expect_same(&l, &f);
    carry_out(&f.d, "FOLLOW NONE\n");
    node_expect(&f, "ADD a 7 7", "ERR TOOBIG");
    node_end(&l);
    node_end(&f);
}

/* With 4 MB there is no room for 100,000 points. */
TEST_TIMEOUT(follower_without_memory_for_a_change_says_so_and_continues_when_there_is_some, 60)
{
    struct node l = node_new(NULL);
    carry_out(&l.d, "ADD a 0 0 1 0 0 1\n");
    struct node f = follower_with(&l, "--max-memory", "4m");
    node_expect_same(&l, &f);
    load(&l, "large", 200000);
    await_error(&f, "--max-memory");
    await_error(&f, "cannot be carried out");
    node_expect(&f, "NEAREST a 0 0", "OK 1");
    CHECK(daemon_info(&f.d, "memory") < 4 << 20);
    carry_out(&f.d, "CONFIG SET max-memory 1g\n");
    node_expect_same(&l, &f);
    node_end(&l);
    node_end(&f);
}

TEST_TIMEOUT(snapshot_beyond_the_memory_limit_is_not_installed_and_comes_again_when_it_is_raised,
             60)
{
    struct node l = node_new(NULL);
    load(&l, "large", 100000);
    carry_out(&l.d, "TRIANGULATE large\n");
    struct node f = follower_with(&l, "--max-memory", "4m");
    await_error(&f, "no room in --max-memory for its snapshot");
    CHECK(node_is(&f, "lsn", "0"));
    CHECK(daemon_info(&f.d, "memory") < 4 << 20);
    carry_out(&f.d, "CONFIG SET max-memory 1g\n");
    node_expect_same(&l, &f);
    node_end(&l);
    node_end(&f);
}

TEST_TIMEOUT(temporary_set_of_a_client_gives_way_to_the_set_of_the_leader, 60)
{
    char first[128], last[128];
    struct node l = node_new(NULL), f = node_new(NULL);
    carry_out(&l.d, "ADD b 0 0\n");
    int fd = daemon_connect(&f.d);
    CHECK_STR(node_ask_on(fd, "CREATE a TEMPORARY"), "OK 0");
    CHECK(strncmp(node_ask_on(fd, "ADD a 9 9"), "OK", 2) == 0);
    node_follow(&f, &l, "");
    node_await_position(&l, &f);
    CHECK(directory_file(&f.dir, "snapshot.", 0, first));
    CHECK(strncmp(node_ask_on(fd, "POINTS a"), "OK 1", 4) == 0 &&
          strcmp(hear_line(fd), "0 9 9") == 0);
    carry_out(&l.d, "ADD a 0 0 1 0\nADD a 0 1\nTRIANGULATE a\n");
    node_expect_same(&l, &f);
    CHECK(strncmp(node_ask_on(fd, "ADD a 9 9"), "ERR READONLY", 12) == 0);
    close(fd);
    carry_out(&l.d, "ADD a 4 4\n");
    node_expect_same(&l, &f);
    CHECK(directory_file(&f.dir, "snapshot.", 0, last));
    CHECK_STR(last, first); /* no other snapshot was needed */
    node_end(&l);
    node_end(&f);
}

/* ---- a follower that does not answer ---- */

struct pair {
    struct node l, f;
};

/* A leader that needs its follower, which is then stopped: its connection stays. */
static struct pair stopped_pair(const char *timeout)
{
    struct pair p = {.l = node_new((const char *[]){"--min-followers", "1", "--follower-timeout",
                                                    timeout, NULL})};
    p.f = node_follower_of(&p.l);
    node_await_reply(&p.l, "ADD c 0 0", "OK");
    carry_out(&p.l.d, "ADD a 0 0\n");
    kill(p.f.d.pid, SIGSTOP);
    return p;
}

static void end_pair(struct pair *p)
{
    node_end(&p->l);
    node_end(&p->f);
}

TEST_TIMEOUT(changes_are_refused_when_a_follower_has_not_answered_for_its_time, 60)
{
    struct pair p = stopped_pair("1");
    int fd = daemon_connect(&p.l.d);
    const char *got = node_ask_on(fd, "ADD a 1 1");
    CHECK_STR(got, "ERR NOFOLLOWERS too few followers have the last changes, which are saved here");
    expect_end(fd);
    CHECK(node_is(&p.l, "followers", "1"));
    node_expect(&p.l, "ADD a 2 2", "ERR NOFOLLOWERS");
    node_expect(&p.l, "STAT a",
                "OK 0 points=2"); /* the first one was made, the second one was not */
    kill(p.f.d.pid, SIGCONT);
    node_await_reply(&p.l, "ADD c 3 3", "OK");
    node_expect_same(&p.l, &p.f);
    end_pair(&p);
}

TEST_TIMEOUT(follower_timeout_can_be_set_while_a_change_waits, 60)
{
    struct pair p = stopped_pair("1000000");
    int fd = daemon_connect(&p.l.d);
    say(fd, "ADD a 1 1\n");
    carry_out(&p.l.d, "CONFIG SET follower-timeout 1\n");
    CHECK(strncmp(hear_line(fd), "ERR NOFOLLOWERS", 15) == 0);
    close(fd);
    node_expect(&p.l, "CONFIG SET min-replicas-max-lag 0", "ERR RANGE");
    kill(p.f.d.pid, SIGCONT);
    end_pair(&p);
}

/* TIMEOUT would say that nothing has changed. */
TEST_TIMEOUT(time_limit_of_a_change_holds_while_it_waits_for_followers, 60)
{
    struct pair p = stopped_pair("1000000");
    int fd = daemon_connect(&p.l.d), other = daemon_connect(&p.l.d);
    say(other, "ADD b 1 1\n");
    say(fd, "PING\nTIMEOUT 0.2 ADD a 1 1\nTIMEOUT 0.3 ADD a 2 2\nPING\n");
    CHECK_STR(hear_line(fd), "OK 0");
    CHECK_STR(hear_line(fd),
              "ERR NOFOLLOWERS too few followers have the last changes, which are saved here");
    expect_end(fd);
    carry_out(&p.l.d, "CONFIG SET min-followers 0\n");
    CHECK(strncmp(hear_line(other), "OK 0 first=0", 12) == 0); /* which has no limit */
    node_expect(&p.l, "STAT a", "OK 0 points=3");
    close(other);
    kill(p.f.d.pid, SIGCONT);
    node_expect_same(&p.l, &p.f);
    end_pair(&p);
}

TEST_TIMEOUT(time_limit_of_a_change_that_followers_have_in_time_does_not_end_a_later_one, 60)
{
    struct pair p = stopped_pair("1000000");
    int fd = daemon_connect(&p.l.d);
    say(fd, "TIMEOUT 2 ADD a 1 1\n");
    pause_ms(100);
    kill(p.f.d.pid, SIGCONT);
    CHECK(strncmp(hear_line(fd), "OK 0 first=1", 12) == 0);
    kill(p.f.d.pid, SIGSTOP);
    say(fd, "ADD a 2 2\n");
    pause_ms(2500); /* the limit is over */
    kill(p.f.d.pid, SIGCONT);
    CHECK(strncmp(hear_line(fd), "OK 0 first=2", 12) == 0);
    close(fd);
    end_pair(&p);
}

/* ---- pauses ---- */

TEST(pause_doubles_up_to_three_seconds_or_up_to_thirty_if_a_transfer_would_be_repeated)
{
    int plain = LINK_FIRST_PAUSE_MS, costly = LINK_FIRST_PAUSE_MS;
    for (int i = 1; i <= 10; i++) {
        plain = link_pause(plain, false, 0);
        costly = link_pause(costly, true, 0);
        int doubled = LINK_FIRST_PAUSE_MS << i;
        CHECK_MSG(plain == (doubled < 3000 ? doubled : 3000), "%d: %d", i, plain);
        CHECK_MSG(costly == (doubled < 30000 ? doubled : 30000), "%d: %d", i, costly);
    }
    CHECK(link_pause(costly, false, 0) == 3000); /* the leader has been reached: it is tried soon */
}

/* A leader that accepts a follower and disconnects it at once is not asked ten times a second. */
TEST(pause_is_short_again_only_after_a_connection_that_has_lasted)
{
    CHECK(link_pause(800, false, 100) == 1600);
    CHECK(link_pause(800, false, 3001) == LINK_FIRST_PAUSE_MS);
    CHECK(link_pause(3000, false, 6000) == 3000);
    CHECK(link_pause(3000, false, 6001) == LINK_FIRST_PAUSE_MS);
    CHECK(link_pause(30000, true, 50000) == 30000);
    CHECK(link_pause(30000, true, 60001) == LINK_FIRST_PAUSE_MS);
}
