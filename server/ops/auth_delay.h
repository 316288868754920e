/* auth_delay.h - rate limiting of AUTH by address, against guessed tokens.
 *
 * The check of a token is delayed, whether the token is right or wrong. Otherwise an attacker could recognise a wrong
 * token by its delay, abandon the attempt and continue at full speed. The delay is the
 * longer one of two:
 *
 *   - for earlier wrong tokens of the same connection: 100 ms, 200, 400, ...
 *   - for tokens from the same address: AUTH_DELAY_BURST of them are checked at once, then one every 100 ms;
 *     further tokens queue up 100 ms apart. A right token returns its charge, so that any number of
 *     legitimate clients is not delayed.
 *
 * No delay exceeds AUTH_DELAY_LONGEST_MS. This is the longest delay of a legitimate client whose address is shared with an
 * attacker, for instance behind a proxy. Clients from other addresses are not delayed at all. So an
 * address can try 10 tokens a second, or a third of the number of its connections if it has more than
 * 30. */
#pragma once

#include "server/system/notice.h"
#include "server/system/sock.h"

enum {
    AUTH_DELAY_BURST = 20,
    AUTH_DELAY_EACH_MS = 100,
    AUTH_DELAY_LONGEST_MS = 3000,
    AUTH_DELAY_SETS = 256, /* of the cache: an address is in one of them */
    AUTH_DELAY_WAYS = 4    /* entries of a set */
};

struct auth_delay_entry {
    uint8_t key[17]; /* kind and address; the first half of an IPv6 address */
    int64_t paid_ms; /* when all charges of the address will be paid off */
    struct notice_rarely messages;
};

/* A cache of fixed size: a new address replaces the one with the lowest debt. All zero: empty. */
struct auth_delay {
    struct auth_delay_entry entry[AUTH_DELAY_SETS][AUTH_DELAY_WAYS];
};

/* Charges the address for a token and returns when the token may be checked: now_ms, or later. `wrong`: the
 * number of wrong tokens on this connection so far. */
int64_t auth_delay_charge(struct auth_delay *d, const struct sock_peer *peer, unsigned wrong,
                          int64_t now_ms);

/* The token was right: returns the charge. */
void auth_delay_refund(struct auth_delay *d, const struct sock_peer *peer, int64_t now_ms);

/* The token was wrong: whether to write a message; then *more is the number of wrong tokens from that
 * address without a message since the last one. */
bool auth_delay_should_report(struct auth_delay *d, const struct sock_peer *peer, int64_t now_ms,
                              uint64_t *more);
