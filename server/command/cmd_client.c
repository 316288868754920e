/* cmd_client.c - CLIENT, about connections, and SLOWLOG, the slow log. Without connections (server.clients is NULL)
 * the lists are empty. */
#include "server/command/command.h"

#include "proto/number.h"
#include "server/clients/clients.h"
#include "server/ops/limits.h"
#include "server/system/notice.h"

#include <inttypes.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SLOW_ROWS = 10, SLOW_A_PIECE = 128 };

/* ---- CLIENT ---- */

static const char *state_of(const struct session *s)
{
    switch (s->state) {
    case SESSION_WORKING:
        return "working";
    case SESSION_WAITING:
        return "waiting";
    case SESSION_STREAMING:
        return s->stream->begun ? "sending" : "working";
    case SESSION_READING:
        break;
    }
    if (s->load != NULL)
        return "loading";
    return buf_len(&s->conn.out) > 0 ? "sending" : "idle";
}

/* Without printf, because there may be ten thousand rows, made on a reactor. */
void client_row(struct buf *out, const struct session *s)
{
    static const char *const role[] = {
        [ROLE_NONE] = "none", [ROLE_READ] = "ro", [ROLE_WRITE] = "rw"};
    char peer[SOCK_PEER_TEXT];
    const struct conn *c = &s->conn;
    int64_t now = c->loop->awake_ms;
    sock_peer_text(&s->peer, peer);
    buf_append(out, "id=", 3);
    reply_u64(out, s->id);
    reply_key_text(out, "addr", peer);
    reply_key_text(out, "name", s->name != NULL ? s->name : "");
    reply_key_u64(out, "age", (uint64_t)((now - s->since_ms) / 1000));
    reply_key_u64(out, "idle", (uint64_t)((now - c->heard_ms) / 1000));
    reply_key_text(out, "role", role[s->client.role]);
    reply_key_text(out, "framing", s->resp ? "resp" : "lines");
    reply_key_text(out, "state", state_of(s));
    reply_key_u64(out, "in", buf_len(&c->in));
    reply_key_u64(out, "out", buf_len(&c->out));
    reply_key_u64(out, "watching", s->watches);
    reply_key_u64(out, "reactor", s->reactor->number);
    reply_key_u64(out, "requests", s->requests);
    reply_key_text(out, "command",
                   s->command != NULL ? s->command->name
                   : s->requests > 0  ? "OTHER"
                                      : "");
    reply_end(out);
}

enum { CLIENTS_A_PIECE = 256, CLIENT_BYTES = 256 };

static bool list_clients(struct server *s, uint64_t *at, uint64_t end, struct listing_rows *rows)
{
    const struct clients *c = s->clients;
    uint64_t until = *at + CLIENTS_A_PIECE < end ? *at + CLIENTS_A_PIECE : end;
    for (; *at < until; ++*at) {
        const struct session *one = clients_at(c, (uint32_t)*at);
        if (one == NULL || one->conn.closed)
            continue;
        client_row(&rows->text, one);
        rows->n++;
    }
    return *at < end;
}

void client_list(struct server *s, struct answer *a, enum listing_frame frame)
{
    uint64_t cap = s->clients != NULL ? s->clients->cap : 0, n = cap > 0 ? s->clients->n : 0;
    listing_answer(
        s, a,
        &(struct listing_plan){
            .piece = list_clients, .frame = frame, .end = cap, .bytes = n * CLIENT_BYTES});
}

/* The clients that a KILL names: by id, or by address. */
struct target {
    bool by_id;
    uint64_t id;
    const struct word *address;
};

static bool read_target(const struct request *q, struct target *t)
{
    const struct word *last = &q->word[q->n - 1];
    bool id = q->n == 4 && word_is(&q->word[2], "ID");
    bool address = q->n == 4 && word_is(&q->word[2], "ADDR");
    if (q->n != 3 && !id && !address)
        return false;
    t->address = last;
    t->by_id = !address && proto_read_u64(last->text, last->len, &t->id);
    return t->by_id || !id;
}

static bool is_meant(const struct target *t, const struct session *s)
{
    char peer[SOCK_PEER_TEXT];
    if (t->by_id)
        return s->id == t->id;
    sock_peer_text(&s->peer, peer);
    return t->address->len == strlen(peer) && memcmp(peer, t->address->text, strlen(peer)) == 0;
}

static void kill_one(struct server *s, struct answer *a, struct session *victim)
{
    char peer[SOCK_PEER_TEXT];
    sock_peer_text(&victim->peer, peer);
    notice(NOTICE_INFO, "the client %s was killed by another client", peer);
    s->count.killed++;
    if (victim->id == a->owner)
        a->closes = true; /* after this reply */
    else
        conn_close(&victim->conn);
}

static void kill_clients(struct server *s, const struct request *q, struct answer *a)
{
    const struct clients *c = s->clients;
    struct target target = {0};
    uint64_t n = 0;
    if (!read_target(q, &target)) {
        answer_usage(a);
        return;
    }
    for (uint32_t i = 0; c != NULL && i < c->cap; i++) {
        struct session *one = clients_at(c, i);
        if (one == NULL || one->conn.closed || !is_meant(&target, one))
            continue;
        kill_one(s, a, one);
        n++;
    }
    answer_count(a, "killed", n);
}

bool client_set_name(struct server *s, struct answer *a, const struct word *name)
{
    struct session *me = clients_asker(s, a);
    bool good = name->len <= LIMIT_CLIENT_NAME;
    for (size_t i = 0; good && i < name->len; i++)
        good = name->text[i] > ' ' && name->text[i] <= '~';
    char *copy = good && name->len > 0 ? strndup(name->text, name->len) : NULL;
    if (!good || me == NULL || (copy == NULL && name->len > 0)) {
        free(copy);
        return good;
    }
    free(me->name);
    me->name = copy;
    return true;
}

static void set_name(struct server *s, const struct request *q, struct answer *a)
{
    if (client_set_name(s, a, &q->word[2]))
        answer_ok(a);
    else
        answer_err(a, ERR_SYNTAX, "a client name has at most 64 printable characters and no blank");
}

const char *client_name(const struct server *s, const struct answer *a)
{
    const struct session *me = clients_asker(s, a);
    return me != NULL && me->name != NULL ? me->name : "";
}

static void answer_name(const struct server *s, struct answer *a)
{
    reply_ok(a->out, 0);
    reply_key_text(a->out, "name", client_name(s, a));
    reply_end(a->out);
}

void cmd_client(struct server *s, struct dataset *set, const struct request *q, struct answer *a)
{
    const struct word *what = &q->word[1];
    if (q->n == 2 && word_is(what, "LIST")) {
        if (check_write_role(a))
            client_list(s, a, LISTING_LINES);
    } else if (q->n >= 3 && word_is(what, "KILL")) {
        if (check_write_role(a))
            kill_clients(s, q, a);
    } else if (q->n == 3 && word_is(what, "SETNAME")) {
        set_name(s, q, a);
    } else if (q->n == 4 && word_is(what, "SETINFO")) {
        answer_ok(a); /* the client library is not recorded */
    } else if (q->n == 2 && word_is(what, "ID")) {
        answer_count(a, "id", a->owner);
    } else if (q->n == 2 && word_is(what, "GETNAME")) {
        answer_name(s, a);
    } else {
        answer_usage(a);
    }
}

/* ---- SLOWLOG ---- */

static void append_slow(struct buf *out, const struct slow *e)
{
    char row[SLOW_TEXT + SOCK_PEER_TEXT + 128], peer[SOCK_PEER_TEXT];
    sock_peer_text(&e->peer, peer);
    snprintf(row, sizeof row,
             "%" PRIu64 " at=%" PRId64 " us=%" PRId64 " wait_us=%" PRId64 " client=%" PRIu64
             " addr=%s %s",
             e->id, e->at_s, e->work_us, e->wait_us, e->client, peer, e->text);
    reply_row_text(out, row);
}

bool slowlog_piece(struct server *s, uint64_t *at, uint64_t end, struct listing_rows *rows,
                   void (*append)(struct buf *out, const struct slow *e))
{
    for (int i = 0; *at > end && i < SLOW_A_PIECE; i++) {
        const struct slow *e = slowlog_find(&s->slowlog, --*at);
        if (e == NULL)
            return false;
        append(&rows->text, e);
        rows->n++;
    }
    return *at > end;
}

static bool list_slow(struct server *s, uint64_t *at, uint64_t end, struct listing_rows *rows)
{
    return slowlog_piece(s, at, end, rows, append_slow);
}

/* The number of entries that are requested. */
static bool slowlog_wanted(const struct server *s, const struct request *q, uint32_t *n)
{
    uint32_t there = slowlog_len(&s->slowlog);
    *n = SLOW_ROWS;
    if (q->n == 3 && word_is(&q->word[2], "-1"))
        *n = there;
    else if (q->n == 3 && !proto_read_u32(q->word[2].text, q->word[2].len, n))
        return false;
    *n = *n < there ? *n : there;
    return true;
}

bool slowlog_get(struct server *s, const struct request *q, struct answer *a, listing_piece *piece,
                 enum listing_frame frame)
{
    uint64_t next = s->slowlog.next;
    uint32_t n;
    if (!slowlog_wanted(s, q, &n))
        return false;
    listing_answer(s, a,
                   &(struct listing_plan){.piece = piece,
                                          .frame = frame,
                                          .at = next,
                                          .end = next - n,
                                          .bytes = n * sizeof(struct slow)});
    return true;
}

static void get_slow(struct server *s, const struct request *q, struct answer *a)
{
    if (!slowlog_get(s, q, a, list_slow, LISTING_LINES))
        answer_err(a, ERR_NUMBER, "%.*s is not a number of requests", QUOTED(&q->word[2]));
}

void cmd_slowlog(struct server *s, struct dataset *set, const struct request *q, struct answer *a)
{
    const struct word *what = &q->word[1];
    if (word_is(what, "GET")) {
        get_slow(s, q, a);
    } else if (q->n == 2 && word_is(what, "LEN")) {
        answer_count(a, "len", slowlog_len(&s->slowlog));
    } else if (q->n == 2 && word_is(what, "RESET")) {
        slowlog_reset(&s->slowlog);
        answer_ok(a);
    } else {
        answer_usage(a);
    }
}
