/* consent.h - whether a daemon may follow a leader: never if that would silently discard changes that the leader does not
 * have. */
#pragma once

#include "server/follow/position.h"

#include <stdbool.h>
#include <stddef.h>

enum consent {
    CONSENT_GIVEN,
    CONSENT_REFUSED, /* only an operator can decide (CONFIRM) */
    CONSENT_LATER    /* the leader has answered with an error, or not as a leader does */
};

/* A daemon that asks to follow. */
struct asker {
    struct position at; /* lsn 0: it has no changes */
    bool own;           /* it may have changes that no leader has sent */
    bool confirmed;     /* its changes may be discarded */
};

/* Decides by the leader's reply to SYNC. Unless the result is CONSENT_GIVEN, why[size] gets the reason. */
enum consent consent_to(const struct asker *a, const char *line, char *why, size_t size);

/* Reads the leader's history from that reply. False: it is an error, or none of a leader. */
bool consent_read_history(const char *line, struct history *theirs);
