/* cmd_admin.c - the commands about the server and the connection. */
#include "server/command.h"

#include "proto/number.h"
#include "server/durable.h"
#include "server/loop.h"

#include <inttypes.h>
#include <stdio.h>
#include <unistd.h>

void cmd_ping(struct server *s, struct dataset *set, const struct request *q, struct answer *a)
{
    (void)s, (void)set, (void)q;
    reply_ok(a->out, 0);
    reply_end(a->out);
}

void cmd_quit(struct server *s, struct dataset *set, const struct request *q, struct answer *a)
{
    cmd_ping(s, set, q, a);
    a->close = true;
}

static void help_row(struct answer *a, const struct command *c)
{
    buf_append_text(a->out, c->usage);
    buf_append_text(a->out, " - ");
    reply_row_text(a->out, c->help);
}

void cmd_help(struct server *s, struct dataset *set, const struct request *q, struct answer *a)
{
    (void)s, (void)set;
    const struct command *one = q->n == 2 ? command_find(&q->word[1]) : NULL;
    if (q->n == 2 && one == NULL) {
        reply_err(a->out, ERR_UNKNOWN, "there is no command %.*s", QUOTED(&q->word[1]));
        return;
    }
    reply_ok(a->out, one != NULL ? 1 : command_count);
    reply_end(a->out);
    for (size_t i = 0; i < command_count; i++)
        if (one == NULL || one == &commands[i])
            help_row(a, &commands[i]);
}

void cmd_hello(struct server *s, struct dataset *set, const struct request *q, struct answer *a)
{
    uint32_t version = PROTOCOL_VERSION;
    (void)s, (void)set;
    if (q->n == 2 && !proto_read_u32(q->word[1].text, q->word[1].len, &version)) {
        reply_err(a->out, ERR_NUMBER, "%.*s is not a version", QUOTED(&q->word[1]));
    } else if (version != PROTOCOL_VERSION) {
        reply_err(a->out, ERR_RANGE, "this server speaks version %d", PROTOCOL_VERSION);
    } else {
        reply_ok(a->out, 0);
        reply_key_text(a->out, "server", "delaunayd");
        reply_key_text(a->out, "version", DELAUNAYD_VERSION);
        reply_key_u64(a->out, "protocol", PROTOCOL_VERSION);
        reply_end(a->out);
    }
}

void cmd_auth(struct server *s, struct dataset *set, const struct request *q, struct answer *a)
{
    (void)set;
    /* Without --auth-file any token is welcome, so that a client need not know how its server was
     * started. */
    enum role role = s->auth.n == 0 ? ROLE_WRITE : auth_check(&s->auth, &q->word[1]);
    if (role == ROLE_NONE) {
        reply_err(a->out, ERR_DENIED, "no such token");
        return;
    }
    a->role = role;
    reply_ok(a->out, 0);
    reply_key_text(a->out, "role", role == ROLE_WRITE ? "rw" : "ro");
    reply_end(a->out);
}

void cmd_info(struct server *s, struct dataset *set, const struct request *q, struct answer *a)
{
    (void)set, (void)q;
    struct durable_facts disk;
    durable_facts(s, &disk);
    const struct {
        const char *key;
        uint64_t value;
    } fact[] = {
        {"protocol", PROTOCOL_VERSION},
        {"pid", (uint64_t)getpid()},
        {"uptime_s", (uint64_t)(clock_ms() - s->started_ms) / 1000},
        {"threads", s->config->threads},
        {"clients", s->clients},
        {"max_clients", s->config->max_clients},
        {"connections", s->count.connections},
        {"refused", s->count.refused},
        {"commands", s->count.commands},
        {"errors", s->count.errors},
        {"jobs", s->count.jobs},
        {"sets", s->sets.sets},
        {"memory", s->sets.memory},
        {"loading", s->loading},
        {"max_memory", s->config->max_memory},
        {"max_points", s->config->max_points},
        {"loaded_percent", disk.loaded_percent},
        {"log_lsn", disk.lsn},
        {"log_durable_lsn", disk.durable_lsn},
        {"log_synced_lsn", disk.synced_lsn},
        {"log_bytes", disk.log_bytes},
        {"log_syncs", disk.log_syncs},
        {"log_failures", disk.log_failures},
        {"snapshot_lsn", disk.snapshot_lsn},
        {"snapshot_bytes", disk.snapshot_bytes},
        {"snapshots", disk.snapshots},
        {"snapshot_running", disk.snapshot_running},
    };
    size_t n = sizeof fact / sizeof fact[0];
    reply_ok(a->out, n + 2);
    reply_end(a->out);
    reply_row_text(a->out, "version:" DELAUNAYD_VERSION);
    buf_append_text(a->out, "durability:");
    reply_row_text(a->out, disk.state);
    for (size_t i = 0; i < n; i++) {
        char row[64];
        snprintf(row, sizeof row, "%s:%" PRIu64, fact[i].key, fact[i].value);
        reply_row_text(a->out, row);
    }
}
