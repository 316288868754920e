/* request_stats.h - accounting of requests: statistics and the slow log. */
#pragma once

#include "server/clients/session_state.h"

/* The current request has been answered by *a. `error`: with an ERR line. */
void request_stats_end(struct session *s, const struct answer *a, bool error);

/* It pauses: it waits in a queue, until a time, for a worker, for its body or for the beginning of a stream. */
void request_stats_pause(struct session *s, const struct answer *a);

/* The work of a request begins whose body is complete. */
void request_stats_load(struct session *s);

/* The job that the session waits for has finished. */
void request_stats_job(struct session *s, const struct job *j);
