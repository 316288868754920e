/* server.h - what the commands work on. Connections are not part of it: a command gets a server, a
 * request and an answer, and is tested without sockets. Everything here belongs to the I/O
 * thread. */
#ifndef SERVER_SERVER_H
#define SERVER_SERVER_H

#include "server/disk/hold.h"
#include "server/jobs/answer.h"
#include "server/ops/auth.h"
#include "server/ops/config.h"
#include "server/ops/guard.h"
#include "server/ops/slowlog.h"
#include "server/ops/stats.h"
#include "server/sets/budget.h"
#include "server/sets/dataset.h"
#include "server/sets/worker.h"

struct counters {
    uint64_t connections; /* accepted since the start */
    uint64_t refused;     /* turned away: too many clients, no descriptor left */
    uint64_t commands;    /* carried out, whether or not they succeeded */
    uint64_t errors;      /* ERR replies among them */
    uint64_t jobs;        /* handed to the workers */
    uint64_t shared;      /* requests that got the result of another's job */
    uint64_t slow;        /* requests that went into the slow log */
    uint64_t killed;      /* clients, by CLIENT KILL */
    uint64_t wrong_tokens;
    uint64_t delayed_tokens; /* right and wrong ones that stood in line (guard.h) */
};

struct server {
    struct config *config; /* borrows; CONFIG SET changes it */
    struct budget budget;
    struct wait_queue memory;  /* of requests that wait until a job has given its memory back */
    struct wait_queue log;     /* of changes that wait until the log has been written */
    struct reservation queued; /* bytes that it has to write */
    struct registry sets;
    struct durable *durable; /* owns; NULL: everything is in memory only (no --data) */
    struct rebuild *rebuild; /* owns; of the sets that were read; NULL: none were */
    struct holders held;     /* replies that wait for the disk */
    uint64_t dropped;        /* the lsn of the last DROP in the log */
    struct workers *workers; /* owns; NULL: every job runs at once, where it is asked for */
    struct job *jobs;        /* those that the workers have */
    struct work *early;      /* of these, readers that have finished before an edit (job.h) */
    /* Answers a connection that has joined a job (job_tell); it carries out nothing else then. */
    void (*tell_joined)(struct server *s, uint64_t id, struct job *j);
    struct dt_pages *pages;        /* owns; large arrays come from there, see keep.h */
    uint64_t uses;                 /* of them, at the last tick */
    unsigned idle_ticks;           /* in a row without any */
    bool excess;                   /* more is kept than may be (keep_turn_end) */
    bool releasing;                /* a job gives back what is kept */
    bool preparing;                /* a job makes pages ready */
    size_t expected;               /* bytes that are to be kept for what is being received */
    struct dt_ids scratch;         /* owns; the result of a query that is answered at once */
    struct request request;        /* owns; the words of the request that is carried out */
    struct ahead *ahead;           /* owns; those behind it in its connection's input */
    const struct command *command; /* the last one; the next is often the same; NULL: none yet */
    struct buf lines;              /* owns; a reply in lines before it goes out as RESP */
    struct auth auth;
    struct guard guard;
    struct counters count;
    struct stats stats;
    struct slowlog slowlog;
    struct clients *clients; /* borrows; NULL: there are none, commands come from elsewhere */
    bool draining;           /* it is told to stop, and sends what it has to say */
    bool stopping;
    int64_t started_ms;
};

/* A reservation of that kind, of no bytes yet. */
static inline struct reservation server_reservation(struct server *s, enum budget_kind kind)
{
    return (struct reservation){.budget = &s->budget, .kind = kind};
}

/* Resizes a reservation for a job. False: a says that there is not so much memory, or, if jobs that
 * are under way will give theirs back, to wait for that. Who has come first is served first. */
bool server_reserve(struct server *s, struct answer *a, struct reservation *r, size_t bytes);

/* Answers that there is no memory for `bytes` more: BUSY if there may be later, else NOMEM. */
void server_refuse(const struct server *s, struct answer *a, size_t bytes);

/* To be called when much has been reserved or given back: sets the limit of the pages that are held,
 * those of large arrays and those that are kept to be used again (keep.h). */
void server_limit_pages(struct server *s);

/* That limit, while large arrays take so many bytes. */
size_t server_pages_limit(const struct server *s, size_t large);

/* A job has given its memory back: whoever waits for that is called. */
void server_reserved_less(struct server *s);

#endif
