/* habit.c - see habit.h. */
#include "server/redis/habit.h"

#include "proto/number.h"
#include "proto/resp.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

void redis_time(struct server *s, const struct request *q, struct answer *a)
{
    struct timespec t;
    char text[32];
    (void)s, (void)q;
    clock_gettime(CLOCK_REALTIME, &t);
    resp_array(a->out, 2);
    snprintf(text, sizeof text, "%" PRId64, (int64_t)t.tv_sec);
    redis_bulk_text(a, text);
    snprintf(text, sizeof text, "%ld", t.tv_nsec / 1000);
    redis_bulk_text(a, text);
}

/* Makes the connection like a new one, except that it still watches the sets that it watches. */
void redis_reset(struct server *s, const struct request *q, struct answer *a)
{
    (void)q;
    a->multi = a->typed = false;
    a->role = auth_initial_role(&s->auth);
    a->token = 0;
    client_set_name(s, a, &(struct word){"", 0});
    redis_simple(a, "+RESET");
}

/* WAIT numreplicas milliseconds, where 0 is for ever; our WAIT has seconds. */
void redis_wait(struct server *s, const struct request *q, struct answer *a)
{
    static const char ever[] = "1000000";
    char seconds[24];
    uint32_t ms;
    struct line_reply t;
    if (q->n != 3 || !proto_read_u32(q->word[2].text, q->word[2].len, &ms)) {
        redis_error(a, q->n != 3 ? "ERR wrong number of arguments for 'wait' command"
                                 : "ERR timeout is not an integer or out of range");
        return;
    }
    snprintf(seconds, sizeof seconds, "%u.%03u", ms / 1000, ms % 1000);
    const char *text = ms == 0 || ms / 1000 >= 1000000 ? ever : seconds;
    struct word words[] = {{"WAIT", 4}, q->word[1], {text, strlen(text)}};
    if (!redis_ask(s, &(struct request){.word = words, .n = 3}, a, "", &t))
        return;
    redis_integer(a, (int64_t)line_reply_number(&t, "followers"));
    line_reply_clear(&t);
}

/* ---- ROLE ---- */

/* Splits ADDRESS:PORT; without a port it is 0. */
static void put_address(struct answer *a, const char *text, size_t len)
{
    const char *colon = memrchr(text, ':', len);
    uint32_t port = 0;
    size_t host = colon == NULL ? len : (size_t)(colon - text);
    if (colon != NULL)
        proto_read_u32(colon + 1, len - host - 1, &port);
    resp_bulk(a->out, text, host);
    redis_integer(a, port);
}

/* One of "follower_1:address=A:P,state=log,lsn=L,..." as [A, P, L], texts all. */
static void put_follower(struct answer *a, const char *value, size_t len)
{
    const char *address = value + strlen("address="), *end = value + len;
    const char *comma = memchr(value, ',', len), *lsn = memmem(value, len, ",lsn=", 5);
    size_t n = (size_t)((comma != NULL ? comma : end) - address);
    const char *colon = memrchr(address, ':', n);
    size_t host = colon == NULL ? n : (size_t)(colon - address);
    lsn = lsn == NULL ? "0" : lsn + 5;
    resp_array(a->out, 3);
    resp_bulk(a->out, address, host);
    resp_bulk(a->out, address + host + (colon != NULL), n - host - (colon != NULL));
    resp_bulk(a->out, lsn, strspn(lsn, "0123456789"));
}

static int64_t number_of(const struct buf *rows, const char *key)
{
    size_t len;
    const char *text = redis_fact(rows, key, &len);
    return text == NULL ? 0 : strtoll(text, NULL, 10);
}

static void put_leader(struct answer *a, const struct buf *rows)
{
    int64_t n = number_of(rows, "followers");
    char key[32];
    size_t len;
    resp_array(a->out, 3);
    redis_bulk_text(a, "master");
    redis_integer(a, number_of(rows, "lsn"));
    resp_array(a->out, (size_t)n);
    for (int64_t i = 1; i <= n; i++) {
        snprintf(key, sizeof key, "follower_%" PRId64, i);
        const char *value = redis_fact(rows, key, &len);
        put_follower(a, value != NULL ? value : "address=", value != NULL ? len : 8);
    }
}

void redis_role(struct server *s, const struct request *q, struct answer *a)
{
    struct word words[] = {{"INFO", 4}, {"REPLICATION", 11}};
    struct line_reply t;
    size_t len;
    (void)q;
    if (!redis_ask(s, &(struct request){.word = words, .n = 2}, a, "\n", &t))
        return;
    if (!s->follows) {
        put_leader(a, &t.rows);
    } else {
        resp_array(a->out, 5);
        redis_bulk_text(a, "slave");
        const char *leader = redis_fact(&t.rows, "leader", &len);
        put_address(a, leader, len);
        const char *link = redis_fact(&t.rows, "link", &len);
        bool connected = len == 9 && memcmp(link, "receiving", len) == 0;
        redis_bulk_text(a, connected ? "connected" : "connect");
        redis_integer(a, number_of(&t.rows, "lsn"));
    }
    line_reply_clear(&t);
}

/* ---- what is not there ---- */

void redis_latency(struct server *s, const struct request *q, struct answer *a)
{
    (void)s;
    if (q->n >= 2 && (word_is(&q->word[1], "LATEST") || word_is(&q->word[1], "HISTORY")))
        resp_array(a->out, 0);
    else if (q->n >= 2 && word_is(&q->word[1], "HISTOGRAM"))
        redis_map(a, 0);
    else if (q->n >= 2 && word_is(&q->word[1], "RESET"))
        redis_integer(a, 0);
    else
        redis_usage(a, "LATENCY LATEST|HISTORY|HISTOGRAM|RESET; INFO COMMANDS has latencies");
}

void redis_module(struct server *s, const struct request *q, struct answer *a)
{
    (void)s;
    if (q->n == 2 && word_is(&q->word[1], "LIST"))
        resp_array(a->out, 0);
    else
        redis_usage(a, "MODULE LIST");
}

void redis_cluster(struct server *s, const struct request *q, struct answer *a)
{
    (void)s, (void)q;
    redis_error(a, "ERR This instance has cluster support disabled");
}

/* Appends a word in quotation marks, at most `most` bytes of it. */
static void quote(struct buf *out, const struct word *w, size_t most)
{
    buf_append_char(out, '\'');
    for (size_t i = 0; i < w->len && i < most; i++)
        buf_append_char(out, w->text[i] >= ' ' && w->text[i] <= '~' ? w->text[i] : '?');
    buf_append_char(out, '\'');
}

void redis_unknown(struct server *s, const struct request *q, struct answer *a)
{
    enum { MOST = 128 };
    size_t mark = buf_len(a->out);
    buf_append_text(a->out, "-ERR unknown command ");
    quote(a->out, &q->word[0], MOST);
    buf_append_text(a->out, ", with args beginning with: ");
    for (size_t i = 1; i < q->n && buf_len(a->out) - mark < 2 * MOST; i++) {
        quote(a->out, &q->word[i], MOST);
        buf_append_char(a->out, ' ');
    }
    buf_append(a->out, "\r\n", 2);
    a->refused = true;
    command_skip_body(s, q, a);
}
