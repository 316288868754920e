/* follow_test.c - a daemon that follows another one: it has the same sets, however the connection, it or its leader
 * ends; and which of two daemons accepts changes. */
#include "tests/faults/tree.h"
#include "tests/server/directory.h"
#include "tests/test.h"

#include <inttypes.h>
#include <signal.h>
#include <string.h>
#include <unistd.h>

/* ---- a daemon and its directory ---- */

struct node {
    struct directory dir;
    struct daemon d;
};

/* Starts the daemon again, on the port that it had. */
static void start(struct node *n, const char *const *arguments)
{
    const char *all[10] = {"--port", n->d.port_text};
    for (size_t i = 0; arguments != NULL && arguments[i] != NULL && i < 7; i++)
        all[2 + i] = arguments[i];
    n->d = directory_daemon(&n->dir, all);
}

static struct node node_new(const char *const *arguments)
{
    struct node n = {.dir = directory_quick()};
    strcpy(n.d.port_text, "0");
    start(&n, arguments);
    return n;
}

/* A new follower. */
static struct node follower_of(const struct node *leader)
{
    char address[32];
    snprintf(address, sizeof address, "127.0.0.1:%u", leader->d.port);
    return node_new((const char *const[]){"--follow", address, NULL});
}

static void node_end(struct node *n)
{
    daemon_end(&n->d);
    tree_remove(n->dir.path);
}

/* The connection's reply to a request line. */
static const char *ask_on(int fd, const char *line)
{
    say(fd, line);
    say(fd, "\n");
    return hear_line(fd);
}

/* The first line of the reply on a connection of its own. */
static const char *ask(const struct node *n, const char *line)
{
    int fd = daemon_connect(&n->d);
    const char *reply = ask_on(fd, line);
    close(fd);
    return reply;
}

/* Whether the reply begins with that. */
static void expect_reply(const struct node *n, const char *line, const char *want)
{
    const char *got = ask(n, line);
    CHECK_MSG(strncmp(got, want, strlen(want)) == 0, "%s: %s", line, got);
}

/* ---- INFO replication ---- */

enum { FACT = 300 };

static void read_fact(const struct node *n, const char *key, char value[FACT])
{
    size_t bytes;
    char mark[64];
    int fd = daemon_connect(&n->d);
    say(fd, "INFO replication\nQUIT\n");
    char *text = hear_all(fd, &bytes);
    close(fd);
    snprintf(mark, sizeof mark, "\n%s:", key);
    const char *at = strstr(text, mark);
    CHECK_MSG(at != NULL, "INFO has no %s", key);
    at += strlen(mark);
    snprintf(value, FACT, "%.*s", (int)strcspn(at, "\n"), at);
    free(text);
}

static bool is_fact(const struct node *n, const char *key, const char *want)
{
    char value[FACT];
    read_fact(n, key, value);
    return strcmp(value, want) == 0;
}

static unsigned tries(void)
{
    return 500 * test_slowness();
}

static void await_fact(const struct node *n, const char *key, const char *want)
{
    char value[FACT], why[FACT];
    for (unsigned i = 0; i < tries(); i++) {
        if (is_fact(n, key, want))
            return;
        pause_ms(10);
    }
    read_fact(n, key, value);
    read_fact(n, "link_error", why);
    test_fail(__FILE__, __LINE__, "%s is %s, not %s: %s", key, value, want, why);
}

/* Waits until the follower has everything durable, up to the same position. */
static void await_position(const struct node *leader, const struct node *follower)
{
    static const char *const keys[] = {"history", "lsn", "durable_lsn", "log_digest"};
    char value[FACT], other[FACT];
    for (size_t i = 0; i < sizeof keys / sizeof keys[0]; i++) {
        read_fact(leader, keys[i], value);
        await_fact(follower, keys[i], value);
        read_fact(leader, keys[i], other);
        if (strcmp(value, other) != 0)
            i = 0;
    }
}

static const char *const sets[] = {"a", "b", "c", "d", "gone", "large"};
enum { SETS = sizeof sets / sizeof sets[0] };

/* The follower has the sets of the leader, at the same versions. */
static void expect_same(const struct node *leader, const struct node *follower)
{
    char line[64], want[200];
    await_position(leader, follower);
    for (int i = 0; i < SETS; i++) {
        snprintf(line, sizeof line, "DIGEST %s", sets[i]);
        snprintf(want, sizeof want, "%s", ask(leader, line));
        const char *got = ask(follower, line);
        CHECK_MSG(strcmp(got, want) == 0, "%s: %s, the leader has %s", sets[i], got, want);
    }
}

static bool has_snapshot(const struct node *n)
{
    char path[128];
    return directory_file(&n->dir, "snapshot.", 0, path);
}

/* ---- what it gets ---- */

enum { LARGE = 70000 };

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
}

/* Every kind of change. */
static void change_everything(const struct node *n)
{
    carry_out(
        &n->d,
        "CREATE c TOL 0.5\nCREATE d\nADD a 0 0 1 0 0 1 5 5 5 5\nADD gone 1 1\nEXPIRE gone 1000\n"
        "ADD c 0 0 0.3 0 1 1\nTRIANGULATE a\nMOVE a 1 2 2\nDEL a 2\nEXPIRE c 1000\n"
        "FSET a z 0 1.5 1 nan\nFSET a w 3 7\nFDROP a w\nADD a FIELDS z,q 8 8 1 2\n"
        "LOAD b 3 FIELDS z\n1 2 3\n4 5 nan\n7 8 9\nTRIANGULATE b METHOD shelling\n"
        "TRIANGULATE d\nPERSIST gone\nDROP gone\nDROP d\nCREATE d\n");
}

TEST_TIMEOUT(follower_gets_every_kind_of_change, 60)
{
    struct node l = node_new(NULL), f = follower_of(&l);
    await_fact(&l, "followers", "1");
    change_everything(&l);
    expect_same(&l, &f);
    load_large(&l);
    expect_same(&l, &f);
    carry_out(&l.d, "FDROP large z\nTRIANGULATE large\nEXPIRE b 0.05\n");
    await_info(&l.d, "sets", 4);
    carry_out(&l.d, "ADD b 1 1\nDROP c\nDEL a 0 1\nFDROP a q\n");
    expect_same(&l, &f);
    CHECK(is_fact(&f, "role", "follower") && is_fact(&f, "link", "receiving"));
    expect_reply(&f, "POINTS a", "OK");
    node_end(&l);
    node_end(&f);
}

TEST_TIMEOUT(follower_that_comes_later_gets_every_kind_of_change_as_a_snapshot, 60)
{
    struct node l = node_new(NULL);
    change_everything(&l);
    load_large(&l);
    struct node f = follower_of(&l);
    expect_same(&l, &f);
    CHECK(has_snapshot(&f));
    carry_out(&l.d, "ADD b 3 3\nMOVE large 5 1000 1000\n");
    expect_same(&l, &f);
    daemon_stop(&f.d, SIGKILL);
    start(&f, NULL); /* its directory says whom it follows */
    expect_same(&l, &f);
    node_end(&l);
    node_end(&f);
}

TEST_TIMEOUT(follower_refuses_changes_and_says_who_the_leader_is, 60)
{
    struct node l = node_new(NULL), f = follower_of(&l);
    char want[64];
    carry_out(&l.d, "ADD a 0 0\n");
    expect_same(&l, &f);
    snprintf(want, sizeof want, "ERR READONLY leader=127.0.0.1:%u", l.d.port);
    static const char *const changes[] = {"ADD a 1 1",    "CREATE b",     "DROP a",
                                          "DEL a 0",      "MOVE a 0 3 3", "TRIANGULATE a",
                                          "FSET a z 0 1", "EXPIRE a 100", "FDROP a z"};
    for (size_t i = 0; i < sizeof changes / sizeof changes[0]; i++)
        CHECK_STR(ask(&f, changes[i]), want);
    expect_reply(&f, "SYNC 1.1.1 0 0000000000000000", want);
    expect_same(&l, &f);
    node_end(&l);
    node_end(&f);
}

/* ---- restarts ---- */

TEST_TIMEOUT(follower_continues_after_restarts_without_a_transfer, 60)
{
    struct node l = node_new(NULL), f = follower_of(&l);
    carry_out(&l.d, "ADD a 0 0 1 0\n");
    expect_same(&l, &f);
    for (int i = 0; i < 4; i++) {
        struct node *n = i % 2 == 0 ? &f : &l;
        daemon_stop(&n->d, i < 2 ? SIGTERM : SIGKILL);
        if (n == &f)
            carry_out(&l.d, "ADD a 3 3\nADD b 4 4\n");
        start(n, NULL);
        carry_out(&l.d, "ADD a 5 5\nTRIANGULATE b\n");
        expect_same(&l, &f);
    }
    char path[128];
    CHECK(!directory_file(&l.dir, "snapshot.", 1, path));
    node_end(&l);
    node_end(&f);
}

TEST_TIMEOUT(follower_gets_a_snapshot_when_the_log_does_not_reach_back, 60)
{
    struct node l = node_new((const char *const[]){"--keep-log", "1", NULL}), f = follower_of(&l);
    carry_out(&l.d, "ADD a 0 0 1 0\nADD b 1 1\n");
    expect_same(&l, &f);
    daemon_stop(&f.d, SIGTERM);
    carry_out(&l.d, "DROP b\nADD a 7 7\nADD c 1 1\nSNAPSHOT\n");
    for (unsigned i = 0; i < 3; i++) {
        await_info(&l.d, "snapshot_running", 0);
        carry_out(&l.d, "ADD a 8 8\nSNAPSHOT\n");
    }
    await_info(&l.d, "snapshot_running", 0);
    start(&f, NULL);
    expect_same(&l, &f);
    daemon_stop(&f.d, SIGKILL);
    start(&f, NULL);
    expect_same(&l, &f);
    carry_out(&l.d, "ADD a 9 9\n");
    expect_same(&l, &f);
    node_end(&l);
    node_end(&f);
}

/* ---- promotion ---- */

TEST_TIMEOUT(promoted_follower_accepts_changes_and_its_former_leader_refuses_them, 60)
{
    struct node l = node_new(NULL), f = follower_of(&l);
    char follow[64];
    carry_out(&l.d, "ADD a 0 0 1 0\n");
    expect_same(&l, &f);
    carry_out(&f.d, "FOLLOW NONE\nADD a 2 2\n");
    CHECK(is_fact(&f, "role", "leader"));
    await_fact(&l, "role", "fenced");
    expect_reply(&l, "ADD a 3 3", "ERR READONLY there is a newer history");
    daemon_stop(&l.d, SIGKILL);
    start(&l, NULL);
    expect_reply(&l, "ADD a 3 3", "ERR READONLY there is a newer history");
    daemon_stop(&f.d, SIGKILL);
    start(&f, NULL);
    carry_out(&f.d, "ADD b 2 2\n");
    snprintf(follow, sizeof follow, "FOLLOW 127.0.0.1 %u\n", f.d.port);
    carry_out(&l.d, follow);
    expect_same(&f, &l);
    expect_reply(&l, "ADD a 3 3", "ERR READONLY leader=");
    node_end(&l);
    node_end(&f);
}

TEST_TIMEOUT(former_leader_with_changes_of_its_own_follows_only_with_confirm, 60)
{
    struct node l = node_new(NULL), f = follower_of(&l);
    char follow[64];
    carry_out(&l.d, "ADD a 0 0 1 0\n");
    expect_same(&l, &f);
    daemon_stop(&f.d, SIGKILL);
    carry_out(&l.d, "ADD a 9 9\n");
    daemon_stop(&l.d, SIGKILL);
    start(&f, NULL);
    carry_out(&f.d, "FOLLOW NONE\nADD a 2 2\nADD b 1 1\n");
    start(&l, NULL);
    await_fact(&l, "role", "fenced");
    snprintf(follow, sizeof follow, "FOLLOW 127.0.0.1 %u\n", f.d.port);
    carry_out(&l.d, follow);
    await_fact(&l, "link", "refused");
    expect_reply(&l, "STAT a", "OK 0 points=3");
    expect_reply(&f, "STAT a", "OK 0 points=3");
    daemon_stop(&l.d, SIGTERM);
    start(&l, NULL);
    await_fact(&l, "link", "refused");
    snprintf(follow, sizeof follow, "FOLLOW 127.0.0.1 %u CONFIRM\n", f.d.port);
    carry_out(&l.d, follow);
    expect_same(&f, &l);
    carry_out(&f.d, "ADD b 5 5\n");
    expect_same(&f, &l);
    node_end(&l);
    node_end(&f);
}

TEST_TIMEOUT(fenced_leader_accepts_changes_again_after_follow_none, 60)
{
    struct node l = node_new(NULL), f = follower_of(&l);
    carry_out(&l.d, "ADD a 0 0 1 0\n");
    expect_same(&l, &f);
    carry_out(&f.d, "FOLLOW NONE\n");
    await_fact(&l, "role", "fenced");
    carry_out(&l.d, "FOLLOW NONE\nADD a 3 3\n");
    CHECK(is_fact(&l, "role", "leader"));
    daemon_stop(&l.d, SIGKILL);
    start(&l, NULL);
    carry_out(&l.d, "ADD a 4 4\n");
    node_end(&l);
    node_end(&f);
}

/* ---- refusals ---- */

TEST_TIMEOUT(leader_that_has_lost_its_data_is_refused, 60)
{
    struct node l = node_new(NULL), f = follower_of(&l);
    carry_out(&l.d, "ADD a 0 0 1 0\n");
    expect_same(&l, &f);
    daemon_stop(&l.d, SIGKILL);
    tree_remove(l.dir.path);
    l.dir = directory_quick();
    start(&l, NULL);
    carry_out(&l.d, "ADD z 0 0\nADD z 1 1\nADD z 2 2\nADD z 3 3\n");
    await_fact(&f, "link", "refused");
    expect_reply(&f, "STAT a", "OK 0 points=2");
    char follow[64];
    snprintf(follow, sizeof follow, "FOLLOW 127.0.0.1 %u CONFIRM\n", l.d.port);
    carry_out(&f.d, follow);
    expect_same(&l, &f);
    expect_reply(&f, "STAT a", "ERR NOSET");
    expect_reply(&f, "STAT z", "OK 0 points=4");
    node_end(&l);
    node_end(&f);
}

/* Both have a history of their own. */
TEST_TIMEOUT(daemon_with_changes_of_its_own_does_not_give_them_up_unasked, 60)
{
    struct node l = node_new(NULL), f = node_new(NULL);
    char follow[64];
    carry_out(&l.d, "ADD a 0 0 1 0\n");
    carry_out(&f.d, "ADD a 5 5\n");
    snprintf(follow, sizeof follow, "FOLLOW 127.0.0.1 %u\n", l.d.port);
    carry_out(&f.d, follow);
    await_fact(&f, "link", "refused");
    expect_reply(&f, "STAT a", "OK 0 points=1");
    carry_out(&f.d, "FOLLOW NONE\nADD a 6 6\n");
    expect_reply(&f, "STAT a", "OK 0 points=2");
    expect_reply(&l, "ADD a 3 3", "OK"); /* of another origin: the leader is not fenced */
    snprintf(follow, sizeof follow, "FOLLOW 127.0.0.1 %u CONFIRM\n", l.d.port);
    carry_out(&f.d, follow);
    expect_same(&l, &f);
    node_end(&l);
    node_end(&f);
}

TEST(follow_needs_an_address_a_port_and_a_data_directory)
{
    struct node n = node_new(NULL);
    expect_reply(&n, "FOLLOW somewhere 1", "ERR SYNTAX");
    expect_reply(&n, "FOLLOW 127.0.0.1 0", "ERR NUMBER");
    expect_reply(&n, "FOLLOW 127.0.0.1 65536", "ERR NUMBER");
    expect_reply(&n, "FOLLOW 127.0.0.1 1 PLEASE", "ERR SYNTAX");
    expect_reply(&n, "FOLLOW 127.0.0.1", "ERR SYNTAX");
    expect_reply(&n, "FOLLOW NONE", "OK 0");
    expect_reply(&n, "SYNC 1.1 0 0000000000000000", "ERR SYNTAX");
    expect_reply(&n, "SYNC 1.1.1 -1 0000000000000000", "ERR SYNTAX");
    expect_reply(&n, "SYNC 1.1.1 0 0", "ERR SYNTAX");
    expect_reply(&n, "ADD a 1 1", "OK");
    node_end(&n);
}

/* ---- WAIT and --min-followers ---- */

TEST_TIMEOUT(wait_says_how_many_followers_have_the_changes_of_the_connection, 60)
{
    struct node l = node_new(NULL), f = follower_of(&l);
    await_fact(&l, "followers", "1");
    int fd = daemon_connect(&l.d);
    for (int i = 0; i < 50; i++) {
        CHECK(strncmp(ask_on(fd, "ADD a 1 2"), "OK", 2) == 0);
        CHECK_STR(ask_on(fd, "WAIT 1 60"), "OK 0 followers=1");
    }
    daemon_stop(&f.d, SIGKILL); /* it has everything that WAIT has confirmed */
    await_fact(&l, "followers", "0");
    CHECK_STR(ask_on(fd, "WAIT 1 0.01"), "OK 0 followers=0");
    CHECK_STR(ask_on(fd, "WAIT 0 60"), "OK 0 followers=0");
    close(fd);
    daemon_stop(&l.d, SIGKILL);
    start(&f, NULL);
    expect_reply(&f, "STAT a", "OK 0 points=50");
    start(&l, NULL);
    expect_same(&l, &f);
    node_end(&l);
    node_end(&f);
}

/* Asks until the reply begins with that. */
static void await_reply(const struct node *n, const char *line, const char *want)
{
    for (unsigned i = 0; i < tries() && strncmp(ask(n, line), want, strlen(want)) != 0; i++)
        pause_ms(10);
    expect_reply(n, line, want);
}

TEST_TIMEOUT(changes_are_refused_while_there_are_too_few_followers, 60)
{
    struct node l = node_new((const char *const[]){"--min-followers", "1", NULL});
    await_reply(&l, "ADD b 0 0", "ERR NOFOLLOWERS");
    struct node f = follower_of(&l);
    await_reply(&l, "ADD b 0 0", "OK");
    carry_out(&l.d, "ADD a 1 1\nADD a 2 2\n");
    expect_same(&l, &f);
    node_end(&f);
    await_reply(&l, "ADD b 0 0", "ERR NOFOLLOWERS");
    expect_reply(&l, "ADD a 1 1", "ERR NOFOLLOWERS");
    expect_reply(&l, "STAT a", "OK 0 points=2");
    expect_reply(&l, "CONFIG SET min-followers 0", "OK");
    await_reply(&l, "ADD b 0 0", "OK");
    expect_reply(&l, "ADD a 3 3", "OK");
    node_end(&l);
}

TEST_TIMEOUT(nothing_acknowledged_is_lost_with_the_leader, 60)
{
    enum { CHANGES = 300 };
    struct node l = node_new((const char *const[]){"--min-followers", "1", NULL}),
                f = follower_of(&l);
    await_fact(&l, "followers", "1");
    int fd = daemon_connect(&l.d), acknowledged = 0;
    for (; acknowledged < CHANGES; acknowledged++)
        CHECK(strncmp(ask_on(fd, "ADD a 1 2"), "OK", 2) == 0);
    for (int i = 0; i < 20; i++)
        say(fd, "ADD a 1 2\n"); /* these may be lost, or not */
    daemon_stop(&l.d, SIGKILL);
    close(fd);
    tree_remove(l.dir.path);
    daemon_stop(&f.d, SIGKILL);
    start(&f, NULL);
    carry_out(&f.d, "FOLLOW NONE\nADD b 1 1\n");
    unsigned points;
    CHECK(sscanf(ask(&f, "STAT a"), "OK 0 points=%u", &points) == 1);
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
            await_fact(&f, "lsn", "2");
        for (unsigned k = 0; i < 2 && k < tries() && is_fact(&f, "link_error", ""); k++)
            pause_ms(10);
        char why[FACT];
        read_fact(&f, "link_error", why);
        CHECK_MSG((strncmp(why, i == 0 ? "DENIED" : "ERR DENIED", 6) == 0) == (i < 2), "%s", why);
        node_end(&f);
    }
    daemon_end(&l.d);
    tree_remove(l.dir.path);
    tree_remove(files.path);
}
