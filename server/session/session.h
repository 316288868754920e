/* session.h - one client's conversation: takes requests from its connection one after the other,
 * hands them to the commands, and sees to what an answer leaves to come: streams, jobs, waiting,
 * loads.
 *
 * At most one request of a client is under way, so replies come in the order of requests; those
 * behind it wait in the connection's input. A turn is bounded in time and in output, so that no
 * client holds up the others. */
#ifndef SERVER_SESSION_H
#define SERVER_SESSION_H

#include "server/clients/session_state.h"

/* A session on a connected non-blocking socket, whose other end is *peer; NULL, with the socket
 * still the caller's, when out of memory or descriptors. It frees itself when its connection has
 * closed. */
struct session *session_new(struct server *server, struct loop *loop, int fd,
                            const struct sock_peer *peer, void (*closed)(struct session *s));

/* Ends a job of this session. */
void session_job_done(struct session *s, struct job *j);

/* Answers the session, which has joined another one's job. */
void session_job_shared(struct session *s, struct job *j);

/* The hold of this session's connection lets more of its output go. */
void session_released(struct hold *h);

/* What the replies that are held would have acknowledged may be lost: ends the session with an
 * error instead of them. */
void session_not_saved(struct hold *h);

/* To be called once a second: closes sessions that stall, that show no token in time, or that have
 * sent nothing for --idle-timeout. */
void session_check_timeouts(struct session *s);

/* Closes at once, with an error: a client that has shown no token makes room for another one. */
void session_evict(struct session *s);

enum { SESSION_PROGRESS_MS = 1000 }; /* a job that takes longer reports how far it is */

/* Tells the client how far its job is. */
void session_progress(struct session *s, const struct job *j);

#endif
