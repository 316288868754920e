/* consent.h - whether a daemon may follow a leader: never if that would silently discard changes that the leader does not
 * have. */
#ifndef SERVER_CONSENT_H
#define SERVER_CONSENT_H

#include "server/follow/position.h"

#include <stdbool.h>
#include <stddef.h>

enum consent {
    CONSENT_GIVEN,
    CONSENT_REFUSED, /* only an operator can decide (CONFIRM) */
    CONSENT_LATER    /* the leader has answered with an error, or not as a leader does */
};

/* Decides by the leader's reply to SYNC. `own`: the position of this daemon; lsn 0: it has no changes. `confirmed`: its
 * changes may be discarded. Unless the result is CONSENT_GIVEN, why[size] gets the reason. */
enum consent consent_to(const struct position *own, bool confirmed, const char *line, char *why,
                        size_t size);

#endif
