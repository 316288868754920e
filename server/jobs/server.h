/* server.h - the state that commands work on, apart from connections: a command gets a server, a request and an
 * answer, and is tested without sockets. It is part of the world (loop.h): only a reactor that is alone changes it. */
#pragma once

#include "server/disk/reply_hold.h"
#include "server/jobs/answer.h"
#include "server/jobs/reactor.h"
#include "server/jobs/worker.h"
#include "server/ops/auth.h"
#include "server/ops/auth_delay.h"
#include "server/ops/config.h"
#include "server/ops/slowlog.h"
#include "server/sets/budget.h"
#include "server/sets/dataset.h"

struct counters {
    uint64_t connections; /* accepted since the start */
    uint64_t refused;     /* connections: too many clients, no descriptors */
    uint64_t jobs;        /* submitted to the workers */
    uint64_t shared;      /* requests that got the result of another request's job */
    uint64_t killed;      /* clients, by CLIENT KILL */
    uint64_t watchers;    /* now: sets that connections watch, each counted for each of them */
    uint64_t events;      /* that these were sent */
    uint64_t wrong_tokens;
    uint64_t delayed_tokens; /* right and wrong ones whose check was delayed (auth_delay.h) */
};

/* The sets that clients watch, or have watched lately (server/watch/watch.c). */
struct watching {
    struct list all, busy, now, deserted; /* owns those in `all` */
    struct loop *loop;    /* borrows; of the first reactor; NULL: nobody has watched */
    int64_t processor_ns; /* of all reactors, up to their last events */
};

/* Sets without their triangulations, the smallest one last. */
struct loading {
    struct dataset **set; /* owns n */
    size_t n;
};

struct facts;

struct server {
    struct config *config;   /* borrows; CONFIG SET changes it */
    struct gate *world;      /* owns; what the reactors share; NULL: there is one reactor */
    struct lanes in_world;   /* owns; empty if there is one reactor */
    struct reactor *reactor; /* owns `reactors` */
    unsigned reactors;
    struct budget budget;
    struct request_queue memory; /* of requests that wait for the memory of a job */
    struct request_queue log;    /* of changes that wait because the log's queue is full */
    struct reservation queued;   /* bytes in that queue */
    struct registry sets;
    struct list temporary;   /* sets whose connections have ended, to be dropped (dataset.fellow) */
    struct durable *durable; /* owns; NULL: everything is in memory only (no --data) */
    struct loading loading;  /* sets that were read at the start, and are not triangulated yet */
    struct holders held;     /* replies that wait for the disk (reply_hold.h) */
    uint64_t dropped;        /* the lsn of the last DROP in the log */
    struct workers *workers; /* owns; NULL: every job runs at once, on this thread */
    /* owns; the followers of this daemon (server/follow); NULL: none can follow */
    struct leader *leader;
    struct follower *follower; /* owns; its leader; NULL: it has none */
    struct {
        enum reply_code code;
        const char *why; /* borrows; NULL: changes are possible */
    } read_only;
    bool follows;                   /* it has a leader, or begins with one */
    bool without_followers;         /* there are fewer than --min-followers */
    struct watching watching;       /* the sets that clients watch */
    struct list jobs;               /* those of the workers, until they are collected and ended */
    struct dt_pages *pages;         /* owns; the page cache for large arrays (page_cache.h) */
    uint64_t uses;                  /* of the cache, at the last tick */
    unsigned idle_ticks;            /* ticks in a row without a use */
    atomic_bool excess;             /* the cache exceeds its limit (page_cache_turn_end) */
    bool releasing;                 /* a job is returning pages */
    bool preparing;                 /* a job is prefaulting pages */
    size_t expected;                /* bytes to prefault for points that are being received */
    const struct command *commands; /* borrows; the table, server/commands.c */
    size_t command_count;
    /* Appends the facts of a section of INFO (server/info.h), for Redis's clients. */
    void (*info)(const struct server *s, const char *section, struct facts *f);
    struct auth auth;
    struct auth_delay auth_delay;
    struct counters count;
    struct slowlog slowlog;
    struct clients *clients; /* borrows; NULL: none (tests) */
    bool draining;           /* it is stopping, and finishes replies */
    bool stopping;
    int64_t started_ms;
};

/* The reactor of a request; the first one, if the answer has none. */
static inline struct reactor *reactor_of(const struct server *s, const struct answer *a)
{
    return a->reactor != NULL ? a->reactor : s->reactor;
}

/* An empty reservation of that kind. */
static inline struct reservation server_reservation(struct server *s, enum budget_kind kind)
{
    return (struct reservation){.budget = &s->budget, .kind = kind};
}

/* The statistics of a command, by its index in the table of commands. The statistics of several reactors are added up in
 * *sum, which is returned. */
const struct command_stats *server_stats(const struct server *s, size_t command,
                                         struct command_stats *sum);

/* The requests that all reactors have carried out, of these those with an ERR reply, and those in the slow log. */
struct request_counts {
    uint64_t commands, errors, slow;
} server_requests(const struct server *s);

/* Resizes a reservation for a job. False: the request waits in the queue, if jobs that are under way will free
 * memory; otherwise the ERR line has been written. */
bool server_reserve(struct server *s, struct answer *a, struct reservation *r, size_t bytes);

/* Writes the error for a lack of `bytes`: BUSY if there may be memory later, else NOMEM. Returns false. */
bool server_refuse(struct server *s, struct answer *a, size_t bytes);

/* To be called after large changes of the budget: sets the limit of pages, in use and in the cache (page_cache.h). */
void server_limit_pages(struct server *s);

/* That limit, while large arrays use `large` bytes. */
size_t server_pages_limit(const struct server *s, size_t large);

/* Memory has been freed: calls the first request that waits for it. */
void server_memory_freed(struct server *s);
