/* node.h - a daemon with a data directory, which leads or follows another one. Any failure ends the test. */
#pragma once

#include "tests/server/directory.h"

struct node {
    struct directory dir;
    struct daemon d;
};

/* A new one, with these further arguments (NULL-terminated; NULL for none). */
struct node node_new(const char *const *arguments);

/* A new follower. */
struct node node_follower_of(const struct node *leader);

/* FOLLOW with the other one's address; more: "" or " CONFIRM". */
void node_follow(const struct node *n, const struct node *leader, const char *more);

/* Starts the daemon again, on the port that it had. */
void node_start(struct node *n, const char *const *arguments);

void node_end(struct node *n);

/* The first line of the reply on a connection of its own, and on an open one. */
const char *node_ask(const struct node *n, const char *line);
const char *node_ask_on(int fd, const char *line);

/* The reply begins with that; the second one asks until it does. */
void node_expect(const struct node *n, const char *line, const char *want);
void node_await_reply(const struct node *n, const char *line, const char *want);

/* The value of a key of INFO replication. */
enum { FACT = 300 };
void node_fact(const struct node *n, const char *key, char value[FACT]);
bool node_is(const struct node *n, const char *key, const char *want);
void node_await(const struct node *n, const char *key, const char *want);

/* Returns how often a test looks for an expected state, 10 ms apart. */
unsigned node_tries(void);

/* Waits until the follower has everything durable, up to the same position. */
void node_await_position(const struct node *leader, const struct node *follower);

/* The follower has the sets of the leader that tests use, at the same versions. */
void node_expect_same(const struct node *leader, const struct node *follower);

bool node_has_snapshot(const struct node *n);
