/* session_state.h - the fields of a session, for code that reads them; session.h has its functions. */
#pragma once

#include "proto/reply_read.h"
#include "server/clients/conn.h"
#include "server/jobs/job.h"
#include "server/system/sock.h"

/* The state of the session. */
enum session_state {
    SESSION_READING,  /* takes requests, or the points of `load`, from its connection */
    SESSION_WAITING,  /* its request waits in a queue (waiter), or until a time (later) */
    SESSION_WORKING,  /* a worker has `job` */
    SESSION_STREAMING /* sends `stream` */
};

struct session {
    struct conn conn; /* first: the connection's view */
    struct server *server;
    struct reactor *reactor;   /* that serves it */
    struct list_link stranger; /* in clients.strangers */
    uint64_t id;
    struct client client;
    bool greeted;     /* the first line has been seen */
    int64_t since_ms; /* when it connected */
    struct sock_peer peer;
    char *name;                    /* owns; from CLIENT SETNAME; NULL: none */
    uint64_t requests;             /* answered so far */
    const struct command *command; /* the last or the current one; NULL: an unknown one */
    unsigned wrong_tokens;         /* AUTH failures so far */
    struct timer probe; /* sends a comment that shows whether the client is still connected */
    bool probed;        /* a comment has been sent: one is enough */
    bool waited;        /* `later` has run for the current request */
    bool evicted;       /* closed to make room for another client */
    struct stats_pause pause;
    bool noted; /* `note` has the words of the request that has paused */
    char note[SLOW_TEXT];
    size_t held; /* bytes of the current request, which stay in the input until it is answered */
    struct timer later;    /* ends the waiting until a time */
    int64_t limit_ms;      /* TIMEOUT of the current request; 0: none */
    int64_t deadline_ms;   /* when that is over; 0: none */
    struct timer deadline; /* runs at that time */
    bool timed_out;        /* the deadline has passed */
    /* A change whose reply waits for followers at most until then; the first and the last one that do. */
    struct session_awaited {
        uint64_t lsn; /* 0: none */
        int64_t at_ms;
    } awaited, last_awaited;
    struct timer awaited_timer; /* runs at awaited.at_ms */
    enum session_state state;
    union {
        struct job *job;       /* borrows */
        struct stream *stream; /* owns */
    };
    uint64_t edited;       /* the lsn of its last change; 0: it has made none */
    int64_t wait_ms;       /* when its WAIT ends; 0: it has none */
    struct list watching;  /* owns; the sets that it watches (server/watch), */
    uint32_t watches;      /* so many */
    struct list temporary; /* its temporary sets (dataset.fellow) */
    struct load *load; /* owns: the body that is being received, or that of the current request */
    bool late;         /* the loop's turn is long: only a quick request is carried out in it */
    bool again;        /* the current request has to be carried out by a reactor that is alone */
    bool refused;      /* the request whose body is being received has already been refused */
    bool resp;         /* the current request came in RESP framing (proto/resp.h) */
    bool in_bulk;      /* the body is one bulk string */
    size_t bulk_left;  /* bytes of it that have not been read */
    size_t need;       /* shorter input has no whole RESP request */
    struct reply_reader reader;        /* the position in a reply that is sent as RESP */
    struct waiter waiter;              /* of the current request */
    void (*closed)(struct session *s); /* called before the session is freed; may be NULL */
};
