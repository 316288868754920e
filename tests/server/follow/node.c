/* node.c - see node.h. */
#include "tests/server/follow/node.h"

#include "tests/faults/tree.h"
#include "tests/test.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

void node_follow(const struct node *n, const struct node *leader, const char *more)
{
    char line[64];
    snprintf(line, sizeof line, "FOLLOW 127.0.0.1 %u%s\n", leader->d.port, more);
    carry_out(&n->d, line);
}

void node_start(struct node *n, const char *const *arguments)
{
    const char *all[10] = {"--port", n->d.port_text};
    for (size_t i = 0; arguments != NULL && arguments[i] != NULL && i < 7; i++)
        all[2 + i] = arguments[i];
    n->d = directory_daemon(&n->dir, all);
}

struct node node_new(const char *const *arguments)
{
    struct node n = {.dir = directory_quick()};
    strcpy(n.d.port_text, "0");
    node_start(&n, arguments);
    return n;
}

struct node node_follower_of(const struct node *leader)
{
    char address[32];
    snprintf(address, sizeof address, "127.0.0.1:%u", leader->d.port);
    return node_new((const char *const[]){"--follow", address, NULL});
}

void node_end(struct node *n)
{
    daemon_end(&n->d);
    tree_remove(n->dir.path);
}

const char *node_ask_on(int fd, const char *line)
{
    say(fd, line);
    say(fd, "\n");
    return hear_line(fd);
}

const char *node_ask(const struct node *n, const char *line)
{
    int fd = daemon_connect(&n->d);
    const char *reply = node_ask_on(fd, line);
    close(fd);
    return reply;
}

void node_expect(const struct node *n, const char *line, const char *want)
{
    const char *got = node_ask(n, line);
    CHECK_MSG(strncmp(got, want, strlen(want)) == 0, "%s: %s", line, got);
}

/* ---- INFO replication ---- */

void node_fact(const struct node *n, const char *key, char value[FACT])
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

bool node_is(const struct node *n, const char *key, const char *want)
{
    char value[FACT];
    node_fact(n, key, value);
    return strcmp(value, want) == 0;
}

unsigned node_tries(void)
{
    return 500 * test_slowness();
}

void node_await(const struct node *n, const char *key, const char *want)
{
    char value[FACT], why[FACT];
    for (unsigned i = 0; i < node_tries(); i++) {
        if (node_is(n, key, want))
            return;
        pause_ms(10);
    }
    node_fact(n, key, value);
    node_fact(n, "link_error", why);
    test_fail(__FILE__, __LINE__, "%s is %s, not %s: %s", key, value, want, why);
}

void node_await_position(const struct node *leader, const struct node *follower)
{
    static const char *const keys[] = {"history", "lsn", "durable_lsn", "log_digest"};
    char value[FACT], other[FACT];
    for (size_t i = 0; i < sizeof keys / sizeof keys[0]; i++) {
        node_fact(leader, keys[i], value);
        node_await(follower, keys[i], value);
        node_fact(leader, keys[i], other);
        if (strcmp(value, other) != 0)
            i = 0;
    }
}

static const char *const sets[] = {"a", "b", "c", "d", "gone", "large", "x"};
enum { SETS = sizeof sets / sizeof sets[0] };

void node_expect_same(const struct node *leader, const struct node *follower)
{
    char line[64], want[200];
    node_await_position(leader, follower);
    for (int i = 0; i < SETS; i++) {
        snprintf(line, sizeof line, "DIGEST %s", sets[i]);
        snprintf(want, sizeof want, "%s", node_ask(leader, line));
        const char *got = node_ask(follower, line);
        CHECK_MSG(strcmp(got, want) == 0, "%s: %s, the leader has %s", sets[i], got, want);
    }
}

bool node_has_snapshot(const struct node *n)
{
    char path[128];
    return directory_file(&n->dir, "snapshot.", 0, path);
}

void node_await_reply(const struct node *n, const char *line, const char *want)
{
    for (unsigned i = 0; i < node_tries() && strncmp(node_ask(n, line), want, strlen(want)) != 0;
         i++)
        pause_ms(10);
    node_expect(n, line, want);
}
