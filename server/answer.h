/* answer.h - what becomes of a request: bytes of a reply now, and what is still to come.
 *
 * A handler writes into out. Beyond that it may leave exactly one of: a stream (rows that are too
 * many to write at once), a listing (the same for what is made a piece per turn), a job (a worker has
 * it; the reply comes when it is done), a queue to wait in (the request is to be tried again when its
 * turn has come), a load (points follow the request). Whoever called the handler takes over what is
 * left. */
#ifndef SERVER_ANSWER_H
#define SERVER_ANSWER_H

#include "core/delaunay.h"
#include "proto/reply.h"
#include "server/auth.h"
#include "server/wait.h"

struct stream;
struct listing;
struct job;
struct dataset;
struct load;

struct answer {
    struct buf *out;  /* borrows; the reply is appended to what it holds */
    uint64_t mark;    /* of the reply's first byte in the output of whoever asks */
    uint64_t lsn;     /* it acknowledges this change, and waits until that is durable; 0: none */
    uint64_t shown;   /* it shows what this change has done: likewise (hold.h) */
    uint64_t owner;   /* who asks: a connection's id, 0 for nobody */
    int64_t later_ms; /* the request is to be carried out at this moment; 0: now */
    enum role role;   /* what the asker may do; AUTH changes it */
    unsigned token;   /* the number of the token that gave the role; 0: none did */
    unsigned command; /* which one it is: its place in the table, else STATS_OTHER */
    bool waited;      /* it has stood in line until later_ms */
    bool wait_writes; /* wait is for a set, until it has no writer; else until it can be read */
    bool retry;       /* the job was a preparation: carry out the request now, again */
    bool again;       /* with job: it is such a preparation, keep the request */
    bool timed_out;   /* what is cancelled has taken longer than its TIMEOUT */
    bool close;       /* no further request is carried out */
    bool broken;      /* the reply cannot be completed: the connection must go */
    bool busy;        /* there is no memory for it, because others use it */
    struct stream *stream;         /* moves to the caller */
    struct listing *listing;       /* moves to the caller */
    struct job *job;               /* borrows: the job ends by itself */
    struct wait_queue *wait;       /* borrows: begin to wait before anything else happens */
    const struct wait_queue *turn; /* the request has waited there, and its turn has come */
    struct load *load;             /* moves to the caller */
};

/* The ERR line for a status of the core that is not DT_OK. */
void answer_status(struct answer *a, enum dt_status status);

/* The request is to be tried again when that queue calls it. */
static inline void answer_wait(struct answer *a, struct wait_queue *q, bool writes)
{
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
