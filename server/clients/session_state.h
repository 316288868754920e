/* session_state.h - what a session consists of; for those who look into one (session.h has what it can
 * do). */
#ifndef SERVER_SESSION_STATE_H
#define SERVER_SESSION_STATE_H

#include "proto/reply_read.h"
#include "server/clients/conn.h"
#include "server/jobs/job.h"
#include "server/system/sock.h"

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
    int64_t limit_ms;      /* that the request may take; 0: any time */
    int64_t deadline_ms;   /* of the request that waits or that a worker has; 0: none */
    struct timer deadline; /* set: runs at that moment */
    bool timed_out;        /* it has passed */
    enum session_state state;
    union {
        struct job *job;         /* borrows */
        struct stream *stream;   /* owns */
        struct listing *listing; /* owns */
    };
    struct temporaries *temporary; /* owns; NULL: it has no temporary sets */
    struct load *load; /* owns: the body that is being received, or whose request is under way */
    bool refused;      /* the request whose body is being received has been refused already */
    bool resp;         /* the request under way came in RESP framing (proto/resp.h) */
    bool in_bulk;      /* the load's points come as one bulk string */
    size_t bulk_left;  /* bytes of it that have not been read */
    size_t need;       /* input shorter than this holds no whole RESP request */
    struct reply_reader reader; /* the place in a reply that goes out as RESP */
    struct waiter waiter;       /* of the request under way */
    void (*closed)(
        struct session *s); /* tells whoever keeps the session, which is freed afterwards */
};

#endif
