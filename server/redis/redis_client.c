/* redis_client.c - see handlers.h. CLIENT. */
#include "server/redis/handlers.h"

#include "proto/resp.h"
#include "server/clients/clients.h"

static void put_name(const struct server *s, struct answer *a)
{
    const char *name = client_name(s, a);
    if (name[0] != '\0')
        redis_bulk_text(a, name);
    else
        redis_null(a);
}

/* CLIENT INFO: the row of this connection in CLIENT LIST, and facts that libraries expect in it. */
static void put_own_row(struct server *s, struct answer *a)
{
    static const char facts[] =
        " db=0 sub=0 psub=0 ssub=0 multi=-1 watch=0 qbuf=0 qbuf-free=0 argv-mem=0 "
        "multi-mem=0 obl=0 oll=0 omem=0 tot-mem=0 flags=N events=r user=default "
        "redir=-1 resp=";
    const struct session *me = clients_asker(s, a);
    struct buf row = {0};
    if (me != NULL) {
        client_row(&row, me);
        buf_rewind(&row, buf_len(&row) - 1); /* its LF */
        buf_append(&row, facts, sizeof facts - 1);
        buf_append_text(&row, a->client.typed ? "3\n" : "2\n");
    }
    if (row.failed)
        answer_out_of_memory(a);
    else
        resp_bulk(a->out, buf_head(&row), buf_len(&row));
    buf_free(&row);
}

/* OK, or the error. */
static void put_outcome(struct answer *a, const char *error)
{
    if (error != NULL)
        redis_error(a, error);
    else
        redis_simple(a, "+OK");
}

/* Answers a subcommand that needs no reply of our CLIENT. False: it needs one. */
static bool answer_alone(struct server *s, const struct request *q, struct answer *a)
{
    const struct word *what = &q->word[1], *how = &q->word[q->n - 1];
    bool off = word_is(how, "OFF"), on = word_is(how, "ON");
    if (q->n == 2 && word_is(what, "LIST") && a->client.role == ROLE_WRITE)
        client_list(s, a, LISTING_BULK);
    else if (q->n == 2 && word_is(what, "INFO"))
        put_own_row(s, a);
    else if (q->n == 3 && (word_is(what, "NO-EVICT") || word_is(what, "NO-TOUCH")) && (on || off))
        redis_simple(a, "+OK"); /* that is always so */
    else if (q->n >= 3 && word_is(what, "TRACKING"))
        put_outcome(a, q->n == 3 && off
                           ? NULL
                           : "ERR there is no client-side caching; WATCH set follows a set");
    else if (q->n == 3 && word_is(what, "REPLY"))
        put_outcome(a, on ? NULL : "ERR every request has a reply");
    else if (q->n == 2 && word_is(what, "GETREDIR"))
        redis_integer(a, -1);
    else if (q->n >= 3 && word_is(what, "UNBLOCK"))
        redis_integer(a, 0);
    else
        return false;
    return true;
}

void redis_client(struct server *s, const struct request *q, struct answer *a)
{
    if ((q->n >= 2 && answer_alone(s, q, a)) || !redis_run(s, q, a))
        return;
    const struct word *what = &q->word[1];
    if (word_is(what, "ID") || (word_is(what, "KILL") && q->n == 4))
        redis_integer(a, (int64_t)a->count);
    else if (word_is(what, "GETNAME"))
        put_name(s, a);
    else
        put_outcome(a, word_is(what, "KILL") && a->count == 0 ? "ERR No such client" : NULL);
}
