/* watch.h - clients that follow a set: after each change they get the rows and rings that are different now, never a log
 * of edits.
 *
 * Changes belong to the set: they are collected once (dt_touched_take), as a tick of the set. A watcher is a position among
 * the ticks (feed.h). A change puts all watchers into a queue. Each turn of the loop serves the first WATCH_TURN of them, for at
 * most a tenth of a millisecond. So a change costs other clients the same however many watch, and a watcher that does not
 * read costs nothing. Changes that come before a watcher is served again are sent to it once. While a set is edited
 * all the time, events get a share of the time (credit.h).
 *
 * For clients that come back (SINCE) the last changes are kept (recent.h), for a while also without watchers. */
#pragma once

#include "server/clients/session_state.h"
#include "server/watch/scope.h"

enum {
    WATCH_MOST = 64, /* sets that a connection watches */
    WATCH_TURN = 16  /* watchers that are served in a turn of the loop */
};

/* The session watches the set. The watch owns the scope even if the call fails. `since` is the last version of which the client
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
