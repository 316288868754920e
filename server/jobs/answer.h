/* answer.h - the outcome of a request: the bytes of its reply so far, and what happens next.
 *
 * A handler appends to `out` and sets `next`; the caller of the handler does the rest. */
#pragma once

#include "core/delaunay_constraints.h"
#include "proto/reply.h"
#include "server/ops/auth.h"
#include "server/sets/queue.h"

struct stream;
struct job;
struct dataset;
struct load;
struct command;
struct reactor;

enum answer_next {
    ANSWER_DONE,  /* nothing: the reply is complete */
    ANSWER_WAIT,  /* the request is carried out again, when what it waits for has come */
    ANSWER_WORK,  /* a worker has the job, whose end brings the reply */
    ANSWER_BODY,  /* the body of the request is received */
    ANSWER_STREAM /* the rest of the reply, or all of it, comes from a stream */
};

/* The event that a request waits for (ANSWER_WAIT). */
enum answer_wait {
    WAIT_NOTHING, /* nothing any more: it is carried out now */
    WAIT_QUEUE,   /* the call of a queue */
    WAIT_JOB,     /* the end of a job, which prepares the set */
    WAIT_TIME     /* a time */
};

/* The state of a connection that AUTH, HELLO and MULTI change, through their answer. */
struct client {
    enum role role;
    unsigned token; /* the number of the token that gave the role (auth.h); 0: none */
    bool typed;     /* replies in RESP are typed, since HELLO 3 (server/replies/resp3.h) */
    bool multi;     /* in a transaction: requests in RESP are refused, since MULTI */
};

struct answer {
    struct reactor *reactor; /* that carries out the request; NULL: it is alone in the world */
    struct buf *out;         /* borrows; the reply is appended */
    uint64_t mark;  /* the number of the reply's first byte in the output of the connection */
    uint64_t lsn;   /* the change that the reply acknowledges (reply_hold.h); 0: none */
    uint64_t shown; /* the last change that it shows (reply_hold.h); 0: none */
    uint64_t owner; /* the id of the connection; 0: none */
    struct client client;
    int64_t since_ns; /* when the request was first carried out, if it has waited; 0: it has not */
    const struct command *command; /* NULL: none of that name */
    bool waited;                   /* the request has waited for its time */
    bool timed_out;                /* a cancelled request has exceeded its TIMEOUT */
    bool busy;                     /* out of memory because of other requests */
    bool of_leader;    /* a change of the leader: limits of this daemon on counts do not hold */
    struct load *body; /* borrows: the complete body of the request; NULL: none, or not yet */
    const struct request_queue *turn; /* the queue that has called the request; NULL: none */
    bool refused;                     /* there is an ERR line (answer_err), of this code */
    enum reply_code code;
    uint64_t count; /* what the reply counts (answer_count) */
    bool closes;    /* the connection is closed after the reply */
    bool broken;    /* the reply cannot be completed: the connection is closed at once */
    enum answer_next next;
    enum answer_wait wait_for; /* ANSWER_WAIT */
    bool wait_writes; /* WAIT_QUEUE of a set: until it has no writer, else until it can be read */
    union {
        struct stream *stream; /* ANSWER_STREAM: moves to the caller */
        struct job *job;       /* ANSWER_WORK, WAIT_JOB: borrows */
        struct request_queue
            *wait;         /* WAIT_QUEUE: borrows; to be entered before anything else happens */
        int64_t wait_ms;   /* WAIT_TIME */
        struct load *load; /* ANSWER_BODY: moves to the caller */
    };
};

/* Writes an ERR line, which is the whole reply, and notes its code. This function, and the others that answer with an error or let the
 * request wait, return false, which a caller that checks or reads something returns. */
__attribute__((format(printf, 3, 4))) bool answer_err(struct answer *a, enum reply_code code,
                                                      const char *format, ...);

/* Whether a status of the core is DT_OK; if not, its ERR line has been written. */
bool answer_status(struct answer *a, enum dt_status status);

/* The same; the errors of regions name the border of that number, or all borders if it is DT_NONE. */
bool answer_region(struct answer *a, enum dt_status status, uint32_t number);

/* The ERR line of DT_CROSSES. The two may be named by their numbers in the request, each a `row`; NULL, or 0: by their ids. */
void answer_crosses(struct answer *a, const struct dt_crossed *c, const char *row,
                    const uint64_t *number);

/* The reply of a command without facts or rows. */
static inline void answer_ok(struct answer *a)
{
    reply_ok(a->out, 0);
    reply_end(a->out);
}

/* Ends the status line of an edit: the set has this version now. */
static inline void answer_version(struct answer *a, uint64_t version)
{
    reply_key_u64(a->out, "version", version);
    reply_end(a->out);
}

/* The reply of a request that counts something, which is also a value of the answer. */
static inline void answer_count(struct answer *a, const char *key, uint64_t n)
{
    a->count = n;
    reply_ok(a->out, 0);
    reply_key_u64(a->out, key, n);
    reply_end(a->out);
}

/* The reply of an edit without other facts. */
static inline void answer_changed(struct answer *a, uint64_t version)
{
    reply_ok(a->out, 0);
    answer_version(a, version);
}

/* Whether its reactor shares the world (reactor.h) with others. */
bool answer_shares(const struct answer *a);

/* To be called before the world is changed. False: the reactor shares it with others, and will carry out the request
 * again when it is alone; what the caller has written is void. */
bool world_alone(struct answer *a);

/* The request waits in the queue. */
static inline bool answer_wait(struct answer *a, struct request_queue *q, bool writes)
{
    if (!world_alone(a))
        return false;
    a->next = ANSWER_WAIT;
    a->wait_for = WAIT_QUEUE;
    a->wait = q;
    a->wait_writes = writes;
    return false;
}

/* The request waits for the end of the job, which a worker has; then it is carried out again. */
static inline void answer_wait_job(struct answer *a, struct job *j)
{
    a->next = ANSWER_WAIT;
    a->wait_for = WAIT_JOB;
    a->job = j;
}

/* The request is carried out again, now. */
static inline bool answer_again(struct answer *a)
{
    a->next = ANSWER_WAIT;
    a->wait_for = WAIT_NOTHING;
    return false;
}

/* The request waits until a time of the loop. */
static inline void answer_wait_until(struct answer *a, int64_t ms)
{
    a->next = ANSWER_WAIT;
    a->wait_for = WAIT_TIME;
    a->wait_ms = ms;
}

/* Out of memory: the caller of the handler replaces the reply by an error. */
static inline bool answer_out_of_memory(struct answer *a)
{
    a->out->failed = true;
    return false;
}

/* The same, but there will be memory when other requests have ended. */
static inline bool answer_busy(struct answer *a)
{
    a->busy = true;
    return answer_out_of_memory(a);
}
