/* transaction.c - see handlers.h. MULTI and what follows it. */
#include "server/redis/handlers.h"

void redis_multi(struct server *s, const struct request *q, struct answer *a)
{
    if (a->client.multi)
        redis_error(a, "ERR MULTI calls can not be nested");
    else
        redis_simple(a, "+OK");
    a->client.multi = true;
}

void redis_exec(struct server *s, const struct request *q, struct answer *a)
{
    redis_error(a, a->client.multi
                       ? "EXECABORT there are no transactions: nothing was carried out; send the "
                         "commands without MULTI and EXEC (redis-py: pipeline(transaction=False))"
                       : "ERR EXEC without MULTI");
    a->client.multi = false;
}

void redis_discard(struct server *s, const struct request *q, struct answer *a)
{
    if (a->client.multi)
        redis_simple(a, "+OK");
    else
        redis_error(a, "ERR DISCARD without MULTI");
    a->client.multi = false;
}

bool redis_ends_multi(const struct word *name)
{
    return word_is(name, "EXEC") || word_is(name, "DISCARD") || word_is(name, "QUIT") ||
           word_is(name, "RESET") || word_is(name, "MULTI");
}

void redis_queue(struct server *s, const struct request *q, struct answer *a)
{
    redis_simple(a, "+QUEUED");
    command_skip_body(s, q, a);
}
