/* cmd_admin.c - the commands about the server and the connection, and those about its directory. */
#include "server/command/command.h"

#include "proto/number.h"
#include "proto/version.h"
#include "server/jobs/durable.h"
#include "server/jobs/job.h"

#include <string.h>

void cmd_ping(struct server *s, struct dataset *set, const struct request *q, struct answer *a)
{
    answer_ok(a);
}

void cmd_quit(struct server *s, struct dataset *set, const struct request *q, struct answer *a)
{
    cmd_ping(s, set, q, a);
    a->closes = true;
}

static void help_row(struct answer *a, const struct command *c)
{
    buf_append_text(a->out, c->usage);
    buf_append_text(a->out, " - ");
    reply_row_text(a->out, c->help);
}

void cmd_help(struct server *s, struct dataset *set, const struct request *q, struct answer *a)
{
    const struct command *one = q->n == 2 ? command_find(s, &q->word[1]) : NULL;
    if (q->n == 2 && one == NULL) {
        answer_err(a, ERR_UNKNOWN, "there is no command %.*s", QUOTED(&q->word[1]));
        return;
    }
    reply_ok(a->out, one != NULL ? 1 : s->command_count);
    reply_end(a->out);
    for (size_t i = 0; i < s->command_count; i++)
        if (one == NULL || one == &s->commands[i])
            help_row(a, &s->commands[i]);
}

void cmd_hello(struct server *s, struct dataset *set, const struct request *q, struct answer *a)
{
    uint32_t version = PROTOCOL_VERSION;
    if (q->n == 2 && !proto_read_u32(q->word[1].text, q->word[1].len, &version)) {
        answer_err(a, ERR_NUMBER, "%.*s is not a version", QUOTED(&q->word[1]));
    } else if (version != PROTOCOL_VERSION) {
        answer_err(a, ERR_RANGE, "this server speaks version %d", PROTOCOL_VERSION);
    } else {
        reply_ok(a->out, 0);
        reply_key_text(a->out, "server", "delaunayd");
        reply_key_text(a->out, "version", DELAUNAY_VERSION);
        reply_key_u64(a->out, "protocol", PROTOCOL_VERSION);
        reply_end(a->out);
    }
}

/* ---- the data directory ---- */

static const char no_data[] = "there is no data directory (--data)";

void cmd_snapshot(struct server *s, struct dataset *set, const struct request *q, struct answer *a)
{
    uint64_t lsn;
    switch (durable_begin_snapshot(s, &lsn)) {
    case DURABLE_OFF:
        answer_err(a, ERR_IO, "%s", no_data);
        break;
    case DURABLE_BUSY:
        answer_err(a, ERR_BUSY, "a snapshot is being written");
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

struct backup_job {
    struct job job;
    struct backup backup;
    enum backup_result result;
};

static void run_backup(struct job *j)
{
    struct backup_job *b = (struct backup_job *)j;
    b->result = backup_write(&b->backup);
    j->status = b->result == BACKUP_CANCELLED ? DT_CANCELLED : DT_OK;
}

static void answer_backup(struct answer *a, const struct backup *b)
{
    reply_ok(a->out, 0);
    reply_key_u64(a->out, "lsn", b->lsn);
    reply_key_u64(a->out, "files", b->files);
    reply_key_u64(a->out, "size", b->bytes);
    reply_key_u64(a->out, "copied", b->copied);
    reply_end(a->out);
}

static void end_backup(struct server *s, struct job *j, struct answer *a)
{
    const struct backup_job *b = (struct backup_job *)j;
    const char *why = strerror(b->backup.error);
    if (a == NULL)
        return;
    switch (b->result) {
    case BACKUP_OK:
        durable_note_backup(s, &b->backup);
        answer_backup(a, &b->backup);
        break;
    case BACKUP_EXISTS:
        answer_err(a, ERR_EXISTS, "there is a %s already", b->backup.name);
        break;
    case BACKUP_BUSY:
        answer_err(a, ERR_BUSY, "another backup is being written");
        break;
    case BACKUP_LOG_FAILED:
        answer_err(a, ERR_READONLY, "changes cannot be saved: %s", why);
        break;
    case BACKUP_CANCELLED:
        answer_status(a, DT_CANCELLED);
        break;
    case BACKUP_ERROR:
        answer_err(a, ERR_IO, "the backup cannot be written: %s", why);
    }
}

void cmd_backup(struct server *s, struct dataset *set, const struct request *q, struct answer *a)
{
    const struct word *name = &q->word[1];
    if (!backup_may_name(name->text, name->len)) {
        answer_err(a, ERR_SYNTAX,
                   "a backup's name is 1 to 64 of A-Z a-z 0-9 _ . : -, without . in front or .tmp "
                   "at the end");
        return;
    }
    struct backup_job *b = job_new(sizeof *b, run_backup, end_backup);
    if (b == NULL) {
        answer_out_of_memory(a);
        return;
    }
    memcpy(b->backup.name, name->text, name->len);
    b->backup.cancel = &b->job.cancel;
    b->job.what = "writing a backup";
    const char *missing = !durable_prepare_backup(s, &b->backup) ? no_data
                          : b->backup.under == NULL
                              ? "there is no directory for backups (--backup-dir)"
                              : NULL;
    if (missing == NULL) {
        job_aside(s, a, &b->job, JOB_LONG);
        return;
    }
    answer_err(a, ERR_IO, "%s", missing);
    job_free(s, &b->job);
}
