/* expire.h - EXPIRE: sets that the server drops at a time.
 *
 * The time is one of the wall clock, so it survives a restart: the log and snapshots have it. When it has come, the set
 * is dropped as by DROP, with a record in the log, by the next request that names the set, or by a tick. Three sets stay
 * for longer: a set that a job edits, a set that is still being triangulated after a restart, and a set whose DROP cannot be
 * logged now. */
#pragma once

#include "server/jobs/server.h"

enum { EXPIRE_MOST_S = 1000000000 }; /* from now: 31 years */

/* Takes the time back; with a record in the log. */
void expire_never(struct server *s, struct dataset *set);

/* The wall clock in milliseconds since 1970, as in a set's expires_ms. */
int64_t expire_now_ms(void);

/* Whether its time has come. */
bool expire_is_due(const struct dataset *set);

/* Drops the set if its time has come and it can be dropped. Whether it has been. */
bool expire_drop_if_due(struct server *s, struct dataset *set);

/* Drops some of the temporary sets whose connections have ended (server.temporary), in less than a millisecond. Sets that a
 * job edits get a time to expire. Whether there are more. */
bool expire_temporary(struct server *s);

/* Of a set that is dropped at some time; not negative. */
double expire_seconds_left(const struct dataset *set);

/* Looks at some of the sets that are dropped at some time, one after the other, and drops those whose time has come. To be
 * called once a second. Cost: O(1), less than a millisecond. */
void expire_tick(struct server *s);
