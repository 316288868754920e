/* redis.c - see redis.h. This does no more than tools need in order to start. */
#include "server/redis/redis.h"

#include "proto/number.h"
#include "proto/resp.h"
#include "server/ops/setting.h"
#include "server/redis/resp3.h"

#include <stdio.h>
#include <string.h>

typedef void redis_handler(struct server *s, const struct request *q, struct answer *a);

static void simple(struct answer *a, const char *text)
{
    buf_append_text(a->out, text);
    buf_append(a->out, "\r\n", 2);
}

static void bulk_text(struct answer *a, const char *text)
{
    resp_bulk(a->out, text, strlen(text));
}

static void integer(struct answer *a, uint64_t v)
{
    char text[32];
    snprintf(text, sizeof text, ":%llu", (unsigned long long)v);
    simple(a, text);
}

static void usage(struct answer *a, const char *text)
{
    buf_append_text(a->out, "-SYNTAX usage: ");
    simple(a, text);
}

static void ping(struct server *s, const struct request *q, struct answer *a)
{
    (void)s;
    if (q->n == 2)
        resp_bulk(a->out, q->word[1].text, q->word[1].len);
    else
        simple(a, "+PONG");
}

static void echo(struct server *s, const struct request *q, struct answer *a)
{
    (void)s;
    if (q->n == 2)
        resp_bulk(a->out, q->word[1].text, q->word[1].len);
    else
        usage(a, "ECHO message");
}

static void select_db(struct server *s, const struct request *q, struct answer *a)
{
    (void)s;
    if (q->n == 2 && word_is(&q->word[1], "0"))
        simple(a, "+OK");
    else
        simple(a, "-RANGE there is only the database 0");
}

/* A command as COMMAND lists it: name, number of words (negative: at least), flags, and the places
 * of the first and the last key and the step between keys, a set's name being the key. */
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
    simple(a, text);
    resp_array(a->out, 1);
    simple(a, (c->flags & CMD_WRITE) != 0 ? "+write" : "+readonly");
    for (int i = 0; i < 3; i++)
        integer(a, set);
}

static void command(struct server *s, const struct request *q, struct answer *a)
{
    (void)s;
    if (q->n >= 2 && word_is(&q->word[1], "COUNT")) {
        integer(a, command_count);
    } else if (q->n >= 2) { /* DOCS, INFO, ...: empty */
        resp_array(a->out, 0);
    } else {
        resp_array(a->out, command_count);
        for (size_t i = 0; i < command_count; i++)
            describe(a, &commands[i]);
    }
}

/* ---- replies of our own commands in Redis's form ---- */

/* A reply in lines. */
struct line_reply {
    struct buf lines;         /* owns */
    struct reply_part status; /* borrows lines */
    struct buf rows;          /* owns; each row with an end of line */
};

static void clear_reply(struct line_reply *t)
{
    buf_free(&t->lines);
    buf_free(&t->rows);
}

/* Splits the lines into status and rows; an error is copied to the reply. False: that is all. */
static bool sort_out(struct line_reply *t, struct answer *a, const char *eol)
{
    struct reply_reader reader = {0};
    struct reply_part part;
    size_t at = 0, n = buf_len(&t->lines);
    for (ptrdiff_t took = 1; at < n && took > 0; at += took > 0 ? (size_t)took : 0) {
        took = reply_read(&reader, buf_head(&t->lines) + at, n - at, &part);
        if (took > 0 && part.kind == REPLY_ERR) {
            buf_append_char(a->out, '-');
            buf_append(a->out, part.text + 4, part.len - 4);
            buf_append(a->out, "\r\n", 2);
            return false;
        }
        if (took > 0 && part.kind == REPLY_OK) {
            t->status = part;
        } else if (took > 0) {
            buf_append(&t->rows, part.text, part.len);
            buf_append_text(&t->rows, eol);
        }
    }
    if (t->lines.failed || t->rows.failed)
        answer_out_of_memory(a);
    return !a->out->failed;
}

/* Carries out q as a line. False: it has been answered with an error. */
static bool ask(struct server *s, const struct request *q, struct answer *a, const char *eol,
                struct line_reply *t)
{
    struct answer plain = *a;
    *t = (struct line_reply){0};
    plain.out = &t->lines;
    command_run(s, q, &plain);
    if (plain.next == ANSWER_CLOSING)
        a->next = ANSWER_CLOSING;
    a->role = plain.role;
    a->token = plain.token;
    if (sort_out(t, a, eol))
        return true;
    clear_reply(t);
    return false;
}

static uint64_t number_in(const struct line_reply *t, const char *key)
{
    uint64_t v = 0;
    reply_key_number(&t->status, key, &v);
    return v;
}

static void answer_name(struct answer *a, const struct line_reply *t)
{
    const char *name;
    size_t len = 0;
    if (reply_key(&t->status, "name", &name, &len) && len > 0)
        resp_bulk(a->out, name, len);
    else if (a->typed)
        resp3_null(a->out);
    else
        simple(a, "$-1");
}

static void client(struct server *s, const struct request *q, struct answer *a)
{
    struct line_reply t;
    if (q->n == 2 && word_is(&q->word[1], "LIST") && a->role == ROLE_WRITE) {
        client_list(s, a, LISTING_BULK);
        return;
    }
    if (!ask(s, q, a, "", &t))
        return;
    const struct word *what = &q->word[1];
    if (word_is(what, "ID"))
        integer(a, number_in(&t, "id"));
    else if (word_is(what, "GETNAME"))
        answer_name(a, &t);
    else if (word_is(what, "KILL") && q->n == 4)
        integer(a, number_in(&t, "killed"));
    else if (word_is(what, "KILL") && number_in(&t, "killed") == 0)
        simple(a, "-ERR No such client");
    else
        simple(a, "+OK");
    clear_reply(&t);
}

/* Redis tools ask for settings that do not exist here, and only print their values: these are empty. */
static bool is_foreign(const struct word *name)
{
    return setting_find(name->text, name->len) == NULL &&
           memchr(name->text, '*', name->len) == NULL && memchr(name->text, '?', name->len) == NULL;
}

/* The header of a map; in RESP 2 an array of names and values. */
static void map(struct answer *a, size_t n)
{
    if (a->typed)
        resp3_map(a->out, n);
    else
        resp_array(a->out, 2 * n);
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
    map(a, n);
    for (size_t i = 0; i < setting_count; i++) {
        const char *name = setting_asked(&settings[i], asked, q->n - 2);
        if (name != NULL) {
            bulk_text(a, name);
            bulk_text(a, setting_text(&settings[i], s->config, text));
        }
    }
    for (size_t i = 2; i < q->n; i++) {
        if (is_foreign(&q->word[i])) {
            resp_bulk(a->out, q->word[i].text, q->word[i].len);
            bulk_text(a, "");
        }
    }
}

static void config(struct server *s, const struct request *q, struct answer *a)
{
    struct line_reply t;
    if (q->n >= 3 && word_is(&q->word[1], "GET")) {
        get_settings(s, q, a);
    } else if (ask(s, q, a, "", &t)) {
        simple(a, "+OK");
        clear_reply(&t);
    }
}

/* An entry as Redis has it: id, time, microseconds, words, address, name. */
static void append_slow(struct buf *out, const struct slow *e)
{
    struct answer row = {.out = out}, *a = &row;
    char peer[SOCK_PEER_TEXT];
    size_t words = 1;
    for (const char *p = e->text; *p != '\0'; p++)
        words += *p == ' ';
    resp_array(a->out, 6);
    integer(a, e->id);
    integer(a, (uint64_t)e->at_s);
    integer(a, (uint64_t)(e->work_us + e->wait_us));
    resp_array(a->out, words);
    for (const char *p = e->text; words > 0; words--) {
        size_t len = strcspn(p, " ");
        resp_bulk(a->out, p, len);
        p += len + 1;
    }
    sock_peer_text(&e->peer, peer);
    bulk_text(a, peer);
    bulk_text(a, "");
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
    if (!ask(s, q, a, "", &t))
        return;
    if (word_is(&q->word[1], "LEN")) {
        integer(a, number_in(&t, "len"));
    } else {
        simple(a, "+OK");
    }
    clear_reply(&t);
}

/* Redis's names of sections, and what is nearest to them here. */
static const struct {
    const char *theirs, *ours;
} renamed[] = {
    {"DEFAULT", "ALL"},   {"EVERYTHING", "ALL"},        {"PERSISTENCE", "DURABILITY"},
    {"KEYSPACE", "SETS"}, {"COMMANDSTATS", "COMMANDS"}, {"LATENCYSTATS", "COMMANDS"},
};

/* The rows of INFO as one text, as in Redis. */
static void info(struct server *s, const struct request *q, struct answer *a)
{
    struct line_reply t;
    for (size_t i = 1; i < q->n; i++)
        for (size_t k = 0; k < sizeof renamed / sizeof renamed[0]; k++)
            if (word_is(&q->word[i], renamed[k].theirs))
                q->word[i] = (struct word){renamed[k].ours, strlen(renamed[k].ours)};
    if (!ask(s, q, a, "\r\n", &t))
        return;
    resp_bulk(a->out, buf_head(&t.rows), buf_len(&t.rows));
    clear_reply(&t);
}

/* False: the token is wrong, and the error has been written; or the check is delayed. */
static bool show_token(struct server *s, const struct word *token, struct answer *a)
{
    enum shown shown = client_show_token(s, a, token);
    if (shown == SHOWN_WRONG)
        simple(a, "-DENIED no such token");
    return shown == SHOWN_GOOD;
}

/* AUTH user token: the name is ignored. */
static void auth(struct server *s, const struct request *q, struct answer *a)
{
    if (q->n != 2 && q->n != 3)
        usage(a, "AUTH [user] token");
    else if (show_token(s, &q->word[q->n - 1], a))
        simple(a, a->role == ROLE_WRITE ? "+OK role=rw" : "+OK role=ro");
}

static void greet(struct answer *a, uint32_t version)
{
    enum { FACTS = 7 };
    a->typed = version == 3;
    map(a, FACTS);
    bulk_text(a, "server");
    bulk_text(a, "delaunayd");
    bulk_text(a, "version");
    bulk_text(a, DELAUNAYD_VERSION);
    bulk_text(a, "proto");
    integer(a, version);
    bulk_text(a, "id");
    integer(a, a->owner);
    bulk_text(a, "mode");
    bulk_text(a, "standalone");
    bulk_text(a, "role");
    bulk_text(a, "master");
    bulk_text(a, "modules");
    resp_array(a->out, 0);
}

/* HELLO [2|3 [AUTH user token] [SETNAME name]]; other versions are our own HELLO's. */
static void hello(struct server *s, const struct request *q, struct answer *a)
{
    uint32_t version = a->typed ? 3 : 2;
    if (q->n >= 2 && (!proto_read_u32(q->word[1].text, q->word[1].len, &version) || version < 2 ||
                      version > 3)) {
        simple(a, "-RANGE this server speaks RESP 2 and 3");
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
            usage(a, "HELLO [2|3 [AUTH user token] [SETNAME name]]");
            return;
        }
    }
    if (a->role == ROLE_NONE)
        simple(a, "-NOAUTH authenticate first: AUTH token");
    else
        greet(a, version);
}

static const struct {
    const char *name;
    bool open; /* allowed before AUTH */
    redis_handler *handler;
} table[] = {
    {"PING", true, ping},        {"HELLO", true, hello},       {"AUTH", true, auth},
    {"ECHO", false, echo},       {"SELECT", false, select_db}, {"CLIENT", false, client},
    {"CONFIG", false, config},   {"COMMAND", false, command},  {"INFO", false, info},
    {"SLOWLOG", false, slowlog},
};

static redis_handler *find(const struct request *q, bool *open)
{
    static const char first[] = "PHAESCI"; /* letters in the table; most requests have others */
    if (q->word[0].len == 0 || strchr(first, q->word[0].text[0] & ~0x20) == NULL)
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
    redis_handler *handler = find(q, &open);
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
        simple(a, "-NOAUTH authenticate first: AUTH token");
    else
        handler(s, q, a);
    if (a->out->failed) {
        buf_rewind(a->out, mark);
        simple(a, "-NOMEM out of memory");
    }
    return true;
}
