/* session_inside.h - what the files of a session share among themselves: session.c takes the
 * requests, session_answer.c sees to their answers, session_load.c to the points that follow some of
 * them, session_time.c to the time-outs. */
#ifndef SERVER_SESSION_INSIDE_H
#define SERVER_SESSION_INSIDE_H

#include "proto/line.h"
#include "proto/reply.h"
#include "server/clients/session_state.h"

/* An answer to fill for whatever the session asks next. It is copied from an empty one, which
 * compilers do with a few vector moves. To clear a structure of this size they use `rep stos`, which
 * is slow for so few bytes. */
static inline struct answer session_answer(struct session *s)
{
    static const struct answer empty;
    struct answer a = empty;
    a.out = s->resp ? &s->server->lines : &s->conn.out;
    a.mark = conn_out_end(&s->conn);
    a.owner = s->id;
    a.role = s->role;
    a.token = s->token;
    a.command = s->command;
    a.turn = wait_turn(&s->waiter);
    a.waited = s->waited;
    a.timed_out = s->timed_out;
    return a;
}

/* What the answer says goes on its way. False: the reply cannot be completed. */
bool session_deliver(struct session *s, const struct answer *a);

/* The request at hand leaves the input. */
void session_consume(struct session *s);

/* Sees to what the answer says and leaves to do; whether the next request may be looked at right
 * now. */
bool session_take_over(struct session *s, struct answer *a);

/* Sends the next rows of the stream or the listing; true: go on. */
bool session_step_rows(struct session *s);

/* Refuses what cannot be understood, and whatever follows it; always false. */
bool session_refuse(struct session *s, enum reply_code code, const char *why);
bool session_refuse_line(struct session *s, enum line_fault fault);

/* Whether the end of what is there is the end of a line. When the daemon stops it is not: it may
 * have been cut. */
bool session_input_ended(const struct session *s);

/* More has to come first. If it cannot, because the daemon stops or the input has ended, the session
 * ends: what has not arrived whole is not carried out. Always false. */
bool session_wait_for_input(struct session *s);

/* The time that the request at hand may take, if it has a limit, begins, unless it has begun. */
void session_set_deadline(struct session *s);

/* Reads a piece of the body that the session is receiving, or carries out its request; true: go on. */
bool session_step_load(struct session *s);

/* The input has ended while a worker carries out the request. Over TCP, whether the client still reads
 * or has closed the connection shows only when something is sent: the line about the job's progress,
 * soon, once. A closed connection answers with a reset, which ends the job. */
void session_probe(struct session *s);
void session_on_probe(struct timer *t); /* sends it */

#endif
