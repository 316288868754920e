/* session_load.c - the bodies of requests: a session's steps from the request to the end of its body,
 * and then to its answer. */
#include "proto/resp.h"
#include "server/bodies/load.h"
#include "server/command/command.h"
#include "server/session/request_stats.h"
#include "server/session/session_inside.h"

#include <string.h>

enum { FEED_BYTES = 8 * 1024 }; /* read in one step */

static bool carry_out_load(struct session *s)
{
    request_stats_load(s);
    if (!s->load->adds)
        session_set_deadline(s);
    struct answer a;
    session_answer(s, &a);
    command_run_body(s->server, s->load, &a);
    return session_take_over(s, &a);
}

/* Moves input to bytes[n]. */
static size_t take_input(struct buf *in, char *bytes, size_t n)
{
    n = n < buf_len(in) ? n : buf_len(in);
    memcpy(bytes, buf_head(in), n);
    buf_consume(in, n);
    return n;
}

/* Receives a piece of the body right where it belongs; false: there is none yet, or it has to be fed. */
static bool receive_load(struct session *s)
{
    struct conn *c = &s->conn;
    size_t n = 0;
    char *to = load_room(s->load, &n);
    if (s->in_bulk && n > s->bulk_left)
        n = s->bulk_left;
    c->receives = to != NULL && n > 0;
    if (!c->receives)
        return false;
    size_t got = buf_len(&c->in) > 0 ? take_input(&c->in, to, n) : conn_receive(c, to, n);
    if (got == 0)
        return false;
    load_received(s->load, got);
    if (s->in_bulk)
        s->bulk_left -= got;
    c->receives = !s->load->body.complete;
    return true;
}

/* Workers have parsed all lines before the last one. */
static bool end_parser(struct session *s)
{
    size_t rest = load_end_parser(s->load, &s->conn.in);
    if (s->in_bulk)
        s->bulk_left += rest;
    if (s->conn.in.failed)
        conn_close(&s->conn);
    return !s->conn.closed;
}

/* Appends points that workers have parsed, or receives text for them; true: continue. */
static bool parse_load(struct session *s)
{
    struct parser *p = s->load->parser;
    enum parser_step step = parser_step(p);
    if (step == PARSER_BROKEN)
        return session_refuse_line(s, s->load->body.line_fault);
    if (step == PARSER_MOVED)
        load_moved(s->load);
    if (step == PARSER_MOVED || receive_load(s))
        return true;
    if (s->conn.eof || (s->in_bulk && s->bulk_left == 0))
        parser_end(p);
    return false;
}

/* Feeds the load; true: continue. */
static bool feed_load(struct session *s)
{
    struct buf *in = &s->conn.in;
    size_t all = buf_len(in);
    bool ended = session_input_ended(s);
    if (s->in_bulk && all >= s->bulk_left) {
        all = s->bulk_left;
        ended = true;
    }
    size_t n = all < FEED_BYTES ? all : FEED_BYTES;
    ptrdiff_t took = load_feed(s->load, buf_head(in), n, ended && n == all);
    /* A line longer than a step: again, with all the input. */
    if (took == 0 && n < all)
        took = load_feed(s->load, buf_head(in), all, ended);
    if (took < 0)
        return session_refuse_line(s, s->load->body.line_fault);
    buf_consume(in, (size_t)took);
    if (s->in_bulk)
        s->bulk_left -= (size_t)took;
    return took > 0 || s->load->body.complete || session_wait_for_input(s);
}

/* Reads the rest of the bulk string, which should be empty, and its end. */
static bool end_bulk(struct session *s)
{
    struct buf *in = &s->conn.in;
    size_t n = buf_len(in) < s->bulk_left ? buf_len(in) : s->bulk_left;
    if (n > 0)
        body_fail(&s->load->body, BODY_LONGER);
    buf_consume(in, n);
    s->bulk_left -= n;
    if (s->bulk_left > 0 || buf_len(in) < 2)
        return session_wait_for_input(s);
    if (buf_head(in)[0] != '\r' || buf_head(in)[1] != '\n')
        return session_refuse(s, ERR_SYNTAX, resp_fault_text(RESP_BROKEN));
    buf_consume(in, 2);
    s->in_bulk = false;
    return true;
}

/* Updates the server's state that depends on the load. */
static bool settle_load(struct session *s, bool more)
{
    load_settle(s->load);
    if (s->load->parser == NULL || !parser_is_done(s->load->parser))
        return more;
    return end_parser(s);
}

/* Only the load's own memory changes, so other reactors go on. */
static bool take_points(struct session *s)
{
    loop_share(s->conn.loop);
    if (s->conn.closed || s->conn.finishing)
        return false;
    bool more = s->load->parser != NULL
                    ? parse_load(s)
                    : receive_load(s) || (s->load->parser == NULL && feed_load(s));
    if (!load_has_changed(s->load))
        return more;
    loop_alone(s->conn.loop);
    if (s->conn.closed || s->conn.finishing) /* meanwhile: what follows is not a request */
        return false;
    return settle_load(s, more);
}

/* As the request requires, whose body is complete. Its end frees memory, so a reactor that is alone calls those who wait for some. */
static void enter_world(struct session *s)
{
    bool shares = !s->again && s->waiter.queue == NULL && s->command != NULL &&
                  (s->command->flags & CMD_SHARES) != 0;
    if (shares)
        loop_share(s->conn.loop);
    if (!shares || !queue_is_first(&s->server->memory, NULL))
        loop_alone(s->conn.loop);
}

bool session_step_load(struct session *s)
{
    if (s->load->parser != NULL || !s->load->body.complete)
        return take_points(s);
    enter_world(s);
    if (s->conn.closed || s->conn.finishing)
        return false;
    return s->in_bulk ? end_bulk(s) : carry_out_load(s);
}
