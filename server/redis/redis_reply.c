/* redis_reply.c - see redis_reply.h. */
#include "server/redis/redis_reply.h"

#include "proto/resp.h"
#include "server/replies/resp3.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

void redis_simple(struct answer *a, const char *text)
{
    buf_append_text(a->out, text);
    buf_append(a->out, "\r\n", 2);
}

void redis_bulk_text(struct answer *a, const char *text)
{
    resp_bulk(a->out, text, strlen(text));
}

void redis_integer(struct answer *a, int64_t v)
{
    char text[32];
    snprintf(text, sizeof text, ":%" PRId64, v);
    redis_simple(a, text);
}

void redis_error(struct answer *a, const char *text)
{
    buf_append_char(a->out, '-');
    redis_simple(a, text);
    a->refused = true;
}

void redis_usage(struct answer *a, const char *text)
{
    buf_append_text(a->out, "-SYNTAX usage: ");
    redis_simple(a, text);
    a->refused = true;
}

void redis_map(struct answer *a, size_t n)
{
    if (a->typed)
        resp3_map(a->out, n);
    else
        resp_array(a->out, 2 * n);
}

void redis_null(struct answer *a)
{
    if (a->typed)
        resp3_null(a->out);
    else
        redis_simple(a, "$-1");
}

void line_reply_clear(struct line_reply *t)
{
    buf_free(&t->lines);
    buf_free(&t->rows);
}

uint64_t line_reply_number(const struct line_reply *t, const char *key)
{
    uint64_t v = 0;
    reply_key_number(&t->status, key, &v);
    return v;
}

/* True: an error, which has been copied. */
static bool copy_error(struct answer *a, const struct reply_part *part)
{
    if (part->kind != REPLY_ERR)
        return false;
    buf_append_char(a->out, '-');
    buf_append(a->out, part->text + 4, part->len - 4);
    buf_append(a->out, "\r\n", 2);
    return true;
}

bool line_reply_split(struct line_reply *t, struct answer *a, const char *eol)
{
    struct reply_reader reader = {0};
    struct reply_part part;
    size_t at = 0, n = buf_len(&t->lines);
    bool refused = false;
    for (ptrdiff_t took = 1; at < n && took > 0 && !refused; at += took > 0 ? (size_t)took : 0) {
        took = reply_read(&reader, buf_head(&t->lines) + at, n - at, &part);
        refused = took > 0 && copy_error(a, &part);
        if (took > 0 && part.kind == REPLY_OK) {
            t->status = part;
        } else if (took > 0 && !refused) {
            buf_append(&t->rows, part.text, part.len);
            buf_append_text(&t->rows, eol);
        }
    }
    if (t->lines.failed || t->rows.failed)
        answer_out_of_memory(a);
    if (!refused && !a->out->failed)
        return true;
    line_reply_clear(t);
    return false;
}

const char *redis_fact(const struct buf *rows, const char *key, size_t *len)
{
    const char *at = buf_head(rows), *end = at + buf_len(rows);
    size_t n = strlen(key);
    while (at < end) {
        const char *lf = memchr(at, '\n', (size_t)(end - at));
        size_t line = (size_t)((lf != NULL ? lf : end) - at);
        if (line > n && memcmp(at, key, n) == 0 && at[n] == ':') {
            *len = line - n - 1;
            if (*len > 0 && at[line - 1] == '\r')
                --*len;
            return at + n + 1;
        }
        at += line + 1;
    }
    return NULL;
}

bool redis_ask(struct server *s, const struct request *q, struct answer *a, const char *eol,
               struct line_reply *t)
{
    struct buf *out = a->out;
    *t = (struct line_reply){0};
    a->out = &t->lines;
    command_run(s, q, a);
    a->out = out;
    if (a->next == ANSWER_DONE && !a->broken)
        return line_reply_split(t, a, eol);
    line_reply_clear(t);
    return false;
}
