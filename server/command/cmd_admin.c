/* cmd_admin.c - the commands about the server and the connection. */
#include "server/command/command.h"

#include "proto/number.h"
#include "server/jobs/durable.h"

void cmd_ping(struct server *s, struct dataset *set, const struct request *q, struct answer *a)
{
    (void)s, (void)set, (void)q;
    answer_ok(a);
}

void cmd_quit(struct server *s, struct dataset *set, const struct request *q, struct answer *a)
{
    cmd_ping(s, set, q, a);
    a->next = ANSWER_CLOSING;
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

void cmd_snapshot(struct server *s, struct dataset *set, const struct request *q, struct answer *a)
{
    uint64_t lsn;
    (void)set, (void)q;
    switch (durable_begin_snapshot(s, &lsn)) {
    case DURABLE_OFF:
        reply_err(a->out, ERR_IO, "there is no data directory (--data)");
        break;
    case DURABLE_BUSY:
        reply_err(a->out, ERR_BUSY, "a snapshot is being written");
        break;
    case DURABLE_NOMEM:
        answer_out_of_memory(a);
        break;
    case DURABLE_BEGUN:
        reply_ok(a->out, 0);
        reply_key_u64(a->out, "lsn", lsn);
        reply_end(a->out);
    }
}
