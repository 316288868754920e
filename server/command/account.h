/* account.h - what is remembered of a session's requests: how often, how long, the slow ones. */
#ifndef SERVER_ACCOUNT_H
#define SERVER_ACCOUNT_H

#include "server/clients/session_state.h"
#include "server/system/notice.h"

/* The request at hand has been answered, as a tells. `error`: by an ERR line. */
void account_end(struct session *s, const struct answer *a, bool error);

/* It pauses: it waits in a queue or for a moment, for a worker, for its points or for a listing. */
void account_pause(struct session *s, const struct answer *a);

/* A load whose points are there begins its work. */
void account_load(struct session *s);

/* The job that the session waited for has come back. */
void account_job(struct session *s, const struct job *j);

/* Tells the operator something about the session. */
void notice_client(const struct session *s, enum notice_level level, const char *what);

#endif
