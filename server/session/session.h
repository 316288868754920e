/* session.h - the conversation with one client: takes requests from its connection one after the other, passes
 * them to the commands, and does what their answers require: streams, jobs, waiting, loads.
 *
 * At most one request of a client is under way, so replies are in the order of requests; later requests wait in
 * the connection's input. A turn is bounded in time and in output, so that no client blocks the others. */
#pragma once

#include "server/clients/session_state.h"

/* A session on a connected non-blocking socket of *peer. NULL when out of memory or descriptors; then the socket
 * is still the caller's. The session frees itself when its connection has closed. */
struct session *session_new(struct server *server, struct reactor *reactor, int fd,
                            const struct sock_peer *peer, void (*closed)(struct session *s));

/* Ends a finished job of this session. */
void session_job_done(struct session *s, struct job *j);

/* More output of this session's connection may be sent. */
void session_released(struct hold *h);

/* Changes may be lost that replies in the output acknowledge: replaces these by an error and ends the session. */
void session_not_saved(struct hold *h);

/* To be called once a second: closes a session that stalls, that does not authenticate in time, or that has sent
 * nothing for --idle-timeout. */
void session_check_timeouts(struct session *s);

/* The daemon is stopping and has waited so long: closes if rows are still being searched or computed, or if the client has
 * read nothing in that time. An edit is completed, and its acknowledgement waits for the disk. */
void session_break_off(struct session *s, int64_t waited_ms);

/* Closes at once, with an error, to make room: the client has not authenticated. */
void session_evict(struct session *s);

enum { SESSION_PROGRESS_MS = 1000 }; /* jobs that take longer report their progress */

/* Sends a progress comment to the client. */
void session_progress(struct session *s, const struct job *j);

/* The same to clients that wait for the job's set, the first hundred of them. */
void session_progress_waiting(const struct job *j);
