/* cmd_auth.c - AUTH, in both framings: a token is checked, after a delay if necessary (auth_delay.h), and gives a role. */
#include "server/command/command.h"

#include "server/clients/clients.h"

#include <inttypes.h>
#include <stdio.h>

static void accept_token(struct answer *a, enum role role, unsigned number)
{
    a->client.role = role;
    a->client.token = number;
}

/* Counts a wrong token, and writes a message. */
static void note_wrong(struct server *s, struct session *who)
{
    char what[100];
    uint64_t more;
    s->count.wrong_tokens++;
    if (who == NULL)
        return;
    who->wrong_tokens++;
    if (!auth_delay_should_report(&s->auth_delay, &who->peer, who->conn.loop->now_ms, &more))
        return;
    snprintf(what, sizeof what,
             "sent a wrong token (%" PRIu64 " more from its address since the last message)", more);
    notice_client(who, NOTICE_WARNING, what);
}

/* Whether the check of the token is delayed; then the answer has the time. */
static bool must_wait(struct server *s, struct answer *a, const struct session *who)
{
    if (who == NULL || a->waited)
        return false;
    int64_t now = who->conn.loop->now_ms;
    int64_t at = auth_delay_charge(&s->auth_delay, &who->peer, who->wrong_tokens, now);
    if (at <= now)
        return false;
    s->count.delayed_tokens++;
    answer_wait_until(a, at);
    return true;
}

enum shown client_show_token(struct server *s, struct answer *a, const struct word *token)
{
    struct session *who = clients_asker(s, a);
    unsigned number;
    /* Without --auth-file any token is accepted, so that clients need not know the server's options. */
    if (s->auth.n == 0) {
        accept_token(a, ROLE_WRITE, 0);
        return SHOWN_GOOD;
    }
    if (must_wait(s, a, who))
        return SHOWN_LATER;
    enum role role = auth_check(&s->auth, token, &number);
    if (role == ROLE_NONE) {
        note_wrong(s, who);
        return SHOWN_WRONG;
    }
    if (who != NULL)
        auth_delay_refund(&s->auth_delay, &who->peer, who->conn.loop->now_ms);
    accept_token(a, role, number);
    return SHOWN_GOOD;
}

void cmd_auth(struct server *s, struct dataset *set, const struct request *q, struct answer *a)
{
    switch (client_show_token(s, a, &q->word[1])) {
    case SHOWN_LATER:
        break;
    case SHOWN_WRONG:
        answer_err(a, ERR_DENIED, "no such token");
        break;
    case SHOWN_GOOD:
        reply_ok(a->out, 0);
        reply_key_text(a->out, "role", a->client.role == ROLE_WRITE ? "rw" : "ro");
        reply_end(a->out);
        break;
    }
}
