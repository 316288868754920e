/* lifecycle.h - starts and ends a server, and ends the jobs of its workers. */
#pragma once

#include "server/jobs/server.h"

/* Starts config->threads workers unless that is 0. False, with the reason on standard error. */
bool server_init(struct server *s, struct config *config);

/* The server is stopping: builds, searches and plans of edits are cancelled from now on (job_drain). */
void server_drain(struct server *s);

/* Cancels the jobs of the workers, waits for their end, then frees everything. */
void server_clear(struct server *s);

/* Passes every finished job to `deliver`, which ends it with job_finish. */
void server_collect(struct server *s, void (*deliver)(void *ctx, struct job *j), void *ctx);

/* Ends a job whose owner does not exist any more. */
void server_finish_abandoned(struct server *s, struct job *j);
