/* redis.c - see redis.h. The table of Redis's requests, and the handlers of those that tools send at their start. */
#include "server/redis/redis.h"

#include "proto/number.h"
#include "proto/resp.h"
#include "proto/version.h"
#include "server/bodies/load.h"
#include "server/clients/clients.h"
#include "server/ops/setting.h"
#include "server/redis/handlers.h"

#include <stdio.h>
#include <string.h>

static void ping(struct server *s, const struct request *q, struct answer *a)
{
    if (q->n == 2)
        resp_bulk(a->out, q->word[1].text, q->word[1].len);
    else
        redis_simple(a, "+PONG");
}

static void echo(struct server *s, const struct request *q, struct answer *a)
{
    resp_bulk(a->out, q->word[1].text, q->word[1].len);
}

static void select_db(struct server *s, const struct request *q, struct answer *a)
{
    if (q->n == 2 && word_is(&q->word[1], "0"))
        redis_simple(a, "+OK");
    else
        redis_error(a, "RANGE there is only the database 0");
}

static void put_name(struct answer *a, const struct command *c)
{
    char name[32];
    size_t len = strlen(c->name);
    for (size_t i = 0; i < len; i++)
        name[i] = (char)(c->name[i] - 'A' + 'a');
    resp_bulk(a->out, name, len);
}

/* A command in the format of COMMAND: name, number of words (negative: at least), flags; then the positions of the first
 * and the last key, and the step between keys. The name of a set is a key. */
static void describe(struct answer *a, const struct command *c)
{
    char text[32];
    bool set = (c->flags & CMD_SET) != 0;
    resp_array(a->out, 6);
    put_name(a, c);
    snprintf(text, sizeof text, ":%s%u", c->least == c->most ? "" : "-", c->least);
    redis_simple(a, text);
    resp_array(a->out, 1);
    redis_simple(a, (c->flags & CMD_WRITE) != 0 ? "+write" : "+readonly");
    for (int i = 0; i < 3; i++)
        redis_integer(a, set);
}

/* All commands, each written by `put`. With `asked`: these n commands, and null for each that does not exist. */
static void list_commands(const struct server *s, struct answer *a, const struct word *asked,
                          size_t n, void (*put)(struct answer *a, const struct command *c))
{
    resp_array(a->out, asked != NULL ? n : s->command_count);
    for (size_t i = 0; asked == NULL && i < s->command_count; i++)
        put(a, &s->commands[i]);
    for (size_t i = 0; asked != NULL && i < n; i++) {
        const struct command *c = command_find(s, &asked[i]);
        if (c != NULL)
            put(a, c);
        else
            redis_null(a);
    }
}

static void command(struct server *s, const struct request *q, struct answer *a)
{
    const struct word *what = &q->word[1];
    if (q->n == 1)
        list_commands(s, a, NULL, 0, describe);
    else if (word_is(what, "COUNT"))
        redis_integer(a, (int64_t)s->command_count);
    else if (word_is(what, "LIST"))
        list_commands(s, a, NULL, 0, put_name);
    else if (word_is(what, "INFO"))
        list_commands(s, a, q->n > 2 ? q->word + 2 : NULL, q->n - 2, describe);
    else if (word_is(what, "DOCS"))
        redis_map(a, 0);
    else
        resp_array(a->out, 0);
}

/* Redis tools ask for settings that do not exist here, and only print their values: these are empty. */
static bool is_foreign(const struct word *name)
{
    bool pattern = false;
    for (size_t i = 0; i < name->len; i++)
        pattern = pattern || strchr("*?[", name->text[i]) != NULL;
    return !pattern && setting_find(name->text, name->len) == NULL;
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
    if (q->n >= 3 && word_is(&q->word[1], "GET"))
        get_settings(s, q, a);
    else if (redis_run(s, q, a))
        redis_simple(a, "+OK");
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
    if (q->n >= 2 && q->n <= 3 && word_is(&q->word[1], "GET") && a->client.role == ROLE_WRITE &&
        slowlog_get(s, q, a, list_slow, LISTING_ARRAY))
        return;
    if (!redis_run(s, q, a))
        return;
    if (word_is(&q->word[1], "LEN"))
        redis_integer(a, (int64_t)a->count);
    else
        redis_simple(a, "+OK");
}

/* False: the token is wrong, and the error has been written; or the check is delayed. */
static bool show_token(struct server *s, const struct word *token, struct answer *a)
{
    enum shown shown = client_show_token(s, a, token);
    if (shown == SHOWN_WRONG)
        redis_error(a, "WRONGPASS invalid username-password pair or user is disabled.");
    return shown == SHOWN_GOOD;
}

/* AUTH user token: the name is ignored. */
static void auth(struct server *s, const struct request *q, struct answer *a)
{
    if (show_token(s, &q->word[q->n - 1], a))
        redis_simple(a, "+OK"); /* some clients want exactly that */
}

static void greet(const struct server *s, struct answer *a, uint32_t version)
{
    enum { FACTS = 7 };
    a->client.typed = version == 3;
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
    redis_bulk_text(a, s->follows ? "replica" : "master");
    redis_bulk_text(a, "modules");
    resp_array(a->out, 0);
}

/* HELLO [2|3 [AUTH user token] [SETNAME name]]; other versions are our own HELLO's. */
static void hello(struct server *s, const struct request *q, struct answer *a)
{
    uint32_t version = a->client.typed ? 3 : 2;
    if (q->n >= 2 && (!proto_read_u32(q->word[1].text, q->word[1].len, &version) || version < 2 ||
                      version > 3)) {
        redis_error(a, "NOPROTO this server speaks RESP 2 and 3");
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
    if (a->client.role == ROLE_NONE)
        redis_error(a, "NOAUTH authenticate first: AUTH token");
    else
        greet(s, a, version);
}

#define TTL_USAGE "TTL|PTTL|EXPIRETIME|PEXPIRETIME set"

static const char no_cluster[] = "-ERR This instance has cluster support disabled";

static const struct row {
    const char *name;
    redis_handler *handler;
    unsigned least, most; /* words, including the name; most 0: any number */
    const char *usage;    /* the answer if there are others; NULL: the handler checks them */
    const char *says; /* the answer, which is always the same, with its mark; NULL: the handler's */
    bool sets;        /* it needs redis_sees_sets */
    bool shares;      /* it reads nothing but the request, so the reactor need not be alone */
} table[] = {
    {"PING", .handler = ping, .shares = true},
    {"HELLO", .handler = hello},
    {"AUTH", .handler = auth, .least = 2, .most = 3, .usage = "AUTH [user] token"},
    {"RESET", .handler = redis_reset},
    {"ECHO", .handler = echo, .least = 2, .most = 2, .usage = "ECHO message"},
    {"SELECT", .handler = select_db},
    {"CLIENT", .handler = redis_client},
    {"CONFIG", .handler = config},
    {"COMMAND", .handler = command},
    {"INFO", .handler = redis_info},
    {"SLOWLOG", .handler = slowlog},
    {"DBSIZE", .handler = redis_dbsize, .least = 1, .most = 1, .usage = "DBSIZE", .sets = true},
    {"EXISTS", .handler = redis_exists, .least = 2, .usage = "EXISTS set [set ...]", .sets = true},
    {"TOUCH", .handler = redis_exists, .least = 2, .usage = "EXISTS set [set ...]", .sets = true},
    {"KEYS", .handler = redis_keys, .least = 2, .most = 2, .usage = "KEYS pattern"},
    {"SCAN", .handler = redis_scan},
    {"TYPE", .handler = redis_type, .least = 2, .most = 2, .usage = "TYPE set", .sets = true},
    {"MEMORY", .handler = redis_memory},
    {"OBJECT", .handler = redis_object, .least = 3, .most = 3,
     .usage = "OBJECT ENCODING|REFCOUNT|IDLETIME|FREQ set", .sets = true},
    {"UNLINK", .handler = redis_unlink, .least = 2, .usage = "UNLINK set [set ...]", .sets = true},
    {"DEL", .says = "-SYNTAX usage: DEL set id [id ...]: DEL deletes points; UNLINK set [set ...] "
                    "or DROP set deletes sets"},
    {"EXPIRE", .handler = redis_expire},
    {"PEXPIRE", .handler = redis_expire},
    {"EXPIREAT", .handler = redis_expire},
    {"PEXPIREAT", .handler = redis_expire},
    {"TTL", .handler = redis_ttl, .least = 2, .most = 2, .usage = TTL_USAGE, .sets = true},
    {"PTTL", .handler = redis_ttl, .least = 2, .most = 2, .usage = TTL_USAGE, .sets = true},
    {"EXPIRETIME", .handler = redis_ttl, .least = 2, .most = 2, .usage = TTL_USAGE, .sets = true},
    {"PEXPIRETIME", .handler = redis_ttl, .least = 2, .most = 2, .usage = TTL_USAGE, .sets = true},
    {"PERSIST", .handler = redis_persist, .least = 2, .most = 2, .usage = "PERSIST set",
     .sets = true},
    {"MULTI", .handler = redis_multi, .least = 1, .most = 1, .usage = "MULTI"},
    {"EXEC", .handler = redis_exec},
    {"DISCARD", .handler = redis_discard},
    {"WATCH", .says = "-UNKNOWN there are no transactions, so there is no WATCH before them"},
    {"UNWATCH", .says = "+OK"}, /* nothing is watched */
    {"WAIT", .handler = redis_wait},
    {"TIME", .handler = redis_time},
    {"ROLE", .handler = redis_role},
    {"LATENCY", .handler = redis_latency},
    {"MODULE", .handler = redis_module},
    {"CLUSTER", .says = no_cluster},
    {"READONLY", .says = no_cluster},
    {"READWRITE", .says = no_cluster},
};

/* Whether the request means our command of this name, not the command of Redis with the same name. */
static bool is_ours(const struct request *q, const struct answer *a)
{
    const struct word *name = &q->word[0];
    /* Events are pushes, which RESP 2 does not have. */
    if (a->client.typed && (word_is(name, "WATCH") || word_is(name, "UNWATCH")))
        return true;
    /* `HELLO 1` asks for the version of our protocol. */
    if (q->n == 2 && word_is(name, "HELLO") && word_is(&q->word[1], "1"))
        return true;
    return word_is(name, "DEL") && !redis_del_is_misused(q);
}

/* The row of Redis's command; NULL: there is none of that name, or it is a command of ours. */
static const struct row *find(const struct request *q, const struct answer *a)
{
    static const char first[] = "PHAESCIDKTMWULOR"; /* in the table; most requests have others */
    if (q->word[0].len == 0 || strchr(first, q->word[0].text[0] & ~0x20) == NULL)
        return NULL;
    for (size_t i = 0; i < sizeof table / sizeof table[0]; i++)
        if (word_is(&q->word[0], table[i].name) && !is_ours(q, a))
            return &table[i];
    return NULL;
}

/* Who answers the request; NULL: the command of ours. */
static const struct row *choose(struct server *s, const struct request *q, const struct answer *a)
{
    static const struct row unknown = {.handler = redis_unknown};
    static const struct row queued = {.handler = redis_queue};
    const struct row *row = find(q, a);
    if (row == NULL && command_find_again(s, a->reactor, &q->word[0]) == NULL)
        return &unknown;
    return a->client.multi && !redis_ends_multi(&q->word[0]) ? &queued : row;
}

/* Whether the request is allowed before AUTH: as the command of ours of that name is. */
static bool is_open(const struct answer *a, redis_handler *handler)
{
    return handler == redis_unknown || handler == redis_reset ||
           (a->command != NULL && (a->command->flags & CMD_OPEN) != 0);
}

static void say(struct answer *a, const char *text)
{
    redis_simple(a, text);
    a->refused = text[0] == '-';
}

static void answer_row(struct server *s, const struct row *row, const struct request *q,
                       struct answer *a)
{
    if (a->client.role == ROLE_NONE && !is_open(a, row->handler))
        redis_error(a, "NOAUTH authenticate first: AUTH token");
    else if (row->usage != NULL && (q->n < row->least || (row->most > 0 && q->n > row->most)))
        redis_usage(a, row->usage);
    else if (row->says != NULL)
        say(a, row->says);
    else if (!row->sets || redis_sees_sets(s, a))
        row->handler(s, q, a);
}

bool redis_answer(struct server *s, const struct request *q, struct answer *a)
{
    const struct row *row = choose(s, q, a);
    if (row == NULL)
        return false;
    if (!row->shares && !world_alone(a))
        return true;
    struct buf *out = a->out;
    size_t mark = buf_len(out);
    a->command = command_find(s, &q->word[0]);
    stats_begin(&a->reactor->stats, command_number(s, a->command));
    if (buf_reserve(a->out, REPLY_ERR_ROOM) == NULL) {
        a->broken = true;
        return true;
    }
    answer_row(s, row, q, a);
    if (a->out->failed) {
        buf_rewind(a->out, a->out == out ? mark : 0);
        a->out = out;
        redis_error(a, "NOMEM out of memory");
    }
    return true;
}
