/* reload.c - see reload.h. */
#include "server/clients/reload.h"

#include "server/clients/clients.h"

#include <stdlib.h>

/* number: as of auth_renumber. */
static void renew_client(struct session *s, const struct auth *now, const unsigned *number,
                         uint64_t asker)
{
    if (s->client.token == 0)
        return;
    s->client.token = number[s->client.token - 1];
    s->client.role = auth_role(now, s->client.token);
    if (s->client.token != 0)
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
    if (!auth_load(&now, path))
        return notice_error("%s is not a valid token file: the old tokens stay", path);
    unsigned *number = malloc((before.n + 1) * sizeof *number);
    if (number == NULL || !auth_renumber(&now, &before, number)) {
        notice_error("out of memory: the old tokens stay");
        free(number);
        auth_clear(&now);
        return false;
    }
    for (uint32_t i = 0; s->clients != NULL && i < s->clients->cap; i++) {
        struct session *one = clients_at(s->clients, i);
        if (one != NULL && !one->conn.closed)
            renew_client(one, &now, number, asker);
    }
    notice(NOTICE_INFO, "%zu tokens have been read from %s", now.n, path);
    s->auth = now;
    auth_clear(&before);
    free(number);
    return true;
}
