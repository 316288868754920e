/* watch.h - clients that follow a set: after each change they get the rows and rings that are different now, never a log
 * of edits.
 *
 * What edits touch is collected once for each set (dt_touched_take). Watchers that want the same (scope.h) and are up to
 * date get the same text (feed.h), some of them in each turn of the loop. While a set is edited all the time, events get a
 * share of the time, and what has changed meanwhile is a bit for each id. A watcher that lags, because its client does not
 * read or a long reply is being sent, has such bits of its own, and later gets their rows as they are then, in parts. A
 * watcher that knows nothing, or after a change of everything, is sent all ids in ascending order (a reset), which needs no
 * bits.
 *
 * For clients that come back (SINCE) the last changes are kept (recent.h), for a while also without watchers. */
#ifndef SERVER_WATCH_H
#define SERVER_WATCH_H

#include "server/clients/session_state.h"
#include "server/watch/scope.h"

enum { WATCH_MOST = 64 }; /* sets that a connection watches */

/* The session watches the set. The scope moves there, whatever comes of it. `since` is the last version of which the client
 * knows everything in that scope; 0: none. False: out of memory. */
bool watch_begin(struct server *s, struct session *who, struct dataset *set, struct scope *scope,
                 uint64_t since);
bool watch_end(struct session *who, const struct dataset *set); /* false: it did not watch it */

/* The connection has closed. */
void watch_leave(struct session *who);

/* Its output has room again, and the session may have lacked events. */
void watch_resume(struct session *who);

/* A set that is watched has another version, or is dropped. */
void watch_changed(struct dataset *set);
void watch_dropped(struct dataset *set);

/* To be called at the end of every turn: writes the events. */
void watch_turn_end(struct server *s);

/* All sessions have ended. */
void watch_clear(struct server *s);

#endif
