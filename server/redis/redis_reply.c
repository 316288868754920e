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
    if (a->client.typed)
        resp3_map(a->out, n);
    else
        resp_array(a->out, 2 * n);
}

void redis_null(struct answer *a)
{
    if (a->client.typed)
        resp3_null(a->out);
    else
        redis_simple(a, "$-1");
}

const char *redis_split_address(const char *text, size_t *len)
{
    const char *colon = strrchr(text, ':');
    *len = colon != NULL ? (size_t)(colon - text) : strlen(text);
    return colon != NULL ? colon + 1 : "";
}

bool redis_run(struct server *s, const struct request *q, struct answer *a)
{
    struct buf *out = a->out;
    struct buf *lines = &a->reactor->lines;
    a->out = lines;
    command_run(s, q, a);
    if (a->next != ANSWER_DONE || a->refused || a->broken)
        return false;
    buf_rewind(lines, 0);
    a->out = out;
    return true;
}
