/* false_leader.h - a test that is the leader of a follower: it can send any bytes. Any failure ends the test. */
#pragma once

#include "proto/records/record.h"
#include "tests/server/follow/node.h"

struct false_leader {
    int listener;
    char address[32];
    int fd;          /* of the follower */
    char asked[200]; /* what it has sent last */
    struct buf out;  /* what is to be sent */
    uint64_t lsn;    /* of the last record, */
    uint64_t digest; /* up to there */
    struct history history;
};

struct false_leader false_leader_new(void);
void false_leader_end(struct false_leader *l);

/* Begins to connect to it; the caller closes. */
int false_leader_dial(const struct false_leader *l);

/* Waits until a follower connects, and receives its SYNC. Ends the connection before that. Answers that it continues,
 * "yes", or not. */
void false_leader_accept(struct false_leader *l, const char *continues);

/* Each function appends to the output. In this order: the header of the next record; a record with the next lsn; the
 * header of a snapshot up to the last record. The last one: a snapshot without sets up to lsn, and a header. */
void false_leader_header(struct false_leader *l);
void false_leader_record(struct false_leader *l, struct record r);
void false_leader_snapshot_header(struct false_leader *l);
void false_leader_snapshot(struct false_leader *l, uint64_t lsn);

/* Sends that; false: the follower has disconnected. */
bool false_leader_send(struct false_leader *l);
