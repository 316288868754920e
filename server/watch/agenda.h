/* agenda.h - the watched sets that a turn of the loop has to examine. A set that is merely watched costs a turn nothing.
 *
 *     all       every watched set
 *     busy      those that have changed, or have something to send: at the end of this turn,
 *     now       or of the next one, if this turn has taken long
 *     deserted  those whose last watcher has left, in the order in which they did: about a minute later
 *
 * Cost of each call: constant. */
#pragma once

#include "server/watch/feed.h"

/* A new one: it is in `all` until agenda_leave, which takes it out of all lists. */
void agenda_enter(struct watched *k);
void agenda_leave(struct watched *k);

/* It is looked at, at the end of this turn. Reactors that share the world call it, too: of a set whose gate they have closed. */
void agenda_call(struct watched *k);

/* Begins a turn; then takes one set after the other; NULL at the end. Sets that are called after agenda_begin, or have not
 * been taken, are for the next turn. */
void agenda_begin(struct server *s);
struct watched *agenda_next(struct server *s);
bool agenda_is_done(const struct server *s); /* all have been taken */

/* Its last watcher has left, at now_ms; or it has one again. */
void agenda_desert(struct watched *k, int64_t now_ms);
void agenda_return(struct watched *k);

/* The one that was deserted first; NULL: none is. */
struct watched *agenda_deserted(const struct server *s);
