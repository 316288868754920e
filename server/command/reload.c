/* reload.c - see reload.h. */
#include "server/command/reload.h"

#include "server/clients/clients.h"
#include "server/command/account.h"

static void renew_client(struct session *s, const struct auth *now, const struct auth *before,
                         uint64_t asker)
{
    bool stranger = s->token == 0;
    s->role = auth_renew(now, before, &s->token);
    if (stranger || s->token != 0)
        return;
    notice_client(s, NOTICE_INFO, "has a token that was removed: closed");
    if (s->id != asker)
        conn_close(&s->conn);
}

bool reload_tokens(struct server *s, uint64_t asker)
{
    struct auth now, before = s->auth;
    const char *path = s->config->auth_file;
    if (path == NULL) {
        notice(NOTICE_WARNING, "there are no tokens to reload: no --auth-file");
        return false;
    }
    if (!auth_load(&now, path)) {
        notice(NOTICE_ERROR, "%s is not a valid token file: the old tokens stay", path);
        return false;
    }
    for (uint32_t i = 0; s->clients != NULL && i < s->clients->cap; i++) {
        struct session *one = clients_at(s->clients, i);
        if (one != NULL && !one->conn.closed)
            renew_client(one, &now, &before, asker);
    }
    notice(NOTICE_INFO, "%zu tokens have been read from %s", now.n, path);
    s->auth = now;
    auth_clear(&before);
    return true;
}
