/* lifecycle.h - a server from its start to its end. */
#ifndef SERVER_LIFECYCLE_H
#define SERVER_LIFECYCLE_H

#include "server/jobs/server.h"

/* Starts config->threads workers unless that is 0. False, with the reason on standard error. */
bool server_init(struct server *s, struct config *config);

/* The server is about to stop: what may take long and changes no points, builds and searches, is
 * cancelled from now on. */
void server_drain(struct server *s);

/* Cancels and waits for what the workers still do, then frees everything. */
void server_clear(struct server *s);

/* Hands every job that the workers have finished to deliver, which ends it with job_finish. */
void server_collect(struct server *s, void (*deliver)(void *ctx, struct job *j), void *ctx);

/* Ends a job whose owner has gone. */
void server_finish_unheard(struct server *s, struct job *j);

#endif
