/* cmd_follow.c - see cmd_follow.h. */
#include "server/follow/cmd_follow.h"

#include "proto/number.h"
#include "server/clients/clients.h"
#include "server/follow/follower.h"
#include "server/follow/leader.h"
#include "server/jobs/durable.h"
#include "server/system/sock.h"

#include <fcntl.h>
#include <inttypes.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

/* Whether this daemon can lead or follow; if not, the ERR line has been written. */
static bool check_data(const struct server *s, struct answer *a)
{
    if (s->durable == NULL || s->leader == NULL)
        answer_err(a, ERR_IO, "there is no data directory (--data)");
    else if (durable_dir(s) == NULL || !durable_is_complete(s))
        answer_err(a, ERR_LOADING, "the data directory is being read; try again");
    else
        return true;
    return false;
}

/* ---- FOLLOW ---- */

static bool copy_word(const struct word *w, char *to, size_t size)
{
    if (w->len >= size)
        return false;
    memcpy(to, w->text, w->len);
    to[w->len] = '\0';
    return true;
}

static void answer_why(struct answer *a, const char *why)
{
    if (why == NULL)
        answer_ok(a);
    else
        answer_err(a, ERR_BUSY, "%s", why);
}

/* Follows the daemon at that address, when it has said that it is another one, and a leader. */
static void follow(struct server *s, struct answer *a, const char *host, unsigned port,
                   bool confirmed)
{
    char why[200], address[ROLE_TEXT];
    struct request_queue *queue;
    role_write_address(address, host, port);
    switch (follower_examine(s, host, port, &queue, why, sizeof why)) {
    case FOLLOW_ASKED:
        answer_wait(a, queue, false);
        break;
    case FOLLOW_ITSELF:
        answer_err(a, ERR_RANGE, "%s is this daemon itself", address);
        break;
    case FOLLOW_IMPOSSIBLE:
        answer_err(a, ERR_RANGE, "%s cannot be followed: %s", address, why);
        break;
    case FOLLOW_POSSIBLE:
        answer_why(a, follower_follow(s, host, port, confirmed));
        break;
    }
}

void cmd_follow(struct server *s, struct dataset *set, const struct request *q, struct answer *a)
{
    char host[ROLE_ADDRESS];
    uint32_t port;
    bool none = q->n == 2 && word_is(&q->word[1], "NONE");
    bool confirmed = q->n == 4 && word_is(&q->word[3], "CONFIRM");
    if (!none && q->n != 3 && !confirmed)
        answer_usage(a);
    else if (!check_data(s, a))
        ;
    else if (none)
        answer_why(a, follower_promote(s));
    else if (!copy_word(&q->word[1], host, sizeof host) || !sock_is_address(host, NULL))
        answer_err(a, ERR_SYNTAX, "%.*s is not a numeric IPv4 or IPv6 address",
                   QUOTED(&q->word[1]));
    else if (!proto_read_u32(q->word[2].text, q->word[2].len, &port) || port == 0 || port > 65535)
        answer_err(a, ERR_NUMBER, "%.*s is not a port", QUOTED(&q->word[2]));
    else
        follow(s, a, host, port, confirmed);
}

/* ---- SYNC ---- */

void cmd_sync(struct server *s, struct dataset *set, const struct request *q, struct answer *a)
{
    struct session *who = clients_asker(s, a);
    struct position from;
    if (!history_read(q->word[1].text, q->word[1].len, &from.history) ||
        !proto_read_u64(q->word[2].text, q->word[2].len, &from.lsn) || q->word[3].len != 16 ||
        !proto_read_hex(q->word[3].text, 16, &from.digest)) {
        answer_usage(a);
        return;
    }
    if (!check_data(s, a))
        return;
    follower_meet(s, &from.history);
    if (s->read_only.why != NULL) {
        answer_err(a, ERR_READONLY, "%s", s->read_only.why);
        return;
    }
    if (who == NULL)
        return;
    int fd = fcntl(who->conn.source.fd, F_DUPFD_CLOEXEC, 0);
    if (fd < 0 || !leader_add(s, fd, &who->peer, &from)) {
        if (fd >= 0)
            close(fd);
        answer_out_of_memory(a);
        return;
    }
    a->broken = true; /* the connection is that of the follower's thread now */
}

/* ---- WAIT ---- */

enum { WAIT_MOST_S = 1000000 };

void cmd_wait(struct server *s, struct dataset *set, const struct request *q, struct answer *a)
{
    struct session *who = clients_asker(s, a);
    uint32_t followers;
    double seconds;
    if (!read_count(a, &q->word[1], "a number of followers", &followers))
        return;
    if (!proto_read_double(q->word[2].text, q->word[2].len, &seconds) || !(seconds >= 0) ||
        seconds > WAIT_MOST_S) {
        answer_err(a, ERR_NUMBER, "%.*s is not a number of seconds", QUOTED(&q->word[2]));
        return;
    }
    int64_t now = clock_ms();
    unsigned n = leader_count(s, who == NULL ? 0 : who->edited);
    if (who != NULL && who->wait_ms == 0)
        who->wait_ms = now + (int64_t)(seconds * 1000);
    if (n < followers && s->leader != NULL && who != NULL && now < who->wait_ms) {
        answer_wait(a, leader_queue(s, who->wait_ms), false);
        return;
    }
    if (who != NULL)
        who->wait_ms = 0;
    answer_count(a, "followers", n);
}

/* ---- INFO ---- */

/* The n-th one; the log here ends at `last`. */
static void add_follower(struct facts *facts, const struct sender *f, unsigned n, uint64_t last)
{
    static const char *const state[] = {"starting", "snapshot", "log", "ended"};
    char key[32], value[240], peer[SOCK_PEER_TEXT];
    uint64_t acked = f->acked, sent = f->sent_bytes, acked_bytes = f->acked_bytes;
    int64_t silent = f->silent_ms, now = clock_ms();
    int at = f->state;
    sock_peer_text(&f->peer, peer);
    snprintf(key, sizeof key, "follower_%u", n);
    snprintf(value, sizeof value,
             "address=%s,state=%s,lsn=%" PRIu64 ",lag_records=%" PRIu64 ",lag_bytes=%" PRIu64
             ",lag_s=%.3f,silent_s=%.3f",
             peer, state[at], acked, last > acked ? last - acked : 0,
             sent > acked_bytes ? sent - acked_bytes : 0,
             f->behind_ms == 0 ? 0 : (double)(now - f->behind_ms) / 1000,
             silent == 0 ? 0 : (double)(now - silent) / 1000);
    facts_add_text(facts, key, value);
}

void follow_facts(const struct server *s, struct facts *f)
{
    struct follower_facts own;
    const struct datadir *dir = durable_dir(s);
    const struct log_status *log = durable_status(s);
    char history[HISTORY_TEXT] = "", digest[20] = "", daemon[20];
    const uint64_t last = durable_last_lsn(s);
    unsigned n = 0;
    follower_facts(s, &own);
    facts_add_text(f, "role", own.role);
    if (dir != NULL) {
        history_write(history, &dir->lineage.history);
        snprintf(digest, sizeof digest, "%016" PRIx64, log->digest);
    }
    facts_add_text(f, "history", history);
    facts_add(f, "lsn", last);
    facts_add(f, "durable_lsn", dir == NULL ? 0 : log->durable);
    facts_add_text(f, "log_digest", digest);
    facts_add_text(f, "leader", own.leader);
    facts_add_text(f, "link", own.state);
    facts_add_text(f, "link_error", own.why);
    facts_add(f, "link_lag_records", own.leader_lsn > last ? own.leader_lsn - last : 0);
    facts_add_text(f, "uninformed_leader", own.former);
    snprintf(daemon, sizeof daemon, "%016" PRIx64, own.identity);
    facts_add_text(f, "daemon", daemon);
    facts_add(f, "settled", own.settled);
    facts_add(f, "generation", dir == NULL ? 0 : dir->lineage.history.generation);
    facts_add(f, "followers", leader_followers(s));
    facts_add(f, "min_followers", s->config->min_followers);
    for (const struct sender *one = NULL; (one = leader_next(s, one)) != NULL;)
        add_follower(f, one, ++n, last);
}
