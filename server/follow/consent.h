/* consent.h - whether a daemon may follow a leader: never if that would silently give up changes that the leader does not
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

/* What the line with which a leader answers SYNC means for a daemon with the position `own`; lsn 0: it has no changes.
 * `confirmed`: what is here may be given up. Unless consent is given, why[size] says why not. */
enum consent consent_to(const struct position *own, bool confirmed, const char *line, char *why,
                        size_t size);

#endif
