/* session.h - one client's conversation: takes requests from its connection one after the other,
 * hands them to the commands, and sees to what an answer leaves to come: streams, jobs, waiting,
 * loads.
 *
 * At most one request of a client is under way, so replies come in the order of requests; those
 * behind it wait in the connection's input. A turn is bounded in time and in output, so that no
 * client holds up the others. */
#ifndef SERVER_SESSION_H
#define SERVER_SESSION_H

#include "proto/reply_read.h"
#include "server/conn.h"
#include "server/job.h"
#include "server/sock.h"

/* What it does. */
enum session_state {
    SESSION_READING,   /* takes requests, or the points of `load`, from its connection */
    SESSION_WAITING,   /* its request waits in a queue (waiter) */
    SESSION_DELAYED,   /* its request waits for a moment (later) */
    SESSION_WORKING,   /* a worker has `job` */
    SESSION_STREAMING, /* sends the rows of `stream` */
    SESSION_LISTING    /* sends those of `listing` */
};

struct session {
    struct conn conn; /* first: the connection's view */
    struct server *server;
    uint64_t id;
    enum role role;
    unsigned token;   /* the number of the token that gave it (auth.h); 0: none did */
    bool greeted;     /* the first line has been seen */
    int64_t since_ms; /* when it came */
    struct sock_peer peer;
    char *name;            /* owns; by CLIENT SETNAME; NULL: none */
    uint64_t requests;     /* answered so far */
    unsigned command;      /* the last one, or the one under way; as in struct answer */
    unsigned wrong_tokens; /* that it has shown */
    struct timer probe; /* set: runs when a comment is to show whether the client is still there */
    bool probed;        /* it has run while a worker could report progress: once is enough */
    bool waited;        /* it has run for the request at hand */
    bool evicted;       /* it has made room for another client */
    struct stats_pause pause;
    bool noted; /* the request that has paused is in `note`, as words */
    char note[SLOW_TEXT];
    size_t held; /* bytes of the request that waits: kept in the input until it is answered */
    struct timer later;    /* SESSION_DELAYED: ends that */
    int64_t deadline_ms;   /* of the request that waits or that a worker has; 0: none */
    struct timer deadline; /* set: runs at that moment */
    bool timed_out;        /* it has passed */
    enum session_state state;
    union {
        struct job *job;         /* borrows */
        struct stream *stream;   /* owns */
        struct listing *listing; /* owns */
    };
    struct load *load;          /* owns: points that are being received */
    bool refused;               /* the load that is being received has been refused already */
    bool resp;                  /* the request under way came in RESP framing (proto/resp.h) */
    bool in_bulk;               /* the load's points come as one bulk string */
    size_t bulk_left;           /* bytes of it that have not been read */
    size_t need;                /* input shorter than this holds no whole RESP request */
    struct reply_reader reader; /* the place in a reply that goes out as RESP */
    struct waiter waiter;       /* of the request under way */
    void (*closed)(
        struct session *s); /* tells whoever keeps the session, which is freed afterwards */
};

/* A session on a connected non-blocking socket, whose other end is *peer; NULL, with the socket
 * still the caller's, when out of memory or descriptors. It frees itself when its connection has
 * closed. */
struct session *session_new(struct server *server, struct loop *loop, int fd,
                            const struct sock_peer *peer, void (*closed)(struct session *s));

/* Ends a job of this session. */
void session_job_done(struct session *s, struct job *j);

/* Answers the session, which has joined another one's job. */
void session_job_shared(struct session *s, struct job *j);

/* The hold of this session's connection lets more of its output go. */
void session_released(struct hold *h);

/* What the replies that are held would have acknowledged may be lost: ends the session with an
 * error instead of them. */
void session_not_saved(struct hold *h);

/* To be called once a second: closes sessions that stall, that show no token in time, or that have
 * sent nothing for --idle-timeout. */
void session_check_timeouts(struct session *s);

/* Closes at once, with an error: a client that has shown no token makes room for another one. */
void session_evict(struct session *s);

enum { SESSION_PROGRESS_MS = 1000 }; /* a job that takes longer reports how far it is */

/* Tells the client how far its job is. */
void session_progress(struct session *s, const struct job *j);

#endif
