/* guard.h - slows down those who guess tokens, by the address that they come from.
 *
 * Whoever shows a token stands in line before it is looked at, the right one like a wrong one: else a
 * stranger could tell them apart by the delay, give up the slow ones, and go on at full speed. The
 * line has two reasons, of which the longer one counts:
 *
 *   - earlier wrong tokens of the same connection: 100 ms, 200, 400, ...
 *   - wrong tokens from the same address. It may show BURST of them at once, then one each 100 ms; the
 *     tokens that it shows meanwhile get a place in line, each 100 ms behind the one before. A right
 *     token gives its place back, so that any number of good clients costs nothing.
 *
 * Nobody stands in line for more than GUARD_LONGEST_MS: a good client whose address is shared with
 * somebody who guesses, behind a proxy say, is delayed by so much, and all other clients not at all.
 * So an address can try 10 tokens a second, or a third of the number of its connections if these are
 * more than 30. */
#ifndef SERVER_GUARD_H
#define SERVER_GUARD_H

#include "server/system/notice.h"
#include "server/system/sock.h"

enum {
    GUARD_BURST = 20,
    GUARD_EACH_MS = 100,
    GUARD_LONGEST_MS = 3000,
    GUARD_SETS = 256,
    GUARD_WAYS = 4
};

struct guard_entry {
    uint8_t key[17]; /* kind and address; the first half of an IPv6 address */
    int64_t paid_ms; /* when all that the address has been charged for will be paid off */
    struct notice_rarely told;
};

/* A cache of a fixed size: an address that owes more replaces one that owes less. All zero: empty. */
struct guard {
    struct guard_entry entry[GUARD_SETS][GUARD_WAYS];
};

/* A client at the address, which has shown `wrong` wrong tokens on its connection, shows a token. The
 * moment when that may be looked at: now_ms, or later. The address is charged for it. */
int64_t guard_charge(struct guard *g, const struct sock_peer *peer, unsigned wrong, int64_t now_ms);

/* The token was right: the charge is returned. */
void guard_refund(struct guard *g, const struct sock_peer *peer, int64_t now_ms);

/* The token was wrong: whether to say so to the operator; then *more is how many wrong tokens from
 * that address were not mentioned before this one. */
bool guard_tells(struct guard *g, const struct sock_peer *peer, int64_t now_ms, uint64_t *more);

#endif
