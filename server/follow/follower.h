/* follower.h - a daemon that follows another one: how it starts and stops following. On a reactor; a thread
 * owns the connection (link.h), apply.h carries out the records.
 *
 * The data directory remembers the leader (role.h). */
#pragma once

#include "server/follow/link.h"
#include "server/jobs/server.h"
#include "server/system/loop.h"

/* Before the data directory is read: decides whether this daemon follows (s->follows), by --follow, or by the directory.
 * False, with the reason on standard error. */
bool follower_prepare(struct server *s, struct loop *loop);

/* The data directory has been read, and all sets are triangulated: begins to follow, if it is to. */
void follower_begin(struct server *s);
void follower_stop(struct server *s);

/* To be called at the end of every turn and once a second. */
void follower_turn_end(struct server *s);
void follower_tick(struct server *s);

/* A job of the link's records has ended. */
void follower_job_done(struct server *s, struct job *j);

/* Whether that daemon can be followed; it is asked who it is. FOLLOW_ASKED: there is no answer yet; the request is to be
 * carried out again when the queue calls it. FOLLOW_IMPOSSIBLE: why[size] has the reason. A daemon that does not answer
 * within some seconds can be followed: it may do so later. */
enum follow_target { FOLLOW_POSSIBLE, FOLLOW_ASKED, FOLLOW_IMPOSSIBLE, FOLLOW_ITSELF };
enum follow_target follower_examine(struct server *s, const char *host, unsigned port,
                                    struct request_queue **queue, char *why, size_t size);

/* Follows that daemon from now on; `confirmed`: even if it has to give up its own history. NULL, or why not. */
const char *follower_follow(struct server *s, const char *host, unsigned port, bool confirmed);

/* Ends following, or being fenced: a new generation of the history begins, and changes are possible. */
const char *follower_promote(struct server *s);

/* Another daemon has that history. If it is newer, this daemon refuses changes from now on. */
void follower_meet(struct server *s, const struct history *h);

struct follower_facts {
    const char *role; /* leader, follower, fenced */
    bool settled;     /* a leader, and no follower has been promoted instead that can reach it */
    const char *state;
    char why[LINK_WHY];
    char leader[ROLE_TEXT];
    uint64_t leader_lsn;
    uint64_t identity;      /* of this process */
    char former[ROLE_TEXT]; /* the former leader that is still to be informed */
};
void follower_facts(const struct server *s, struct follower_facts *f);
