/* follow_test.c - a daemon that follows another one: it has the same sets, however the connection, it or its leader
 * ends; and which of two daemons accepts changes. */
#include "server/changes/change.h"
#include "tests/faults/tree.h"
#include "tests/server/follow/node.h"
#include "tests/test.h"

#include <inttypes.h>
#include <signal.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

/* ---- what it gets ---- */

enum { LARGE = 70000 };

/* The rows of the set's lattice become lines, and a part of them is released, in several records each. */
static void constrain_large(const struct node *n)
{
    uint32_t *pair = malloc(2 * LARGE * sizeof *pair), pairs = 0;
    char line[100];
    int fd = daemon_connect(&n->d);
    CHECK(pair != NULL);
    for (uint32_t i = 0; i + 1 < LARGE; i++) {
        if (i % 300 == 299)
            continue;
        pair[2 * pairs] = i + 1;
        pair[2 * pairs++ + 1] = i;
    }
    snprintf(line, sizeof line, "CONSTRAINB large OF 5 %" PRIu32 "\n", pairs);
    say(fd, line);
    say_bytes(fd, pair, pairs * 2 * sizeof *pair);
    CHECK(strncmp(hear_line(fd), "OK 0 added=", 11) == 0);
    pairs -= 100;
    snprintf(line, sizeof line, "RELEASEB large OF 5 %" PRIu32 "\n", pairs);
    say(fd, line);
    say_bytes(fd, pair, pairs * 2 * sizeof *pair);
    CHECK(strncmp(hear_line(fd), "OK 0 released=", 14) == 0);
    close(fd);
    free(pair);
}

/* A set whose LOAD and whose values need several records. */
static void load_large(const struct node *n)
{
    char *text = malloc(LARGE * 40 + 100), *to = text;
    CHECK(text != NULL);
    to += sprintf(to, "LOAD large FIELDS z,w\n");
    for (unsigned i = 0; i < LARGE; i++)
        to += sprintf(to, "%u %u %u.5 %s\n", i % 300, i / 300, i, i % 3 == 0 ? "nan" : "-1e300");
    strcpy(to, ".\n");
    carry_out(&n->d, text);
    double *v = malloc(LARGE * sizeof *v);
    CHECK(v != NULL);
    for (unsigned i = 0; i < LARGE; i++)
        v[i] = i * 0.1;
    int fd = daemon_connect(&n->d);
    sprintf(text, "FSETB large y 0 %d\n", LARGE);
    say(fd, text);
    say_bytes(fd, v, LARGE * sizeof *v);
    CHECK(strncmp(hear_line(fd), "OK", 2) == 0);
    close(fd);
    free(v);
    free(text);
    constrain_large(n);
}

/* Every kind of change (check_everything); no snapshot begins another log. */
static void change_everything(const struct node *n)
{
    carry_out(
        &n->d,
        "CREATE c TOL 0.5\nCREATE d\nADD a 0 0 1 0 0 1 5 5 5 5\nADD gone 1 1\nEXPIRE gone 1000\n"
        "ADD c 0 0 0.3 0 1 1\nTRIANGULATE a\nMOVE a 1 2 2\nDEL a 2\nEXPIRE c 1000\n"
        "FSET a z 0 1.5 1 nan\nFSET a w 3 7\nFDROP a w\nADD a FIELDS z,q 8 8 1 2\n"
        "LOAD b 3 FIELDS z\n1 2 3\n4 5 nan\n7 8 9\nTRIANGULATE b METHOD shelling\n"
        "TRIANGULATE d\nPERSIST gone\nDROP gone\nDROP d\nCREATE d\n"
        "CONSTRAIN a OF 7 0 1 1 3\nCONSTRAIN b BORDER RING 0 1 2\nRELEASE b BORDER 0 1\n"
        "MOVE a 0 0 1 1 3 2\nCONSTRAIN a 5 0\nRELEASE a OF 7\nDEL a 5 CASCADE\n"
        "CONSTRAIN a OF 2 3 4\nCONSTRAIN b 0 1\nRELEASE b ALL\nCONSTRAIN b OF 3 PATH 2 0 1\n"
        "ADD x FIELDS z,w 0 0 1 2 9 9 3 4 0 9 5 6 9 0 7 nan 0 4 0 0 9 5 0 0\nCONSTRAIN x 0 1\n"
        "CONSTRAIN x SPLIT OF 3 2 3\nTRIANGULATE x\nCONSTRAIN x SPLIT BORDER 4 5\n"
        "CONSTRAIN x SPLIT 4 5\nCONSTRAIN x SPLIT 0 2\n"
        "LOAD x 5 PATHS OF 4 SPLIT FIELDS v\n1 7 1\n9 2 2\n> b\n0 1 3\n9 8 4\n"
        "SIMPLIFY x z ERROR 1 IDS id INTO y\nSIMPLIFY b z ERROR 0 INTO z\n"
        "LOAD x PATHS BORDER\n20 20\n21 20\n20 21\n20 20\n.\nLOAD x 1 PATHS\n30 30\n");
}

/* Notes which types of records the file has. */
static void note_types(const char *path, bool seen[RECORD_TYPES])
{
    size_t n;
    struct segment header;
    struct record r;
    char *bytes = file_read(path, &n);
    ptrdiff_t took = segment_read(bytes, n, &header);
    CHECK(took > 0);
    for (size_t at = (size_t)took; (took = record_read(bytes + at, n - at, &r)) > 0;
         at += (size_t)took)
        seen[r.type] = true;
    free(bytes);
}

/* The log of a leader with everything has records of every kind of change. */
static void check_everything(const struct node *n)
{
    bool seen[RECORD_TYPES] = {false};
    char path[128];
    for (unsigned i = 0; directory_file(&n->dir, "log.", i, path); i++)
        note_types(path, seen);
    for (unsigned code = CHANGE_NONE + 1; code < CHANGE_KINDS; code++) {
        enum record_type type = change_kinds[code].record;
        CHECK_MSG(type == 0 || seen[type],
                  "change_everything makes no change of kind %u, whose record has type %u", code,
                  type);
    }
}

TEST_TIMEOUT(follower_gets_every_kind_of_change, 60)
{
    struct node l = node_new(NULL), f = node_follower_of(&l);
    node_await(&l, "followers", "1");
    change_everything(&l);
    check_everything(&l);
    node_expect_same(&l, &f);
    load_large(&l);
    node_expect_same(&l, &f);
    carry_out(&l.d, "FDROP large z\nTRIANGULATE large\nEXPIRE b 0.05\n");
    await_info(&l.d, "sets", 7);
    carry_out(&l.d, "ADD b 1 1\nDROP c\nDEL a 0 1\nFDROP a q\n");
    node_expect_same(&l, &f);
    CHECK(node_is(&f, "role", "follower") && node_is(&f, "link", "receiving"));
    node_expect(&f, "POINTS a", "OK");
    node_end(&l);
    node_end(&f);
}

TEST_TIMEOUT(follower_that_comes_later_gets_every_kind_of_change_as_a_snapshot, 60)
{
    struct node l = node_new(NULL);
    change_everything(&l);
    load_large(&l);
    struct node f = node_follower_of(&l);
    node_expect_same(&l, &f);
    CHECK(node_has_snapshot(&f));
    carry_out(&l.d, "ADD b 3 3\nMOVE large 5 1000 1000\n");
    node_expect_same(&l, &f);
    daemon_stop(&f.d, SIGKILL);
    node_start(&f, NULL); /* its directory says whom it follows */
    node_expect_same(&l, &f);
    node_end(&l);
    node_end(&f);
}

TEST_TIMEOUT(follower_refuses_changes_and_says_who_the_leader_is, 60)
{
    struct node l = node_new(NULL), f = node_follower_of(&l);
    char want[64];
    carry_out(&l.d, "ADD a 0 0\n");
    node_expect_same(&l, &f);
    snprintf(want, sizeof want, "ERR READONLY leader=127.0.0.1:%u", l.d.port);
    static const char *const changes[] = {
        "ADD a 1 1",    "CREATE b",        "DROP a",        "DEL a 0",
        "MOVE a 0 3 3", "TRIANGULATE a",   "FSET a z 0 1",  "EXPIRE a 100",
        "FDROP a z",    "CONSTRAIN a 0 0", "RELEASE a ALL", "SIMPLIFY a z ERROR 1 INTO b"};
    for (size_t i = 0; i < sizeof changes / sizeof changes[0]; i++)
        CHECK_STR(node_ask(&f, changes[i]), want);
    node_expect(&f, "SYNC 1.1.1 0 0000000000000000", want);
    node_expect_same(&l, &f);
    node_end(&l);
    node_end(&f);
}

/* ---- restarts ---- */

TEST_TIMEOUT(follower_continues_after_restarts_without_a_transfer, 60)
{
    struct node l = node_new(NULL), f = node_follower_of(&l);
    carry_out(&l.d, "ADD a 0 0 1 0\n");
    node_expect_same(&l, &f);
    for (int i = 0; i < 4; i++) {
        struct node *n = i % 2 == 0 ? &f : &l;
        daemon_stop(&n->d, i < 2 ? SIGTERM : SIGKILL);
        if (n == &f)
            carry_out(&l.d, "ADD a 3 3\nADD b 4 4\n");
        node_start(n, NULL);
        carry_out(&l.d, "ADD a 5 5\nTRIANGULATE b\n");
        node_expect_same(&l, &f);
    }
    char path[128];
    CHECK(!directory_file(&l.dir, "snapshot.", 1, path));
    node_end(&l);
    node_end(&f);
}

TEST_TIMEOUT(follower_gets_a_snapshot_when_the_log_does_not_reach_back, 60)
{
    struct node l = node_new((const char *const[]){"--keep-log", "1", NULL}),
                f = node_follower_of(&l);
    carry_out(&l.d, "ADD a 0 0 1 0\nADD b 1 1\n");
    node_expect_same(&l, &f);
    daemon_stop(&f.d, SIGTERM);
    carry_out(&l.d, "DROP b\nADD a 7 7\nADD c 1 1\nSNAPSHOT\n");
    for (unsigned i = 0; i < 3; i++) {
        await_info(&l.d, "snapshot_running", 0);
        carry_out(&l.d, "ADD a 8 8\nSNAPSHOT\n");
    }
    await_info(&l.d, "snapshot_running", 0);
    node_start(&f, NULL);
    node_expect_same(&l, &f);
    daemon_stop(&f.d, SIGKILL);
    node_start(&f, NULL);
    node_expect_same(&l, &f);
    carry_out(&l.d, "ADD a 9 9\n");
    node_expect_same(&l, &f);
    node_end(&l);
    node_end(&f);
}

/* The leader has a new snapshot and has been restarted meanwhile, twice. */
TEST_TIMEOUT(log_stays_for_a_follower_that_is_stopped_while_its_leader_restarts, 60)
{
    struct node l = node_new(NULL), f = node_follower_of(&l);
    char before[128] = "", after[128] = "";
    carry_out(&l.d, "ADD a 0 0\n");
    node_expect_same(&l, &f);
    daemon_stop(&f.d, SIGTERM);
    directory_file(&f.dir, "snapshot.", 0, before);
    for (int i = 0; i < 3; i++) {
        carry_out(&l.d, "ADD a 7 7\nSNAPSHOT\n");
        await_info(&l.d, "snapshot_running", 0);
        carry_out(&l.d, "ADD a 8 8\n");
        daemon_stop(&l.d, i == 1 ? SIGTERM : SIGKILL);
        node_start(&l, NULL);
    }
    node_start(&f, NULL);
    node_expect_same(&l, &f);
    directory_file(&f.dir, "snapshot.", 0, after);
    CHECK_STR(after, before); /* it has not received any */
    node_end(&l);
    node_end(&f);
}

TEST_TIMEOUT(setting_of_keep_log_holds_for_the_next_snapshot, 60)
{
    struct node l = node_new(NULL), f = node_follower_of(&l);
    char path[128];
    carry_out(&l.d, "ADD a 0 0\n");
    node_expect_same(&l, &f);
    carry_out(&l.d, "SNAPSHOT\n");
    await_info(&l.d, "snapshot_running", 0);
    CHECK(directory_file(&l.dir, "log.", 1, path));
    carry_out(&l.d, "CONFIG SET keep-log 1\nADD a 1 1\nSNAPSHOT\n");
    await_info(&l.d, "snapshot_running", 0);
    CHECK(!directory_file(&l.dir, "log.", 1, path));
    node_end(&l);
    node_end(&f);
}

/* ---- promotion ---- */

TEST_TIMEOUT(promoted_follower_accepts_changes_and_its_former_leader_refuses_them, 60)
{
    struct node l = node_new(NULL), f = node_follower_of(&l);
    carry_out(&l.d, "ADD a 0 0 1 0\n");
    node_expect_same(&l, &f);
    carry_out(&f.d, "FOLLOW NONE\nADD a 2 2\n");
    CHECK(node_is(&f, "role", "leader"));
    node_await(&l, "role", "fenced");
    node_expect(&l, "ADD a 3 3", "ERR READONLY there is a newer history");
    daemon_stop(&l.d, SIGKILL);
    node_start(&l, NULL);
    node_expect(&l, "ADD a 3 3", "ERR READONLY there is a newer history");
    daemon_stop(&f.d, SIGKILL);
    node_start(&f, NULL);
    carry_out(&f.d, "ADD b 2 2\n");
    node_follow(&l, &f, "");
    node_expect_same(&f, &l);
    node_expect(&l, "ADD a 3 3", "ERR READONLY leader=");
    node_end(&l);
    node_end(&f);
}

TEST_TIMEOUT(former_leader_with_changes_of_its_own_follows_only_with_confirm, 60)
{
    struct node l = node_new(NULL), f = node_follower_of(&l);
    carry_out(&l.d, "ADD a 0 0 1 0\n");
    node_expect_same(&l, &f);
    daemon_stop(&f.d, SIGKILL);
    carry_out(&l.d, "ADD a 9 9\n");
    daemon_stop(&l.d, SIGKILL);
    node_start(&f, NULL);
    carry_out(&f.d, "FOLLOW NONE\nADD a 2 2\nADD b 1 1\n");
    node_start(&l, NULL);
    node_await(&l, "role", "fenced");
    node_follow(&l, &f, "");
    node_await(&l, "link", "refused");
    node_expect(&l, "STAT a", "OK 0 points=3");
    node_expect(&f, "STAT a", "OK 0 points=3");
    daemon_stop(&l.d, SIGTERM);
    node_start(&l, NULL);
    node_await(&l, "link", "refused");
    node_follow(&l, &f, " CONFIRM");
    node_expect_same(&f, &l);
    carry_out(&f.d, "ADD b 5 5\n");
    node_expect_same(&f, &l);
    node_end(&l);
    node_end(&f);
}

TEST_TIMEOUT(fenced_leader_accepts_changes_again_after_follow_none, 60)
{
    struct node l = node_new(NULL), f = node_follower_of(&l);
    carry_out(&l.d, "ADD a 0 0 1 0\n");
    node_expect_same(&l, &f);
    carry_out(&f.d, "FOLLOW NONE\n");
    node_await(&l, "role", "fenced");
    carry_out(&l.d, "FOLLOW NONE\nADD a 3 3\n");
    CHECK(node_is(&l, "role", "leader"));
    daemon_stop(&l.d, SIGKILL);
    node_start(&l, NULL);
    carry_out(&l.d, "ADD a 4 4\n");
    node_end(&l);
    node_end(&f);
}

/* ---- refusals ---- */

TEST_TIMEOUT(leader_that_has_lost_its_data_is_refused, 60)
{
    struct node l = node_new(NULL), f = node_follower_of(&l);
    carry_out(&l.d, "ADD a 0 0 1 0\n");
    node_expect_same(&l, &f);
    daemon_stop(&l.d, SIGKILL);
    tree_remove(l.dir.path);
    l.dir = directory_quick();
    node_start(&l, NULL);
    carry_out(&l.d, "ADD z 0 0\nADD z 1 1\nADD z 2 2\nADD z 3 3\n");
    node_await(&f, "link", "refused");
    node_expect(&f, "STAT a", "OK 0 points=2");
    node_follow(&f, &l, " CONFIRM");
    node_expect_same(&l, &f);
    node_expect(&f, "STAT a", "ERR NOSET");
    node_expect(&f, "STAT z", "OK 0 points=4");
    node_end(&l);
    node_end(&f);
}

/* Both have a history of their own. */
TEST_TIMEOUT(daemon_with_changes_of_its_own_does_not_give_them_up_unasked, 60)
{
    struct node l = node_new(NULL), f = node_new(NULL);
    carry_out(&l.d, "ADD a 0 0 1 0\n");
    carry_out(&f.d, "ADD a 5 5\n");
    node_follow(&f, &l, "");
    node_await(&f, "link", "refused");
    node_expect(&f, "STAT a", "OK 0 points=1");
    carry_out(&f.d, "FOLLOW NONE\nADD a 6 6\n");
    node_expect(&f, "STAT a", "OK 0 points=2");
    node_expect(&l, "ADD a 3 3", "OK"); /* of another origin: the leader is not fenced */
    node_follow(&f, &l, " CONFIRM");
    node_expect_same(&l, &f);
    node_end(&l);
    node_end(&f);
}

TEST(follow_needs_an_address_a_port_and_a_data_directory)
{
    struct node n = node_new(NULL);
    node_expect(&n, "FOLLOW somewhere 1", "ERR SYNTAX");
    node_expect(&n, "FOLLOW 127.0.0.1 0", "ERR NUMBER");
    node_expect(&n, "FOLLOW 127.0.0.1 65536", "ERR NUMBER");
    node_expect(&n, "FOLLOW 127.0.0.1 1 PLEASE", "ERR SYNTAX");
    node_expect(&n, "FOLLOW 127.0.0.1", "ERR SYNTAX");
    node_expect(&n, "FOLLOW NONE", "OK 0");
    node_expect(&n, "SYNC 1.1 0 0000000000000000", "ERR SYNTAX");
    node_expect(&n, "SYNC 1.1.1 -1 0000000000000000", "ERR SYNTAX");
    node_expect(&n, "SYNC 1.1.1 0 0", "ERR SYNTAX");
    node_expect(&n, "ADD a 1 1", "OK");
    node_end(&n);
}

/* ---- WAIT and --min-followers ---- */

TEST_TIMEOUT(wait_says_how_many_followers_have_the_changes_of_the_connection, 60)
{
    struct node l = node_new(NULL), f = node_follower_of(&l);
    node_await(&l, "followers", "1");
    int fd = daemon_connect(&l.d);
    for (int i = 0; i < 50; i++) {
        CHECK(strncmp(node_ask_on(fd, "ADD a 1 2"), "OK", 2) == 0);
        CHECK_STR(node_ask_on(fd, "WAIT 1 60"), "OK 0 followers=1");
    }
    daemon_stop(&f.d, SIGKILL); /* it has everything that WAIT has confirmed */
    node_await(&l, "followers", "0");
    CHECK_STR(node_ask_on(fd, "WAIT 1 0.01"), "OK 0 followers=0");
    CHECK_STR(node_ask_on(fd, "WAIT 0 60"), "OK 0 followers=0");
    close(fd);
    daemon_stop(&l.d, SIGKILL);
    node_start(&f, NULL);
    node_expect(&f, "STAT a", "OK 0 points=50");
    node_start(&l, NULL);
    node_expect_same(&l, &f);
    node_end(&l);
    node_end(&f);
}

TEST_TIMEOUT(changes_are_refused_while_there_are_too_few_followers, 60)
{
    struct node l = node_new((const char *const[]){"--min-followers", "1", NULL});
    node_await_reply(&l, "ADD b 0 0", "ERR NOFOLLOWERS");
    struct node f = node_follower_of(&l);
    node_await_reply(&l, "ADD b 0 0", "OK");
    carry_out(&l.d, "ADD a 1 1\nADD a 2 2\n");
    node_expect_same(&l, &f);
    node_end(&f);
    node_await_reply(&l, "ADD b 0 0", "ERR NOFOLLOWERS");
    node_expect(&l, "ADD a 1 1", "ERR NOFOLLOWERS");
    node_expect(&l, "STAT a", "OK 0 points=2");
    carry_out(&l.d, "CONFIG SET min-followers 0\nADD a 3 3\n");
    node_end(&l);
}

/* A leader whose follower is stopped, and a connection with a change that waits for it. */
static int wait_for_stopped(const struct node *l, const struct node *f)
{
    char text[FACT];
    node_await_reply(l, "ADD b 0 0", "OK");
    node_fact(l, "lsn", text);
    snprintf(text, sizeof text, "%lu", strtoul(text, NULL, 10) + 1);
    kill(f->d.pid, SIGSTOP);
    int fd = daemon_connect(&l->d);
    say(fd, "ADD a 5 5\n");
    node_await(l, "lsn", text);
    return fd;
}

TEST_TIMEOUT(setting_of_min_followers_holds_for_the_next_request_and_for_what_waits, 60)
{
    struct node l = node_new((const char *const[]){"--min-followers", "1", NULL});
    node_await_reply(&l, "ADD b 0 0", "ERR NOFOLLOWERS");
    carry_out(&l.d, "CONFIG SET min-followers 0\nADD b 0 0\n");
    node_end(&l);
    l = node_new((const char *const[]){"--min-followers", "1", NULL});
    struct node f = node_follower_of(&l);
    int fd = wait_for_stopped(&l, &f);
    node_expect(&l, "CONFIG SET min-followers 0", "OK");
    CHECK(strncmp(hear_line(fd), "OK 0 first=0", 12) == 0);
    close(fd);
    daemon_stop(&f.d, SIGKILL);
    node_end(&l);
    tree_remove(f.dir.path);
}

/* The promoted follower does not have it. */
TEST_TIMEOUT(change_that_waits_for_followers_is_not_acknowledged_when_its_leader_is_replaced, 60)
{
    for (int i = 0; i < 2; i++) {
        struct node l = node_new((const char *const[]){"--min-followers", "1", NULL});
        struct node f = node_follower_of(&l);
        char history[FACT], line[FACT + 40];
        int fd = wait_for_stopped(&l, &f);
        node_fact(&l, "history", history);
        snprintf(line, sizeof line, "SYNC %.16s.2.1 0 0000000000000000", history);
        node_expect(&l, i == 0 ? line : "FOLLOW 127.0.0.1 1", i == 0 ? "ERR READONLY" : "OK");
        const char *got = hear_line(fd);
        CHECK_MSG(strncmp(got, "ERR NOFOLLOWERS", 15) == 0, "%s", got);
        node_expect(&l, "STAT a", "OK 0 points=1"); /* which does not wait */
        close(fd);
        daemon_stop(&f.d, SIGKILL);
        node_end(&l);
        tree_remove(f.dir.path);
    }
}

/* Whether the leader knows that one of two followers has all its changes. */
static bool one_has_all(const struct node *l)
{
    char value[FACT], last[FACT], want[FACT + 10];
    bool has = false;
    node_fact(l, "lsn", last);
    snprintf(want, sizeof want, ",lsn=%s,", last);
    for (int i = 1; i <= 2; i++) {
        node_fact(l, i == 1 ? "follower_1" : "follower_2", value);
        has = has || strstr(value, want) != NULL;
    }
    return has;
}

/* With two followers of which one does not answer. */
TEST_TIMEOUT(change_waits_for_all_the_followers_that_are_needed, 60)
{
    struct node l = node_new((const char *const[]){"--min-followers", "2", NULL}),
                f = node_follower_of(&l), other = node_follower_of(&l);
    char byte;
    node_await_reply(&l, "ADD b 0 0", "OK");
    kill(other.d.pid, SIGSTOP);
    int fd = daemon_connect(&l.d);
    say(fd, "ADD a 1 1\n");
    node_await_reply(&f, "STAT a", "OK 0 points=1");
    for (unsigned i = 0; i < node_tries() && !one_has_all(&l); i++)
        pause_ms(10);
    CHECK(one_has_all(&l));
    CHECK(recv(fd, &byte, 1, MSG_DONTWAIT) < 0);
    kill(other.d.pid, SIGCONT);
    CHECK(strncmp(hear_line(fd), "OK", 2) == 0);
    close(fd);
    node_end(&l);
    node_end(&f);
    node_end(&other);
}

TEST_TIMEOUT(nothing_acknowledged_is_lost_with_the_leader, 60)
{
    enum { CHANGES = 300 };
    struct node l = node_new((const char *const[]){"--min-followers", "1", NULL}),
                f = node_follower_of(&l);
    node_await(&l, "followers", "1");
    int fd = daemon_connect(&l.d), acknowledged = 0;
    for (; acknowledged < CHANGES; acknowledged++)
        CHECK(strncmp(node_ask_on(fd, "ADD a 1 2"), "OK", 2) == 0);
    for (int i = 0; i < 20; i++)
        say(fd, "ADD a 1 2\n"); /* these may be lost, or not */
    daemon_stop(&l.d, SIGKILL);
    close(fd);
    tree_remove(l.dir.path);
    daemon_stop(&f.d, SIGKILL);
    node_start(&f, NULL);
    carry_out(&f.d, "FOLLOW NONE\nADD b 1 1\n");
    unsigned points;
    CHECK(sscanf(node_ask(&f, "STAT a"), "OK 0 points=%u", &points) == 1);
    CHECK_MSG(points >= CHANGES && points <= CHANGES + 20, "%u points", points);
    node_end(&f);
}

/* ---- tokens ---- */

TEST_TIMEOUT(follower_of_a_leader_with_tokens_needs_one_that_may_write, 60)
{
    static const char tokens[] = "rw secret\nro reader\n";
    static const char *const token[] = {"reader\n", "wrong\n", "secret\n"};
    struct directory files = directory_quick();
    char auth_file[100], token_file[100], address[32];
    snprintf(auth_file, sizeof auth_file, "%s/tokens", files.path);
    snprintf(token_file, sizeof token_file, "%s/token", files.path);
    file_write(auth_file, tokens, strlen(tokens));
    struct node l = node_new(NULL);
    carry_out(&l.d, "ADD a 1 1\nADD a 2 2\n");
    daemon_stop(&l.d, SIGKILL);
    l.d = daemon_start((const char *const[]){"--data", l.dir.path, "--port", l.d.port_text,
                                             "--auth-file", auth_file, NULL});
    snprintf(address, sizeof address, "127.0.0.1:%u", l.d.port);
    for (int i = 0; i < 3; i++) {
        file_write(token_file, token[i], strlen(token[i]));
        struct node f = node_new(
            (const char *const[]){"--follow", address, "--follow-token-file", token_file, NULL});
        if (i == 2)
            node_await(&f, "lsn", "2");
        for (unsigned k = 0; i < 2 && k < node_tries() && node_is(&f, "link_error", ""); k++)
            pause_ms(10);
        char why[FACT];
        node_fact(&f, "link_error", why);
        CHECK_MSG((strncmp(why, i == 0 ? "DENIED" : "ERR DENIED", 6) == 0) == (i < 2), "%s", why);
        node_end(&f);
    }
    daemon_end(&l.d);
    tree_remove(l.dir.path);
    tree_remove(files.path);
}
