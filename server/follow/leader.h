/* leader.h - the followers of this daemon: their addresses, their positions, and the requests that wait for them. Everything but their
 * threads (sender.h) is a reactor's. */
#pragma once

#include "server/follow/sender.h"
#include "server/jobs/server.h"
#include "server/system/loop.h"

/* False, with the reason on standard error. */
bool leader_start(struct server *s, struct loop *loop);
void leader_stop(struct server *s); /* ends the threads; does nothing if it has not started */

/* Adds the follower at the other end of the socket, which moves here; it continues from that position. False: out of memory
 * or descriptors; the caller still owns fd. */
bool leader_add(struct server *s, int fd, const struct sock_peer *peer,
                const struct position *from);

/* Disconnects all followers; they connect again: the history has changed. */
void leader_dismiss(struct server *s);

/* To be called at the end of every turn: passes on the durable changes. */
void leader_turn_end(struct server *s);
void leader_tick(struct server *s); /* once a second */

/* Returns how many followers have all changes up to lsn on their disks. */
unsigned leader_count(const struct server *s, uint64_t lsn);

/* The queue of requests that wait for followers (WAIT): they are tried again when a follower has more on its disk, and at
 * at_ms. */
struct request_queue *leader_queue(struct server *s, int64_t at_ms);

/* The number of followers. */
unsigned leader_followers(const struct server *s);

/* The follower after f; f NULL: the first one. NULL: there is none. */
const struct sender *leader_next(const struct server *s, const struct sender *f);
