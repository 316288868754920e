/* redis.c - see redis.h. This does no more than tools need in order to start. */
#include "server/redis/redis.h"

#include "proto/number.h"
#include "proto/resp.h"
#include "proto/version.h"
#include "server/clients/clients.h"
#include "server/command/load.h"
#include "server/ops/setting.h"
#include "server/redis/keys.h"
#include "server/redis/redis_reply.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

static void ping(struct server *s, const struct request *q, struct answer *a)
{
    (void)s;
    if (q->n == 2)
        resp_bulk(a->out, q->word[1].text, q->word[1].len);
    else
        redis_simple(a, "+PONG");
}

static void echo(struct server *s, const struct request *q, struct answer *a)
{
    (void)s;
    if (q->n == 2)
        resp_bulk(a->out, q->word[1].text, q->word[1].len);
    else
        redis_usage(a, "ECHO message");
}

static void select_db(struct server *s, const struct request *q, struct answer *a)
{
    (void)s;
    if (q->n == 2 && word_is(&q->word[1], "0"))
        redis_simple(a, "+OK");
    else
        redis_simple(a, "-RANGE there is only the database 0");
}

/* A command in the format of COMMAND: name, number of words (negative: at least), flags, and the positions
 * of the first and the last key and the step between keys; the name of a set is a key. */
static void describe(struct answer *a, const struct command *c)
{
    char name[32], text[32];
    bool set = (c->flags & CMD_SET) != 0;
    size_t len = strlen(c->name);
    for (size_t i = 0; i < len; i++)
        name[i] = (char)(c->name[i] - 'A' + 'a');
    resp_array(a->out, 6);
    resp_bulk(a->out, name, len);
    snprintf(text, sizeof text, ":%s%u", c->least == c->most ? "" : "-", c->least);
    redis_simple(a, text);
    resp_array(a->out, 1);
    redis_simple(a, (c->flags & CMD_WRITE) != 0 ? "+write" : "+readonly");
    for (int i = 0; i < 3; i++)
        redis_integer(a, set);
}

static void command(struct server *s, const struct request *q, struct answer *a)
{
    (void)s;
    if (q->n >= 2 && word_is(&q->word[1], "COUNT")) {
        redis_integer(a, (int64_t)command_count);
    } else if (q->n >= 2) { /* DOCS, INFO, ...: empty */
        resp_array(a->out, 0);
    } else {
        resp_array(a->out, command_count);
        for (size_t i = 0; i < command_count; i++)
            describe(a, &commands[i]);
    }
}

static void answer_name(struct answer *a, const struct line_reply *t)
{
    const char *name;
    size_t len = 0;
    if (reply_key(&t->status, "name", &name, &len) && len > 0)
        resp_bulk(a->out, name, len);
    else
        redis_null(a);
}

static void client(struct server *s, const struct request *q, struct answer *a)
{
    struct line_reply t;
    if (q->n == 2 && word_is(&q->word[1], "LIST") && a->role == ROLE_WRITE) {
        client_list(s, a, LISTING_BULK);
        return;
    }
    if (!redis_ask(s, q, a, "", &t))
        return;
    const struct word *what = &q->word[1];
    if (word_is(what, "ID"))
        redis_integer(a, (int64_t)line_reply_number(&t, "id"));
    else if (word_is(what, "GETNAME"))
        answer_name(a, &t);
    else if (word_is(what, "KILL") && q->n == 4)
        redis_integer(a, (int64_t)line_reply_number(&t, "killed"));
    else if (word_is(what, "KILL") && line_reply_number(&t, "killed") == 0)
        redis_simple(a, "-ERR No such client");
    else
        redis_simple(a, "+OK");
    line_reply_clear(&t);
}

/* Redis tools ask for settings that do not exist here, and only print their values: these are empty. */
static bool is_foreign(const struct word *name)
{
    return setting_find(name->text, name->len) == NULL &&
           memchr(name->text, '*', name->len) == NULL && memchr(name->text, '?', name->len) == NULL;
}

/* The matching settings: names and values. */
static void get_settings(struct server *s, const struct request *q, struct answer *a)
{
    char text[SETTING_TEXT_ROOM];
    const struct word *asked = q->word + 2;
    size_t n = 0;
    for (size_t i = 0; i < setting_count; i++)
        n += setting_asked(&settings[i], asked, q->n - 2) != NULL;
    for (size_t i = 2; i < q->n; i++)
        n += is_foreign(&q->word[i]);
    redis_map(a, n);
    for (size_t i = 0; i < setting_count; i++) {
        const char *name = setting_asked(&settings[i], asked, q->n - 2);
        if (name != NULL) {
            redis_bulk_text(a, name);
            redis_bulk_text(a, setting_text(&settings[i], s->config, text));
        }
    }
    for (size_t i = 2; i < q->n; i++) {
        if (is_foreign(&q->word[i])) {
            resp_bulk(a->out, q->word[i].text, q->word[i].len);
            redis_bulk_text(a, "");
        }
    }
}

static void config(struct server *s, const struct request *q, struct answer *a)
{
    struct line_reply t;
    if (q->n >= 3 && word_is(&q->word[1], "GET")) {
        get_settings(s, q, a);
    } else if (redis_ask(s, q, a, "", &t)) {
        redis_simple(a, "+OK");
        line_reply_clear(&t);
    }
}

/* An entry in the format of Redis: id, time, microseconds, words, address, name. */
static void append_slow(struct buf *out, const struct slow *e)
{
    struct answer row = {.out = out}, *a = &row;
    char peer[SOCK_PEER_TEXT];
    size_t words = 1;
    for (const char *p = e->text; *p != '\0'; p++)
        words += *p == ' ';
    resp_array(a->out, 6);
    redis_integer(a, (int64_t)e->id);
    redis_integer(a, e->at_s);
    redis_integer(a, e->work_us + e->wait_us);
    resp_array(a->out, words);
    for (const char *p = e->text; words > 0; words--) {
        size_t len = strcspn(p, " ");
        resp_bulk(a->out, p, len);
        p += len + 1;
    }
    sock_peer_text(&e->peer, peer);
    redis_bulk_text(a, peer);
    redis_bulk_text(a, "");
}

static bool list_slow(struct server *s, uint64_t *at, uint64_t end, struct listing_rows *rows)
{
    return slowlog_piece(s, at, end, rows, append_slow);
}

static void slowlog(struct server *s, const struct request *q, struct answer *a)
{
    struct line_reply t;
    uint32_t n;
    uint64_t next = s->slowlog.next;
    if (q->n >= 2 && q->n <= 3 && word_is(&q->word[1], "GET") && a->role == ROLE_WRITE &&
        slowlog_wanted(s, q, &n)) {
        listing_answer_framed(s, a, list_slow, LISTING_ARRAY, next, next - n,
                              n * sizeof(struct slow));
        return;
    }
    if (!redis_ask(s, q, a, "", &t))
        return;
    if (word_is(&q->word[1], "LEN")) {
        redis_integer(a, (int64_t)line_reply_number(&t, "len"));
    } else {
        redis_simple(a, "+OK");
    }
    line_reply_clear(&t);
}

/* Redis's names of sections, and the closest sections here. */
static const struct {
    const char *theirs, *ours;
} renamed[] = {
    {"DEFAULT", "ALL"},   {"EVERYTHING", "ALL"},        {"PERSISTENCE", "DURABILITY"},
    {"KEYSPACE", "SETS"}, {"COMMANDSTATS", "COMMANDS"}, {"LATENCYSTATS", "COMMANDS"},
};

/* Whether q, an INFO, asks for the section. */
static bool asks_for(const struct request *q, const char *section)
{
    bool asked = q->n == 1;
    for (size_t i = 1; i < q->n; i++)
        asked |= word_is(&q->word[i], section) || word_is(&q->word[i], "ALL");
    return asked;
}

static void add_fact(struct buf *rows, const char *key, uint64_t value, const char *rest)
{
    char text[96];
    snprintf(text, sizeof text, "%s%" PRIu64 "%s\r\n", key, value, rest);
    buf_append_text(rows, text);
}

static void add_keyspace(const struct server *s, struct buf *rows)
{
    char rest[64];
    snprintf(rest, sizeof rest, ",expires=%zu,avg_ttl=0", s->sets.expiring);
    add_fact(rows, "db0:keys=", s->sets.sets, rest);
}

/* The facts that redis-cli --stat and other tools read, by Redis's names. */
static void add_redis_facts(struct server *s, const struct request *q, struct buf *rows)
{
    if (asks_for(q, "CLIENTS")) {
        add_fact(rows, "connected_clients:", s->clients != NULL ? s->clients->n : 0, "");
        add_fact(rows, "blocked_clients:", 0, "");
    }
    if (asks_for(q, "MEMORY"))
        add_fact(rows, "used_memory:", budget_used(&s->budget), "");
    if (asks_for(q, "STATS")) {
        add_fact(rows, "total_connections_received:", s->count.connections, "");
        add_fact(rows, "total_commands_processed:", s->count.commands, "");
    }
    if (asks_for(q, "SETS"))
        add_keyspace(s, rows);
}

/* The rows of INFO as one text, as in Redis. */
static void info(struct server *s, const struct request *q, struct answer *a)
{
    struct line_reply t;
    for (size_t i = 1; i < q->n; i++)
        for (size_t k = 0; k < sizeof renamed / sizeof renamed[0]; k++)
            if (word_is(&q->word[i], renamed[k].theirs))
                q->word[i] = (struct word){renamed[k].ours, strlen(renamed[k].ours)};
    if (!redis_ask(s, q, a, "\r\n", &t))
        return;
    add_redis_facts(s, q, &t.rows);
    if (t.rows.failed)
        answer_out_of_memory(a);
    else
        resp_bulk(a->out, buf_head(&t.rows), buf_len(&t.rows));
    line_reply_clear(&t);
}

/* False: the token is wrong, and the error has been written; or the check is delayed. */
static bool show_token(struct server *s, const struct word *token, struct answer *a)
{
    enum shown shown = client_show_token(s, a, token);
    if (shown == SHOWN_WRONG)
        redis_simple(a, "-DENIED no such token");
    return shown == SHOWN_GOOD;
}

/* AUTH user token: the name is ignored. */
static void auth(struct server *s, const struct request *q, struct answer *a)
{
    if (q->n != 2 && q->n != 3)
        redis_usage(a, "AUTH [user] token");
    else if (show_token(s, &q->word[q->n - 1], a))
        redis_simple(a, a->role == ROLE_WRITE ? "+OK role=rw" : "+OK role=ro");
}

static void greet(struct answer *a, uint32_t version)
{
    enum { FACTS = 7 };
    a->typed = version == 3;
    redis_map(a, FACTS);
    redis_bulk_text(a, "server");
    redis_bulk_text(a, "delaunayd");
    redis_bulk_text(a, "version");
    redis_bulk_text(a, DELAUNAY_VERSION);
    redis_bulk_text(a, "proto");
    redis_integer(a, version);
    redis_bulk_text(a, "id");
    redis_integer(a, (int64_t)a->owner);
    redis_bulk_text(a, "mode");
    redis_bulk_text(a, "standalone");
    redis_bulk_text(a, "role");
    redis_bulk_text(a, "master");
    redis_bulk_text(a, "modules");
    resp_array(a->out, 0);
}

/* HELLO [2|3 [AUTH user token] [SETNAME name]]; other versions are our own HELLO's. */
static void hello(struct server *s, const struct request *q, struct answer *a)
{
    uint32_t version = a->typed ? 3 : 2;
    if (q->n >= 2 && (!proto_read_u32(q->word[1].text, q->word[1].len, &version) || version < 2 ||
                      version > 3)) {
        redis_simple(a, "-RANGE this server speaks RESP 2 and 3");
        return;
    }
    for (size_t at = 2; at < q->n;) {
        if (at + 2 < q->n && word_is(&q->word[at], "AUTH")) {
            if (!show_token(s, &q->word[at + 2], a))
                return;
            at += 3;
        } else if (at + 1 < q->n && word_is(&q->word[at], "SETNAME")) {
            client_set_name(s, a, &q->word[at + 1]);
            at += 2;
        } else {
            redis_usage(a, "HELLO [2|3 [AUTH user token] [SETNAME name]]");
            return;
        }
    }
    if (a->role == ROLE_NONE)
        redis_simple(a, "-NOAUTH authenticate first: AUTH token");
    else
        greet(a, version);
}

/* ---- transactions, which are not supported ----
 *
 * Clients send MULTI, the commands and EXEC at once. If only MULTI were refused, the commands would be carried out one by
 * one, and the client would believe that they were not. So all commands that follow are refused as well, until EXEC or DISCARD. */

static void multi(struct server *s, const struct request *q, struct answer *a)
{
    (void)s, (void)q;
    a->multi = true;
    redis_simple(a, "-UNKNOWN there are no transactions: send the commands without MULTI and EXEC "
                    "(redis-py: pipeline(transaction=False))");
}

static void exec(struct server *s, const struct request *q, struct answer *a)
{
    (void)s, (void)q;
    redis_simple(a, a->multi ? "-EXECABORT there are no transactions: nothing was carried out"
                             : "-ERR EXEC without MULTI");
    a->multi = false;
}

static void discard(struct server *s, const struct request *q, struct answer *a)
{
    (void)s, (void)q;
    redis_simple(a, a->multi ? "+OK" : "-ERR DISCARD without MULTI");
    a->multi = false;
}

static void watch(struct server *s, const struct request *q, struct answer *a)
{
    (void)s, (void)q;
    redis_simple(a, "-UNKNOWN there are no transactions, so no WATCH and UNWATCH");
}

static void refuse_in_multi(struct server *s, const struct request *q, struct answer *a)
{
    redis_simple(a, "-UNKNOWN not carried out: it follows MULTI, and there are no transactions");
    command_skip_body(s, q, a);
}

static const struct {
    const char *name;
    bool open; /* allowed before AUTH */
    redis_handler *handler;
} table[] = {
    {"PING", true, ping},
    {"HELLO", true, hello},
    {"AUTH", true, auth},
    {"ECHO", false, echo},
    {"SELECT", false, select_db},
    {"CLIENT", false, client},
    {"CONFIG", false, config},
    {"COMMAND", false, command},
    {"INFO", false, info},
    {"SLOWLOG", false, slowlog},
    {"DBSIZE", false, redis_dbsize},
    {"EXISTS", false, redis_exists},
    {"KEYS", false, redis_keys},
    {"SCAN", false, redis_scan},
    {"TYPE", false, redis_type},
    {"MEMORY", false, redis_memory},
    {"EXPIRE", false, redis_expire},
    {"TTL", false, redis_ttl},
    {"PTTL", false, redis_ttl},
    {"PERSIST", false, redis_persist},
    {"MULTI", false, multi},
    {"EXEC", false, exec},
    {"DISCARD", false, discard},
    {"WATCH", false, watch},
    {"UNWATCH", false, watch},
};

/* Whether a connection in a refused transaction may send this command. */
static bool ends_multi(const struct word *name)
{
    return word_is(name, "EXEC") || word_is(name, "DISCARD") || word_is(name, "QUIT");
}

static redis_handler *find(const struct request *q, const struct answer *a, bool *open)
{
    static const char first[] =
        "PHAESCIDKTMWU"; /* letters in the table; most requests have others */
    *open = false;
    if (a->multi && !ends_multi(&q->word[0]))
        return refuse_in_multi;
    if (q->word[0].len == 0 || strchr(first, q->word[0].text[0] & ~0x20) == NULL)
        return NULL;
    /* Events are pushes, which RESP 2 does not have. */
    if (a->typed && (word_is(&q->word[0], "WATCH") || word_is(&q->word[0], "UNWATCH")))
        return NULL;
    /* `HELLO 1` asks for the version of our protocol. */
    if (q->n == 2 && word_is(&q->word[0], "HELLO") && word_is(&q->word[1], "1"))
        return NULL;
    for (size_t i = 0; i < sizeof table / sizeof table[0]; i++)
        if (word_is(&q->word[0], table[i].name)) {
            *open = table[i].open;
            return table[i].handler;
        }
    return NULL;
}

bool redis_answer(struct server *s, const struct request *q, struct answer *a)
{
    bool open;
    redis_handler *handler = find(q, a, &open);
    if (handler == NULL)
        return false;
    size_t mark = buf_len(a->out);
    const struct command *c = command_find(&q->word[0]);
    a->command = c != NULL ? (unsigned)(c - commands) : STATS_OTHER;
    stats_begin(&s->stats, a->command);
    if (buf_reserve(a->out, REPLY_ERR_ROOM) == NULL) {
        a->next = ANSWER_BROKEN;
        return true;
    }
    if (a->role == ROLE_NONE && !open)
        redis_simple(a, "-NOAUTH authenticate first: AUTH token");
    else
        handler(s, q, a);
    if (a->out->failed) {
        buf_rewind(a->out, mark);
        redis_simple(a, "-NOMEM out of memory");
    }
    return true;
}
