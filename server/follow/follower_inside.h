/* follower_inside.h - the shared state of the parts of a follower: follower.c carries out the records that the link receives,
 * follower_role.c decides whom it follows. */
#pragma once

#include "server/follow/announce.h"
#include "server/follow/apply.h"
#include "server/follow/link.h"
#include "server/follow/role.h"
#include "server/jobs/server.h"
#include "server/system/loop.h"

struct follower {
    struct source source; /* first: the eventfd of the link and of the announcement */
    struct task task;     /* to continue after other tasks */
    struct server *server;
    struct loop *loop;
    struct link *link;             /* owns; NULL: there is none */
    struct announcement *announce; /* owns; NULL: the former leader has been informed */
    struct announcement *question; /* owns; who the daemon is that is to be followed; NULL: none */
    struct request_queue asking;   /* of the FOLLOW that waits for the answer */
    uint64_t identity;             /* random: of this process */
    struct apply apply;
    struct remembered_role role;
    /* when a promoted follower has certainly informed it; 0: it never needs to */
    int64_t settled_ms;
    bool unsaved;   /* the directory does not remember the newer history that was met */
    bool following; /* records are carried out */
    bool drops;     /* what comes until the link asks for the position is dropped */
    bool busy;      /* a record waits, or a worker has it */
    bool confirmed;
    char why[160];            /* why changes are refused */
    struct link_piece *piece; /* that is being carried out, */
    size_t at;                /* from here on */
    uint64_t looked;          /* lsn at the last tick */
    uint64_t lsn;             /* of the last record that has been carried out or collected */
    uint64_t digest;          /* up to there; 0: it cannot be continued */
    uint64_t whole_digest;    /* without an incomplete LOAD: of what is in the log */
    size_t record;            /* length of the record that a worker has */
    uint64_t claimed, claim;  /* the lsn of a header, and its digest */
    uint64_t done,
        done_bytes; /* the last piece's end: its lsn, and the bytes of the stream up to there */
    uint64_t acked, acked_bytes; /* what was passed to the link */
    uint64_t failures;           /* of the log, when the role was last written */
};

/* Whether a record waits, a worker has it, or its worker has ended and that has not been looked at. */
static inline bool follower_has_record(const struct follower *f)
{
    return f->busy || f->record > 0;
}

/* Begins with what the loop calls. False with errno. */
bool follower_watch(struct follower *f);

/* Writes the role again if the log had failed and works again: its directory may be a new one. To be called once a second. */
void follower_remember(struct follower *f);

/* Drops an incomplete load. */
void follower_forget(struct follower *f);

/* The leader's records and those here are the same up to here, or everything here is the leader's: so there are no
 * changes of its own. */
void follower_agrees(struct follower *f);

/* The question has been answered: the FOLLOW that waits is carried out. */
void follower_hear(struct follower *f);

/* Takes the answer of the former leader, if there is one. */
void follower_take_answer(struct follower *f);
