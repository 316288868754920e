/* habit.c - see handlers.h. Small requests that libraries send by habit, and unknown ones. */
#include "server/redis/handlers.h"

#include "proto/number.h"
#include "proto/resp.h"
#include "server/follow/follower.h"
#include "server/follow/leader.h"
#include "server/jobs/durable.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

void redis_time(struct server *s, const struct request *q, struct answer *a)
{
    struct timespec t;
    char text[32];
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
    a->client = (struct client){.role = auth_initial_role(&s->auth)};
    client_set_name(s, a, &(struct word){"", 0});
    redis_simple(a, "+RESET");
}

/* WAIT numreplicas milliseconds, where 0 is for ever; our WAIT has seconds. */
void redis_wait(struct server *s, const struct request *q, struct answer *a)
{
    static const char ever[] = "1000000";
    char seconds[24];
    uint32_t ms;
    if (q->n != 3 || !proto_read_u32(q->word[2].text, q->word[2].len, &ms)) {
        redis_error(a, q->n != 3 ? "ERR wrong number of arguments for 'wait' command"
                                 : "ERR timeout is not an integer or out of range");
        return;
    }
    snprintf(seconds, sizeof seconds, "%u.%03u", ms / 1000, ms % 1000);
    const char *text = ms == 0 || ms / 1000 >= 1000000 ? ever : seconds;
    struct word words[] = {{"WAIT", 4}, q->word[1], {text, strlen(text)}};
    if (redis_run(s, &(struct request){.word = words, .n = 3}, a))
        redis_integer(a, (int64_t)a->count);
}

/* ---- ROLE ---- */

/* [address, port, lsn], texts all. */
static void put_follower(struct answer *a, const struct sender *f)
{
    char text[24], address[SOCK_PEER_TEXT];
    uint64_t lsn = f->acked;
    size_t host;
    sock_peer_text(&f->peer, address);
    const char *port = redis_split_address(address, &host);
    resp_array(a->out, 3);
    resp_bulk(a->out, address, host);
    redis_bulk_text(a, port);
    snprintf(text, sizeof text, "%" PRIu64, lsn);
    redis_bulk_text(a, text);
}

static void put_leader(const struct server *s, struct answer *a)
{
    struct follower_facts own;
    uint32_t number = 0;
    size_t host;
    follower_facts(s, &own);
    const char *port = redis_split_address(own.leader, &host);
    proto_read_u32(port, strlen(port), &number);
    resp_array(a->out, 5);
    redis_bulk_text(a, "slave");
    resp_bulk(a->out, own.leader, host);
    redis_integer(a, number);
    redis_bulk_text(a, strcmp(own.state, "receiving") == 0 ? "connected" : "connect");
    redis_integer(a, (int64_t)durable_last_lsn(s));
}

void redis_role(struct server *s, const struct request *q, struct answer *a)
{
    if (s->follows) {
        put_leader(s, a);
        return;
    }
    resp_array(a->out, 3);
    redis_bulk_text(a, "master");
    redis_integer(a, (int64_t)durable_last_lsn(s));
    resp_array(a->out, leader_followers(s));
    for (const struct sender *f = NULL; (f = leader_next(s, f)) != NULL;)
        put_follower(a, f);
}

/* ---- what is not there ---- */

void redis_latency(struct server *s, const struct request *q, struct answer *a)
{
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
    if (q->n == 2 && word_is(&q->word[1], "LIST"))
        resp_array(a->out, 0);
    else
        redis_usage(a, "MODULE LIST");
}

/* Appends a word in quotation marks, cut after `most` bytes. */
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
