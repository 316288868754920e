/* session_inside.h - shared by the files of a session: session.c takes requests, session_answer.c processes
 * their answers, session_load.c to the points that follow some of them, session_time.c to the time-outs. */
#pragma once

#include "proto/line.h"
#include "proto/reply.h"
#include "server/clients/session_state.h"

/* Makes it a new answer for the current request. It is copied from an empty one, which compilers do with a few vector
 * moves; to clear a structure of this size they use `rep stos`, which is slower. */
static inline void session_answer(struct session *s, struct answer *a)
{
    static const struct answer empty;
    *a = empty;
    a->reactor = s->reactor;
    a->out = s->resp ? &s->reactor->lines : &s->conn.out;
    a->mark = conn_out_end(&s->conn);
    a->owner = s->id;
    a->client = s->client;
    a->since_ns = s->pause.began_ns;
    a->command = s->command;
    a->turn = queue_turn(&s->waiter);
    a->waited = s->waited;
    a->timed_out = s->timed_out;
}

/* Moves the bytes of the answer to the output. False: the reply cannot be completed. */
bool session_deliver(struct session *s, const struct answer *a);

/* Removes the current request from the input. */
void session_consume(struct session *s);

/* Delivers the answer and does what it requires; whether the next request may be carried out now. */
bool session_take_over(struct session *s, struct answer *a);

/* Sends the next piece of the stream; true: continue with the next request. */
bool session_step_stream(struct session *s);

/* Answers with an error and ends the session, because the rest of the input cannot be parsed. Always false. */
bool session_refuse(struct session *s, enum reply_code code, const char *why);
bool session_refuse_line(struct session *s, enum line_fault fault);

/* Whether the end of the input also ends a line. Not when the daemon is stopping: then the line may be
 * incomplete. */
bool session_input_ended(const struct session *s);

/* Waits for more input. If there will be none, because the input has ended or the daemon is stopping, the session
 * ends without carrying out the incomplete request. Always false. */
bool session_wait_for_input(struct session *s);

/* Starts the TIMEOUT of the current request, if it has one and it has not started yet. */
void session_set_deadline(struct session *s);

/* The reply about that change waits: for followers at most until the TIMEOUT of the request is over. */
void session_limit_hold(struct session *s, uint64_t lsn);
void session_on_awaited(struct timer *t); /* it is over */

/* Reads a piece of the body, or carries out its request when the body is complete; true: continue. */
bool session_step_load(struct session *s);

/* To be called when the input has ended while a worker carries out the request. Over TCP, a client that has only
 * closed its sending side can be distinguished from a closed connection only by sending something: a progress
 * comment, soon, once. A closed connection answers with a reset, which ends the job. */
void session_probe(struct session *s);
void session_on_probe(struct timer *t); /* sends the comment */
