/* auth_delay.c - see auth_delay.h. For addresses this is the generic cell rate algorithm: each address has one time
 * value, when its charges will be paid off, and every charge advances it by 100 ms. */
#include "server/ops/auth_delay.h"

#include <string.h>

enum { HALF_IPV6 = 8, CREDIT_MS = AUTH_DELAY_BURST * AUTH_DELAY_EACH_MS };

static int64_t later(int64_t a, int64_t b)
{
    return a > b ? a : b;
}

static int64_t sooner(int64_t a, int64_t b)
{
    return a < b ? a : b;
}

/* An IPv6 network is identified by the first half of its addresses. An IPv4 address that is mapped into
 * IPv6 counts as the IPv4 address. */
static void key_of(const struct sock_peer *peer, uint8_t key[17])
{
    static const uint8_t mapped[12] = {[10] = 0xFF, [11] = 0xFF};
    enum sock_kind kind = peer->kind;
    const uint8_t *address = peer->address;
    if (kind == SOCK_V6 && memcmp(address, mapped, sizeof mapped) == 0) {
        kind = SOCK_V4;
        address += sizeof mapped;
    }
    memset(key, 0, 17);
    key[0] = (uint8_t)kind;
    if (kind != SOCK_UNIX)
        memcpy(key + 1, address, kind == SOCK_V4 ? 4 : HALF_IPV6);
}

static uint32_t hash(const uint8_t key[17]) /* FNV-1a */
{
    uint32_t h = 2166136261u;
    for (int i = 0; i < 17; i++)
        h = (h ^ key[i]) * 16777619u;
    return h ^ h >> 15;
}

/* The entry of the address; a new one replaces the entry with the lowest debt of its set. */
static struct auth_delay_entry *entry_of(struct auth_delay *d, const struct sock_peer *peer)
{
    uint8_t key[17];
    key_of(peer, key);
    struct auth_delay_entry *set = d->entry[hash(key) % AUTH_DELAY_SETS], *least = set;
    for (int i = 0; i < AUTH_DELAY_WAYS; i++) {
        if (memcmp(set[i].key, key, sizeof key) == 0)
            return &set[i];
        if (set[i].paid_ms < least->paid_ms)
            least = &set[i];
    }
    *least = (struct auth_delay_entry){0};
    memcpy(least->key, key, sizeof key);
    return least;
}

/* 100 ms after the first wrong token, doubled with each further one. */
static int64_t wait_of_connection(unsigned wrong)
{
    return wrong == 0 ? 0 : wrong > 6 ? AUTH_DELAY_LONGEST_MS : AUTH_DELAY_EACH_MS << (wrong - 1);
}

int64_t auth_delay_charge(struct auth_delay *d, const struct sock_peer *peer, unsigned wrong,
                          int64_t now_ms)
{
    struct auth_delay_entry *e = entry_of(d, peer);
    e->paid_ms = sooner(later(e->paid_ms, now_ms) + AUTH_DELAY_EACH_MS,
                        now_ms + CREDIT_MS + AUTH_DELAY_LONGEST_MS);
    return sooner(later(now_ms + wait_of_connection(wrong), e->paid_ms - CREDIT_MS),
                  now_ms + AUTH_DELAY_LONGEST_MS);
}

void auth_delay_refund(struct auth_delay *d, const struct sock_peer *peer, int64_t now_ms)
{
    struct auth_delay_entry *e = entry_of(d, peer);
    e->paid_ms = later(e->paid_ms - AUTH_DELAY_EACH_MS, now_ms);
}

bool auth_delay_should_report(struct auth_delay *d, const struct sock_peer *peer, int64_t now_ms,
                              uint64_t *more)
{
    return notice_rarely(&entry_of(d, peer)->messages, now_ms, more);
}
