/* redis.c - see redis.h. Nothing here does more than tools need in order to start. */
#include "server/redis.h"

#include "proto/number.h"
#include "proto/resp.h"

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

static void client(struct server *s, const struct request *q, struct answer *a)
{
    (void)s;
    const struct word *what = &q->word[1];
    if (q->n == 3 && word_is(what, "SETNAME"))
        simple(a, "+OK");
    else if (q->n == 4 && word_is(what, "SETINFO"))
        simple(a, "+OK");
    else if (q->n == 2 && word_is(what, "ID"))
        integer(a, a->owner);
    else if (q->n == 2 && word_is(what, "GETNAME"))
        simple(a, "$-1");
    else
        usage(a, "CLIENT SETNAME name | SETINFO key value | ID | GETNAME");
}

/* redis-benchmark asks for settings whose values it prints only. */
static void config(struct server *s, const struct request *q, struct answer *a)
{
    (void)s;
    if (q->n < 3 || !word_is(&q->word[1], "GET")) {
        usage(a, "CONFIG GET name");
        return;
    }
    resp_array(a->out, 2 * (q->n - 2));
    for (size_t i = 2; i < q->n; i++) {
        resp_bulk(a->out, q->word[i].text, q->word[i].len);
        bulk_text(a, "");
    }
}

/* A command as COMMAND tells it: name, number of words (negative: at least), flags, and the places
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
    } else if (q->n >= 2) { /* DOCS, INFO, ...: nothing to tell */
        resp_array(a->out, 0);
    } else {
        resp_array(a->out, command_count);
        for (size_t i = 0; i < command_count; i++)
            describe(a, &commands[i]);
    }
}

/* INFO's rows as the one text that Redis answers with. */
static void info(struct server *s, const struct request *q, struct answer *a)
{
    struct buf lines = {0}, text = {0};
    struct answer plain = {.out = &lines};
    struct reply_reader reader = {0};
    struct reply_part part;
    cmd_info(s, NULL, q, &plain);
    while (!lines.failed && buf_len(&lines) > 0) {
        ptrdiff_t took = reply_read(&reader, buf_head(&lines), buf_len(&lines), &part);
        if (took <= 0)
            break;
        if (part.kind == REPLY_ROW) {
            buf_append(&text, part.text, part.len);
            buf_append(&text, "\r\n", 2);
        }
        buf_consume(&lines, (size_t)took);
    }
    if (lines.failed || text.failed)
        answer_out_of_memory(a);
    else
        resp_bulk(a->out, buf_head(&text), buf_len(&text));
    buf_free(&lines);
    buf_free(&text);
}

/* False if the token is wrong. */
static bool show_token(struct server *s, const struct word *token, struct answer *a)
{
    enum role role = s->auth.n == 0 ? ROLE_WRITE : auth_check(&s->auth, token);
    if (role == ROLE_NONE) {
        simple(a, "-DENIED no such token");
        return false;
    }
    a->role = role;
    return true;
}

/* AUTH user token: the name plays no part. */
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
    if (version == 3)
        buf_append_text(a->out, "%7\r\n");
    else
        resp_array(a->out, 2 * (size_t)FACTS);
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
    uint32_t version = 2;
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
            at += 2;
        } else {
            usage(a, "HELLO [2|3 [AUTH user token] [SETNAME name]]");
            return;
        }
    }
    if (a->role == ROLE_NONE)
        simple(a, "-NOAUTH show a token first: AUTH token");
    else
        greet(a, version);
}

static const struct {
    const char *name;
    bool open; /* allowed before AUTH */
    redis_handler *handler;
} table[] = {
    {"PING", true, ping},      {"HELLO", true, hello},       {"AUTH", true, auth},
    {"ECHO", false, echo},     {"SELECT", false, select_db}, {"CLIENT", false, client},
    {"CONFIG", false, config}, {"COMMAND", false, command},  {"INFO", false, info},
};

static redis_handler *find(const struct request *q, bool *open)
{
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
    if (buf_reserve(a->out, REPLY_ERR_ROOM) == NULL) {
        a->broken = true;
        return true;
    }
    if (a->role == ROLE_NONE && !open)
        simple(a, "-NOAUTH show a token first: AUTH token");
    else
        handler(s, q, a);
    if (a->out->failed) {
        buf_rewind(a->out, mark);
        simple(a, "-NOMEM out of memory");
    }
    s->count.commands++;
    if (buf_head(a->out)[mark] == '-')
        s->count.errors++;
    return true;
}
