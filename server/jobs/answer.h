/* answer.h - what becomes of a request: bytes of a reply now, and what is still to come.
 *
 * A handler writes into out. What is still to come then is told by `next`; whoever called the handler
 * takes it over. */
#ifndef SERVER_ANSWER_H
#define SERVER_ANSWER_H

#include "core/delaunay.h"
#include "proto/reply.h"
#include "server/ops/auth.h"
#include "server/sets/wait.h"

struct stream;
struct listing;
struct job;
struct dataset;
struct load;

enum answer_next {
    ANSWER_WHOLE,   /* nothing: the reply is there */
    ANSWER_CLOSING, /* the same, and no further request is carried out */
    ANSWER_STREAM,  /* rows that are too many to write at once */
    ANSWER_LISTING, /* the same for rows that are made a piece per turn */
    ANSWER_JOB,     /* all of it: a worker has the job, and the reply comes when it is done */
    ANSWER_PREPARING, /* a worker prepares the set; when it is done, the request is to be carried out */
    ANSWER_AGAIN,     /* the set has been prepared: the request is to be carried out now */
    ANSWER_WAIT,      /* the request is to be carried out when the queue calls it */
    ANSWER_LATER,     /* it is to be carried out at the moment later_ms */
    ANSWER_BODY,      /* the body, which follows the request */
    ANSWER_BROKEN     /* the reply cannot be completed: the connection must go */
};

struct answer {
    struct buf *out;  /* borrows; the reply is appended to what it holds */
    uint64_t mark;    /* of the reply's first byte in the output of whoever asks */
    uint64_t lsn;     /* it acknowledges this change, and waits until that is durable; 0: none */
    uint64_t shown;   /* it shows what this change has done: likewise (hold.h) */
    uint64_t owner;   /* who asks: a connection's id, 0 for nobody */
    enum role role;   /* what the asker may do; AUTH changes it */
    unsigned token;   /* the number of the token that gave the role; 0: none did */
    unsigned command; /* which one it is: its place in the table, else STATS_OTHER */
    bool waited;      /* it has waited until later_ms */
    bool timed_out;   /* what is cancelled has taken longer than its TIMEOUT */
    bool busy;        /* there is no memory for it, because others use it */
    struct load
        *body; /* borrows: the body of the request, which is complete; NULL: it has none, or it
                          has not come yet */
    const struct wait_queue *turn; /* the request has waited there, and its turn has come */
    enum answer_next next;
    bool wait_writes; /* ANSWER_WAIT for a set: until it has no writer; else until it can be read */
    union {
        struct stream *stream;   /* ANSWER_STREAM: moves to the caller */
        struct listing *listing; /* ANSWER_LISTING: moves to the caller */
        struct job *job;         /* ANSWER_JOB, ANSWER_PREPARING: borrows; the job ends by itself */
        struct wait_queue
            *wait;         /* ANSWER_WAIT: borrows; begin to wait before anything else happens */
        int64_t later_ms;  /* ANSWER_LATER */
        struct load *load; /* ANSWER_BODY: moves to the caller */
    };
};

/* The ERR line for a status of the core that is not DT_OK. */
void answer_status(struct answer *a, enum dt_status status);

/* The whole reply of a command that has no facts to add. */
static inline void answer_ok(struct answer *a)
{
    reply_ok(a->out, 0);
    reply_end(a->out);
}

/* The request is to be carried out when that queue calls it. */
static inline void answer_wait(struct answer *a, struct wait_queue *q, bool writes)
{
    a->next = ANSWER_WAIT;
    a->wait = q;
    a->wait_writes = writes;
}

/* Out of memory: whoever called the handler undoes the reply and says so. */
static inline void answer_out_of_memory(struct answer *a)
{
    a->out->failed = true;
}

/* The same, and there will be memory when others give theirs back. */
static inline void answer_busy(struct answer *a)
{
    a->busy = true;
    answer_out_of_memory(a);
}

#endif
