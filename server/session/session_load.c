/* session_load.c - the bodies of requests: a session's steps from the request to the end of its body,
 * and then to its answer. */
#include "proto/resp.h"
#include "server/command/account.h"
#include "server/command/command.h"
#include "server/command/load.h"
#include "server/session/session_inside.h"

enum { FEED_BYTES = 8 * 1024 }; /* read in one step */

static bool carry_out_load(struct session *s)
{
    account_load(s);
    if (!s->load->adds)
        session_set_deadline(s);
    struct answer a;
    session_answer(s, &a);
    command_run_body(s->server, s->load, &a);
    return session_take_over(s, &a);
}

/* Receives points right into their array; false: there are none yet, or they have to be fed. */
static bool receive_load(struct session *s)
{
    struct conn *c = &s->conn;
    size_t n = 0;
    char *to = buf_len(&c->in) == 0 ? load_room(s->load, &n) : NULL;
    if (s->in_bulk && n > s->bulk_left)
        n = s->bulk_left;
    c->receives = n > 0;
    size_t got = c->receives ? conn_receive(c, to, n) : 0;
    if (got == 0)
        return false;
    load_received(s->load, got);
    if (s->in_bulk)
        s->bulk_left -= got;
    c->receives = !s->load->body.complete;
    return true;
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

/* Only the load's own memory changes, so other reactors go on. */
static bool take_points(struct session *s)
{
    loop_share(s->conn.loop);
    if (s->conn.closed || s->conn.finishing)
        return false;
    bool more = receive_load(s) || feed_load(s);
    if (load_has_changed(s->load)) {
        loop_alone(s->conn.loop);
        if (s->load != NULL)
            load_expect(s->load);
    }
    return more;
}

bool session_step_load(struct session *s)
{
    if (!s->load->body.complete)
        return take_points(s);
    loop_alone(s->conn.loop);
    if (s->conn.closed || s->conn.finishing)
        return false;
    return s->in_bulk ? end_bulk(s) : carry_out_load(s);
}
